"""The matrix of an energy on devices, known by its products (:mod:`solvers.device.product`)."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from rfm.calculus.types import Array
from solvers.device.backend import computing
from solvers.device.cells import Groups
from solvers.device.layout import Layout
from solvers.device.mesh import compiled, fetched, mesh_of, placed
from solvers.device.product import applied
from solvers.device.team import Team
from solvers.linear.choice import Candidate, MatrixFree


class Operator(MatrixFree):
    """A symmetric matrix known by its products.

    Parameters
    ----------
    groups
        The cells; given up.
    kind
        What to compute on: a name in :data:`solvers.device.backend.DEVICES`.
    team
        The processes that compute together.
    """

    def __init__(self, groups: Groups, kind: str, team: Team) -> None:
        self.kind, space, components = kind, groups.space, groups.components
        layout = Layout(groups, team)
        self._diagonal = groups.diagonal(team)
        self._known: tuple[Array, Array] | None = None
        self._where = "" if groups.blocks.count == 1 else f", {groups.blocks.shown()} boxes of cells"
        self.shape = (components * space.n_dofs,) * 2
        self.plan, self._boxes = layout.plan, layout.boxes
        own = layout.halo.own
        self._held = layout.held
        self._unknowns = np.concatenate(own)
        self._places = np.concatenate([box * self._held + np.arange(len(one)) for box, one in enumerate(own)])
        self.data = np.array(team.gather(groups.moduli))
        """Sums of the moduli of the coefficients, finite where all of these are."""
        with computing(kind):
            self.mesh = mesh_of(kind, groups.blocks.count)
            self.arrays = layout.arrays(kind, partial(placed, self.mesh))

    def spread(self, vector: Array, spare: float = 0.0) -> Any:
        """Array (boxes, components * held, ...) on the devices of a vector (n, ...), `spare` where there is nothing."""
        components, boxes, rest = self.plan.components, self.mesh.devices.size, vector.shape[1:]
        found = np.full((components, boxes * self._held, *rest), spare)
        found[:, self._places] = vector.reshape(components, len(self._unknowns), *rest)[:, self._unknowns]
        by_box = found.reshape(components, boxes, self._held, *rest).swapaxes(0, 1)[list(self._boxes)]
        return placed(self.mesh, list(by_box.reshape(len(self._boxes), components * self._held, *rest)))

    def everywhere(self, number: float) -> Any:
        """Array (boxes,) of one number."""
        return placed(self.mesh, [np.array(number)] * len(self._boxes))

    def joined(self, array: Any) -> Array:
        """Vector (n,) of an array of all boxes."""
        components = self.plan.components
        by_box = fetched(array).reshape(-1, components, self._held).swapaxes(0, 1).reshape(components, -1)
        found = np.empty((components, len(self._unknowns)))
        found[:, self._unknowns] = by_box[:, self._places]
        return found.ravel()

    def __matmul__(self, vector: Array) -> Array:
        """``A x`` of a vector (n,)."""
        if self._known is not None and np.array_equal(vector, self._known[0]):
            return self._known[1]

        with computing(self.kind):
            return self.joined(compiled(applied)(self.mesh, self.plan, self.arrays, self.spread(vector)))

    def remember(self, vector: Array, image: Array) -> None:
        """Keep a product, so that the residual of a solution needs no program of its own."""
        self._known = (vector, image)

    def diagonal(self) -> Array:
        """Diagonal without the products of different splines attached to one unknown, shape (n,)."""
        return self._diagonal

    def candidate(self) -> Candidate:
        """Conjugate gradients on the device."""
        from solvers.device.conjugate_gradients import DeviceGradients

        name, size = f"cg, matrix-free on {self.kind}", f"{self.shape[0]} unknowns"
        return Candidate(name, DeviceGradients(), f"{size}; device: {self.kind}{self._where}")
