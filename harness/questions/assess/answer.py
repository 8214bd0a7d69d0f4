"""What an assessment says: how probable a fall is, what reserve is left, what would help, and the room that it needs."""

import math
import shlex
from collections.abc import Iterator, Mapping
from typing import Any, Final

from harness.model import Answer, Finding, caution, info
from harness.questions.assess.clearance import PLANAR_DEG
from harness.questions.assess.probability import MODEL
from harness.records.assess import (
    CONTRADICTED,
    FLOOR,
    MOSTLY,
    TURNED,
    Assessment,
    AssessRecord,
    ClearanceRecord,
    FragilityRecord,
    Index,
    NotAssessed,
    OptionAnswer,
    OptionsRecord,
    ProbabilityDifference,
    worst,
)

CLEAR: Final = 0.95
"""Share of the standing draws whose clearance is told."""
FIRST: Final = "0.05"
"""The least probability whose factor is told: what a reserve is."""
MATTERS: Final = 0.05
"""A total index below this: knowing the input would change next to nothing."""
NEGLIGIBLE: Final = 0.01
"""A statue that overturns less often than this needs nothing done."""


def answer_of(record: AssessRecord) -> Answer:
    """The headline: the probability, the reserve, the most effective option, the clearance."""
    found = [probability(record.answers)]
    code = found[0].code
    alone = "plane" if record.plane_only else "alone" if record.contradicted else ""
    found += [] if record.fragility is None else [reserve(record.fragility, alone)]
    found += [] if record.options is None else [best_option(record.options, contradicted=record.contradicted)]
    room = record.whole_clearance
    return Answer(code, found + ([] if room is None else [clearance(room)]))


def findings_of(record: AssessRecord) -> list[Finding]:
    """All that is to be known beside the headline."""
    found = [
        (caution("no_run_ended", runs=item.runs) if item.runs else caution("not_assessed", reason=item.message)).of(
            name
        )
        for name, item in record.assessment.items()
        if isinstance(item, NotAssessed)
    ]
    found += _other_commands(record.answers, record.scene.file, pedestal=record.scene.pedestal is not None)
    found += [_difference(name, item) for name, item in record.difference_from_model.items()]
    found += [] if record.options is None else of_options(record.options, contradicted=record.contradicted)
    found += [] if record.clearance is None else without_clearance(record.clearance)
    key, most = max((record.indices or {}).items(), key=lambda item: item[1].most, default=("", Index(0.0, 0.0)))
    if most.most >= max(MATTERS, most.half_width):
        planar = record.plane_only and record.fragility is not None and record.fragility.model == MODEL
        # Of the same draws: a difference is known better than by both widths, so that none is left out that may matter more.
        equal = [
            other
            for other, item in (record.indices or {}).items()
            if other != key and most.most - item.most <= math.hypot(most.half_width, item.half_width)
        ]
        found.append(info("decisive_input", input=key, share=min(most.most, 1.0), planar=planar, equal=equal))
    if record.assumed:
        found.append(info("uncertainty_assumed", keys=[item.key for item in record.uncertainty]))
    if record.runs is not None and record.runs.computed < record.runs.wanted:
        found.append(info("runs_kept", kept=record.runs.wanted - record.runs.computed, of=record.runs.wanted))
    return found


def probability(answers: Mapping[str, Assessment], *, contradicted: bool = False) -> Finding:
    """How probable a fall is, by the answer in which it is the most probable.

    The interval of one model's draws holds neither another model nor a friction that nobody knows: so a number is `about`; where
    draws have no answer, or an engine answered a sample of them, the interval is told, and where it is wide no number at all.
    `contradicted`: with the values as given a model in space ends otherwise, by what a model in the plane leaves out.
    """
    name = worst(answers)
    item = answers[name]
    values = {
        "share": item.probability_overturned,
        "low": item.low,
        "high": item.high,
        "undecided": max(item.undecided - item.touches_wall, 0.0),
        "touches_wall": item.touches_wall,
        "model": name,
        "planar": [CONTRADICTED if contradicted else "in_plane"] if item.plane_only else [],
        "sampled": item.sampled,
        "sampler": item.sampler,
    }
    if not item.tells:
        return caution("probability_open", **values)
    if item.undecided or item.sampled:
        return caution("probability_between", **values)
    if item.probability_overturned in (0.0, 1.0):
        return info("probability_extreme", none=item.probability_overturned == 0.0, **values)
    return info("probability", **values)


def _other_commands(answers: Mapping[str, Assessment], file: str | None, *, pedestal: bool) -> Iterator[Finding]:
    """The command that knows what every answer leaves out: the shaking across the plane, or most draws on a pedestal."""
    scene = shlex.quote(file) if file else "SCENE"
    if answers and all(item.plane_only for item in answers.values()):
        yield caution("assess_in_space", file=scene)
    if list(answers) == [MODEL] and pedestal and not answers[MODEL].tells:
        yield caution("assess_by_contact", file=scene)


