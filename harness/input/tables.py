"""The files that a user writes in TOML, a scene's above all: keys replaced, validated strictly, every mistake listed at once."""

from __future__ import annotations

import math
import re
import shlex
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from os import PathLike, fspath
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any, Final, Literal, TypeVar, cast

from pydantic import BaseModel, BeforeValidator, Field, JsonValue, ValidationError, model_validator

from analytic.block import GRAVITY_M_S2
from harness.input.mistakes import Contradiction, UserTable, agree, mistakes_of
from harness.input.motions.spec import Motion, list_to_tuple
from harness.model import InputError, Mistake, Uncertain, nearest, refuse, require, translated

# TOML as a user hands it in: no more of it than memory should be given, and no number that TOML does not have.

MOST_KEYS: Final = 10_000
"""Far more than any scene or study has; the tables of a million keys take gigabytes."""
MOST_PARTS: Final = 16
"""Parts of one dotted key, twice the deepest of a scene: what the parser keeps of a key grows with their square."""
MOST: Final = 2**63
"""Whole numbers of TOML have 64 bits."""
_PART: Final = r"""(?:[\w-]+|"[^"\n]*"|'[^'\n]*')"""
_DEEP: Final = re.compile(rf"(?<![\w-]){_PART}(?:[ \t]*\.[ \t]*{_PART}){{{MOST_PARTS}}}")


def content_of(text: str, where: str, key: str = "") -> dict[str, JsonValue]:
    """The content of a TOML text. Raises `TOMLDecodeError` where it is none, `InputError` where it is more than is read.

    `key` is what the whole text belongs to, "" for a file, whose own keys and lines are named.
    """
    keys = text.count("=")
    require(keys <= MOST_KEYS, where, f"TOML of at most {MOST_KEYS} keys", str(keys), key=key)
    if deep := _DEEP.search(text):
        place = key or f"line {text.count(chr(10), 0, deep.start()) + 1}"
        raise InputError(Mistake(where, place, f"keys of at most {MOST_PARTS} parts", f"{deep.group()[:40]}..."))
    try:
        content: dict[str, JsonValue] = tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        raise
    except RecursionError as error:
        raise InputError(Mistake(where, key, "valid TOML", "values nested too deeply to read")) from error
    except ValueError as error:  # Python's, of a number with thousands of digits
        raise InputError(Mistake(where, key, "whole numbers of 64 bits", "one of thousands of digits")) from error
    inside: list[tuple[str, JsonValue]] = [("", content)]
    while inside:
        name, value = inside.pop()
        if isinstance(value, dict):
            inside += [(f"{name}.{part}" if name else part, item) for part, item in value.items()]
        elif isinstance(value, list):
            inside += [(name, item) for item in value]
        elif isinstance(value, int) and not -MOST <= value < MOST:
            raise InputError(Mistake(where, key or name, "whole numbers of 64 bits", f"one of {value.bit_length()}"))
    return content


# Keys of a scene replaced: `KEY=VALUE` of a command line, or values by key of a program.

Overrides = Sequence[str] | Mapping[str, object]
"""`KEY=VALUE` texts with a dotted key and a TOML value, or values by dotted key; `none` or None removes the key."""
Replacement = str | tuple[str, str, object]
"""A `KEY=VALUE` text of a command line; or what a program named it by, the dotted key and the value."""
OPTION: Final = "--set"
DOT: Final = "__"
"""Stands for a dot where a key is a Python keyword argument: `motion__x__amplitude_g`. No key of a scene holds it."""


def plain(value: object) -> object:
    """A program's value as a scene file holds it: numbers and arrays of any library, tuples, paths; no key without a value."""
    if isinstance(value, Mapping):
        return {key: plain(item) for key, item in value.items() if item is not None}
    if isinstance(value, PathLike):
        return fspath(value)
    if hasattr(value, "tolist"):
        value = value.tolist()
    return [plain(item) for item in value] if isinstance(value, list | tuple) else value


