"""What a scene rests on, needs and may leave out, decided before anything runs; printed by `--explain`."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from analytic.excitation import BOW, SampledAcceleration, ZeroExcitation
from harness.model import OVERTURN_RAD, SKIPS, Array, Capabilities, Finding, Pedestal, RunOptions, Scene, Statue, info
from harness.statics.standstill import LEVEL_M, instants_s, resting_polygon_m, rests_on_m, tipping_of_pedestal
from meshes.footprint import margin_m, outward_sides
from meshes.solid import hull_excess_rel

# Other bodies made of a statue and its pedestal: both as one, its base widened, another side before the shaking.


def as_one(statue: Statue, pedestal: Pedestal) -> Statue:
    """The statue fixed to its pedestal: mass, centroid and inertia of both (parallel axes), on the pedestal's base."""
    mass = statue.mass_kg + pedestal.mass_kg
    middle = statue.base_centre_m + pedestal.offset_m
    centres = np.array(
        [[0.0, 0.0, pedestal.height_m + statue.centroid_height_m], [middle, 0.0, pedestal.centroid_height_m]]
    )
    masses = np.array([statue.mass_kg, pedestal.mass_kg])
    centroid = masses @ centres / mass
    w, d, h = pedestal.width_m, pedestal.depth_m, pedestal.height_m
    tensor = statue.inertia_tensor_kg_m2 + pedestal.mass_kg / 12.0 * np.diag(
        [d * d + h * h, w * w + h * h, w * w + d * d]
    )
    for each, centre in zip(masses, centres - centroid, strict=True):
        tensor = tensor + each * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    left, right = float(centroid[0] - middle + 0.5 * w), float(middle + 0.5 * w - centroid[0])
    raised = statue.section_m + np.array([-centroid[0], h])
    return Statue(
        mass_kg=mass,
        centroid_height_m=float(centroid[2]),
        corner_left_m=left,
        corner_right_m=right,
        inertia_kg_m2=float(tensor[1, 1]),
        height_m=statue.height_m + h,
        depth_m=d,
        section_m=np.vstack([[[-left, 0.0], [right, 0.0]], raised]),
        footprint_m=_rectangle(left, right, 0.5 * d, 0.5 * d),
        inertia_tensor_kg_m2=tensor,
    )


def sliding(scene: Scene) -> Scene:
    """The scene's body as one that slides and cannot rock: its mass shared by a pedestal and a plate too flat to lift.

    A rigid body that slides knows no mass: only friction and the floor's motion decide its path.
    """
    half = 0.5 * scene.statue.mass_kg
    low, wide = 0.01, 1.0
    section = np.array([[-wide, 0.0], [wide, 0.0], [wide, 2.0 * low], [-wide, 2.0 * low]])
    plate = Statue(
        half,
        low,
        wide,
        wide,
        half * wide**2 / 3.0,
        2.0 * low,
        wide,
        section,
        _rectangle(wide, wide, 0.5 * wide, 0.5 * wide),
        half * np.eye(3),
    )
    return replace(scene, statue=plate, pedestal=Pedestal(half, 2.0 * wide, wide, low))


def widened(statue: Statue, by_m: float) -> Statue:
    """The statue on a plate fixed to it that reaches `by_m` beyond both corners; the plate itself weighs nothing here."""
    left, right = statue.corner_left_m + by_m, statue.corner_right_m + by_m
    front, back = -float(statue.footprint_m[:, 1].min()) + by_m, float(statue.footprint_m[:, 1].max()) + by_m
    section = np.vstack([[[-left, 0.0], [right, 0.0]], statue.section_m])
    return replace(
        statue,
        corner_left_m=left,
        corner_right_m=right,
        section_m=section,
        footprint_m=_rectangle(left, right, front, back),
        solid=None,
    )


def turned_block(statue: Statue) -> Statue:
    """A block turned by 90 degrees: its depth lies in the rocking plane, and its moment about x decides."""
    half, across = 0.5 * statue.depth_m, statue.corner_left_m + statue.corner_right_m
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    tensor = turn @ statue.inertia_tensor_kg_m2 @ turn.T
    return replace(
        statue,
        corner_left_m=half,
        corner_right_m=half,
        depth_m=across,
        inertia_kg_m2=float(tensor[1, 1]),
        section_m=np.array([[-half, 0.0], [half, 0.0], [half, statue.height_m], [-half, statue.height_m]]),
        # What was left is now in front.
        footprint_m=_rectangle(half, half, statue.corner_left_m, statue.corner_right_m),
        inertia_tensor_kg_m2=tensor,
    )


