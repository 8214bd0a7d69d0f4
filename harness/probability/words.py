"""An assessment in plain words: how probable a fall is, the room it needs, and advice only where a change is shown."""

from __future__ import annotations

import math
from typing import Final

from harness.probability.by_model import MODEL
from harness.probability.options import FLOOR, TURNED
from harness.probability.plan import PLANAR_DEG
from harness.records.assess import (
    MOSTLY,
    Assessment,
    AssessRecord,
    ClearanceRecord,
    FragilityRecord,
    OptionAnswer,
    OptionsRecord,
    not_answered,
    percent,
)

CLEAR: Final = 0.95
"""Share of the standing draws whose clearance is told in a sentence."""

FIRST: Final = "0.05"
"""The least probability whose factor is told: what a reserve is."""


def summary(record: AssessRecord) -> str:
    """An assessment in a few lines of plain words."""
    lines = [record.title]
    width = max(len(name) for name in record.assessment)
    for name, item in record.assessment.items():
        if isinstance(item, Assessment):
            lines.append(f"  {name:{width}}  {item.sentence}; {item.engine_runs} runs")
        elif item is not None:
            lines.append(f"  {name:{width}}  not installed: {item.message}")
    lines += [
        f"  {text}"
        for text in not_answered(record.answers, record.scene.file, pedestal=record.scene.pedestal is not None)
    ]
    if record.assumed:
        assumed = ", ".join(f"{item.key} ({item.kind}, {item.width:g})" for item in record.uncertainty)
        lines.append(f"  note: the scene has no table [uncertainty]; assumed are {assumed}")
    if record.options is not None:
        lines += [f"  {line}" for line in advice(record.options)]
    if record.fragility is not None:
        lines.append(f"  {reserve(record.fragility, record.plane_only)}")
    if record.clearance is not None:
        lines.append(f"  {room(record.clearance)}")
    if record.runs is not None and record.runs.computed < record.runs.wanted:
        lines.append(
            f"  {record.runs.wanted - record.runs.computed} of {record.runs.wanted} engine runs found in the store"
        )
    return "\n".join(lines)


def reserve(item: FragilityRecord, plane_only: bool = False) -> str:
    """How much stronger than today's the shaking may be until a fall is as probable as 5, 16 and 50 %, by the model."""
    at_most = f"{item.factor[-1]:g} times today's shaking"
    reached = [asked for asked, factor in item.factor_at.items() if factor is not None]
    each = _listed([_factor(item, asked) for asked in reached])
    open_ = max(item.undecided, default=0.0)
    counted = f" Draws without an answer, up to {percent(open_)} %, fall in the lower factor and stand in the higher."
    after = counted if open_ else ""
    if plane_only and item.model == MODEL:
        said = "In the rocking plane alone a fall is"
        if not reached:
            return f"{said} less probable than 5 % at all strengths tried, up to {at_most}.{after}"
        return f"{said} as probable as {each} today's shaking.{after}"
    soonest = item.soonest_at.get(FIRST, item.factor_at[FIRST])
    word = "No reserve" if (item.factor_at[FIRST] or math.inf) <= 1.0 else "Reserve"
    if word == "Reserve" and (soonest or math.inf) <= 1.0:
        word = "No reserve is shown"
    if not reached:
        beyond = "" if soonest is None else f", as far as draws tell; it may be as probable from {soonest:.2f} times on"
        return f"{word}: at {at_most} a fall is still less probable than 5 %{beyond}.{after}"
    return f"{word}: a fall is as probable as {each} today's shaking.{after}"


def _factor(item: FragilityRecord, asked: str) -> str:
    """`5 % at 1.10 (1.02 to 1.20) times`; the range is what draws leave open."""
    soonest, latest = (at.get(asked, item.factor_at[asked]) for at in (item.soonest_at, item.latest_at))
    low, high = (f"beyond {item.factor[-1]:g}" if at is None else f"{at:.2f}" for at in (soonest, latest))
    between = "" if low == high else f" ({low} to {high})"
    return f"{percent(float(asked))} % at {item.factor_at[asked]:.2f}{between} times"


