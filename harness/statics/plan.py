"""What a scene needs and what may be left out, decided before anything runs; printed by `--explain`."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Literal, Protocol

import numpy as np

from harness.model.finding import Finding, info
from harness.model.history import Array
from harness.model.options import SKIPS, Capabilities, RunOptions
from harness.model.scene import OVERTURN_RAD, Pedestal, Scene, Statue
from harness.statics.rest import LimitsOfRest, first_motion_s

# Which collision shape of the statue a 3D run needs, and why: a pure function of the scene.


HULL_EXCESS_LIMIT: Final = 0.12
"""What a hull may add to the volume near an edge: about what the convex parts themselves add to a statue (docs/meshes.md)."""


@dataclass(frozen=True)
class Need:
    """The shape that meets a pedestal's edge: `base` (vertices alone), `hull` or `parts`.

    `hull_excess_rel` is what the hull adds to the volume of the mesh below `below_m`, the highest that an edge can meet.
    """

    shape: Literal["base", "hull", "parts"]
    hull_excess_rel: float = 0.0
    below_m: float = 0.0


def shape_needed(scene: Scene) -> Need:
    """The cheapest shape that is right: planes touch vertices of the hull, an edge touches what lies between them.

    A level floor and a wall are planes; a statue given by numbers is convex.
    """
    from meshes.collision import hull_excess_rel

    if scene.pedestal is None:
        return Need("base")
    if scene.statue.solid is None:
        return Need("hull")
    below_m = min(edge_reach_m(scene.statue, scene.pedestal), scene.statue.height_m)
    excess = hull_excess_rel(scene.statue.solid, below_m)
    return Need("hull" if excess <= HULL_EXCESS_LIMIT else "parts", excess, below_m)


def edge_reach_m(statue: Statue, pedestal: Pedestal) -> float:
    """Greatest distance from a foot to the pedestal's edge: a body turning on that foot meets the edge with points as far
    from it, hence no higher above the base (while the foot has not slipped).
    """
    centre = statue.base_centre_m + pedestal.offset_m
    far = np.abs(statue.feet_m[:, :2] - np.array([centre, 0.0])) + 0.5 * np.array([pedestal.width_m, pedestal.depth_m])
    return float(np.hypot(far[:, 0], far[:, 1]).max())


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


class Asked(Protocol):
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
    scene: Scene, engines: Sequence[Asked], options: RunOptions, registered: Iterable[str] = ()
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
    return (*own, *_edges(scene, engines), _planar(scene, engines), _lazy(engines, registered), _cached())


def _decided(name: str, scene: Scene, engine: Asked, options: RunOptions) -> Step:
    """One skip of one engine."""
    if name not in options.skips:
        return Step(name, engine.name, False, info("plan_switched_off"))
    applies, reason = DECISIONS[name](scene, options)
    return Step(name, engine.name, applies, reason)


def _quiet_start(scene: Scene, options: RunOptions) -> Decision:
    quiet = first_motion_s(scene)
    return (True, info("plan_nothing_moves", until_s=quiet)) if quiet > 0.0 else (False, info("plan_not_quiet"))


def _quiet_rest(scene: Scene, options: RunOptions) -> Decision:
    if scene.table != "frame":
        return False, info("plan_table_moves")
    if LimitsOfRest.of(scene) is None:
        return False, info("plan_no_limits_of_rest")
    return True, info("plan_below_limits_of_rest")


def _quiet_end(scene: Scene, options: RunOptions) -> Decision:
    end = scene.base_excitation.end_s
    return (True, info("plan_floor_still", from_s=end)) if end < scene.duration_s else (False, info("plan_floor_moves"))


def _energy(scene: Scene, options: RunOptions) -> Decision:
    end = scene.base_excitation.end_s
    if options.history:
        return False, info("plan_histories_asked")
    return (True, info("plan_energy", from_s=end)) if end < scene.duration_s else (False, info("plan_floor_moves"))


def _base_only(scene: Scene, options: RunOptions) -> Decision:
    from meshes.decomposition import missing

    need, wall = shape_needed(scene), None if scene.wall is None else scene.wall.side
    absent = missing() if need.shape == "parts" else None
    return True, info("plan_shape", shape=need.shape, wall=wall, missing=absent, **_excess(need))


def _excess(need: Need) -> dict[str, float]:
    return {"excess": need.hull_excess_rel, "limit": HULL_EXCESS_LIMIT, "below_m": need.below_m}


def _mirror(scene: Scene, options: RunOptions) -> Decision:
    if scene.table != "frame":
        return False, info("plan_table_moves")
    cause = asymmetry(scene)
    if cause is not None:
        return False, info("plan_asymmetric", cause=cause)
    whole = "base_only" not in options.skips and scene.pedestal is not None
    return True, info("plan_mirror", whole=whole)


def _no_history(scene: Scene, options: RunOptions) -> Decision:
    return (False, info("plan_histories_asked")) if options.history else (True, info("plan_outcome_asked"))


def _stop(scene: Scene, options: RunOptions) -> Decision:
    return True, info("plan_overturned", lean_rad=OVERTURN_RAD)


Decision = tuple[bool, Finding]
DECISIONS: Final[Mapping[str, Callable[[Scene, RunOptions], Decision]]] = {
    "quiet_start": _quiet_start,
    "quiet_rest": _quiet_rest,
    "quiet_end": _quiet_end,
    "energy_outcome": _energy,
    "base_only": _base_only,
    "mirror": _mirror,
    "no_history": _no_history,
    "stop_at_overturn": _stop,
}
"""Whether a skip that an engine has applies to a scene, and why; switched with `--no-skip`."""


def _edges(scene: Scene, engines: Sequence[Asked]) -> list[Step]:
    """Engines that have one shape of their own for whatever scene, said where a pedestal's edge would need another."""
    need = shape_needed(scene)
    if need.shape != "parts":
        return []
    shapes = {engine.name: engine.capabilities.edge_shape for engine in engines if engine.capabilities.edge_shape}
    return [
        Step("base_only", name, False, info("plan_edge_shape", shape=shape, **_excess(need)))
        for name, shape in shapes.items()
    ]


def _planar(scene: Scene, engines: Sequence[Asked]) -> Step:
    """Switched by naming a 3D engine."""
    solid = [engine.name for engine in engines if engine.capabilities.dimensions == 3]
    if solid:
        return Step("planar", "*", False, info("plan_in_3d", engines=solid))
    return Step("planar", "*", scene.planar, info("plan_no_3d", planar=scene.planar))


def _lazy(engines: Sequence[Asked], registered: Iterable[str]) -> Step:
    """Switched by naming the engine."""
    asked = {engine.name for engine in engines}
    idle = [name for name in registered if name not in asked]
    return Step("lazy_engines", "*", bool(idle), info("plan_engines", idle=idle, every=not idle))


def _cached() -> Step:
    """Switched by another folder for the store."""
    return Step("cached", "*", False, info("plan_always_computed"))
