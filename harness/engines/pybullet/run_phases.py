"""The phases of one run: where integration begins, and which shapes the statue needs when."""

import math
from dataclasses import dataclass
from typing import Final

import pybullet

from harness.engines.pybullet.settings import BulletSettings, halves
from harness.engines.pybullet.statue import EdgeCrossing, EdgeWatch, FullShape, Setup, full_shape, vector
from harness.engines.pybullet.world import BulletBackend, World, at_rest
from harness.engines.stepping import loop
from harness.engines.stepping.loop import LOOK_STEPS, MOST_FREE, SETTLE_STEPS, RestSpells, WallWatch, Watch, plain_steps
from harness.engines.stepping.step_state import ContactGaps, Stepper, StepState
from harness.engines.stepping.trajectory import Schedule, StepLog, greatest_pull_m_s2, schedules, step_count
from harness.model import RunOptions, Scene
from harness.statics.plan import LimitsOfRest, first_motion_s

LOOK_AHEAD_STEPS: Final = MOST_FREE + 4
"""Steps between two looks at the pedestal's edge at most: those taken at once, and what an event takes."""


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


def run(scene: Scene, own: BulletSettings, setup: Setup, options: RunOptions, coarsest: BulletSettings) -> RunPhases:
    """All samples: on the feet alone as long as nothing else can touch, then with the full shape."""
    quiet_s = quiet_start_s(scene, setup) if options.allows("quiet_start") else 0.0
    first = min(max(int(quiet_s / own.dt_s) - SETTLE_STEPS, 0), step_count(scene.duration_s, own.dt_s) - 1)
    full, full_from, record, row = None, None, None, setup.start
    if scene.pedestal is not None:
        row += at_rest((scene.statue.base_centre_m + scene.pedestal.offset_m, 0.0, scene.pedestal.centroid_height_m))
        if not options.allows("base_only"):
            full, full_from = full_shape(scene, own.full_shape), 0.0
    whole = setup
    if options.allows("mirror") and halves(scene):
        whole = setup.flat
        setup = whole if full is not None else setup.halved
    mirrored = setup.mirrored
    steps = schedules(scene, own, coarsest, first, options.coarser_from_s)
    while True:
        crossing = None
        if full is not None and scene.pedestal is not None:
            # What tells a foot that comes over the pedestal's edges, from here on.
            crossing = EdgeCrossing(setup.feet_m, scene.pedestal.half_m[:2], row)
        level, schedule = steps[0]
        watch = _watch(scene, level, setup, options, crossing)
        record = _part(scene, level, setup, schedule, watch, full, crossing, record)
        row, ended = record.row(-1), schedule.ended(record.t_s[-1])
        if ended and len(steps) > 1:
            steps = steps[1:]
            record.go_on(coarsest.dt_s)
            continue
        if watch.leave is None or ended or not watch.leave(row):
            break
        # The pedestal's edge can meet the body from here on, or another foot is beside its top: the same state goes on in a
        # world with the full shape, and with these feet.
        full_from = record.t_s[-1] if full_from is None else full_from
        full, setup = full or full_shape(scene, own.full_shape), whole
    times = {
        "quiet_start": first * own.dt_s,
        "quiet_rest": record.rest_s,
        "quiet_end": scene.duration_s - record.t_s[-1] if record.rested else 0.0,
    }
    skipped: dict[str, float | None] = {"mirror": None} if setup.in_plane else {}
    if full_from is None:
        skipped["base_only"] = None
    skipped |= {name: time_s for name, time_s in times.items() if time_s > 0.0}
    return RunPhases(record, skipped, full_from, full, mirrored)


def _part(
    scene: Scene,
    level: BulletSettings,
    setup: Setup,
    schedule: Schedule,
    watch: Watch,
    full: FullShape | None,
    crossing: EdgeCrossing | None,
    done: StepLog | None,
) -> StepLog:
    """One world: from the scene's start, or from where another one has come to."""
    with World(level, setup) as world:
        bodies = None if full is None else full.turned(scene.statue, setup.axes)
        world.build(scene, bodies, None if crossing is None else crossing.beside)
        backend = BulletBackend(world, level.dt_s, scene.contact.statue)
        stepper = Stepper(backend, scene, schedule, level.event_share, setup.axes)
        if done is None:
            record, even = StepLog.begun(backend.read(), schedule.first * level.dt_s), True
        else:
            backend.place(done.row(-1))
            record, even = done, False
        return loop.integrate(scene, schedule, watch, StepState(stepper, record, even=even))


