"""What the third dimension changes: overturning amplitude by direction in 3D beside the planar models, and what moves it.

Azimuths are directions in the statue's own frame, counter-clockwise from x seen from above: the direction along which the
floor shakes. The statue is turned, not the floor: shaking stays along x, so every planar model sees its own section.
"""

import math
import shlex
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from itertools import product
from pathlib import Path
from typing import Annotated, Any, Final, Literal, Self, TypeVar, final

import numpy as np
from pydantic import Field, model_validator

from analytic.excitation import ZeroExcitation
from harness.accuracy.horizon import amplified
from harness.accuracy.refinement import simulate
from harness.engines.spatial import LEVELS, problem_of
from harness.input.mesh_statue import statue_of
from harness.input.mistakes import UserTable, agree
from harness.input.tables import read_model
from harness.model import (
    Answer,
    Finding,
    History,
    Outcome,
    Run,
    RunOptions,
    Say,
    Scene,
    caution,
    changes_answer,
    grouped,
    info,
    keywords,
    machine,
    require,
    required,
    scan_azimuth_deg,
    to_plain,
    translated,
    versions,
    written,
)
from harness.questions.scene.scene_run import run_scene, write_result
from harness.questions.study.cases import BaseScene, EngineName, base_of_scene
from harness.records.base import check_folder, part, write_whole
from harness.records.effects3d import (
    BASELINE,
    SOLID,
    Amplitude,
    AmplitudeChange,
    AskedRecord,
    Band,
    Departure,
    Doubt,
    Effect,
    EffectsRecord,
    EffectsSummary,
    Group,
    ReplayRecord,
    StaticLimit,
)
from harness.records.scene import SceneRecord
from harness.runs.execute import Campaign, OnProgress, silent
from harness.runs.runner import Pool
from harness.runs.store import STORE_NAME, Store, check_begun
from harness.runs.task import Task, TaskResult, request_key
from harness.statics.plan import limit_of_rest_m_s2
from harness.statics.standstill import motion_sized
from meshes import MeshError, Solid, footprint
from meshes.footprint import reach_m
from meshes.orientation import turn_axis
from meshes.solid import turn_about_z
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
    history = required(run.history, engine, "a run with a history", run.message or run.outcome.value, key="history")
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


# The least amplitude that overturns: looked for on a grid and halved, or followed from a neighbour; by the exact model too.

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


# The whole study: every search a task of its own, one record at the end.

REFUSES: Final = dict.fromkeys(
    ("--export", "--witness"), "a study of cases: all of one of the third dimension stands in its result.json"
)
KIND = "effects3d"


class EffectsFile(UserTable):
    """A whole file of `kind = "effects3d"`.

    Directions are `directions` equal parts of the circle; conditions are asked at every `every`-th of them. `samples` statues
    with errors in h, b and J are drawn at each of those for the band around the planar model.
    """

    kind: Literal["effects3d"]
    title: Annotated[str, Field(min_length=1)]
    scene: Annotated[str, Field(min_length=1)]
    directions: Annotated[int, Field(ge=4, le=360)] = 24
    every: Annotated[int, Field(ge=1, le=90)] = 2
    engines: Annotated[list[EngineName], Field(min_length=1)]
    conditions: list[str] = Field(default_factory=lambda: [name for name in CONDITIONS if name != BASELINE])
    samples: Annotated[int, Field(ge=0, le=10_000)] = 200
    share: Annotated[float, Field(gt=0.0, lt=1.0)] = 0.95
    seed: Annotated[int, Field(ge=0)] = 0
    search: Search = Search()

    @model_validator(mode="after")
    def _whole(self) -> Self:
        known, engines = [name for name in CONDITIONS if name != BASELINE], ", ".join(self.engines)
        unknown = next((name for name in self.conditions if name not in known), None)
        solid, once = any(name in SOLID for name in self.engines), len(set(self.engines)) == len(self.engines)
        divides = self.directions % self.every == 0
        agree(
            (unknown is None, "conditions", f"names out of {', '.join(known)}", repr(unknown)),
            (solid, "engines", f"one that computes in 3D ({' or '.join(SOLID)})", engines),
            (once, "engines", "each engine once", engines),
            (divides, "every", f"a divisor of directions = {self.directions}", str(self.every)),
        )
        return self

    def azimuths_deg(self, every: int = 1) -> list[float]:
        """The directions, or every n-th of them."""
        return [360.0 * k / self.directions for k in range(0, self.directions, every)]


