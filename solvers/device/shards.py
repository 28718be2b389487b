"""How many boxes a grid is cut into, and what does not suit the devices at hand."""

from __future__ import annotations

from solvers.problem import SolverOptions

ALL = "all"


def boxes_of(options: SolverOptions) -> int:
    """Boxes of a solve: what is asked for, otherwise one, or all devices of several processes."""
    import jax

    every = len(jax.devices(options.device))
    if isinstance(options.shards, int):
        return options.shards
    return every if options.shards == ALL or jax.process_count() > 1 else 1


def unsuitable_shards(options: SolverOptions) -> str | None:
    """Why `options.shards` does not suit, and what does; None when it suits.  The kind of device is there."""
    import jax

    count, kind = boxes_of(options), options.device
    if count < 1 or (isinstance(options.shards, str) and options.shards != ALL):
        return f"shards must be a positive number, or {ALL}, got {options.shards!r}"
    processes, devices = jax.process_count(), jax.devices(kind)
    if count > len(devices):
        remedy = (
            f"set XLA_FLAGS=--xla_force_host_platform_device_count={count} before the start"
            if kind == "cpu" and processes == 1
            else "run on more machines (rfm run --coordinator)"
        )
        return (
            f"shards: {count} needs as many devices, but JAX finds {len(devices)} of kind {kind}: choose shards: "
            f"{len(devices)} or fewer, or {remedy}"
        )
    if count % processes:
        return (
            f"shards: {count} cannot be divided among {processes} processes: choose a multiple of {processes}, or "
            f"shards: {ALL}"
        )
    fewest = min(sum(one.process_index == k for one in devices) for k in range(processes))
    if count // processes > fewest:
        return (
            f"shards: {count} needs {count // processes} devices of each process, but one has {fewest} only"
        )
    return None
