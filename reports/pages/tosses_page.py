"""The page of measured tosses: how far each model's pose is off, with what was fitted."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from reports.charts.palette import look
from reports.text.numbers import digits, short, unit
from reports.text.wording import Verdict

QUARTILES = ("median", "low", "high")


def context(folder: Path, record: dict[str, Any]) -> dict[str, Any]:
    """Everything that the tosses' template shows."""
    models: Mapping[str, Any] = record["models"]
    return {
        "title": f"Validation against {record['count']} measured tosses",
        "verdict": tosses_verdict(record),
        "chips": [],
        "names": list(models),
        "score_rows": score_rows(models),
        "fitted": {name: fitted_words(item) for name, item in models.items()},
        "absent": record["absent"],
        "shares": (len(record["fitted_on"]), record["count"] - len(record["fitted_on"])),
        "raised": {key: unit(record["raised_m"][key], "m") for key in QUARTILES},
        "charts": [
            ("rotation", "Rotation error over time (median; quartiles thin)", chart(models, "rotation_rad", "rad")),
            ("place", "Place error over time (median; quartiles thin)", chart(models, "place_m", "m")),
        ],
        "rows": toss_rows(models),
        "command": command(record),
        "versions": record["versions"],
        "machine": record["machine"],
        "seconds": unit(record["seconds"], "s"),
    }


def tosses_verdict(record: Mapping[str, Any]) -> Verdict:
    """Which model's rotation is nearest at the median of all frames that nothing was fitted on."""
    known = {
        name: item["frames"]["rotation_rad"]["median"] for name, item in record["models"].items() if item["frames"]
    }
    if not known:
        return Verdict("No model computed any toss", "failed", [])
    best = min(known, key=lambda name: known[name])
    ends = {name: item["end"] for name, item in record["models"].items() if item["end"]}
    points = [
        f"{name}: at the end rotation {_spread(item['rotation_rad'], 'rad')}, place {_spread(item['place_m'], 'm')}."
        for name, item in ends.items()
    ]
    points += [
        f"{name} could not compute {len(item['failed'])} tosses."
        for name, item in record["models"].items()
        if item["failed"]
    ]
    sentence = f"{best} is nearest: its rotation is off by {unit(known[best], 'rad')} at the median of all frames"
    return Verdict(sentence, "agree", points)


def _spread(item: Mapping[str, float], name: str) -> str:
    return f"{unit(item['median'], name)} ({digits(item['low'])} to {digits(item['high'])})"


def score_rows(models: Mapping[str, Any]) -> list[tuple[str, list[str]]]:
    """Medians with their quartiles over all frames and at the end."""
    parts = (("frames", "all frames"), ("end", "at the end"))
    kinds = (("rotation_rad", "rotation", "rad"), ("place_m", "place", "m"))
    return [
        (f"{word}, {where}", [_spread(item[part][key], name) if item[part] else "–" for item in models.values()])
        for part, where in parts
        for key, word, name in kinds
    ]


def fitted_words(item: Mapping[str, Any]) -> str:
    """The coefficients with which a model came nearest to the fitted share, and what others missed by."""
    friction = ", ".join(f"{key}: {1e3 * value:.1f} mm" for key, value in item["missed_m"]["by_friction"].items())
    text = f"friction {short(item['friction'])}, restitution {short(item['restitution'])} (plastic: {friction}"
    bouncing = {key: value for key, value in item["missed_m"]["by_restitution"].items() if float(key) > 0.0}
    if not bouncing:
        return f"{text}; plastic impacts only)"
    return f"{text}; restitution " + ", ".join(f"{key}: {1e3 * value:.1f} mm" for key, value in bouncing.items()) + ")"


def chart(models: Mapping[str, Any], key: str, name: str) -> dict[str, Any]:
    """A model's median over time with its quartiles, as Plotly's figure."""
    traces = []
    for model, item in models.items():
        colour = look(model, list(models)).colour
        for part in QUARTILES:
            line = {"color": colour, "width": 2 if part == "median" else 0.7}
            values = [row[key][part] for row in item["over_time"]]
            times = [row["t_s"] for row in item["over_time"]]
            traces.append(
                {
                    "type": "scatter",
                    "x": times,
                    "y": values,
                    "mode": "lines",
                    "name": model,
                    "line": line,
                    "showlegend": part == "median",
                }
            )
    layout = {
        "xaxis": {"title": {"text": "time [s]"}},
        "yaxis": {"title": {"text": f"error [{name}]"}, "rangemode": "tozero"},
    }
    return {"data": traces, "layout": layout}


def toss_rows(models: Mapping[str, Any]) -> list[tuple[str, list[str]]]:
    """Each scored toss: its rotation error at the end, and its place error, by each model."""
    by_model = {name: {row["toss"]: row for row in item["rows"]} for name, item in models.items()}
    names = dict.fromkeys(toss for rows in by_model.values() for toss in rows)
    return [(toss, [_toss_cell(rows.get(toss)) for rows in by_model.values()]) for toss in names]


def _toss_cell(row: Mapping[str, Any] | None) -> str:
    return "–" if row is None else f"{unit(row['end_rotation_rad'], 'rad')}, {unit(row['end_place_m'], 'm')}"


def command(record: Mapping[str, Any]) -> str:
    """The command that repeats it."""
    parts = [f"rockcheck validate {shlex.quote(record['tosses'])} --body {shlex.quote(record['body'])}"]
    parts += [f"-e {name}" for name in record["models"]]
    return " ".join([*parts, f"--seed {record['seed']}"] if record["seed"] else parts)