# What the rows of an effects study say together: the planar model asked at the base's sides, and each condition's effect.

GRAZING_COS: Final = 0.05
"""A side that the shaking meets more obliquely than this (87°) is not tipped by it."""


def scan_directions(scene: Scene) -> Finding:
    """Where the study's 0° and 90° point on the scan as its file has it, before it was set upright and turned."""
    file, up = (written(scene, "statue", "mesh", key) for key in ("file", "up"))
    back = turn_axis(str(up or "z")).T @ turn_about_z(scan_azimuth_deg(scene)).T
    first, second = ((column.round(12) + 0.0).tolist() for column in (back[:, 0], back[:, 1]))
    return info("scan_directions", file=str(file), along_0=first, along_90=second)


def static_rose(scene: Scene, azimuths_deg: Sequence[float], sides: Sequence[Amplitude]) -> list[StaticLimit]:
    """By direction: peaks, g, at which a level push lifts the statue in 3D and in the plane, and the sides' planar answer.

    `projected_g` is the least over the base's sides of the planar model's amplitude at the side divided by the cosine between
    shaking and the side's direction: the share of the shaking that turns the statue about that side.
    """
    solid = solid_of(scene)
    back = [azimuth + 180.0 for azimuth in azimuths_deg]
    # The floor shakes both ways along a direction.
    reach, corner = (
        np.minimum(of(solid.footprint_m, azimuths_deg), of(solid.footprint_m, back)) / solid.centroid_height_m
        for of in (footprint.reach_m, footprint.corner_m)
    )
    limits = zip(azimuths_deg, reach.tolist(), corner.tolist(), strict=True)
    return [StaticLimit(azimuth, lifts, planar, *_projected(azimuth, sides)) for azimuth, lifts, planar in limits]


def _projected(azimuth_deg: float, sides: Sequence[Amplitude]) -> tuple[float | None, float | None]:
    amplitudes = [
        (row.peak_g / share, row.azimuth_deg)
        for row in sides
        for share in [math.cos(math.radians(azimuth_deg - row.azimuth_deg))]
        if row.peak_g is not None and share > GRAZING_COS
    ]
    return min(amplitudes, default=(None, None))


def effects(rows: Sequence[Amplitude], conditions: Sequence[str]) -> list[Effect]:
    """For every engine and condition how much the overturning amplitude changes: by direction, median, least and largest."""
    base = {(row.engine, row.azimuth_deg): row.peak_g for row in rows if row.condition == BASELINE}
    asked = grouped(((row.engine, row.condition), row) for row in rows)
    found = []
    every = product(dict.fromkeys(row.engine for row in rows), conditions)
    for (engine, condition), mine in [(each, asked[each]) for each in every if each in asked]:
        changes = [
            AmplitudeChange(row.azimuth_deg, row.peak_g / unchanged - 1.0)
            for row in mine
            for unchanged in [base[engine, row.azimuth_deg]]
            if row.peak_g is not None and unchanged is not None
        ]
        values = [item.relative for item in changes]
        median = float(np.median(values)) if values else None
        least, largest = min(values, default=None), max(values, default=None)
        flips = sum(row.peak_g is None for row in mine)
        found.append(Effect(engine, condition, CONDITIONS[condition].group, changes, median, least, largest, flips))
    return found


# One case of an effects study run with histories, to be watched: where 3D leaves the plane most.

PLANAR: Final = "analytic"


