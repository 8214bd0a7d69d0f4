"""The scene file: what a user may write, validated strictly, every mistake listed at once."""

from __future__ import annotations

import math
import shlex
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Literal, TypeVar

from pydantic import BaseModel, BeforeValidator, Field, JsonValue, ValidationError, model_validator

from analytic.block import GRAVITY_M_S2
from harness.input.mistakes import UserTable, agree, mistakes_of
from harness.input.motions.spec import Motion, list_to_tuple
from harness.input.overrides import Replacement, content_of, override
from harness.input.uncertain import Distribution, uncertain_inputs
from harness.model import InputError, Mistake, refuse, require, translated

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
