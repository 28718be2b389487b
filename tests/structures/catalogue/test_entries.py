"""Every structure of the catalogue: its conditions hold for random psi at 1000 random boundary points."""

from __future__ import annotations

import pytest

from rfm.errors import StructureError
from structures.catalogue.registry import CATALOGUE, COLUMNS, entry, markdown, rows

CASES = [(name, k) for name, e in CATALOGUE.items() for k in range(len(e.examples()))]


@pytest.mark.parametrize(("name", "k"), CASES)
def test_conditions_hold_for_random_psi(name, k):
    example = CATALOGUE[name].examples()[k]
    for seed in (1, 2):
        residuals = example.residual(seed, count=1000)
        assert residuals
        assert max(residuals.values()) < 1e-10, residuals


@pytest.mark.parametrize("name", CATALOGUE)
def test_what_the_table_says_is_what_the_structure_has(name):
    e, example = CATALOGUE[name], CATALOGUE[name].examples()[0]
    assert max(op.order for op in example.operators) == e.derivatives
    unknowns = len({m for op in example.operators for m in op.unknowns})
    components = 1 if name == "interface" else len(example.operators)
    assert unknowns == e.unknowns * components


@pytest.mark.parametrize("name", CATALOGUE)
def test_every_psi_matters(name):
    # the residual would also vanish for a structure that prescribes u everywhere
    for op in CATALOGUE[name].examples()[0].operators:
        assert op.terms


def test_table():
    assert all(len(row) == len(COLUMNS) for row in rows())
    assert len(markdown().splitlines()) == len(CATALOGUE) + 2
    with pytest.raises(StructureError, match="choose one of dirichlet"):
        entry("neuman")
