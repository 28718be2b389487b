"""Every psi satisfies the flux conditions: residuals on every part, to rounding."""

from __future__ import annotations

import numpy as np
import pytest

from rfm.calculus.functions import cos, exp, sin
from rfm.calculus.jets import partials
from rfm.geometry import ball, disk, polygon, rectangle
from rfm.geometry.distance import distance
from rfm.geometry.weight import weight
from structures.catalogue import traces
from structures.catalogue.entry import OnBoundary
from structures.catalogue.plate_conditions import Moment, Shear
from structures.catalogue.rule import Site, even
from structures.catalogue.scalar_conditions import AnisotropicFlux, Flux, Oblique
from structures.catalogue.vector_conditions import TangentialTraction, Traction
from structures.contact import boundary_points
from structures.field_expression import ONE, Constant, field
from structures.jet_matrix import evaluate_all
from structures.localized import Bell, localized, supplemented, window
from structures.operator import known, unknown


def random_psi(seed, dimension=2):
    rng = np.random.default_rng(seed)
    a, b = rng.normal(size=(2, dimension))
    c, k, phase = rng.normal(size=(3, 3))

    def psi(*xs):
        t = sum(u * x for u, x in zip(a, xs, strict=True))
        s = sum(u * x for u, x in zip(b, xs, strict=True))
        return c[0] + t * (c[1] + s * (c[2] + t)) + sum(sin(k[i] * t + phase[i] * s) for i in range(3))

    return psi


def flux_data(*xs):
    return exp(0.3 * xs[0]) * cos(2 * xs[1]) + 0.2


def conductivity(*xs):
    return 1.5 + 0.4 * xs[0] * xs[1]


def jets(ops, points, seed):
    """Values and gradients ``(components, d + 1, n)`` of a structure with random psi's."""
    coords, dimension = tuple(points.T), points.shape[1]
    psis = sorted({m for op in ops for m in op.unknowns})
    found = []
    for matrix in evaluate_all(ops, coords, 1):
        order = matrix.order + matrix.operator_order
        found.append(
            matrix.apply({m: partials(random_psi(seed + m, dimension), coords, order) for m in psis})
        )
    return np.array(found)


def seeds_of(domain, count=1500):
    rng = np.random.default_rng(0)
    low, high = np.array(domain.box.lower), np.array(domain.box.upper)
    return low + rng.random((count, domain.dimension)) * (high - low)


def points_and_normals(domain, part):
    """Points of a part, away from its ends, and outward normals."""
    points = boundary_points(domain, part, seeds_of(domain))
    assert len(points) > 100
    slopes = partials(distance(domain, part), tuple(points.T), 1)[1:]
    return points, -slopes / np.sqrt((slopes**2).sum(axis=0))


ANNULUS = disk(center=(0.5, 0.5), radius=0.4).named("o") - disk(center=(0.5, 0.5), radius=0.1).named("i")
SHELL = ball(center=(0, 0, 0), radius=1.0).named("o") - ball(center=(0, 0, 0), radius=0.4).named("i")
PLATE = rectangle(min=(0, 0), max=(1.2, 1)).named("r")
KITE = polygon(vertices=[(0, 0), (1, -0.2), (1.4, 0.9), (0.3, 0.8)]).named("k")


def mixed(domain, essential, fluxes, length=0.1):
    """Structure with the value `flux_data` on some parts, and one flux condition on each of the others."""
    dimension = domain.dimension
    w0 = field(weight(domain, domain.part(essential)))
    ua = known(dimension, flux_data) + w0 * unknown(dimension, 0)
    names = [essential, *(name for name, _ in fluxes)]
    ws = {name: field(distance(domain, domain.part(name))) for name in names}
    sites = [Site.of(ws[name], [Flux(flux_data, conductivity, h)]) for name, h in fluxes]
    windows = [window(ws[name], length, [(ws[j], 2) for j in names if j != name]) for name, _ in fluxes]
    return localized([ua], sites, windows)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(
    ("domain", "essential", "fluxes"),
    [
        (ANNULUS, "i", [("o", 0.0)]),
        (ANNULUS, "o", [("i", 2.0)]),
        (SHELL, "i", [("o", lambda x, y, z: 1 + x * z)]),
        (PLATE, "r.left", [("r.bottom", 0.0), ("r.right", lambda x, y: 2 + y), ("r.top", -1.0)]),
        (KITE, "k.edge1", [("k.edge0", 0.0), ("k.edge2", 3.0), ("k.edge3", 0.0)]),
    ],
    ids=["annulus", "inside out", "shell", "rectangle", "kite"],
)
def test_conditions_hold_for_every_psi(domain, essential, fluxes, seed):
    ops = mixed(domain, essential, fluxes)
    points, _ = points_and_normals(domain, domain.part(essential))
    values = jets(ops, points, seed)[0, 0]
    assert np.abs(values - flux_data(*points.T)).max() < 1e-12
    for name, h in fluxes:
        points, normals = points_and_normals(domain, domain.part(name))
        u = jets(ops, points, seed)[0]
        coefficient = h(*points.T) if callable(h) else h
        left = conductivity(*points.T) * (u[1:] * normals).sum(axis=0) + coefficient * u[0]
        assert np.abs(left - flux_data(*points.T)).max() < 1e-10 * np.abs(u).max()


