"""pybullet: rigid bodies with contact in three dimensions, the statue's own mesh on spheres at its base's vertices; and its own
steps alone.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, ClassVar, Final, final

import numpy as np

from harness.engines.base import (
    VERIFICATION_EVENT_SHARE,
    VERIFICATION_STEP_SHARE,
    Engine,
    EngineFailure,
    Settings,
    near,
    own_settings,
)
from harness.engines.pybullet.settings import BulletSettings, axes_of, halves, other_axes
from harness.engines.stepping.loop import IMPOSED_LABEL, refuse_steering
from harness.engines.stepping.reduce import REST_BAND_RAD, Report, reduce_trajectory
from harness.engines.stepping.support import stuck_below_m_s
from harness.engines.stepping.trajectory import trajectory
from harness.model import Array, Capabilities, Finding, Run, RunOptions, Scene, caution, changes_answer

if TYPE_CHECKING:
    from harness.engines.pybullet.run_phases import RunPhases
    from harness.engines.pybullet.statue import Setup


STEPS_S: Final = (4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4, 1.25e-4)
ON_FLOOR_RAD: Final = (5e-4, 3e-4, 8e-5, 3.5e-5, 1.5e-5, 6e-6, 2e-6)
"""What the levels are expected to err by where the scene is planar and on the floor: at least twice the largest errors of
`python -m tests.measures.pybullet_levels`, as random scenes err by more (docs/engines.md).
"""
ON_PEDESTAL_RAD: Final = (6e-4, 4e-4, 1.5e-4, 5e-5, 4e-5, 2e-5, 5e-6)
"""The same on a pedestal, and"""
ACROSS_RAD: Final = (6e-4, 4e-4, 1.5e-4, 9e-5, 7e-5, 6e-5, 6e-5)
"""for a scan or motion across the plane: the largest errors on a level or a finer one, rounded up."""
RESIDUAL_ALONE: Final = 1e-16
"""Residual without a pedestal, where tighter equations take a tenth more time: with 1e-12 standing feet of a scan sank by 1e-8 m
in a step of 4 ms, which comes to as much as small rocking lifts them, with shorter steps alike."""
TIGHTER: Final = 0.3
"""Residual of a verification run over its level's."""
MOST_ITERATIONS: Final = 1000
"""So many the finest level makes, and"""
MOST_ITERATIONS_ALONE: Final = 300
"""without a pedestal, where these already reach rounding."""
OUT_OF_PLANE_REPORTED_RAD: Final = 1e-3
"""A larger rotation out of the plane is said: a planar model cannot follow it."""


