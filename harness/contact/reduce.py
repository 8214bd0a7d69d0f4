"""From a contact engine's trajectory to the record of its run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.contact import forces, support
from harness.contact.rocking import patterns, rocking
from harness.contact.trajectory import Trajectory
from harness.history import History, Outcome, hermite, output_grid
from harness.record import Run
from harness.scene import OVERTURN_RAD, Scene

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Report:
    """What the adapter knows of its own run: settings, counts, sentences.

    `resolution_rad` is the rotation that the contact's slop leaves at rest; `stuck_below_m_s` the velocity that is rest.
    `outcome` is given where the adapter itself saw how the run ended (3D: front, back), else None. `rested` says that the run
    was ended at rest before the scene's end, so that the last state holds to it.
    """

    engine: str
    settings: Mapping[str, Any]
    steps: int
    wall_s: float
    resolution_rad: float
    stuck_below_m_s: float
    outcome: Outcome | None = None
    rested: bool = False
    with_history: bool = True
    validity: Mapping[str, Any] = field(default_factory=dict)
    work: Mapping[str, int] = field(default_factory=dict)
    skipped: Sequence[str] = ()
    warnings: Sequence[str] = ()
    labels: Sequence[str] = ()


def reduce_trajectory(scene: Scene, trajectory: Trajectory, report: Report) -> Run:
    """The whole record of a run; a trajectory that is not finite is `diverged`, without a history.

    The run ends at the overturning rotation, the same in every model; the time is interpolated between two samples.
    """
    finite = (
        np.isfinite(trajectory.theta_rad) & np.isfinite(trajectory.theta_rate_rad_s) & np.isfinite(trajectory.slip_m)
    )
    if not np.all(finite):
        return _diverged(report, float(trajectory.t_s[int(np.flatnonzero(~finite)[0])]))
    end_s, overturn_s, kept = _ending(scene, trajectory, report.rested)
    motion = trajectory.until(kept)
    theta, rate = motion.theta_rad, motion.theta_rate_rad_s
    swings = rocking(motion.t_s, theta, rate, report.resolution_rad)
    wall = support.wall_touch(scene, motion)
    inside = motion.t_s <= end_s
    peak = int(np.argmax(np.abs(np.where(inside, theta, 0.0))))
    outcome = report.outcome or _outcome(scene, motion, overturn_s, wall)
    validity, found = _validity(scene, motion)
    validity |= {"impact_ratios": _ratios(swings.rates_before_rad_s, swings.rates_after_rad_s)}
    if wall is not None:
        validity["wall_touch_time_s"] = float(motion.t_s[wall])
    return Run(
        engine=report.engine,
        outcome=outcome,
        history=_history(scene, motion, found, end_s) if report.with_history else None,
        settings=report.settings,
        steps=report.steps,
        wall_s=report.wall_s,
        peak_theta_rad=float(abs(theta[peak])) if overturn_s is None else OVERTURN_RAD,
        peak_time_s=float(motion.t_s[peak]) if overturn_s is None else overturn_s,
        end_s=end_s,
        overturn_time_s=overturn_s,
        no_return_time_s=None if overturn_s is None else no_return_time_s(scene, motion.t_s, theta),
        impact_times_s=tuple(time for time in swings.impact_times_s if time <= end_s),
        uplift_times_s=tuple(time for time in swings.uplift_times_s if time <= end_s),
        peak_slip_m=float(np.max(np.abs(motion.slip_m))),
        residual_slip_m=float(motion.slip_m[-1]),
        patterns=patterns(motion.t_s, theta, motion.slip_rate_m_s, report.resolution_rad, report.stuck_below_m_s),
        validity=validity | dict(report.validity),
        work=report.work,
        skipped=report.skipped,
        warnings=report.warnings,
        labels=report.labels,
    )


def _diverged(report: Report, time_s: float) -> Run:
    message = f"the engine's numbers are not finite from {time_s:.6g} s"
    return Run(
        engine=report.engine,
        outcome=Outcome.DIVERGED,
        history=None,
        settings=report.settings,
        steps=report.steps,
        wall_s=report.wall_s,
        peak_theta_rad=0.0,
        peak_time_s=0.0,
        end_s=time_s,
        message=message,
        warnings=(*report.warnings, message),
        labels=report.labels,
    )


def _ending(scene: Scene, trajectory: Trajectory, rested: bool) -> tuple[float, float | None, int]:
    """End of the run, time of overturning or None, and the number of samples that belong to it."""
    t_s, size = trajectory.t_s, np.abs(trajectory.theta_rad)
    over = np.flatnonzero(size >= OVERTURN_RAD)
    if over.size:
        k = int(over[0])
        if k == 0:
            return float(t_s[0]), float(t_s[0]), 1
        share = (OVERTURN_RAD - size[k - 1]) / (size[k] - size[k - 1])
        time = float(t_s[k - 1] + share * (t_s[k] - t_s[k - 1]))
        if time <= scene.duration_s:
            return time, time, k + 1
    last = scene.duration_s if rested else min(float(t_s[-1]), scene.duration_s)
    count = int(np.searchsorted(t_s, last, side="left")) + 1
    return last, None, min(count, t_s.size)


def no_return_time_s(scene: Scene, t_s: Array, theta_rad: Array) -> float | None:
    """Last outward crossing of α on the side of the fall, interpolated, None when the run starts beyond it."""
    side = 1 if theta_rad[-1] > 0.0 else -1
    limit = scene.statue.slenderness_rad(side)
    lean = side * theta_rad
    inside = np.flatnonzero(lean < limit)
    if inside.size == 0:
        return None
    k = int(inside[-1])
    if k + 1 >= t_s.size:
        return float(t_s[-1])
    share = (limit - lean[k]) / (lean[k + 1] - lean[k])
    return float(t_s[k] + share * (t_s[k + 1] - t_s[k]))


def _outcome(scene: Scene, motion: Trajectory, overturn_s: float | None, wall: int | None) -> Outcome:
    last = float(motion.theta_rad[-1])
    if wall is not None:
        return Outcome.TOUCHES_WALL
    if overturn_s is not None:
        return Outcome.OVERTURNED_RIGHT if last > 0.0 else Outcome.OVERTURNED_LEFT
    if _left_support(scene, motion):
        return Outcome.LEFT_PEDESTAL
    side = 1 if last > 0.0 else -1
    return Outcome.UNDECIDED if abs(last) > scene.statue.slenderness_rad(side) else Outcome.STANDS


def _left_support(scene: Scene, motion: Trajectory) -> bool:
    """Whether the middle of the statue's base ends beside the pedestal's top."""
    if scene.pedestal is None or motion.pedestal_xz_m is None:
        return False
    middle = -scene.pedestal.offset_m + support.statue_slip_m(scene, motion)[-1]
    return bool(abs(middle) > 0.5 * scene.pedestal.width_m)


def _validity(scene: Scene, motion: Trajectory) -> tuple[dict[str, Any], forces.Impulses]:
    found = forces.impulses(scene, motion)
    gap = support.gap_m(scene, motion)
    validity: dict[str, Any] = {
        **forces.force_limits(scene, motion, found),
        "statue_slip_m": float(np.max(np.abs(support.statue_slip_m(scene, motion)))),
        "statue_flight_m": float(max(np.max(gap), 0.0)),
        "penetration_m": float(max(-np.min(gap), 0.0)),
        "energy_gained_j": forces.energy_gained_j(scene, motion),
    }
    if "pedestal_tilt_rad" in motion.extra:
        validity["pedestal_tilt_rad"] = float(np.max(np.abs(motion.extra["pedestal_tilt_rad"])))
    return validity, found


def _ratios(before: Sequence[float], after: Sequence[float]) -> list[float]:
    return [b / a if a != 0.0 else 0.0 for a, b in zip(before, after, strict=True)]


def _history(scene: Scene, motion: Trajectory, found: forces.Impulses, end_s: float) -> History:
    grid = output_grid(end_s, scene.output_dt_s) if end_s > 0.0 else np.zeros(1)
    t_s = motion.t_s
    columns = {
        "statue_slip_m": support.statue_slip_m(scene, motion),
        "energy_j": forces.energy_j(scene, motion),
        **motion.extra,
    }
    extra = {name: np.interp(grid, t_s, values) for name, values in columns.items()}
    pairs = [("statue_force_x_n", found.statue_x), ("statue_force_z_n", found.statue_z)]
    if scene.pedestal is not None:
        pairs += [("floor_force_x_n", found.floor_x), ("floor_force_z_n", found.floor_z)]
    extra |= {name: forces.mean_force(t_s, impulse, grid) for name, impulse in pairs}
    return History(
        grid,
        hermite(grid, t_s, motion.theta_rad, motion.theta_rate_rad_s),
        np.interp(grid, t_s, motion.theta_rate_rad_s),
        hermite(grid, t_s, motion.slip_m, motion.slip_rate_m_s),
        np.interp(grid, t_s, motion.slip_rate_m_s),
        extra,
    )
