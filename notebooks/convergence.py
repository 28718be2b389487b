# ---
# jupyter:
#   jupytext:
#     formats: ipynb,py:percent
#     text_representation:
#       extension: .py
#       format_name: percent
#       format_version: '1.3'
#       jupytext_version: 1.19.6
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # How fast it converges, and what the weight does at a corner
#
# The domain is a formula, the condition $u = 0$ holds by construction because $u = w\,\psi$ with a weight $w$ that
# vanishes on the boundary, and $\psi$ is a spline of degree $p$ on a uniform grid that ignores the boundary. Two
# experiments with the packages used directly:
#
# 1. the orders $p + 1$ in $L_2$ and $p$ in $H^1$ for $p = 1, \dots, 5$ on an annulus,
# 2. three weights on a shape with convex corners: the R-conjunctions $R_0$ and $R_0^m$, and the product of the factors.

# %%
import matplotlib.pyplot as plt
import numpy as np

from rfm.calculus.functions import exp, sin
from rfm.geometry import disk, rectangle
from solvers import ritz
from solvers.equations.poisson import Poisson
from solvers.norms import error_norms
from solvers.problem import Dirichlet, Discretization, Problem


def homogeneous(domain, exact):
    """Poisson's equation with u = 0 on all of the boundary; the source is that of the exact solution."""
    return Problem(domain, Poisson(source=None), (Dirichlet(domain.part("all"), 0.0),), exact)


def solve(problem, **discretization):
    """The solution, and its relative errors."""
    solution = ritz.solve(problem, Discretization(**discretization))
    return solution, error_norms(solution.trial, problem.exact, solution.background)


def rate(grids, errors):
    """Observed order over the last two refinements whose errors are above rounding."""
    good = [(n, e) for n, e in zip(grids, errors, strict=True) if e > 1e-12][-3:]
    n, e = np.array(good).T
    return np.polyfit(np.log(n), -np.log(e), 1)[0]


# %% [markdown]
# ## Orders on an annulus
#
# The solution is the product of the two circles' polynomials times $e^x \sin(10y + 5x)$: with a smooth weight, $\psi$ is a
# generic smooth function, lively enough that the asymptotic orders show well above rounding.

# %%
annulus = disk(center=(0.5, 0.5), radius=0.4) - disk(center=(0.5, 0.5), radius=0.1)


def exact(x, y):
    rho = (x - 0.5) ** 2 + (y - 0.5) ** 2
    return (0.16 - rho) * (rho - 0.01) * exp(x) * sin(10 * y + 5 * x)


problem = homogeneous(annulus, exact)
grids = [16, 24, 32, 48, 64]
l2, h1 = {}, {}
for p in range(1, 6):
    norms = [solve(problem, degree=p, grid=n)[1] for n in grids]
    l2[p], h1[p] = [e.l2 for e in norms], [e.h1 for e in norms]

print("p   order in L2   order in H1   finest L2 error")
for p, e in l2.items():
    print(f"{p}   {rate(grids, e):11.2f}   {rate(grids, h1[p]):11.2f}   {e[-1]:15.1e}")

# %%
fig, axes = plt.subplots(1, 2, figsize=(10, 4), sharey=True)
for ax, errors, name in zip(axes, (l2, h1), ("$L_2$", "$H^1$"), strict=True):
    for p, e in errors.items():
        ax.loglog(grids, e, "o-", label=f"$p = {p}$, order {rate(grids, e):.1f}")
    ax.set(xlabel="cells across", title=f"relative error in {name}")
    ax.grid(True, which="both", alpha=0.3)
    ax.legend(fontsize="small")
fig.tight_layout()

# %% [markdown]
# High degree on few cells pays: the error against the number of unknowns.

# %%
fig, ax = plt.subplots(figsize=(6, 4))
for p in (2, 3, 4, 6, 8):
    points = [(s.dofs, e.l2) for s, e in (solve(problem, degree=p, grid=n) for n in (10, 12, 14, 18, 24))]
    ax.loglog(*np.array(points).T, "o-", label=f"$p = {p}$")
ax.set(xlabel="unknowns", ylabel="relative error in $L_2$")
ax.grid(True, which="both", alpha=0.3)
ax.legend()
fig.tight_layout()

# %% [markdown]
# ## The weight at a convex corner
#
# A disk intersected with a rectangle. The solution is the product of all the primitives' polynomials times a smooth
# function. An R-conjunction of two functions $f, g$ is not smooth where $f = g = 0$, which is just at the corner, so
# $\psi = u/w$ has a kink there and the order is lost. The plain product of the factors vanishes to first order on each
# side and is smooth: on an intersection every factor is positive inside.

# %%
plate = disk(center=(0.5, 0.5), radius=0.4) & rectangle(min=(0.22, 0.26), max=(0.87, 0.85))


def corner_exact(x, y):
    circle = 0.16 - (x - 0.5) ** 2 - (y - 0.5) ** 2
    return circle * (x - 0.22) * (0.87 - x) * (y - 0.26) * (0.85 - y) * exp(x) * sin(3 * y)


corner = homogeneous(plate, corner_exact)
grids = [16, 32, 64]
names = {"r0": "$R_0$", "r0m2": "$R_0^m, m = 2$", "product": "product"}
errors = {
    (weight, p): [solve(corner, degree=p, grid=n, weight=weight)[1].l2 for n in grids]
    for weight in names
    for p in (3, 4)
}
print("weight    p   relative L2 errors on", grids)
for (weight, p), e in errors.items():
    print(f"{weight:8}  {p}  ", "  ".join(f"{value:.1e}" for value in e))

# %%
fig, axes = plt.subplots(1, 2, figsize=(10, 4), sharey=True)
for ax, p in zip(axes, (3, 4), strict=True):
    for weight, label in names.items():
        e = errors[weight, p]
        ax.loglog(grids, e, "o-", label=f"{label}: order {rate(grids, e):.1f}")
    ax.set(xlabel="cells across", title=f"relative $L_2$ error, $p = {p}$")
    ax.grid(True, which="both", alpha=0.3)
    ax.legend(fontsize="small")
fig.tight_layout()

# %% [markdown]
# The weights themselves near the corners on the upper right: level lines of the R-conjunction follow the boundary round
# them, those of the product are smooth.

# %%
from rfm.geometry.weight import weight as weight_of

x, y = np.meshgrid(np.linspace(0.6, 0.88, 200), np.linspace(0.6, 0.86, 200))
inside = np.where(plate.membership(x, y) >= 0, 1.0, np.nan)
fig, axes = plt.subplots(1, 3, figsize=(12, 3.6), sharey=True)
for ax, (weight, label) in zip(axes, names.items(), strict=True):
    w = weight_of(plate, plate.part("all"), weight)(x, y) * inside
    ax.contour(x, y, w, levels=np.nanmax(w) * np.linspace(0, 0.9, 12))
    ax.set(title=label, aspect="equal")
fig.tight_layout()
