"""All pictures of one run, each drawn once, when it is asked for.

Plane and solid runs are two painters with one interface; the dimension chooses between them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Protocol

import numpy as np

from rfm.app.pictures.canvas import ERROR_MAP, FIELD_MAP, png_bytes, short_number
from rfm.app.record import RunRecord
from rfm.app.samples import Samples, exact_values, lengths
from rfm.calculus.types import Array
from rfm.errors import RfmError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from rfm.app.pictures.space import Solid


class Painter(Protocol):
    """Draws the pictures of one run as figures."""

    def solution(self, title: str) -> Figure:
        """Draw the solution."""

    def error(self, title: str) -> Figure:
        """Draw the difference from the exact solution."""

    def shape(self, title: str) -> Figure:
        """Draw the shape on its grid."""


@dataclass(frozen=True)
class PlanePainter:
    """Draws a run in the plane."""

    record: RunRecord
    samples: Samples

    def solution(self, title: str) -> Figure:
        """Draw the solution."""
        from rfm.app.pictures.plane import field_2d

        return field_2d(self.samples.mesh, self.samples.shown, title)

    def error(self, title: str) -> Figure:
        """Draw the difference from the exact solution."""
        from rfm.app.pictures.plane import error_2d

        shown = self.samples.shown_error
        error = np.zeros(len(self.samples.u)) if shown is None else shown
        return error_2d(self.samples.mesh, error, title)

    def shape(self, title: str) -> Figure:
        """Draw the shape on its grid."""
        from rfm.app.pictures.shape_grid import shape_2d

        return shape_2d(self.record, self.samples.mesh, title)


@dataclass(frozen=True)
class SolidPainter:
    """Draws a run in space."""

    record: RunRecord
    samples: Samples

    @cached_property
    def _solid(self) -> Solid:
        from rfm.app.pictures.space import Solid

        return Solid(self.record)

    def solution(self, title: str) -> Figure:
        """Draw the solution."""
        from rfm.app.pictures.space import field_3d

        return field_3d(
            self._solid, lambda points: lengths(self.record.u(points)), title, FIELD_MAP, symmetric=False
        )

    def error(self, title: str) -> Figure:
        """Draw the difference from the exact solution."""
        from rfm.app.pictures.space import field_3d

        return field_3d(self._solid, self._difference, title, ERROR_MAP, symmetric=True)

    def shape(self, title: str) -> Figure:
        """Draw the shape on its grid."""
        from rfm.app.pictures.shape_grid import shape_3d

        return shape_3d(self.record, self._solid, title)

    def _difference(self, points: Array) -> Array:
        if self.record.exact is None:
            return np.zeros(len(points))
        return lengths(self.record.u(points) - exact_values(self.record, points))


PAINTERS: dict[int, type[PlanePainter] | type[SolidPainter]] = {2: PlanePainter, 3: SolidPainter}


def painter(record: RunRecord, samples: Samples) -> Painter:
    """Whoever draws runs of this dimension.

    Raises
    ------
    RfmError
        Nobody does.
    """
    dimension = record.domain.dimension
    if dimension not in PAINTERS:
        raise RfmError(f"no pictures are drawn in {dimension} dimensions, only in 2 and 3")
    return PAINTERS[dimension](record, samples)


def solution_figure(record: RunRecord, samples: Samples) -> Figure:
    """The picture of the solution as a matplotlib figure."""
    return painter(record, samples).solution(_solution_title(record, samples))


@dataclass(frozen=True)
class Gallery:
    """The pictures of a run as PNG, drawn on first use."""

    record: RunRecord
    samples: Samples

    @cached_property
    def solution(self) -> bytes:
        """The solution: ``picture.png``."""
        return png_bytes(self._painter.solution(_solution_title(self.record, self.samples)))

    @cached_property
    def error(self) -> bytes | None:
        """The difference from the exact solution; None when that is not known."""
        if self.samples.error is None:
            return None
        shown = self.samples.shown_error if self.samples.shown_error is not None else np.zeros(0)
        finite = shown[np.isfinite(shown)]
        largest = short_number(float(np.abs(finite).max(initial=0.0)))
        what = "u − exact" if self.samples.error.ndim == 1 else "|u − exact|"
        return png_bytes(self._painter.error(f"{what}, at most {largest}"))

    @cached_property
    def components(self) -> dict[str, bytes]:
        """Components of a vector and derived quantities such as stresses, in the plane, by name."""
        from rfm.app.pictures.plane import field_2d

        samples = self.samples
        if self.record.domain.dimension != 2:
            return {}
        fields = dict(samples.derived)
        if samples.u.ndim > 1:
            fields = {f"u{'xyz'[c]}": samples.u[:, c] for c in range(samples.u.shape[1])} | fields
        return {name: png_bytes(field_2d(samples.mesh, values, name)) for name, values in fields.items()}

    @cached_property
    def shape(self) -> bytes:
        """The shape on its grid."""
        cells = " × ".join(str(int(count)) for count in self.record.grid.cells)
        return png_bytes(self._painter.shape(f"The shape on its grid of {cells} cells"))

    @cached_property
    def convergence(self) -> bytes | None:
        """The convergence of the study; None when there was none."""
        from rfm.app.pictures.convergence import convergence

        figure = convergence(self.record.study or (), "Convergence")
        return None if figure is None else png_bytes(figure)

    @cached_property
    def _painter(self) -> Painter:
        return painter(self.record, self.samples)


def _solution_title(record: RunRecord, samples: Samples) -> str:
    return f"{record.title}: {'u' if samples.u.ndim == 1 else '|u|'}"
