"""The commands that measure: run time against error, and numerical stability."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from harness.runs.progress import ProgressMessages
from reports.cli.app import app, command
from reports.cli.ending import FAILED, OK
from reports.cli.options import OUT, Out, OutputOptions
from reports.cli.result import say_result

if TYPE_CHECKING:
    from harness.runs.parts import Measurement, R

Quick = Annotated[bool, typer.Option("--quick", help="A few rows of each kind: to see that it works, not to judge.")]
Parts = Annotated[
    str | None,
    typer.Option(
        "--parts", metavar="NAMES", help="Only these parts (a,b), the others as measured before; see the docs."
    ),
]


@command(app, None, "rockcheck bench --out out/bench", "rockcheck bench --parts precision,skips")
def bench(saying: OutputOptions, quick: Quick = False, parts: Parts = None, out: Out = None) -> None:
    """Measure run time against error for every engine and setting, what skips gain, and how cost grows."""
    from harness.questions.bench import bench_run

    measured(bench_run.bench(), saying, quick, parts, out)


@command(app, None, "rockcheck stress --out out/stress", "rockcheck stress --parts fuzz")
def stress(saying: OutputOptions, quick: Quick = False, parts: Parts = None, out: Out = None) -> None:
    """Run hard scenes, map each engine's stability, and read thousands of mutated files."""
    from harness.questions.bench.stress import stress_run

    record = measured(stress_run.stress(), saying, quick, parts, out)
    raise typer.Exit(OK if record.holds else FAILED)


def measured(measurement: Measurement[R], saying: OutputOptions, quick: bool, parts: str | None, out: Path | None) -> R:
    """The record of a measurement of these parts (comma-separated; None: of all), once it is said."""
    from harness.records.base import as_file
    from reports.messages import ENGLISH
    from reports.terminal import study_lines

    folder = out or OUT / measurement.name
    only = None if parts is None else [name.strip() for name in parts.split(",") if name.strip()]
    with ProgressMessages(saying.silent) as messages:
        record = measurement.run(folder, quick, only, messages.engine, ENGLISH.say)
    say_result(as_file(record), "\n".join(study_lines(record, verbose=saying.verbose)), folder, saying)
    return record
