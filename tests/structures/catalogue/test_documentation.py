"""The table in the documentation and in `rfm list structures` is the registry's."""

from __future__ import annotations

from pathlib import Path

from rfm.app.catalogue import TOPICS
from structures.catalogue.registry import CATALOGUE, COLUMNS, markdown, rows

DOCUMENT = Path(__file__).parents[3] / "docs" / "structures.md"


def test_the_table_of_the_documentation_is_the_registry():
    text = DOCUMENT.read_text(encoding="utf-8")
    table = text.split("<!-- catalogue: begin -->")[1].split("<!-- catalogue: end -->")[0].strip()
    assert table == markdown(), "paste structures.catalogue.registry.markdown() between the marks"


def test_rfm_list_structures():
    topic = TOPICS["structures"]
    assert topic.columns == COLUMNS
    assert topic.rows() == rows()
    assert {row[0] for row in topic.rows()} == set(CATALOGUE)
