"""The matrix applied cell by cell equals the assembled one; what a device cannot do is refused by name."""

from __future__ import annotations

import os
from dataclasses import replace

import numpy as np
import pytest

from rfm.errors import DiscretizationError, NumericsError
from rfm.geometry import disk
from solvers import pipeline
from solvers.device import backend
from solvers.device.blocks import whole
from solvers.device.contraction import PointTables, TensorTables
from solvers.device.extension import attached, extended, extension_arrays, restricted, sizes_of
from solvers.device.halo import Halo
from solvers.equations.elasticity import Elasticity
from solvers.equations.plate import Plate
from solvers.equations.poisson import Poisson
from solvers.linear.system import Indefinite, NotConverged, ScaledSystem
from solvers.method import refused
from solvers.methods import METHODS
from solvers.problem import (
    FROM_EXACT,
    Clamped,
    Dirichlet,
    Discretization,
    Inclusion,
    Neumann,
    Problem,
    SolverOptions,
    Traction,
)
from solvers.stopwatch import Stopwatch
from solvers.web import SplineSpace
from tests.solvers.methods_problems import ANNULUS, dirichlet, mixed, on_the_ball, smooth
from tests.solvers.synthetic import ball_states, to_array, unit_grid

os.environ.setdefault("XLA_FLAGS", "--xla_backend_optimization_level=0")  # programs that run once

RITZ = METHODS["ritz"]
CPU = SolverOptions(device="cpu")


@pytest.fixture(autouse=True)
def programs(monkeypatch, request):
    """Keep compiled programs with the caches of the tests, not of the user."""
    monkeypatch.setenv(backend.CACHE, str(request.config.cache.mkdir("jax")))


def elastic():
    conditions = (
        Dirichlet(ANNULUS.part("outer"), FROM_EXACT),
        Traction(ANNULUS.part("inner"), FROM_EXACT),
    )
    equation = Elasticity(model="plane_strain", young_modulus=lambda x, y: 2 + x, poisson_ratio=0.3)
    return Problem(ANNULUS, equation, conditions, exact=(smooth, lambda x, y: x * y))


def floating():
    flux = Neumann(ANNULUS.part("all"), FROM_EXACT)
    return Problem(ANNULUS, Poisson(source=None), (flux,), exact=smooth)


def plate():
    return Problem(
        ANNULUS, Plate(stiffness=1.0, poisson_ratio=0.3, load=1.0), (Clamped(ANNULUS.part("all")),)
    )


def system(problem, discretization, device):
    """Matrix, or what stands for it, and load."""
    watch = Stopwatch(None)
    mode = pipeline.mode_of(discretization)
    background = pipeline.prepare(problem.domain, mode.quadrature(problem, discretization), watch)
    setting = mode.setting(problem, discretization, background)
    assembler = pipeline.assembler_of(setting, True, SolverOptions(device=device))
    return pipeline.Assembly(assembler, problem, RITZ, setting.structure, background, setting.regions).run(
        watch
    )


MATRICES = [
    (mixed(conductivity=lambda x, y: 1 + x * y, reaction=2.0), Discretization(degree=2, grid=12)),
    (dirichlet(conductivity=lambda x, y: 1 + x * y), Discretization(degree=3, grid=12)),
    (dirichlet(), Discretization(degree=4, grid=12)),
    (dirichlet(), Discretization(degree=2, grid=12, moment_fitting=False)),
    (dirichlet(), Discretization(degree=2, grid=10, basis="b-spline")),
    (on_the_ball(), Discretization(degree=2, grid=6)),
    (elastic(), Discretization(degree=2, grid=12)),
    pytest.param(plate(), Discretization(degree=3, grid=12), marks=pytest.mark.slow),
]
NAMES = ["p2", "p3", "p4", "fine rules", "points", "ball", "elasticity", "plate"]


@pytest.mark.parametrize(("problem", "discretization"), MATRICES, ids=NAMES)
def test_products_are_those_of_the_assembled_matrix(problem, discretization):
    matrix, load = system(problem, discretization, "none")
    operator, again = system(problem, discretization, "cpu")
    np.testing.assert_allclose(again, load, atol=1e-14 * np.abs(load).max())
    vector = np.random.default_rng(0).standard_normal(len(load))
    image = matrix @ vector
    assert operator.shape == matrix.shape
    np.testing.assert_allclose(operator @ vector, image, atol=1e-12 * np.abs(image).max())
    ratio = operator.diagonal() / matrix.diagonal()
    assert (ratio > 0.2).all()
    assert (ratio < 20).all()
    prepared = pipeline.mode_of(discretization).quadrature(problem, discretization)
    space = pipeline.prepare(problem.domain, prepared, Stopwatch(None)).space
    single = np.diff(space.extension.tocsr().indptr) == 1  # no outer spline is attached
    np.testing.assert_allclose(ratio.reshape(-1, len(single))[:, single], 1.0, rtol=1e-12)
    assert single.any() or problem.domain.dimension == 3


