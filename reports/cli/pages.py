"""The commands that make something of finished records: pages, figures, an animation."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Final

import typer

from harness.runs.progress import ProgressMessages
from reports.cli.app import app, command
from reports.cli.options import InLanguage, OutputOptions

READERS: Final = ("engineer", "conservator")

Folder = Annotated[Path, typer.Argument(metavar="DIR", help="A folder with a result.json.", show_default=False)]


@command(app, None, "rockcheck report out/maria", "rockcheck report out/maria --for conservator --language it --pdf")
def report(
    folder: Folder,
    saying: OutputOptions,
    reader: Annotated[str, typer.Option("--for", help="Whose page to name: engineer or conservator.")] = "engineer",
    pdf: Annotated[bool, typer.Option("--pdf", help="Also print that page, beside it (by Chromium).")] = False,
    language: InLanguage = "en",
) -> None:
    """Write the pages of a result folder again from its records: report.html, and conservator.html where there is one."""
    from harness.model.errors import InputError, Mistake
    from reports.export.pdf import browser, write_pdf
    from reports.pages.page import CONSERVATOR_NAME, write_report

    if reader not in READERS:
        raise InputError(Mistake("--for", "", f"one of {', '.join(READERS)}", repr(reader)))
    if pdf:
        browser()
    page = write_report(folder, language)
    if reader == "conservator":
        page = folder / CONSERVATOR_NAME
        if not page.is_file():
            raise InputError(Mistake("--for", "", "a run or a study", "a record that has no conservator's page"))
    paths = {"report": str(page)} | ({"pdf": str(write_pdf(page))} if pdf else {})
    saying.say(paths, "\n".join(f"{name}: {path}" for name, path in paths.items()))


@command(app, None, "rockcheck figures out/paestum_floor --format pdf --width column")
def figures(
    folder: Folder,
    saying: OutputOptions,
    formats: Annotated[list[str] | None, typer.Option("--format", help="png, svg, pdf (repeat). Default: all.")] = None,
    width: Annotated[str, typer.Option("--width", help="column or page, as journals print.")] = "page",
    model: Annotated[
        str | None, typer.Option("--model", help="Of a study: whose panels, such as `pymunk (paper)`.")
    ] = None,
) -> None:
    """Write the figures of a result for print."""
    from reports.export.figures import FORMATS, write_figures

    written = [str(path) for path in write_figures(folder, formats or FORMATS, width, model)]
    saying.say(written, "\n".join(written))


@command(app, None, "rockcheck gif out/paestum_floor")
def gif(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="A folder of a run.", show_default=False)],
    saying: OutputOptions,
    out: Annotated[Path | None, typer.Option("--out", help="The file to write. Default: replay.gif in DIR.")] = None,
    model: Annotated[str | None, typer.Option("--model", help="Whose motion. Default: the 3D engine's.")] = None,
) -> None:
    """Write the replay of a run as an animated picture for slides."""
    from reports.export.animation import write_gif

    with ProgressMessages(saying.silent) as messages:
        messages.now("drawing the frames")
        written = str(write_gif(folder, out, model))
    saying.say([written], written)
