"""The page of measured tosses: how far each model's pose is off, with what was fitted."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Final

from harness.records.tosses import PoseErrors, Quartiles, TossesRecord, TossModel
from reports.charts.figure import curve
from reports.charts.palette import look
from reports.messages.numbers import digits, unit
from reports.text.wording import Verdict

QUARTILES = ("median", "low", "high")
KINDS: Final[Mapping[str, tuple[Callable[[PoseErrors], Quartiles], str]]] = {
    "rotation": (lambda errors: errors.rotation_rad, "rad"),
    "place": (lambda errors: errors.place_m, "m"),
}
"""The two errors of a pose and their units."""


def context(folder: Path, record: TossesRecord) -> dict[str, object]:
    """Everything that the tosses' template shows."""
    models = record.models
    return {
        "title": f"Validation against {record.count} measured tosses",
        "verdict": tosses_verdict(record),
        "names": list(models),
        "errors": _spread,
        "shares": (len(record.fitted_on), record.count - len(record.fitted_on)),
        "raised": {key: unit(value, "m") for key, value in vars(record.raised_m).items()},
        "charts": [
            ("rotation", "Rotation error over time (median; quartiles thin)", chart(models, "rotation")),
            ("place", "Place error over time (median; quartiles thin)", chart(models, "place")),
        ],
        "rows": {name: {row.toss: row for row in item.rows} for name, item in models.items()},
        "tosses": dict.fromkeys(row.toss for item in models.values() for row in item.rows),
        "command": command(record),
    }


def tosses_verdict(record: TossesRecord) -> Verdict:
    """Which model's rotation is nearest at the median of all frames that nothing was fitted on."""
    known = {name: item.frames.rotation_rad.median for name, item in record.models.items() if item.frames}
    if not known:
        return Verdict("No model computed any toss", "failed", [])
    best = min(known, key=lambda name: known[name])
    ends = {name: item.end for name, item in record.models.items() if item.end}
    points = [
        f"{name}: at the end rotation {_spread(item.rotation_rad, 'rad')}, place {_spread(item.place_m, 'm')}."
        for name, item in ends.items()
    ]
    points += [
        f"{name} could not compute {len(item.failed)} tosses." for name, item in record.models.items() if item.failed
    ]
    points += [
        f"{name} ended {len(item.ended_s)} tosses before their last frame: its last pose is held there."
        for name, item in record.models.items()
        if item.ended_s
    ]
    sentence = f"{best} is nearest: its rotation is off by {unit(known[best], 'rad')} at the median of all frames"
    return Verdict(sentence, "agree", points)


def _spread(item: Quartiles, name: str) -> str:
    return f"{unit(item.median, name)} ({digits(item.low)} to {digits(item.high)})"


def chart(models: Mapping[str, TossModel], kind: str) -> dict[str, object]:
    """A model's median error over time with its quartiles, of rotation or place, as Plotly's figure."""
    of, name = KINDS[kind]
    traces = []
    for model, item in models.items():
        colour = look(model, list(models)).colour
        for part in QUARTILES:
            line = {"color": colour, "width": 2 if part == "median" else 0.7}
            values, times = [vars(of(row))[part] for row in item.over_time], [row.t_s for row in item.over_time]
            traces.append(curve(times, values, line, name=model, showlegend=part == "median"))
    layout = {
        "xaxis": {"title": {"text": "time [s]"}},
        "yaxis": {"title": {"text": f"error [{name}]"}, "rangemode": "tozero"},
    }
    return {"data": traces, "layout": layout}


def command(record: TossesRecord) -> str:
    """The command that repeats it."""
    parts = [f"rockcheck validate {shlex.quote(record.tosses)} --body {shlex.quote(record.body)}"]
    parts += [f"-e {name}" for name in record.models]
    return " ".join([*parts, f"--seed {record.seed}"] if record.seed else parts)
