r"""Fields that neither the energy nor the essential conditions see, and what is done about them.

A temperature with flux conditions only is known up to a constant, a body that is held nowhere up to a rigid
motion.  Then the matrix is singular, the load must vanish on these fields, and the solution is fixed by the
condition that it (or its difference from the exact solution) is orthogonal to them.

The fields are affine (:mod:`solvers.equations.motions`); their unknowns are known to the spaces.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from rfm.calculus.types import Array
from rfm.errors import NumericsError
from solvers.background import Background
from solvers.bases.basis import Space
from solvers.boundary import boundary_batches, outward
from solvers.equations.motions import Motion
from solvers.essential import prescribed
from solvers.exact import exact_jet
from solvers.norms import norm_batches
from solvers.periodicity import periods_of
from solvers.problem import Oblique, Problem, Robin, Slip
from solvers.solution import Piece

TOLERANCE = 1e-6
"""Relative size of a load on a free motion that counts as imbalance."""


@dataclass(frozen=True, eq=False)
class Kernel:
    """Free motions of a problem and their coefficients.

    Attributes
    ----------
    motions
        Linearly independent fields that the problem leaves free.
    vectors
        Unknowns of each of them, shape (n, k).
    """

    motions: tuple[Motion, ...]
    vectors: Array

    def balanced(self, load: Array) -> Array:
        """Load without its rounding errors along the free motions.

        Raises
        ------
        NumericsError
            The load does work on a free motion.
        """
        for motion, vector in zip(self.motions, self.vectors.T, strict=True):
            imbalance = float(vector @ load)
            if abs(imbalance) > TOLERANCE * float(np.linalg.norm(vector) * np.linalg.norm(load)):
                raise NumericsError(incompatible(motion, len(motion.shift), imbalance))
        basis = np.linalg.qr(self.vectors)[0]
        result: Array = load - basis @ (basis.T @ load)
        return result


def incompatible(motion: Motion, components: int, imbalance: float) -> str:
    """Message of a load that does work on a free motion."""
    if components == 1 and not motion.slope.any():
        return (
            "the problem has only flux conditions, and its data are incompatible: the integrals of the source "
            f"and of the boundary flux must add up to zero, but their sum is {imbalance:.6g}; correct them, or fix "
            "the solution somewhere with a Dirichlet or Robin condition"
        )
    return (
        f"the essential conditions leave {motion.name} free, and the loads do not balance along it: their "
        f"resultant is {imbalance:.6g} and must be zero; correct the loads, or hold the body somewhere"
    )


def kernel_of(problem: Problem, background: Background, spaces: Sequence[Space]) -> Kernel | None:
    """Free motions of `problem`, None when there are none.

    Parameters
    ----------
    problem, background
        The problem and its rules, for points of the boundary.
    spaces
        Space of each spline; the first are those of the components of u.

    Raises
    ------
    NumericsError
        Slip conditions leave a rigid motion free, or oblique ones a constant.
    """
    motions = free_motions(problem)
    if motions and problem.oblique:
        raise NumericsError(
            "oblique derivatives and fluxes alone leave a constant free, and nothing tells whether their data are "
            "compatible: fix the solution somewhere with a Dirichlet or Robin condition"
        )
    if motions and any(isinstance(c, Slip) for c in problem.conditions):
        _refuse_slipping(problem, background, motions)
        return None
    if not motions:
        return None
    columns = [
        np.concatenate(
            [
                affine(space, motion.shift[c], motion.slope[c])
                if c < len(motion.shift)
                else np.zeros(space.n_dofs)
                for c, space in enumerate(spaces)
            ]
        )
        for motion in motions
    ]
    return Kernel(tuple(motions), np.stack(columns, axis=1))


def free_motions(problem: Problem) -> list[Motion]:
    """Motions of the equation that no condition of the problem sees; slip is not looked at."""
    dimension = problem.domain.dimension
    motions = problem.equation.motions(dimension)
    if any(len(i.equation.motions(dimension)) < len(motions) for i in problem.inclusions):
        return []
    robin = [c.coefficient for c in problem.conditions if isinstance(c, Robin | Oblique)]
    if any(callable(h) or float(h) != 0.0 for h in robin):
        return []
    for period in periods_of(problem):
        motions = [m for m in motions if period.factor == 1.0 and not m.slope[:, period.axis].any()]
    count = problem.equation.components(dimension)
    held = [c for c in range(count) if prescribed(problem, c, count)]
    if not motions or not held or len(held) == count:
        return [] if held else motions
    return combined(motions, lambda m: np.concatenate([m.shift[held], m.slope[held].ravel()]))


def combined(motions: Sequence[Motion], seen: Callable[[Motion], Array]) -> list[Motion]:
    """Combinations of `motions` of which nothing is `seen`, a linear function of them."""
    rows = np.stack([seen(motion) for motion in motions], axis=1)
    _, sizes, right = np.linalg.svd(rows)
    rank = int((sizes > 1e-9 * max(1.0, float(sizes.max(initial=0.0)))).sum())
    found = []
    for row in right[rank:]:
        mix = row / row[np.argmax(np.abs(row))]
        names = [m.name for a, m in zip(mix, motions, strict=True) if abs(a) > 1e-9]
        shift, slope = (
            np.tensordot(mix, np.stack(parts), axes=1)
            for parts in ([m.shift for m in motions], [m.slope for m in motions])
        )
        found.append(Motion(" with ".join(names), shift, slope))
    return found


def _refuse_slipping(problem: Problem, background: Background, motions: Sequence[Motion]) -> None:
    samples = [
        (
            np.stack([axis[batch.weights > 0] for axis in batch.points(background.grid)]),
            outward(batch)[batch.weights > 0],
        )
        for condition, batch in boundary_batches(problem, background.rules.boundary, background.grid)
        if isinstance(condition, Slip)
    ]
    samples = [one for some in background.sharing.team.gather(samples) for one in some]
    points = np.concatenate([where for where, _ in samples], axis=1)
    normals = np.concatenate([n for _, n in samples])
    left = combined(motions, lambda m: np.einsum("cn,nc->n", m.values(list(points)), normals))
    if left:
        raise NumericsError(
            f"the body can still slip: its conditions leave {left[0].name} free; hold it somewhere with a "
            "Dirichlet condition"
        )


def affine(space: Space, shift: float, slope: Array) -> Array:
    """Unknowns of the function ``shift + slope . x``.

    Raises
    ------
    NumericsError
        The space does not hold it.
    """
    unknowns = space.affine(shift, slope)
    if unknowns is None:
        raise NumericsError(
            "this basis does not hold the motions of a body that is held nowhere: use basis: web-spline"
        )
    return unknowns


def excess(pieces: Sequence[Piece], kernel: Kernel) -> Array:
    """Amounts (k,) of the free motions to take off, so that u (or u - exact) becomes orthogonal to them."""
    count = len(kernel.motions)
    gram, right = np.zeros((count, count)), np.zeros(count)
    batches = (
        (piece, batch) for piece in pieces for batch in norm_batches(piece.background, piece.trial.degree)
    )
    for piece, batch in batches:
        coords = batch.points(piece.background.grid)
        field = piece.trial.jet(batch, 0)
        if piece.problem.exact is not None:
            field = field - exact_jet(piece.problem.exact, coords, 0)
        field = np.where(batch.weights != 0, field, 0.0)
        modes = np.stack([motion.values(coords) for motion in kernel.motions])
        gram += np.einsum("acnq,bcnq,nq->ab", modes, modes, batch.weights)
        right += np.einsum("acnq,cnq,nq->a", modes, field, batch.weights)
    sums = pieces[0].background.sharing.total(np.column_stack([gram, right]))
    return np.asarray(np.linalg.solve(sums[:, :count], sums[:, count]), dtype=float)
