"""Commands and options.  Each command imports its body when it runs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from rfm.app.cli.outcome import finish

app = typer.Typer(
    add_completion=False,
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    help="Solve boundary value problems without a mesh, with boundary conditions satisfied exactly.",
    epilog="Exit codes: 0 done, 1 done but an expectation was missed, 2 the case or command is wrong, "
    "3 the numerics or a run of a study failed, 130 interrupted.",
)

CaseFile = Annotated[Path, typer.Argument(metavar="CASE", help="Case file (YAML).")]
Overrides = Annotated[
    list[str] | None,
    typer.Option(
        "--set", metavar="KEY=VALUE", help="Override a value, e.g. discretization.grid=64; repeatable."
    ),
]
Json = Annotated[
    bool, typer.Option("--json", help="One JSON object on standard output, text on standard error.")
]
Large = Annotated[
    bool, typer.Option("--allow-large", help="Do not refuse a grid that may not fit into memory.")
]
Out = Annotated[
    Path | None, typer.Option("--out", metavar="DIR", help="Output directory (default runs/NAME).")
]


@app.callback(invoke_without_command=True)
def _root(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Print the version and leave.")] = False,
) -> None:
    if version:
        from importlib.metadata import version as installed

        typer.echo(f"rfm {installed('rfm')}")
        raise typer.Exit


@app.command()
def run(
    case: CaseFile,
    set_: Overrides = None,
    out: Out = None,
    json: Json = False,
    allow_large: Large = False,
    coordinator: Annotated[
        str | None,
        typer.Option(
            metavar="HOST:PORT", help="Solve with other processes; 0 listens here (auto: Slurm, Open MPI)."
        ),
    ] = None,
    processes: Annotated[int | None, typer.Option(metavar="N", help="How many processes.")] = None,
    process: Annotated[int | None, typer.Option(metavar="I", help="Which one this is, from 0.")] = None,
) -> None:
    """Solve a case and write results, pictures and a report."""
    together = {"coordinator": coordinator, "count": processes, "index": process}
    finish(
        "rfm.app.cli.run:run_case",
        json,
        file=case,
        settings=set_ or [],
        out=out,
        allow_large=allow_large,
        together=together if set(together.values()) != {None} else None,
    )


@app.command()
def check(case: CaseFile, set_: Overrides = None, json: Json = False, allow_large: Large = False) -> None:
    """Check a case up to the classification of the cells, without solving it."""
    finish("rfm.app.cli.check:check_case", json, file=case, settings=set_ or [], allow_large=allow_large)


@app.command()
def study(
    case: CaseFile,
    set_: Overrides = None,
    vary: Annotated[
        list[str] | None,
        typer.Option(
            "--vary",
            metavar="KEY=V1,V2,...",
            help="Vary a value of the case, e.g. parameters.R=0.3,0.4; repeatable, every combination is run.",
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", metavar="DIR", help="Keep the runs there; again: only what is missing or failed."
        ),
    ] = None,
    jobs: Annotated[
        int | None,
        typer.Option(
            "--jobs", metavar="N", help="Processes (default: one, all cores when the study is long)."
        ),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(
            "--scheduler", metavar="ADDRESS", help="Dask scheduler, or 'local' for a cluster started here."
        ),
    ] = None,
    restart: Annotated[bool, typer.Option("--restart", help="Make the runs in DIR anew.")] = False,
    pictures: Annotated[
        bool, typer.Option("--pictures", help="Each run in DIR with field, picture and report.")
    ] = False,
    json: Json = False,
    allow_large: Large = False,
) -> None:
    """Solve a case on several grids and degrees, or for several values of any key; print results and rates."""
    finish(
        "rfm.app.cli.study:study_case",
        json,
        file=case,
        settings=set_ or [],
        vary=vary or [],
        out=out,
        jobs=jobs,
        scheduler=scheduler,
        restart=restart,
        pictures=pictures,
        allow_large=allow_large,
    )


@app.command()
def show(
    target: Annotated[Path, typer.Argument(metavar="CASE|RUN", help="Case file, or directory of a run.")],
    set_: Overrides = None,
    json: Json = False,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE", help="Picture of the shape (default NAME.png).")
    ] = None,
) -> None:
    """Show what a case states, with a picture of its shape, or the summary of a run."""
    finish("rfm.app.cli.show:show_target", json, target=target, settings=set_ or [], out=out)


@app.command("list")
def list_(
    topic: Annotated[
        str | None,
        typer.Argument(metavar="[TOPIC]", help="shapes, functions, equations, structures, bases or cases."),
    ] = None,
    json: Json = False,
) -> None:
    """List what a case may use, or the cases that come along."""
    finish("rfm.app.cli.listing:list_topic", json, topic=topic)


@app.command()
def schema(
    out: Annotated[Path | None, typer.Option("--out", metavar="FILE", help="Write it to a file.")] = None,
) -> None:
    """Print the JSON schema of case files."""
    finish("rfm.app.cli.schema:print_schema", True, out=out)


@app.command()
def doctor(json: Json = False) -> None:
    """Report versions, threads and optional packages, and test this installation in a second."""
    finish("rfm.app.doctor:examine", json)
