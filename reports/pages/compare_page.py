"""The page of two histories from files: the verdict, both curves and their difference, the scores in words."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Final

import numpy as np

from harness.input.history_file import read_history
from harness.model.errors import InputError, Mistake
from harness.model.history import Array, History, pair
from harness.records.base import REWRITE
from harness.records.result_folder import as_written
from harness.records.scores import FILES, CompareRecord
from harness.records.scores import Verdict as ScoredVerdict
from reports.blocks import Block, Cell, Chart, Row, Table, Verdict, repeat, section
from reports.charts.figure import axis, curve, figure, stroke
from reports.charts.palette import MUTED, look
from reports.charts.samples import packed_array, shown_samples
from reports.messages import Language
from reports.source import MOVED_SHARE, event_s
from reports.text.wording import score_rows

DIFFERENCE: Final = "difference, first less second"
ROWS: Final = (((0.52, 1.0), "rotation θ  [rad]"), ((0.27, 0.47), "difference  [rad]"), ((0.0, 0.21), "slip  [mm]"))
"""Share of the chart's height and title of each row, from above."""


def blocks(folder: Path, record: CompareRecord, say: Language) -> list[Block]:
    """The blocks of the page; raises `InputError` for a history that is lost or was changed."""
    paths = [folder / name for name in FILES]
    lost = [path for path in paths if not path.is_file() or not as_written(path, record)]
    if lost:
        raise InputError([Mistake(str(path), "", "the file that result.json lists", "none", REWRITE) for path in lost])
    a, b = map(read_history, paths)
    scores = record.scores
    # Both may have the same name, in two folders.
    names = (scores.a, scores.b) if scores.a != scores.b else (f"{scores.a} (1)", f"{scores.b} (2)")
    rows: list[Row] = [[Cell(name, tip=tip), *cells] for name, tip, cells in score_rows({record.title: scores}, say)]
    tone = "agree" if scores.verdict is ScoredVerdict.AGREE else "differ"
    return [
        Verdict(scores.verdict_sentence, tone, [each.text for each in scores.findings[1:]]),
        *section(say, "histories", Chart("histories", say("text.compare_chart"), compare_figure(names, a, b), 1060)),
        *section(say, "scores", Table(say("table.compare"), ["", say("label.value")], rows)),
        *repeat(say, record, shlex.join(["rockcheck", "compare", scores.a, scores.b, "--out", folder.name])),
    ]


def compare_figure(names: tuple[str, str], a: History, b: History) -> dict[str, object]:
    """Rotations, their difference on one grid, and slips where there are any, over one axis of time."""
    both = pair(a, b)
    data = [
        _curve(name, history.t_s, history.theta_rad, "y", names) for name, history in zip(names, (a, b), strict=True)
    ]
    data.append(_curve(DIFFERENCE, both.t_s, both.difference_rad, "y2", (*names, DIFFERENCE)))
    slips = any(history.slip_m.any() for history in (a, b))
    if slips:
        data += [
            _curve(name, history.t_s, 1e3 * history.slip_m, "y3", names) | {"showlegend": False}
            for name, history in zip(names, (a, b), strict=True)
        ]
    level = MOVED_SHARE * float(np.abs(b.theta_rad).max(initial=0.0))
    shown = list(event_s((a, b), level, float(both.t_s[-1])))
    layout = {
        f"yaxis{number if number > 1 else ''}": axis(
            title, domain=list(domain), zerolinecolor=MUTED, automargin=True, fixedrange=True
        )
        for number, (domain, title) in enumerate(ROWS[: 3 if slips else 2], start=1)
    }
    x = axis("time  [s]", anchor="y3" if slips else "y2", zeroline=False, range=shown)
    return figure(data, 620, x, layout.pop("yaxis"), hovermode="x unified", **layout)


def _curve(name: str, t_s: Array, values: Array, axis_name: str, names: tuple[str, ...]) -> dict[str, object]:
    shown, style = shown_samples(values), look(name, names)
    place = {"name": name, "yaxis": axis_name, "legendgroup": name}
    return curve(packed_array(t_s[shown]), packed_array(values[shown]), stroke(style), **place)