@pytest.mark.parametrize("problem", [mixed(), elastic()], ids=["poisson", "elasticity"])
def test_solutions_agree(problem):
    discretization = Discretization(degree=2, grid=12)
    options = SolverOptions(linear="cg", tolerance=1e-13)
    assembled = pipeline.solve(problem, discretization, RITZ, options)
    found = pipeline.solve(problem, discretization, RITZ, SolverOptions(device="cpu", tolerance=1e-13))
    assert found.linear.method == "cg, matrix-free on cpu"
    assert found.linear.reason == f"{found.dofs} unknowns; device: cpu"
    assert found.linear.residual < 2e-13
    assert abs(found.linear.iterations - assembled.linear.iterations) < 0.2 * assembled.linear.iterations
    one, other = (s.trial.splines[0].coefficients for s in (found, assembled))
    np.testing.assert_allclose(one, other, atol=1e-10 * np.abs(other).max())
    points = np.random.default_rng(1).uniform((0.35, 0.6), (0.38, 0.63), (30, 2))
    np.testing.assert_allclose(
        found.u(points), assembled.u(points), atol=1e-12 * np.abs(found.u(points)).max()
    )


def test_only_flux_conditions():
    problem = floating()
    discretization = Discretization(degree=2, grid=12)
    assembled = pipeline.solve(problem, discretization, RITZ)
    found = pipeline.solve(problem, discretization, RITZ, CPU)
    points = np.array([[0.3, 0.5], [0.7, 0.6]])
    np.testing.assert_allclose(found.u(points), assembled.u(points), atol=1e-10)


def test_the_precision_outside_stays_what_it_was():
    import jax

    before = jax.config.jax_enable_x64
    with backend.computing("cpu") as device:
        assert jax.numpy.ones(1).dtype == np.float64
        assert device.platform == "cpu"
    assert jax.config.jax_enable_x64 == before
    assert jax.numpy.ones(1).dtype == (np.float64 if before else np.float32)


def test_the_folder_of_compiled_programs(monkeypatch, tmp_path):
    monkeypatch.setenv(backend.CACHE, str(tmp_path))
    assert backend.cache_folder() == tmp_path
    monkeypatch.delenv(backend.CACHE)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert backend.cache_folder() == tmp_path / "rfm" / "jax"


@pytest.mark.parametrize("basis", ["web-spline", "b-spline"])
def test_the_extension_and_its_transpose(basis):
    grid = unit_grid(7, 8)
    space = SplineSpace.build(grid, 2, ball_states(grid), basis)
    rng = np.random.default_rng(2)
    unknowns, full = rng.standard_normal((2, space.n_dofs)), rng.standard_normal((2, 90))
    local = Halo(space, whole(grid.shape)).local(0)
    place = np.arange(space.n_dofs, dtype=np.int32)
    sizes = sizes_of(attached(local, place)[0])
    with backend.computing("cpu"):
        arrays = extension_arrays(local, place, space.n_dofs, len(local.outer), sizes)
        wide, narrow = extended(arrays, unknowns), restricted(arrays, full)
    matrix = to_array(space.extension)
    np.testing.assert_allclose(wide, unknowns @ matrix, atol=1e-13)
    np.testing.assert_allclose(narrow, full @ matrix.T, atol=1e-13)


@pytest.mark.parametrize("dimension", [2, 3])
def test_contractions_on_points_and_on_tensor_nodes(dimension):
    """The same nodes as a tensor grid and as a list; the adjoint maps are transposes of the others."""
    rng, p, q, n = np.random.default_rng(3), 2, 3, 4
    lines = [rng.standard_normal((2, q, p + 1)) for _ in range(dimension)]
    where = np.indices((q,) * dimension).reshape(dimension, -1)
    listed = [np.repeat(line[:, at, :, None], n, axis=3) for line, at in zip(lines, where, strict=True)]
    kinds = [(0,) * dimension, (1,) + (0,) * (dimension - 1), (0,) * (dimension - 1) + (1,)]
    local = rng.standard_normal((2, *(p + 1,) * dimension, n))
    fields = {kind: rng.standard_normal((2, *(q,) * dimension, n)) for kind in kinds}
    with backend.computing("cpu"):
        tensor, points = TensorTables(tuple(map(np.asarray, lines))), PointTables(tuple(listed))
        one, other = tensor.values(local, kinds), points.values(local, kinds)
        back = tensor.adjoint(fields)
        again = points.adjoint({kind: field.reshape(2, -1, n) for kind, field in fields.items()})
    for kind in kinds:
        np.testing.assert_allclose(np.asarray(one[kind]).reshape(2, -1, n), other[kind], atol=1e-12)
    np.testing.assert_allclose(back, again, atol=1e-12)
    forward = sum(float((np.asarray(one[kind]) * fields[kind]).sum()) for kind in kinds)
    assert forward == pytest.approx(float((np.asarray(back) * local).sum()), rel=1e-12)


