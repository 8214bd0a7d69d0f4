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
from reports.charts.figure import axis, curve, figure, level, note
from reports.charts.study_figures import FLOOR_COLOUR, PEDESTAL_COLOUR
from reports.drawing.kinematics import section
from reports.messages import ENGLISH
from reports.messages.numbers import heading
from reports.text.study_rows import Condition, runs_of

WALL_COLOUR: Final = "#8c1d2f"


@dataclass(frozen=True)
class PedestalEffect:
    """What a model says it saves, and charts of the share of falls (`saved`) and of the reach (`moved`).

    There are charts where the study varies a frequency.
    """

    finding: Finding
    charts: Sequence[Chart] = ()


def pedestal_effect(record: StudyRecord, models: Sequence[str], cases: Sequence[Condition]) -> PedestalEffect | None:
    """The effect in a study with and without pedestal, by its first analytic model; None for other studies."""
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
        setting = "on the floor" if item.varied["pedestal"] == "none" else "on the pedestal"
        place = (float(item.varied[pace]), setting)
        fell.setdefault(place, []).append(run.outcome.overturned)
        if run.outcome is Outcome.STANDS:
            theta = run.peak_theta_rad * np.array([-1.0, 1.0])
            moved = float(np.abs(shape.top_displacement_m(theta, np.zeros(2))).max()) + run.peak_slip_m
            reach[place] = max(reach.get(place, 0.0), moved)
    by_pace = heading(pace)
    drawn = {"saved": _by_setting(fell, by_pace), "moved": _reach_by_setting(reach, by_pace, record)}
    charts = [Chart(name, ENGLISH(f"text.pedestal_{name}", model=model), figure) for name, figure in drawn.items()]
    return PedestalEffect(_saved(cases, model), charts)


def _saved(cases: Sequence[Condition], model: str) -> Finding:
    """How often the pedestal prevents, and how often it causes, an overturning under the same condition."""
    pairs: dict[tuple[Any, ...], dict[bool, bool]] = {}
    for item, run in runs_of(cases, model):
        rest = tuple(value for key, value in item.varied.items() if key != "pedestal")
        pairs.setdefault(rest, {})[item.varied["pedestal"] == "none"] = run.outcome.overturned
    saved = Saved.of([(pair[True], pair[False]) for pair in pairs.values() if len(pair) == 2])
    return info("pedestal_saves", model=model, **vars(saved))


def _by_setting(fell: Mapping[tuple[float, str], Sequence[bool]], title: str) -> Json:
    data = []
    for setting, colour in (("on the floor", FLOOR_COLOUR), ("on the pedestal", PEDESTAL_COLOUR)):
        places = sorted(place for place in fell if place[1] == setting)
        shares = [100.0 * sum(fell[place]) / len(fell[place]) for place in places]
        text = [f"{sum(fell[place])}/{len(fell[place])}" for place in places]
        data.append(
            {
                "type": "bar", "name": setting, "x": [f"{place[0]:g}" for place in places], "y": shares, "text": text,
                "textposition": "outside", "cliponaxis": False, "marker": {"color": colour},
            }
        )  # fmt: skip
    x, y = {"title": {"text": title}, "type": "category"}, axis("overturns  [%]", range=[0, 112])
    return figure(data, 360, x, y, barmode="group")


def _reach_by_setting(reach: Mapping[tuple[float, str], float], title: str, record: StudyRecord) -> Json:
    data = []
    for setting, colour in (("on the floor", FLOOR_COLOUR), ("on the pedestal", PEDESTAL_COLOUR)):
        places = [place for place in sorted(reach) if place[1] == setting]
        x, y = [place[0] for place in places], [reach[place] for place in places]
        data.append(curve(x, y, {"color": colour}, name=setting, mode="lines+markers"))
    wall, lines = record.scene.wall, {}
    if wall is not None:
        at = wall.distance_m
        dashed = {"color": WALL_COLOUR, "width": 1.5, "dash": "dash"}
        words = note(1, at, "wall", xref="paper", xanchor="right", yanchor="bottom")
        lines = {"shapes": [level(at, dashed)], "annotations": [words]}
    return figure(data, 360, axis(title), axis("top moves by  [m]", rangemode="tozero"), **lines)
