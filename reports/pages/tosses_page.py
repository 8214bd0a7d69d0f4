"""The page of measured tosses: how far each model's pose is off, with what was fitted."""

from __future__ import annotations

import math
import shlex
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Final

from harness.records.tosses import PoseErrors, Quartiles, TossesRecord, TossModel, TrajectoryMeans
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
        "means": means_rows(record),
        "keyed_means": [(row[0], row[1:]) for row in means_rows(record)[1:]],
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
    """The record's answer as a headline with what is to be known of it."""
    said = "" if record.answer is None else record.answer.text
    known = record.answer is not None and record.answer.code == "tosses"
    return Verdict(said or record.title, "agree" if known else "failed", [each.text for each in record.findings])


def means_rows(record: TossesRecord) -> list[list[str]]:
    """Means over the trajectory by model and fit, those that are published below, under a heading."""
    rows = [["", "fitted on", "friction", "restitution", "place [% of width]", "rotation [°]"]]
    for name, model in record.models.items():
        rows += [
            [name, fit.replace("_", " "), digits(item.friction, 3), digits(item.restitution, 2), *_means(item.means)]
            for fit, item in model.fits.items()
        ]
    return rows + [[name, "published", "–", "–", *_means(means)] for name, means in record.published.items()]


def _means(item: TrajectoryMeans | None) -> list[str]:
    if item is None:
        return ["–", "–"]
    place, turn = (100.0 * item.place_share, 100.0 * item.place_share_sd), (item.rotation_rad, item.rotation_rad_sd)
    return [f"{mean:.1f} ± {sd:.1f}" for mean, sd in (place, tuple(map(math.degrees, turn)))]


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