def test_an_energy_that_is_not_positive_is_refused():
    discretization = Discretization(degree=2, grid=12, moment_fitting=False)
    with pytest.raises(NumericsError, match="the matrix is not positive definite"):
        pipeline.solve(dirichlet(reaction=-1e3), discretization, RITZ, CPU)


def test_conjugate_gradients_that_do_not_converge():
    from solvers.device.conjugate_gradients import DeviceGradients

    operator, load = system(dirichlet(), Discretization(degree=2, grid=12), "cpu")
    with pytest.raises(NotConverged, match="in 3 iterations"):
        DeviceGradients(limit=3).solve(ScaledSystem.of(operator, load), 1e-12)
    negative = type(operator).__new__(type(operator))
    negative.__dict__.update(operator.__dict__)
    scaled = ScaledSystem.of(operator, load)
    flipped = [
        {**group, "chunks": {**group["chunks"], "coefficients": -group["chunks"]["coefficients"]}}
        for group in operator.arrays["groups"]
    ]
    negative.arrays = {**operator.arrays, "groups": flipped}
    with pytest.raises(Indefinite, match="negative curvature in iteration 0"):
        DeviceGradients().solve(replace(scaled, original=negative), 1e-12)


REFUSED = [
    (
        "galerkin",
        {},
        {},
        "device: cpu runs conjugate gradients on the matrix of an energy, which the method galerkin does not have: "
        "choose method: ritz, or device: none",
    ),
    ("least-squares", {}, {}, "which the method least-squares does not have"),
    ("ritz", {"basis": "legendre", "grid": 4}, {}, "overlap everywhere: choose basis: web-spline"),
    ("ritz", {"conditions": "exact", "degree": 3}, {}, "choose conditions: natural, or device: none"),
    ("ritz", {}, {"linear": "superlu"}, r"choose linear: cg \(or auto\), or device: none"),
    ("ritz", {}, {"shards": 0}, "shards must be a positive number, or all, got 0"),
    ("ritz", {}, {"shards": "most"}, "shards must be a positive number, or all, got 'most'"),
    ("ritz", {}, {"device": "none", "shards": 2}, "choose device: gpu or cpu, or remove shards"),
    ("ritz", {}, {"device": "tpu"}, "unknown device 'tpu': choose one of none, cpu, gpu"),
]


@pytest.mark.parametrize(("method", "given", "options", "message"), REFUSED)
def test_what_a_device_does_not_do(method, given, options, message):
    discretization = Discretization(**{"degree": 3, "grid": 8, **given})
    with pytest.raises(DiscretizationError, match=message):
        pipeline.solve(
            mixed(), discretization, METHODS[method], SolverOptions(**{"device": "cpu", **options})
        )


def test_the_residual_of_a_solution_is_that_of_its_product():
    from solvers.device.conjugate_gradients import DeviceGradients

    operator, load = system(dirichlet(), Discretization(degree=2, grid=12), "cpu")
    fresh, _ = system(dirichlet(), Discretization(degree=2, grid=12), "cpu")
    scaled = ScaledSystem.of(operator, load)
    x, _ = DeviceGradients().solve(scaled, 1e-10)
    solution, residual = scaled.unscale(x)
    np.testing.assert_allclose(operator @ solution, fresh @ solution, atol=1e-14 * np.abs(load).max())
    assert 0 < residual <= 1.1e-10
    np.testing.assert_allclose(
        operator @ (2 * solution), 2 * (fresh @ solution), atol=1e-12 * np.abs(load).max()
    )


def test_several_materials_are_refused():
    inclusion = Inclusion("core", disk(center=(0.7, 0.5), radius=0.1).named("core"), Poisson(0.0))
    problem = replace(dirichlet(), inclusions=(inclusion,))
    assert (
        "each material of the inclusions has its own" in refused(RITZ, problem, Discretization(), CPU).message
    )


def test_exact_conditions_without_a_flux_need_no_second_space():
    assert refused(RITZ, dirichlet(), Discretization(conditions="exact"), CPU) is None


def test_no_gpu_is_an_error_with_a_remedy(monkeypatch):
    import jax

    real = jax.devices

    def without_gpu(kind=None):
        """What JAX says on a machine without one."""
        if kind == "gpu":
            raise RuntimeError("unknown backend gpu")
        return real(kind)

    monkeypatch.setattr(jax, "devices", without_gpu)
    with pytest.raises(
        DiscretizationError, match=r"JAX finds no gpu here, only cpu: install JAX .* or choose device: cpu"
    ):
        pipeline.solve(mixed(), Discretization(degree=2, grid=8), RITZ, SolverOptions(device="gpu"))
