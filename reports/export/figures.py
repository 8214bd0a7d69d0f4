"""Figures for papers: print sizes, labels with units, one command (`python -m reports.export.figures DIR`)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from harness.model.errors import InputError, Mistake
from harness.model.run import PATTERN_NAMES
from harness.records.base import Record
from harness.records.result_folder import MARK, check_marked, writing
from harness.records.run import RunRecord
from reports.charts.palette import INK, MUTED, PATTERN_LOOKS, Look, look
from reports.charts.study_figures import FLOOR_COLOUR, PEDESTAL_COLOUR, SHOWN_RAD, SLIP_COLOUR
from reports.source import RunSource, kind_of, read_record, source_of, telling_damage
from reports.text.numbers import drawn_text
from reports.text.wording import horizon_s

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTHS_MM: Final = {"column": 85.0, "page": 178.0}
"""A column and a page of most journals."""
FORMATS: Final = ("png", "svg", "pdf")
DPI: Final = 300
STYLE: Final[Any] = {
    "font.size": 8.0,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "lines.linewidth": 0.9,
    "legend.frameon": False,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "pdf.fonttype": 42,
    "svg.fonttype": "none",
    "svg.hashsalt": "rockcheck",
}
"""Eight-point type; fonts stay editable in PDF and SVG; the same record always gives the same SVG."""
DASHES: Final[Mapping[str, Any]] = {"solid": "solid", "7px,2px": (0, (5, 1.5)), "2px,2px": (0, (1.5, 1.5))}


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
    record = read_record(folder)
    with telling_damage(folder, record):
        return _drawn(folder, record, formats, width, model)


def _drawn(
    folder: Path, record: Record | Mapping[str, Any], formats: Sequence[str], width: str, model: str | None
) -> list[Path]:
    drawn: dict[str, Callable[[Figure], None]] = {}
    if isinstance(record, RunRecord):
        source = source_of(folder, record)
        if source.histories:
            drawn["histories"] = lambda figure: draw_histories(figure, source)
    for group in [] if isinstance(record, Record) else _groups(record):
        chosen = _chosen(group, model)
        name = f"panels_{group[0]['restitution']:g}_{chosen}".replace(" ", "_").replace("(", "").replace(")", "")
        drawn[name] = lambda figure, group=group, chosen=chosen: draw_panels(figure, group, chosen)  # type: ignore[misc]
    if not drawn:
        raise InputError(Mistake(str(folder), "", "a record with histories or panels", f"a {kind_of(record)} without"))
    target = folder / "figures"
    target.mkdir(exist_ok=True)
    return [path for name, draw in drawn.items() for path in _save(target / name, formats, width, draw)]


def _groups(record: Mapping[str, Any]) -> list[list[Mapping[str, Any]]]:
    groups: dict[float, list[Mapping[str, Any]]] = {}
    for panel in record.get("panels") or ():
        groups.setdefault(panel["restitution"], []).append(panel)
    return list(groups.values())


def _chosen(group: Sequence[Mapping[str, Any]], model: str | None) -> str:
    known = list(dict.fromkeys(name for panel in group for name in panel["curves"]))
    if model is not None and model not in known:
        raise InputError(Mistake("--model", "", f"one of {', '.join(known)}", repr(model)))
    return model or known[0]


def _save(stem: Path, formats: Sequence[str], width: str, draw: Callable[[Figure], None]) -> list[Path]:
    import matplotlib as mpl
    from matplotlib.figure import Figure

    paths = []
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(WIDTHS_MM[width] / 25.4, 1.0), layout="constrained")
        draw(figure)
        for kind in formats:
            path = stem.with_name(f"{stem.name}.{kind}")
            dated = {"pdf": "CreationDate", "svg": "Date"}.get(kind)
            check_marked([path])
            marked = {"Software" if kind == "png" else "Creator": MARK.decode()}
            with writing(path) as fresh:
                figure.savefig(fresh, dpi=DPI, metadata=marked if dated is None else {**marked, dated: None})
            paths.append(path)
    return paths


def draw_histories(figure: Figure, source: RunSource) -> None:
    """Rotation of all models, their motion patterns, the pedestal's slip and the floor's motion over one time axis."""
    patterns = {name: run.patterns for name, run in source.runs.items() if run.patterns}
    motion = source.record.motion
    rows = {"rotation": 5.0}
    if patterns:
        rows["patterns"] = 0.45 * len(patterns)
    if source.scene.pedestal is not None:
        rows["slip"] = 2.0
    if motion.accel_m_s2:
        rows["floor"] = 1.5
    width = figure.get_figwidth()
    figure.set_figheight(min(0.092 * sum(rows.values()) * width + 0.9, 9.0))
    axes = figure.subplots(len(rows), 1, sharex=True, height_ratios=list(rows.values()), squeeze=False)[:, 0]
    by_row = dict(zip(rows, axes, strict=True))
    names = list(source.runs)
    _rotation(by_row["rotation"], source, names)
    if "patterns" in by_row:
        _patterns(by_row["patterns"], patterns)
    if "slip" in by_row:
        for name, history in source.histories.items():
            by_row["slip"].plot(history.t_s, 1000.0 * history.slip_m, **_style(look(name, names)))
        by_row["slip"].set_ylabel("slip (mm)")
    if "floor" in by_row:
        for axis, colour in (("x", INK), ("y", "#AA4499"), ("z", "#3A8FC7")):
            if axis in motion.accel_m_s2:
                accel = np.asarray(motion.accel_m_s2[axis]) / source.scene.gravity_m_s2
                by_row["floor"].plot(motion.t_s, accel, color=colour, linewidth=0.5, label=axis)
        by_row["floor"].set_ylabel("floor (g)")
        if len(motion.accel_m_s2) > 1:
            by_row["floor"].legend(loc="upper right", ncols=3)
    axes[-1].set_xlabel("time (s)")
    axes[-1].set_xlim(0.0, source.scene.duration_s)


def _rotation(axes: Axes, source: RunSource, names: list[str]) -> None:
    statue = source.scene.statue
    low, high = -statue.slenderness_left_rad, statue.slenderness_right_rad
    for name, history in source.histories.items():
        axes.plot(history.t_s, history.theta_rad, label=name, **_style(look(name, names)))
    least = min(float(item.theta_rad.min()) for item in source.histories.values())
    most = max(float(item.theta_rad.max()) for item in source.histories.values())
    bottom, top = max(least, 1.3 * low), min(most, 1.3 * high)
    margin = 0.08 * (top - bottom) or 0.01
    axes.set_ylim(bottom - margin, top + margin)
    for level in (low, high):
        axes.axhline(level, color=MUTED, linewidth=0.5, linestyle=(0, (6, 4)))
    axes.axhline(0.0, color=MUTED, linewidth=0.4)
    until = horizon_s(source)
    if until is not None:
        axes.axvspan(until, source.scene.duration_s, color="#7a8696", alpha=0.13, linewidth=0)
    axes.set_ylabel("rotation θ (rad)")
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=4, borderaxespad=0.1)


def _patterns(axes: Axes, patterns: Mapping[str, Any]) -> None:
    for row, stretches in enumerate(patterns.values()):
        for name, (colour, hatch) in PATTERN_LOOKS.items():
            spans = [(start, end - start) for start, end, which in stretches if which == name]
            if spans:
                label = PATTERN_NAMES[name] if row == 0 else None
                axes.broken_barh(
                    spans,
                    (row - 0.36, 0.72),
                    facecolor=colour,
                    hatch=2 * hatch,
                    edgecolor="white",
                    linewidth=0,
                    label=label,
                )
    axes.set_yticks(range(len(patterns)), list(patterns))
    axes.invert_yaxis()
    axes.spines["left"].set_visible(False)
    axes.tick_params(axis="y", length=0)
    axes.legend(
        loc="upper left", bbox_to_anchor=(0.0, -0.02), ncols=4, fontsize=6.5, handlelength=1.2, borderaxespad=0.1
    )


def _style(style: Look) -> dict[str, Any]:
    return {"color": style.colour, "linestyle": DASHES.get(style.dash, "solid"), "linewidth": 0.55 * style.width}


def draw_panels(figure: Figure, group: Sequence[Mapping[str, Any]], model: str) -> None:
    """The arrangement of the paper's figures 7 to 9: amplitudes across, frequencies down."""
    amplitudes = sorted({panel["amplitude_g"] for panel in group})
    frequencies = sorted({panel["frequency_hz"] for panel in group})
    figure.set_figheight(1.15 * len(frequencies) + 0.5)
    axes = figure.subplots(len(frequencies), len(amplitudes), sharex=True, sharey=True, squeeze=False)
    for panel in group:
        place = axes[frequencies.index(panel["frequency_hz"]), amplitudes.index(panel["amplitude_g"])]
        curves = panel["curves"].get(model, {})
        for setting, colour in (("floor", FLOOR_COLOUR), ("pedestal", PEDESTAL_COLOUR)):
            if setting in curves:
                words = f"θ, on the {setting} (rad)"
                place.plot(curves[setting]["t_s"], curves[setting]["theta_rad"], color=colour, label=words)
        if "pedestal" in curves:
            tenth = 0.1 * np.asarray(curves["pedestal"]["slip_m"])
            place.plot(curves["pedestal"]["t_s"], tenth, color=SLIP_COLOUR, label="slip of the pedestal (m ÷ 10)")
        place.set_title(f"{panel['amplitude_g']:g} g, {panel['frequency_hz']:g} Hz", fontsize=8, loc="left", pad=2)
        place.set_ylim(-SHOWN_RAD, SHOWN_RAD)
    figure.supxlabel("time (s)", fontsize=8)
    figure.supylabel("rotation θ (rad)", fontsize=8)
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(
        handles,
        labels,
        loc="outside upper left",
        ncols=3 if figure.get_figwidth() > 5.0 else 1,
        title=f"{drawn_text(model)}, r = {group[0]['restitution']:g}",
        alignment="left",
        borderaxespad=0.0,
    )


def main() -> None:
    """`python -m reports.export.figures DIR [column|page]`: write all figures of a folder and name them."""
    import sys

    from harness.cli import guarded

    def run() -> int:
        if len(sys.argv) not in (2, 3):
            raise InputError(Mistake("command", "", "DIR [column|page]", " ".join(sys.argv[1:]) or "nothing"))
        for path in write_figures(Path(sys.argv[1]), width=sys.argv[2] if len(sys.argv) == 3 else "page"):
            print(path)
        return 0

    sys.exit(guarded(run))


if __name__ == "__main__":
    main()
