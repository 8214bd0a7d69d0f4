"""A scene as it stands in a record: what a page draws, and what a reader needs to repeat the run."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Final, Literal, Self

import numpy as np
from pydantic import Field

from analytic.excitation import Excitation, ZeroExcitation
from harness.input.mistakes import agree
from harness.model import OMITTED, Array, Contact, Form, Initial, Pedestal, Scene, Wall, to_plain
from harness.records.base import Positive, Table, same_fields
from harness.statics.standstill import Cause, peak_within_m_s2, push_of

Point = tuple[float, float]
Point3 = tuple[float, float, float]
Axis = Literal["x", "y", "z"]

MOTION_SAMPLES: Final = 4001
"""Most samples of the floor's motion kept for drawing; each is the value of largest size in its interval."""


@dataclass(frozen=True)
class MeshSize:
    """How large the statue's mesh is."""

    vertices: int
    faces: int


@dataclass(frozen=True, eq=False)
class StatueRecord:
    """The statue as `harness.model.scene.Statue`, with its slendernesses; `mesh` None for a block by its numbers."""

    mass_kg: Positive
    centroid_height_m: Positive
    corner_left_m: float
    corner_right_m: float
    slenderness_left_rad: Positive
    slenderness_right_rad: Positive
    inertia_kg_m2: float
    inertia_tensor_kg_m2: tuple[Point3, Point3, Point3]
    height_m: Positive
    depth_m: Positive
    section_m: Annotated[Sequence[Point], Field(min_length=3)]
    footprint_m: Annotated[Sequence[Point3], Field(min_length=3)]
    mesh: MeshSize | None

    def slenderness_rad(self, side: int) -> float:
        """The slenderness on that side (+1 right, −1 left)."""
        return self.slenderness_right_rad if side > 0 else self.slenderness_left_rad


@dataclass(frozen=True)
class WallRecord(Wall):
    """The wall, and the |θ| at which the statue first touches it (None: never below flat)."""

    touching_rotation_rad: float | None


@dataclass(frozen=True, kw_only=True, eq=False)
class SceneRecord:
    """The resolved scene; `file` names the scene file, `toml` is its content as read."""

    title: str
    file: str | None
    duration_s: Positive
    gravity_m_s2: Positive
    model: Form
    statue: StatueRecord
    pedestal: Pedestal | None
    contact: Contact
    wall: WallRecord | None
    initial: Initial
    table: Literal["frame", "moving"]
    output_dt_s: float
    toml: Table

    @classmethod
    def of(cls, scene: Scene) -> Self:
        """The record of a scene, without its mesh."""
        statue, wall = scene.statue, scene.wall
        size = None if statue.solid is None else MeshSize(len(statue.solid.vertices_m), len(statue.solid.faces))
        arrays = ("inertia_tensor_kg_m2", "section_m", "footprint_m")
        own_statue = {name: to_plain(getattr(statue, name)) for name in arrays} | {
            "slenderness_left_rad": statue.slenderness_rad(-1),
            "slenderness_right_rad": statue.slenderness_rad(1),
            "mesh": size,
        }
        own = {
            "file": None if scene.source is None else scene.source.name,
            "model": scene.form,
            "statue": StatueRecord(**same_fields(StatueRecord, statue) | own_statue),
            "wall": None if wall is None else WallRecord(wall.side, wall.distance_m, scene.wall_rotation_rad),
            "toml": scene.given,
        }
        return cls(**same_fields(cls, scene) | own)


@dataclass(frozen=True)
class PushRecord:
    """The motion's strongest level push as a share of the weight, and by cause its largest share of what begins that motion.

    A share that is infinite is None; `first` is what gives way first.
    """

    peak: float
    shares: Mapping[Cause, float | None]
    first: Cause

    def __post_init__(self) -> None:
        agree((self.first in self.shares, "first", "one of `shares`", repr(self.first)))