def write_replay(
    scene: Scene, rows: Sequence[Amplitude], departures: Sequence[Departure], dt_s: float, folder: Path
) -> ReplayRecord | None:
    """Run the direction whose motion turns most about the vertical, at its overturning amplitude, into `folder`; say what it is.

    By a contact engine where one was asked: there the exact model may slide for a million steps. None when no engine
    overturned the statue in any direction whose motion was followed.
    """
    yaw_rad = {row.azimuth_deg: abs(row.yaw_rad) for row in departures}
    overturned = [row for row in rows if row.condition == BASELINE and row.peak_g and row.azimuth_deg in yaw_rad]
    chosen = max(
        (row for row in overturned if row.engine in SOLID),
        key=lambda row: (row.engine != EXACT, yaw_rad[row.azimuth_deg]),
        default=None,
    )
    if chosen is None or chosen.peak_g is None:
        return None
    engine, azimuth, peak = chosen.engine, chosen.azimuth_deg, chosen.peak_g
    turned = changed_scene(scene, BASELINE, azimuth)
    shaken = amplified(turned, peak / peak_g(turned))
    shaken = replace(shaken, title=f"{scene.title}, shaken towards {azimuth:g}° with {peak:.3g} g")
    result = run_scene(shaken, [PLANAR, engine], dt_s=dt_s)
    write_result(result, folder)
    outcomes = {name: run.outcome for name, run in result.runs.items()}
    return ReplayRecord(azimuth, engine, peak, outcomes, folder.name, _command(scene, azimuth, peak, engine, dt_s))


def _command(scene: Scene, azimuth_deg: float, peak: float, engine: str, dt_s: float) -> str:
    """The command that runs the same case by itself; empty where the motion has no single key for its size."""
    sized = motion_sized(scene, peak / peak_g(scene))
    if not sized or scene.source is None:
        return ""
    turn = scan_azimuth_deg(scene) - azimuth_deg
    still = "".join(f" --set motion.{axis}=none" for axis in "yz" if written(scene, "motion", axis) is not None)
    return (
        f"rockcheck run {shlex.quote(scene.source.name)} -e {PLANAR} -e {engine} --dt {dt_s:g}"
        f" --set statue.mesh.azimuth_deg={turn:g}"
        f" --set {sized}{still}"
    )


# The planar model's overturning amplitude of many statues that differ by a survey's errors: the band around a rose.

SIGMAS: Final = 2.0
"""The stated uncertainty of a length or an inertia is this many standard deviations."""


def band(scene: Scene, azimuth_deg: float, search: Search, samples: int, seed: int) -> Band:
    """The band at one azimuth; h, each corner and J drawn independently, normal, two standard deviations being 3 %.

    Every statue has two corners (a ragged base counts as its outer ones). Raises `InputError`.
    """
    from analytic import Block, ensemble

    changed = changed_scene(scene, BASELINE, azimuth_deg)
    statue, unit = changed.statue, peak_g(changed)
    block = Block.two_corners(
        mass_kg=statue.mass_kg,
        centroid_height_m=statue.centroid_height_m,
        inertia_kg_m2=statue.inertia_kg_m2,
        corner_left_m=statue.corner_left_m,
        corner_right_m=statue.corner_right_m,
    )
    draws = 1.0 + GEOMETRY_REL / SIGMAS * np.random.default_rng([seed, round(azimuth_deg)]).standard_normal(
        (4, samples, 1)
    )
    least, most = min(start_factor(changed), 0.5 * search.most_g / unit), search.most_g / unit
    count = math.ceil(math.log(most / least) / math.log(STEPS["analytic"]))
    factors = np.geomspace(least, most, count + 1)
    given: dict[str, Any] = {name: value for name, value in keywords(changed).items() if name not in UNUSED}
    drawn = ensemble(
        block,
        changed.base_excitation.x,
        sweep={
            "scale": factors[None, :],
            "centroid_height_m": statue.centroid_height_m * draws[0],
            "corner_left_m": statue.corner_left_m * draws[1],
            "corner_right_m": statue.corner_right_m * draws[2],
            "inertia_kg_m2": statue.inertia_kg_m2 * draws[3],
        },
        threads=1,
        **given,
    )
    falls = drawn.overturned.any(axis=1)
    first = np.where(falls, factors[np.argmax(drawn.overturned, axis=1)] * unit, np.inf)
    low, middle, high = (
        None if math.isinf(value) else value
        for value in (float(np.quantile(first, q, method="inverted_cdf")) for q in (0.05, 0.5, 0.95))
    )
    return Band(float(azimuth_deg), low, middle, high, float(np.mean(~falls)), int(drawn.steps.size))


UNUSED: Final = frozenset({"statue_friction", "pedestal", "wall"})
"""Keywords that an effects scene leaves at rest: the statue stands on the floor."""


ORDER: Final = (*SOLID, "pymunk", "pymunk:plain", "analytic")
"""Longest first keeps both ends of a pool busy."""
LONG_SIDE: Final = 0.05
"""Sides of the footprint shorter than this share of its outline are the bend of one corner."""