def _rectangle(left: float, right: float, front: float, back: float) -> Array:
    return np.array([[-left, -front, 0.0], [right, -front, 0.0], [right, back, 0.0], [-left, back, 0.0]])


WINDOW: Final = 256
"""Samples looked at together: the first that moves a statue at rest mostly comes soon."""


def limit_of_rest_m_s2(scene: Scene) -> float:
    """Horizontal acceleration, in whatever direction, below which nothing can move while the floor moves horizontally only.

    The least of uplift, g b / h with b the distance of the nearest edge of what it rests on (of its two ends when the motion
    stays in the plane), and, on a pedestal, slip, μ_s g (docs/model.md, section 2).
    """
    statue, gravity, stands_on = scene.statue, scene.gravity_m_s2, rests_on_m(scene.statue)
    corner = float(np.abs([stands_on[:, 0].min(), stands_on[:, 0].max()]).min())
    if not isinstance(scene.base_excitation.y, ZeroExcitation):
        corner = min(corner, margin_m(stands_on))
    return min(gravity * corner / statue.centroid_height_m, _holding_friction(scene) * gravity)


def _holding_friction(scene: Scene) -> float:
    """The least coefficient of static friction between statue and floor."""
    contact = scene.contact
    return contact.statue if scene.pedestal is None else min(contact.floor_static, contact.statue)


@dataclass(frozen=True, eq=False)
class LimitsOfRest:
    """A statue at rest on its lowest vertices `polygon_m` (k, 2) under accelerations (n, 3) at instants between which they are
    straight lines, so that what both ends bear is borne between them too; `bow_m_s2` is by how much formulas depart from them.
    """

    scene: Scene
    polygon_m: Array
    times_s: Array
    accel_m_s2: Array
    bow_m_s2: float = 0.0

    @classmethod
    def of(cls, scene: Scene) -> Self | None:
        """None where a component has too many cycles, or the statue tilts off its lowest vertices or overhangs its pedestal: then
        nothing is known.
        """
        parts = scene.base_excitation.parts
        if any(item.straight_s(scene.duration_s) is None for item in parts):
            return None
        polygon = resting_polygon_m(scene.statue)
        if polygon is None:
            return None
        if scene.pedestal is not None:
            # No scene file has a statue that its pedestal's top does not bear on all of its lowest vertices.
            middle_m = scene.statue.base_centre_m + scene.pedestal.offset_m, 0.0
            if np.max(np.abs(polygon - middle_m) - scene.pedestal.half_m[:2]) > LEVEL_M:
                return None
        times = instants_s(parts, scene.duration_s)
        accel = np.stack([np.asarray(item.accel_m_s2(times), dtype=np.float64) for item in parts], axis=1)
        formulas = [item.peak_m_s2 for item in parts if not isinstance(item, SampledAcceleration)]
        return cls(scene, polygon, times, accel, BOW * math.hypot(*formulas))

    def until_s(self, t_s: float, yaw_rad: float = 0.0) -> float:
        """A time up to which a statue at rest at `t_s`, turned about the vertical, stays so: the last sample before the first
        that moves it; the scene's duration where none does.
        """
        first = max(int(np.searchsorted(self.times_s, t_s, side="right")) - 1, 0)
        if not self.accel_m_s2[first:].any():
            return self.scene.duration_s
        for begin in range(first, self.times_s.size, WINDOW):
            passed = np.flatnonzero(self._moves(self.accel_m_s2[begin : begin + WINDOW], yaw_rad))
            if passed.size:
                return max(float(self.times_s[max(begin + int(passed[0]) - 1, 0)]), t_s)
        return self.scene.duration_s

    def _moves(self, accel_m_s2: Array, yaw_rad: float) -> NDArray[np.bool_]:
        """At which samples the floor's acceleration passes what friction holds or what the base bears, statue or pedestal.

        A base bears it while the weight's line, leant by the acceleration, meets the floor inside the polygon that it rests on.
        A planar body bears at least as much: its ends are the polygon's outermost points.
        """
        scene, statue = self.scene, self.scene.statue
        weight = np.maximum(scene.gravity_m_s2 - np.abs(accel_m_s2[:, 2]) - self.bow_m_s2, 0.0)
        push = -accel_m_s2[:, :2]
        slips = np.hypot(push[:, 0], push[:, 1]) + self.bow_m_s2 >= _holding_friction(scene) * weight
        # What pushes, in the frame of a statue that has turned.
        cosine, sine = math.cos(yaw_rad), math.sin(yaw_rad)
        turned = push @ np.array([[cosine, -sine], [sine, cosine]])
        normals, reach = outward_sides(self.polygon_m)
        moves: NDArray[np.bool_] = slips | np.any(
            statue.centroid_height_m * (turned @ normals.T + self.bow_m_s2) >= reach * weight[:, None], axis=1
        )
        if scene.pedestal is not None:
            sides = tipping_of_pedestal(statue.mass_kg, statue.centroid_height_m, statue.base_centre_m, scene.pedestal)
            for (axis, direction), share in sides.items():
                moves |= direction * push[:, axis] + self.bow_m_s2 >= share * weight
        return moves


