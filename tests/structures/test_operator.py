"""Operator arithmetic against hand-written formulas and sympy; jet matrices against finite differences."""

from __future__ import annotations

import numpy as np
import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st

from rfm.calculus.functions import cos, exp, sin
from rfm.calculus.jets import multi_indices, partials
from rfm.errors import StructureError
from structures.field_expression import ONE, ZERO, Constant, field
from structures.jet_matrix import evaluate, evaluate_all
from structures.operator import D, differentiated, known, unknown

X, Y = sympy.symbols("x y")
POINTS = np.random.default_rng(7).random((2, 9))

w = field(lambda x, y: (1.0 - x * x - y * y) / 2.0)
phi = field(lambda x, y: exp(x) * y)
psi = unknown(2)
psi2 = unknown(2, 1)


def close(a, b, tolerance=1e-12):
    return a == pytest.approx(b, rel=tolerance, abs=tolerance)


def symbolic_partials(expression, order):
    values = []
    for i, j in multi_indices(2, order):
        f = sympy.lambdify((X, Y), sympy.diff(expression, X, i, Y, j), "numpy")
        values.append(np.broadcast_to(f(*POINTS), POINTS[0].shape))
    return np.array(values)


def test_mixed_structure_reads_like_the_paper():
    # Shapiro (2007), (7.13), against the formula written out by hand
    op = psi - w * D(w, psi) + w * phi + w**2 * psi2
    assert (op.order, op.unknowns) == (1, (0, 1))
    s = sympy
    ws, ps, p2 = (1 - X**2 - Y**2) / 2, s.sin(X + 2 * Y), X * Y**2
    slope = s.diff(ws, X) * s.diff(ps, X) + s.diff(ws, Y) * s.diff(ps, Y)
    u = ps - ws * slope + ws * s.exp(X) * Y + ws**2 * p2
    fields = {0: lambda x, y: sin(x + 2 * y), 1: lambda x, y: x * y * y}
    jet = evaluate(op, tuple(POINTS), 2)
    got = jet.apply({0: partials(fields[0], tuple(POINTS), 3), 1: partials(fields[1], tuple(POINTS), 3)})
    assert close(got, symbolic_partials(u, 2))
    assert close(partials(op.apply(fields), tuple(POINTS), 2), symbolic_partials(u, 2))


def test_neumann_structure_has_the_flux_on_the_boundary():
    # on w = 0 with unit normal derivative: du/dn = phi whatever psi is, u - (psi + w (phi - D psi)) = O(w^2)
    op = psi - w * D(w, psi) + w * phi
    angle = np.linspace(0, 6, 20)
    x, y = np.cos(angle), np.sin(angle)
    jet = evaluate(op, (x, y), 1).apply(partials(lambda x, y: sin(3 * x * y) + x, (x, y), 2))
    assert close(-x * jet[1] - y * jet[2], np.exp(x) * y)


def test_derivative_of_the_weight_structure():
    # D(w, u0 + w psi) = Dw psi + w D(psi) + D(u0)
    u0 = field(lambda x, y: x * y)
    op = D(w, u0 + w * psi)
    x, y = POINTS
    assert close(partials(op.coefficient(0, (0, 0)), (x, y), 0)[0], x**2 + y**2)
    assert close(partials(op.coefficient(0, (1, 0)), (x, y), 0)[0], -x * (1 - x**2 - y**2) / 2)
    assert close(partials(op.offset, (x, y), 0)[0], -2 * x * y)
    assert op.coefficient(1, (0, 0)) is ZERO


@pytest.mark.parametrize("order", [0, 1, 2, 3])
def test_jet_matrix_of_the_dirichlet_structure_is_leibniz(order):
    a = field(lambda x, y: sin(x) * y)
    jet = evaluate(phi + a * psi, tuple(POINTS), order)
    s = symbolic_partials(sympy.sin(X) * Y, order)
    indices = multi_indices(2, order)
    for row, beta in enumerate(indices):
        for column, gamma in enumerate(indices):
            rest = tuple(b - g for b, g in zip(beta, gamma, strict=True))
            inside = min(rest) >= 0
            factor = (
                np.prod([sympy.binomial(b, g) for b, g in zip(beta, gamma, strict=True)]) if inside else 0
            )
            wanted = float(factor) * s[indices.index(rest)] if inside else np.zeros(9)
            assert close(jet.blocks[0][row, column], wanted)