def replacements(overrides: Overrides, keywords: Mapping[str, object] = MappingProxyType({})) -> list[Replacement]:
    """Both ways of a program to replace keys, in one list."""
    items: list[Replacement] = []
    if isinstance(overrides, Mapping):
        items += [("overrides", key, plain(value)) for key, value in overrides.items()]
    else:
        items += [overrides] if isinstance(overrides, str) else overrides
    return [*items, *((f"keyword {key}", key.replace(DOT, "."), plain(value)) for key, value in keywords.items())]


def override(content: dict[str, JsonValue], items: Iterable[Replacement]) -> dict[tuple[str, ...], str]:
    """Replace keys of a scene's content; returns by their parts what named them. Raises `InputError` with every mistake."""
    mistakes: list[Mistake] = []
    keys: dict[tuple[str, ...], str] = {}
    for item in items:
        try:
            place, key, value = (OPTION, *_parted(item)) if isinstance(item, str) else item
            keys[put(content, place, key, value)] = place
        except InputError as error:
            mistakes += error.mistakes
    refuse(mistakes)
    return keys


def _parted(item: str) -> tuple[str, object]:
    """Key and value of a `KEY=VALUE`; what is no TOML value is a text."""
    key, equals, value = item.partition("=")
    require(equals, OPTION, *_key_wanted(item), key=item)
    try:
        return key, content_of(f"value = {value}", OPTION, key)["value"]
    except tomllib.TOMLDecodeError:
        return key, value.strip()


def _key_wanted(got: str) -> tuple[str, str]:
    return "KEY=VALUE with a dotted key, such as motion.x.amplitude_g=0.3", repr(got)


def put(content: dict[str, JsonValue], place: str, key: str, value: object) -> tuple[str, ...]:
    """Set one dotted key of a scene's content, or remove it (None, "none"); returns its parts.

    `place` is what names it. Raises `InputError` where the path is no table.
    """
    parts = tuple(part.strip() for part in key.split("."))
    require(all(parts), place, *_key_wanted(key), key=key)
    table = content
    for part in parts[:-1]:
        inner = table.setdefault(part, {})
        if not isinstance(inner, dict):
            raise InputError(Mistake(place, key, f"a key inside a table, but {part} is a value", repr(key)))
        table = inner
    if value is None or value == "none":
        table.pop(parts[-1], None)
    else:
        table[parts[-1]] = cast(JsonValue, value)
    return parts


# `[uncertainty]`: which numbers of a scene are not known, and how far; where nobody says, a distribution for each kind of key.


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
        table = vars(place) if isinstance(place, BaseModel) else place
        place = table.get(part) if isinstance(table, Mapping) else None
    return float(place) if isinstance(place, (int, float)) and not isinstance(place, bool) else None


# Wider than any statue, and narrow enough that no product of a few of them leaves the range of floating point.
Density = Annotated[float, Field(ge=1e-3, le=1e5)]
Mass = Annotated[float, Field(ge=1e-9, le=1e9)]
Inertia = Annotated[float, Field(ge=1e-18, le=1e18)]
Length = Annotated[float, Field(ge=1e-6, le=1e4)]
Tolerance = Annotated[float, Field(gt=0.0, le=0.1)]
Friction = Annotated[float, Field(ge=0.0, le=1e3)]
Place = Annotated[float, Field(ge=-1e4, le=1e4)]
Speed = Annotated[float, Field(ge=-1e3, le=1e3)]
SAME_INERTIA = 1e-9
"""Two statements of one moment of inertia may differ by rounding."""
POSE = ("position_m", "quaternion_wxyz", "velocity_m_s", "angular_velocity_rad_s")
UNIT = 1e-4
"""A quaternion's norm may be off by this much: measured and printed ones are rounded; it is made exact."""
MAX_SAMPLES = 2e6
"""Half an hour at 1 ms; the page that reads such a history takes a gigabyte."""
MAX_BYTES = 10_000_000
SCANS = (".ply", ".obj", ".stl", ".glb", ".gltf")


M = TypeVar("M", bound=BaseModel)