@final
class Bullet3D(Engine):
    """pybullet, in the contract of the harness."""

    name: ClassVar[str] = "pybullet"
    capabilities: ClassVar[Capabilities] = Capabilities(
        dimensions=3,
        uses_mesh=True,
        own_impact=True,
        pedestal_tips=True,
        statue_slips=True,
        flies=True,
        posed_start=True,
        moving_table=True,
        forces=True,
        skips=frozenset({"quiet_start", "quiet_rest", "quiet_end", "base_only", "mirror", "no_history"}),
    )
    order: ClassVar[float] = 1.0
    agreements: ClassVar[int] = 1

    def missing(self) -> str | None:
        """Why pybullet cannot run here, or None."""
        try:
            import pybullet  # noqa: F401
        except ImportError as error:
            return (
                f"pybullet cannot be imported ({error}): it has wheels for CPython up to 3.11 on Linux x86-64 only; "
                "elsewhere it is built from source, or spatial takes its place"
            )
        return None

    def refinement_levels(self, scene: Scene) -> tuple[BulletSettings, ...]:
        """Steps that halve, then the finest one with its equations solved to the end; docs/measured/pybullet_levels.md."""
        expected = ON_FLOOR_RAD if scene.pedestal is None else ON_PEDESTAL_RAD
        *stepped, last = expected if scene.planar else ACROSS_RAD
        alone = scene.pedestal is None
        most_iterations = MOST_ITERATIONS_ALONE if alone else MOST_ITERATIONS
        axes, residual = axes_of(scene), RESIDUAL_ALONE if alone else BulletSettings.residual
        halving = (
            BulletSettings(dt_s, error_rad, residual=residual, axes=axes)
            for dt_s, error_rad in zip(STEPS_S, stepped, strict=True)
        )
        return (*halving, BulletSettings(STEPS_S[-1], last, residual=0.0, iterations=most_iterations, axes=axes))

    def settings_for_dt(self, scene: Scene, dt_s: float) -> Settings:
        """The nearest finer level's settings with the expert's step."""
        # A coarser level's solver would leave more than this step errs by: the next finer one is taken.
        refinement_levels = self.refinement_levels(scene)
        level = next((item for item in refinement_levels if item.dt_s <= dt_s * (1.0 + 1e-9)), refinement_levels[-1])
        return replace(level, dt_s=dt_s, expected_error_rad=level.expected_error_rad * dt_s / level.dt_s)

    def verification_settings(self, scene: Scene, settings: Settings) -> tuple[Settings, ...]:
        """Less than half the step, with the equations of each step solved more tightly; where they are solved to the end (a
        residual of 0), with the bodies in the other order too: before that the order changes how far the solver iterations get,
        not what they seek. It is expected to err by what the finest level does that is no finer.
        """
        level = own_settings(self.name, BulletSettings, settings)
        other = level.reversed_bodies != (level.residual == 0.0)
        tighter = replace(
            level,
            residual=TIGHTER * level.residual,
            iterations=2 * level.iterations,
            reversed_bodies=other,
            event_share=VERIFICATION_EVENT_SHARE,
        )
        verification = replace(tighter, dt_s=VERIFICATION_STEP_SHARE * level.dt_s)
        coarser = (
            item
            for item in self.refinement_levels(scene)
            if item.dt_s >= verification.dt_s and item.residual >= verification.residual
        )
        expected = min((item.expected_error_rad for item in coarser), default=level.expected_error_rad)
        return (replace(verification, expected_error_rad=min(expected, level.expected_error_rad)),)

    def sensitivity_settings(self, scene: Scene, settings: Settings) -> Settings:
        """The same level with Bullet's axes otherwise: what friction does then is Bullet's own."""
        return other_axes(scene, own_settings(self.name, BulletSettings, settings))

    def step_s(self, scene: Scene) -> float:
        """Measured on the shipped scenes: half of a body that mirrors itself, and a statue with all its feet."""
        return 2e-5 if halves(scene) else 2e-4

    def simulate(self, scene: Scene, settings: Settings, options: RunOptions) -> Run:
        """Compute the scene. Raises `EngineFailure` when pybullet cannot finish it."""
        from harness.engines.pybullet import run_phases, statue

        level = own_settings(self.name, BulletSettings, settings)
        if scene.initial.pose is not None and scene.contact.restitution is not None:
            raise EngineFailure(
                "pybullet locates plastic impacts only: a coefficient of restitution is pybullet:plain's"
            )
        begin = time.perf_counter()
        setup = statue.prepare(scene)
        phases = run_phases.run(scene, level, setup, options, self.refinement_levels(scene)[0])
        path = trajectory(scene, phases.record, setup.axes, level.dt_s)
        report = Report(
            engine=self.name,
            settings=level.as_dict(),
            steps=len(phases.record.t_s) - 1 - phases.record.at_rest,
            wall_s=time.perf_counter() - begin,
            resolution_rad=REST_BAND_RAD,
            stuck_below_m_s=stuck_below_m_s(scene, level.dt_s),
            coarser=phases.record.coarser,
            rested=phases.record.rested,
            with_history=options.history or not options.allows("no_history"),
            validity=_validity(path.extra, setup, phases),
            interventions=phases.record.ledger.record(),
            skipped=phases.skipped,
            findings=_findings(scene, setup, phases, path.extra),
            labels=(IMPOSED_LABEL,) if scene.contact.restitution is not None else (),
        )
        return reduce_trajectory(scene, path, report)


