"""The exact rigid body in three dimensions (docs/spatial.md) behind the engine contract: one statue on the floor."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, ClassVar, Final, final

import numpy as np

from harness.engines.base import MOVING_TABLE, RELIABLE_RAD, Engine, EngineFailure, Settings, own_settings, refuse
from harness.engines.stepping.reduce import Report, reduce_trajectory
from harness.engines.stepping.trajectory import Trajectory, apparent_gravity, planar, statue_columns
from harness.model import (
    OVERTURN_RAD,
    SAME_END,
    Array,
    Capabilities,
    Finding,
    Outcome,
    Pose,
    Run,
    RunOptions,
    Scene,
    caution,
    changes_answer,
)

if TYPE_CHECKING:
    from analytic.spatial import Certified, Problem, Solution


LEVELS: Final = ((1e-7, 1e-4), (1e-10, 1e-7), (1e-13, 1e-10))
"""(local error of a step, error of the rotation expected): rocking histories of some ten impacts amplify by up to a thousand."""
BEYOND_RAD: Final = 1e-9
"""By how much a run goes on beyond the overturning rotation, so that a sample lies there."""
STEPS_SHARE: Final = 30.0
"""Steps of a finer level over those of the coarsest, at most: 4 at the median and 20 at the most of some thousand bodies."""
LEAST_STEPS: Final = 5000
LEAST_ROTATION_RAD: Final = 1e-9
"""A rotation below this is rest to the eye that finds half-cycles in a history: far above rounding."""
VERIFICATION_STEP_S: Final = 0.005
BELOW_M: Final = 1e-6
"""What is no foot and further below the floor than this, has come down: far above the rounding of places."""
SAMPLES: Final = 4096
"""Samples looked at together for that: some 20 MB of a scan's outer vertices."""


@dataclass(frozen=True)
class SpatialSettings(Settings):
    """Local error of a step; `dt_s` is the longest step (0: as the error allows)."""

    tolerance: float = LEVELS[-1][0]


@final
class Spatial(Engine):
    """Event-driven integration of a rigid body on its base's vertices with Coulomb friction at each."""

    name: ClassVar[str] = "spatial"
    capabilities: ClassVar[Capabilities] = Capabilities(
        dimensions=3, certifies=True, uses_mesh=True, own_impact=True, statue_slips=True, flies=True, forces=True,
        pedestal=False, posed_start=True, edge_shape="base_vertices",
    )  # fmt: skip
    order: ClassVar[float] = 8.0

    def refinement_levels(self, scene: Scene) -> tuple[SpatialSettings, ...]:
        """Three local errors; the step's length follows from them."""
        return tuple(SpatialSettings(0.0, expected, tolerance) for tolerance, expected in LEVELS)

    def settings_for_dt(self, scene: Scene, dt_s: float) -> SpatialSettings:
        """The finest local error with steps no longer than dt_s."""
        return SpatialSettings(dt_s, LEVELS[-1][1], LEVELS[-1][0])

    def verification_settings(self, scene: Scene, settings: Settings) -> tuple[SpatialSettings, ...]:
        """A hundredth of the local error, and short steps."""
        own = own_settings(self.name, SpatialSettings, settings)
        return (replace(own, tolerance=max(0.01 * own.tolerance, 1e-15)), replace(own, dt_s=VERIFICATION_STEP_S))

    def awaited(self) -> str:
        """What a run in a process of its own is at: its kernel is compiled there first where it is not kept."""
        from analytic.spatial.solver import run_rows

        return "still" if run_rows.is_stored else "compiled first, once after an upgrade"

    def simulate(self, scene: Scene, settings: Settings, options: RunOptions) -> Run:
        """Compute the scene and certify the numbers; raises EngineFailure for what the model does not have."""
        from analytic import AnalyticInputError
        from analytic.spatial.solver import run_rows

        imposed = "a prescribed ratio at impact (contact.restitution; only a body thrown in space bounces)"
        asked = {
            "a pedestal (its statue stands on the floor)": scene.pedestal is not None,
            imposed: scene.contact.restitution is not None and scene.initial.pose is None,
            MOVING_TABLE: scene.table == "moving",
            "a wall": scene.wall is not None,
        }
        refuse(self.name, asked, "pymunk", "pybullet")
        own = own_settings(self.name, SpatialSettings, settings)
        run_rows.loaded()  # compiling is no part of the time of a run
        begin = time.perf_counter()
        try:
            own, certified, unfinished = _answer(scene, own, problem_of(scene), options.stated)
        except AnalyticInputError as error:
            raise EngineFailure(str(error)) from error
        return _run(scene, own, certified, unfinished, options, begin)


