"""The page of a trust map: one picture of where the analytic model holds, and what each class means."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np

from harness.records.trust import CLASSES, HELD, TrustCell, TrustMap, TrustRecord
from harness.trust.point import MODEL
from harness.trust.trust_run import CELLS_NAME
from reports.blocks import Block, Chart, Facts, Group, Text, facts, repeat, section, verdict, words
from reports.charts import Json
from reports.charts.figure import curve, figure
from reports.charts.map_figures import border, map_axis
from reports.charts.palette import INK
from reports.messages import ENGLISH, Language
from reports.messages.numbers import digits

COLOURS: Final = dict(
    zip(CLASSES, ("#e3e6ea", "#0072b2", "#9ccbe8", "#e69f00", "#aa4499", "#f0e442", "#8c1d2f", "#000000"), strict=True)
)
"""Told apart by every form of colour vision: blue where the model is confirmed, the darker the more."""
BASES: Final = ("rest", "runs", "between", "checked")
"""What a point may rest on."""
MOTIONS: Final = {
    "sine": """ --set 'motion={x={kind="harmonic",amplitude_g=0.3,frequency_hz=2.0}}'""",
    "pulse": """ --set 'motion={x={kind="pulse",shape="one_sine",amplitude_g=0.3,duration_s=0.5}}'""",
    "scene": " --set motion.scale=1.2",
}
"""What a point's command changes in the scene."""


def blocks(_folder: Path, record: TrustRecord, say: Language) -> list[Block]:
    """The blocks of a trust map's page."""
    kinds = [kind for kind in CLASSES if any(each.shares[kind] for each in record.maps)]
    cells = [cell for each in record.maps for cell in each.cells]
    falls = any(cell["outcomes"].get(MODEL) == "overturned" for cell in cells)
    tone = "failed" if "refuted" in kinds else "agree" if set(kinds) <= HELD and not falls else "differ"
    shares = {kind: ", ".join(say.percent(each.shares[kind]) for each in record.maps) for kind in kinds}
    meanings = [(f"{say.word(kind)}, {each}", say(f"text.trust_{kind}")) for kind, each in shares.items()]
    counts = [(say(f"text.basis_{name}"), str(sum(cell["basis"] == name for cell in cells))) for name in BASES]
    spent = {
        "engines": record.engines,
        "points": record.summary.points,
        "cpu_time": say.value(record.summary.cpu_s, "s"),
    }
    engines = "".join(f" -e {name}" for name in record.engines)
    command = f"rockcheck run {record.scene.file or 'SCENE'}{engines}{MOTIONS[record.motion]}"
    return [
        verdict(record, tone),
        *section(
            say, "map", *(
                Chart(each.stands_on, say(f"text.trust_on_{each.stands_on}"), map_figure(each), 1060)
                for each in record.maps
            ),
            words(say, "trust_map", motion=say(f"text.motion_{record.motion}"), name=CELLS_NAME),
        ),
        *section(
            say, "classes", Facts(meanings, ""), Group("", [Facts(counts)], say("text.bases")),
            Text([each.text for each in record.findings], "notes"),
        ),
        *repeat(say, record, command, more=[facts(say, spent)]),
    ]  # fmt: skip


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
    lines = [", ".join(words), f"{ENGLISH.word(cell['class'])}, {ENGLISH('text.basis_' + cell['basis'])}"]
    lines += [f"why: {ENGLISH.listed(map(ENGLISH.word, cell['why']))}"] if cell["why"] else []
    ends = [f"{name}: {ENGLISH.word(end)}" for name, end in cell["outcomes"].items()]
    lines += [*ends, *([f"agree until {digits(cell['agree_until_s'])} s"] if cell["agree_until_s"] else [])]
    for name, chance in cell["probability"].items():
        low, high = ENGLISH.percent(chance.low), ENGLISH.percent(chance.high)
        lines.append(f"overturning probability ({name}) {ENGLISH.percent(chance.value)} ({low} to {high})")
    return "<br>".join(lines)