@pytest.mark.parametrize("seed", range(3))
def test_oblique_derivative(seed):
    part, direction = ANNULUS.part("o"), (lambda x, y: x + 0.3, lambda x, y: y + 0.1 * x)
    w = field(distance(ANNULUS, part))
    site = Site.of(w, [Oblique(flux_data, direction, 0.7)])
    ops = localized([unknown(2, 0)], [site], [window(w, 0.1)])
    points, _ = points_and_normals(ANNULUS, part)
    u = jets(ops, points, seed)[0]
    left = sum(b(*points.T) * slope for b, slope in zip(direction, u[1:], strict=True)) + 0.7 * u[0]
    assert np.abs(left - flux_data(*points.T)).max() < 1e-11 * np.abs(u).max()


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(("domain", "name"), [(ANNULUS, "o"), (PLATE, "r.top"), (SHELL, "i")])
def test_traction(domain, name, seed):
    dimension, lam, mu = domain.dimension, 1.3, field(conductivity)
    part = domain.part(name)
    w = field(distance(domain, part))
    wanted = [field(flux_data) * (1.0 + k) for k in range(dimension)]
    site = Site.of(w, [Traction(tuple(wanted), (lam * ONE, mu))])
    ops = localized([unknown(dimension, k) for k in range(dimension)], [site], [window(w, 0.1)])
    assert len({m for op in ops for m in op.unknowns}) == 2 * dimension
    points, n = points_and_normals(domain, part)
    u = jets(ops, points, seed)
    slopes = u[:, 1:]  # slopes[i, j] = d_j u_i
    shear = conductivity(*points.T)
    stress = shear * (slopes + slopes.swapaxes(0, 1))
    stress = stress + lam * np.eye(dimension)[:, :, None] * np.trace(slopes)
    left = np.einsum("ijn,jn->in", stress, n)
    right = np.stack([t(*points.T) for t in wanted])
    assert np.abs(left - right).max() < 1e-10 * np.abs(u).max()


def test_window_is_one_on_its_part_and_zero_on_the_others():
    left, bottom = (field(distance(PLATE, PLATE.part(f"r.{name}"))) for name in ("left", "bottom"))
    x = window(left, 0.2, [(bottom, 2)])
    t = np.linspace(0.01, 0.9, 20)
    own, other = partials(x, (0 * t, t), 1), partials(x, (t, 0 * t), 1)
    assert np.abs(own[0] - 1).max() < 1e-14
    assert np.abs(own[1:]).max() < 1e-12
    assert np.abs(other[:2]).max() < 1e-14
    assert np.abs(other[2]).max() < 1e-14
    assert np.isfinite(partials(x, (np.zeros(1), np.zeros(1)), 1)).all()


def test_window_spares_a_moment_or_a_shear_force():
    left, bottom = (field(distance(PLATE, PLATE.part(f"r.{name}"))) for name in ("left", "bottom"))
    x = window(left, 0.2, [(bottom, even(4))])
    t = np.linspace(0.01, 0.9, 20)
    own, other = partials(x, (0 * t, t), 3), partials(x, (t, 0 * t), 3)
    assert np.abs(own[0] - 1).max() < 1e-14
    assert np.abs(own[1:]).max() < 1e-10
    assert np.abs(other).max() < 1e-14


def test_bell_is_flat_at_its_top():
    values = partials(Bell(0.5), (np.array([0.0, 2.0]),), 3)
    assert values[0, 0] == 1.0
    assert np.abs(values[1:, 0]).max() == 0.0
    assert values[0, 1] < 1e-100


def test_no_conditions_change_nothing():
    u = known(2, Constant(1.0)) + unknown(2, 0)
    assert localized([u], [], []) == (u,)


