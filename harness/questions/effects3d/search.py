"""The least amplitude that overturns: looked for on a grid and halved, or followed from a neighbour, under what is changed of
the scene; by the exact model too.
"""

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import Annotated, Any, Final, final

import numpy as np
from pydantic import Field

from analytic.excitation import ZeroExcitation
from harness.accuracy.horizon import amplified
from harness.accuracy.refinement import simulate
from harness.engines.spatial import LEVELS, problem_of
from harness.input.mesh_statue import statue_of
from harness.input.mistakes import UserTable
from harness.model import History, Outcome, Run, RunOptions, Scene, required, translated
from harness.records.effects3d import BASELINE, Amplitude, Departure, Doubt, Group
from harness.statics.plan import limit_of_rest_m_s2
from meshes import MeshError, Solid
from meshes.footprint import reach_m
from meshes.survey import adjusted, ragged

# What is changed of a scene, one thing at a time: components of the motion, base, inertia, survey, friction, time step.

GEOMETRY_REL: Final = 0.03
"""Uncertainty of centroid height, corners and inertia: a few per cent, as surveys of one statue differ."""
FRICTION_REL: Final = 0.10
"""Uncertainty of a friction coefficient of stone on stone."""
RAGGED_M: Final = 1e-3
"""Unevenness given to a flat base: what a photogrammetric scan of a real one shows."""
RAGGED_SPACING_M: Final = 0.05
RAGGED_SEED: Final = 1
FLAT_M: Final = 1e-6
"""A base that is more even than this is flat."""


@dataclass(frozen=True)
class EffectCondition:
    """One thing changed: its group, how the scene is changed, whether planar models see it, and its share of the time step."""

    group: Group
    change: Callable[[Scene], Scene]
    planar: bool = True
    step_share: float = 1.0


def solid_of(scene: Scene) -> Solid:
    """The scene's mesh; raises `InputError` for a statue given by numbers alone."""
    where, advice = str(scene.source or "scene"), "a block given by numbers has no azimuth"
    return required(scene.statue.solid, where, "a mesh", "numbers alone", advice, key="statue.mesh")


def with_solid(scene: Scene, solid: Solid) -> Scene:
    """The same scene with another solid, every number of the statue taken from it."""
    return replace(scene, statue=statue_of(solid))


def turned(scene: Scene, azimuth_deg: float) -> Scene:
    """The scene with the statue turned so that the floor shakes along `azimuth_deg` of the statue's own frame."""
    return with_solid(scene, solid_of(scene).rotated(-azimuth_deg))


def _along(scene: Scene, axes: str) -> Scene:
    """The scene shaken along these axes only."""
    return replace(
        scene,
        base_excitation=replace(
            scene.base_excitation, **{axis: ZeroExcitation() for axis in "xyz" if axis not in axes}
        ),
    )


def _adjusted(scene: Scene, **shares: Any) -> Scene:
    return with_solid(_along(scene, "x"), adjusted(solid_of(scene), **shares))


def _ragged(scene: Scene) -> Scene:
    rough = ragged(solid_of(scene), RAGGED_M, spacing_m=RAGGED_SPACING_M, seed=RAGGED_SEED)
    return with_solid(_along(scene, "x"), rough)


def _rougher(scene: Scene, relative: float) -> Scene:
    contact = replace(scene.contact, statue=(1.0 + relative) * scene.contact.statue)
    return replace(_along(scene, "x"), contact=contact)


CONDITIONS: Final[Mapping[str, EffectCondition]] = {
    BASELINE: EffectCondition("baseline", lambda scene: _along(scene, "x")),
    "with the vertical component": EffectCondition("components", lambda scene: _along(scene, "xz")),
    "with the second horizontal component": EffectCondition(
        "components", lambda scene: _along(scene, "xy"), planar=False
    ),
    "with all three components": EffectCondition("components", lambda scene: scene, planar=False),
    "base ragged by 1 mm": EffectCondition("base", _ragged),
    "base planed flat": EffectCondition("base", partial(_adjusted, flat_base=True)),
    "products of inertia left out": EffectCondition("inertia", partial(_adjusted, products=False), planar=False),
    "centroid 3 % higher": EffectCondition("uncertainty", partial(_adjusted, centroid_rel=GEOMETRY_REL)),
    "centroid 3 % lower": EffectCondition("uncertainty", partial(_adjusted, centroid_rel=-GEOMETRY_REL)),
    "base 3 % wider": EffectCondition("uncertainty", partial(_adjusted, base_rel=GEOMETRY_REL)),
    "base 3 % narrower": EffectCondition("uncertainty", partial(_adjusted, base_rel=-GEOMETRY_REL)),
    "inertia 3 % larger": EffectCondition("uncertainty", partial(_adjusted, inertia_rel=GEOMETRY_REL)),
    "inertia 3 % smaller": EffectCondition("uncertainty", partial(_adjusted, inertia_rel=-GEOMETRY_REL)),
    "friction 10 % larger": EffectCondition("uncertainty", partial(_rougher, relative=FRICTION_REL), planar=False),
    "friction 10 % smaller": EffectCondition("uncertainty", partial(_rougher, relative=-FRICTION_REL), planar=False),
    "half the time step": EffectCondition("numerical", lambda scene: _along(scene, "x"), planar=False, step_share=0.5),
}
"""Every condition by name, the baseline first. `planar` says that the planar models see the change."""


