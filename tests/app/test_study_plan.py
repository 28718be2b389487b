"""Which runs a study has, how they are named, and their table."""

import csv

import pytest

from rfm.app.study.plan import changes, labels
from rfm.app.study.table import csv_text, with_rates
from rfm.app.study.task import DONE, PENDING
from rfm.errors import CaseError
from tests.app.dying import SUMMARY
from tests.app.studies import CASE, plan_of

# The plan ------------------------------------------------------------------------------------------


def test_runs_are_all_combinations_with_grids_next_to_each_other():
    plan = plan_of()
    names = ["r=0.1,grid=8", "r=0.1,grid=12", "r=0.2,grid=8", "r=0.2,grid=12"]
    assert [task.name for task in plan.tasks] == names
    assert plan.tasks[2].settings == {"parameters.r": 0.2, "discretization.grid": 8}
    assert (plan.tasks[2].degree, plan.tasks[2].grid) == (2, 8)
    assert len({task.digest for task in plan.tasks}) == 4
    assert "study" not in plan.tasks[0].document.data


def test_values_of_the_command_replace_those_of_the_case():
    plan = plan_of(parameters__r=[0.15], discretization__grid=[6], discretization__degree=[1, 3])
    assert [task.name for task in plan.tasks] == ["r=0.15,degree=1,grid=6", "r=0.15,degree=3,grid=6"]
    spaced = plan_of(CASE.replace("  grid: [8, 12]\n", ""), discretization__spacing=[0.1, 0.05])
    assert [task.grid for task in spaced.tasks] == [None] * 4


def test_names_of_folders():
    assert labels(["a.b.radius", "a.c.radius", "p.R"]) == {
        "a.b.radius": "b.radius",
        "a.c.radius": "c.radius",
        "p.R": "R",
    }
    center = "geometry__shapes__inner__disk__center"
    names = [task.name for task in plan_of(**{center: [[0.5, 0.5], [0.4, 0.5]]}).tasks]
    assert len(set(names)) == 8
    assert all(name.replace(",", "").replace("=", "").replace("-", "").isascii() for name in names)
    assert not any(set(name) & set("[] /") for name in names)
    exact = plan_of(parameters__r=[1 / 7, 0.14285714], discretization__grid=[8]).tasks
    assert len({task.name for task in exact}) == 2


@pytest.mark.parametrize(
    ("change", "place", "words"),
    [
        (("[0.1, 0.2]", "[0.1, -1]"), "7:48: geometry.shapes.inner.disk.radius", "must be positive, got -1"),
        (("[0.1, 0.2]", "[0.1, 'q+1']"), "17:31: parameters.r", "unknown name 'q'"),
        (
            ("vary: {parameters.r", "vary: {geometry.shapes.iner.disk.radius"),
            "17:10: study.vary",
            "did you mean 'inner'?",
        ),
        (("vary: {parameters.r", "vary: {solver.linaer"), "17:10: solver.linaer", "did you mean 'linear'?"),
        (("vary: {parameters.r", "vary: {discretization.grid"), "17:10: study.vary", "gives the grid twice"),
        (("[0.1, 0.2]", "[0.1, 0.1]"), "17:30: study.vary.parameters.r.1", "holds 0.1 twice"),
        (("[0.1, 0.2]", "0.1"), "17:24: study.vary.parameters.r", "must be a list of values, got 0.1"),
        (("vary: {parameters.r: [0.1, 0.2]}", "vary: 3"), "17:9: study.vary", "must be a mapping from keys"),
        (
            ("vary: {parameters.r", "vary: {study.grid"),
            "17:10: study.vary",
            "a study cannot vary 'study.grid'",
        ),
        (("[8, 12]", "[12, 8]"), "18:9: study.grid", "must increase"),
    ],
)
def test_a_wrong_study_is_refused_at_its_place(change, place, words):
    with pytest.raises(CaseError) as caught:
        plan_of(CASE.replace(*change))
    assert str(caught.value).startswith(f"case.yaml:{place}")
    assert words in str(caught.value)


def test_changes_of_a_case():
    assert changes({"a": {"b": 1, "c": [1]}}, {"a": {"b": 2, "c": [1]}, "d": 0}) == ["a.b", "d"]


# The table -----------------------------------------------------------------------------------------


def test_rates_belong_to_runs_that_differ_in_the_grid_only():
    plan = plan_of()
    rows = {
        task.name: {
            "state": DONE,
            "settings": task.settings,
            "grid": task.grid,
            "relative_l2_error": task.settings["parameters.r"] * float(task.grid) ** -3,
        }
        for task in plan.tasks
    }
    table = with_rates(plan, dict(reversed(rows.items())))
    assert [row["rate_l2"] for row in table] == [None, pytest.approx(3.0), None, pytest.approx(3.0)]
    del rows["r=0.1,grid=12"]
    assert [row["state"] for row in with_rates(plan, rows)] == [DONE, PENDING, DONE, DONE]


def test_the_table_as_text():
    plan = plan_of()
    table = with_rates(plan, {})
    table[0].update(state=DONE, dofs=5, results={"integrals.area": 0.1})
    rows = list(csv.DictReader(csv_text(plan, table).splitlines()))
    assert len(rows) == 4
    assert (rows[0]["parameters.r"], rows[0]["grid"], rows[0]["integrals.area"]) == ("0.1", "8", "0.1")
    assert (rows[1]["state"], rows[1]["dofs"]) == ("pending", "")
    assert SUMMARY.keys() >= {"dofs", "energy"}
