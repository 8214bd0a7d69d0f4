"""What a scene needs and what may be left out, decided before anything runs; printed by `--explain`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from analytic.excitation import Excitation, Rest
from harness.engine import Engine, Want
from harness.scene import OVERTURN_RAD, Scene, Statue

LEVEL_M: Final = 1e-9
"""Feet within this height of each other are level: what is left is rounding."""


@dataclass(frozen=True)
class Step:
    """One decision of the plan: the skip's name, the engine it concerns (`*`: all), whether it applies, and why."""

    skip: str
    engine: str
    applies: bool
    reason: str

    def as_dict(self) -> dict[str, Any]:
        """The decision as plain values."""
        return {"skip": self.skip, "engine": self.engine, "applies": self.applies, "reason": self.reason}

    def __str__(self) -> str:
        return f"{'skip' if self.applies else 'keep'} {self.skip} ({self.engine}): {self.reason}"


def plan(scene: Scene, engines: Sequence[Engine], want: Want) -> tuple[Step, ...]:
    """All decisions for a scene, one for each skip and engine that it concerns."""
    steps = [_quiet_start(scene, want), _quiet_end(scene, want), _energy(scene, want)]
    steps += [_base_only(scene, engine, want) for engine in engines if engine.capabilities.dimensions == 3]
    steps += [
        _step("no_history", want, not want.history, "only the outcome is asked", "histories are asked"),
        _planar(scene, engines, want),
        _step("stop_at_overturn", want, True, f"a run ends at |θ| = {OVERTURN_RAD:g} rad", ""),
    ]
    return tuple(steps)


def _step(skip: str, want: Want, applies: bool, yes: str, no: str, engine: str = "*") -> Step:
    if skip not in want.skips:
        return Step(skip, engine, False, "switched off")
    return Step(skip, engine, applies, yes if applies else no)


def limit_of_rest_m_s2(scene: Scene) -> float:
    """Horizontal acceleration, in whatever direction, below which nothing can move while the floor moves horizontally only.

    The least of uplift, g b / h with b the distance of the base's nearest edge (of its two corners when the motion stays in the
    plane), and, on a pedestal, slip, μ_s g (docs/model.md, section 2).
    """
    statue, gravity = scene.statue, scene.gravity_m_s2
    corner = min(statue.corner_left_m, statue.corner_right_m)
    if not isinstance(scene.shake.y, Rest):
        corner = min(corner, _nearest_edge_m(statue.footprint_m[:, :2]))
    uplift = gravity * corner / statue.centroid_height_m
    slip = scene.contact.statue if scene.pedestal is None else min(scene.contact.floor_static, scene.contact.statue)
    return min(uplift, slip * gravity)


def _nearest_edge_m(polygon_m: np.ndarray[Any, np.dtype[np.float64]]) -> float:
    """Distance from the origin (below the centroid) to the nearest edge of a convex polygon around it."""
    along = np.roll(polygon_m, -1, axis=0) - polygon_m
    across = polygon_m[:, 0] * along[:, 1] - polygon_m[:, 1] * along[:, 0]
    return float(np.min(np.abs(across) / np.hypot(along[:, 0], along[:, 1])))


def first_motion_s(scene: Scene) -> float:
    """A time before which nothing can move, from the samples' own values (0 when the statue starts off rest).

    A body with a rough base tilts at once onto what it rests on, which is narrower than its corners are apart: 0 too.

    For piecewise linear records the time is the last sample before a limit is first exceeded; for formulas it is 0.
    """
    if scene.initial.theta_rad != 0.0 or scene.initial.theta_rate_rad_s != 0.0 or not _level(scene.statue):
        return 0.0
    components = (scene.shake.x, scene.shake.y, scene.shake.z)
    if all(isinstance(item, Rest) for item in components):
        return scene.duration_s
    times = _knots(components, scene.duration_s)
    if times is None:
        return 0.0
    x, y, z = (np.abs(np.asarray(item.accel_m_s2(times), dtype=np.float64)) for item in components)
    # A vertical acceleration lowers every limit in proportion; horizontal motion counts by its magnitude.
    limit = limit_of_rest_m_s2(scene) * np.maximum(1.0 - z / scene.gravity_m_s2, 0.0)
    over = np.flatnonzero(np.hypot(x, y) >= limit)
    if over.size == 0:
        return scene.duration_s
    return float(times[max(int(over[0]) - 1, 0)])


def _level(statue: Statue) -> bool:
    """Whether all that the statue can stand on is at one height."""
    feet = statue.footprint_m if statue.solid is None else statue.solid.feet_m
    return float(np.ptp(feet[:, 2])) <= LEVEL_M


def _knots(components: Sequence[Excitation], duration_s: float) -> np.ndarray[Any, np.dtype[np.float64]] | None:
    """All sample times of records, or None when a component is a formula (its extremes lie between knots)."""
    found = [np.zeros(1)]
    for item in components:
        if isinstance(item, Rest):
            continue
        samples = getattr(item, "t_s", None)
        if samples is None:
            return None
        found.append(np.asarray(samples))
    return np.unique(np.clip(np.concatenate(found), 0.0, duration_s))


def _quiet_start(scene: Scene, want: Want) -> Step:
    quiet = first_motion_s(scene)
    yes = f"nothing can move before {quiet:.4g} s"
    return _step(
        "quiet_start", want, quiet > 0.0, yes, "the motion is not quiet at its start, or the statue starts off rest"
    )


def _quiet_end(scene: Scene, want: Want) -> Step:
    end = scene.shake.end_s
    yes = f"the floor is still after {end:.4g} s: the run ends once the statue is at rest"
    return _step("quiet_end", want, end < scene.duration_s, yes, "the floor moves until the end")


def _energy(scene: Scene, want: Want) -> Step:
    end = scene.shake.end_s
    possible = math.isfinite(end) and end < scene.duration_s and not want.history
    why = "histories are asked" if want.history else "the floor moves until the end"
    yes = f"after {end:.4g} s the energy decides the outcome, where the pedestal is shown to hold"
    return _step("energy_outcome", want, possible, yes, why)


def _base_only(scene: Scene, engine: Engine, want: Want) -> Step:
    yes = "nothing but the base can touch before the statue has overturned"
    if scene.pedestal is not None:
        yes = "the base alone touches until the body can meet the pedestal's edge; from there on the full shape is used"
    if scene.wall is not None:
        yes += "; the wall's contact follows from the silhouette"
    return _step("base_only", want, True, yes, "", engine.name)


def _planar(scene: Scene, engines: Sequence[Engine], want: Want) -> Step:
    solid = [engine.name for engine in engines if engine.capabilities.dimensions == 3]
    asked = bool(solid)
    names = ", ".join(solid)
    return _step(
        "planar",
        want,
        scene.planar and not asked,
        "no 3D engine is asked: the scene is planar",
        f"{names} asked by name: computed in 3D" if asked else "the scene is not planar",
    )