REPLAY: Final = "replay"
"""The folder of the case that is run to be watched, in the result's."""
WORK: Final[dict[type, tuple[str, Callable[..., object]]]] = {
    Amplitude: ("search", find),
    Band: ("band", band),
    Departure: ("departure", departure),
}
"""What an answer of each class is called in a store, and what finds it."""
T = TypeVar("T", Amplitude, Band, Departure)


def answer(question: tuple[type, BaseScene, tuple[Any, ...]]) -> TaskResult:
    """What a worker does for the answer of a class, from its scene and arguments; its cost is the processor time, s, it took."""
    begin = time.process_time()
    kind, base, arguments = question
    name, work = WORK[kind]
    plain = to_plain(work(base.scene({}), *arguments))
    return TaskResult(name, plain, time.process_time() - begin)


def asked(
    base: BaseScene, campaign: Campaign, where: Path, kind: type[T], questions: Iterable[tuple[Any, ...]]
) -> list[T]:
    """The answers in the questions' order, those that the store `where` lacks found now; one whose process died is left out."""
    (name, _), scene = WORK[kind], base.scene({})
    named = [(each, [item.key() if isinstance(item, Search) else item for item in each]) for each in questions]
    tasks = [Task(request_key(scene, None, name, words), answer, (kind, base, each)) for each, words in named]
    return [part(kind, item, where) for item in campaign.ask(tasks) if item is not None]


def run_file(
    path: Path,
    folder: Path,
    pool: Pool,
    on_progress: OnProgress = silent,
    *,
    resume: bool = False,
    say: Say = lambda finding: "",
) -> EffectsRecord:
    """Run an effects study into `folder` (result.json, store.sqlite, replay/); returns its record.

    Raises `InputError` for a wrong file or scene, or `resume` where nothing was begun.
    """
    start = time.perf_counter()
    study = read_model(EffectsFile, path)
    if resume:
        check_begun(folder, "a study")
    check_folder(folder / REPLAY, ("run",))
    base = base_of_scene(path.parent / study.scene)
    scene = base.scene({})
    solid_of(scene)
    require(scene.base_excitation.x.peak_m_s2 > 0.0, str(path), "a motion along x", "none", key="motion.x")
    wanted = "a statue on the floor: pedestal and wall have a direction of their own"
    require(scene.pedestal is None and scene.wall is None, str(path), wanted, "a pedestal or a wall", key="scene")
    with Store(folder / STORE_NAME, "effects3d") as store:
        done = Campaign(store, pool, on_progress)
        answers = answers_of(study, scene, partial(asked, base, done, store.path))
        # A direction across a side may be one of the rose's, and is then one search.
        searched = {*answers["rows"], *answers["sides"], *answers["bands"]}
        runs = sum(each.runs for each in searched) + len(answers["departures"])
        counts = done.computed + len(done.reused), len(done.reused), runs, done.failed, done.asked_s
    finished = EffectsRecord(
        title=study.title,
        file=path.name,
        **answers,
        scene=SceneRecord.of(scene),
        findings=[scan_directions(scene), *scene.findings],
        study=part(AskedRecord, study.model_dump(), path),
        unit_g=peak_g(scene),
        replay=write_replay(scene, answers["rows"], answers["departures"], study.search.dt_s, folder / REPLAY),
        summary=EffectsSummary(study.directions, *counts),
        versions=versions(),
        machine=machine(),
        seconds=time.perf_counter() - start,
    )
    finished = replace(finished, answer=answer_of(finished), findings=[*findings_of(finished), *finished.findings])
    return write_whole(folder, finished.texted(say))


