"""What the pedestal changes over a study: how often it prevents a fall, and how far the top moves with and without it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from harness.model.finding import Finding, info
from harness.model.history import Outcome
from harness.records.study import StudyRecord
from harness.records.trust import Saved
from reports.blocks import Chart
from reports.charts import Json
from reports.charts.figure import across, figure, kinds, level, marks, names, points, upwards
from reports.charts.palette import Look
from reports.charts.study_figures import FLOOR_COLOUR, PEDESTAL_COLOUR
from reports.drawing.kinematics import section
from reports.messages import ENGLISH, Language
from reports.text.study_rows import Condition, runs_of

WALL_COLOUR: Final = "#8c1d2f"


@dataclass(frozen=True)
class PedestalEffect:
    """What a model says it saves, and charts of the share of falls (`saved`) and of the reach (`moved`).

    There are charts where the study varies a frequency.
    """

    finding: Finding
    charts: Sequence[Chart] = ()


def pedestal_effect(
    record: StudyRecord,
    models: Sequence[str],
    cases: Sequence[Condition],
    say: Language = ENGLISH,
    words: str = "chart",
) -> PedestalEffect | None:
    """The effect in a study with and without pedestal, by its first analytic model; None for other studies.

    `words` is the table of the catalogue that names what the charts show.
    """
    keys = list(cases[0].varied) if cases else []
    paces = (key for key in keys if key.endswith("frequency_hz"))
    # "keep" is no number.
    pace = next((key for key in paces if all(isinstance(item.varied[key], (int, float)) for item in cases)), None)
    if len({item.varied["pedestal"] for item in cases if "pedestal" in keys}) < 2:
        return None
    shape = section(record.scene)
    model = next((name for name in models if name.startswith("analytic")), models[0])
    if pace is None:
        return PedestalEffect(_saved(cases, model))
    fell: dict[tuple[float, str], list[bool]] = {}
    reach: dict[tuple[float, str], float] = {}
    for item, run in runs_of(cases, model):
        setting = "floor" if item.varied["pedestal"] == "none" else "pedestal"
        place = (float(item.varied[pace]), setting)
        fell.setdefault(place, []).append(run.outcome.overturned)
        if run.outcome is Outcome.STANDS:
            theta = run.peak_theta_rad * np.array([-1.0, 1.0])
            moved = float(np.abs(shape.top_displacement_m(theta, np.zeros(2))).max()) + run.peak_slip_m
            reach[place] = max(reach.get(place, 0.0), moved)
    named = {
        each: say(f"{words}.{each}") for each in ("frequency", "on_floor", "on_pedestal", "share_falls", "top", "wall")
    }
    drawn = {"saved": _by_setting(fell, named), "moved": _reach_by_setting(reach, named, record)}
    charts = [Chart(name, say(f"text.pedestal_{name}", model=model), figure) for name, figure in drawn.items()]
    return PedestalEffect(_saved(cases, model), charts)


def _saved(cases: Sequence[Condition], model: str) -> Finding:
    """How often the pedestal prevents, and how often it causes, an overturning under the same condition."""
    pairs: dict[tuple[Any, ...], dict[bool, bool]] = {}
    for item, run in runs_of(cases, model):
        rest = tuple(value for key, value in item.varied.items() if key != "pedestal")
        pairs.setdefault(rest, {})[item.varied["pedestal"] == "none"] = run.outcome.overturned
    saved = Saved.of([(pair[True], pair[False]) for pair in pairs.values() if len(pair) == 2])
    return info("pedestal_saves", model=model, **vars(saved))


SETTINGS: Final = {"floor": FLOOR_COLOUR, "pedestal": PEDESTAL_COLOUR}


def _by_setting(fell: Mapping[tuple[float, str], Sequence[bool]], named: Mapping[str, str]) -> Json:
    places = sorted(fell)
    parts = [
        {
            "kind": named[f"on_{setting}"], "x": [f"{place[0]:g}" for place in mine],
            "y": [100.0 * sum(fell[place]) / len(fell[place]) for place in mine],
            "count": [f"{sum(fell[place])}/{len(fell[place])}" for place in mine],
        }
        for setting in SETTINGS for mine in [[place for place in places if place[1] == setting]]
    ]  # fmt: skip
    colours = {named[f"on_{setting}"]: colour for setting, colour in SETTINGS.items()}
    beside = {"xOffset": {"field": "kind", "sort": list(colours)}}
    bars = marks("bar", "falls", beside | {"color": kinds(colours)})
    words = marks("text", "falls", beside | {"text": {"field": "count"}}, dy=-7, clip=False)
    x = names(
        "x",
        [f"{value:g}" for value in sorted({place[0] for place in places})],
        named["frequency"],
        labelAngle=0,
        grid=False,
    )
    return figure([bars, words], 340, {"falls": parts}, x, upwards("y", named["share_falls"], {"domain": [0, 112]}))


def _reach_by_setting(reach: Mapping[tuple[float, str], float], named: Mapping[str, str], record: StudyRecord) -> Json:
    parts = [
        {"name": named[f"on_{setting}"], "x": [place[0] for place in mine], "y": [reach[place] for place in mine]}
        for setting in SETTINGS for mine in [[place for place in sorted(reach) if place[1] == setting]]
    ]  # fmt: skip
    y = upwards("y", named["top"], {"zero": True})
    wall = record.scene.wall
    lines = [] if wall is None else level(wall.distance_m, named["wall"], line=Look(WALL_COLOUR, "6 4", 1.5))
    looks = {named[f"on_{setting}"]: Look(colour) for setting, colour in SETTINGS.items()}
    return figure(
        [*points("reach", looks, y, first=True), *lines], 340, {"reach": parts}, across("x", named["frequency"]), y
    )
