"""The command `rfm`.  Nothing but the command line itself is imported before a command runs."""

from __future__ import annotations

__all__ = ["main"]


def main() -> None:
    """Run the command `rfm` with the arguments of the process."""
    from rfm.app.cli.application import app

    app(prog_name="rfm")
