"""The conservator's page of a study: how often the statue falls, how strong a shaking it bore, what the pedestal changed."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from harness.model.history import Outcome
from harness.records.effects3d import EffectsRecord
from harness.records.study import StudyRecord
from reports.charts.static_svg import still
from reports.pages.conservator import reach_picture
from reports.pages.conservator_parts import LIMITS, Picture, end_words, order_picture, push_picture
from reports.source import run_source
from reports.text.chance import tone_of_outcomes
from reports.text.giving_way import compass, scan_turn_deg, study_support, support_of
from reports.text.numbers import count_word, heading, listed, percent, short
from reports.text.pedestal_effect import pedestal_effect
from reports.text.study_rows import Condition, agreement, conditions, family

WIDTH: Final = 480
"""Width of the charts among the page's pictures."""
PLAIN: Final[Mapping[str, str]] = {
    "restitution": "how much an impact throws back",
    "amplitude_g": "the strength of the shaking",
    "scale": "the strength of the shaking",
    "frequency_hz": "how fast the floor swings",
    "pedestal": "with or without the pedestal",
    "azimuth_deg": "the direction of the shaking",
}
AXES: Final[Mapping[str, str]] = {
    "frequency [Hz]": "swings of the floor in a second",
    "top moves by  [m]": "top moves by (metres)",
    "overturns  [%]": "situations in which it falls (%)",
}
"""Keys and axes of a study in plain words."""
STRENGTHS: Final = (
    "motion.scale",
    *(f"motion.{axis}.{name}" for axis in "xy" for name in ("amplitude_g", "scale", "pga_g")),
)
"""Keys that vary the strength of a level shaking."""


def context(folder: Path, record: StudyRecord | EffectsRecord) -> dict[str, object]:
    """Everything that the conservator's template shows of a study."""
    page = of_study(record) if isinstance(record, StudyRecord) else of_effects(folder, record)
    return page | {"title": record.title, "limits": LIMITS, "versions": record.versions}


def of_study(record: StudyRecord) -> dict[str, Any]:
    """Headline, points and pictures of a study."""
    models, cases = conditions(record.rows)
    ends = {model: _ends(cases, model) for model in models}
    ends = {model: outcomes for model, outcomes in ends.items() if outcomes}
    return {
        "headline": _headline(ends),
        "tone": tone_of_outcomes([family(outcome) for outcomes in ends.values() for outcome in outcomes]),
        "points": [*_asked(record, models), *_by_model(ends), *_bore(cases), *_agree(models, cases)],
        "pictures": _pictures(record, models, cases),
    }


def _ends(cases: Sequence[Condition], model: str) -> list[Outcome]:
    """The outcomes of one model, condition after condition that it answered."""
    rows = [item.answers.get(model) for item in cases]
    return [Outcome(row.run.outcome) for row in rows if row is not None and row.run is not None]


def _headline(ends: Mapping[str, Sequence[Outcome]]) -> str:
    """In how many situations it falls, by the models that answered the most of them."""
    if not ends:
        return "Nothing was computed"
    most = max(map(len, ends.values()))
    whole = {model: outcomes for model, outcomes in ends.items() if len(outcomes) == most}
    falls = {_falls(outcomes) for outcomes in whole.values()}
    if len(falls) == 1:
        return f"The statue falls in {falls.pop()} of {most} situations that were tried"
    parts = [{model.partition(" (")[0] for model in whole}, {model.partition(" (")[2] for model in whole}]
    by = listed(name for name, names in zip(("model", "variant"), parts, strict=True) if len(names) > 1)
    return (
        f"The statue falls in {min(falls)} to {max(falls)} of {most} situations that were tried, depending on the {by}"
    )


def _by_model(ends: Mapping[str, Sequence[Outcome]]) -> list[str]:
    """What each model says of the situations that it answered; whatever is neither a fall nor standing is named."""
    sentences = []
    for model, outcomes in ends.items():
        other = Counter(
            "no answer came" if outcome.failed else f"it {end_words(outcome)}"
            for outcome in outcomes
            if not outcome.overturned and outcome is not Outcome.STANDS
        )
        more = f"; {listed(f'{words} in {count}' for words, count in other.items())}" if other else ""
        sentences.append(f"“{model}”: it falls in {_falls(outcomes)} of {len(outcomes)}{more}.")
    return sentences


def _falls(outcomes: Sequence[Outcome]) -> int:
    return sum(outcome.overturned for outcome in outcomes)


