"""The bench and the stress run with what the source tree measures for them: `python -m tests.measures.whole bench|stress`.

Options are those of `rockcheck bench` and `rockcheck stress`, which leave these parts out.
"""

from __future__ import annotations

import sys
from typing import Final

import typer

from harness.questions.bench import bench_run
from harness.questions.bench.stress import stress_run
from reports.cli.app import command
from reports.cli.ending import FAILED, OK, guarded
from reports.cli.options import Out, OutputOptions
from reports.cli.questions import Parts, Quick, measured

SOURCES: Final = ("tests/fuzz", "tests/measures")
BENCH: Final = bench_run.bench(
    {
        bench_run.DEFAULTS: "tests.measures.engine_defaults",
        bench_run.COVERAGE: "tests.measures.coverage",
        bench_run.OTHERS: "tests.measures.other_integrators",
    },
    SOURCES,
)
STRESS: Final = stress_run.stress(
    {
        stress_run.QUESTIONS: "tests.measures.invariance_checks",
        stress_run.FUZZ: "tests.fuzz",
        stress_run.DEFAULTS: "tests.measures.engine_defaults",
    },
    SOURCES,
)
app: Final = typer.Typer(no_args_is_help=True, pretty_exceptions_enable=False)


def bench(saying: OutputOptions, quick: Quick = False, parts: Parts = None, out: Out = None) -> None:
    """The bench, whole."""
    measured(BENCH, saying, quick, parts, out)


def stress(saying: OutputOptions, quick: Quick = False, parts: Parts = None, out: Out = None) -> None:
    """The stress run, whole."""
    record = measured(STRESS, saying, quick, parts, out)
    raise typer.Exit(OK if record.holds else FAILED)


command(app, "bench")(bench)
command(app, "stress")(stress)

if __name__ == "__main__":
    sys.exit(guarded(app))
