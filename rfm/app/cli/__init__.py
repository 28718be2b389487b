"""The command `rfm`.  Nothing but the command line itself is imported before a command runs."""

from __future__ import annotations

__all__ = ["main"]


def main() -> None:
    """Run the command `rfm` with the arguments of the process."""
    import gc
    import os

    # most of a short command is imports: the collector would walk all that was loaded again and again (a tenth of
    # the time), and pydantic would search every installed package for plugins
    gc.set_threshold(20_000, 10, 10)
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    from rfm.app.cli.application import app

    app(prog_name="rfm")