def first_motion_s(scene: Scene) -> float:
    """A time before which nothing can move: the last instant of `LimitsOfRest` before a limit is first exceeded (0 when the
    statue starts off rest, or on a table that itself moves).

    A body with a rough base rests on its lowest vertices, which lie nearer than its corners; where its centroid is not above
    them it tilts at once: 0 too.
    """
    limits = LimitsOfRest.of(scene) if scene.initial.still and scene.table == "frame" else None
    return 0.0 if limits is None else limits.until_s(0.0)


# Which collision shape of the statue a 3D run needs, and why: a pure function of the scene.

HULL_EXCESS_LIMIT: Final = 0.12
"""What a hull may add to the volume near an edge: about what the convex parts themselves add to a statue (docs/meshes.md)."""


@dataclass(frozen=True)
class Need:
    """The shape that meets a pedestal's edge: `base` (vertices alone), `hull` or `parts`.

    `excess` is what the hull adds to the volume of the mesh below `below_m`, the highest that an edge can meet, as a share of it;
    above `limit` parts are needed.
    """

    shape: Literal["base", "hull", "parts"]
    excess: float = 0.0
    below_m: float = 0.0
    limit: float = HULL_EXCESS_LIMIT


def shape_needed(scene: Scene) -> Need:
    """The cheapest shape that is right: planes touch vertices of the hull, an edge touches what lies between them.

    A level floor and a wall are planes; a statue given by numbers is convex.
    """
    if scene.pedestal is None:
        return Need("base")
    if scene.statue.solid is None:
        return Need("hull")
    # A body turning on a foot that has not slipped meets the edge with points as far from it, hence no higher above the base.
    pedestal, middle_m = scene.pedestal, np.array([scene.statue.base_centre_m + scene.pedestal.offset_m, 0.0])
    reach_m = np.abs(scene.statue.feet_m[:, :2] - middle_m) + 0.5 * np.array([pedestal.width_m, pedestal.depth_m])
    below_m = min(float(np.hypot(reach_m[:, 0], reach_m[:, 1]).max()), scene.statue.height_m)
    excess = hull_excess_rel(scene.statue.solid, below_m)
    return Need("hull" if excess <= HULL_EXCESS_LIMIT else "parts", excess, below_m)


# Whether a scene is its own mirror image across the rocking plane.

SAME: Final = 1e-9
"""Lengths (m) and shares of the inertia that differ by no more are equal: rounding of the numbers given."""


def asymmetry(scene: Scene) -> str | None:
    """What keeps a scene from being its own mirror image: `plane`, `inertia` or `base`; None when it is one."""
    if not scene.planar:
        return "plane"
    tensor, feet = scene.statue.inertia_tensor_kg_m2, scene.statue.footprint_m
    if max(abs(float(tensor[0, 1])), abs(float(tensor[1, 2]))) > SAME * float(np.trace(tensor)):
        return "inertia"
    if np.max(np.abs(_sorted(feet) - _sorted(feet * np.array([1.0, -1.0, 1.0])))) > SAME:
        return "base"
    return None


