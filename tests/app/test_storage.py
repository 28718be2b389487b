"""solution.h5 gives back what was put in; what is no solution is refused with the reason."""

import json

import h5py
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ruamel.yaml import YAML

from rfm.app import storage
from tests.app.records import CASE, record

NAMES = st.text("abcdefgh_", min_size=1, max_size=6)
LEAVES = st.one_of(
    st.integers(-(10**9), 10**9),
    st.floats(allow_nan=False, allow_infinity=False),
    st.booleans(),
    st.none(),
    st.text(st.characters(codec="utf-8", exclude_categories=("C", "Z")), max_size=20),
)
CASES = st.dictionaries(
    NAMES,
    st.recursive(
        LEAVES,
        lambda inner: st.lists(inner, max_size=3) | st.dictionaries(NAMES, inner, max_size=3),
        max_leaves=8,
    ),
    max_size=4,
)


@pytest.fixture
def saved(tmp_path):
    made = record()
    path = tmp_path / "solution.h5"
    path.write_bytes(storage.solution_bytes(made))
    return made, path


def test_round_trip(saved):
    made, path = saved
    loaded = storage.load(path)
    assert np.array_equal(loaded.coefficients, made.coefficients)
    assert (loaded.degree, loaded.basis, loaded.name, loaded.title) == (
        3,
        "web-spline",
        "annulus",
        made.title,
    )
    assert loaded.lower == tuple(made.grid.lower)
    assert loaded.spacing == tuple(made.grid.spacing)
    assert loaded.cells == tuple(made.grid.cells)
    assert loaded.case == CASE
    assert loaded.summary == made.summary
    assert loaded.provenance == made.provenance


def test_a_run_directory_is_accepted(saved):
    _, path = saved
    assert storage.load(path.parent).degree == 3


@settings(deadline=None, max_examples=25)
@given(CASES)
def test_case_text_keeps_every_value(case):
    assert (YAML(typ="safe").load(storage.case_text(case)) or {}) == case


def test_summary_is_strict_json():
    text = storage.summary_text({"a": float("nan"), "b": np.float64(2), "c": (1, np.int64(3)), "d": [np.inf]})
    assert json.loads(text) == {"a": None, "b": 2.0, "c": [1, 3], "d": [None]}


def test_missing_file(tmp_path):
    with pytest.raises(storage.StorageError, match="no such file"):
        storage.load(tmp_path)


def test_truncated_file(saved):
    _, path = saved
    path.write_bytes(path.read_bytes()[:2000])
    with pytest.raises(storage.StorageError, match="cannot be read"):
        storage.load(path)


def test_other_hdf5_file(tmp_path):
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["x"] = 1
    with pytest.raises(storage.StorageError, match="not a solution"):
        storage.load(tmp_path / "other.h5")


def test_later_format(saved):
    _, path = saved
    with h5py.File(path, "r+") as file:
        file.attrs["format"] = 99
    with pytest.raises(storage.StorageError, match="newer rfm"):
        storage.load(path)