@pytest.mark.parametrize("seed", range(2))
def test_moment_and_shear_meet_other_conditions_at_corners(seed):
    """Clamped left, supported at the bottom, free on the right and on top: all hold for every psi."""
    nu, length = 0.3, 0.3
    parts = {name: PLATE.part(f"r.{name}") for name in ("left", "bottom", "right", "top")}
    ws = {name: field(distance(PLATE, part)) for name, part in parts.items()}
    ua = known(2, flux_data) * 0.0 + ws["left"] ** 2 * ws["bottom"] * unknown(2, 0)
    free = [Moment(flux_data, nu, 2.0), Shear(conductivity, nu, 2.0)]
    sites = {
        "left": Site(ws["left"], (), 2),
        "bottom": Site.of(ws["bottom"], [Moment(conductivity, nu, 2.0)], {0: 1}),
        "right": Site.of(ws["right"], free),
        "top": Site.of(ws["top"], free),
    }
    active = [name for name, site in sites.items() if site.conditions]
    windows = [
        window(ws[m], length, [(ws[j], even(site.kept)) for j, site in sites.items() if j != m])
        for m in active
    ]
    u = localized([ua], [sites[m] for m in active], windows)
    checks = [
        (parts["left"], traces.value(0.0)),
        (parts["left"], traces.flux(0.0)),
        (parts["bottom"], traces.value(0.0)),
        (parts["bottom"], traces.moment(conductivity, nu, 2.0)),
    ]
    for name in ("right", "top"):
        checks += [
            (parts[name], traces.moment(flux_data, nu, 2.0)),
            (parts[name], traces.shear(conductivity, nu, 2.0)),
        ]
    assert max(OnBoundary(PLATE, u, checks).residual(seed).values()) < 1e-10


def test_supported_edge_takes_first_derivatives_only():
    w = field(distance(ANNULUS, ANNULUS.part("o")))
    site = Site.of(w, [Moment(flux_data, 0.3)], {0: 1})
    u = localized([known(2, flux_data) + w * unknown(2, 0)], [site], [window(w, 0.2)])
    assert u[0].order == 1
    part = ANNULUS.part("o")
    checks = [(part, traces.value(flux_data)), (part, traces.moment(flux_data, 0.3))]
    assert max(OnBoundary(ANNULUS, u, checks).residual(1).values()) < 1e-10
    plain = localized([w * unknown(2, 0)], [Site.of(w, [Moment(flux_data, 0.3)])], [window(w, 0.2)])
    assert plain[0].order == 2


def test_anisotropic_flux():
    part, k = SHELL.part("o"), ((2.0, 0.5, 0.0), (0.5, 1.0, -0.2), (0.0, -0.2, 1.5))
    w = field(distance(SHELL, part))
    u = localized([unknown(3, 0)], [Site.of(w, [AnisotropicFlux(flux_data, k)])], [window(w, 0.2)])
    assert max(OnBoundary(SHELL, u, [(part, traces.conormal(flux_data, k))]).residual(0).values()) < 1e-10


@pytest.mark.parametrize(("domain", "name"), [(ANNULUS, "o"), (SHELL, "i")])
def test_tangential_traction(domain, name):
    d, part, lame = domain.dimension, domain.part(name), (1.3, 0.8)
    w = field(distance(domain, part))
    wanted = tuple(field(flux_data) * (1.0 + k) for k in range(d))
    site = Site.of(w, [TangentialTraction(wanted, lame)])
    assert supplemented(site) == tuple(range(d))
    u = localized([unknown(d, k) for k in range(d)], [site], [window(w, 0.2)])
    checks = [(part, traces.tangential_traction(wanted, lame))]
    assert max(OnBoundary(domain, u, checks).residual(0).values()) < 1e-10


@pytest.mark.parametrize("name", ["k.edge0", "k.edge2"])
def test_traction_of_one_component_beside_a_held_one(name):
    """A roller, on a slanted edge: u_x is held, the traction along y is given."""
    part, lame = KITE.part(name), (1.3, 0.8)
    w = field(distance(KITE, part))
    site = Site.of(w, [Traction((None, flux_data), lame)], {0: 1})
    assert supplemented(site) == (1,)
    u = localized([known(2, conductivity) + w * unknown(2, 0), unknown(2, 1)], [site], [window(w, 0.2)])
    checks = [(part, traces.value(conductivity)), (part, traces.traction((None, flux_data), lame))]
    assert max(OnBoundary(KITE, u, checks).residual(0).values()) < 1e-10
