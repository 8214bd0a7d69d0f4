"""The scene as engines see it: plain numbers, arrays and accelerations; nothing left to read or to decide."""

from __future__ import annotations

import math
import pickle
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property, lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np
from numpy.typing import ArrayLike

from analytic.block import OVERTURN_RAD as OVERTURN_RAD
from analytic.block import rotation_matrices
from analytic.excitation import Excitation, Harmonic, Pulse, SampledAcceleration, ZeroExcitation
from harness.model.errors import require, required
from harness.model.finding import Axes, Finding, Shown, new_axes
from harness.model.history import Array, numbers
from harness.model.run import OMITTED

if TYPE_CHECKING:
    from pydantic import JsonValue

    from meshes import Solid


# A pedestal that tips: where its centroid and its top come to lie, whose slip is that of the edge on which it stands.


def centroid_shift_m(pedestal: Pedestal, tilt_rad: Array) -> Array:
    """How far the centroid moves along the floor while the pedestal tips about an edge that stands, of the tilts' shape:
    (h/2) sin φ + sgn φ (w/2) (1 − cos φ).
    """
    aside = 0.5 * pedestal.width_m * np.sign(tilt_rad) * (1.0 - np.cos(tilt_rad))
    return np.asarray(0.5 * pedestal.height_m * np.sin(tilt_rad) + aside)


def support_m(pedestal: Pedestal | None, slip_m: Array, extra: Mapping[str, Array]) -> Array:
    """Displacement (n,) of what the statue stands on, from a history's columns: of the middle of its pedestal's top."""
    tilt_rad = extra.get("pedestal_tilt_rad")
    if pedestal is None or tilt_rad is None:
        return slip_m
    return np.asarray(slip_m + centroid_shift_m(pedestal, tilt_rad) + 0.5 * pedestal.height_m * np.sin(tilt_rad))


SOLID_COLUMNS: Final = (
    "pitch_rad",
    "roll_rad",
    "yaw_rad",
    "corner_right_x_m",
    "corner_right_y_m",
    "corner_right_z_m",
)
"""Columns that give the statue's whole pose: R = R_z(yaw) R_y(pitch) R_x(roll) and its right corner's place."""


def rotations(columns: Mapping[str, Array | float]) -> Array:
    """Rotation matrices (..., 3, 3) from the statue's frame to the table's, of values or columns of `SOLID_COLUMNS`."""
    pitch, roll, yaw = (columns[name] for name in SOLID_COLUMNS[:3])
    cr, sr, cp, sp, cy, sy = np.cos(roll), np.sin(roll), np.cos(pitch), np.sin(pitch), np.cos(yaw), np.sin(yaw)
    turn = np.empty((*np.shape(pitch), 3, 3))
    turn[..., 0, :] = np.stack([cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr], axis=-1)
    turn[..., 1, :] = np.stack([sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr], axis=-1)
    turn[..., 2, :] = np.stack([-sp, cp * sr, cp * cr], axis=-1)
    return turn


# What a scene's file says, read as it was written.


def written(scene: Scene, *keys: str) -> object:
    """What the file has under keys, each in the table of the one before; None where it has nothing."""
    value: object = scene.given
    for key in keys:
        value = value.get(key) if isinstance(value, Mapping) else None
    return value


def scan_azimuth_deg(scene: Scene) -> float:
    """By how much the file turns the scan about the vertical."""
    value = written(scene, "statue", "mesh", "azimuth_deg")
    return float(value) if isinstance(value, int | float) else 0.0


@dataclass(frozen=True)
class Form:
    """Which form of the model (docs/model.md, section 4): `dynamic`/`static` normal force, `momentum`/`unchanged` pedestal."""

    friction_normal: Literal["dynamic", "static"] = "dynamic"
    pedestal_at_impact: Literal["momentum", "unchanged"] = "momentum"


KEPT_STATUES: Final = 2
"""Statues that a worker keeps: a question asks of one, here and there beside another."""


