"""The case that the tests of studies vary."""

from rfm.app.source import from_text
from rfm.app.study.plan import make_plan

CASE = """\
rfm: 1
title: Annulus
parameters: {r: 0.1}
geometry:
  shapes:
    outer: {disk: {center: [0.5, 0.5], radius: 0.4}}
    inner: {disk: {center: [0.5, 0.5], radius: r}}
  domain: outer - inner
equation: {poisson: {source: from exact}}
boundary_conditions:
  - {on: all, dirichlet: from exact}
exact: exp(x)*sin(y)
discretization: {degree: 2, grid: 10}
integrals: {area: {on: domain, of: area}}
probes: {A: [0.5, 0.8]}
study:
  vary: {parameters.r: [0.1, 0.2]}
  grid: [8, 12]
"""


def plan_of(text: str = CASE, **given):
    return make_plan(from_text(text, "case.yaml"), {key.replace("__", "."): v for key, v in given.items()})
