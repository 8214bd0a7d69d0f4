"""What a scene needs and what may be left out, decided before anything runs; printed by `--explain`."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, Protocol

import numpy as np
from numpy.typing import NDArray

from analytic.excitation import Excitation, ZeroExcitation
from harness.model.options import SKIPS, Capabilities, RunOptions
from harness.model.scene import OVERTURN_RAD, Scene, Statue
from harness.statics.collision_shape import shape_needed
from harness.statics.symmetry import asymmetry
from meshes.footprint import margin_m, outward_sides

Array = NDArray[np.float64]
LEVEL_M: Final = 1e-9
"""Feet within this height of each other are level: what is left is rounding."""


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
    reason: str

    def __str__(self) -> str:
        return f"{'skip' if self.applies else 'keep'} {self.skip} ({self.engine}): {self.reason}"


def plan(
    scene: Scene, engines: Sequence[Asked], options: RunOptions, registered: Iterable[str] = ()
) -> tuple[Step, ...]:
    """All decisions for a scene: each engine's own skips, then those of the harness.

    `registered` names all engines there are: those that are not among `engines` are not imported.
    """
    own = [_decided(name, scene, engine, options) for engine in engines for name in SKIPS if name in _skips_of(engine)]
    return (*own, *_edges(scene, engines), _planar(scene, engines), _lazy(engines, registered), _cached())


def _skips_of(engine: Asked) -> frozenset[str]:
    return engine.capabilities.skips


def _decided(name: str, scene: Scene, engine: Asked, options: RunOptions) -> Step:
    """One skip of one engine."""
    if name not in options.skips:
        return Step(name, engine.name, False, "switched off")
    applies, reason = DECISIONS[name](scene, options)
    return Step(name, engine.name, applies, reason)


def limit_of_rest_m_s2(scene: Scene) -> float:
    """Horizontal acceleration, in whatever direction, below which nothing can move while the floor moves horizontally only.

    The least of uplift, g b / h with b the distance of the base's nearest edge (of its two corners when the motion stays in the
    plane), and, on a pedestal, slip, μ_s g (docs/model.md, section 2).
    """
    statue, gravity = scene.statue, scene.gravity_m_s2
    corner = min(statue.corner_left_m, statue.corner_right_m)
    if not isinstance(scene.base_excitation.y, ZeroExcitation):
        corner = min(corner, margin_m(statue.footprint_m))
    uplift = gravity * corner / statue.centroid_height_m
    return min(uplift, _holding_friction(scene) * gravity)


def _holding_friction(scene: Scene) -> float:
    """The least coefficient of static friction between statue and floor."""
    contact = scene.contact
    return contact.statue if scene.pedestal is None else min(contact.floor_static, contact.statue)


def first_motion_s(scene: Scene) -> float:
    """A time before which nothing can move, from the samples' own values (0 when the statue starts off rest).

    A body with a rough base rests on its lowest vertices, which lie nearer than its corners; where its centroid is not above
    them it tilts at once: 0 too.

    For piecewise linear records the time is the last sample before a limit is first exceeded; for formulas it is 0.
    """
    if not scene.initial.still:
        return 0.0
    components = (scene.base_excitation.x, scene.base_excitation.y, scene.base_excitation.z)
    times = _knots(components, scene.duration_s)
    if times is None:
        return 0.0
    polygon = resting_polygon_m(scene.statue)
    if polygon is None:
        return 0.0
    if all(isinstance(item, ZeroExcitation) for item in components):
        return scene.duration_s
    x, y, z = (np.asarray(item.accel_m_s2(times), dtype=np.float64) for item in components)
    over = np.flatnonzero(_leaves_rest(scene, polygon, x, y, scene.gravity_m_s2 - np.abs(z)))
    if over.size == 0:
        return scene.duration_s
    return float(times[max(int(over[0]) - 1, 0)])


def _leaves_rest(
    scene: Scene, polygon_m: Array, x_m_s2: Array, y_m_s2: Array, gravity_m_s2: Array
) -> NDArray[np.bool_]:
    """At which instants the floor's acceleration passes what friction holds or what the base bears under that gravity.

    The base bears it while the weight's line, leant by the acceleration, meets the floor inside the polygon that it rests on.
    A planar body bears at least as much: its ends are the polygon's outermost points.
    """
    weight = np.maximum(gravity_m_s2, 0.0)
    slips = np.hypot(x_m_s2, y_m_s2) >= _holding_friction(scene) * weight
    push = -scene.statue.centroid_height_m * np.stack([x_m_s2, y_m_s2], axis=1)
    normals, reach = outward_sides(polygon_m)
    tips: NDArray[np.bool_] = np.any(push @ normals.T >= reach * weight[:, None], axis=1)
    return slips | tips


def resting_polygon_m(statue: Statue) -> Array | None:
    """The polygon (k, 2), counter-clockwise, of the lowest vertices, which the statue rests on; None where it tilts off it."""
    from meshes import MeshError
    from meshes.footprint import footprint

    feet = statue.footprint_m if statue.solid is None else statue.solid.feet_m
    try:
        polygon = footprint(feet, LEVEL_M)
    except MeshError:  # fewer than three vertices, or all on a line
        return None
    return polygon[:, :2] if margin_m(polygon) > 0.0 else None


def _knots(components: Sequence[Excitation], duration_s: float) -> np.ndarray[Any, np.dtype[np.float64]] | None:
    """All sample times of records, or None when a component is a formula (its extremes lie between knots)."""
    knots = [np.zeros(1)]
    for item in components:
        if isinstance(item, ZeroExcitation):
            continue
        samples = getattr(item, "t_s", None)
        if samples is None:
            return None
        knots.append(np.asarray(samples))
    return np.unique(np.clip(np.concatenate(knots), 0.0, duration_s))


def _quiet_start(scene: Scene, options: RunOptions) -> Decision:
    quiet = first_motion_s(scene)
    if quiet > 0.0:
        return True, f"nothing can move before {quiet:.4g} s"
    return False, "the motion is not quiet at its start, or the statue starts off rest"


def _quiet_end(scene: Scene, options: RunOptions) -> Decision:
    end = scene.base_excitation.end_s
    if end < scene.duration_s:
        return True, f"the floor is still after {end:.4g} s: the run ends once the statue is at rest"
    return False, "the floor moves until the end"


def _energy(scene: Scene, options: RunOptions) -> Decision:
    if options.history:
        return False, "histories are asked"
    end = scene.base_excitation.end_s
    if end < scene.duration_s:
        return True, f"after {end:.4g} s the energy decides the outcome, where the pedestal is shown to hold"
    return False, "the floor moves until the end"


def _base_only(scene: Scene, options: RunOptions) -> Decision:
    from meshes.decomposition import missing

    need = shape_needed(scene)
    if need.shape == "base":
        sentence = "nothing but the base can touch before the statue has overturned"
        return (
            True,
            sentence if scene.wall is None else f"{sentence} but the wall, at vertices of the hull: {need.reason}",
        )
    body = "hull" if need.shape == "hull" else "convex parts"
    sentence = (
        f"the base alone touches until the body can meet the pedestal's edge; from there on its {body}: {need.reason}"
    )
    if need.shape == "parts" and (reason := missing()):
        sentence += f"; but {reason}, so its hull is taken"
    return True, sentence if scene.wall is None else f"{sentence}; the wall is met at vertices of the hull"


def _mirror(scene: Scene, options: RunOptions) -> Decision:
    if scene.table != "frame":
        return False, "the table moves, not the frame"
    reason = asymmetry(scene)
    if reason is not None:
        return False, reason
    whole = "base_only" not in options.skips and scene.pedestal is not None
    sentence = "its bodies turn in the plane alone" if whole else "half of it is computed"
    return True, f"the scene is its own mirror image across the rocking plane: {sentence}"


def _no_history(scene: Scene, options: RunOptions) -> Decision:
    return (False, "histories are asked") if options.history else (True, "only the outcome is asked")


def _stop(scene: Scene, options: RunOptions) -> Decision:
    return True, f"a run ends at |θ| = {OVERTURN_RAD:g} rad"


Decision = tuple[bool, str]
DECISIONS: Final[Mapping[str, Callable[[Scene, RunOptions], Decision]]] = {
    "quiet_start": _quiet_start,
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
    fixed = [engine for engine in engines if engine.capabilities.edge_shape]
    if need.shape != "parts":
        return []
    return [
        Step(
            "base_only",
            engine.name,
            False,
            f"it meets the pedestal's edge with {engine.capabilities.edge_shape} in every scene; {need.reason}",
        )
        for engine in fixed
    ]


def _planar(scene: Scene, engines: Sequence[Asked]) -> Step:
    """Switched by naming a 3D engine."""
    solid = [engine.name for engine in engines if engine.capabilities.dimensions == 3]
    if solid:
        return Step("planar", "*", False, f"{', '.join(solid)} asked: computed in 3D (leave it out with -e)")
    if not scene.planar:
        return Step("planar", "*", False, "the scene is not planar, but no 3D engine is asked (name one with -e)")
    return Step("planar", "*", True, "the scene is planar and no 3D engine is asked (name one with -e)")


def _lazy(engines: Sequence[Asked], registered: Iterable[str]) -> Step:
    """Switched by naming the engine."""
    asked = {engine.name for engine in engines}
    idle = [name for name in registered if name not in asked]
    if not idle:
        return Step("lazy_engines", "*", False, "every engine is asked")
    return Step("lazy_engines", "*", True, f"{', '.join(idle)} not asked (-e): not imported")


def _cached() -> Step:
    """Switched by another folder for the store."""
    return Step(
        "cached", "*", False, "one run is always computed; a study finds what its store has (--out elsewhere: anew)"
    )
