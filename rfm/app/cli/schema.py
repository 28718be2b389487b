"""`rfm schema`: the JSON schema of case files, for editors and other programs."""

from __future__ import annotations

import json
from pathlib import Path

from rfm.app.case import Case
from rfm.app.cli.outcome import DONE
from rfm.app.run_directory import OutputError


def print_schema(*, out: Path | None, as_json: bool) -> int:
    """Print the schema or write it to a file; returns the exit code."""
    schema = {"$schema": "https://json-schema.org/draft/2020-12/schema", **Case.model_json_schema()}
    text = json.dumps(schema, indent=2)
    if out is None:
        print(text)
        return DONE
    try:
        out.write_text(text + "\n")
    except OSError as error:
        raise OutputError(f"cannot write {out}: {error.strerror}; choose another place with --out") from error
    return DONE