def answers_of(study: EffectsFile, scene: Scene, ask: Callable[..., list[Any]]) -> dict[str, Any]:
    """All rows of the record: the roses first, then what follows each of them; `ask(kind, questions)` gives the answers."""
    search = study.search
    engines = sorted(study.engines, key=ORDER.index)
    first = [name for name in engines if name in (EXACT, PLANAR)] if EXACT in engines else engines
    rows: list[Amplitude] = ask(
        Amplitude, [(BASELINE, a, name, search) for name in first for a in study.azimuths_deg()]
    )
    others = [name for name in engines if name not in first]
    rows += ask(Amplitude, [(BASELINE, a, name, search) for name in others for a in checked_azimuths(rows)])
    projected = ask(Amplitude, [(BASELINE, a, PLANAR, search) for a in side_azimuths(scene)])
    near = {(row.engine, row.azimuth_deg): row.peak_g for row in rows}
    empty = without_meaning(scene)
    wanted = [name for name in study.conditions if name not in empty]
    if EXACT in engines:
        empty |= {name: "own_steps" for name in wanted if CONDITIONS[name].group == "numerical"}
        wanted = [name for name in wanted if name not in empty]
    # 3D engines are asked under every condition, the analytic model under those that it sees.
    changing = [
        (condition, azimuth, name, search, peak)
        for name in first
        for condition in wanted
        if name in SOLID or (name == PLANAR and CONDITIONS[condition].planar)
        for azimuth in study.azimuths_deg(study.every)
        if (peak := near.get((name, azimuth))) is not None
    ]
    changed = ask(Amplitude, changing)
    bands = [(a, search, study.samples, study.seed) for a in study.azimuths_deg(study.every)] if study.samples else []
    leaving = [
        (a, name, study.share * peak, search.dt_s)
        for name in first
        if name in SOLID
        for a in study.azimuths_deg()
        if (peak := near.get((name, a))) is not None
    ]
    everything = [*rows, *changed]
    return {
        "rows": everything,
        "sides": projected,
        "static": static_rose(scene, study.azimuths_deg(), projected),
        "bands": ask(Band, bands),
        "departures": ask(Departure, leaving),
        "effects": effects(everything, wanted),
        "left_out": empty,
    }


def checked_azimuths(rows: Sequence[Amplitude]) -> list[float]:
    """Where other engines are asked beside the exact model: where it doubts its answer, and where the plane errs most."""
    exact = {row.azimuth_deg: row for row in rows if row.engine == EXACT}
    doubtful = {azimuth for azimuth, row in exact.items() if row.doubt}
    errors = {
        row.azimuth_deg: (row.peak_g or row.stands_at_g) / peak
        for row in rows
        if row.engine == PLANAR and row.azimuth_deg in exact
        for peak in [exact[row.azimuth_deg].peak_g]
        if peak is not None
    }
    return sorted(doubtful | {max(errors, key=lambda azimuth: errors[azimuth])} if errors else doubtful)


def side_azimuths(scene: Scene) -> list[float]:
    """Directions across the long sides of the footprint, both ways: where a planar model at a side is asked."""
    lengths, towards = footprint.sides(solid_of(scene).footprint_m)
    azimuths = {round(float(a), 6) for a in towards[lengths > LONG_SIDE * lengths.sum()]}
    return sorted(azimuths | {round((a + 180.0) % 360.0, 6) for a in azimuths})


# What an effects study says: the planar model against the solid one by direction, and each effect beside a survey's errors.

NEAR: Final = 0.05
"""Amplitudes within this share of each other count as the same: a survey's errors move them as much."""
LEAVES_RAD: Final = 1e-3
"""A statue that leaves the plane of shaking by more is said to."""
UNKNOWN: Final = (0.05, 0.95)
"""Quantiles between which the changes by a survey's errors are told."""

Peaks = Mapping[float, float]


def answer_of(record: EffectsRecord) -> Answer:
    """At how many directions the planar model is too safe, by how much at most, and the least peak that overturns."""
    solid, planar = (_peaks(record, name) for name in (record.solid_engine, "analytic"))
    found = [*_planar(record, solid, planar)] if planar else [changes_answer("plane_not_asked")]
    for name, peaks in ((record.solid_engine, solid), ("analytic", planar)):
        least_g = min(peaks.values(), default=math.inf)
        if math.isfinite(least_g):
            azimuth_deg = next(a for a, peak in peaks.items() if peak == least_g)
            found.append(info("least_peak", model=name, peak_g=least_g, azimuth_deg=azimuth_deg))
    return Answer(found[0].code, [*found, info("effects_done", **vars(record.summary))])


def findings_of(record: EffectsRecord) -> list[Finding]:
    """All that is to be known beside the headline."""
    return [*_solid_pairs(record), *_effects(record), *_leaving(record)]


