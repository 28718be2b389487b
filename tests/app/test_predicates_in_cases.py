"""Predicates, products, systems and weight forms in case files: what works and the exact place of what does not."""

from __future__ import annotations

import json

import numpy as np
import pytest
from typer.testing import CliRunner

from rfm.app.build import build_domain
from rfm.app.case import load_case
from rfm.app.cli.application import app
from rfm.errors import CaseError

CASE = """\
rfm: 1
geometry:
  shapes:
    a: {disk: {center: [0, 0], radius: 1}}
    b: {disk: {center: [0.8, 0], radius: 0.7}}
  domain: a ^ b
equation: {poisson: {source: 1}}
boundary_conditions:
  - {on: all, dirichlet: 0}
discretization: {degree: 2, grid: 12}
"""
SOLID = """\
rfm: 1
geometry:
  shapes:
    a: {disk: {center: [0, 0], radius: 1}}
    h: {interval: {min: 0, max: 2}}
  domain: a @ h
equation: {poisson: {source: z}}
boundary_conditions:
  - {on: [a, h.top], dirichlet: 0}
  - {on: h.bottom, neumann: 1}
discretization: {degree: 2, grid: 6}
"""


def check(tmp_path, text):
    file = tmp_path / "case.yaml"
    file.write_text(text)
    return CliRunner().invoke(app, ["check", str(file), "--json"])


def test_check_reports_on_the_function(tmp_path):
    found = json.loads(check(tmp_path, CASE).stdout)
    assert found["inversion_degree"] == 1
    assert found["function"][0] == "3 R-functions of 2 surfaces, inversion degree 1"
    assert "keeps every order" in found["function"][1]
    named = json.loads(
        check(tmp_path, CASE.replace("domain: a ^ b", "domain: a ^ b\n  membership: rp4")).stdout
    )
    assert "keeps order 3" in named["function"][1]


def test_a_product_is_solid(tmp_path):
    found = json.loads(check(tmp_path, SOLID).stdout)
    assert found["dimension"] == 3
    assert found["parts"] == ["a", "h", "h.bottom", "h.top"]


def domain_of(tmp_path, text):
    file = tmp_path / "case.yaml"
    file.write_text(text)
    return build_domain(load_case(file))


def test_systems_change_values_only(tmp_path):
    points = np.random.default_rng(0).uniform(-1.5, 1.6, (500, 2))
    plain = domain_of(tmp_path, CASE)
    texts = ("rp4(a ^ b)", "spline2:group3(a) ^ r0(a & b) ^ a", "ralpha0.5(iff(~a, b)) & ~(a & b)")
    for text in texts:
        domain = domain_of(tmp_path, CASE.replace("a ^ b", text))
        np.testing.assert_array_equal(domain.contains(points), domain.sign(*points.T) > 0)
    smooth = domain_of(tmp_path, CASE.replace("domain: a ^ b", "domain: a ^ b\n  membership: r0"))
    np.testing.assert_array_equal(smooth.contains(points), plain.contains(points))
    assert np.abs(smooth.membership(*points.T) - plain.membership(*points.T)).max() > 0.1
    marked = domain_of(tmp_path, CASE.replace("a ^ b", "rp4(a ^ b)"))
    np.testing.assert_allclose(marked.membership(*points.T), plain.using("rp4").membership(*points.T))


WRONG = [
    (CASE, "a ^ b", "a ^ b & rp3(a)", "6:19", "geometry.domain: R_p needs an even p >= 2, got 3"),
    (CASE, "a ^ b", "ralpha1.5(a ^ b)", "6:11", "-1 < alpha < 1, got 1.5"),
    (CASE, "a ^ b", "rq4(a ^ b)", "6:11", "'rq4' is neither implies, iff nor a system of R-functions"),
    (CASE, "a ^ b", "implies(a ^ b)", "6:11", "implies takes two shapes, as in implies(a, b)"),
    (CASE, "a ^ b", "a & b & ~a", "6:11", "the predicate a & b & ~a holds nowhere: there is no boundary"),
    (
        CASE,
        "a ^ b",
        "a @ b",
        "6:11",
        "a product of shapes of dimension 2 and 2 has more than three dimensions",
    ),
    (CASE, "a ^ b", "a ^ b\n  membership: best", "7:15", "geometry.membership: unknown name 'best'"),
    (CASE, "a ^ b", "a ^ b\n  membership: rp5", "7:15", "R_p needs an even p >= 2, got 5"),
    (CASE, "grid: 12", "weight: plateau", "10:37", "the weight plateau needs delta"),
    (CASE, "grid: 12", "weight: plateau:delta0", "10:37", "delta must be positive, got 0"),
    (CASE, "grid: 12", "weight: plateau:delta1:gamma0.5", "10:37", "gamma must be at least 1, got 0.5"),
    (CASE, "grid: 12", "weight: rp3", "10:37", "R_p needs an even p >= 2, got 3"),
    (CASE, "grid: 12", "weight: ralpha-1", "10:37", "R_alpha needs -1 < alpha < 1, got -1"),
    (SOLID, "a @ h", "a ^ h", "5:9", "interval is one-dimensional, the other shapes are two-dimensional"),
    (
        SOLID,
        "a @ h",
        "a @ h ^ a",
        "6:11",
        "shapes of dimension 3 and 2 cannot be combined (only multiplied, by @)",
    ),
    (SOLID, "[0, 0], radius", "[0, 0, 0], radius", "4:24", "must have 2 components"),
    (SOLID, "max: 2", "max: 0", "5:33", "must exceed min, got 0 and min 0"),
]


@pytest.mark.parametrize(("case", "old", "new", "place", "words"), WRONG)
def test_mistakes(tmp_path, case, old, new, place, words):
    assert case.count(old) == 1
    result = check(tmp_path, case.replace(old, new))
    assert result.exit_code == 2
    assert f"case.yaml:{place}: " in result.stderr, result.stderr
    assert words in result.stderr.replace("\n", " ")


def test_an_interval_alone_is_no_domain(tmp_path):
    text = SOLID.replace("    a: {disk: {center: [0, 0], radius: 1}}\n", "").replace("a @ h", "h")
    with pytest.raises(CaseError, match="the domain is one-dimensional; multiply it: disk @ interval"):
        domain_of(tmp_path, text)
