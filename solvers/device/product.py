r"""The matrix of an energy as what it does to a vector, cell by cell on JAX.

.. math:: A x = E \sum_G \Pi_G^T\, T_G^T\, C_G\, T_G\, \Pi_G\, E^T x

over the groups G of cells (:mod:`solvers.device.cells`): E extends the unknowns to all B-spline coefficients
(:mod:`solvers.device.extension`), :math:`\Pi` gathers the ``K = (p+1)^d`` of each cell, T evaluates their derivatives
at the nodes (:mod:`solvers.device.contraction`), C are the coefficients of :mod:`solvers.equations.density`.
:math:`\Pi^T` is a gather too: index i collects from the cells ``i - a``, :math:`a \in \{0, \dots, p\}^d`, whose rows a
padded grid of cell numbers tells, so that nothing is added in an order that a device is free to choose.

The scaling of conjugate gradients takes the diagonal of :math:`E D E^T`, D the diagonal of the B-splines' matrix: exact
where no outer spline is attached, and of the right size elsewhere.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.jets import multi_indices
from solvers.device.cells import GroupPlan
from solvers.device.contraction import PointTables, Tables, TensorTables
from solvers.device.extension import extended, restricted
from solvers.device.halo import received, returned
from solvers.device.places import gathered
from solvers.device.plan import Plan

Arrays = dict[str, Any]


def applied(plan: Plan, arrays: Arrays, vector: Any) -> Any:
    """``A x`` of the unknowns (n,) of a box, to be compiled."""
    held = received(plan.links, arrays["links"], vector.reshape(plan.components, -1))
    full = extended(arrays["extension"], held)
    sums = [
        _group_product(plan, group, data, full)
        for group, data in zip(plan.groups, arrays["groups"], strict=True)
    ]
    found = restricted(arrays["extension"], gathered(plan, arrays["places"], sums))
    return returned(plan.links, arrays["links"], found).ravel()


def _group_product(plan: Plan, group: GroupPlan, data: Arrays, full: Any) -> Any:
    """Element products ``T^T C T x`` of all cells of a group, chunk by chunk: (chunks, M, K, n)."""
    import jax
    import jax.numpy as jnp

    offsets = _offsets(plan)
    derivatives = multi_indices(len(plan.shape), group.order)
    columns = sorted({column for key in group.keys for column in key})
    kinds = {derivatives[alpha] for _, alpha in columns}

    def chunk(number: Any, found: Any) -> Any:
        piece = {
            name: jax.lax.dynamic_index_in_dim(a, number, 0, False) for name, a in data["chunks"].items()
        }
        tables = _tables(group, data, piece)
        local = full[:, piece["base"] + offsets[:, None]].reshape(plan.components, *plan.local, -1)
        jets = tables.values(local, kinds)
        images: dict[Any, Any] = {}
        for key, (test, trial) in enumerate(group.keys):
            weight = _at_nodes(group, plan, piece["coefficients"][key])
            for row, column in {(test, trial), (trial, test)}:
                term = weight * jets[derivatives[column[1]]][column[0]]
                images[row] = images[row] + term if row in images else term
        fields = {(m, derivatives[alpha]): f for (m, alpha), f in images.items()}
        return found.at[number].set(_components(plan, tables, fields))

    chunks, size = data["chunks"]["base"].shape
    # a box has room for as many cells as the one that has most, and goes through its own only
    nothing = jnp.zeros((chunks, plan.components, offsets.size, size))
    return jax.lax.fori_loop(0, data["used"], chunk, nothing)


def _components(plan: Plan, tables: Tables, fields: dict[Any, Any]) -> Any:
    """Transposed tables applied to fields by (component, kind): (M, K, n)."""
    import jax.numpy as jnp

    some = next(iter(fields.values()))
    kinds = sorted({kind for _, kind in fields})
    stacked = {
        kind: jnp.stack([fields.get((m, kind), jnp.zeros_like(some)) for m in range(plan.components)])
        for kind in kinds
    }
    return tables.adjoint(stacked).reshape(plan.components, -1, some.shape[-1])


def _tables(group: GroupPlan, data: Arrays, piece: Arrays) -> Tables:
    if group.nodes is not None:
        return TensorTables(tuple(data["lines"]))
    return PointTables(tuple(piece[f"lines{axis}"] for axis in range(len(piece) - 2)))


def _at_nodes(group: GroupPlan, plan: Plan, weight: Any) -> Any:
    """A coefficient (nodes, n) in the shape of the values at the nodes."""
    return weight.reshape(*[group.count] * len(plan.shape), -1) if group.nodes is not None else weight


def _offsets(plan: Plan) -> NDArray[np.int32]:
    """Flat distances from the first coefficient of a cell to all of them, shape (K,)."""
    local = np.indices(plan.local).reshape(len(plan.shape), -1)
    return np.asarray(np.ravel_multi_index(tuple(local), plan.shape), dtype=np.int32)
