"""What must hold in any run of a hard scene; every check gives its number and how much is allowed."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.comparison.scores.pointwise import error_rad as difference_rad
from harness.model.history import Array, Outcome
from harness.model.run import Run, number
from harness.model.scene import Scene
from harness.records.bench import Measure

AGREES_RAD: Final = 1e-3
"""Error that is allowed of any scene: the accuracy that a run aims at unless told otherwise."""
AGREES_SHARE: Final = 0.05
"""Share of the exact peak that the error may be, where this is less: else a statue that never moved would agree."""
CREEP_RAD: Final = 1e-6
"""Rotation that a statue at rest may gather in its whole scene, of a minute or of ten."""
CREEP_M: Final = 1e-6
TREMBLE_RAD: Final = 1e-4
"""Range of rotation within which contacts at rest may tremble: a depth of contact over half the base, at 4 ms."""
ENERGY_SHARE: Final = 2e-3
"""Energy that contacts may seem to add, of what the run exchanges: half a step's work of the weight at 1 ms."""
TABLE_STEPS: Final = 2.0
"""Steps of the table's period by which a first-order engine may misplace the table's work."""
LEAST_ENERGY_J: Final = 1e-9
UPRIGHT_RAD: Final = 1e-5
"""Rotation that loads below the limit of rest may cause: what the depths of the two corners' contacts differ by."""
DEPTH_SHARE: Final = 2e-3
"""Greatest penetration, of the base's width: a contact that is held stays a hundred times below it."""
REST_RAD: Final = 2e-4
"""Rotation below which a rocking that has died out counts as rest: what the engines' contact depths can leave."""


Check = Callable[[Scene, Run], list[Measure]]


def within(check: str, value: float, allowed: float, until_s: float | None = None) -> Measure:
    """What was measured, which holds where it is no more than is allowed."""
    return Measure(check, value <= allowed, value, allowed, until_s=until_s)


def all_hold(measures: Iterable[Measure]) -> bool:
    """Whether every check holds."""
    return all(each.holds for each in measures)


def barrier_j(scene: Scene) -> float:
    """Energy, J, that lifts the centroid over the nearer corner."""
    s = scene.statue
    corner = min(s.corner_left_m, s.corner_right_m)
    return float(s.mass_kg * scene.gravity_m_s2 * (np.hypot(corner, s.centroid_height_m) - s.centroid_height_m))


def exchanged_j(scene: Scene, run: Run) -> float:
    """Energy, J, that the run exchanges: to lift the centroid over the nearer corner, and what it falls from there."""
    s = scene.statue
    # A largest rotation has no side; only of a fall is what lies beyond the balance angle much.
    corner = s.corner_m(-1 if run.outcome is Outcome.OVERTURNED_LEFT else 1)
    beyond = max(run.peak_theta_rad - float(np.arctan2(corner, s.centroid_height_m)), 0.0)
    fallen = float(np.hypot(corner, s.centroid_height_m)) * (1.0 - float(np.cos(beyond)))
    return barrier_j(scene) + s.mass_kg * scene.gravity_m_s2 * fallen


def beyond_plane_j(scene: Scene, run: Run) -> float:
    """Largest kinetic energy, J, of motion out of the rocking plane, which the energy of the planar motion does not hold."""
    if run.history is None or "yaw_rad" not in run.history.extra or run.history.t_s.size < 3:
        return 0.0
    extra, t_s = run.history.extra, run.history.t_s
    roll, yaw, across = (np.gradient(extra[name], t_s) for name in ("roll_rad", "yaw_rad", "statue_y_m"))
    tensor, mass = scene.statue.inertia_tensor_kg_m2, scene.statue.mass_kg
    return float(np.max(0.5 * (tensor[0, 0] * roll**2 + tensor[2, 2] * yaw**2 + mass * across**2)))


def finite(scene: Scene, run: Run) -> list[Measure]:
    """Every number of the run is finite (a history with another cannot be made)."""
    numbers = [run.peak_theta_rad, run.peak_slip_m, run.end_s]
    return [Measure("finite", bool(np.all(np.isfinite(numbers))) and run.history is not None)]