class ModelTable(UserTable):
    """`[model]`: the form of the analytic model; `preset` or the two choices one by one."""

    preset: Literal["consistent", "paper"] = "consistent"
    friction_normal: Literal["dynamic", "static"] | None = None
    pedestal_at_impact: Literal["momentum", "unchanged"] | None = None


class InnerTable(UserTable):
    """`[statue.mesh] inner`: a closed shell in the same frame, unit and axes, and the density inside it (0: hollow)."""

    file: Annotated[str, Field(min_length=1)]
    density_kg_m3: Annotated[float, Field(ge=0.0, le=1e5)] = 0.0


class AdjustTable(UserTable):
    """`[statue.mesh] adjust`: the statue as it would be if the scan were off by these shares, or with a part simplified."""

    centroid_rel: Annotated[float, Field(gt=-0.5, lt=0.5)] = 0.0
    base_rel: Annotated[float, Field(gt=-0.5, lt=0.5)] = 0.0
    inertia_rel: Annotated[float, Field(gt=-0.5, lt=0.5)] = 0.0
    flat_base: bool = False
    products: bool = True


class MeshTable(UserTable):
    """`[statue] mesh`: the statue's surface; `up` is the file's vertical axis, `azimuth_deg` turns it about the vertical.

    Vertices within `contact_tolerance_m` of the lowest touch. `use_survey` names numbers of `[statue]` that replace the mesh's.
    """

    file: Annotated[str, Field(min_length=1)]
    unit: Literal["m", "dm", "cm", "mm", "in", "ft"] = "m"
    up: Literal["x", "y", "z", "-x", "-y", "-z"] = "z"
    azimuth_deg: float = 0.0
    density_kg_m3: Density | None = None
    contact_tolerance_m: Tolerance = 1e-3
    inner: InnerTable | None = None
    use_survey: Annotated[
        tuple[Literal["centroid_height_m", "inertia_kg_m2"], ...], BeforeValidator(list_to_tuple)
    ] = ()
    adjust: AdjustTable = Field(default_factory=AdjustTable)


class StatueTable(UserTable):
    """`[statue]`: numbers, a mesh, or both (then the mesh gives the shape and the numbers are compared with it)."""

    mass_kg: Mass | None = None
    centroid_height_m: Length | None = None
    corner_left_m: Length | None = None
    corner_right_m: Length | None = None
    inertia_kg_m2: Inertia | None = None
    inertia_xyz_kg_m2: Annotated[tuple[Inertia, Inertia, Inertia] | None, BeforeValidator(list_to_tuple)] = None
    height_m: Length | None = None
    depth_m: Length | None = None
    mesh: MeshTable | None = None

    @model_validator(mode="after")
    def _one_inertia(self) -> StatueTable:
        if self.inertia_xyz_kg_m2 is None:
            return self
        x, y, z = self.inertia_xyz_kg_m2
        about_y = y if self.inertia_kg_m2 is None else self.inertia_kg_m2
        possible = 2.0 * max(x, y, z) <= (x + y + z) * (1.0 + SAME_INERTIA)
        key = "inertia_xyz_kg_m2"
        agree(
            (self.mesh is None, key, "no moments beside a mesh: it gives them all", "both"),
            (abs(y - about_y) <= SAME_INERTIA * y, key, f"inertia_kg_m2 = {about_y:g} about y", f"{y:g}"),
            (possible, key, "no moment above the sum of the other two", f"{x:g}, {y:g}, {z:g}"),
        )
        return self


class PedestalTable(UserTable):
    """`[pedestal]`: a rectangular block under the statue."""

    mass_kg: Mass
    width_m: Length
    depth_m: Length
    height_m: Length
    offset_m: Annotated[float, Field(ge=-1e4, le=1e4)] = 0.0


