"""Positions, limits and refusals of the YAML reader; overrides."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rfm.app.source import Document, excerpt, from_file, from_mapping, from_text, nearest, parse_value
from rfm.app.yaml_reader import MAX_CHARACTERS, MAX_DEPTH, MAX_VALUES, YamlError, read
from rfm.errors import CaseError


def error_of(text: str) -> CaseError:
    with pytest.raises(CaseError) as caught:
        from_text(text, "case.yaml")
    return caught.value


def test_every_key_and_value_has_its_position():
    text = "rfm: 1\ngeometry:\n  shapes:\n    inner: {disk: {radius: -1}}\nlist: [a, [b, c]]\n"
    document = from_text(text, "case.yaml")
    assert document.data == {
        "rfm": 1,
        "geometry": {"shapes": {"inner": {"disk": {"radius": -1}}}},
        "list": ["a", ["b", "c"]],
    }
    path = ("geometry", "shapes", "inner", "disk", "radius")
    assert document.error(path, "bad").place == "case.yaml:4:28"
    assert document.error(path, "bad", key=True).place == "case.yaml:4:20"
    assert document.error(("list", 1, 1), "bad").place == "case.yaml:5:15"
    assert document.error((*path, "missing"), "bad").place == "case.yaml:4:20"


def test_message_has_place_path_and_a_caret():
    text = "rfm: 1\nradius:   -1\n"
    assert str(from_text(text, "case.yaml").error(("radius",), "must be positive, got -1")) == (
        "case.yaml:2:11: radius: must be positive, got -1\n    radius:   -1\n              ^"
    )


@pytest.mark.parametrize(
    ("yaml", "place"),
    [
        ("f: 1 + zz\n", "c:1:8"),
        ('f: "1 + zz"\n', "c:1:9"),
        ("f: '1 + zz'\n", "c:1:9"),
        ("f: >\n  1 +\n  zz\n", "c:3:3"),
        ("f: |\n  1 + zz\n", "c:2:7"),
        ("f: 1 +\n   zz\n", "c:2:4"),
        ("{f: [0, 1 + zz]}\n", "c:1:13"),
    ],
)
def test_offset_inside_a_scalar_of_any_style(yaml, place):
    document = from_text(yaml, "c")
    path = ("f",) if isinstance(document.data["f"], str) else ("f", 1)
    value = document.data["f"] if len(path) == 1 else document.data["f"][1]
    assert document.error(path, "unknown", offset=value.index("zz")).place == place


def test_plain_scalars_follow_the_core_schema():
    text = "a: [1, -2.5, 1e-3, .5, ~, null, true, False, yes, on, 0x1F, 1_0, .inf, '1', 2026-01-02]"
    values = from_text(text, "c").data["a"]
    assert values == [
        1,
        -2.5,
        1e-3,
        0.5,
        None,
        None,
        True,
        False,
        "yes",
        "on",
        "0x1F",
        "1_0",
        float("inf"),
        "1",
        "2026-01-02",
    ]
    assert from_text("on: all\nno: 1\n", "c").data == {"on": "all", "no": 1}


@pytest.mark.parametrize(
    ("text", "place", "words"),
    [
        ("", "case.yaml:1:1", "found nothing"),
        ("- 1\n", "case.yaml:1:1", "found a list"),
        ("42", "case.yaml:1:1", "found a int"),
        ("a: [1,\n", "case.yaml:2:1", "not valid YAML"),
        ("a:\n  - b\n c: d\n", "case.yaml:3:2", "not valid YAML"),
        ("a: 1\na: 2\n", "case.yaml:2:1", "given twice (first on line 1)"),
        ("a: {b: 1, b: 2}\n", "case.yaml:1:11", "given twice"),
        ("a: !!python/object/apply:os.system [ls]\n", "case.yaml:1:4", "tags are not allowed"),
        ("a: !include x\n", "case.yaml:1:4", "tags are not allowed"),
        ("a: &x [*x]\n", "case.yaml:1:8", "contains it"),
        ("a: &x {b: {c: *x}}\n", "case.yaml:1:15", "contains it"),
        ("a: *x\n", "case.yaml:1:4", "no anchor"),
        ("a: &x {b: 1}\nc:\n  <<: *x\n", "case.yaml:3:3", "merge keys"),
        ("{[1, 2]: 3}\n", "case.yaml:1:2", "plain name"),
        ("a: 1\n---\nb: 2\n", "case.yaml:2:1", "one document"),
        ("a: \x07\n", "case.yaml:1:4", "not valid YAML"),
    ],
)
def test_refusals_carry_their_place(text, place, words):
    error = error_of(text)
    assert error.place == place
    assert words in error.message


def test_alias_is_expanded():
    assert from_text("a: &x [1, 2]\nb: *x\n", "c").data == {"a": [1, 2], "b": [1, 2]}


def test_alias_bomb_is_refused():
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]" for i in range(1, 12)]
    assert f"more than {MAX_VALUES} values" in error_of("\n".join(lines)).message


def test_alias_tower_is_refused():
    lines = ["a0: &a0 [x]"] + [f"a{i}: &a{i} [*a{i - 1}]" for i in range(1, 60)]
    assert f"deeper than {MAX_DEPTH}" in error_of("\n".join(lines)).message


@pytest.mark.parametrize("text", ["[" * 5000, "{a: " * 5000, "- " * 5000, "? " * 5000])
def test_deep_nesting_is_refused(text):
    assert error_of(text).place.startswith("case.yaml:1:")


def test_long_text_is_refused():
    assert "longer than" in error_of("a: 1 #" + "x" * MAX_CHARACTERS).message


def test_terminal_control_is_not_printed():
    assert "\x1b" not in excerpt("a: \x1b[31m", 4)


def test_long_lines_are_cut_around_the_caret():
    shown, caret = excerpt("a" * 500 + "X" + "b" * 500, 501).split("\n")
    assert shown[caret.index("^")] == "X"
    assert len(shown) < 140


@settings(max_examples=300, deadline=None)
@given(st.text(alphabet="ab:-[]{}&*!|>'\"#%@,? \n\t\x00é", max_size=60))
def test_any_text_is_read_or_refused(text):
    place = (1, 1)
    try:
        read(text)
    except YamlError as error:
        place = error.line, error.column
    assert min(place) >= 1


def test_files_that_are_no_cases(tmp_path):
    (tmp_path / "annulus.yaml").write_text("rfm: 1")
    with pytest.raises(CaseError, match=r"no such file; did you mean .*annulus\.yaml"):
        from_file(tmp_path / "anulus.yaml")
    with pytest.raises(CaseError, match="nor a folder"):
        from_file(tmp_path / "nowhere" / "case.yaml")
    with pytest.raises(CaseError, match="is a directory"):
        from_file(tmp_path)
    binary = tmp_path / "binary.yaml"
    binary.write_bytes(b"\x89PNG\xff\xfe")
    with pytest.raises(CaseError, match="not a text file"):
        from_file(binary)
    large = tmp_path / "large.yaml"
    large.write_bytes(b" " * (4 * MAX_CHARACTERS + 1))
    with pytest.raises(CaseError, match="too large"):
        from_file(large)
    marked = tmp_path / "bom.yaml"
    marked.write_bytes(b"\xef\xbb\xbfrfm: 1\n")
    assert from_file(marked).data == {"rfm": 1}


def example() -> Document:
    return from_text("a: {b: 1, c: [x, y]}\nd: 2\n", "case.yaml")


def test_overrides_replace_create_and_keep_their_origin():
    document = example()
    document.override("a.b", 5)
    document.override("a.c.1", "z")
    document.override("new.key", 6)
    assert document.data == {"a": {"b": 5, "c": ["x", "z"]}, "d": 2, "new": {"key": 6}}
    assert document.error(("a", "b"), "bad").place == "--set a.b=5"
    assert document.error(("a", "c", 1), "bad", offset=0).excerpt == "    z\n    ^"
    assert document.error(("a", "c", 0), "bad").place == "case.yaml:1:15"
    assert document.error(("new", "key"), "bad").place == "--set new.key=6"


def test_a_later_override_hides_an_earlier_one():
    document = example()
    document.override("a.b", 5)
    document.override("a", {"b": 7})
    assert document.error(("a", "b"), "bad").place == "--set a={'b': 7}"


@pytest.mark.parametrize(
    ("key", "words"),
    [
        ("a.c.2", "no index"),
        ("a.c.x", "no index"),
        ("d.e", "has no keys"),
        ("a..b", "dotted key"),
        ("", "dotted key"),
    ],
)
def test_overrides_that_lead_nowhere(key, words):
    with pytest.raises(CaseError, match=words) as caught:
        example().override(key, 1)
    assert caught.value.place == f"--set {key}=1"


def test_values_of_overrides_are_yaml():
    assert parse_value("k", "[1, 2.5, x]") == [1, 2.5, "x"]
    assert parse_value("k", "") is None
    with pytest.raises(CaseError) as caught:
        parse_value("k", "[1")
    assert caught.value.place == "--set k=[1"


def test_mappings_from_python_have_no_place():
    document = from_mapping({"a": (1, 2), "b": {"c": 3}})
    assert document.data == {"a": [1, 2], "b": {"c": 3}}
    assert str(document.error(("b", "c"), "bad")) == "b.c: bad"


def test_nearest_name_or_the_list():
    assert nearest("radus", ["center", "radius"]) == "did you mean 'radius'?"
    assert nearest("Radius", ["center", "radius"]) == "did you mean 'radius'?"
    assert nearest("qqq", ["center", "radius"]) == "valid keys: center, radius"
    assert nearest("q", [], "shapes") == "there are no shapes"
