"""The conservator's page of a study: how often the statue falls, how strong a shaking it bore, what the pedestal changed."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

from harness.model.history import Outcome
from harness.records.effects3d import EffectsRecord
from harness.records.study import StudyRecord, StudyRow, Value
from reports.blocks import Block, Drawing
from reports.charts.drawn import still
from reports.charts.map_figures import map_axes, map_figures
from reports.messages import ENGLISH, Language
from reports.pages.conservator import ENDS, order_picture, plain_page, push_picture, reach_picture
from reports.source import run_source
from reports.text.giving_way import compass, pedestal_effect, scan_turn_deg, support_of
from reports.text.wording import Condition, conditions, family, runs_of, tone_of_study, varying_keys

WIDTH: Final = 480
"""Width of the charts among the page's pictures."""
AXES: Final = {"frequency_hz": "plain.frequency", "amplitude_g": "plain.strength", "pga_g": "plain.strength"}
"""The words of a map's axis with their unit, by the last part of its key; others have the key's own."""
SEVERE: Final = ("stands", "failed", "other", "wall", "overturns")
"""Families of outcomes, the worst for the statue last."""
STRENGTHS: Final = (
    "motion.scale",
    *(f"motion.{axis}.{name}" for axis in "xy" for name in ("amplitude_g", "scale", "pga_g")),
)
"""Keys that vary the strength of a level shaking."""


def blocks(folder: Path, record: StudyRecord | EffectsRecord, say: Language = ENGLISH) -> list[Block]:
    """The blocks of the conservator's page of a study."""
    return of_study(record, say) if isinstance(record, StudyRecord) else of_effects(folder, record, say)


def of_study(record: StudyRecord, say: Language = ENGLISH) -> list[Block]:
    """Headline, points and pictures of a study."""
    models, cases = conditions(record.rows)
    ends = {model: [run.outcome for _, run in runs_of(cases, model)] for model in models}
    ends = {model: outcomes for model, outcomes in ends.items() if outcomes}
    said = [*_asked(record, models, say), *_by_variant(ends, say), *_bore(cases, say)]
    tone = tone_of_study(family(outcome) for outcomes in ends.values() for outcome in outcomes)
    basis = [*_agree(record, say), say("chance.unknown")]
    pictures = [*_map(record, cases, say), *_pictures(record, models, cases, say)]
    return plain_page(_headline(ends, say), tone, said, [say("todo.ask")], pictures, basis, say)


def _headline(ends: Mapping[str, Sequence[Outcome]], say: Language) -> str:
    """In how many situations it falls, by the models that answered the most of them."""
    if not ends:
        return say("study.nothing")
    most = max(map(len, ends.values()))
    whole = {model: outcomes for model, outcomes in ends.items() if len(outcomes) == most}
    falls = {_falls(outcomes) for outcomes in whole.values()}
    if len(falls) == 1:
        return say("study.falls", falls=falls.pop(), total=most)
    parts = [{model.partition(" (")[0] for model in whole}, {model.partition(" (")[2] for model in whole}]
    named = zip(("study.model", "study.variant"), parts, strict=True)
    by = say.listed(say(key) for key, names in named if len(names) > 1)
    return say("study.falls_between", least=min(falls), most=max(falls), total=most, by=by)


def _by_variant(ends: Mapping[str, Sequence[Outcome]], say: Language) -> list[str]:
    """What the models say of each variant; whatever is neither a fall nor standing is named."""
    variants: dict[str, list[Sequence[Outcome]]] = {}
    for model, outcomes in ends.items():
        variants.setdefault(model.partition(" (")[2][:-1], []).append(outcomes)
    sentences = []
    for variant, answers in variants.items():
        kinds = [Counter(map(_end_key, outcomes)) for outcomes in answers]
        others = dict.fromkeys(key for counts in kinds for key in counts if key not in ("falls", "stands"))
        each = [
            say("study.more_silent", count=_between([counts[key] for counts in kinds], say))
            if key == "silent"
            else say("study.more_end", end=say(f"end.{key}"), count=_between([counts[key] for counts in kinds], say))
            for key in others
        ]
        more = say("study.more", ends=say.listed(each)) if each else ""
        falls, total = _between([counts["falls"] for counts in kinds], say), _between(list(map(len, answers)), say)
        key = "study.by_one" if len(variants) == 1 else "study.by_variant"
        sentences.append(say(key, variant=variant, falls=falls, total=total, more=more))
    return sentences


