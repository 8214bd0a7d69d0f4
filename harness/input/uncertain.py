"""`[uncertainty]`: which numbers of a scene are not known, and how far."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from typing import Annotated, Any, Final, Literal

from pydantic import BaseModel, Field

from harness.input.mistakes import Contradiction, UserTable, agree
from harness.model import Uncertain, nearest

# How far a number of a scene is known where nobody says: a distribution for each kind of key.


@dataclass(frozen=True)
class Assumption:
    """Keys (`*` stands for an axis), and their distribution's kind and width."""

    keys: str
    kind: Literal["lognormal", "normal", "uniform"]
    width: float

    @property
    def name(self) -> str:
        """What names it in the catalogues of messages, where the source of its width stands."""
        return self.keys.replace(".", "_").replace("*", "axis")


ASSUMPTIONS: Final = (
    Assumption("contact.floor", "lognormal", 0.15),
    Assumption("contact.statue", "lognormal", 0.15),
    Assumption("contact.floor_impact", "uniform", 0.5),
    Assumption("motion.scale", "lognormal", 0.1),
    Assumption("motion.*.frequency_hz", "lognormal", 0.05),
    Assumption("statue.mesh.density_kg_m3", "lognormal", 0.03),
    Assumption("motion.time_scale", "lognormal", 0.05),
    Assumption("statue.mass_kg", "lognormal", 0.03),
    Assumption("statue.centroid_height_m", "lognormal", 0.02),
    Assumption("statue.mesh.adjust.centroid_rel", "normal", 0.02),
    Assumption("statue.corner_left_m", "uniform", 0.005),
    Assumption("statue.corner_right_m", "uniform", 0.005),
    Assumption("statue.mesh.adjust.base_rel", "uniform", 0.02),
    Assumption("statue.mesh.contact_tolerance_m", "lognormal", 0.5),
    Assumption("statue.mesh.azimuth_deg", "normal", 2.0),
    Assumption("pedestal.offset_m", "uniform", 0.01),
    Assumption("contact.restitution", "normal", 0.037),
)
"""What each width rests on stands in the catalogues of messages; of one that the project chose itself they say so."""


def assumption(key: str) -> Assumption | None:
    """What is assumed of a key, None where nothing is."""
    return next((item for item in ASSUMPTIONS if fnmatchcase(key, item.keys)), None)


JOINT: Final = {"contact.floor": "contact.floor_static"}
"""Keys that stand for several numbers moved by one factor, and the number that their median is told by."""
IMPACT: Final = "contact.floor_impact"
"""Told, and drawn, by its place between the two coefficients of the floor: 0 is the kinetic one, 1 the static."""
FACTORS: Final = {"motion.time_scale": 1.0}
"""Keys that stand for no number of the file but for a factor on what it holds, and that factor as the scene is."""
WIDTHS: Final = {"lognormal": "cov", "normal": "sd", "uniform": "half_width"}


class _Spread(UserTable):
    """What every distribution may say: `rho` goes with the earlier key that it names."""

    correlated_with: str | None = None
    rho: Annotated[float | None, Field(gt=-1.0, lt=1.0)] = None


class Lognormal(_Spread):
    """The scene's value times exp(s Z), s² = ln(1 + cov²): its median is the scene's value."""

    kind: Literal["lognormal"]
    cov: Annotated[float, Field(gt=0.0, le=2.0)]


class Normal(_Spread):
    """The scene's value plus a normal number of this standard deviation, in the key's own unit."""

    kind: Literal["normal"]
    sd: Annotated[float, Field(gt=0.0, le=1e6)]


class Uniform(_Spread):
    """Anything within `half_width` of the scene's value, in the key's own unit."""

    kind: Literal["uniform"]
    half_width: Annotated[float, Field(gt=0.0, le=1e6)]


class Assumed(_Spread):
    """The distribution that is assumed of such a key."""

    kind: Literal["assumed"]


Distribution = Annotated[Lognormal | Normal | Uniform | Assumed, Field(discriminator="kind")]