def energy(scene: Scene, run: Run) -> list[Measure]:
    """Contacts add no energy but what comes back from motion out of the plane."""
    gained = number(run.validity, "energy_gained_j", 0.0)
    frequency_hz = float(getattr(scene.base_excitation.x, "frequency_hz", 0.0))
    share = ENERGY_SHARE + TABLE_STEPS * number(run.settings, "dt_s", 0.0) * frequency_hz
    allowed = max(share * exchanged_j(scene, run), LEAST_ENERGY_J) + beyond_plane_j(scene, run)
    return [within("energy_gained_j", gained, allowed)]


def depth(scene: Scene, run: Run) -> list[Measure]:
    """No tunnelling: bodies stay within a share of the base's width of each other's surfaces, where a model has such a depth."""
    if "penetration_m" not in run.validity:
        return []
    width_m = scene.statue.corner_left_m + scene.statue.corner_right_m
    return [within("penetration_m", number(run.validity, "penetration_m"), DEPTH_SHARE * width_m)]


def creep(scene: Scene, run: Run, share: float = 1.0) -> list[Measure]:
    """At rest nothing drifts: the means of the second and the last tenth are the same, though contacts may tremble.

    `share` of the scene's time is what was run: so much of the drift is allowed.
    """
    if run.history is None:
        return [Measure("finite", holds=False)]
    t_s, end = run.history.t_s, run.end_s
    early, late = (t_s >= 0.1 * end) & (t_s < 0.2 * end), t_s >= 0.9 * end
    return [
        within("creep_rad", _drift(run.history.theta_rad, early, late), share * CREEP_RAD),
        within("creep_m", _drift(run.history.slip_m, early, late), share * CREEP_M),
        within("tremble_rad", float(np.ptp(run.history.theta_rad[t_s >= 0.1 * end])), TREMBLE_RAD),
    ]


def _drift(values: Array, early: NDArray[np.bool_], late: NDArray[np.bool_]) -> float:
    return abs(float(np.mean(values[late]) - np.mean(values[early])))


def holds_until_s(exact: Run) -> float:
    """Until when the analytic solution is sure and the two-block model inside its domain, s."""
    return min(exact.bounded_until_s, number(exact.validity, "left_domain_s", exact.end_s))


def error_rad(run: Run, exact: Run, until_s: float = math.inf) -> float:
    """Largest difference from the exact rotation, rad, while that holds; infinite without numbers to compare."""
    if run.history is None or exact.history is None or not np.all(np.isfinite(run.history.theta_rad)):
        return math.inf
    return difference_rad(run, exact, min(holds_until_s(exact), until_s))


def allowed_rad(exact: Run) -> float:
    """Error that a scene allows, rad: a share of what there is to see, above what the depths of contacts leave."""
    return max(min(AGREES_RAD, AGREES_SHARE * abs(exact.peak_theta_rad)), UPRIGHT_RAD)


def agrees(scene: Scene, run: Run, exact: Run) -> list[Measure]:
    """The rotation is the exact one, and on a pedestal its slip too, while the two-block model holds."""
    until_s = holds_until_s(exact)
    told_s = until_s if until_s < 0.99 * exact.end_s else None
    found = [within("error_rad", error_rad(run, exact), allowed_rad(exact), told_s)]
    if scene.pedestal is not None and run.history is not None and exact.history is not None:
        t_s = run.history.t_s[run.history.t_s <= until_s]
        slip = np.interp(t_s, exact.history.t_s, exact.history.slip_m)
        slid_m = float(np.max(np.abs(run.history.slip_m[: t_s.size] - slip)))
        found.append(within("slip_error_m", slid_m, AGREES_SHARE * exact.peak_slip_m + CREEP_M, told_s))
    return found


def upright(scene: Scene, run: Run) -> list[Measure]:
    """Below every limit of rest the statue does not rock."""
    return [within("largest_rotation_rad", abs(run.peak_theta_rad), UPRIGHT_RAD)]


def ends_at_rest(scene: Scene, run: Run) -> list[Measure]:
    """The rocking has died out."""
    last = abs(float(run.history.theta_rad[-1])) if run.history is not None else math.inf
    return [within("last_rotation_rad", last, REST_RAD)]


BASIC: Final[tuple[Check, ...]] = (finite, energy, depth)
