"""Fills the template of the report with a run."""

from __future__ import annotations

import base64
import math
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from rfm.app.pictures import Gallery
from rfm.app.record import RunRecord
from rfm.app.report.statement import state_problem
from rfm.app.storage import case_text

TEMPLATE = "report.html.jinja"

NORMS = (
    ("relative_l2_error", "relative L² error"),
    ("relative_h1_error", "relative H¹ error"),
    ("relative_max_error", "relative maximum error"),
    ("relative_energy_error", "relative error in the energy norm"),
    ("energy", "energy"),
)
"""Keys of the summary in the table of norms."""

STUDY_COLUMNS = (
    ("degree", "degree"),
    ("grid", "grid"),
    ("dofs", "unknowns"),
    ("relative_l2_error", "L² error"),
    ("rate_l2", "rate"),
    ("relative_h1_error", "H¹ error"),
    ("rate_h1", "rate"),
    ("relative_max_error", "max error"),
    ("seconds", "seconds"),
)
"""Columns of the convergence table, shown where any row has them."""


def report_html(record: RunRecord, gallery: Gallery) -> bytes:
    """Content of ``report.html``: self-contained, no script, nothing is fetched."""
    study = record.study or ()
    html: str = _template().render(
        record=record,
        summary=record.summary,
        statement=state_problem(record.case),
        pictures={
            name: _embedded(getattr(gallery, name)) for name in ("shape", "solution", "error", "convergence")
        },
        components={name: _embedded(picture) for name, picture in gallery.components.items()},
        norms=[(label, record.summary[key]) for key, label in NORMS if record.summary.get(key) is not None],
        timings=_shares(record.timings),
        columns=[(key, label) for key, label in STUDY_COLUMNS if any(r.get(key) is not None for r in study)],
        study=study,
        case_text=case_text(record.case),
    )
    return html.encode("utf-8")


@cache
def _template() -> Any:
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["number"] = number
    return environment.get_template(TEMPLATE)


def number(value: Any) -> str:
    """A number for people: few digits, powers of ten as ``1.2e-9``; a dash for nothing."""
    if value is None:
        return "–"
    if isinstance(value, Mapping):
        return number(value.get("total"))
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return str(value)
    if isinstance(value, int) or value == 0 or not math.isfinite(value):
        return f"{value:g}" if isinstance(value, float) else str(value)
    if 1e-3 <= abs(value) < 1e4:
        return f"{value:.4g}"
    mantissa, exponent = f"{value:.2e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def _embedded(picture: bytes | None) -> str | None:
    """Picture as a data address for the ``src`` of an image."""
    return None if picture is None else "data:image/png;base64," + base64.b64encode(picture).decode("ascii")


def _shares(timings: Mapping[str, float]) -> Sequence[tuple[str, float, float]]:
    """Phase, seconds and per cent of the total."""
    total = timings.get("total") or sum(timings.values()) or 1.0
    return [(phase, seconds, min(100.0, 100 * seconds / total)) for phase, seconds in timings.items()]
