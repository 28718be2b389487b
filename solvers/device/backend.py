"""What JAX computes on: devices by name, double precision, and a compilation cache that outlives the process.

JAX is imported here and only when a device is asked for.  Double precision holds inside :func:`computing` alone, so
a program that uses JAX for something else keeps its own setting.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from importlib import import_module
from pathlib import Path
from typing import Any

NONE = "none"
DEVICES = (NONE, "cpu", "gpu")
"""Where systems are solved: as assembled matrices with NumPy, or matrix-free by JAX."""
CACHE = "JAX_COMPILATION_CACHE_DIR"
"""Variable of the environment that says where compiled programs are kept."""
WORTH_KEEPING = 0.1
"""Seconds of compilation from which on its result is kept."""


def found() -> tuple[str, ...]:
    """Devices that JAX finds, as ``cpu: TFRT_CPU_0``."""
    import jax

    names = []
    for kind in DEVICES[1:]:
        try:
            names += [f"{kind}: {device}" for device in jax.devices(kind)]
        except RuntimeError:
            continue
    return tuple(names)


def missing(kind: str) -> str | None:
    """Why there is no device of a kind and what to do; None when there is one."""
    import jax

    try:
        jax.devices(kind)
    except RuntimeError:
        others = sorted({name.partition(":")[0] for name in found()})
        return (
            f"JAX finds no {kind} here, only {', '.join(others)}: install JAX with support for yours "
            '(pip install "jax[cuda12]" for NVIDIA) and see what `rfm doctor` lists, or choose device: cpu, or none'
        )
    return None


@contextmanager
def computing(kind: str) -> Iterator[Any]:
    """Context with double precision and the first own device of a kind as the default one; gives the device."""
    import jax

    _keep_programs()
    device = jax.local_devices(backend=kind)[0]
    with _double_precision(), jax.default_device(device):
        yield device


def _double_precision() -> AbstractContextManager[Any]:
    """Context of double precision, which older versions of JAX keep elsewhere."""
    import jax

    module: Any = jax if hasattr(jax, "enable_x64") else import_module("jax.experimental")
    context: AbstractContextManager[Any] = module.enable_x64(True)
    return context


def cache_folder() -> Path:
    """Where compiled programs are kept: as JAX is told, or ``rfm/jax`` in the user's folder of caches."""
    if os.environ.get(CACHE):
        return Path(os.environ[CACHE])
    home = os.environ.get("XDG_CACHE_HOME")
    return (Path(home) if home else Path.home() / ".cache") / "rfm" / "jax"


def _keep_programs() -> None:
    """Keep compiled programs, unless the user has told JAX where or whether to."""
    import jax

    config: Any = jax.config
    if config.jax_compilation_cache_dir is None:
        config.update("jax_compilation_cache_dir", str(cache_folder()))
        config.update("jax_persistent_cache_min_compile_time_secs", WORTH_KEEPING)