@dataclass(frozen=True, kw_only=True, eq=False)
class MotionRecord:
    """The floor's accelerations for drawing, absent along an axis where it is at rest.

    Where it moves along x and y, `level_m_s2` (n, 2) holds both at the instants of their largest sum; `push` says what the
    motion asks of the statue at rest (`harness.statics.standstill`).
    """

    t_s: Sequence[float]
    x_m_s2: Sequence[float] | None = field(default=None, metadata=OMITTED)
    x_peak_m_s2: float | None = field(default=None, metadata=OMITTED)
    x_is: str | None = field(default=None, metadata=OMITTED)
    y_m_s2: Sequence[float] | None = field(default=None, metadata=OMITTED)
    y_peak_m_s2: float | None = field(default=None, metadata=OMITTED)
    y_is: str | None = field(default=None, metadata=OMITTED)
    z_m_s2: Sequence[float] | None = field(default=None, metadata=OMITTED)
    z_peak_m_s2: float | None = field(default=None, metadata=OMITTED)
    z_is: str | None = field(default=None, metadata=OMITTED)
    push: PushRecord | None = field(default=None, metadata=OMITTED)
    level_m_s2: Sequence[Point] | None = field(default=None, metadata=OMITTED)

    def __post_init__(self) -> None:
        for axis, values in self.accel_m_s2.items():
            times, given = len(self.t_s), len(values)
            agree((given == times, f"{axis}_m_s2", f"{times} values, as `t_s` has", f"{given}"))

    @property
    def accel_m_s2(self) -> dict[Axis, Sequence[float]]:
        """The acceleration by the axes along which the floor moves."""
        along: dict[Axis, Sequence[float] | None] = {"x": self.x_m_s2, "y": self.y_m_s2, "z": self.z_m_s2}
        return {axis: values for axis, values in along.items() if values is not None}

    def peak_m_s2(self, axis: Axis) -> float:
        """The largest size along an axis."""
        return {"x": self.x_peak_m_s2, "y": self.y_peak_m_s2, "z": self.z_peak_m_s2}[axis] or 0.0

    def words(self, axis: Axis) -> str:
        """What the floor does along an axis, in words."""
        return {"x": self.x_is, "y": self.y_is, "z": self.z_is}[axis] or ""


def motion_of(scene: Scene) -> MotionRecord:
    """The motion's record of a scene."""
    t_s, base = np.linspace(0.0, scene.duration_s, MOTION_SAMPLES), scene.base_excitation
    moving = {axis: item for axis, item in zip("xyz", base.parts, strict=True) if not isinstance(item, ZeroExcitation)}
    parts: dict[str, object] = {}
    for axis, item in moving.items():
        parts[f"{axis}_m_s2"] = _largest((item,), t_s)[:, 0].tolist()
        parts[f"{axis}_peak_m_s2"] = peak_within_m_s2(item, scene.duration_s)
        parts[f"{axis}_is"] = repr(item) if not hasattr(item, "t_s") else f"record of {len(item.t_s)} samples"
    if {"x", "y"} & moving.keys():
        push = push_of(scene)
        parts["push"] = PushRecord(push.peak, push.shares, push.first[0])
    if {"x", "y"} <= moving.keys():
        parts["level_m_s2"] = _largest((base.x, base.y), t_s).tolist()
    return MotionRecord(t_s=t_s.tolist(), **parts)  # type: ignore[arg-type]


def _largest(items: Sequence[Excitation], t_s: Array) -> Array:
    """The values (n, k) of all items at the instant of their largest sum as vectors, among ten samples of each interval, so that
    no peak is lost in a drawing.
    """
    fine = np.clip(t_s[:, None] + (t_s[1] - t_s[0]) * (np.arange(10) - 5.0) / 10.0, 0.0, t_s[-1])
    values = np.stack([np.asarray(item.accel_m_s2(fine.ravel())).reshape(fine.shape) for item in items], axis=2)
    return np.asarray(values[np.arange(len(t_s)), np.argmax((values**2).sum(axis=2), axis=1)])