@dataclass(frozen=True, eq=False)
class Statue:
    """The statue in its own frame: origin on the base plane below the centroid, x in the rocking plane, z up.

    `section_m` (k, 2) is the convex silhouette in (x, z), `footprint_m` (k, 3) the base vertices that touch, counter-clockwise
    from above; both hold exactly the corners. `inertia_tensor_kg_m2` (3, 3) is about the centroid; its yy entry is
    `inertia_kg_m2`. `solid` is the statue's mesh, None when the scene gives numbers alone (a block).
    """

    mass_kg: float
    centroid_height_m: float
    corner_left_m: float
    corner_right_m: float
    inertia_kg_m2: float
    height_m: float
    depth_m: float
    section_m: Array
    footprint_m: Array
    inertia_tensor_kg_m2: Array
    solid: Solid | None = None

    def __reduce__(self) -> tuple[Any, ...]:
        """To another process a statue goes as its bytes: what is worked out of a mesh there is kept for the next scene of it."""
        return _unpacked, (pickle.dumps([getattr(self, each.name) for each in fields(self)]),)

    @property
    def base_centre_m(self) -> float:
        """x of the middle of the base."""
        return 0.5 * (self.corner_right_m - self.corner_left_m)

    @property
    def feet_m(self) -> Array:
        """Points (k, 3) that a level floor can touch as it stands: of a mesh those of its base's lower hull, raggedness kept."""
        return self.footprint_m if self.solid is None else self.solid.feet_m

    @property
    def outer_points_m(self) -> Array:
        """Points (k, 3) whose hull is the body's: the mesh's vertices, a block's eight corners; about the centroid."""
        block = np.vstack([self.footprint_m, self.footprint_m + np.array([0.0, 0.0, self.height_m])])
        points = block if self.solid is None else self.solid.vertices_m
        return np.asarray(points - np.array([0.0, 0.0, self.centroid_height_m]))

    def corner_m(self, side: int) -> float:
        """Distance b_s of the corner on that side (+1 right, −1 left) from the centroid's vertical."""
        return self.corner_right_m if side > 0 else self.corner_left_m

    @property
    def profile_m(self) -> tuple[tuple[float, float], ...]:
        """The base's vertices (x, z) in the rocking plane, from left to right: two corners, or those of a scan's worn base."""
        if self.solid is None or len(self.solid.base_profile_m) <= 2:
            return (-self.corner_left_m, 0.0), (self.corner_right_m, 0.0)
        return tuple((float(x), float(z)) for x, z in self.solid.base_profile_m)

    def slenderness_rad(self, side: int) -> float:
        """α_s = atan(b_s / h), h above that corner."""
        return math.atan2(self.corner_m(side), self.centroid_height_m - self.profile_m[-1 if side > 0 else 0][1])


@lru_cache(maxsize=KEPT_STATUES)
def _unpacked(packed: bytes) -> Statue:
    return Statue(*pickle.loads(packed))


@dataclass(frozen=True)
class Pedestal:
    """A rigid rectangular pedestal; `offset_m` is its centre from the centre of the statue's base."""

    mass_kg: float
    width_m: float
    depth_m: float
    height_m: float
    offset_m: float = 0.0

    @property
    def centroid_height_m(self) -> float:
        """Height of its centroid above the floor."""
        return 0.5 * self.height_m

    @property
    def half_m(self) -> tuple[float, float, float]:
        """Half its width, depth and height."""
        return 0.5 * self.width_m, 0.5 * self.depth_m, 0.5 * self.height_m


@dataclass(frozen=True)
class Contact:
    """Friction and impact; `restitution` None is the angular-momentum law (or the engine's own impact).

    `floor_impact` is the coefficient that acts as an impact breaks a stuck pedestal loose (docs/model.md, section 3).
    """

    floor_static: float
    floor_kinetic: float
    statue: float
    restitution: float | None = None
    floor_impact: float | Literal["kinetic", "static"] = "kinetic"

    @property
    def at_impact(self) -> float:
        """The floor's coefficient as an impact breaks a stuck pedestal loose."""
        acts = self.floor_impact
        if isinstance(acts, str):
            return self.floor_static if acts == "static" else self.floor_kinetic
        return acts

    def with_floor(self, static: float, kinetic: float, share: float | None = None) -> Contact:
        """The same with other coefficients of the floor, in motion at most that at rest; what acts at an impact lies as far
        between them, or at that share."""
        kinetic = min(kinetic, static)
        acts, apart = self.floor_impact, self.floor_static - self.floor_kinetic
        if share is None and not isinstance(acts, str):
            share = (acts - self.floor_kinetic) / apart if apart > 0.0 else 0.0
        if share is not None:
            acts = min(max(kinetic + share * (static - kinetic), kinetic), static)
        return replace(self, floor_static=static, floor_kinetic=kinetic, floor_impact=acts)


