"""The page of an assessment: how probable the fall is, by each model; what it depends on; how strong a shaking is borne."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from harness.input.uncertain import assumption
from harness.model.scene import Uncertain
from harness.probability.answer import CLEAR, clearance
from harness.probability.by_model import MODEL
from harness.probability.sensitivity import LEAST_DRAWS
from harness.records.assess import (
    AssessRecord,
    ClearanceByModel,
    FragilityRecord,
)
from reports.charts import Json
from reports.charts.figure import axis, band, curve, figure
from reports.charts.palette import INK, MUTED
from reports.drawing.conservator_pictures import plan_svg
from reports.drawing.floor_plan import probable_plan
from reports.messages import ENGLISH, probability_text
from reports.text.chance import tone_of_answers
from reports.text.limits import by_severity
from reports.text.wording import Verdict

TICKS: Final = [0.25, 0.5, 1.0, 2.0, 4.0]
"""Factors written on the axis."""


def context(_folder: Path, record: AssessRecord) -> dict[str, object]:
    """Everything that the assess template shows."""
    room = record.clearance
    plan = None if room is None else probable_plan(room, CLEAR)
    return {
        "verdict": assess_verdict(record),
        "notes": by_severity(record.findings),
        "inputs": [(item, _said(item, record.assumed)) for item in record.uncertainty],
        "totals": any(item.total is not None for item in (record.indices or {}).values()),
        "least_draws": LEAST_DRAWS,
        "chart": None if record.fragility is None else _chart(record.fragility),
        "planar": record.options is not None and record.options.model == MODEL,
        "plan": room and plan and plan_svg(record.scene, plan, ENGLISH.say(clearance(room)), ENGLISH),
        "clearance": [_clearance(*each) for each in (room.answered.items() if room else ())],
    }


def assess_verdict(record: AssessRecord) -> Verdict:
    """The record's answer, in the colour of the most probable fall."""
    answers, told = record.answers, record.answer
    first, *points = [each.text for each in told.findings] if told else [""]
    return Verdict(first, tone_of_answers(answers) if answers else "failed", points)


def _said(item: Uncertain, assumed: bool) -> str:
    """Where a width comes from: the scene's own, or what is assumed of such a key, with its source."""
    given = assumption(item.key)
    if given is None or (given.kind, given.width) != (item.kind, item.width):
        return "the scene's own"
    return given.source if assumed else f"as assumed: {given.source}"


def _clearance(name: str, item: ClearanceByModel) -> tuple[str, list[str], list[tuple[str, list[str]]]]:
    """A model's table by direction, its heads first: quantiles of the outline's way, and at one share of top and pedestal."""
    at = list(item.share).index(CLEAR)
    heads = [f"outline, {probability_text(share)} of 100" for share in item.share]
    heads += [f"{part}, {probability_text(CLEAR)} of 100" for part in ("top", "pedestal")]
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
