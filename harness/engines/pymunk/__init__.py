"""pymunk (Chipmunk): rigid polygons in the rocking plane, contact by iterated impulses. docs/engines.md."""

import math
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from importlib import metadata
from typing import ClassVar, Final, final

import numpy as np

from harness.engines.base import (
    VERIFICATION_EVENT_SHARE,
    VERIFICATION_STEP_SHARE,
    Engine,
    EngineFailure,
    Settings,
    near,
    own_settings,
    refuse,
)
from harness.engines.pymunk.settings import MunkSettings
from harness.engines.stepping.loop import (
    IMPOSED_LABEL,
    STILL_M_S,
    WallWatch,
    Watch,
    integrate,
    plain_steps,
    refuse_steering,
)
from harness.engines.stepping.reduce import REST_BAND_RAD, Report, reduce_trajectory
from harness.engines.stepping.step_state import ContactGaps, Stepper, StepState
from harness.engines.stepping.support import flat_base, stuck_below_m_s
from harness.engines.stepping.trajectory import Schedule, StepLog, schedules, step_count, trajectory
from harness.model import Capabilities, Run, RunOptions, Scene
from harness.statics.plan import first_motion_s

LEVELS: Final = (
    (4e-3, 90, 5e-4),
    (2e-3, 120, 2e-4),
    (1e-3, 120, 1e-4),
    (5e-4, 160, 3e-5),
    (2.5e-4, 240, 7e-6),
    (1e-4, 400, 3e-6),
    (5e-5, 600, 1.5e-6),
    (2e-5, 800, 1e-6),
)
"""(step in s, iterations, error in rad reached where tuned): the paper's four cases with a pedestal, μ_s = 0.15 and 0.20,
μ_k = 0.15, first second, against the analytic model. A statue on a pedestal needs many iterations at any step: with fewer the
solver iterations leave more than the step does. They grow as the step shrinks, because what they leave does not fall with the
step."""
ALONE_SHARE, ALONE_LEAST = 0.5, 90
"""Share of the iterations that a statue without a pedestal needs: twice as many as those at which its error stops falling; but at
rest, with 60, it turned by 7e-7 rad a minute at 4 ms, and a later start (skip `quiet_start`) decided a borderline outcome."""
AT_IMPACTS: Final = 2
"""Times the iterations in a step in which all contacts meet an impact or a stick onset: its first guess is of another state."""
DEPTH_RAD_S: Final = 1e-5
"""Depth at which a vertex is held over the base's width and the step: what comes down is felt at its depth, and must not be so
before its impact is met."""
SLOP_RAD_S: Final = 0.1
"""Penetration that Chipmunk leaves alone, over the same: its correction of deeper ones adds energy."""
SETTLE_STEPS: Final = 500
"""Whole steps computed before the first instant at which anything can move: the contact's penetration must have settled as it
would have by then, or an outcome far on may be another (with 64 of them two of six under real records were)."""


