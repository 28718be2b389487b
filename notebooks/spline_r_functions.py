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
# # Spline R-functions as weights of WEB-splines
#
# A spline R-function of bidegree $k$ is a piecewise polynomial on $[-1, 1]^2$, of class $C^{k-1}$, with the signs of a
# Boolean operation. As a weight it is as smooth as the WEB-splines of degree $k$ that it multiplies, and polynomial where
# $R_0$ has a square root. Four experiments: an intersection, a union with all six groups of ordinates, an iterated
# shape, and a union in space; each with $k = 1, 2, 3$, beside the weight of $R_0$ and the program's default.
#
# The exact solutions are $u = w\,g$, $w$ the weight of the run and $g$ smooth. A weight is only $C^{k-1}$ across the
# inner lines where one function vanishes and the other decides, so $-\Delta u$ is a function for $k \ge 2$ only; the load
# is therefore given in the weak form, $\int \nabla u \cdot \nabla v$. The orders are those of the approximation of
# $\psi = g$, if the weight is as good as the theory says: $k + 1$ in $L_2$, $k$ in $H^1$.

# %%
import matplotlib.pyplot as plt
import numpy as np

from rfm.calculus import derivatives, exp, sin, spline_system
from rfm.geometry import ball, disk, rectangle
from rfm.geometry.weight import weight as weight_of
from solvers import ritz
from solvers.equations.energy import Energy
from solvers.equations.poisson import Poisson
from solvers.norms import error_norms
from solvers.problem import Dirichlet, Discretization, Problem


def generic(*x):
    return exp(0.5 * x[0]) * sin(2 * x[1] + x[0] + 1) * (1 if len(x) == 2 else 1 + 0.5 * sin(2 * x[2]))


def equation(exact):
    """Poisson's equation whose load is that of `exact` in the weak form."""
    last = {"x": None}

    def density(*arguments):
        *x, u = arguments
        if last["x"] is not x[0]:  # the density is asked for several u at the same points
            last.update(x=x[0], slopes=derivatives(exact, x, 1)[1:])
        along = (u.x, u.y) if len(x) == 2 else (u.x, u.y, u.z)
        return sum(0.5 * v * v - s * v for s, v in zip(last["slopes"], along, strict=True))

    return Energy(density)


def errors(domain, weight, k, spacings, exact=None):
    """Relative errors in L2 and H1 with WEB-splines of degree k, shape (2, spacings)."""
    w = weight_of(domain, domain.part("all"), weight)
    u = exact or (lambda *x: w(*x) * generic(*x))
    problem = Problem(domain, equation(u), (Dirichlet(domain.part("all"), 0.0),), u)
    found = []
    for h in spacings:
        solution = ritz.solve(problem, Discretization(degree=k, spacing=h, weight=weight))
        norms = error_norms(solution.trial, u, solution.background)
        found.append((norms.l2, norms.h1))
    return np.array(found).T


def order(spacings, values):
    """Observed order over the last refinement."""
    return np.log(values[-1] / values[-2]) / np.log(spacings[-1] / spacings[-2])


def table(title, rows, spacings):
    print(f"{title:34}" + "".join(f"{'h = 1/' + str(round(1 / h)):>11}" for h in spacings) + "      order")
    for name, values in rows.items():
        print(
            f"{name:34}" + "".join(f"{value:11.1e}" for value in values) + f"{order(spacings, values):11.2f}"
        )


def plot(ax, rows, spacings, title):
    for name, values in rows.items():
        ax.loglog(spacings, values, "o-", ms=3, label=f"{name}: {order(spacings, values):.1f}")
    ax.set(xlabel="$h$", title=title)
    ax.grid(True, which="both", alpha=0.3)
    ax.legend(fontsize="x-small")


# %% [markdown]
# ## The functions
#
# Bidegree 2: the six groups of ordinates. Black: the zero set of the intersection, the positive half axes.

# %%
x, y = np.meshgrid(np.linspace(-1, 1, 201), np.linspace(-1, 1, 201))
fig, axes = plt.subplots(1, 6, figsize=(15, 2.9), sharey=True)
for group, ax in enumerate(axes, 1):
    r = spline_system(2, group).conjunction(x, y)
    ax.contourf(x, y, r, levels=np.linspace(-1, 1, 21), cmap="RdBu_r")
    ax.contour(x, y, r, levels=np.linspace(0.05, 0.95, 10), colors="0.4", linewidths=0.5)
    ax.plot([0, 0, 1], [1, 0, 0], "k", lw=1.5)
    ax.set(title=f"group {group}", aspect="equal")
fig.tight_layout()

# %% [markdown]
# ## Example 4.1 of the paper
#
# The annulus of radii 0.1 and 0.4 about $(1/2, 1/2)$ and $u = \sin(t s)$, $t = 0.16 - \rho$, $s = 0.01 - \rho$, $\rho$ the
# squared distance from the centre: one solution for all weights, with the source $-\Delta u$. It is a trap for weights that
# are products: $u$ is the product $t s$ to six digits, and spline R-functions of bidegree 1 and 2 (group 1) *are* the product
# inside, as is the default; their $\psi$ is nearly constant and the errors say nothing about the weight. $R_0$ and
# bidegree 3 have the orders $k + 1$.


# %%
def sine(x, y):
    rho = (x - 0.5) ** 2 + (y - 0.5) ** 2
    return sin((0.16 - rho) * (0.01 - rho))


def annulus_errors(weight, k, spacings):
    ring = disk((0.5, 0.5), 0.4) - disk((0.5, 0.5), 0.1)
    problem = Problem(ring, Poisson(source=None), (Dirichlet(ring.part("all"), 0.0),), sine)
    found = []
    for h in spacings:
        solution = ritz.solve(problem, Discretization(degree=k, spacing=h, weight=weight))
        found.append(error_norms(solution.trial, sine, solution.background).l2)
    return np.array(found)