MOTIONS: Final = (ZeroExcitation, Harmonic, Pulse, SampledAcceleration)
"""What the floor's acceleration along an axis may be."""
_SAMPLED: Final = f"one of {', '.join(each.__name__ for each in MOTIONS)}"


@dataclass(frozen=True)
class BaseExcitation:
    """Acceleration of the floor: x in the rocking plane, y across it, z up. Raises `InputError` for a motion of one's own class,
    which the compiled model does not know.
    """

    x: Excitation = field(default_factory=ZeroExcitation)
    y: Excitation = field(default_factory=ZeroExcitation)
    z: Excitation = field(default_factory=ZeroExcitation)

    def __post_init__(self) -> None:
        advice = "sample it: scene.with_motion(accel_m_s2, dt_s)"
        for axis, part in zip("xyz", self.parts, strict=True):
            require(type(part) in MOTIONS, "BaseExcitation", _SAMPLED, type(part).__name__, advice, key=axis)

    @property
    def parts(self) -> tuple[Excitation, Excitation, Excitation]:
        """The components along x, y and z."""
        return self.x, self.y, self.z

    @property
    def end_s(self) -> float:
        """After this time all components are exactly zero."""
        return max(part.end_s for part in self.parts)

    @property
    def still(self) -> bool:
        """Whether the floor never moves."""
        return all(isinstance(part, ZeroExcitation) for part in self.parts)

    def axes(self, dimensions: int = 3) -> tuple[str, ...]:
        """The axes along which the floor moves, of those that a model of 2 (x and z) or 3 dimensions is given."""
        return tuple(axis for axis in ("xyz" if dimensions == 3 else "xz") if getattr(self, axis).peak_m_s2 > 0.0)

    def in_plane(self) -> BaseExcitation:
        """What a planar model is given of it: nothing across the rocking plane."""
        return BaseExcitation(self.x, ZeroExcitation(), self.z)

    def scaled(self, factor: float) -> BaseExcitation:
        """The same motion with every component multiplied by a factor."""
        return BaseExcitation(self.x.scaled(factor), self.y.scaled(factor), self.z.scaled(factor))


@dataclass(frozen=True)
class Wall:
    """A vertical wall at `distance_m` from the statue's base on that side."""

    side: Literal["left", "right"]
    distance_m: float

    @property
    def sign(self) -> int:
        """+1 right, −1 left."""
        return 1 if self.side == "right" else -1


@dataclass(frozen=True)
class Pose:
    """A body anywhere in space at t = 0, table's frame (z up, floor at 0): its centroid's place and velocity, the rotation of its
    own axes (unit quaternion, w first; none is upright, as the scene describes the statue), angular velocity about these axes.
    """

    position_m: tuple[float, float, float]
    quaternion_wxyz: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)
    velocity_m_s: tuple[float, float, float] = (0.0, 0.0, 0.0)
    angular_velocity_rad_s: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def rotation(self) -> Array:
        """The rotation (3, 3) from the body's axes to the table's."""
        return np.asarray(rotation_matrices(np.array([self.quaternion_wxyz]))[0])

    @property
    def in_plane(self) -> bool:
        """Whether it neither turns nor moves out of the rocking plane."""
        (_, a, _, b), (p, _, r) = self.quaternion_wxyz, self.angular_velocity_rad_s
        return not any((a, b, p, r, self.velocity_m_s[1]))

    def faster(self, factor: float) -> Pose:
        """The same pose with its velocities multiplied by a factor."""
        (u, v, w), (p, q, r) = self.velocity_m_s, self.angular_velocity_rad_s
        turning = (factor * p, factor * q, factor * r)
        return replace(self, velocity_m_s=(factor * u, factor * v, factor * w), angular_velocity_rad_s=turning)