@final
class Munk2D(Engine):
    """Chipmunk's contact of polygons, its steps ended at impacts and stick onsets."""

    name: ClassVar[str] = "pymunk"
    capabilities: ClassVar[Capabilities] = Capabilities(
        dimensions=2,
        own_impact=True,
        pedestal_tips=True,
        statue_slips=True,
        flies=True,
        posed_start=True,
        moving_table=True,
        forces=True,
        edge_shape="silhouette_hull",
        skips=frozenset({"quiet_start", "quiet_end", "no_history", "stop_at_overturn"}),
    )
    order: ClassVar[float] = 1.0
    agreements: ClassVar[int] = 1

    def missing(self) -> str | None:
        """Why pymunk cannot run here, or None."""
        try:
            import pymunk  # noqa: F401
        except ImportError as error:
            return f"pymunk cannot be imported: {error}"
        # The module's own attribute says 2.0.0 in 7.0.0.
        installed = metadata.version("pymunk")
        return None if int(installed.split(".")[0]) >= 7 else f"pymunk 7 is wanted, {installed} is installed"

    def refinement_levels(self, scene: Scene) -> tuple[MunkSettings, ...]:
        """Steps of 4 ms to 0.02 ms; iterations grow because a finer step needs them to show."""
        return tuple(_settings(scene, *level) for level in LEVELS)

    def settings_for_dt(self, scene: Scene, dt_s: float) -> MunkSettings:
        """The nearest level's iterations with the given step."""
        return _settings(scene, *near(LEVELS, dt_s))

    def verification_settings(self, scene: Scene, settings: Settings) -> tuple[MunkSettings, ...]:
        """Less than half the step, with the bodies added in the other order and the iterations of that step."""
        own = own_settings(self.name, MunkSettings, settings)
        # Step and order of the bodies change together: the answer depends on both, and each alone may agree by chance.
        iterations = max(self.settings_for_dt(scene, VERIFICATION_STEP_SHARE * own.dt_s).iterations, own.iterations)
        return (
            replace(
                own,
                dt_s=VERIFICATION_STEP_SHARE * own.dt_s,
                depth_m=VERIFICATION_STEP_SHARE * own.depth_m,
                slop_m=VERIFICATION_STEP_SHARE * own.slop_m,
                expected_error_rad=VERIFICATION_STEP_SHARE * own.expected_error_rad,
                iterations=iterations,
                impact_iterations=3 * own.iterations,
                pedestal_first=not own.pedestal_first,
                event_share=VERIFICATION_EVENT_SHARE,
            ),
        )

    def step_s(self, scene: Scene) -> float:
        """Measured on the shipped scenes, with and without a pedestal."""
        return 3e-5

    def simulate(self, scene: Scene, settings: Settings, options: RunOptions) -> Run:
        """Compute the scene. Raises `EngineFailure` where Chipmunk refuses it."""
        own = own_settings(self.name, MunkSettings, settings)
        scene = _in_plane(self.name, scene)
        if scene.initial.pose is not None and scene.contact.restitution is not None:
            raise EngineFailure("pymunk locates plastic impacts only: a coefficient of restitution is pymunk:plain's")
        begin = time.perf_counter()
        count = step_count(scene.duration_s, own.dt_s)
        quiet_s = first_motion_s(scene) if options.allows("quiet_start") else 0.0
        first = min(max(int(quiet_s / own.dt_s) - SETTLE_STEPS, 0), count - 1)
        coarsest = self.refinement_levels(scene)[0]
        with _refusals():
            record = _steps(scene, options, schedules(scene, own, coarsest, first, options.coarser_from_s), None)
        run = _reduced(self.name, scene, own, options, record, plain=False)
        return replace(run, wall_s=time.perf_counter() - begin)


def _in_plane(name: str, scene: Scene) -> Scene:
    """The scene without its push across the plane, which has no part in what friction must hold.

    Raises `EngineFailure` where it begins out of the plane.
    """
    pose = scene.initial.pose
    aside = {"a pose out of the rocking plane": pose is not None and not pose.in_plane}
    refuse(name, aside, name.replace("munk", "bullet"))
    return replace(scene, base_excitation=scene.base_excitation.in_plane())


@contextmanager
def _refusals() -> Iterator[None]:
    """What Chipmunk refuses becomes an `EngineFailure`."""
    try:
        yield
    except (AssertionError, ValueError, MemoryError) as error:
        raise EngineFailure(f"pymunk refused the scene: {error}") from error