def _end_key(outcome: Outcome) -> str:
    if outcome.failed:
        return "silent"
    return "falls" if outcome.overturned else ENDS.get(outcome, "other")


def _between(counts: Sequence[int], say: Language) -> str:
    least, most = min(counts), max(counts)
    return str(least) if least == most else say("study.between", least=least, most=most)


def _falls(outcomes: Sequence[Outcome]) -> int:
    return sum(outcome.overturned for outcome in outcomes)


def _asked(record: StudyRecord, models: Sequence[str], say: Language) -> list[str]:
    varied = [say.key(key) or say("key.other") for key in record.vary]
    variants = list(dict.fromkeys(model.partition(" (")[2][:-1] for model in models))
    said = [say("study.varied", keys=say.listed(dict.fromkeys(varied)))] if varied else []
    names = say.listed(f"“{name}”" for name in variants)
    return [*said, *([say("study.variants", names=names)] if len(variants) > 1 else [])]


def _strength(cases: Sequence[Condition]) -> str | None:
    """The key that varies the strength of the shaking."""
    keys = cases[0].varied if cases else ()
    return next((key for key in keys if key in STRENGTHS), None)


def _borne(cases: Sequence[Condition], key: str) -> float | None:
    """The strongest level of the shaking up to which the statue stood in every situation and every model; None without one."""
    ends: dict[float, set[str]] = {}
    for item in cases:
        answered = {family(row.run.outcome) for row in item.answers.values() if row.run is not None}
        ends.setdefault(abs(float(item.varied[key])), set()).update(answered)
    safe = itertools.takewhile(lambda level: ends[level] == {"stands"}, sorted(level for level in ends if ends[level]))
    return max(safe, default=None)


def _bore(cases: Sequence[Condition], say: Language) -> list[str]:
    """The strongest shaking that it bore; where there is none, the weakest that was tried."""
    key = _strength(cases)
    if key is None:
        return []
    safe, tried = _borne(cases, key), [abs(float(item.varied[key])) for item in cases]
    level = min(tried) if safe is None else safe
    return [say("study.weakest" if safe is None else "study.borne", level=_level(key, level, say))]


def _level(key: str, value: float, say: Language) -> str:
    """How strong a shaking is, by the key that varies it."""
    kind = "weight" if key.endswith("_g") else "record" if key.endswith("scale") else "other"
    words, number = say.key(key) or say("key.other"), say.short(value)
    return say(f"study.level_{kind}", push=say.percent(value), factor=number, key=words, value=number)


def _by_direction(record: StudyRecord, cases: Sequence[Condition]) -> dict[float, float]:
    """The strongest shaking borne by direction of the push, where the study turned the statue and varied the amplitude in g.

    A statue turned by an angle under a shaking along x is one shaken along minus that angle, to both sides.
    """
    turn = next((key for item in cases for key in item.varied if key.endswith("azimuth_deg")), None)
    strength = _strength(cases)
    if turn is None or strength is None or not strength.endswith("_g"):
        return {}
    own = scan_turn_deg(record.scene)
    borne = {}
    for angle in {float(item.varied[turn]) for item in cases}:
        safe = _borne([item for item in cases if float(item.varied[turn]) == angle], strength)
        for side in (0.0, 180.0):
            borne[(own - angle + side) % 360.0] = safe or 0.0
    return borne


def _agree(record: StudyRecord, say: Language) -> list[str]:
    """How often the other models end as the reference does: the record's own count."""
    scores = [each for each in (record.scores or {}).values() if each.cases]
    if not scores:
        return []
    same, total = sum(each.same for each in scores), sum(each.cases for each in scores)
    count = say.count(len(scores) + 1)
    return [say("study.agree", count=count[0].upper() + count[1:], same=same, total=total)]


