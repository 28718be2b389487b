"""`rfm list`: shapes, functions, equations, structures, bases, weights, solvers, cases."""

from __future__ import annotations

from rfm.app.catalogue import TOPICS
from rfm.app.cli.outcome import DONE, print_json
from rfm.app.cli.output import say, table
from rfm.app.source import nearest
from rfm.errors import CaseError


def list_topic(*, topic: str | None, as_json: bool) -> int:
    """Print the list of a topic, or the topics; returns the exit code."""
    if topic is None:
        say("rfm list TOPIC, where TOPIC is one of: " + ", ".join(TOPICS), as_json)
        if as_json:
            print_json({"topics": list(TOPICS)})
        return DONE
    if topic not in TOPICS:
        raise CaseError(f"unknown topic {topic!r}; {nearest(topic, TOPICS, 'topics')}")
    chosen = TOPICS[topic]
    rows = chosen.rows()
    table(chosen.columns, rows, as_json)
    if as_json:
        print_json({topic: [dict(zip(chosen.columns, row, strict=True)) for row in rows]})
    return DONE