def _reduced(name: str, scene: Scene, own: MunkSettings, options: RunOptions, record: StepLog, *, plain: bool) -> Run:
    """The run of either engine from its samples."""
    begin_s, end_s = record.t_s[0], record.t_s[-1]
    skipped: dict[str, float | None] = {"quiet_start": begin_s} if begin_s > 0.0 else {}
    if record.rested:
        skipped["quiet_end"] = scene.duration_s - end_s
    plain_throughout = {"plain_from_s": begin_s, "plain_for_s": end_s - begin_s, "plain_because": ["asked for"]}
    located, stuck_m_s = not plain and _located(scene), stuck_below_m_s(scene, own.dt_s)
    base_m = scene.statue.corner_left_m + scene.statue.corner_right_m
    report = Report(
        engine=name,
        settings=own.as_dict(),
        steps=len(record.t_s) - 1,
        wall_s=0.0,
        # Else what the contact's slop can leave at rest.
        resolution_rad=REST_BAND_RAD if located else 2.0 * own.slop_m * max(record.coarser[1] / own.dt_s, 1.0) / base_m,
        stuck_below_m_s=stuck_m_s if plain else max(10.0 * stuck_m_s, STILL_M_S),
        rested=record.rested,
        with_history=options.history or not options.allows("no_history"),
        validity={} if plain or located else plain_throughout,
        interventions=record.ledger.record(),
        skipped=skipped,
        coarser=record.coarser,
        labels=() if plain or scene.contact.restitution is None else (IMPOSED_LABEL,),
        repeats=not plain,
    )
    return reduce_trajectory(scene, trajectory(scene, record, None, own.dt_s), report)


def _steps(
    scene: Scene, options: RunOptions, parts: Sequence[tuple[MunkSettings, Schedule]], done: StepLog | None
) -> StepLog:
    """Samples of a run, one space for each part: from the scene's start, or from where another one has come to."""
    from harness.engines.pymunk import backend, world

    (level, schedule), *later = parts
    support = backend.SupportVertex(scene, level)
    munk = backend.ChipmunkBackend(world.build(scene, level), level, support)
    if done is not None:
        munk.place(done.row(-1))
    record = done or StepLog.begun(munk.read(), schedule.first * level.dt_s)
    state = StepState(Stepper(munk, scene, schedule, level.event_share), record, even=done is None)
    watch, end_s = _watch(scene, level, options), scene.base_excitation.end_s
    if _located(scene):
        x, z = np.array(support.points).T
        # A vertex is felt at its depth: there its gap is none.
        feet_m = np.column_stack([x, np.zeros(x.size), z + level.depth_m])
        half_m = None if scene.pedestal is None else 0.5 * scene.pedestal.height_m
        watch = replace(watch, gaps=ContactGaps(scene, feet_m, half_m, level.dt_s))
    if options.allows("quiet_end") and end_s < scene.duration_s:
        watch = replace(watch, quiet_from=math.ceil(end_s / level.dt_s))
    record = integrate(scene, schedule, watch, state)
    if later and schedule.ended(record.t_s[-1]):
        record.go_on(later[0][0].dt_s)
        return _steps(scene, options, later, record)
    return record


def _watch(scene: Scene, level: MunkSettings, options: RunOptions) -> Watch:
    wall = None if scene.wall is None else WallWatch(scene, None, level.dt_s)
    return Watch(stop=options.stop, ends_fallen=options.allows("stop_at_overturn"), wall=wall)


def _located(scene: Scene) -> bool:
    """Whether impacts are met inside steps; a prescribed ratio is imposed on a flat base only."""
    return scene.contact.restitution is None or flat_base(scene)


def _settings(
    scene: Scene, dt_s: float, most_iterations: float, error_rad: float, *, plain: bool = False
) -> MunkSettings:
    """A level for this scene: the depth of contact is a rotation of the base, in proportion to the step."""
    base_m = scene.statue.corner_left_m + scene.statue.corner_right_m
    iterations, depth_rad_s = round(most_iterations), PLAIN_DEPTH_RAD_S if plain else DEPTH_RAD_S
    if scene.pedestal is None and not plain:
        iterations = max(round(ALONE_SHARE * iterations), ALONE_LEAST)
    at_impacts = (1 if plain else AT_IMPACTS) * iterations
    return MunkSettings(
        dt_s, error_rad, iterations, depth_rad_s * base_m * dt_s, SLOP_RAD_S * base_m * dt_s, at_impacts
    )


