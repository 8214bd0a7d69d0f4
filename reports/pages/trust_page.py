"""The page of a trust map: one picture of where the analytic model holds, and what each class means."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np

from harness.records.trust import CLASSES, HELD, TrustCell, TrustMap, TrustRecord
from harness.trust.point import MODEL
from harness.trust.trust_run import CELLS_NAME
from reports.charts import Json
from reports.charts.figure import curve, figure
from reports.charts.map_figures import border, map_axis
from reports.charts.palette import INK
from reports.messages import ENGLISH
from reports.messages.numbers import digits
from reports.text.wording import Verdict

COLOURS: Final = dict(
    zip(CLASSES, ("#e3e6ea", "#0072b2", "#9ccbe8", "#e69f00", "#aa4499", "#f0e442", "#8c1d2f", "#000000"), strict=True)
)
"""Told apart by every form of colour vision: blue where the model is confirmed, the darker the more."""
MEANS: Final = {
    "nothing_moves": "The shaking is below what a statue at rest bears.",
    "confirmed": "All models agree to the end, in outcome, lean and slip, within their numerical errors.",
    "outcome_confirmed": "All models say the same outcome. Their histories agree up to a time; from there numerical error or "
    "sensitivity leaves nothing to compare.",
    "probability": "The smallest changes, or numerical error, change the outcome: only its probability can be told.",
    "left_domain": "Models differ after the analytic model left what it computes.",
    "plane_left_out": "Models differ by what a model in the plane leaves out.",
    "refuted": "Models differ by more than numerical error and sensitivity explain.",
    "no_answer": "What was asked there failed.",
}
"""What each class says of its points."""
BASES: Final = {
    "rest": "by the limits of rest",
    "runs": "by runs of all models",
    "between": "as the points above and below",
    "checked": "by runs of all models, as a check",
}
"""What a point rests on."""


def context(_folder: Path, record: TrustRecord) -> dict[str, object]:
    """Everything that the template shows."""
    said = [] if record.answer is None else [each.text for each in record.answer.findings]
    kinds = [kind for kind in CLASSES if any(each.shares[kind] for each in record.maps)]
    there = {kind: ", ".join(ENGLISH.percent(each.shares[kind]) for each in record.maps) for kind in kinds}
    cells = [cell for each in record.maps for cell in each.cells]
    falls = any(cell["outcomes"].get(MODEL) == "overturned" for cell in cells)
    tone = "failed" if "refuted" in there else "agree" if there.keys() <= HELD and not falls else "differ"
    return {
        "verdict": Verdict(said[0], tone, said[1:]),
        "maps": [(each.stands_on, map_figure(each)) for each in record.maps],
        "classes": [(ENGLISH.word(kind), shares, MEANS[kind]) for kind, shares in there.items()],
        "bases": [(words, sum(cell["basis"] == name for cell in cells)) for name, words in BASES.items()],
        "cells_name": CELLS_NAME,
    }


def map_figure(record: TrustMap) -> Json:
    """Strength upwards, frequency across (of a scene's own motion one column): each point in its class's colour."""
    frequencies = list(dict.fromkeys(cell["frequency_hz"] for cell in record.cells))
    strengths = list(dict.fromkeys(cell["amplitude_g"] for cell in record.cells))
    rows = [record.cells[j :: len(strengths)] for j in range(len(strengths))]
    count = len(CLASSES)
    scale = [[(k + side) / count, COLOURS[kind]] for k, kind in enumerate(CLASSES) for side in (0, 1)]
    own = frequencies == [None]
    across = [0.0] if own else [each for each in frequencies if each is not None]
    trace = {
        "type": "heatmap", "x": across, "y": strengths, "zmin": -0.5, "zmax": count - 0.5,
        "z": [[CLASSES.index(cell["class"]) for cell in row] for row in rows], "colorscale": scale, "showscale": False,
        "text": [[tip(cell) for cell in row] for row in rows], "hovertemplate": "%{text}<extra></extra>",
    }  # fmt: skip
    falls = np.array([[cell["outcomes"].get(MODEL) == "overturned" for cell in row] for row in rows])
    line = border(
        falls, across, strengths, {"color": INK, "width": 2.4}, "where the statue falls, by the analytic model"
    )
    x = map_axis("frequency  [Hz]", across)
    if own:
        x = {"title": {"text": ""}, "tickvals": across, "ticktext": ["the scene's own motion"], "range": [-0.5, 0.5]}
    keys = [
        curve([across[0]], [None], {}, mode="markers", name=ENGLISH.word(kind), marker=marker)
        for kind in record.shares if record.shares[kind]
        for marker in [{"color": COLOURS[kind], "symbol": "square", "size": 12}]
    ]  # fmt: skip
    return figure(
        [trace, *keys, line], 480, x, map_axis("strength, peak of the floor  [g]", strengths), showlegend=True
    )


def tip(cell: TrustCell) -> str:
    """What a point says under the pointer."""
    words = [f"{digits(cell['amplitude_g'])} g"]
    words += [f"{digits(cell['frequency_hz'])} Hz"] if cell["frequency_hz"] else []
    lines = [", ".join(words), f"{ENGLISH.word(cell['class'])}, {BASES[cell['basis']]}"]
    lines += [f"why: {ENGLISH.listed(map(ENGLISH.word, cell['why']))}"] if cell["why"] else []
    ends = [f"{name}: {ENGLISH.word(end)}" for name, end in cell["outcomes"].items()]
    lines += [*ends, *([f"agree until {digits(cell['agree_until_s'])} s"] if cell["agree_until_s"] else [])]
    for name, chance in cell["probability"].items():
        low, high = ENGLISH.percent(chance.low), ENGLISH.percent(chance.high)
        lines.append(f"overturning probability ({name}) {ENGLISH.percent(chance.value)} ({low} to {high})")
    return "<br>".join(lines)
