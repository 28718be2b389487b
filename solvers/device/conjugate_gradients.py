"""Conjugate gradients as one compiled loop; tests and reports are those of :mod:`solvers.linear.iterative`."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING, Any

import numpy as np

from rfm.calculus.types import Array
from solvers.device.backend import computing
from solvers.linear.iterative import NOISE, STALLED, not_converged
from solvers.linear.system import INDEFINITE, ScaledSystem, refusal

if TYPE_CHECKING:
    from solvers.device.operator import Plan


class State(IntEnum):
    """How the loop ended."""

    RUNNING = 0
    CONVERGED = 1
    STALLED = 2
    CURVED = 3


@dataclass(frozen=True)
class DeviceGradients:
    """Conjugate gradients with Jacobi's preconditioner (which is the scaling) where the operator computes."""

    limit: int = 10_000

    def solve(self, system: ScaledSystem, tolerance: float) -> tuple[Array, int]:
        """Solve to the relative residual `tolerance`.

        Raises
        ------
        NumericsError
            A direction of negative energy was met.
        NotConverged
            The tolerance was not reached.
        """
        import jax

        operator = system.original
        target = tolerance * float(np.linalg.norm(system.load))
        with computing(operator.kind):
            run = jax.jit(iterate, static_argnums=(0, 1))
            right = system.project(system.scaled_load)
            found = run(operator.plan, self.limit, operator.arrays, system.scale, system.null, right, target)
            x, image, step, best, state = (np.asarray(one) for one in found)
        if state == State.CURVED and best > NOISE * target:
            raise refusal(INDEFINITE, f"negative curvature in iteration {step}")
        if state == State.STALLED:
            raise not_converged(float(best) / target * tolerance, tolerance, int(step))
        if state == State.CONVERGED:
            operator.remember(system.scale * x, image / system.scale)
        return x, int(step)


def iterate(plan: Plan, limit: int, arrays: Any, scale: Any, null: Any, right: Any, target: Any) -> Any:
    """Return the scaled solution and its image, the steps, the smallest residual and the state; to be compiled."""
    import jax
    import jax.numpy as jnp

    from solvers.device.operator import applied

    def project(vector: Any) -> Any:
        return vector - null @ (null.T @ vector)

    def unfinished(loop: dict[str, Any]) -> Any:
        return loop["state"] == State.RUNNING

    def advance(loop: dict[str, Any]) -> dict[str, Any]:
        step, remainder = loop["step"], loop["remainder"]
        norm = jnp.linalg.norm(remainder / scale)
        better = norm < loop["best"]
        best, best_step = jnp.where(better, norm, loop["best"]), jnp.where(better, step, loop["best_step"])
        stalled = (step - best_step > STALLED) | (step >= limit)
        done = (norm <= target) | stalled
        product = remainder @ remainder
        ratio = jnp.where(step > 0, product / loop["old"], 0.0)
        direction = remainder + ratio * loop["direction"]
        # the last product is that of the solution, for the residual that is reported
        image = scale * applied(plan, arrays, scale * jnp.where(done, loop["x"], direction))
        curvature = direction @ image
        going = jnp.where(curvature > 0, State.RUNNING, State.CURVED)
        state = jnp.where(norm <= target, State.CONVERGED, jnp.where(stalled, State.STALLED, going))
        length = jnp.where(state == State.RUNNING, product / curvature, 0.0)
        return {
            "x": loop["x"] + length * direction,
            "image": image,
            "remainder": project(remainder - length * image),
            "direction": direction,
            "old": product,
            "best": best,
            "best_step": best_step,
            "step": step + (state == State.RUNNING),
            "state": state,
        }

    zero = jnp.zeros_like(right)
    start = {
        "x": zero,
        "image": zero,
        "remainder": right,
        "direction": zero,
        "old": jnp.ones(()),
        "best": jnp.array(jnp.inf),
        "best_step": jnp.array(0),
        "step": jnp.array(0),
        "state": jnp.array(int(State.RUNNING)),
    }
    end = jax.lax.while_loop(unfinished, advance, start)
    return end["x"], end["image"], end["step"], end["best"], end["state"]
