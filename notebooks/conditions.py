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
# # Which conditions belong into the structure?
#
# A solution structure can satisfy every boundary condition, or only the essential ones and leave fluxes to the functional.
# An annulus with $u = g$ on the inner circle, $\partial u / \partial n = \varphi$ on the outer one and a smooth solution shows
# what each choice costs: errors, condition numbers and flux residuals of
#
# 1. `natural`: $u = g + w_1 \psi$, the flux through the functional (the default),
# 2. `exact`: the flux in a collar of few cells along its part ([docs/structures.md](../docs/structures.md)),
# 3. (7.15) of Shapiro, *Acta Numerica* 2007, with one $\psi$: the flux by a structure that contains $w_2 D\psi$ on all of the domain,
# 4. the same with a second $\psi_2$ that makes it complete (the general rule of the catalogue, whose weights are squares),
#
# and, with $u$ given on both circles, Ritz' method against least squares. A picture of Example 7.1 ends it.

# %%
import matplotlib.pyplot as plt
import numpy as np

from rfm.calculus.functions import exp, sin
from rfm.calculus.jets import partials
from rfm.geometry import disk
from solvers.background import prepare
from solvers.block_assembly import BlockAssembler
from solvers.equations.poisson import Poisson
from solvers.least_squares import LeastSquares
from solvers.linear.condition import condition_number
from solvers.modes import mode_of
from solvers.norms import boundary_errors, error_norms
from solvers.pipeline import Assembly
from solvers.problem import FROM_EXACT, Dirichlet, Discretization, Neumann, Problem, SolverOptions
from solvers.ritz import Ritz
from solvers.setting import Region, Setting
from solvers.solution import Trial
from solvers.stopwatch import Stopwatch
from structures.catalogue.mixed import mixed, mixed_published
from structures.features import normalised
from structures.field_expression import field
from structures.manufactured import generic_field
from structures.operator import D, known
from structures.taylor_example import CENTER, RADIUS, taylor_example

outer, inner = disk(center=(0.5, 0.5), radius=0.4), disk(center=(0.5, 0.5), radius=0.1)
annulus = outer.named("outer") - inner.named("inner")


def data(x, y):
    return 1 + 0.5 * x - y


def exact(x, y):
    return data(x, y) + 4 * ((x - 0.5) ** 2 + (y - 0.5) ** 2 - 0.01) * exp(x) * sin(3 * y)


mixed_problem = Problem(
    annulus,
    Poisson(source=None),
    (Dirichlet(annulus.part("inner"), data), Neumann(annulus.part("outer"), FROM_EXACT)),
    exact,
)
value_problem = Problem(annulus, Poisson(source=None), (Dirichlet(annulus.part("all"), FROM_EXACT),), exact)

# %% [markdown]
# The two published structures are not a mode of the program, but the catalogue has them, and the pieces of the pipeline take
# any structure. The flux data are the exact flux *on* the circle, extended by something else: an extension with the true
# derivatives would make the correction vanish for the exact solution, and the test void. (The program's modes do the same, and
# extend the values on both circles generically too, so that `values only` has another $\psi$ to find than the mixed problem.)

# %%
w1, w2 = (field(normalised(annulus, annulus.part(name), 1)) for name in ("inner", "outer"))
flux = -D(w2, known(2, field(exact))).offset + w2 * generic_field(annulus.box)
one_psi = mixed_published(w1, w2, 2, data, flux)
two_psi = mixed(w1, w2, 2, data, flux)


def by_mode(conditions):
    """Structure, spaces and rules of a mode of the program."""

    def setting(problem, discretization, background):
        return mode_of(discretization).setting(problem, discretization, background)

    return conditions, setting


def by_structure(operator):
    """The same for any structure: all of its splines in the one space, everywhere."""

    def setting(problem, discretization, background):
        count = len({term.psi for term in operator.terms})
        return Setting((operator,), (background.space,) * count, (Region((operator,), background),))

    return "natural", setting


def solve(problem, method, kind, degree, grid, functional=None):
    """Relative L2 error, condition number of the scaled matrix, largest flux residual (nan: no flux), unknowns.

    `functional` is the problem whose functional is assembled, when that is not `problem` itself.
    """
    conditions, setting_of = kind
    discretization = Discretization(degree=degree, grid=grid, conditions=conditions)
    watch = Stopwatch()
    background = prepare(annulus, discretization, watch)
    setting = setting_of(problem, discretization, background)
    assembler = BlockAssembler(setting.spaces, method.symmetric(problem))
    parts = setting.structure, background, setting.regions
    system = method.system(Assembly(assembler, functional or problem, method, *parts), watch)
    linear = system.solve(SolverOptions(), None)
    trial = Trial(setting.structure, assembler.functions(linear.x))
    return {
        "error": error_norms(trial, exact, background).l2,
        "condition": condition_number(system.matrix, system.load),
        "flux": boundary_errors(problem, trial, background).get("outer", np.nan),
        "unknowns": len(linear.x),
    }


# %%
kinds = {
    "natural": (mixed_problem, Ritz(), by_mode("natural")),
    "exact, in collars": (mixed_problem, Ritz(), by_mode("exact")),
    "(7.15), one psi": (mixed_problem, Ritz(), by_structure(one_psi)),
    "(7.15) with psi2": (mixed_problem, Ritz(), by_structure(two_psi)),
    "values only, Ritz": (value_problem, Ritz(), by_mode("natural")),
    "values only, least squares": (value_problem, LeastSquares(), by_mode("natural")),
}
grids = {3: [8, 16, 32, 48, 64], 4: [8, 16, 24, 32]}
results = {(name, p): [solve(*kind, p, n) for n in grids[p]] for name, kind in kinds.items() for p in grids}


