"""The conservator's page of a study: how often the statue falls, how strong a shaking it bore, what the pedestal changed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from harness.model.history import Outcome
from reports.charts.static_svg import still
from reports.pages.conservator import Picture, end_words, order_picture, push_picture, reach_picture
from reports.source import run_source, scene_of
from reports.text.giving_way import compass, scan_turn_deg, study_support, support_of
from reports.text.numbers import count_word, heading, listed, percent, short
from reports.text.pedestal_effect import pedestal_effect
from reports.text.study_rows import Condition, agreement, conditions, family, tone

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


def of_study(record: Mapping[str, Any]) -> dict[str, Any]:
    """Headline, points and pictures of a study."""
    models, found = conditions(record["rows"])
    ends = {model: _ends(found, model) for model in models}
    ends = {model: outcomes for model, outcomes in ends.items() if outcomes}
    return {
        "headline": _headline(ends),
        "tone": tone([family(outcome) for outcomes in ends.values() for outcome in outcomes]),
        "points": [*_asked(record, models), *_by_model(ends), *_bore(found), *_agree(models, found)],
        "pictures": _pictures(record, models, found),
    }


def _ends(found: Sequence[Condition], model: str) -> list[Outcome]:
    """The outcomes of one model, condition after condition that it answered."""
    rows = [item.answers.get(model) for item in found]
    return [Outcome(row["run"]["outcome"]) for row in rows if row is not None and row["run"] is not None]


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


def _asked(record: Mapping[str, Any], models: Sequence[str]) -> list[str]:
    varied = [PLAIN.get(key.rsplit(".", 1)[-1], heading(key).partition(" [")[0]) for key in record["vary"]]
    variants = list(dict.fromkeys(model.partition(" (")[2][:-1] for model in models))
    named = f"the variants {listed(f'“{name}”' for name in variants)}" if len(variants) > 1 else ""
    each = [*dict.fromkeys(varied), *([named] if named else [])]
    return [f"What was varied: {listed(each)}."] if each else []


def _strength(found: Sequence[Condition]) -> str | None:
    """The key that varies the strength of the shaking."""
    keys = found[0].varied if found else ()
    return next((key for key in keys if key in STRENGTHS), None)


def _borne(found: Sequence[Condition], key: str) -> float | None:
    """The strongest level of the shaking up to which the statue stood in every situation and every model; None without one."""
    ends: dict[float, set[str]] = {}
    for item in found:
        for row in item.answers.values():
            if row["run"] is not None:
                ends.setdefault(abs(float(item.varied[key])), set()).add(family(row["run"]["outcome"]))
    safe = None
    for level in sorted(ends):
        if ends[level] != {"stands"}:
            break
        safe = level
    return safe


def _bore(found: Sequence[Condition]) -> list[str]:
    key = _strength(found)
    if key is None:
        return []
    safe = _borne(found, key)
    if safe is None:
        weakest = min(abs(float(item.varied[key])) for item in found)
        return [f"Already in the weakest shaking tried ({_level(key, weakest)}) not every answer is that it stands."]
    return [f"Up to a shaking of {_level(key, safe)} it stood in every situation that was tried, in every model."]


def _level(key: str, value: float) -> str:
    if key.endswith("_g"):
        return f"{percent(value)} of its weight"
    return f"{short(value)} times the record" if key.endswith("scale") else f"{heading(key)} {short(value)}"


def _by_direction(record: Mapping[str, Any], found: Sequence[Condition]) -> dict[float, float]:
    """The strongest shaking borne by direction of the push, where the study turned the statue and varied the amplitude in g.

    A statue turned by an angle under a shaking along x is one shaken along minus that angle, to both sides.
    """
    turn = next((key for item in found for key in item.varied if key.endswith("azimuth_deg")), None)
    strength = _strength(found)
    if turn is None or strength is None or not strength.endswith("_g"):
        return {}
    own = scan_turn_deg(scene_of(record))
    borne = {}
    for angle in {float(item.varied[turn]) for item in found}:
        safe = _borne([item for item in found if float(item.varied[turn]) == angle], strength)
        for side in (0.0, 180.0):
            borne[(own - angle + side) % 360.0] = safe or 0.0
    return borne


def _agree(models: Sequence[str], found: Sequence[Condition]) -> list[str]:
    pairs = agreement(models, found)
    same, total = sum(item[2] for item in pairs), sum(item[3] for item in pairs)
    if not total:
        return []
    engines = {model.partition(" (")[0] for model in models}
    return [
        f"{count_word(len(engines)).capitalize()} models were asked; of all comparisons of two of them, "
        f"{100.0 * same / total:.0f} % agree."
    ]


def _pictures(record: Mapping[str, Any], models: Sequence[str], found: Sequence[Condition]) -> list[Picture]:
    """Reach and effect of the pedestal where the study varied it; else what gives way first."""
    scene, support = scene_of(record), study_support(record)
    push = push_picture(scene, support, borne=_by_direction(record, found))
    effect = pedestal_effect(record, models, found)
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


def of_effects(folder: Path, record: Mapping[str, Any]) -> dict[str, Any]:
    """Headline, points and pictures of an effects study: the shaking borne by direction, over all its conditions and models."""
    borne: dict[float, float] = {}
    for row in record["rows"]:
        azimuth = float(row["azimuth_deg"])
        borne[azimuth] = min(borne.get(azimuth, float("inf")), float(row["stands_at_g"]))
    weak, strong = (choose(borne, key=lambda key: borne[key]) for choose in (min, max))
    scene = scene_of(record)
    support = support_of(scene)
    pictures = [push_picture(scene, support, borne=borne), order_picture(scene, support)]
    if record["replay"]:
        pictures.insert(
            0, reach_picture(run_source(folder / record["replay"]["folder"]), "One case, replayed in the full report")
        )
    cases = len({row["condition"] for row in record["rows"]})
    return {
        "headline": f"It stood in every shaking tried of up to {percent(borne[weak])} of its weight, from any direction",
        "tone": "agree",
        "points": [
            f"Least towards the {compass(weak)}; towards the {compass(strong)} it bears {percent(borne[strong])}.",
            f"{len(borne)} directions were tried, each in up to {cases} variants of what is not known exactly about the statue.",
            "The shaking is always of the same form; only its strength and direction were varied.",
        ],
        "pictures": pictures,
    }
