"""The page of measured tosses: how far each model's pose is off, with what was fitted."""

from __future__ import annotations

import math
import shlex
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Final

from harness.records.tosses import PoseErrors, Quartiles, TossesRecord, TossModel, TrajectoryMeans
from reports.blocks import Block, Chart, Facts, Group, Table, Text, code, grid, repeat, section, verdict, words
from reports.charts.figure import curve
from reports.charts.palette import look
from reports.messages import ENGLISH, Language

QUARTILES = ("median", "low", "high")
KINDS: Final[Mapping[str, tuple[Callable[[PoseErrors], Quartiles], str]]] = {
    "rotation": (lambda errors: errors.rotation_rad, "rad"),
    "place": (lambda errors: errors.place_m, "m"),
}
"""The two errors of a pose and their units."""


def blocks(_folder: Path, record: TossesRecord, say: Language) -> list[Block]:
    """The blocks of the tosses' page."""
    models, published = record.models, say("text.published") if record.published else ""
    medians: list[list[str]] = [
        [say(f"label.{kind}_{part}"), *(_spread(getattr(item, part), kind, say) for item in models.values())]
        for part in ("frames", "end") for kind in KINDS
    ]  # fmt: skip
    ends = {name: {row.toss: row for row in item.rows} for name, item in models.items()}
    tosses = dict.fromkeys(row.toss for item in models.values() for row in item.rows)
    scored: list[list[str]] = [
        [toss, *(
            f"{say.value(rows[toss].end_rotation_rad, 'rad')}, {say.value(rows[toss].end_place_m, 'm')}"
            if toss in rows else "–"
            for rows in ends.values()
        )]
        for toss in tosses
    ]  # fmt: skip
    raised = {key: say.value(value, "m") for key, value in vars(record.raised_m).items()}
    absent = [say("text.not_run", name=name, reason=reason) for name, reason in record.absent.items()]
    fitted: list[Block] = [
        words(say, "tosses_fit", count=len(record.fitted_on)),
        Facts([(name, _fitted(item, say)) for name, item in models.items()], ""),
        Text([*absent, say("text.tosses_flight"), say("text.tosses_raised", **raised)]),
    ]
    return [
        verdict(record, "agree" if code(record) == "tosses" else "failed", [each.text for each in record.findings]),
        *section(
            say, "scores",
            Table(say("table.tosses", count=record.count - len(record.fitted_on)), ["", *models], medians),
            means_table(record, say, published),
            Group("", fitted, say("text.fitted")),
        ),
        *section(
            say, "over_time", grid(Chart(kind, say(f"text.{kind}_chart"), chart(models, kind)) for kind in KINDS)
        ),
        *section(say, "tests", Table(say("table.scored_tosses"), ["", *models], scored)),
        *repeat(say, record, command(record)),
    ]  # fmt: skip


def means_table(record: TossesRecord, say: Language = ENGLISH, published: str = "") -> Table:
    """Means over the trajectory by model and fit, those that are published below."""
    heads = ["", *(say.label(key) for key in ("fitted_on", "friction", "restitution", "place_percent", "rotation_deg"))]
    rows = [
        [name, fit.replace("_", " "), say.digits(item.friction, 3), say.digits(item.restitution, 2), *_means(item.means)]
        for name, model in record.models.items() for fit, item in model.fits.items()
    ]  # fmt: skip
    rows += [[name, say("text.published_row"), "–", "–", *_means(means)] for name, means in record.published.items()]
    return Table(f"{say('table.means')}{published}", heads, rows)


def _means(item: TrajectoryMeans | None) -> list[str]:
    if item is None:
        return ["–", "–"]
    place, turn = (100.0 * item.place_share, 100.0 * item.place_share_sd), (item.rotation_rad, item.rotation_rad_sd)
    return [f"{mean:.1f} ± {sd:.1f}" for mean, sd in (place, tuple(map(math.degrees, turn)))]


def _spread(errors: PoseErrors | None, kind: str, say: Language) -> str:
    """A median with its quartiles."""
    if errors is None:
        return "–"
    of, name = KINDS[kind]
    item = of(errors)
    return f"{say.digits(item.median)}\u00a0{name} ({say.range([say.digits(item.low), say.digits(item.high)])})"


def _fitted(item: TossModel, say: Language) -> str:
    """The coefficients found, and what others miss by."""
    tried = {"by_friction": item.missed_m.by_friction, "by_restitution": {
        key: value for key, value in item.missed_m.by_restitution.items() if float(key) > 0
    }}  # fmt: skip
    missed = {
        kind: ", ".join(
            f"{key}: {say('text.most_failed') if value is None else say.value(value, 'm')}"
            for key, value in each.items()
        )
        for kind, each in tried.items()
    }
    more = say("text.missed_restitution", missed=missed["by_restitution"]) if missed["by_restitution"] else ""
    return say(
        "text.coefficients", friction=say.short(item.friction), restitution=say.short(item.restitution),
        missed=missed["by_friction"], more=more or say("text.plastic"),
    )  # fmt: skip


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
