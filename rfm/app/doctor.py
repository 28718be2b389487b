"""`rfm doctor`: whether this installation works, and with what."""

from __future__ import annotations

import os
import platform
import time
from importlib import metadata
from importlib.util import find_spec
from typing import Any

from rfm.app.cli.outcome import DONE, FAILED, print_json
from rfm.app.cli.output import say, table
from rfm.app.memory import available_bytes, shown
from rfm.errors import RfmError

REQUIRED = (
    "numpy", "scipy", "jax", "h5py", "matplotlib", "meshio", "pyvista", "pyamg",
    "pydantic", "ruamel.yaml", "typer", "rich", "jinja2",
)  # fmt: skip

OPTIONAL = {
    "pypardiso": "fast sparse factorisation (linear: pardiso)",
    "distributed": "studies on a cluster (rfm study --scheduler)",
    "skfem": "comparison in benchmarks/",
    "gmsh": "comparison in benchmarks/",
}

THREAD_VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")

SELF_TEST: dict[str, Any] = {
    "rfm": 1,
    "title": "self test: Poisson on an annulus",
    "geometry": {
        "shapes": {
            "outer": {"disk": {"center": [0.5, 0.5], "radius": 0.4}},
            "inner": {"disk": {"center": [0.5, 0.5], "radius": 0.1}},
        },
        "domain": "outer - inner",
    },
    "equation": {"poisson": {"source": "from exact"}},
    "boundary_conditions": [{"on": "all", "dirichlet": 0}],
    "exact": "(0.16-(x-0.5)^2-(y-0.5)^2) * ((x-0.5)^2+(y-0.5)^2-0.01) * exp(x) * sin(3*y)",
    "discretization": {"degree": 4, "grid": 12},
}

SELF_TEST_ERROR = 1e-5
"""Relative L2 error that the self test must stay below (it reaches about 1e-7)."""


def examine(*, as_json: bool) -> int:
    """Print the report and run the self test; returns the exit code."""
    facts = report()
    rows = [(name, value or "MISSING") for name, value in facts["versions"].items()]
    rows += [
        (f"{name} (optional)", value or f"absent: {OPTIONAL[name]}")
        for name, value in facts["optional"].items()
    ]
    rows += [("devices of JAX", ", ".join(facts["devices"]) or "none")]
    rows += [("processors", facts["processors"]), ("threads", facts["threads"]), ("memory", facts["memory"])]
    table(("what", "found"), rows, as_json)
    test = self_test()
    missing = [name for name, value in facts["versions"].items() if value is None]
    for name in missing:
        say(f"{name} is missing: install rfm again with its dependencies", as_json)
    say(test["message"], as_json)
    ok = bool(test["passed"]) and not missing
    if as_json:
        print_json({**facts, "self_test": test, "status": "ok" if ok else "broken"})
    return DONE if ok else FAILED


def report() -> dict[str, Any]:
    """Versions, devices, threads and memory."""
    set_threads = {name: os.environ[name] for name in THREAD_VARIABLES if name in os.environ}
    return {
        "versions": {
            "python": platform.python_version(),
            **{name: _version(name) for name in ("rfm", *REQUIRED)},
        },
        "optional": {name: _version(name) if find_spec(name) else None for name in OPTIONAL},
        "devices": list(_devices()),
        "system": f"{platform.system()} {platform.machine()}",
        "processors": _processors(),
        "threads": set_threads or "as many as the libraries choose",
        "memory": f"{shown(available_bytes())} available",
    }


def self_test() -> dict[str, Any]:
    """Solve a small case with a known solution."""
    start = time.perf_counter()
    try:
        from rfm.app.case import load_case
        from rfm.app.run import compute

        error = float(compute(load_case(SELF_TEST)).summary["relative_l2_error"])
    except (RfmError, ImportError) as failure:
        return {"passed": False, "message": f"self test failed: {failure}"}
    seconds, passed = time.perf_counter() - start, error <= SELF_TEST_ERROR
    verdict = "passed" if passed else f"FAILED (limit {SELF_TEST_ERROR:g})"
    message = f"self test {verdict}: relative error {error:.2e} in {seconds:.2f} s"
    return {"passed": passed, "relative_l2_error": error, "seconds": round(seconds, 3), "message": message}


def _version(package: str) -> str | None:
    names = {"skfem": "scikit-fem"}
    try:
        return metadata.version(names.get(package, package))
    except metadata.PackageNotFoundError:
        return None


def _devices() -> tuple[str, ...]:
    """Devices that JAX finds, for the key `device` of the section solver."""
    try:
        from solvers.device.backend import found

        return found()
    except ImportError:
        return ()


def _processors() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
