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

from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rfm.calculus.jets import multi_indices
from rfm.calculus.types import Array
from solvers.device.backend import computing
from solvers.device.cells import GroupPlan, Groups
from solvers.device.contraction import PointTables, Tables, TensorTables
from solvers.device.extension import extended, extension_arrays, restricted
from solvers.linear.choice import Candidate, MatrixFree

Arrays = dict[str, Any]


@dataclass(frozen=True)
class Plan:
    """Everything that the compiled programs depend on but the arrays.

    Attributes
    ----------
    degree, shape
        Degree p and full shape of a component's coefficients.
    components
        Splines M of the same space.
    groups
        Groups of cells.
    """

    degree: int
    shape: tuple[int, ...]
    components: int
    groups: tuple[GroupPlan, ...]

    @property
    def local(self) -> tuple[int, ...]:
        """Shape of the coefficients of a cell."""
        return (self.degree + 1,) * len(self.shape)


class Operator(MatrixFree):
    """A symmetric matrix known by its products.

    Parameters
    ----------
    groups
        The cells; given up.
    kind
        What to compute on: a name in :data:`solvers.device.backend.DEVICES`.
    """

    def __init__(self, groups: Groups, kind: str) -> None:
        self.kind, space, components = kind, groups.space, groups.components
        arrays = groups.arrays(kind)
        self._diagonal = groups.diagonal()
        self._known: tuple[Array, Array] | None = None
        self.plan = Plan(space.degree, space.shape, components, tuple(arrays))
        self.shape = (components * space.n_dofs,) * 2
        finite = [float(np.abs(a["chunks"]["coefficients"]).sum()) for a in arrays.values()]
        self.data = np.array(finite)
        """Sums of the moduli of the coefficients, finite where all of these are."""
        import jax

        with computing(kind) as device:
            self.arrays = jax.device_put(
                {
                    "extension": extension_arrays(space.free, int(np.prod(space.shape))),
                    "groups": list(arrays.values()),
                    "places": places(self.plan, [a["chunks"]["base"] for a in arrays.values()], arrays),
                },
                device,
            )

    def __matmul__(self, vector: Array) -> Array:
        """``A x`` of a vector (n,)."""
        import jax

        if self._known is not None and np.array_equal(vector, self._known[0]):
            return self._known[1]

        with computing(self.kind):
            return np.asarray(jax.jit(applied, static_argnums=0)(self.plan, self.arrays, vector))

    def remember(self, vector: Array, image: Array) -> None:
        """Keep a product, so that the residual of a solution needs no program of its own."""
        self._known = (vector, image)

    def diagonal(self) -> Array:
        """Diagonal without the products of different splines attached to one unknown, shape (n,)."""
        return self._diagonal

    def candidate(self) -> Candidate:
        """Conjugate gradients on the device."""
        from solvers.device.conjugate_gradients import DeviceGradients

        name = f"cg, matrix-free on {self.kind}"
        return Candidate(name, DeviceGradients(), f"{self.shape[0]} unknowns; device: {self.kind}")


def applied(plan: Plan, arrays: Arrays, vector: Any) -> Any:
    """``A x``, to be compiled."""
    full = extended(arrays["extension"], vector.reshape(plan.components, -1))
    sums = [
        _group_product(plan, group, data, full)
        for group, data in zip(plan.groups, arrays["groups"], strict=True)
    ]
    return restricted(arrays["extension"], gathered(plan, arrays["places"], sums)).ravel()


def _group_product(plan: Plan, group: GroupPlan, data: Arrays, full: Any) -> Any:
    """Element products ``T^T C T x`` of all cells of a group, chunk by chunk: (chunks, M, K, n)."""
    import jax

    offsets = _offsets(plan)
    derivatives = multi_indices(len(plan.shape), group.order)
    columns = sorted({column for key in group.keys for column in key})
    kinds = {derivatives[alpha] for _, alpha in columns}

    def chunk(piece: Arrays) -> Any:
        tables = _tables(group, data, piece)
        local = full[:, piece["base"] + offsets[:, None]].reshape(plan.components, *plan.local, -1)
        jets = tables.values(local, kinds)
        images: dict[Any, Any] = {}
        for number, (test, trial) in enumerate(group.keys):
            weight = _at_nodes(group, plan, piece["coefficients"][number])
            for row, column in {(test, trial), (trial, test)}:
                term = weight * jets[derivatives[column[1]]][column[0]]
                images[row] = images[row] + term if row in images else term
        return _components(plan, tables, {(m, derivatives[alpha]): f for (m, alpha), f in images.items()})

    return jax.lax.map(chunk, data["chunks"])


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


