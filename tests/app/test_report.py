"""The report carries everything it shows, says what was solved, and trusts no text."""

import re
from html.parser import HTMLParser

import pytest

from rfm.app.output import file_paths, write_run
from rfm.app.pictures import Gallery
from rfm.app.report import report_html
from rfm.app.report.builder import number
from rfm.app.report.statement import state_problem
from rfm.app.run_directory import RUN_FILES
from rfm.app.samples import sample
from tests.app.records import CASE, RESIDUALS, record

VOID = {"meta", "img", "br", "link", "input", "hr"}


class Outline(HTMLParser):
    """Collects headings and sources; notices tags that do not match."""

    def __init__(self):
        super().__init__()
        self.open, self.sources, self.words = [], [], []

    def handle_starttag(self, tag, attributes):
        if tag not in VOID:
            self.open.append(tag)
        self.sources += [value for key, value in attributes if key in ("src", "href")]

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.words.append(data.strip())


def outline(made):
    html = report_html(made, Gallery(made, sample(made, 12))).decode()
    parsed = Outline()
    parsed.feed(html)
    assert parsed.open == []
    return html, parsed


@pytest.fixture(scope="module")
def full():
    return outline(record())


def test_nothing_is_fetched(full):
    html, parsed = full
    assert len(parsed.sources) == 4
    assert all(source.startswith("data:image/png;base64,") for source in parsed.sources)
    assert "<script" not in html
    assert not re.search(r"https?:|url\(|@import", html)


@pytest.mark.parametrize(
    "text",
    [
        "−∇·(k ∇u) + c u = f in Ω",
        "u = 0 on outer",
        "k ∂u/∂n + (2 + y) u = x*y on inner where x > 0.5",
        "k ∂u/∂n = 1 on inner where x <= 0.5",
        "outer - inner",
        "1.50e-16",
        "2.50e-7",
        "140 unknowns: sparse direct",
        "Convergence",
        "0.05 s",
        "numpy",
    ],
)
def test_what_the_report_says(full, text):
    assert text in full[1].words


def test_the_resolved_case_is_in_it(full):
    assert any("domain: outer - inner" in words for words in full[1].words)


def test_every_residual_is_listed(full):
    for row in RESIDUALS:
        assert row.part in full[1].words


def test_texts_of_the_user_are_not_markup(full):
    html, parsed = full
    assert "<an>" not in html
    assert any("Poisson on <an> annulus & $more" in words for words in parsed.words)


def test_a_bare_run_has_a_report_too():
    made = record(exact=None, study=None, linear=None, residuals=(), summary={}, timings={})
    _, parsed = outline(made)
    assert len(parsed.sources) == 2
    assert "Convergence" not in parsed.words
    assert "no exact solution is given" in parsed.words


def test_probes_integrals_and_warnings_are_shown():
    summary = {
        "probes": {"A": {"u": 0.25, "gradient": [1.0, -2.0]}},
        "integrals": {"flux_in": 3.5},
        "warnings": ["contradictory data at a corner"],
    }
    _, parsed = outline(record(summary=summary))
    for text in ("A: u", "0.25", "1, -2", "flux_in", "3.5", "contradictory data at a corner"):
        assert text in parsed.words


def test_simple_coefficients_are_left_out():
    case = {**CASE, "equation": {"poisson": {"source": 1, "conductivity": 1, "reaction": 0}}}
    assert state_problem(case).equation == "−Δu = f in Ω"


def test_an_unknown_equation_is_listed_by_its_data():
    statement = state_problem({"equation": {"eigen": {"operator": "laplace", "count": 6}}})
    assert statement.equation == "eigen in Ω"
    assert statement.where == (("operator", "laplace"), ("count", "6"))


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (None, "–"),
        (3, "3"),
        (0.0, "0"),
        (1.234567e-9, "1.23e-9"),
        (2.0, "2"),
        ("cg", "cg"),
        ({"total": 2.0}, "2"),
    ],
)
def test_numbers(value, text):
    assert number(value) == text


def test_all_files_are_written(tmp_path):
    told = []
    files = write_run(record(), tmp_path / "run", told.append)
    assert sorted(path.name for path in (tmp_path / "run").iterdir()) == sorted(RUN_FILES)
    assert tuple(told) == RUN_FILES
    assert files == file_paths(tmp_path / "run")


def test_a_failure_while_drawing_leaves_the_previous_run(tmp_path):
    write_run(record(), tmp_path / "run")
    before = (tmp_path / "run" / "solution.h5").read_bytes()

    def broken(points):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_run(record(gradient=broken), tmp_path / "run")
    assert (tmp_path / "run" / "solution.h5").read_bytes() == before
    assert [path.name for path in tmp_path.iterdir()] == ["run"]
