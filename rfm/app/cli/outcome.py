"""Exit codes, and how every way a command can end is mapped to one."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pkgutil import resolve_name
from typing import Any

import typer

from rfm.errors import CaseError, RfmError

DONE, MISSED, WRONG, FAILED, INTERRUPTED = 0, 1, 2, 3, 130


def finish(body: str, as_json: bool, **arguments: Any) -> None:
    """Import the body of a command (``module:function``), run it and leave with its exit code.

    Errors are printed on standard error; with `as_json` standard output gets one object in any case.
    """
    try:
        command: Callable[..., int] = resolve_name(body)
        code = command(as_json=as_json, **arguments)
    except KeyboardInterrupt as stop:
        message = str(stop) or "interrupted; files of earlier runs are intact"
        code = _report("interrupted", message, INTERRUPTED, as_json)
    except RfmError as error:
        code = _report(type(error).__name__, error, error.exit_code, as_json)
    except MemoryError:
        message = "not enough memory; take a coarser grid or a lower degree"
        code = _report("MemoryError", message, FAILED, as_json)
    except BrokenPipeError:
        sys.stderr.close()  # the reader of our output is gone, there is nobody to tell
        code = FAILED
    except OSError as error:
        code = _report("OSError", f"{error}; choose another place with --out", FAILED, as_json)
    raise typer.Exit(code)


def _report(kind: str, error: RfmError | str, code: int, as_json: bool) -> int:
    text = str(error) if isinstance(error, CaseError) else f"error: {error}"
    print("".join(c if c.isprintable() or c == "\n" else "?" for c in text), file=sys.stderr)
    if as_json:
        print_json({"status": "error", "exit_code": code, "error": kind, "errors": _rows(error)})
    return code


def _rows(error: RfmError | str) -> list[dict[str, str]]:
    several = getattr(error, "errors", (error,))
    return [
        {"message": item.message, "path": item.path, "place": item.place}
        if isinstance(item, CaseError)
        else {"message": str(item)}
        for item in several
    ]


def print_json(value: Any) -> None:
    """Print one object on standard output; what is not a finite number becomes null."""
    import json

    print(json.dumps(plain(value), indent=2, allow_nan=False))


def plain(value: Any) -> Any:
    """Value as JSON can hold it: tuples as lists, NumPy numbers as numbers, infinities and NaN as null."""
    import math
    from collections.abc import Mapping

    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if value is None or isinstance(value, bool | int | str):
        return value
    if hasattr(value, "tolist"):
        return plain(value.tolist())
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return str(value)
