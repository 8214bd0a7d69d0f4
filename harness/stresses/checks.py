"""What must hold in any run of a hard scene; every check gives a sentence with its number."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.record import Run
from harness.scene import Scene

Array = NDArray[np.float64]

CREEP_RAD: Final = 1e-6
"""Rotation that a statue at rest may gather (60 s were asked; here in 600 s)."""
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


@dataclass(frozen=True)
class Finding:
    """One check of one run: whether it holds, and the number that says so."""

    name: str
    holds: bool
    sentence: str


Check = Callable[[Scene, Run], Finding]


def barrier_j(scene: Scene) -> float:
    """Energy, J, that lifts the centroid over the nearer corner."""
    s = scene.statue
    corner = min(s.corner_left_m, s.corner_right_m)
    return float(s.mass_kg * scene.gravity_m_s2 * (np.hypot(corner, s.centroid_height_m) - s.centroid_height_m))


def exchanged_j(scene: Scene, run: Run) -> float:
    """Energy, J, that the run exchanges: to lift the centroid over the nearer corner, and what it falls from there."""
    s = scene.statue
    corner = s.corner_m(1 if run.peak_theta_rad > 0.0 else -1)
    beyond = max(abs(run.peak_theta_rad) - float(np.arctan2(corner, s.centroid_height_m)), 0.0)
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


def _frequency_hz(scene: Scene) -> float:
    return float(getattr(scene.shake.x, "frequency_hz", 0.0))


def finite(scene: Scene, run: Run) -> Finding:
    """Every number of the run is finite (a history with another cannot be made)."""
    numbers = [run.peak_theta_rad, run.peak_slip_m, run.end_s]
    good = bool(np.all(np.isfinite(numbers))) and run.history is not None
    return Finding("finite", good, "all numbers finite" if good else f"not finite: {numbers}")


def energy(scene: Scene, run: Run) -> Finding:
    """Contacts add no energy."""
    gained = float(run.validity.get("energy_gained_j") or 0.0)
    share = ENERGY_SHARE + TABLE_STEPS * float(run.settings.get("dt_s") or 0.0) * _frequency_hz(scene)
    beyond = beyond_plane_j(scene, run)
    allowed = max(share * exchanged_j(scene, run), LEAST_ENERGY_J) + beyond
    told = f"contacts add {gained:.1e} J of {allowed:.1e} J allowed"
    if beyond > LEAST_ENERGY_J and beyond > 0.1 * allowed:
        told += f", of which {beyond:.1e} J may come back from motion out of the plane"
    return Finding("energy", gained <= allowed, told)


def depth(scene: Scene, run: Run) -> Finding:
    """No tunnelling: bodies stay within a share of the base's width of each other's surfaces."""
    deep = float(run.validity.get("penetration_m") or 0.0)
    width = scene.statue.corner_left_m + scene.statue.corner_right_m
    return Finding(
        "penetration", deep <= DEPTH_SHARE * width, f"penetration {deep:.1e} m of {DEPTH_SHARE * width:.1e} m"
    )


def creep(scene: Scene, run: Run) -> Finding:
    """At rest nothing drifts: the means of the second and the last tenth are the same, though contacts may tremble."""
    if run.history is None:
        return Finding("creep", False, "no history")
    t_s, end = run.history.t_s, run.end_s
    early, late = (t_s >= 0.1 * end) & (t_s < 0.2 * end), t_s >= 0.9 * end
    turned = _drift(run.history.theta_rad, early, late)
    slid = _drift(run.history.slip_m, early, late)
    trembles = float(np.ptp(run.history.theta_rad[t_s >= 0.1 * end]))
    good = turned <= CREEP_RAD and slid <= CREEP_M and trembles <= TREMBLE_RAD
    sentence = f"creep {turned:.1e} rad, {slid:.1e} m in {end:g} s, trembling {trembles:.1e} rad"
    return Finding("creep", good, sentence)


def _drift(values: Array, early: NDArray[np.bool_], late: NDArray[np.bool_]) -> float:
    return abs(float(np.mean(values[late]) - np.mean(values[early])))


def upright(scene: Scene, run: Run) -> Finding:
    """Below every limit of rest the statue does not rock."""
    peak = abs(run.peak_theta_rad)
    return Finding("upright", peak <= UPRIGHT_RAD, f"largest rotation {peak:.1e} rad")


def ends_at_rest(scene: Scene, run: Run) -> Finding:
    """The rocking has died out."""
    last = abs(float(run.history.theta_rad[-1])) if run.history is not None else float("inf")
    return Finding("rest", last <= REST_RAD, f"last rotation {last:.1e} rad")


BASIC: Final[tuple[Check, ...]] = (finite, energy, depth)