def _sorted(points_m: Array) -> Array:
    """Points (k, 3) in an order that rounding does not change."""
    return points_m[np.lexsort(np.round(points_m / SAME).T)]


class PlannedEngine(Protocol):
    """What a plan needs to know of an engine."""

    @property
    def name(self) -> str:
        """Its name."""

    @property
    def capabilities(self) -> Capabilities:
        """What it is able to do."""


@dataclass(frozen=True)
class Step:
    """One decision of the plan: the skip's name, the engine it concerns (`*`: all), whether it applies, and why."""

    skip: str
    engine: str
    applies: bool
    reason: Finding


def plan(
    scene: Scene, engines: Sequence[PlannedEngine], options: RunOptions, registered: Iterable[str] = ()
) -> tuple[Step, ...]:
    """All decisions for a scene: each engine's own skips, then those of the harness.

    `registered` names all engines there are: those that are not among `engines` are not imported.
    """
    own = [
        _decided(name, scene, engine, options)
        for engine in engines
        for name in SKIPS
        if name in engine.capabilities.skips
    ]
    idle = [name for name in registered if name not in {engine.name for engine in engines}]
    return (
        *own,
        *_edges(scene, engines),
        _planar(scene, engines),
        # Switched by naming the engine, and by another folder for the store.
        Step("lazy_engines", "*", bool(idle), info("plan_engines", idle=idle, every=not idle)),
        Step("cached", "*", False, info("plan_always_computed")),
    )


def _decided(name: str, scene: Scene, engine: PlannedEngine, options: RunOptions) -> Step:
    """Whether a skip that an engine has applies to a scene, and why; switched with `--no-skip`."""
    if name not in options.skips:
        return Step(name, engine.name, False, info("plan_switched_off"))
    reason, applies = _reason(name, scene, options)
    return Step(name, engine.name, applies, reason)


def _reason(name: str, scene: Scene, options: RunOptions) -> tuple[Finding, bool]:
    match name:
        case "quiet_start" if (quiet := first_motion_s(scene)) > 0.0:
            return info("plan_nothing_moves", until_s=quiet), True
        case "quiet_start":
            return info("plan_not_quiet"), False
        case "quiet_end" if (end := scene.base_excitation.end_s) < scene.duration_s:
            return info("plan_floor_still", from_s=end), True
        case "quiet_end":
            return info("plan_floor_moves"), False
        case "quiet_rest" | "mirror" if scene.table != "frame":
            return info("plan_table_moves"), False
        case "quiet_rest" if LimitsOfRest.of(scene) is None:
            return info("plan_no_limits_of_rest"), False
        case "quiet_rest":
            return info("plan_below_limits_of_rest"), True
        case "mirror" if (cause := asymmetry(scene)) is not None:
            return info("plan_asymmetric", cause=cause), False
        case "mirror":
            return info("plan_mirror", whole="base_only" not in options.skips and scene.pedestal is not None), True
        case "no_history" if options.history:
            return info("plan_histories_asked"), False
        case "no_history":
            return info("plan_outcome_asked"), True
        case "stop_at_overturn":
            return info("plan_overturned", lean_rad=OVERTURN_RAD), True
        case "base_only":
            from meshes.decomposition import missing

            need, wall = shape_needed(scene), None if scene.wall is None else scene.wall.side
            absent = missing() if need.shape == "parts" else None
            return info("plan_shape", wall=wall, missing=absent, **vars(need)), True
    raise KeyError(name)


def _edges(scene: Scene, engines: Sequence[PlannedEngine]) -> list[Step]:
    """Engines that have one shape of their own for whatever scene, said where a pedestal's edge would need another."""
    need = shape_needed(scene)
    shapes = {engine.name: engine.capabilities.edge_shape for engine in engines if need.shape == "parts"}
    return [
        Step("base_only", name, False, info("plan_edge_shape", **vars(need) | {"shape": shape}))
        for name, shape in shapes.items()
        if shape
    ]


def _planar(scene: Scene, engines: Sequence[PlannedEngine]) -> Step:
    """Switched by naming a 3D engine."""
    solid = [engine.name for engine in engines if engine.capabilities.dimensions == 3]
    reason = info("plan_in_3d", engines=solid) if solid else info("plan_no_3d", planar=scene.planar)
    return Step("planar", "*", scene.planar and not solid, reason)