def _peaks(record: EffectsRecord, engine: str) -> dict[float, float]:
    """Overturning peak by direction of one engine, infinite where it does not overturn up to the most tried."""
    return {
        row.azimuth_deg: math.inf if row.peak_g is None else row.peak_g for row in record.amplitudes(engine, BASELINE)
    }


def _planar(record: EffectsRecord, solid: Peaks, planar: Peaks) -> Iterator[Finding]:
    over = [a for a in solid if math.isfinite(solid[a]) and planar[a] > (1.0 + NEAR) * solid[a]]
    sides = [row for row in record.static if math.isfinite(solid.get(row.azimuth_deg, math.inf))]
    apart = {row: abs(row.projected_g / solid[row.azimuth_deg] - 1.0) for row in sides if row.projected_g is not None}
    values: dict[str, Any] = {"over": len(over), "directions": len(solid), "near": NEAR, "model": record.solid_engine}
    yield changes_answer("plane_unsafe", **values) if over else info("plane_safe", **values)
    fall_over = {row.azimuth_deg: [row.side_deg] for row, share in apart.items() if share <= NEAR}
    if apart:
        median = float(np.median([*apart.values()]))
        yield info("plane_by_sides", median=median, directions=len(apart), within=len(fall_over), near=NEAR)
    if over:
        most_g = record.study.search.most_g
        worst = max(over, key=lambda a: min(planar[a], most_g) / solid[a])
        never = sum(math.isinf(planar[a]) for a in over)
        values = {"azimuth_deg": worst, "solid_g": solid[worst], "never": never, "sides_deg": fall_over.get(worst, [])}
        bounded = math.isfinite(planar[worst])
        yield info(
            "plane_worst",
            bounded=bounded,
            planar_g=planar[worst] if bounded else most_g,
            error=min(planar[worst], most_g) / solid[worst] - 1.0,
            **values,
        )


def _solid_pairs(record: EffectsRecord) -> Iterator[Finding]:
    """Each other 3D engine against the first, and where the exact model's own answer is in doubt."""
    first = record.solid_engine
    one = _peaks(record, first)
    for name in (name for name in record.engines if name in SOLID and name != first):
        other = _peaks(record, name)
        both = [a for a in one if math.isfinite(one[a]) and math.isfinite(other.get(a, math.inf))]
        apart = np.abs([other[a] / one[a] - 1.0 for a in both])
        if both:
            values = {"median": float(np.median(apart)), "within": int((apart <= NEAR).sum()), "directions": len(both)}
            yield info("solids_apart", a=name, b=first, near=NEAR, **values)
    doubted = {row.azimuth_deg: row.doubt for row in record.amplitudes(first, BASELINE) if row.doubt}
    if undecided := [azimuth for azimuth, doubt in doubted.items() if doubt == "undecided"]:
        yield caution("peaks_undecided", azimuths_deg=undecided).of(first)
    if change := [azimuth for azimuth, doubt in doubted.items() if doubt == "change"]:
        yield caution("peaks_change", azimuths_deg=change).of(first)


def _effects(record: EffectsRecord) -> Iterator[Finding]:
    """The least and largest change of each by direction, beside the range of what a survey does not know."""
    mine = [item for item in record.effects if item.engine == record.solid_engine and item.median is not None]
    unknown = [change.relative for item in mine if item.group == "uncertainty" for change in item.changes]
    if unknown:
        low, high = (float(np.quantile(unknown, q)) for q in UNKNOWN)
        yield info("survey_effect", low=low, high=high, model=record.solid_engine)
    shown = {item.condition: [item.least, item.largest] for item in mine if item.group != "uncertainty"}
    if shown:
        yield info("other_effects", ranges=shown)


def _leaving(record: EffectsRecord) -> Iterator[Finding]:
    """How far statues that stand leave the plane: one that falls at less than the least found, too, is no example of it."""
    mine = [each for each in record.departures if each.engine == record.solid_engine and each.outcome == Outcome.STANDS]
    leaving = [row.out_of_plane_rad for row in mine if row.out_of_plane_rad > LEAVES_RAD]
    if leaving:
        yield info(
            "leaves_plane",
            share=record.study.share,
            leaving=len(leaving),
            directions=len(mine),
            out_of_plane_rad=max(leaving),
            yaw_rad=max(abs(row.yaw_left_rad) for row in mine),
            walked_m=max(row.walked_m for row in mine),
        )
