"""Figures for papers: the charts of a record's page at print sizes, one command (`python -m reports.export.figures DIR`)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from harness.model.errors import InputError, Mistake
from harness.records.base import Record, plain
from harness.records.kinds import read_result
from harness.records.result_folder import check_marked
from harness.records.run import RunRecord
from harness.records.study import StudyRecord
from reports.charts.histories import histories_figure
from reports.charts.static_svg import picture
from reports.charts.study_figures import panels_figure
from reports.drawing.shapes import Picture, Text, moved
from reports.export.paper import pixels_across, write_picture
from reports.source import RunSource, source_of

WIDTHS_MM: Final = {"column": 85.0, "page": 178.0}
"""A column and a page of most journals."""
FORMATS: Final = ("png", "svg", "pdf")
POINTS: Final = 2400
"""Most points of a printed curve: more than dots across a page at 300 dpi."""
NARROW_PX: Final = 500.0
"""A picture narrower than this needs more rows for the names over it."""
HEAD_PX: Final = 22.0
"""Height of a line of title over a picture."""


def write_figures(
    folder: Path, formats: Sequence[str] = FORMATS, width: str = "page", model: str | None = None
) -> list[Path]:
    """Write the figures of a result folder into `figures/` in it; returns the files.

    `model` chooses the model of a study's panels, such as `pymunk (own impact)`; default: its first.
    Raises `InputError` for an unknown format, width or model, or a record that holds nothing to draw.
    """
    for value, known, option in [
        *((item, FORMATS, "--format") for item in formats),
        (width, tuple(WIDTHS_MM), "--width"),
    ]:
        if value not in known:
            raise InputError(Mistake(option, "", f"one of {', '.join(known)}", repr(value)))
    record = read_result(folder)
    pictures = dict(_pictures(folder, record, pixels_across(WIDTHS_MM[width]), model))
    if not pictures:
        raise InputError(Mistake(str(folder), "", "a record with histories or panels", f"a {record.kind} without"))
    target = folder / "figures"
    target.mkdir(exist_ok=True)
    paths = {target / f"{name}.{kind}": drawn for name, drawn in pictures.items() for kind in formats}
    check_marked(paths)
    return [write_picture(drawn, path) for path, drawn in paths.items()]


def _pictures(folder: Path, record: Record, width_px: float, model: str | None) -> Iterator[tuple[str, Picture]]:
    """The name and the picture of each figure of a record."""
    if isinstance(record, RunRecord):
        source = source_of(folder, record)
        if source.histories:
            yield "histories", histories_picture(source, width_px)
    for group in _groups(record) if isinstance(record, StudyRecord) else []:
        chosen = _chosen(group, model)
        name = f"panels_{group[0]['restitution']:g}_{chosen}".replace(" ", "_").replace("(", "").replace(")", "")
        yield name, panels_picture(group, chosen, width_px)


def _groups(record: StudyRecord) -> list[list[Mapping[str, Any]]]:
    groups: dict[float, list[Mapping[str, Any]]] = {}
    for panel in record.panels or ():
        groups.setdefault(panel.restitution, []).append(plain(panel))
    return list(groups.values())


def _chosen(group: Sequence[Mapping[str, Any]], model: str | None) -> str:
    known = list(dict.fromkeys(name for panel in group for name in panel["curves"]))
    if model is not None and model not in known:
        raise InputError(Mistake("--model", "", f"one of {', '.join(known)}", repr(model)))
    return model or known[0]


def histories_picture(source: RunSource, width_px: float) -> Picture:
    """The page's histories of all models, with the names of the motion patterns, which the page writes below them."""
    figure = histories_figure(source)
    data = [trace | {"showlegend": True} if trace["type"] == "bar" else trace for trace in figure["data"]]
    layout = figure["layout"] | {"height": 0.8 * figure["layout"]["height"]}
    return _drawn({"data": data, "layout": layout}, width_px)


def panels_picture(group: Sequence[Mapping[str, Any]], model: str, width_px: float) -> Picture:
    """The arrangement of the paper's figures 7 to 9 for one model, named over it."""
    drawn = _drawn(panels_figure(group, model), width_px)
    title = Text(8.0, 16.0, f"{model}, r = {group[0]['restitution']:g}", "start")
    return Picture(drawn.width, drawn.height + HEAD_PX, [title, *moved(drawn.shapes, 0.0, HEAD_PX)])


def _drawn(figure: Mapping[str, Any], width_px: float) -> Picture:
    room = {"top": 100.0 if width_px < NARROW_PX else 56.0}
    drawn = picture({**figure, "layout": figure["layout"] | {"still": room}}, width_px, POINTS)
    if drawn is None:
        raise LookupError("a figure for print holds a kind of chart that has no still picture")
    return drawn


def main() -> None:
    """`python -m reports.export.figures DIR [column|page]`: write all figures of a folder and name them."""
    import sys

    from harness.command import guarded

    def run() -> int:
        if len(sys.argv) not in (2, 3):
            raise InputError(Mistake("command", "", "DIR [column|page]", " ".join(sys.argv[1:]) or "nothing"))
        for path in write_figures(Path(sys.argv[1]), width=sys.argv[2] if len(sys.argv) == 3 else "page"):
            print(path)
        return 0

    sys.exit(guarded(run))


if __name__ == "__main__":
    main()