@dataclass(frozen=True)
class Initial:
    """Rotation and rate at t = 0; or, for engines of three dimensions, a pose, beside which both are 0."""

    theta_rad: float = 0.0
    theta_rate_rad_s: float = 0.0
    pose: Pose | None = field(default=None, metadata=OMITTED)

    @property
    def still(self) -> bool:
        """Whether the statue begins at rest on its base."""
        return self.theta_rad == 0.0 and self.theta_rate_rad_s == 0.0 and self.pose is None

    def plus(self, theta_rad: float, rate_rad_s: float) -> Initial:
        """The start with so much more rotation and rate in the rocking plane (of a posed body: more angular velocity only)."""
        if self.pose is None:
            return Initial(self.theta_rad + theta_rad, self.theta_rate_rad_s + rate_rad_s)
        spin = np.array(self.pose.angular_velocity_rad_s) + rate_rad_s * self.pose.rotation[1]
        return Initial(pose=replace(self.pose, angular_velocity_rad_s=(float(spin[0]), float(spin[1]), float(spin[2]))))


@dataclass(frozen=True)
class Uncertain:
    """One number that is not known: its dotted `key`, its distribution's `kind`, the scene's `value` (a lognormal's median, else
    the mean) and the distribution's `width` (`cov`, `sd` or `half_width`).

    Its normal score correlates by `rho` with that of the earlier key `correlated_with` (a Gaussian copula).
    """

    key: str
    kind: Literal["lognormal", "normal", "uniform"]
    value: float
    width: float
    correlated_with: str | None = None
    rho: float = 0.0


Reader = Callable[["Scene", "Mapping[str, object] | Sequence[str]", "Mapping[str, object]"], "Scene"]