def changed_scene(scene: Scene, condition: str, azimuth_deg: float) -> Scene:
    """The scene under one of `CONDITIONS` with the statue turned. Raises `InputError` where the changed statue does not stand."""
    with translated(MeshError, str(scene.source or "scene"), "a statue that stands", key="statue"):
        return turned(CONDITIONS[condition].change(scene), azimuth_deg)


def without_meaning(scene: Scene) -> dict[str, str]:
    """The conditions that change nothing of this scene, each with the code of its reason."""
    y, z = (isinstance(item, ZeroExcitation) for item in (scene.base_excitation.y, scene.base_excitation.z))
    flat = float(np.ptp(solid_of(scene).feet_m[:, 2])) < FLAT_M
    reasons = {
        "with the vertical component": "motion_has_none" if z else "",
        "with the second horizontal component": "motion_has_none" if y else "",
        "with all three components": "motion_has_fewer" if y or z else "",
        "base planed flat": "base_flat" if flat else "",
        "base ragged by 1 mm": "" if flat else "base_uneven",
    }
    return {name: why for name, why in reasons.items() if why}


# How far a run in three dimensions leaves the plane of shaking: tilt, yaw, way, and whether it rocks on an edge or a corner.

UPRIGHT_RAD: Final = 1.0
"""Beyond this tilt the statue is falling: its yaw and its way say nothing of rocking."""
ROCKING_RAD: Final = 2e-3
"""A smaller lean is no rocking: it is what an uneven base and the contact's give amount to."""
EDGE_M: Final = 5e-4
"""Another foot as near to the lowest as this shares the load: the statue turns about an edge, not about one corner."""
APART_SHARE: Final = 0.1
"""Feet nearer to each other than this share of the base are one corner."""


def departure(scene: Scene, azimuth_deg: float, engine: str, floor_g: float, dt_s: float) -> Departure:
    """How far a 3D engine's statue leaves the plane when shaken along that azimuth alone with that peak. Raises `InputError`."""
    turned = changed_scene(scene, BASELINE, azimuth_deg)
    shaken = amplified(turned, floor_g / peak_g(turned))
    run = run_once(shaken, engine, dt_s, history=True)
    said = run.message or run.outcome.value
    history = required(run.history, engine, "a run with a history", said, key="history")
    extra, theta = history.extra, history.theta_rad
    standing = np.hypot(theta, extra["out_of_plane_rad"]) < UPRIGHT_RAD
    until = len(theta) if standing.all() else int(np.argmin(standing))
    yaw, across = (extra[name][:until] - extra[name][0] for name in ("yaw_rad", "statue_y_m"))
    return Departure(
        azimuth_deg=float(azimuth_deg),
        engine=engine,
        peak_g=floor_g,
        outcome=run.outcome,
        peak_theta_rad=float(np.abs(theta[:until]).max()),
        out_of_plane_rad=float(np.abs(extra["out_of_plane_rad"][:until]).max()),
        yaw_rad=float(np.abs(yaw).max()),
        across_m=float(np.abs(across).max()),
        yaw_left_rad=float(yaw[-1]),
        walked_m=float(math.hypot(across[-1], extra["statue_slip_m"][until - 1])),
        corner_share=corner_share(shaken, history, until),
    )


