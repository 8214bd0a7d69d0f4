"""The phases of one run: what the statue is in this world, where integration begins, and which shapes it needs when."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.engines.pybullet import feet, mirror, pose
from harness.engines.pybullet.backend import BulletBackend
from harness.engines.pybullet.feet import Crossing, EdgeWatch
from harness.engines.pybullet.full import FullShape, full_shape
from harness.engines.pybullet.settings import BulletSettings
from harness.engines.pybullet.world import STILL, UPRIGHT, World
from harness.engines.stepping import loop
from harness.engines.stepping.contact_gaps import ContactGaps
from harness.engines.stepping.frame import greatest_pull_m_s2, step_count
from harness.engines.stepping.loop import MOST_FREE, RestSpells, WallWatch, Watch
from harness.engines.stepping.schedule import Schedule
from harness.engines.stepping.step_log import Body, Row, StepLog, Vector
from harness.engines.stepping.step_state import Stepper, StepState
from harness.model.run import RunOptions
from harness.model.scene import Scene
from harness.statics.plan import LimitsOfRest, first_motion_s

Array = NDArray[np.float64]

LOOK_AHEAD_STEPS: Final = MOST_FREE + 4
"""Steps between two looks at the pedestal's edge at most: those taken at once, and what an event takes."""


@dataclass(frozen=True, eq=False)
class Setup:
    """The statue in its principal frame, origin at its centroid: `axes` (3, 3) as columns in the statue frame, `moments` (3,),
    `feet_m` (k, 3) and `hull_m` (n, 3); `rest` is its pose at rest, `start` its state at t = 0.
    """

    axes: Array
    moments: Array
    feet_m: Array
    hull_m: Array
    rest: feet.Rest
    start: Body
    mirrored: bool = False
    in_plane: bool = False

    @property
    def axis(self) -> Vector:
        """The statue's vertical axis in its principal frame."""
        return pose.vector(self.axes[2])

    @property
    def flat(self) -> Setup:
        """All of a scene that mirrors itself, its bodies turning in the plane alone."""
        return replace(self, moments=mirror.locked(self.moments), in_plane=True)

    @property
    def halved(self) -> Setup:
        """The half of a scene that mirrors itself."""
        return replace(self.flat, feet_m=mirror.halved(self.feet_m), mirrored=True)


@dataclass(frozen=True, eq=False)
class RunPhases:
    """Samples of a whole run; `full_from_s` is when the full shape `full` took over from its feet, both None if it never did.

    `mirrored` says that half of a scene that is its own mirror image was computed, up to there.
    """

    record: StepLog
    skipped: dict[str, float | None]
    full_from_s: float | None
    full: FullShape | None
    mirrored: bool = False


def prepare(scene: Scene) -> Setup:
    """Feet, hull, inertia, rest pose and start of a scene's statue."""
    statue = scene.statue
    moments, axes = pose.principal(statue)
    centroid = np.array([0.0, 0.0, statue.centroid_height_m])
    hull = feet.hull_vertices(statue)
    # Any vertex can touch a wall, and the floor under a thrown body; else those that a lean brings down to a level support.
    touching = hull if scene.wall is not None or scene.initial.pose is not None else feet.touchable(statue)
    rest = feet.rest(statue)
    start = pose.start(scene, touching, rest, axes)
    return Setup(axes, moments, (touching - centroid) @ axes, (hull - centroid) @ axes, rest, start)


def run(scene: Scene, level: BulletSettings, setup: Setup, options: RunOptions) -> RunPhases:
    """All samples: on the feet alone as long as nothing else can touch, then with the full shape."""
    count = step_count(scene.duration_s, level.dt_s)
    quiet_s = quiet_start_s(scene, setup) if options.allows("quiet_start") else 0.0
    first = min(int(quiet_s / level.dt_s), count - 1)
    schedule = Schedule(scene, level.dt_s, first, count)
    full = None
    if scene.pedestal is not None and not options.allows("base_only"):
        full = full_shape(scene, level.full_shape)
    whole = setup
    if options.allows("mirror") and mirror.halves(scene):
        whole = setup.flat
        setup = whole if full is not None else setup.halved
    crossing = None if full is None else _crossing(scene, setup, _first_row(scene, setup))
    watch = _watch(scene, level, setup, options, crossing)
    record = _part(scene, level, setup, schedule, watch, full=full, crossing=crossing)
    full_from = None if full is None else 0.0
    while watch.leave is not None and round(record.t_s[-1] / level.dt_s) < count and watch.leave(record.last):
        # The pedestal's edge can meet the body from here on, or another foot is beside its top: the same state goes on in a
        # world with the full shape, and with these feet.
        full_from = record.t_s[-1] if full_from is None else full_from
        full, crossing = full or full_shape(scene, level.full_shape), _crossing(scene, whole, record.last)
        watch = _watch(scene, level, whole, options, crossing)
        rest_of = _part(scene, level, whole, schedule, watch, full=full, crossing=crossing, done=record)
        record = _joined(record, rest_of)
    said = _skipped(
        first * level.dt_s,
        record.at_rest * level.dt_s,
        scene.duration_s - record.t_s[-1] if record.rested else 0.0,
        base_only=full_from is None,
        in_plane=setup.in_plane,
    )
    return RunPhases(record, said, full_from, full, setup.mirrored)


def _crossing(scene: Scene, setup: Setup, row: Row) -> Crossing | None:
    """What tells a foot that comes over the pedestal's edges, from a row on."""
    p = scene.pedestal
    return None if p is None else Crossing(setup.feet_m, p.half_m[:2], row)