def _difference(name: str, item: ProbabilityDifference) -> Finding:
    values = {"model": name, "difference": item.value, "low": item.low, "high": item.high}
    if item.low <= 0.0 <= item.high:
        return info("probability_difference", shown="none", **values)
    if item.low > 0.0:
        return caution("probability_difference", shown="over", **values)
    less = {"difference": -item.value, "low": -item.high, "high": -item.low}
    return caution("probability_difference", shown="under", **values | less)


def reserve(item: FragilityRecord, alone: str = "") -> Finding:
    """How much stronger than today's the shaking may be until a fall is as probable as 5, 16 and 50 %, by the model.

    `alone`: the analytic model's is none, as it leaves a part of the shaking out ("plane") or others contradict it ("alone").
    """
    soonest, latest = ({**item.factor_at, **at} for at in (item.soonest_at, item.latest_at))
    # A probability that the weakest shaking tried already has is reached by that, or by less.
    weakest = item.factor[0]
    factors = {
        share: [soonest[share], at, latest[share], weakest] for share, at in item.factor_at.items() if at is not None
    }
    kind = "none" if (item.factor_at[FIRST] or math.inf) <= 1.0 else "some"
    if kind == "some" and (soonest[FIRST] or math.inf) <= 1.0:
        kind = "open"
    values = {
        "factors": factors,
        "most": None if factors or soonest[FIRST] else item.factor[-1],
        "soonest": None if factors else soonest[FIRST],
        "undecided": max(item.undecided, default=0.0),
        "model": item.model,
    }
    if alone and item.model == MODEL:
        return caution("reserve", kind=alone, **values)
    return info("reserve", kind=kind, **values) if kind == "some" else caution("reserve", kind=kind, **values)


def clearance(item: ClearanceRecord) -> Finding:
    """How much must be kept clear, in which direction, by the model that knows most of them; and what a fall needs."""
    name, answer = next(iter(item.answered.items()), ("", None))
    if answer is None:
        return caution("clearance", by="none", height_m=item.height_m)
    beyond_m = answer.at(CLEAR)
    values: dict[str, Any] = {"model": name, "height_m": item.height_m}
    if len(beyond_m) == len(PLANAR_DEG):
        right_m, left_m = beyond_m.values()
        return info("clearance", by="plane", right_m=right_m, left_m=left_m, **values)
    towards_deg, most_m = max(beyond_m.items(), key=lambda each: each[1])
    least_m = round(min(beyond_m.values()), 4)  # a tenth of a millimetre is none that anyone keeps free
    return info("clearance", by="space", most_m=most_m, towards_deg=towards_deg, least_m=least_m, **values)


def without_clearance(item: ClearanceRecord) -> Iterator[Finding]:
    """Models of which too few draws stand, and draws that the clearance leaves out."""
    for name, each in item.by_model.items():
        if name not in item.answered:
            yield caution("clearance_few", standing=each.standing, draws=each.draws).of(name)
        if each.undecided:
            yield caution("clearance_undecided", undecided=each.undecided, draws=each.draws).of(name)


def best_option(record: OptionsRecord, *, contradicted: bool = False) -> Finding:
    """The option with the least probable fall, of those shown to help, a draw without an end taken for one: the less slip first;
    what is turned comes last, as its weak side is one that no draw shakes.
    """
    helping = sorted(
        record.helping,
        key=lambda item: (item.probability_overturned + item.undecided, item.name == TURNED, item.slip_high_m or 0.0),
    )
    now = record.as_it_is
    if not helping:
        needed = record.plane_only or contradicted or now.high >= NEGLIGIBLE
        return info("no_option_helps", needed=needed if record.options[1:] else "none_compared")
    best, *others = helping
    return info(
        "best_option",
        option=best.name,
        share=best.probability_overturned,
        undecided=best.undecided or None,
        now=now.probability_overturned if now.tells else None,
        slip_m=best.slip_high_m,
        equal=[item.name for item in others if item.low <= best.high],
    )


def of_options(record: OptionsRecord, *, contradicted: bool = False) -> Iterator[Finding]:
    """What would harm, and the paper's claim: whether a pedestal that slides protects, answered by this statue on the floor."""
    if record.plane_only:
        yield caution("options_in_plane")
    elif contradicted and record.model == MODEL:
        yield caution("options_contradicted")
    if record.harming:
        yield caution("options_harm", options=[item.name for item in record.harming])
    floor = next((item for item in record.options if item.name == FLOOR), None)
    if floor is not None:
        yield pedestal_effect(record.as_it_is, floor)


def pedestal_effect(own: OptionAnswer, floor: OptionAnswer) -> Finding:
    """Whether the pedestal protects by sliding."""
    shown = "protects" if floor.harms else "endangers" if floor.helps else "not_shown"
    if own.undecided > MOSTLY or not own.slip_high_m:
        shown = "undecided" if own.undecided > MOSTLY else "stuck"
    shares = {"own": own.probability_overturned, "floor": floor.probability_overturned}
    return info("pedestal_effect", shown=shown, undecided=own.undecided, **shares)