def room(item: ClearanceRecord) -> str:
    """How much must be kept clear, in which direction, by the model that knows most of them; and what a fall needs."""
    falls = f"one that falls needs its height, {item.height_m:.2f} m"
    few = {name: each for name, each in item.by_model.items() if name not in item.answered}
    silent = "".join(
        f"; in {name} only {each.standing} of {each.draws} draws stand, too few to tell" for name, each in few.items()
    )
    silent += "".join(
        f"; left out are draws of {name} without an answer, {each.undecided} of {each.draws}"
        for name, each in item.by_model.items()
        if each.undecided
    )
    name, answer = next(iter(item.answered.items()), ("", None))
    if answer is None:
        return f"Clearance{silent}; {falls}."
    beyond = answer.at(CLEAR)
    if len(beyond) == len(PLANAR_DEG):
        right, left = beyond.values()
        where = f"{right:.2f} m beyond its right side and {left:.2f} m beyond its left"
    else:
        most_m, least_m = max(beyond.values()), min(beyond.values())
        towards = next(angle for angle, value in beyond.items() if value == most_m)
        where = f"{most_m:.2f} m beyond where it rests, all round (most towards {towards:g}°, seen from above, anticlockwise "
        where += f"from its right; least {least_m:.2f} m)"
    return f"Clearance, by {name}: where it stands, in 95 of 100 its outline stays within {where}{silent}; {falls}."


def advice(record: OptionsRecord) -> list[str]:
    """The recommendation first, then what would harm, then the paper's claim on this statue's pedestal."""
    helping = sorted(record.helping, key=_rank)
    sentences = [_recommended(record, helping) if helping else _nothing(record)]
    if record.plane_only:
        sentences.append("Options are compared in the rocking plane: the shaking across it is in none of them.")
    if record.harming:
        names = _listed([item.name for item in record.harming])
        sentences.append(f"A fall becomes more probable with: {names}.")
    floor = next((item for item in record.options if item.name == FLOOR), None)
    return sentences if floor is None else [*sentences, _claim(record.as_it_is, floor)]


def _rank(item: OptionAnswer) -> tuple[float, bool, float]:
    """The less probable fall first, then less slip; what is turned comes last: its weak side is one that no draw shakes."""
    return item.probability_overturned, item.name == TURNED, item.slip_high_m or 0.0


def _recommended(record: OptionsRecord, helping: list[OptionAnswer]) -> str:
    best = helping[0]
    equal = [item for item in helping[1:] if item.low <= best.high]
    words = f"What would help most: {best.name}. The statue then falls in {percent(best.probability_overturned)} %, "
    words += f"as it is in {percent(record.as_it_is.probability_overturned)} %"
    if best.slip_high_m:
        words += f"; the pedestal slides by up to {best.slip_high_m:.2g} m in 95 of 100"
    if equal:
        words += f". As good, as far as can be told: {_listed([item.name for item in equal])}"
    return words + "."


def _nothing(record: OptionsRecord) -> str:
    if record.as_it_is.high + record.as_it_is.undecided < 0.01 and not record.plane_only:
        return "Nothing need be done against a fall: none of these options makes it less probable."
    return "Nothing is recommended: none of these options is shown to make a fall less probable."


def _claim(own: OptionAnswer, floor: OptionAnswer) -> str:
    """Whether a pedestal that slides protects: the paper's claim, answered by this statue on the floor."""
    falls = f"on the floor it falls in {percent(floor.probability_overturned)} %"
    falls += f", on its pedestal in {percent(own.probability_overturned)} %"
    if own.undecided > MOSTLY:
        return f"Whether its pedestal protects this statue is not told: in {percent(own.undecided)} % the model has no answer."
    if not own.slip_high_m:
        return f"The pedestal does not slide, and so protects nothing by it: {falls}."
    if floor.harms:
        return f"The sliding pedestal protects this statue: {falls}."
    if floor.helps:
        return f"The sliding pedestal does not protect this statue, it endangers it: {falls}."
    return f"That the sliding pedestal protects this statue is not shown: {falls}."


def _listed(names: list[str]) -> str:
    return "; ".join(names)