class ContactTable(UserTable):
    """`[contact]`: friction coefficients and the law of impact."""

    floor_static: Friction = 0.20
    floor_kinetic: Friction = 0.15
    floor_impact: Literal["kinetic", "static"] | Friction = "kinetic"
    statue: Annotated[float, Field(gt=0.0, le=1e3)] = 1.0
    restitution: Literal["momentum"] | Annotated[float, Field(ge=0.0, le=1.0)] = "momentum"

    @model_validator(mode="after")
    def _ordered(self) -> ContactTable:
        kinetic, static = self.floor_kinetic, self.floor_static
        acts = kinetic if isinstance(self.floor_impact, str) else self.floor_impact
        numbers = f"a number from floor_kinetic = {kinetic:g} to floor_static = {static:g}"
        agree(
            (kinetic <= static, "floor_kinetic", f"at most floor_static = {static:g}", f"{kinetic:g}"),
            (kinetic <= acts <= static, "floor_impact", f'"kinetic", "static" or {numbers}', f"{acts:g}"),
        )
        return self


class WallTable(UserTable):
    """`[wall]`: a vertical wall beside the statue."""

    side: Literal["left", "right"]
    distance_m: Length


class InitialTable(UserTable):
    """`[initial]`: rotation and rate at t = 0; or a pose in space, for engines of three dimensions."""

    theta_rad: Annotated[float, Field(gt=-1.5, lt=1.5)] = 0.0
    theta_rate_rad_s: Annotated[float, Field(ge=-1e3, le=1e3)] = 0.0
    position_m: Annotated[tuple[Place, Place, Place] | None, BeforeValidator(list_to_tuple)] = None
    quaternion_wxyz: Annotated[tuple[Place, Place, Place, Place] | None, BeforeValidator(list_to_tuple)] = None
    velocity_m_s: Annotated[tuple[Speed, Speed, Speed] | None, BeforeValidator(list_to_tuple)] = None
    angular_velocity_rad_s: Annotated[tuple[Speed, Speed, Speed] | None, BeforeValidator(list_to_tuple)] = None

    @property
    def posed(self) -> bool:
        """Whether any part of a pose in space is given."""
        return not self.model_fields_set.isdisjoint(POSE)

    @model_validator(mode="after")
    def _one_start(self) -> InitialTable:
        pose, planar = (
            next((name for name in names if name in self.model_fields_set), "")
            for names in (POSE, ("theta_rad", "theta_rate_rad_s"))
        )
        norm = 1.0 if self.quaternion_wxyz is None else math.hypot(*self.quaternion_wxyz)
        unit = f"a unit quaternion (norm 1 to {UNIT:g})"
        agree(
            (not pose or not planar, planar, f"no planar start beside {pose}: the pose says it all", "both"),
            (not pose or self.position_m is not None, "position_m", f"the centroid's place beside {pose}", "nothing"),
            (abs(norm - 1.0) <= UNIT, "quaternion_wxyz", unit, f"one of norm {norm:.6g}"),
        )
        return self


class OutputTable(UserTable):
    """`[output]`: the grid of every history."""

    dt_s: Annotated[float, Field(ge=1e-6, le=3600.0)] = 0.001


class SceneFile(UserTable):
    """A whole scene file."""

    title: Annotated[str, Field(min_length=1)]
    duration_s: Annotated[float, Field(gt=0.0, le=3600.0)]
    gravity_m_s2: Annotated[float, Field(ge=1e-3, le=1e3)] = GRAVITY_M_S2
    table: Literal["frame", "moving"] = "frame"
    model: ModelTable = Field(default_factory=ModelTable)
    statue: StatueTable
    pedestal: PedestalTable | None = None
    contact: ContactTable = Field(default_factory=ContactTable)
    motion: Motion = Field(default_factory=Motion)
    wall: WallTable | None = None
    initial: InitialTable = Field(default_factory=InitialTable)
    output: OutputTable = Field(default_factory=OutputTable)
    uncertainty: dict[str, Distribution] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _whole(self) -> SceneFile:
        planar, dt_s = not self.initial.posed, self.output.dt_s
        lacking = self.model.preset == "paper" and self.contact.restitution == "momentum"
        topless = self.statue.mesh is None and self.statue.height_m is None
        floor = "a body on the floor: no [pedestal] beside a pose in space"
        few = f"a step that leaves at most {MAX_SAMPLES:.0e} samples"
        agree(
            (not lacking, "contact.restitution", 'a number such as 0.875 with model.preset = "paper"', "'momentum'"),
            (dt_s <= self.duration_s, "output.dt_s", f"at most duration_s = {self.duration_s:g}", f"{dt_s:g}"),
            (self.duration_s / dt_s <= MAX_SAMPLES, "output.dt_s", few, f"{dt_s:g}"),
            (planar or self.pedestal is None, "initial.position_m", floor, "both"),
            (planar or self.wall is None, "initial.position_m", "no [wall] beside a pose in space", "both"),
            (
                self.wall is None or not topless,
                "statue.height_m",
                "a number beside a wall: what touches it is the top",
                "nothing",
            ),
        )
        uncertain_inputs(self, self.uncertainty)
        return self