def test_pattern_of_the_dirichlet_structure():
    jet = evaluate(w * psi, tuple(POINTS), 1)
    assert jet.pattern == {0: {(0, 0), (1, 0), (2, 0), (1, 1), (2, 2)}}
    assert jet.entries[0][1, 1] is not None
    assert np.shares_memory(jet.entries[0][0, 0], jet.entries[0][1, 1])


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_jet_matrices_against_finite_differences(seed):
    rng = np.random.default_rng(seed)
    c = rng.normal(size=8)
    u0 = field(lambda x, y: sin(c[0] * x + c[1] * y))
    a = field(lambda x, y: exp(c[2] * x) * cos(c[3] * y))
    op = u0 + a * psi + D(a, w * psi)
    function = lambda x, y: c[4] * x**3 + c[5] * x * y + sin(c[6] * x + c[7] * y)  # noqa: E731
    x, y = rng.random((2, 4))
    h = 1e-4

    def value(x, y):
        return evaluate(op, (x, y), 0).apply(partials(function, (x, y), 1))[0]

    got = evaluate(op, (x, y), 1).apply(partials(function, (x, y), 2))
    assert got[0] == pytest.approx(value(x, y))
    scale = 1e-6 * max(1.0, np.abs(got).max())
    assert got[1] == pytest.approx((value(x + h, y) - value(x - h, y)) / (2 * h), rel=1e-5, abs=scale)
    assert got[2] == pytest.approx((value(x, y + h) - value(x, y - h)) / (2 * h), rel=1e-5, abs=scale)


def test_operators_are_a_module_over_fields():
    a, b = field(lambda x, y: x + y), field(lambda x, y: cos(x * y))
    left, right = psi + phi, D(w, psi) - 2.0
    pairs = [
        (a * (left + right), a * left + a * right),
        ((a + b) * left, a * left + b * left),
        (left - right, -(right - left)),
        ((a * b) * right, a * (b * right)),
        (left / b, (1 / b) * left),
        (np.float64(2.0) * left, left + left),
        (1.0 - left, -(left - 1.0)),
        (differentiated(a * psi, 0), psi + a * differentiated(psi, 0)),
    ]
    function = lambda x, y: sin(x + 3 * y)  # noqa: E731
    for one, two in pairs:
        values = [partials(op.apply(function), tuple(POINTS), 1) for op in (one, two)]
        assert close(values[0], values[1])


def test_in_space():
    f = field(lambda x, y, z: x * y + z * z)
    op = D(f, f * unknown(3))
    points = tuple(np.random.default_rng(0).random((3, 5)))
    function = lambda x, y, z: exp(x) * y - z**3  # noqa: E731
    got = evaluate(op, points, 1).apply(partials(function, points, 2))
    assert close(got, partials(op.apply(function), points, 1))


def test_components_share_evaluations():
    calls = []

    def counted(x, y):
        calls.append(1)
        return x * y

    g = field(counted)
    jets = evaluate_all([g * psi, g * psi2 + g * g], tuple(POINTS), 1)
    assert len(calls) == 1
    assert [set(jet.pattern) for jet in jets] == [{0}, {1}]


def test_points_of_any_shape():
    x, y = np.random.default_rng(0).random((2, 3, 4))
    jet = evaluate(w * psi, (x, y), 1)
    assert jet.blocks[0].shape == (3, 3, 3, 4)
    assert evaluate(w * psi, (x[:, :1], y[:1]), 1).offset.shape == (3, 3, 4)


def test_structural_zeros_and_ones_fold():
    f = field(lambda x, y: x)
    assert (0 * f) is ZERO
    assert (1 * f) is f
    assert (f + 0) is f
    assert (f**0) is ONE
    assert isinstance(field(2) * 3 - 1, Constant)
    assert (psi - psi).terms == ()
    assert (f * psi - f * psi).terms != ()  # equal formulas are not recognised as such
    assert (0.0 * psi).terms == ()


def test_what_is_not_affine_is_refused():
    with pytest.raises(StructureError, match="not affine"):
        _ = psi * psi
    with pytest.raises(StructureError, match="2 and 3 dimensions"):
        _ = psi + unknown(3)
    with pytest.raises(StructureError, match="mapping from index"):
        (psi + psi2).apply(phi)
    with pytest.raises(TypeError, match="callable"):
        field("x")
    assert (known(2, phi) * psi).order == 0