spacings = 0.5 ** np.arange(3, 7)
example = {
    f"k = {k}, {weight}": annulus_errors(weight, k, spacings)
    for k in (1, 2, 3)
    for weight in (f"spline{k}", "r0", "auto")
}
table("Example 4.1, relative L2 error", example, spacings)

# %%
fig, ax = plt.subplots(figsize=(6, 4))
plot(ax, example, spacings, "Example 4.1, relative error in $L_2$")

# %% [markdown]
# ## An intersection
#
# The lens of two unit disks. Inside, both arguments are positive and the weight is one polynomial of them. The table down
# to $h = 2^{-8}$ is written by `benchmarks/spline_weights.py`.

# %%
one, other = disk((0, 0), 1.0), disk((0.8, 0), 1.0)
lens = one & other
spacings = 0.5 ** np.arange(1, 6)
own = {}
for k in (1, 2, 3):
    for weight in (f"spline{k}", "r0", "auto"):
        own[f"k = {k}, {weight}"] = errors(lens, weight, k, spacings)

table("lens, relative L2 error", {name: e[0] for name, e in own.items()}, spacings)
print()
table("lens, relative H1 error", {name: e[1] for name, e in own.items()}, spacings)

# %%
fig, axes = plt.subplots(1, 2, figsize=(10, 4))
for ax, i, norm in zip(axes, (0, 1), ("L_2", "H^1"), strict=True):
    plot(ax, {name: e[i] for name, e in own.items()}, spacings, f"lens, relative error in ${norm}$")
fig.tight_layout()


# %% [markdown]
# The same solution for all weights is a harder test: $u = f_1 f_2\, g$ is smooth, but $\psi = u/w$ is only where the weight
# divides it. Group 1 of bidegrees 1 and 2 is $c f_1 f_2$ inside, the product itself, and keeps its order. Bidegree 3 has
# to vanish at the corners to third order, so $\psi$ is unbounded there and the errors are worse than those of $R_0$,
# which vanishes to first order: the default remains the better weight where the solution is not made for it.


# %%
def smooth(x, y):
    return (1 - x * x - y * y) * (1 - (x - 0.8) ** 2 - y * y) * generic(x, y)


same = {}
for k in (1, 2, 3):
    for weight in (f"spline{k}", "r0", "auto"):
        same[f"k = {k}, {weight}"] = errors(lens, weight, k, spacings, exact=smooth)[0]
table("lens, one solution, L2 error", same, spacings)

# %% [markdown]
# ## A union, with all six groups
#
# Two overlapping disks. Across the arcs inside the union the weights are piecewise: bidegree $k$ is $C^{k-1}$ there, $R_0$
# is smooth. All groups have the order $k + 1$; they differ by little, the default is $R_0$ here. The bound 2 scales the
# disks' functions, which lie between $-2$ and $1/2$ in the box.

# %%
union = one | other
spacings = 0.5 ** np.arange(2, 5)
groups = {
    f"k = {k}, group {group}": errors(union, f"spline{k}:group{group}:bound2", k, spacings)[0]
    for k in (1, 2, 3)
    for group in range(1, 7)
}
groups |= {f"k = {k}, r0 = default": errors(union, "r0", k, spacings)[0] for k in (1, 2, 3)}
table("union, relative L2 error", groups, spacings)

# %%
fig, axes = plt.subplots(1, 3, figsize=(12, 4), sharey=True)
for ax, k in zip(axes, (1, 2, 3), strict=True):
    plot(
        ax, {name[7:]: e for name, e in groups.items() if name.startswith(f"k = {k}")}, spacings, f"$k = {k}$"
    )
fig.tight_layout()

# %% [markdown]
# ## An iterated shape
#
# The union, cut by a rectangle, with a hole: the weight is the R-function of the whole expression. With the ordinates
# in $[-1, 1]$ the values stay there, so the operations can be iterated without new scaling.

# %%
spacings = 0.5 ** np.arange(2, 6)
plate = (union & rectangle(min=(-0.8, -0.7), max=(1.6, 0.8))) - disk((0.4, 0.1), 0.25)
iterated = {
    f"k = {k}, {weight}": errors(plate, weight.format(k=k), k, spacings)[0]
    for k in (1, 2, 3)
    for weight in ("spline{k}", "spline{k}:group5:bound2", "r0", "auto")
}
table("iterated shape, relative L2 error", iterated, spacings)

# %%
x, y = np.meshgrid(np.linspace(-0.8, 1.6, 300), np.linspace(-0.7, 0.8, 200))
fig, axes = plt.subplots(1, 3, figsize=(12, 3), sharey=True)
for ax, weight in zip(axes, ("spline2", "r0", "auto"), strict=True):
    w = weight_of(plate, plate.part("all"), weight)(x, y)
    w = np.where(plate.membership(x, y) >= 0, w, np.nan)
    ax.contourf(x, y, w, levels=np.nanmax(w) * np.linspace(0, 1, 13))
    ax.set(title=weight, aspect="equal")
fig.tight_layout()

# %% [markdown]
# ## A union in space

# %%
solid = ball((0, 0, 0), 1.0) | ball((0.8, 0, 0), 1.0)
spacings = np.array([1 / 2, 1 / 4, 1 / 8])
space = {
    f"k = {k}, {weight}": errors(solid, weight, k, spacings)[0]
    for k in (1, 2, 3)
    for weight in (f"spline{k}", "r0")
}
table("two balls, relative L2 error", space, spacings)