@dataclass(frozen=True, eq=False, repr=False)
class Scene(Shown):
    """One scene, resolved. `findings` are what was assumed or reconciled; `given` is the file's content as read."""

    title: str
    duration_s: float
    gravity_m_s2: float
    form: Form
    statue: Statue
    pedestal: Pedestal | None
    contact: Contact
    base_excitation: BaseExcitation
    wall: Wall | None = None
    initial: Initial = Initial()
    table: Literal["frame", "moving"] = "frame"
    output_dt_s: float = 0.001
    source: Path | None = None
    given: Mapping[str, JsonValue] = field(default_factory=dict)
    findings: Sequence[Finding] = ()
    uncertainty: Sequence[Uncertain] = ()
    _reader: Reader | None = field(default=None, repr=False)
    """What reads its tables anew with other values (`harness.input.scene_file.changed`); None of a scene of resolved parts."""

    def replace(self, overrides: Mapping[str, object] | Sequence[str] = (), /, **keys: object) -> Scene:
        """The scene with keys of its tables replaced, all of it read again: a value, a whole table, or None to remove a key.

        >>> stronger = scene.replace({"motion.x.amplitude_g": 0.4})
        >>> stronger = scene.replace(motion__x__amplitude_g=0.4, duration_s=5.0)

        Keywords have two underscores for each dot. Raises `InputError` for a key or value that makes no scene.
        """
        reader = required(
            self._reader,
            self.title,
            "a scene that was loaded, whose keys are known",
            "one made of parts",
            "use dataclasses.replace",
            key="replace",
        )
        return reader(self, overrides, keys)

    def with_motion(self, accel_m_s2: ArrayLike, dt_s: float, axis: str = "x") -> Scene:
        """The scene shaken along an axis by samples of an acceleration, m/s², every `dt_s` from t = 0, linear between them.

        >>> shaken = scene.with_motion(3.0 * np.sin(2.0 * np.pi * 2.0 * np.arange(0.0, 4.0, 0.005)), dt_s=0.005)

        They take the place of what the scene has along that axis (x in the rocking plane, y across it, z up), and of what is not
        known of it. Raises `InputError` for samples that are no numbers, or fewer than two.
        """
        place = "with_motion"
        require(axis in ("x", "y", "z"), place, "x, y or z", repr(axis), key="axis")
        samples = numbers(accel_m_s2, place, "accel_m_s2")
        require(isinstance(dt_s, int | float) and dt_s > 0.0, place, "a positive step", repr(dt_s), key="dt_s")
        require(
            samples.ndim == 1, place, "an array of one dimension", f"one of shape {samples.shape}", key="accel_m_s2"
        )
        wrong = np.flatnonzero(~np.isfinite(samples))
        got = f"{samples[wrong[0]]} at sample {wrong[0]}" if wrong.size else ""
        require(not got, place, "finite numbers", got, key="accel_m_s2")
        motion, unknown = self.given.get("motion"), self.given.get("uncertainty")
        # What the file multiplies all axes by multiplies these too.
        scale = motion.get("scale") if isinstance(motion, Mapping) else None
        own = samples / scale if isinstance(scale, int | float) else samples
        keys: dict[str, object] = {f"motion.{axis}": {"kind": "samples", "dt_s": dt_s, "accel_m_s2": own}}
        if isinstance(unknown, Mapping):
            keys["uncertainty"] = {
                key: value for key, value in unknown.items() if not key.startswith(f"motion.{axis}.")
            }
        return self.replace(keys)

    def facts(self) -> dict[str, str]:
        """Title, statue, what it stands on, the floor's motion, how long."""
        s, p = self.statue, self.pedestal
        balance = f"balances at {s.slenderness_rad(-1):.3f} and {s.slenderness_rad(1):.3f} rad"
        floor = self.base_excitation
        peaks = [f"{axis} up to {getattr(floor, axis).peak_m_s2:.3g} m/s²" for axis in floor.axes()]
        return {
            "title": self.title,
            "statue": f"{s.mass_kg:.4g} kg, {s.height_m:.4g} m high, {balance}",
            "stands on": "the floor" if p is None else f"a pedestal of {p.mass_kg:.4g} kg, {p.height_m:.4g} m high",
            "floor": ", ".join(peaks) or "at rest",
            "duration": f"{self.duration_s:.4g} s",
        }

    def columns(self) -> dict[str, Array]:
        """Acceleration of the floor at the scene's output step, along the axes on which it moves."""
        t_s = np.arange(0.0, self.duration_s, self.output_dt_s)
        floor = self.base_excitation
        return {"t_s": t_s} | {f"accel_{axis}_m_s2": getattr(floor, axis).accel_m_s2(t_s) for axis in floor.axes()}

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the acceleration of the floor over time."""
        ax, columns = new_axes(ax), self.columns()
        for axis in self.base_excitation.axes():
            ax.plot(columns["t_s"], columns[f"accel_{axis}_m_s2"], label=f"floor {axis}")
        ax.set(xlabel="time [s]", ylabel="acceleration [m/s²]", title=self.title)
        return ax

    @property
    def planar(self) -> bool:
        """Whether nothing in the scene leaves the rocking plane (no shaking across it, no scan, no pose in space)."""
        flat = self.statue.solid is None and self.initial.pose is None
        return flat and isinstance(self.base_excitation.y, ZeroExcitation)

    @property
    def pivot_inertia_kg_m2(self) -> Mapping[int, float]:
        """J_s = J_G + m R_s² by side (+1 right, −1 left)."""
        s, h2 = self.statue, self.statue.centroid_height_m**2
        return {side: s.inertia_kg_m2 + s.mass_kg * (s.corner_m(side) ** 2 + h2) for side in (1, -1)}

    @cached_property
    def wall_rotation_rad(self) -> float | None:
        """|θ| at which the statue's silhouette first touches the wall, None without a wall (inf: never below flat)."""
        if self.wall is None:
            return None
        sign = self.wall.sign
        # Every point of the silhouette turns about the corner on that side; the first to reach x = reach counts.
        dx, dz = sign * self.statue.section_m[:, 0] - self.statue.corner_m(sign), self.statue.section_m[:, 1]
        radius = np.hypot(dx, dz)
        touching = radius > self.wall.distance_m
        if np.any(dx > self.wall.distance_m):
            return 0.0
        turn = np.arctan2(dz, dx)[touching] - np.arccos(self.wall.distance_m / radius[touching])
        # A clockwise turn lowers the polar angle: the point meets the wall where r cos(angle) = distance.
        return float(np.min(turn[turn >= 0.0], initial=math.inf))


def must_be_scene(scene: object, caller: str) -> None:
    """Raise `InputError` for what is no scene, such as its file's path."""
    require(isinstance(scene, Scene), caller, "a scene: harness.load_scene(path)", type(scene).__name__, key="scene")
