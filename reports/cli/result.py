"""Where a command's result goes, and how it is said: as JSON or as text, then its pages."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import typer

from harness.model.errors import InputError
from harness.model.terminal import printable
from reports.cli.ending import FAILED
from reports.cli.options import OutputOptions


def say_result(
    record: Mapping[str, object], text: str, folder: Path, saying: OutputOptions, language: str = "en"
) -> None:
    """Say what was computed, then write its pages, none with `--json`: most of a short run's time, for a program that reads the
    record. A page that cannot be made is no mistake of the user's, and costs no other.
    """
    if text or saying.as_json:
        saying.say(record, text)
    if saying.as_json:
        return
    from reports.pages.page import write_report

    try:
        page = write_report(folder, language)
    except InputError as error:
        for mistake in error.mistakes:
            typer.echo(f"error: {mistake}", err=True)
        raise typer.Exit(FAILED) from error
    except OSError:
        typer.echo(printable(f"the result stands in {folder}; `rockcheck report {folder}` writes its pages"), err=True)
        raise
    except Exception as fault:
        page_name = ", ".join(getattr(fault, "__notes__", ["a page"]))
        fault_text = (
            f"{page_name} could not be made, {type(fault).__name__}: {fault}; a fault of rockcheck: please report it"
        )
        typer.echo(printable(f"error: {fault_text}"), err=True)
        raise typer.Exit(FAILED) from fault
    if not saying.silent:
        typer.echo(printable(f"report: {page}"))


def check_language(code: str) -> None:
    """Raise `InputError` for a language that the conservator's page does not speak, before anything is computed."""
    from reports.messages import language

    language(code)