def _first_row(scene: Scene, setup: Setup) -> Row:
    """The row at t = 0 on a pedestal."""
    p, start = scene.pedestal, setup.start
    centre = (0.0, 0.0, 0.0) if p is None else (scene.statue.base_centre_m + p.offset_m, 0.0, p.centroid_height_m)
    return (*start.place_m, *start.turn, *start.velocity_m_s, *start.rate_rad_s, *centre, *UPRIGHT, *STILL, *STILL)


def _watch(scene: Scene, level: BulletSettings, setup: Setup, options: RunOptions, crossing: Crossing | None) -> Watch:
    """What the loop looks at; with `crossing` in a world of full shapes."""
    end_s = scene.base_excitation.end_s
    may_rest = options.allows("quiet_end") and end_s < scene.duration_s
    edges = None
    if scene.pedestal is not None:
        edges = EdgeWatch(setup.hull_m, scene.pedestal.half_m, LOOK_AHEAD_STEPS * level.dt_s, greatest_pull_m_s2(scene))
    axis, rest = setup.axis, pose.vector(setup.rest.rotation[:, 2])
    limits = LimitsOfRest.of(scene) if options.allows("quiet_rest") and _may_be_skipped(scene, setup) else None
    return Watch(
        axis=axis,
        rest=rest,
        quiet_from=math.ceil(end_s / level.dt_s) if may_rest else None,
        impose=scene.contact.restitution is not None,
        leave=edges if crossing is None else crossing,
        stop=options.stop,
        gaps=gaps_of(scene, setup, level, edges=crossing is not None) if level.events else None,
        edges=None if crossing is None else edges,
        wall=WallWatch.of(scene, setup.axes, level.dt_s),
        spells=None if limits is None else RestSpells(limits, setup.axes, axis, rest),
    )


def _may_be_skipped(scene: Scene, setup: Setup) -> bool:
    """Whether limits of rest are known: of a statue that rests upright on a table that is kept still in its own frame."""
    return setup.rest.lean_rad == 0.0 and scene.table == "frame"


def gaps_of(scene: Scene, setup: Setup, level: BulletSettings, *, edges: bool = False) -> ContactGaps:
    """What finds the impacts of the base; with `edges` a foot beside the pedestal's top meets nothing there."""
    p = scene.pedestal
    half = None if p is None else 0.5 * p.height_m
    within = p.half_m[:2] if edges and p is not None else None
    return ContactGaps(scene, setup.feet_m, half, level.dt_s, within)


def _part(
    scene: Scene,
    level: BulletSettings,
    setup: Setup,
    schedule: Schedule,
    watch: Watch,
    *,
    full: FullShape | None,
    crossing: Crossing | None,
    done: StepLog | None = None,
) -> StepLog:
    """One world: from the scene's start, or from where another one has come to."""
    with World(level, mirrored=setup.mirrored, in_plane=setup.in_plane) as world:
        build(world, scene, setup, full, crossing)
        backend = BulletBackend(world, level.dt_s, scene.contact.statue)
        stepper = Stepper(backend, scene, schedule, level.event_share, setup.axes)
        if done is None:
            state = StepState(stepper, backend.read(), schedule.first, schedule.first * level.dt_s, even=True)
        else:
            backend.place(done.last)
            stepper.writer.ledger = done.ledger
            state = StepState(stepper, done.last, round(done.t_s[-1] / level.dt_s), done.kick_s[-1], even=False)
        return loop.integrate(scene, schedule, watch, state)


def build(world: World, scene: Scene, setup: Setup, full: FullShape | None, crossing: Crossing | None = None) -> None:
    """Create the scene's bodies, the statue on its feet or with its full shape."""
    statue, pedestal, wall = scene.statue, None, None
    if scene.pedestal is not None:
        pedestal = (scene.pedestal, statue.base_centre_m + scene.pedestal.offset_m)
    if scene.wall is not None:
        sign = scene.wall.sign
        wall = (scene.wall, sign * (statue.corner_m(sign) + scene.wall.distance_m))
    centroid = np.array([0.0, 0.0, statue.centroid_height_m])
    bodies = None if full is None else full.turned(centroid, setup.axes)
    whole = (statue.mass_kg, setup.moments, setup.feet_m, bodies, setup.start)
    world.build(scene.contact, pedestal, wall, whole, None if crossing is None else crossing.beside)


def _joined(before: StepLog, after: StepLog) -> StepLog:
    return StepLog(
        before.width,
        before.t_s + after.t_s[1:],
        before.kick_s + after.kick_s[1:],
        before.flat + after.flat[after.width :],
        after.ledger,
        after.rested,
        before.at_rest + after.at_rest,
    )


def quiet_start_s(scene: Scene, setup: Setup) -> float:
    """Time before which nothing can move: 0 where the statue rests aslant."""
    return first_motion_s(scene) if setup.rest.lean_rad == 0.0 else 0.0


def _skipped(
    quiet_s: float, rest_s: float, end_s: float, *, base_only: bool, in_plane: bool
) -> dict[str, float | None]:
    """What the run left out, by skip (`Run.skipped`)."""
    times = {"quiet_start": quiet_s, "quiet_rest": rest_s, "quiet_end": end_s}
    whole: dict[str, float | None] = {"mirror": None} if in_plane else {}
    if base_only:
        whole["base_only"] = None
    return whole | {name: time_s for name, time_s in times.items() if time_s > 0.0}
