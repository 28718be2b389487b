"""Boxes on devices: one program for all of them, arrays whose first axis counts the boxes.

A box has the same shapes as any other, so all run one compiled program, each on the device that holds its arrays, and
exchange what they need from inside of it (:func:`solvers.device.halo.received`, :func:`total`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module
from typing import Any

import numpy as np

from rfm.calculus.types import Array
from solvers.device.halo import AXIS


def mesh_of(kind: str, count: int) -> Any:
    """Mesh of `count` devices of a kind, as many of each process as of any other."""
    import jax

    each = count // jax.process_count()
    devices = [
        [one for one in jax.devices(kind) if one.process_index == process][:each]
        for process in range(jax.process_count())
    ]
    return jax.sharding.Mesh(np.array(devices).ravel(), (AXIS,))


def mapped(function: Callable[..., Any], mesh: Any, plan: Any, *arrays: Any) -> Any:
    """``function(plan, *arrays)`` of each box, to be compiled; the first three arguments are static."""
    import jax

    def of_box(*blocks: Any) -> Any:
        found = function(plan, *jax.tree.map(lambda array: array[0], blocks))
        return jax.tree.map(lambda array: array[None], found)

    sharding: Any = jax.sharding
    spec = sharding.PartitionSpec(AXIS)
    given = {"mesh": mesh, "in_specs": spec, "out_specs": spec}
    module: Any = jax
    if hasattr(jax, "shard_map"):
        given["check_vma"] = False
    else:  # its place in older versions
        module = import_module("jax.experimental.shard_map")
        given["check_rep"] = False
    return module.shard_map(of_box, **given)(*arrays)


def compiled(function: Callable[..., Any]) -> Callable[..., Any]:
    """Program ``(mesh, plan, *arrays)`` of a function of one box."""
    import jax

    program = jax.jit(mapped, static_argnums=(0, 1, 2))
    return lambda *given: program(function, *given)


def placed(mesh: Any, boxes: Sequence[Any]) -> Any:
    """Arrays on devices from the trees of arrays of the boxes of this process."""
    import jax

    module: Any = jax.sharding
    sharding = module.NamedSharding(mesh, module.PartitionSpec(AXIS))
    own = [device for device in mesh.devices.flat if device.process_index == jax.process_index()]

    def joined(*parts: Any) -> Any:
        pieces = [
            jax.device_put(np.asarray(part)[None], device) for part, device in zip(parts, own, strict=True)
        ]
        shape = (mesh.devices.size, *pieces[0].shape[1:])
        return jax.make_array_from_single_device_arrays(shape, sharding, pieces)

    return jax.tree.map(joined, *boxes)


def fetched(array: Any) -> Array:
    """Values (boxes, ...) of an array of all boxes, on every process."""
    from jax.experimental.multihost_utils import process_allgather

    if array.is_fully_addressable:
        return np.asarray(array)
    return np.asarray(process_allgather(array, tiled=True))


def first(array: Any) -> Array:
    """Values of one box of this process, of what is the same in all boxes."""
    value: Array = np.asarray(array.addressable_shards[0].data)[0]
    return value


def total(values: Any) -> Any:
    """Sum over the boxes, inside a program."""
    import jax

    lax: Any = jax.lax
    return lax.psum(values, AXIS)