def _validity(extra: Mapping[str, Array], setup: Setup, phases: RunPhases) -> dict[str, object]:
    """What three dimensions add to the limits of the planar model."""
    return {
        "statue_across_m": float(np.max(np.abs(extra["statue_y_m"]))),
        "rest_lean_rad": setup.rest.lean_rad,
        "touching_vertices": len(setup.feet_m),
        "mirrored": phases.mirrored,
        "full_shape_from_s": phases.full_from_s,
        "full_shape": None if phases.full is None else phases.full.note,
    }


def _findings(scene: Scene, setup: Setup, phases: RunPhases, extra: Mapping[str, Array]) -> tuple[Finding, ...]:
    found = []
    if phases.full is not None and phases.full.no_parts:
        found.append(caution("hull_for_parts", reason=phases.full.no_parts))
    if not setup.rest.stable:
        found.append(caution("no_stable_face"))
    if setup.rest.lean_rad > 0.0:
        # A rotation that the scene gives is from upright in every model.
        upright_rad = 0.0 if scene.initial.pose is None and scene.initial.theta_rad == 0.0 else None
        found.append(caution("base_not_flat", lean_rad=setup.rest.lean_rad, others_rad=upright_rad))
    across = float(np.max(np.abs(extra["out_of_plane_rad"] - extra["out_of_plane_rad"][0])))
    if scene.planar and across > OUT_OF_PLANE_REPORTED_RAD:
        found.append(changes_answer("left_its_plane", across_rad=across))
    return tuple(found)


# Unmodified pybullet (`pybullet:plain`): bodies, shapes, masses, inertia, coefficients, gravity, step; after the start no body is
# written to.
#
# The steps are all of one length, none is repeated, no place or velocity is set, no contact parameter changes on the way. The
# shapes are what the scene needs: spheres at the vertices that can touch, and where the statue comes to its pedestal's edge its
# full shape from the start. Two coefficients of friction are the one thing that Bullet does not know: the floor's follows the
# pedestal's own velocity (`harness.engines.stepping.support.followed`).


PLAIN_LEVELS: Final = (
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


@final
class PlainBullet3D(Engine):
    """Bullet's own steps, nothing else, in the contract of the harness."""

    name: ClassVar[str] = "pybullet:plain"
    capabilities: ClassVar[Capabilities] = replace(
        Bullet3D.capabilities, moving_table=False, skips=frozenset({"base_only", "no_history", "stop_at_overturn"})
    )
    order: ClassVar[float] = 1.0

    missing = Bullet3D.missing
    sensitivity_settings = Bullet3D.sensitivity_settings

    def refinement_levels(self, scene: Scene) -> tuple[BulletSettings, ...]:
        """Steps of 2 ms to 0.0625 ms."""
        return tuple(_plain_settings(*level) for level in PLAIN_LEVELS)

    def settings_for_dt(self, scene: Scene, dt_s: float) -> BulletSettings:
        """The nearest level's settings with the given step."""
        return _plain_settings(*near(PLAIN_LEVELS, dt_s))

    def verification_settings(self, scene: Scene, settings: Settings) -> tuple[BulletSettings, ...]:
        """Less than half the step, with the bodies added in the other order."""
        own = own_settings(self.name, BulletSettings, settings)
        finer = _plain_settings(VERIFICATION_STEP_SHARE * own.dt_s, VERIFICATION_STEP_SHARE * own.expected_error_rad)
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
        from harness.engines.pybullet import run_phases, statue

        own = own_settings(self.name, BulletSettings, settings)
        refuse_steering(scene, self.name)
        begin = time.perf_counter()
        setup = statue.prepare(scene)
        record, full = run_phases.run_plain(scene, own, setup, options)
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


def _plain_settings(dt_s: float, error_rad: float) -> BulletSettings:
    """One level: the reach of contacts is what a step may lift a foot off its support at `TURNING_RAD_S`, twice over."""
    reach = max(BulletSettings(dt_s, error_rad).reach, 2.0 * (TURNING_RAD_S * dt_s) ** 2)
    return BulletSettings(dt_s, error_rad, events=False, reach=reach, iterations=1000)