def column(name, p, key):
    return np.array([one[key] for one in results[name, p]])


def slope(p, values):
    """Observed exponent of the spacing over the last refinement."""
    return -np.log(values[-1] / values[-2]) / np.log(grids[p][-1] / grids[p][-2])


for p, cells in grids.items():
    print(f"p = {p}: relative L2 error on N cells across; on the finest grid order, condition, ...")
    print(
        f"{'':27}", "".join(f"{f'N = {n}':>9}" for n in cells), "  order  condition  flux residual  unknowns"
    )
    for name in kinds:
        error, last = column(name, p, "error"), results[name, p][-1]
        residual = "-" if np.isnan(last["flux"]) else f"{last['flux']:.0e}"
        print(f"{name:27}", "".join(f"{e:9.1e}" for e in error), end="")
        print(f"{slope(p, error):8.1f}{last['condition']:11.0e}{residual:>15}{last['unknowns']:10d}")
    print()

# %% [markdown]
# Condition numbers, and the exponent of $1/h$ with which they grow over the last refinement:

# %%
for p, cells in grids.items():
    print(f"p = {p}{'':22}", "".join(f"{f'N = {n}':>9}" for n in cells), "  growth")
    for name in kinds:
        condition = column(name, p, "condition")
        print(f"{name:27}", "".join(f"{c:9.0e}" for c in condition), f"{-slope(p, condition):8.1f}")
    print()

# %%
fig, axes = plt.subplots(1, 2, figsize=(12, 4.5))
titles = {"error": "relative error in $L_2$", "condition": "condition number"}
for ax, (key, title) in zip(axes, titles.items(), strict=True):
    for name in kinds:
        ax.loglog(grids[3], column(name, 3, key), "o-", label=name)
    ax.set(xlabel="cells across", title=f"{title}, $p = 3$")
    ax.grid(True, which="both", alpha=0.3)
axes[0].legend(fontsize="small")
fig.tight_layout()

# %% [markdown]
# What is seen:
#
# - `natural` has the full order $p + 1$ and the condition number of a pure Dirichlet problem, give or take a digit. Its flux
#   residual is small, but not zero.
# - `exact` has every condition to rounding and a smaller error. It pays with more unknowns and a larger condition
#   number, which stays where it is as the grid is refined.
# - (7.15) with one $\psi$ has every condition to rounding too, but a larger error, loses an order as the grid is refined, and has a condition
#   number that grows quickly: it contains $w_2 D\psi$ on all of the domain.
# - $\psi_2$ gives most of the order back and takes the condition number near the end of double precision.
# - Least squares is as accurate as Ritz' method where $u$ is given everywhere; its condition number grows faster, as that of
#   an operator of fourth order does.
#
# Hence the defaults: essential conditions by structure, fluxes by the functional, Ritz' method; and collars, when
# all conditions are wanted to rounding.
#
# ## The functional keeps its boundary term
#
# A structure that satisfies the flux condition does not replace the term $\int_{\Gamma_2} \varphi u$ of the functional:
# the structure says what the flux is, the functional what work it does. Without the term:

# %%
without = Problem(annulus, mixed_problem.equation, mixed_problem.conditions[:1], exact)
print("p = 3, N = 32              with the term   without")
for name in ("exact, in collars", "(7.15), one psi", "(7.15) with psi2"):
    full, cut = (solve(*kinds[name], 3, 32, functional)["error"] for functional in (None, without))
    print(f"{name:27} {full:12.1e} {cut:9.1e}")

# %% [markdown]
# ## Two Taylor polynomials and their interpolant
#
# Conditions can also be met before there is any unknown. After Example 7.1: $P_1$ has value and normal derivative on the
# hole, $P_2$ has the value on the rim, and the transfinite interpolant (7.12) has both.

# %%
example = taylor_example()
fields = {"$P_1$: right on the hole": example.hole, "$P_2$: right on the rim": example.rim}
fields["interpolant: right on both"] = example.interpolant

x, y = np.meshgrid(np.linspace(-1, 1, 301), np.linspace(-1, 1, 301))
membership = example.domain.membership(x, y)
inside = np.where(membership >= 0, 1.0, np.nan)
shown = example.interpolant(x, y) * inside
levels = np.linspace(np.nanmin(shown), np.nanmax(shown), 25)
fig, axes = plt.subplots(1, 3, figsize=(12, 4), sharey=True, layout="constrained")
for ax, (name, f) in zip(axes, fields.items(), strict=True):
    filled = ax.contourf(x, y, f(x, y) * inside, levels=levels, extend="both")
    ax.contour(x, y, membership, levels=[0], colors="k")
    ax.set(title=name, aspect="equal")
bar = fig.colorbar(filled, ax=axes, shrink=0.8)
bar.set_label("colours of the interpolant")

# %% [markdown]
# How far the interpolant is from either on its part:

# %%
t = np.linspace(0, 2 * np.pi, 1000, endpoint=False)
normal = np.array([np.cos(t), np.sin(t)])
on_hole = np.array(CENTER)[:, None] + RADIUS * normal
s = np.linspace(-0.99, 0.99, 250)
one = np.ones_like(s)
on_rim = np.array([np.concatenate([s, s, -one, one]), np.concatenate([-one, one, s, s])])


def largest_gap(other, points):
    """Largest differences of value and of gradient."""
    gap = partials(example.interpolant, points, 1) - partials(other, points, 1)
    return np.abs(gap[0]).max(), np.linalg.norm(gap[1:], axis=0).max()


value, gradient = largest_gap(example.hole, on_hole)
print(f"hole: value {value:.0e}, gradient {gradient:.0e}")
value, gradient = largest_gap(example.rim, on_rim)
print(f"rim:  value {value:.0e}, gradient {gradient:.0e} (no slope is prescribed there)")