def corner_share(scene: Scene, history: History, until: int) -> float:
    """Share of the rocking time (lean above 2 mrad) in which a single corner carries the statue; 0 when it never rocks."""
    feet = solid_of(scene).feet_m - np.array([0.0, 0.0, scene.statue.centroid_height_m])
    roll, pitch = (history.extra[name][:until] for name in ("roll_rad", "pitch_rad"))
    # The last row of the rotation: each body axis's share of the vertical.
    up = np.column_stack([-np.sin(pitch), np.cos(pitch) * np.sin(roll), np.cos(pitch) * np.cos(roll)])
    heights = up @ feet.T
    rocking = np.arccos(np.clip(up[:, 2], -1.0, 1.0)) > ROCKING_RAD
    if not rocking.any():
        return 0.0
    lowest = np.argmin(heights, axis=1)
    spans = np.linalg.norm(feet[:, None, :2] - feet[None, :, :2], axis=2)
    elsewhere = spans[lowest] > APART_SHARE * spans.max()
    above = np.where(elsewhere, heights - heights.min(axis=1)[:, None], np.inf).min(axis=1)
    return float(np.mean(above[rocking] > EDGE_M))


EXACT: Final = "spatial"
SECOND_TOLERANCE: Final = LEVELS[1][0]
"""A thousandth of the local error at which outcomes are asked (`analytic.spatial.solver.OUTCOME_TOLERANCE`)."""
MOST_STEPS: Final = 50_000
"""A run of more is given up, and told: rocking takes some hundreds of steps, a slide that creeps a million."""
STEPS: Final[Mapping[str, float]] = {"analytic": 1.01, EXACT: 1.01, "pymunk": 1.03, "pybullet": 1.04}
"""Ratio of the grid's neighbouring amplitudes for each engine: finer where a run costs less."""
BEGIN_SHARE: Final = 0.95
"""The grid begins at this share of the amplitude below which nothing can move."""


class Search(UserTable):
    """`[search]`: peaks of the floor up to `most_g` are tried, to `resolution` (relative), at contact engines' steps of `dt_s`.

    Overturning is not monotonic in amplitude: what is found is the least of a grid that overturns, bracketed below.
    """

    most_g: Annotated[float, Field(gt=0.0, le=5.0)] = 1.2
    resolution: Annotated[float, Field(ge=1e-4, le=0.1)] = 0.002
    dt_s: Annotated[float, Field(ge=1e-5, le=1e-2)] = 1e-3

    def key(self) -> list[object]:
        """What of it names a result."""
        return [self.most_g, self.resolution, self.dt_s, dict(STEPS)]


Outcomes = Callable[[float], Outcome | None]
"""How the statue overturns at a factor on the motion, None where it does not: remembered, as it is asked again."""
Crossing = tuple[float | None, float]
"""The factor that overturns (None: none up to the most tried), and the largest tried below it that stands, or 0."""


def first_crossing(outcome: Outcomes, rising: Iterable[float], resolution: float) -> Crossing:
    """The least of these factors that overturns, brought to the resolution of the one before it, which stands."""
    below = 0.0
    for above in rising:
        if outcome(above) is None:
            below = above
            continue
        while below > 0.0 and above / below > 1.0 + resolution:
            middle = math.sqrt(above * below)
            above, below = (above, middle) if outcome(middle) is None else (middle, below)
        return above, below
    return None, below


UNEVEN_SHARE: Final = 0.1
"""Of the factor from which a statue lifts off a flat base: at less no fall of one on an uneven base is looked for."""


def nearest_crossing(outcome: Outcomes, near: float, least: float, most: float, resolution: float) -> Crossing:
    """The crossing next to `near`, by strides that double away from it; between `least` and `most`."""
    stride, tried = 1.0 + 4.0 * resolution, [near]
    falls = outcome(near) is not None
    while tried[-1] > least if falls else tried[-1] < most:
        tried.append(max(tried[-1] / stride, least) if falls else min(tried[-1] * stride, most))
        stride *= stride
        if (outcome(tried[-1]) is None) == falls:
            break
    return first_crossing(outcome, sorted(tried), resolution)


def run_once(scene: Scene, engine: str, dt_s: float, *, history: bool = False) -> Run:
    """One run; contact engines at the given step, the analytic model at its default accuracy."""
    options = RunOptions(history=history)
    return simulate(scene, engine, dt_s=None if engine == "analytic" else dt_s, options=options)


def peak_g(scene: Scene) -> float:
    """Peak of the floor's acceleration along x as a share of gravity."""
    return scene.base_excitation.x.peak_m_s2 / scene.gravity_m_s2