def places(plan: Plan, bases: list[Array], arrays: Any) -> Arrays:
    """Where the products of each cell are found in the list of all of them.

    The list is a zero, the groups' arrays (chunks, M, K, n) one after the other, and the sums of the cells that occur
    more than once, as (M, K, n).  ``start`` is the place of component 0, coefficient 0 of a cell, ``stride`` the
    distance to the next coefficient; both on the grid of cells with a margin of p, zero where there is nothing.
    """
    block, total = plan.components * (plan.degree + 1) ** len(plan.shape), 1
    cells, starts, strides = [], [], []
    for base, (_, data) in zip(bases, arrays.items(), strict=True):
        chunks, size = base.shape
        real = np.any(data["chunks"]["coefficients"] != 0, axis=(1, 2))
        at = np.arange(chunks)[:, None] * (block * size) + np.arange(size) + total
        cells.append(base[real])
        starts.append(at[real])
        strides.append(np.full(int(real.sum()), size))
        total += chunks * block * size
    cell, start, stride = (np.concatenate(found) for found in (cells, starts, strides))
    order = np.argsort(cell, kind="stable")
    cell, start, stride = cell[order], start[order], stride[order]
    unique, first, times = np.unique(cell, return_index=True, return_counts=True)
    several = times > 1
    column = np.arange(times.max(initial=1))
    valid = column[:, None] < times[several]
    at = np.where(valid, first[several] + column[:, None], 0)
    found_start, found_stride = start[first], stride[first]
    found_start[several] = total + np.arange(int(several.sum()))
    found_stride[several] = int(several.sum())
    margin = tuple(n + plan.degree for n in plan.shape)  # cells + 2 p
    where = np.stack(np.unravel_index(unique, plan.shape)) + plan.degree
    kind = np.int32 if total < 2**31 - 2**24 else np.int64
    grids = [np.zeros(margin, dtype=kind) for _ in range(2)]
    for grid, found in zip(grids, (found_start, found_stride), strict=True):
        grid[tuple(where)] = found
    return {
        "start": grids[0],
        "stride": grids[1],
        "several_start": np.where(valid, start[at], 0).astype(kind),
        "several_stride": np.where(valid, stride[at], 0).astype(kind),
    }


def gathered(plan: Plan, where: Arrays, sums: list[Any]) -> Any:
    """Sums over the cells around each coefficient: (M, size)."""
    import jax
    import jax.numpy as jnp

    kept = (plan.degree + 1) ** len(plan.shape)
    listed = jnp.concatenate([jnp.zeros(1), *(s.ravel() for s in sums)])
    if where["several_start"].shape[1]:
        number = jnp.arange(plan.components * kept)[:, None]
        start, stride = where["several_start"][:, None], where["several_stride"][:, None]
        again = listed[start + number * stride].sum(axis=0)
        listed = jnp.concatenate([listed, again.ravel()])
    corners = jnp.array([[plan.degree - a for a in index] for index in product(*map(range, plan.local))])

    def add(number: Any, total: Any) -> Any:
        corner = corners[number]
        start, stride = (
            jax.lax.dynamic_slice(where[name], corner, plan.shape).ravel() for name in ("start", "stride")
        )
        parts = [listed[start + (m * kept + number) * stride] for m in range(plan.components)]
        return total + jnp.stack(parts)

    empty = jnp.zeros((plan.components, int(np.prod(plan.shape))))
    return jax.lax.fori_loop(0, kept, add, empty)