def _pictures(record: StudyRecord, models: Sequence[str], cases: Sequence[Condition], say: Language) -> list[Drawing]:
    """Reach and effect of the pedestal where the study varied it; else what gives way first."""
    scene, support = record.scene, record.supports or support_of(record.scene)
    push = push_picture(scene, support, say, borne=_by_direction(record, cases))
    effect = pedestal_effect(record, models, cases, say, "plain")
    if effect is None:
        return [push, order_picture(scene, support, say)]
    saved_words = say("study.saved", **effect.finding.values)
    if not effect.charts:
        order = order_picture(scene, support, say)
        return [push, replace(order, caption=[*order.caption, saved_words])]
    saved, moved = (still(each.figure, WIDTH) for each in effect.charts)
    return [
        Drawing(moved, [say("study.far")], heading=say("study.top")),
        push,
        Drawing(saved, [saved_words], heading=say("order.heading_pedestal")),
    ]


def _map(record: StudyRecord, cases: Sequence[Condition], say: Language) -> list[Drawing]:
    """Where it falls, over the two keys of the study's own map: at each place the worst that any answer there says."""
    axes = map_axes(cases, [key for key in record.vary if key in varying_keys(cases)])
    if axes is None or record.panels:
        return []
    worst: dict[tuple[Value, ...], StudyRow] = {}
    for item in cases:
        place = tuple(item.varied[key] for key in axes)
        for row in item.answers.values():
            if place not in worst or _severity(row) > _severity(worst[place]):
                worst[place] = row
    places = [Condition(dict(zip(axes, place, strict=True)), {"": row}) for place, row in worst.items()]
    figures = map_figures([""], places, axes, say)
    if not figures:
        return []
    _, figure = figures[0]
    for side, key in zip("xy", axes, strict=True):
        last = key.rsplit(".", 1)[-1]
        named = say(AXES[last]) if last in AXES else say.key(key) or say("key.other")
        figure["encoding"][side]["title"] = named
    figure["layer"][0]["encoding"]["fill"]["legend"] = None
    seen = sorted({_severity(row) for row in worst.values()} - {-1}, reverse=True)
    words = [say("map.seen"), " ".join(say(f"map.{SEVERE[k]}") for k in seen)]
    return [Drawing(still(figure, WIDTH), words, heading=say("map.heading"))]


def _severity(row: StudyRow) -> int:
    """Place of what a row says among `SEVERE`; nothing computed is the least."""
    return -1 if row.run is None else SEVERE.index(family(row.run.outcome))


def of_effects(folder: Path, record: EffectsRecord, say: Language = ENGLISH) -> list[Block]:
    """Headline, points and pictures of an effects study: the shaking borne by direction, over all its conditions and models."""
    borne: dict[float, float] = {}
    for row in record.rows:
        borne[row.azimuth_deg] = min(borne.get(row.azimuth_deg, math.inf), row.stands_at_g)
    weak, strong = (choose(borne, key=lambda key: borne[key]) for choose in (min, max))
    scene, support = record.scene, support_of(record.scene)
    pictures = [push_picture(scene, support, say, borne=borne), order_picture(scene, support, say)]
    if record.replay:
        pictures.insert(0, reach_picture(run_source(folder / record.replay.folder), say, "reach.replayed"))
    variants = len({row.condition for row in record.rows})
    strongest = say.percent(borne[strong])
    points = [
        say("study.effects_least", weak=compass(weak, say), strong=compass(strong, say), push=strongest),
        say("study.effects_directions", count=len(borne), variants=variants),
        say("study.effects_form"),
    ]
    # What shaking is borne says nothing of how probable a fall is: never green.
    headline = say("study.effects", push=say.percent(borne[weak]))
    return plain_page(headline, "differ", points, [say("todo.ask")], pictures, [], say)
