"""The page of an assessment: how probable the fall is, by each model; what it depends on; how strong a shaking is borne."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from harness.model.assumed import assumption
from harness.model.scene import Uncertain
from harness.probability.by_model import MODEL
from harness.probability.sensitivity import LEAST_DRAWS
from harness.probability.words import CLEAR, advice, reserve, room
from harness.records.assess import (
    AssessRecord,
    ClearanceByModel,
    FragilityRecord,
    Index,
    ProbabilityDifference,
    not_answered,
    percent,
)
from reports.charts import Json
from reports.charts.figure import axis, band, curve, figure
from reports.charts.palette import INK, MUTED
from reports.drawing.conservator_pictures import plan_svg
from reports.drawing.floor_plan import probable_plan
from reports.messages import ENGLISH
from reports.text.chance import tone_of_answers
from reports.text.wording import Verdict

MATTERS: Final = 0.05
"""A total index below this: knowing the input would change next to nothing."""
TICKS: Final = [0.25, 0.5, 1.0, 2.0, 4.0]
"""Factors written on the axis."""


def context(_folder: Path, record: AssessRecord) -> dict[str, object]:
    """Everything that the assess template shows."""
    clearance = record.clearance
    room_words = None if clearance is None else room(clearance)
    plan = None if clearance is None else probable_plan(clearance, CLEAR)
    return {
        "verdict": assess_verdict(record),
        "inputs": [(item, _said(item, record.assumed)) for item in record.uncertainty],
        "totals": any(item.total is not None for item in (record.indices or {}).values()),
        "least_draws": LEAST_DRAWS,
        "chart": None if record.fragility is None else _chart(record.fragility),
        "advice": [] if record.options is None else advice(record.options),
        "planar": record.options is not None and record.options.model == MODEL,
        "room": room_words,
        "plan": plan and plan_svg(record.scene, plan, str(room_words), ENGLISH),
        "clearance": [_clearance(*each) for each in (clearance.answered.items() if clearance else ())],
    }


def assess_verdict(record: AssessRecord) -> Verdict:
    """The first model's probability, then what the others say, and the factors on the motion."""
    answers = record.answers
    if not answers:
        return Verdict("No model could assess this scene", "failed", [])
    # What knows all of the shaking speaks first; the most probable fall decides the colour.
    first = next((name for name, item in answers.items() if not item.plane_only), next(iter(answers)))
    points = [f"{name}: {item.sentence}." for name, item in answers.items()] if len(answers) > 1 else []
    points += not_answered(answers, record.scene.file, pedestal=record.scene.pedestal is not None)
    if record.options is not None:
        points.append(advice(record.options)[0])
    if record.clearance is not None:
        points.append(room(record.clearance))
    if record.fragility is not None:
        points.append(reserve(record.fragility, record.plane_only))
    key, most = max((record.indices or {}).items(), key=lambda item: item[1].most, default=("", Index(0.0, 0.0)))
    if most.most >= max(MATTERS, most.half_width):
        planar = record.plane_only and record.fragility is not None and record.fragility.model == MODEL
        where = "In the rocking plane alone, what" if planar else "What"
        words = ENGLISH.key(key)
        named = key if words is None else f"{words} ({key})"
        points.append(f"{where} decides most is {named}: {percent(min(most.most, 1.0))} % of the doubt hangs on it.")
    points += [_difference(name, item) for name, item in record.difference_from_model.items()]
    return Verdict(f"The statue {answers[first].sentence}", tone_of_answers(answers), points)


def _difference(name: str, item: ProbabilityDifference) -> str:
    low, high = 100.0 * item.low, 100.0 * item.high
    told = (
        f"the model's probability less that of {name} is {100.0 * item.value:+.1f} points ({low:+.1f} to {high:+.1f})"
    )
    if low > 0.0 or high < 0.0:
        return f"The model {'over' if low > 0.0 else 'under'}states the danger: {told}."
    return f"No difference is shown between the model and {name}: {told}."


def _said(item: Uncertain, assumed: bool) -> str:
    """Where a width comes from: the scene's own, or what is assumed of such a key, with its source."""
    given = assumption(item.key)
    if given is None or (given.kind, given.width) != (item.kind, item.width):
        return "the scene's own"
    return given.source if assumed else f"as assumed: {given.source}"


def _clearance(name: str, item: ClearanceByModel) -> tuple[str, list[str], list[tuple[str, list[str]]]]:
    """A model's table by direction, its heads first: quantiles of the outline's way, and at one share of top and pedestal."""
    at = list(item.share).index(CLEAR)
    heads = [f"outline, {percent(share)} of 100" for share in item.share]
    heads += [f"{part}, {percent(CLEAR)} of 100" for part in ("top", "pedestal")]
    columns = zip(*item.outline_m, item.top_m[at], item.pedestal_m[at], strict=True)
    cells = ([f"{value:.3f}\u00a0m" for value in row] for row in columns)
    return name, heads, [(_towards(angle), row) for angle, row in zip(item.direction_deg, cells, strict=True)]


def _towards(angle_deg: float) -> str:
    side = {0.0: "right", 90.0: "back", 180.0: "left", 270.0: "front"}.get(angle_deg)
    return f"{angle_deg:g}°" + (f", {side}" if side else "")


def _chart(fragility: FragilityRecord) -> Json:
    factors, line = fragility.factor, {"color": INK, "width": 2}
    tip = "× %{x:.2f}: %{y:.0%}<extra></extra>"
    mean = curve(factors, fragility.probability_overturned, line, mode="lines+markers", name=fragility.model)
    today = {"color": MUTED, "width": 1, "dash": "4px,3px"}
    data = [
        mean | {"showlegend": False, "hovertemplate": tip},
        curve([1.0, 1.0], [0.0, 1.0], today, name="today's shaking", hoverinfo="skip"),
    ]
    if fragility.low:
        around = [*factors, *reversed(factors)], [*fragility.high, *reversed(fragility.low)]
        data.insert(0, band(*around, INK, 0.1))
    x = axis("factor on the shaking, all axes", type="log", tickvals=TICKS)
    return figure(data, 380, x, axis("probability of overturning", range=[-0.02, 1.02]))
