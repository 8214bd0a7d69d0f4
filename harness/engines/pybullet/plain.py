"""Unmodified pybullet: bodies, shapes, masses, inertia, coefficients, gravity, step; after the start no body is written to.

The steps are all of one length, none is repeated, no place or velocity is set, no contact parameter changes on the way. The
shapes are what the scene needs: spheres at the vertices that can touch, and where the statue comes to its pedestal's edge its
full shape from the start. Two coefficients of friction are the one thing that Bullet does not know: the floor's follows the
pedestal's own velocity (`harness.engines.stepping.coulomb.followed`).
"""

from __future__ import annotations

import math
import time
from dataclasses import replace
from typing import TYPE_CHECKING, ClassVar, Final, final

from harness.engines.base import VERIFICATION_STEP_SHARE, Engine, Settings, near, own_settings
from harness.engines.pybullet.adapter import Bullet3D
from harness.engines.pybullet.mirror import halves
from harness.engines.pybullet.settings import BulletSettings
from harness.engines.stepping.columns import trajectory
from harness.engines.stepping.coulomb import stuck_below_m_s
from harness.engines.stepping.frame import Schedule, greatest_pull_m_s2, step_count
from harness.engines.stepping.loop import LOOK_STEPS, WallWatch, Watch, plain_steps, refuse_steering
from harness.engines.stepping.reduce import REST_BAND_RAD, Report, reduce_trajectory
from harness.engines.stepping.step_log import StepLog
from harness.model import Capabilities, Run, RunOptions, Scene

if TYPE_CHECKING:
    from harness.engines.pybullet.pose import Setup
    from harness.engines.pybullet.shapes import FullShape
    from harness.engines.pybullet.world import World

LEVELS: Final = (
    (2e-3, 1e-2),
    (1e-3, 5e-3),
    (5e-4, 2.5e-3),
    (2.5e-4, 1e-3),
    (1.25e-4, 5e-4),
    (6.25e-5, 2.5e-4),
)
"""(step in s, error in rad). The error is assumed: first order, some ten times what the paper's cases with one coefficient show;
not measured over random scenes."""
TURNING_RAD_S: Final = 3.0
"""Rate up to which a turning body's feet are still contacts at the end of a step: statues rock at up to some 2 rad/s."""
BOUNCES_ABOVE_M_S: Final = 0.02
"""Where contacts bounce, slower ones do not: a body that has come to rest would never rest."""


@final
class PlainBullet3D(Engine):
    """Bullet's own steps, nothing else."""

    name: ClassVar[str] = "pybullet:plain"
    capabilities: ClassVar[Capabilities] = replace(
        Bullet3D.capabilities, moving_table=False, skips=frozenset({"base_only", "no_history", "stop_at_overturn"})
    )
    order: ClassVar[float] = 1.0

    missing = Bullet3D.missing
    sensitivity_settings = Bullet3D.sensitivity_settings

    def refinement_levels(self, scene: Scene) -> tuple[BulletSettings, ...]:
        """Steps of 2 ms to 0.0625 ms."""
        return tuple(_settings(*level) for level in LEVELS)

    def settings_for_dt(self, scene: Scene, dt_s: float) -> BulletSettings:
        """The nearest level's settings with the given step."""
        return _settings(*near(LEVELS, dt_s))

    def verification_settings(self, scene: Scene, settings: Settings) -> tuple[BulletSettings, ...]:
        """Less than half the step, with the bodies added in the other order."""
        own = own_settings(self.name, BulletSettings, settings)
        finer = _settings(VERIFICATION_STEP_SHARE * own.dt_s, VERIFICATION_STEP_SHARE * own.expected_error_rad)
        return (replace(finer, reversed_bodies=not own.reversed_bodies),)

    def step_cost(self, scene: Scene) -> float:
        """Of 21 invented, random and wide scenes 0.9 to 2.1 on the floor, 1.7 to 9.3 where `pybullet` computes half of a pedestal
        and its statue, and 0.1 to 0.4 where it computes all of them; worlds that are made, and made again, count in it.
        """
        if scene.pedestal is None:
            return 2.1
        return 8.0 if halves(scene) else 1.0

    def simulate(self, scene: Scene, settings: Settings, options: RunOptions) -> Run:
        """Compute the scene. Raises `EngineFailure` where pybullet refuses it, or where it would have to be steered."""
        from harness.engines.pybullet import pose

        own = own_settings(self.name, BulletSettings, settings)
        refuse_steering(scene, self.name)
        begin = time.perf_counter()
        setup = pose.prepare(scene)
        record, full = _integrate(scene, own, setup, options)
        path = trajectory(scene, record, setup.axes, own.dt_s)
        report = Report(
            engine=self.name,
            settings=own.as_dict(),
            steps=len(record.t_s) - 1,
            wall_s=time.perf_counter() - begin,
            resolution_rad=REST_BAND_RAD,
            stuck_below_m_s=stuck_below_m_s(scene, own.dt_s),
            with_history=options.history or not options.allows("no_history"),
            repeats=False,
            validity={
                "touching_vertices": len(setup.feet_m),
                "full_shape_from_s": None if full is None else 0.0,
                "full_shape": full,
            },
        )
        return reduce_trajectory(scene, path, report)


def _settings(dt_s: float, error_rad: float) -> BulletSettings:
    """One level: the reach of contacts is what a step may lift a foot off its support at `TURNING_RAD_S`, twice over."""
    reach = max(BulletSettings(dt_s, error_rad).reach, 2.0 * (TURNING_RAD_S * dt_s) ** 2)
    return BulletSettings(dt_s, error_rad, events=False, reach=reach, iterations=1000)


def _integrate(scene: Scene, settings: BulletSettings, setup: Setup, options: RunOptions) -> tuple[StepLog, str | None]:
    """All samples, and what the full shape was, None where the vertices that touch were enough."""
    from harness.engines.pybullet.backend import BulletBackend
    from harness.engines.pybullet.feet import EdgeWatch
    from harness.engines.pybullet.shapes import full_shape
    from harness.engines.pybullet.world import World

    schedule = Schedule(scene, settings.dt_s, 0, step_count(scene.duration_s, settings.dt_s))

    def stepped(full: FullShape | None, leave: EdgeWatch | None) -> StepLog:
        wall = WallWatch.of(scene, setup.axes, settings.dt_s)
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
    import pybullet

    pybullet.setPhysicsEngineParameter(restitutionVelocityThreshold=BOUNCES_ABOVE_M_S, physicsClientId=world.client)
    for body in (world.statue, world.floor):
        pybullet.changeDynamics(body, -1, restitution=math.sqrt(restitution), physicsClientId=world.client)
