"""What a scene needs and what may be left out, decided before anything runs; printed by `--explain`."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Protocol

from harness.model.finding import Finding, info
from harness.model.options import SKIPS, Capabilities, RunOptions
from harness.model.scene import OVERTURN_RAD, Scene
from harness.statics.collision_shape import HULL_EXCESS_LIMIT, Need, shape_needed
from harness.statics.rest import LimitsOfRest, first_motion_s
from harness.statics.symmetry import asymmetry


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
