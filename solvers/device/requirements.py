"""What the matrix-free path can do, so that the rest is refused before anything is computed."""

from __future__ import annotations

from solvers.bases.registry import basis
from solvers.device.backend import DEVICES, NONE, missing
from solvers.flux_conditions import has_flux
from solvers.problem import Discretization, Problem, SolverOptions

SUITABLE = ("auto", "cg")
"""Names of linear solvers that need no more than products with the matrix."""


def without_device(
    method: str, problem: Problem, discretization: Discretization, options: SolverOptions
) -> str | None:
    """Why `options.device` does not suit, and the nearest that does; None when it suits."""
    device = options.device
    if device not in DEVICES:
        return f"unknown device {device!r}: choose one of {', '.join(DEVICES)}"
    if method != "ritz":
        return (
            f"device: {device} runs conjugate gradients on the matrix of an energy, which the method {method} does not "
            f"have: choose method: ritz, or device: {NONE}"
        )
    if not basis(discretization.basis).local:
        return (
            f"device: {device} works cell by cell, but the functions of basis: {discretization.basis} overlap "
            f"everywhere: choose basis: web-spline, or device: {NONE}"
        )
    if discretization.conditions == "exact" and any(has_flux(c) for c in problem.conditions):
        return (
            f"device: {device} knows one space of splines, and conditions: exact puts a second one into collars: "
            f"choose conditions: natural, or device: {NONE}"
        )
    if problem.inclusions:
        return (
            f"device: {device} knows one space of splines, and each material of the inclusions has its own: choose "
            f"device: {NONE}"
        )
    if options.linear not in SUITABLE:
        return (
            f"device: {device} has no matrix that linear: {options.linear} could take: choose linear: cg (or auto), or "
            f"device: {NONE}"
        )
    return missing(device)