def _watch(
    scene: Scene, level: BulletSettings, setup: Setup, options: RunOptions, crossing: EdgeCrossing | None
) -> Watch:
    """What the loop looks at; with `crossing` in a world of full shapes."""
    end_s = scene.base_excitation.end_s
    may_rest = options.allows("quiet_end") and end_s < scene.duration_s
    edges = None
    if scene.pedestal is not None:
        edges = EdgeWatch(setup.hull_m, scene.pedestal.half_m, LOOK_AHEAD_STEPS * level.dt_s, greatest_pull_m_s2(scene))
    axis, rest = setup.axis, vector(setup.rest.rotation[:, 2])
    limits = None
    # Limits of rest are known of a statue that rests upright on a table that is kept still in its own frame.
    if options.allows("quiet_rest") and setup.rest.lean_rad == 0.0 and scene.table == "frame":
        limits = LimitsOfRest.of(scene)
    return Watch(
        axis=axis,
        rest=rest,
        quiet_from=math.ceil(end_s / level.dt_s) if may_rest else None,
        leave=edges if crossing is None else crossing,
        stop=options.stop,
        gaps=gaps_of(scene, setup, level, edges=crossing is not None) if level.events else None,
        edges=None if crossing is None else edges,
        wall=None if scene.wall is None else WallWatch(scene, setup.axes, level.dt_s),
        spells=None if limits is None else RestSpells(limits, setup.axes, axis, rest),
    )


def gaps_of(scene: Scene, setup: Setup, level: BulletSettings, *, edges: bool = False) -> ContactGaps:
    """What finds the impacts of the base; with `edges` a foot beside the pedestal's top meets nothing there."""
    p = scene.pedestal
    half = None if p is None else 0.5 * p.height_m
    within = p.half_m[:2] if edges and p is not None else None
    return ContactGaps(scene, setup.feet_m, half, level.dt_s, within)


def quiet_start_s(scene: Scene, setup: Setup) -> float:
    """Time before which nothing can move: 0 where the statue rests aslant."""
    return first_motion_s(scene) if setup.rest.lean_rad == 0.0 else 0.0


# Whole steps of an unmodified Bullet.

BOUNCES_ABOVE_M_S: Final = 0.02
"""Where contacts bounce, slower ones do not: a body that has come to rest would never rest."""


def run_plain(scene: Scene, settings: BulletSettings, setup: Setup, options: RunOptions) -> tuple[StepLog, str | None]:
    """All samples of plain steps, and what the full shape was, None where the vertices that touch were enough."""
    schedule = Schedule(scene, settings.dt_s, 0, step_count(scene.duration_s, settings.dt_s))

    def stepped(full: FullShape | None, leave: EdgeWatch | None) -> StepLog:
        wall = None if scene.wall is None else WallWatch(scene, setup.axes, settings.dt_s)
        fallen = options.allows("stop_at_overturn")
        watch = Watch(setup.axis, leave=leave, stop=options.stop, ends_fallen=fallen, wall=wall)
        with World(settings, setup) as world:
            world.build(scene, None if full is None else full.turned(scene.statue, setup.axes))
            if scene.contact.restitution is not None:
                _bounce(world, scene.contact.restitution)
            return plain_steps(BulletBackend(world, settings.dt_s), schedule, watch)

    p = scene.pedestal
    if p is None:
        return stepped(None, None), None
    if options.allows("base_only"):
        edge = EdgeWatch(setup.hull_m, p.half_m, LOOK_STEPS * settings.dt_s, greatest_pull_m_s2(scene))
        record = stepped(None, edge)
        if not edge(record.row(-1)):
            return record, None
    # The statue comes to the pedestal's edge: a body is not exchanged on the way, the run begins again with all of it.
    full = full_shape(scene, settings.full_shape)
    return stepped(full, None), full.note


def _bounce(world: World, restitution: float) -> None:
    """Let contacts between the statue and the floor return this share of their normal velocity (Bullet multiplies both)."""
    pybullet.setPhysicsEngineParameter(restitutionVelocityThreshold=BOUNCES_ABOVE_M_S, physicsClientId=world.client)
    for body in (world.statue, world.floor):
        pybullet.changeDynamics(body, -1, restitution=math.sqrt(restitution), physicsClientId=world.client)
