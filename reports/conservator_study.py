"""The conservator's page of a study: how often the statue falls, how strong a shaking it bore, what the pedestal changed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from reports.conservator import Picture, levels, order_words, push_picture, reach_picture
from reports.conservator_pictures import compass, order_svg, percent
from reports.numbers import count_word, heading, listed, short
from reports.pedestal_effect import pedestal_effect
from reports.source import run_source
from reports.still import still
from reports.study_rows import Condition, agreement, conditions, family

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


def of_study(record: Mapping[str, Any]) -> dict[str, Any]:
    """Headline, points and pictures of a study."""
    models, found = conditions(record["rows"])
    model = _counted(models)
    fell, asked = _falls(found, model)
    tone = "agree" if fell == 0 else "differ" if fell < asked else "failed"
    return {
        "headline": f"The statue falls in {fell} of {asked} situations that were tried"
        if asked
        else "Nothing was computed",
        "tone": tone,
        "points": [*_asked(record, model), *_bore(found, model), *_agree(models, found)],
        "pictures": _pictures(record, models, found),
    }


def _counted(models: Sequence[str]) -> str:
    """The model whose answers are counted: the analytic one where it was asked."""
    return next((name for name in models if name.startswith("analytic")), models[0] if models else "")


def _falls(found: Sequence[Condition], model: str) -> tuple[int, int]:
    ends = [family(row["run"]["outcome"]) for item in found for row in [item.answers.get(model)] if row and row["run"]]
    return sum(end == "overturns" for end in ends), len(ends)


def _asked(record: Mapping[str, Any], model: str) -> list[str]:
    varied = listed(PLAIN.get(key.rsplit(".", 1)[-1], heading(key).partition(" [")[0]) for key in record["vary"])
    return [f"What was varied: {varied}. The count is that of the model “{model}”."]


def _strength(found: Sequence[Condition]) -> str | None:
    """The key that varies the strength of the shaking."""
    return next((key for item in found for key in item.varied if "amplitude" in key or key.endswith("scale")), None)


def _borne(found: Sequence[Condition], model: str, key: str) -> float | None:
    """The strongest level of the shaking up to which the statue stood in every situation; None where it never did."""
    ends: dict[float, set[str]] = {}
    for item in found:
        row = item.answers.get(model)
        if row is not None and row["run"] is not None:
            ends.setdefault(float(item.varied[key]), set()).add(family(row["run"]["outcome"]))
    safe = None
    for level in sorted(ends):
        if ends[level] != {"stands"}:
            break
        safe = level
    return safe


def _bore(found: Sequence[Condition], model: str) -> list[str]:
    key = _strength(found)
    if key is None:
        return []
    safe = _borne(found, model, key)
    if safe is None:
        weakest = min(float(item.varied[key]) for item in found)
        return [f"Already in the weakest shaking tried ({_level(key, weakest)}) it does not stand in every situation."]
    return [f"Up to a shaking of {_level(key, safe)} it stood in every situation that was tried."]


def _level(key: str, value: float) -> str:
    if key.endswith("amplitude_g"):
        return f"{percent(value)} of its weight"
    return f"{short(value)} times the record" if key.endswith("scale") else f"{heading(key)} {short(value)}"


def _by_direction(record: Mapping[str, Any], found: Sequence[Condition], model: str) -> dict[float, float]:
    """The strongest shaking borne by direction of the push, where the study turned the statue and varied the amplitude in g.

    A statue turned by an angle under a shaking along x is one shaken along minus that angle, to both sides.
    """
    turn = next((key for item in found for key in item.varied if key.endswith("azimuth_deg")), None)
    strength = _strength(found)
    if turn is None or strength is None or not strength.endswith("amplitude_g"):
        return {}
    own = float((((record["scene"]["toml"] or {}).get("statue") or {}).get("mesh") or {}).get("azimuth_deg", 0.0))
    borne = {}
    for angle in {float(item.varied[turn]) for item in found}:
        safe = _borne([item for item in found if float(item.varied[turn]) == angle], model, strength)
        for side in (0.0, 180.0):
            borne[(own - angle + side) % 360.0] = safe or 0.0
    return borne


def _agree(models: Sequence[str], found: Sequence[Condition]) -> list[str]:
    pairs = agreement(models, found)
    same, total = sum(item[2] for item in pairs), sum(item[3] for item in pairs)
    if not total:
        return []
    return [
        f"{count_word(len(models)).capitalize()} models were asked; they agree in {100.0 * same / total:.0f} % of comparisons."
    ]


def _pictures(record: Mapping[str, Any], models: Sequence[str], found: Sequence[Condition]) -> list[Picture]:
    """Reach and effect of the pedestal where the study varied it; else what gives way first."""
    push = push_picture(record["scene"], {}, _by_direction(record, found, _counted(models)))
    effect = pedestal_effect(record, models, found)
    if effect is None:
        return [push, _order(record["scene"])]
    saved, moved = (still(_plainly(figure), WIDTH) for _, _, figure in effect.charts)
    far = "Each point is the farthest that the statue's top moves in any situation in which it stands."
    return [
        Picture("How far does its top move?", moved, [far]),
        push,
        Picture("What does the pedestal change?", saved, [effect.sentence]),
    ]


def _order(scene: Mapping[str, Any]) -> Picture:
    title = "What gives way first?"
    return Picture(title, order_svg(levels(scene), None, title), order_words(scene, None))


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
    pictures = [push_picture(record["scene"], {}, borne), _order(record["scene"])]
    if record["replay"]:
        pictures.insert(
            0, reach_picture(run_source(folder / record["replay"]["folder"]), "One case, replayed in the full report")
        )
    cases = len({row["condition"] for row in record["rows"]})
    return {
        "headline": f"It did not fall in any shaking of up to {percent(borne[weak])} of its weight, from any direction",
        "tone": "agree",
        "points": [
            f"Least towards the {compass(weak)}; towards the {compass(strong)} it bears {percent(borne[strong])}.",
            f"{len(borne)} directions were tried, each in up to {cases} variants of what is not known exactly about the statue.",
            "The shaking is always of the same form; only its strength and direction were varied.",
        ],
        "pictures": pictures,
    }