def uncertain_inputs(model: BaseModel, spreads: Mapping[str, Distribution]) -> tuple[Uncertain, ...]:
    """What `[uncertainty]` says, each with the scene file's own value. Raises `Contradiction` for a key without a number."""
    inputs: list[Uncertain] = []
    for key, spread in spreads.items():
        before, other = [item.key for item in inputs], spread.correlated_with
        place, earlier = (
            f'uncertainty."{key}"',
            f"an earlier key of the table ({', '.join(before) or 'this is the first'})",
        )
        twice = next((name for name in before if _moves(name) & _moves(key)), None)
        agree(
            ((other is None) == (spread.rho is None), place, "correlated_with and rho together", "one of them"),
            (other is None or other in before, place, f"correlated_with {earlier}", repr(other)),
            (twice is None, place, f"one key for each number: {twice} moves it too", key),
        )
        item = _uncertain(model, key, spread)
        inputs.append(replace(item, correlated_with=other, rho=spread.rho or 0.0))
    return tuple(inputs)


def _moves(key: str) -> set[str]:
    """The numbers of the file that a key of `[uncertainty]` moves."""
    return {"contact.floor_static", "contact.floor_kinetic"} if key == "contact.floor" else {key}


def _uncertain(model: BaseModel, key: str, spread: Lognormal | Normal | Uniform | Assumed) -> Uncertain:
    place = f'uncertainty."{key}"'
    if key == IMPACT:
        return _impact(model, place, spread)
    value = FACTORS.get(key, _number(model, JOINT.get(key, key)))
    if value is None or key.startswith("uncertainty"):
        advice = nearest(key, [item.keys for item in ASSUMPTIONS]) if assumption(key) is None else ""
        raise Contradiction(
            place,
            'the dotted key of a number of this scene, such as "contact.floor" or "motion.scale"',
            "; ".join(filter(None, ("no such number", advice))),
        )
    if spread.kind == "assumed":
        if (given := assumption(key)) is None:
            wanted = f"one of the keys of which a width is assumed ({', '.join(item.keys for item in ASSUMPTIONS)})"
            raise Contradiction(place, f"a distribution, or {wanted}", "assumed")
        kind, width = given.kind, given.width
    else:
        kind, width = spread.kind, float(getattr(spread, WIDTHS[spread.kind]))
    positive = kind != "lognormal" or value > 0.0
    agree((positive, place, "a positive value for a lognormal distribution", f"{key} = {value:g}"))
    return Uncertain(key, kind, value, width)


def _impact(model: BaseModel, place: str, spread: Lognormal | Normal | Uniform | Assumed) -> Uncertain:
    """The coefficient at an impact by its place between the other two; its width is given in its own unit."""
    static, kinetic = (_number(model, f"contact.floor_{name}") for name in ("static", "kinetic"))
    if static is None or kinetic is None or not kinetic < static or spread.kind == "lognormal":
        wanted = "a uniform, normal or assumed width between floor_kinetic and a floor_static that is more"
        raise Contradiction(place, wanted, f"{spread.kind} between {kinetic} and {static}")
    if spread.kind == "assumed":
        return Uncertain(IMPACT, "uniform", 0.5, 0.5)
    whole: Any = model
    acts, width = whole.contact.floor_impact, float(getattr(spread, WIDTHS[spread.kind]))
    value = {"kinetic": 0.0, "static": 1.0}[acts] if isinstance(acts, str) else (acts - kinetic) / (static - kinetic)
    return Uncertain(IMPACT, spread.kind, value, width / (static - kinetic))


def _number(model: BaseModel, key: str) -> float | None:
    """The number at a dotted key of a validated scene, None where there is none."""
    place: Any = model
    for part in key.split("."):
        if isinstance(place, Mapping):
            place = place.get(part)
        elif isinstance(place, BaseModel) and part in type(place).model_fields:
            place = getattr(place, part)
        else:
            return None
    return float(place) if isinstance(place, (int, float)) and not isinstance(place, bool) else None