def _answer(
    scene: Scene, own: SpatialSettings, problem: Problem, stated: bool
) -> tuple[SpatialSettings, Certified, Sequence[tuple[float, Solution]]]:
    """The answer at the local error asked, else at the finest coarser level whose runs reach their ends, else at a finer one; and
    what did not.

    A run that takes `STEPS_SHARE` times the steps of the coarsest level makes no progress worth them: it is given up.
    """
    from analytic import spatial
    from analytic.spatial.solver import CAP_S

    coarse = spatial.solve(problem, tolerance=LEVELS[0][0], dt_out_s=None, events=False)
    # What is held to short steps takes those of its length too, whatever the coarse run took.
    steps = coarse.work.steps + coarse.work.rejected + scene.duration_s / min(own.dt_s or math.inf, CAP_S)
    most_steps = int(max(LEAST_STEPS, STEPS_SHARE * steps))
    coarser = [each for each in reversed(LEVELS) if each[0] > own.tolerance]
    finer = [each for each in LEVELS if each[0] < own.tolerance]
    tried: list[tuple[SpatialSettings, Certified]] = []
    others = (replace(own, tolerance=local, expected_error_rad=error) for local, error in (*coarser, *finer))
    for settings in (own, *others):
        certified = spatial.certify(
            problem,
            tolerance=settings.tolerance,
            dt_out_s=scene.output_dt_s,
            accuracy=RELIABLE_RAD,
            step_cap_s=own.dt_s or math.inf,
            most_steps=most_steps,
            alone=not stated,
        )
        tried.append((settings, certified))
        if certified.complete:
            break
    else:
        # No level is sure: the finest that ended by itself, if there is one.
        tried = next((tried[: k + 1] for k, (_, each) in enumerate(tried) if not each.solution.gave_up), tried)
    return *tried[-1], [(settings.tolerance, each.solution) for settings, each in tried[:-1]]


def problem_of(scene: Scene) -> Problem:
    """The scene's statue on its feet as the scene begins, or on all its outer points where it is thrown."""
    from analytic import spatial

    statue, pose = scene.statue, scene.initial.pose
    # What is thrown may land on any of its points; what stands touches with its base.
    feet = np.asarray(statue.feet_m, dtype=np.float64) - [0.0, 0.0, statue.centroid_height_m]
    vertices = feet if pose is None else statue.outer_points_m
    start, motion = pose or _leaning(scene, vertices), scene.base_excitation
    return spatial.Problem(
        spatial.Body(statue.mass_kg, statue.inertia_tensor_kg_m2, vertices),
        scene.duration_s,
        scene.contact.statue,
        None,
        motion.x,
        motion.y,
        motion.z,
        gravity_m_s2=scene.gravity_m_s2,
        restitution=scene.contact.restitution or 0.0,
        position_m=start.position_m,
        quaternion_wxyz=start.quaternion_wxyz,
        velocity_m_s=start.velocity_m_s,
        angular_velocity_rad_s=start.angular_velocity_rad_s,
        # No rotation ends what is thrown.
        overturn_rad=OVERTURN_RAD + BEYOND_RAD if pose is None else math.tau,
    )


def _leaning(scene: Scene, vertices: Array) -> Pose:
    """A start in the rocking plane, turned and turning about the lowest vertex."""
    theta, rate = scene.initial.theta_rad, scene.initial.theta_rate_rad_s
    c, s = math.cos(theta), math.sin(theta)
    turned = vertices @ np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]]).T
    # Upright both corners are as low: the rate says about which it turns.
    side = math.copysign(1.0, theta or rate)
    lowest = int(np.argmin(turned[:, 2] - 1e-9 * side * vertices[:, 0]))
    place = np.array([vertices[lowest, 0], 0.0, 0.0]) - turned[lowest] * [1.0, 0.0, 1.0]
    turn = (math.cos(0.5 * theta), 0.0, math.sin(0.5 * theta), 0.0)
    moving = (-rate * turned[lowest, 2], 0.0, rate * turned[lowest, 0])
    return Pose(tuple(place), turn, moving, (0.0, rate, 0.0))


def trajectory_of(scene: Scene, solution: Solution) -> Trajectory:
    """The solution's samples with the columns that every engine of three dimensions records."""
    turn, t_s = solution.rotation, solution.t_s
    spin = np.einsum("tij,tj->ti", turn, solution.angular_velocity_rad_s)
    theta, rate = planar(turn[:, :, 2], spin)
    nothing = np.zeros_like(t_s)
    return Trajectory(
        t_s=t_s,
        theta_rad=theta,
        theta_rate_rad_s=rate,
        slip_m=nothing,
        slip_rate_m_s=nothing,
        gravity_xz_m_s2=apparent_gravity(scene, t_s)[:, [0, 2]],
        statue_xz_m=solution.position_m[:, [0, 2]],
        statue_rate_m_s=solution.velocity_m_s[:, [0, 2]],
        extra={**statue_columns(scene.statue, turn, solution.position_m), "energy_j": _energy_j(scene, solution)},
    )


def _energy_j(scene: Scene, solution: Solution) -> Array:
    """Energy (n,) of all its motions in the table's frame, J, its height counted from the start."""
    statue, spin = scene.statue, solution.angular_velocity_rad_s
    turning = np.einsum("ti,ij,tj->t", spin, statue.inertia_tensor_kg_m2, spin)
    moving = np.sum(solution.velocity_m_s**2, axis=1)
    rise = solution.position_m[:, 2] - solution.position_m[0, 2]
    return np.asarray(0.5 * turning + statue.mass_kg * (0.5 * moving + scene.gravity_m_s2 * rise))