def start_factor(scene: Scene) -> float:
    """Factor on the motion below which nothing moves in any model.

    A level push along x lifts a rigid body once h a/g leaves the footprint in that direction; it slips at μ g.
    """
    solid = solid_of(scene)
    reach = float(np.min(reach_m(solid.footprint_m, [0.0, 180.0])))
    limit = min(limit_of_rest_m_s2(scene), scene.gravity_m_s2 * reach / solid.centroid_height_m)
    vertical = scene.base_excitation.z.peak_m_s2 / scene.base_excitation.x.peak_m_s2
    across = math.hypot(1.0, scene.base_excitation.y.peak_m_s2 / scene.base_excitation.x.peak_m_s2)
    # A vertical peak taken off gravity: limit (1 − f z/g) = f x.
    factor = limit / (across * scene.base_excitation.x.peak_m_s2)
    return BEGIN_SHARE * factor / (1.0 + factor * vertical * scene.base_excitation.x.peak_m_s2 / scene.gravity_m_s2)


def find(
    scene: Scene, condition: str, azimuth_deg: float, engine: str, search: Search, near_g: float | None = None
) -> Amplitude:
    """The least overturning amplitude; with `near_g`, as every condition of a study has it, the next one. Raises `InputError`."""
    changed = changed_scene(scene, condition, azimuth_deg)
    unit, dt_s = peak_g(changed), search.dt_s * CONDITIONS[condition].step_share
    space = SpaceOutcomes(changed) if engine == EXACT else None

    @cache
    def outcome_at(factor: float) -> Outcome | None:
        if space is not None:
            return space.overturning(factor)
        outcome = run_once(amplified(changed, factor), engine, dt_s).outcome
        return outcome if outcome.overturned else None

    least, most = min(start_factor(changed), search.most_g / unit), search.most_g / unit
    if near_g is None:
        count = max(math.ceil(math.log(most / least) / math.log(STEPS.get(engine, max(STEPS.values())))), 1)
        above, below = first_crossing(outcome_at, np.geomspace(least, most, count + 1).tolist(), search.resolution)
    else:
        # On an uneven base it rocks, and may fall, before a flat one would lift.
        above, below = nearest_crossing(outcome_at, near_g / unit, UNEVEN_SHARE * least, most, search.resolution)
    doubt: Doubt = "" if space is None else space.doubt(above, below)
    outcome, peak = (None, None) if above is None else (outcome_at(above), above * unit)
    runs = outcome_at.cache_info().currsize
    return Amplitude(condition, float(azimuth_deg), engine, peak, below * unit, outcome or "", runs, doubt)


@final
class SpaceOutcomes:
    """Asks the exact model for outcomes, and remembers the factors at which it gave none."""

    def __init__(self, scene: Scene) -> None:
        self._scene, self._problem = scene, problem_of(scene)
        self.unanswered: list[float] = []

    def overturning(self, factor: float, tolerance: float = LEVELS[0][0]) -> Outcome | None:
        """How the scene with its motion scaled by a factor overturns, None when it does not."""
        from analytic import spatial

        run = spatial.outcomes(
            self._problem, {"scale": [factor]}, tolerance=tolerance, threads=1, most_steps=MOST_STEPS
        )
        if not run.overturned[0]:
            alone = Outcome(run.outcomes[0])
            if alone is not Outcome.STANDS and run.steps[0] < MOST_STEPS:
                # Of one that still leans at its end a single run says whether it can come back.
                options = RunOptions(history=False)
                alone = simulate(amplified(self._scene, factor), EXACT, options=options).outcome
            if alone.fell is None:
                self.unanswered.append(factor)
            return alone if alone.overturned else None
        x, y, _ = run.axis[0]
        if abs(y) > abs(x):
            return Outcome.OVERTURNED_BACK if y > 0.0 else Outcome.OVERTURNED_FRONT
        return Outcome.OVERTURNED_RIGHT if x > 0.0 else Outcome.OVERTURNED_LEFT

    def doubt(self, above: float | None, below: float) -> Doubt:
        """Why an amplitude between `below` (stands) and `above` (overturns) is in doubt; empty where it is not."""
        if self.unanswered:
            return "undecided"
        again = (above is None or self.overturning(above, SECOND_TOLERANCE) is not None) and (
            below == 0.0 or self.overturning(below, SECOND_TOLERANCE) is None
        )
        return "" if again and not self.unanswered else "change"