NUMBERS = ("mass_kg", "centroid_height_m", "corner_left_m", "corner_right_m", "inertia_kg_m2")


def parse(text: str, where: str, overrides: Sequence[Replacement] = ()) -> tuple[SceneFile, dict[str, JsonValue]]:
    """Parse and validate a scene; returns the model and the plain content (with overrides).

    Raises `InputError` with every mistake.
    """
    return checked(toml_table(text, where), where, overrides, text)


def checked(
    content: dict[str, JsonValue], where: str, overrides: Sequence[Replacement] = (), text: str = ""
) -> tuple[SceneFile, dict[str, JsonValue]]:
    """The same of a content that is a table already, which is changed."""
    overridden = override(content, overrides)
    try:
        model = SceneFile.model_validate(content)
    except ValidationError as error:
        missing = _absent_numbers(content.get("statue"), where)
        raise InputError([*mistakes_of(error, SceneFile, where, text, overridden), *missing]) from error
    refuse(_absent_numbers(content["statue"], where))
    return model, content


def toml_table(text: str, where: str) -> dict[str, JsonValue]:
    """The plain content of a TOML text. Raises `InputError` where it is none."""
    with translated(tomllib.TOMLDecodeError, where, "valid TOML"):
        return content_of(text, where)


def read_model(kind: type[M], path: Path) -> M:
    """Read and validate a TOML file. Raises `InputError` with every mistake."""
    text = read(path)
    try:
        return kind.model_validate(toml_table(text, str(path)))
    except ValidationError as error:
        raise InputError(mistakes_of(error, kind, str(path), text)) from error


def kind_of(path: Path) -> JsonValue:
    """The kind that a TOML file names; None for one that cannot be read, which is left to whoever reads it whole."""
    try:
        return toml_table(read(path), str(path)).get("kind")
    except InputError:
        return None


def _absent_numbers(statue: JsonValue, where: str) -> list[Mistake]:
    """Without a mesh the five numbers of the planar model are all needed."""
    if not isinstance(statue, Mapping) or "mesh" in statue:
        return []
    return [
        Mistake(where, f"statue.{name}", "a number, or statue.mesh to take it from", "nothing")
        for name in NUMBERS
        if name not in statue
    ]


def read(path: Path) -> str:
    """The text of a scene file; raises `InputError` when it cannot be read."""
    require(
        path.suffix.lower() not in SCANS,
        str(path),
        "a TOML file",
        "a scan",
        f"`rockcheck new {shlex.quote(str(path))} --motion RECORD` makes a scene of it",
    )
    try:
        with path.open("rb") as stream:
            raw = stream.read(MAX_BYTES + 1)
        require(len(raw) <= MAX_BYTES, str(path), f"a TOML file of at most {MAX_BYTES:.0e} bytes", "a longer one")
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        got = f"byte {error.start} that is none"
        raise InputError(Mistake(str(path), "", "a text in UTF-8", got, "save it as UTF-8")) from error
    except OSError as error:
        raise InputError(Mistake(str(path), "", "a readable TOML file", error.strerror or str(error))) from error