# Unmodified pymunk: bodies, shapes, masses, coefficients, gravity, step and iterations; after the start no body is written to.
#
# What `pymunk` adds to this, events located inside a step, rests on rigid-body formulas of this project; this engine has none of
# them, so that where the two agree the contact engine itself has confirmed the answer. Two coefficients of friction are the one
# thing that Chipmunk does not know: the floor's follows the pedestal's own velocity
# (`harness.engines.stepping.support.followed`).


PLAIN_LEVELS: Final = (
    (2e-3, 200, 1e-2),
    (1e-3, 200, 5e-3),
    (5e-4, 200, 2.5e-3),
    (2.5e-4, 200, 1e-3),
    (1e-4, 200, 5e-4),
    (5e-5, 200, 2.5e-4),
    (2.5e-5, 200, 1e-4),
)
"""(step in s, iterations, error in rad). With 40 iterations a stuck pedestal slides (0.1 rad off); with 200 two of the paper's
cases err at 0.25 ms (8.960e-4 and 2.6428e-3 rad) as with 1000 (8.953e-4, 2.6414e-3), at a quarter of the cost. The error is
assumed: first order, some ten times what the paper's cases with one coefficient show; not measured over random scenes."""


PLAIN_DEPTH_RAD_S: Final = 0.002
"""Depth at which the statue is placed at first over the base's width and the step, so that contacts exist from then on."""


@final
class PlainMunk2D(Engine):
    """Chipmunk's own steps, nothing else."""

    name: ClassVar[str] = "pymunk:plain"
    capabilities: ClassVar[Capabilities] = replace(
        Munk2D.capabilities, moving_table=False, skips=frozenset({"no_history", "stop_at_overturn"})
    )
    order: ClassVar[float] = 1.0

    missing = Munk2D.missing

    def refinement_levels(self, scene: Scene) -> tuple[MunkSettings, ...]:
        """Steps of 2 ms to 0.025 ms."""
        return tuple(_settings(scene, *level, plain=True) for level in PLAIN_LEVELS)

    def settings_for_dt(self, scene: Scene, dt_s: float) -> MunkSettings:
        """The nearest level's iterations with the given step."""
        return _settings(scene, *near(PLAIN_LEVELS, dt_s), plain=True)

    def verification_settings(self, scene: Scene, settings: Settings) -> tuple[MunkSettings, ...]:
        """Less than half the step, with the bodies added in the other order."""
        own = own_settings(self.name, MunkSettings, settings)
        finer = self.settings_for_dt(scene, VERIFICATION_STEP_SHARE * own.dt_s)
        return (
            replace(
                finer,
                iterations=max(finer.iterations, own.iterations),
                pedestal_first=not own.pedestal_first,
                expected_error_rad=VERIFICATION_STEP_SHARE * own.expected_error_rad,
            ),
        )

    def step_cost(self, scene: Scene) -> float:
        """On the paper's statue 0.9 on the floor and 1.1 on its pedestal."""
        return 1.25

    def simulate(self, scene: Scene, settings: Settings, options: RunOptions) -> Run:
        """Compute the scene. Raises `EngineFailure` where Chipmunk refuses it, or where it would have to be steered."""
        from harness.engines.pymunk import backend, world

        refuse_steering(scene, self.name)
        own = own_settings(self.name, MunkSettings, settings)
        scene = _in_plane(self.name, scene)
        begin = time.perf_counter()
        schedule = Schedule(scene, own.dt_s, 0, step_count(scene.duration_s, own.dt_s))
        with _refusals():
            # Without a support the backend holds nothing: it is Chipmunk's own step, read.
            plain = backend.ChipmunkBackend(world.build(scene, own), own)
            record = plain_steps(plain, schedule, _watch(scene, own, options))
        run = _reduced(self.name, scene, own, options, record, plain=True)
        return replace(run, wall_s=time.perf_counter() - begin)
