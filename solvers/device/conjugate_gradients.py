"""Conjugate gradients as one compiled loop; tests and reports are those of :mod:`solvers.linear.iterative`."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np

from rfm.calculus.types import Array
from solvers.device.backend import computing
from solvers.device.mesh import compiled, first, total
from solvers.device.plan import Plan
from solvers.device.product import applied
from solvers.linear.iterative import NOISE, STALLED, not_converged
from solvers.linear.system import INDEFINITE, ScaledSystem, refusal


class State(IntEnum):
    """How the loop ended."""

    RUNNING = 0
    CONVERGED = 1
    STALLED = 2
    CURVED = 3


@dataclass(frozen=True)
class Loop:
    """What the compiled loop depends on besides its arrays: the operator's plan and the most steps."""

    plan: Plan
    limit: int


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
        operator = system.original
        target = tolerance * float(np.linalg.norm(system.load))
        right = system.project(system.scaled_load)
        with computing(operator.kind):
            vectors = {
                "scale": operator.spread(system.scale, 1.0),
                "null": operator.spread(system.null),
                "right": operator.spread(right),
            }
            run = compiled(iterate)
            plan = Loop(operator.plan, self.limit)
            ends = run(operator.mesh, plan, operator.arrays, vectors, operator.everywhere(target))
            x, image = operator.joined(ends["x"]), operator.joined(ends["image"])
            step, best, state = (first(ends[name]) for name in ("step", "best", "state"))
        if state == State.CURVED and best > NOISE * target:
            raise refusal(INDEFINITE, f"negative curvature in iteration {step}")
        if state == State.STALLED:
            raise not_converged(float(best) / target * tolerance, tolerance, int(step))
        if state == State.CONVERGED:
            operator.remember(system.scale * x, image / system.scale)
        return x, int(step)


def iterate(loop: Loop, arrays: Any, vectors: dict[str, Any], target: Any) -> dict[str, Any]:
    """Return the scaled solution and its image, the steps, the smallest residual and the state; to be compiled.

    All is done box by box; two sums over the boxes a step, one more where there is a null space.
    """
    import jax
    import jax.numpy as jnp

    scale, null, right = vectors["scale"], vectors["null"], vectors["right"]

    def project(vector: Any) -> Any:
        return vector - null @ total(null.T @ vector) if null.shape[1] else vector

    def unfinished(now: dict[str, Any]) -> Any:
        return now["state"] == State.RUNNING

    def advance(now: dict[str, Any]) -> dict[str, Any]:
        step, remainder = now["step"], now["remainder"]
        unscaled = remainder / scale
        square, product = total(jnp.stack([unscaled @ unscaled, remainder @ remainder]))
        norm = jnp.sqrt(square)
        better = norm < now["best"]
        best, best_step = jnp.where(better, norm, now["best"]), jnp.where(better, step, now["best_step"])
        stalled = (step - best_step > STALLED) | (step >= loop.limit)
        done = (norm <= target) | stalled
        ratio = jnp.where(step > 0, product / now["old"], 0.0)
        direction = remainder + ratio * now["direction"]
        # the last product is that of the solution, for the residual that is reported
        image = scale * applied(loop.plan, arrays, scale * jnp.where(done, now["x"], direction))
        curvature = total(direction @ image)
        going = jnp.where(curvature > 0, State.RUNNING, State.CURVED)
        state = jnp.where(norm <= target, State.CONVERGED, jnp.where(stalled, State.STALLED, going))
        length = jnp.where(state == State.RUNNING, product / curvature, 0.0)
        return {
            "x": now["x"] + length * direction,
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
    return {key: end[key] for key in ("x", "image", "step", "best", "state")}