def _findings(certified: Certified, unfinished: Sequence[tuple[float, Solution]]) -> list[Finding]:
    solution, until_s = certified.solution, certified.reliable_until_s
    end_s, steps, several = solution.end_s, solution.work.steps, solution.ambiguous_states
    said = [
        (solution.outcome.value == "friction_paradox", changes_answer("no_consistent_motion", at_s=end_s)),
        (solution.gave_up, changes_answer("run_given_up", at_s=end_s, steps=steps)),
        (several, caution("several_joint_states", count=several)),
        (not certified.outcome_is_sure, changes_answer("outcome_changes_with_steps", outcomes=[])),
        (until_s < end_s * (1.0 - SAME_END), caution("error_not_bounded", until_s=until_s, end_s=end_s)),
    ]
    return [
        *(caution("level_given_up", local_error=e, steps=run.work.steps, at_s=run.end_s) for e, run in unfinished),
        *(finding for holds, finding in said if holds),
    ]


def beyond_base_s(scene: Scene, solution: Solution) -> float | None:
    """When a part of a scan that is no foot is first below the floor, s; None where none is. All of a thrown body touches."""
    solid = scene.statue.solid
    if solid is None or scene.initial.pose is not None:
        return None
    from scipy.spatial import ConvexHull

    points = scene.statue.outer_points_m
    outer, down = points[ConvexHull(points).vertices], solution.rotation[:, 2]
    # What stands as at the sample before has nothing lower.
    moved = np.append(True, (np.diff(down, axis=0) != 0.0).any(axis=1) | (np.diff(solution.position_m[:, 2]) != 0.0))
    chosen = np.flatnonzero(moved)
    for begin in range(0, chosen.size, SAMPLES):
        part = chosen[begin : begin + SAMPLES]
        lowest = solution.position_m[part, 2] + (down[part] @ outer.T).min(axis=1)
        below = np.flatnonzero(lowest < -BELOW_M)
        if below.size:
            return float(solution.t_s[part[below[0]]])
    return None


def outcome_of(solution: Solution, reduced: Outcome) -> Outcome:
    """The run's outcome; one that was given up, or that found no mode, has none."""
    if solution.outcome.value == "friction_paradox":
        return Outcome.FRICTION_PARADOX
    return Outcome.UNDECIDED if solution.gave_up and not reduced.overturned else reduced


def _run(
    scene: Scene,
    own: SpatialSettings,
    certified: Certified,
    unfinished: Sequence[tuple[float, Solution]],
    options: RunOptions,
    begin: float,
) -> Run:
    solution = certified.solution
    plain: dict[str, object] = own.as_dict()
    clear_m = solution.gap_m.min(axis=1)
    report = Report(
        engine=Spatial.name,
        settings=plain,
        steps=solution.work.steps,
        wall_s=0.0,
        resolution_rad=LEAST_ROTATION_RAD,
        stuck_below_m_s=LEAST_ROTATION_RAD,
        with_history=options.history,
        validity={
            "statue_friction_needed": solution.least_friction,
            "energy_residual": solution.energy_residual,
            "momentum_residual": solution.momentum_residual,
            # What is told of a contact engine's run is of its motion in the plane.
            "statue_flight_m": max(float(clear_m.max()), 0.0),
            "penetration_m": max(-float(clear_m.min()), 0.0),
            "energy_gained_j": None,
            "lost_in_impacts_j": solution.energy_lost_at_impacts_j,
            "energy_lost_by_sliding_j": solution.energy_lost_by_sliding_j,
        },
        work={
            "events": solution.work.events,
            "impacts": solution.work.impacts,
            "rejected_steps": solution.work.rejected,
            "ambiguous_states": solution.ambiguous_states,
            "levels_given_up": len(unfinished),
        },
        findings=_findings(certified, unfinished),
    )
    run = reduce_trajectory(scene, trajectory_of(scene, solution), report)
    left_s = beyond_base_s(scene, solution)
    if left_s is not None and left_s < (math.inf if run.no_return_time_s is None else run.no_return_time_s):
        left = {"left_domain_s": left_s, "left_domain_by": "beyond_base"}
        told = changes_answer("left_domain", at_s=left_s, by="beyond_base")
        run = replace(run, validity={**run.validity, **left}, findings=(*run.findings, told))
    return replace(
        run,
        outcome=outcome_of(solution, run.outcome),
        impact_times_s=tuple(event.time_s for event in solution.impacts),
        uplift_times_s=tuple(event.time_s for event in solution.events if event.kind.value == "uplift"),
        numerical_uncertainty_rad=certified.uncertainty_rad if options.stated else None,
        slip_uncertainty_m=certified.place_uncertainty_m if options.stated else None,
        reliable_until_s=certified.reliable_until_s if options.stated else None,
        wall_s=time.perf_counter() - begin,
    )