def _asked(record: StudyRecord, models: Sequence[str]) -> list[str]:
    varied = [PLAIN.get(key.rsplit(".", 1)[-1], heading(key).partition(" [")[0]) for key in record.vary]
    variants = list(dict.fromkeys(model.partition(" (")[2][:-1] for model in models))
    named = f"the variants {listed(f'“{name}”' for name in variants)}" if len(variants) > 1 else ""
    each = [*dict.fromkeys(varied), *([named] if named else [])]
    return [f"What was varied: {listed(each)}."] if each else []


def _strength(cases: Sequence[Condition]) -> str | None:
    """The key that varies the strength of the shaking."""
    keys = cases[0].varied if cases else ()
    return next((key for key in keys if key in STRENGTHS), None)


def _borne(cases: Sequence[Condition], key: str) -> float | None:
    """The strongest level of the shaking up to which the statue stood in every situation and every model; None without one."""
    ends: dict[float, set[str]] = {}
    for item in cases:
        for row in item.answers.values():
            if row.run is not None:
                ends.setdefault(abs(float(item.varied[key])), set()).add(family(row.run.outcome))
    safe = None
    for level in sorted(ends):
        if ends[level] != {"stands"}:
            break
        safe = level
    return safe


def _bore(cases: Sequence[Condition]) -> list[str]:
    key = _strength(cases)
    if key is None:
        return []
    safe = _borne(cases, key)
    if safe is None:
        weakest = min(abs(float(item.varied[key])) for item in cases)
        return [f"Already in the weakest shaking tried ({_level(key, weakest)}) not every answer is that it stands."]
    return [f"Up to a shaking of {_level(key, safe)} it stood in every situation that was tried, in every model."]


def _level(key: str, value: float) -> str:
    if key.endswith("_g"):
        return f"{percent(value)} of its weight"
    return f"{short(value)} times the record" if key.endswith("scale") else f"{heading(key)} {short(value)}"


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


def _agree(models: Sequence[str], cases: Sequence[Condition]) -> list[str]:
    pairs = agreement(models, cases)
    same, total = sum(item[2] for item in pairs), sum(item[3] for item in pairs)
    if not total:
        return []
    engines = {model.partition(" (")[0] for model in models}
    return [
        f"{count_word(len(engines)).capitalize()} models were asked; of all comparisons of two of them, "
        f"{100.0 * same / total:.0f} % agree."
    ]


def _pictures(record: StudyRecord, models: Sequence[str], cases: Sequence[Condition]) -> list[Picture]:
    """Reach and effect of the pedestal where the study varied it; else what gives way first."""
    scene, support = record.scene, study_support(record)
    push = push_picture(scene, support, borne=_by_direction(record, cases))
    effect = pedestal_effect(record, models, cases)
    if effect is None:
        return [push, order_picture(scene, support)]
    if not effect.charts:
        order = order_picture(scene, support)
        return [push, Picture(order.heading, order.drawing, [*order.words, effect.sentence])]
    saved, moved = (still(_plainly(figure), WIDTH) for _, _, figure in effect.charts)
    far = f"No top moves farther than its point in any situation in which the statue stands ({effect.model})."
    return [
        Picture("How far does its top move?", moved, [far]),
        push,
        Picture("What does the pedestal change?", saved, [effect.sentence]),
    ]


def _plainly(figure: Mapping[str, Any]) -> dict[str, Any]:
    """The figure with its axes named in plain words."""
    layout = dict(figure["layout"])
    for axis in ("xaxis", "yaxis"):
        text = layout[axis]["title"]["text"]
        layout[axis] = layout[axis] | {"title": {"text": AXES.get(text, text)}}
    return {"data": figure["data"], "layout": layout}


def of_effects(folder: Path, record: EffectsRecord) -> dict[str, Any]:
    """Headline, points and pictures of an effects study: the shaking borne by direction, over all its conditions and models."""
    borne: dict[float, float] = {}
    for row in record.rows:
        borne[row.azimuth_deg] = min(borne.get(row.azimuth_deg, math.inf), row.stands_at_g)
    weak, strong = (choose(borne, key=lambda key: borne[key]) for choose in (min, max))
    scene, support = record.scene, support_of(record.scene)
    pictures = [push_picture(scene, support, borne=borne), order_picture(scene, support)]
    if record.replay:
        pictures.insert(
            0, reach_picture(run_source(folder / record.replay.folder), "One case, replayed in the full report")
        )
    variants = len({row.condition for row in record.rows})
    return {
        "headline": f"It stood in every shaking tried of up to {percent(borne[weak])} of its weight, from any direction",
        "tone": "agree",
        "points": [
            f"Least towards the {compass(weak)}; towards the {compass(strong)} it bears {percent(borne[strong])}.",
            f"{len(borne)} directions were tried, each in up to {variants} variants"
            " of what is not known exactly about the statue.",
            "The shaking is always of the same form; only its strength and direction were varied.",
        ],
        "pictures": pictures,
    }
