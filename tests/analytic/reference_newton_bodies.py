"""Reference B, the physics: Newton-Euler balance of the two bodies.

Nothing is shared with reference A but the statement of the problem: every acceleration and every reaction comes from one
linear system per instant (three balances of the statue, two of the pedestal, two of the pivot's kinematics, one
friction law), every impact from the same balances in impulses, and states are judged by their reactions.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgesv

from tests.analytic.reference_case import Case

Array = NDArray[np.float64]


def solved(a: Array, b: Array) -> Array:
    """x of a x = b, as `numpy.linalg.solve` has it, whose checks take longer than so small a system."""
    _, _, x, singular = dgesv(a, b)
    if singular:
        raise np.linalg.LinAlgError("singular balances")
    return x


@dataclass(frozen=True)
class Reactions:
    """Accelerations and reactions at one instant (clockwise rotation positive; N)."""

    theta_dd: float
    u_dd: float
    vertical_left: float
    vertical_right: float
    friction: float
    normal: float
    balances: Array
    """The matrix (9, 9) of the balances, its last row the law of friction."""
    kinetic: bool
    """Whether friction follows the force that presses."""

    @property
    def regularity(self) -> float:
        """Determinant over that without friction: where it vanishes, friction leaves no solution."""
        if not self.kinetic:
            return 1.0
        smooth = self.balances.copy()
        smooth[8] = 0.0
        smooth[8, 7] = 1.0
        return float(np.linalg.det(self.balances) / np.linalg.det(smooth))

    @property
    def vertical(self) -> float:
        """What the statue presses on its support."""
        return self.vertical_left + self.vertical_right


class Bodies:
    """Balances of one case."""

    def __init__(self, case: Case) -> None:
        self.case = case
        self.m1 = case.pedestal_kg or 0.0
        self.slides = case.pedestal_kg is not None

    def reactions(self, mode: tuple[int, int], theta: float, omega: float, ax: float, az: float) -> Reactions:
        """Solve for (ẍ, z̈, θ̈, ü, H, V_left, V_right, F, N)."""
        k, (side, slide) = self.case, mode
        sin, cos = math.sin(theta), math.cos(theta)
        arms = [(c * cos - k.h * sin, -c * sin - k.h * cos) for c in (-k.b_left, k.b_right)]  # corner from centroid
        pivot = arms[0] if side < 0 else arms[1]
        a = np.zeros((9, 9))
        b = np.zeros(9)
        a[0, 0], a[0, 4] = k.m2, -1.0
        a[1, 1], a[1, 5], a[1, 6], b[1] = k.m2, -1.0, -1.0, -k.m2 * k.gravity
        a[2, 2], a[2, 4], a[2, 5], a[2, 6] = k.inertia, -pivot[1], arms[0][0], arms[1][0]
        a[3, 3], a[3, 4], a[3, 7], b[3] = self.m1, 1.0, -1.0, -self.m1 * ax
        a[4, 8], a[4, 5], a[4, 6], b[4] = 1.0, -1.0, -1.0, self.m1 * (k.gravity + az)
        a[5, 0], a[5, 2], a[5, 3], b[5] = 1.0, pivot[1], -1.0, ax + omega**2 * pivot[0]
        a[6, 1], a[6, 2], b[6] = 1.0, -pivot[0], az + omega**2 * pivot[1]
        if side == 0:
            a[7, 2] = 1.0  # both corners press, no rotation
        else:
            a[7, 5 if side > 0 else 6] = 1.0  # the lifted corner carries nothing
        self._friction_law(a[8], b, slide, az)
        x = solved(a, b)
        kinetic = bool(side and slide and k.normal == "dynamic")
        return Reactions(x[2], x[3], x[5], x[6], x[7], x[8], a, kinetic)

    def outer(self, side: int) -> bool:
        """Whether nothing follows the corner on that side."""
        return self.case.gap(side) == math.inf

    def lean(self, side: int) -> float:
        """Rotation at which the centroid stands above the corner."""
        return math.atan2(self.case.b_right if side > 0 else self.case.b_left, self.case.h)

    def carried(self, r: Reactions, side: int, y: Array) -> float:
        """What must press for the model to hold: in a fall beyond the balance point a lost corner is part of it."""
        if self.outer(side) and side * y[0] > self.lean(side) and side * y[1] > 0.0:
            return r.normal if self.slides else math.inf
        return min(r.vertical, r.normal)

    def _friction_law(self, row: Array, b: Array, slide: int, az: float) -> None:
        k = self.case
        if slide == 0:
            row[3] = 1.0
        elif k.normal == "dynamic":
            row[7], row[8] = 1.0, slide * k.mu_kinetic
        else:
            row[7], b[8] = 1.0, -slide * k.mu_kinetic * (self.m1 + k.m2) * (k.gravity + az)

    def margins(self, mode: tuple[int, int], y: Array, ax: float, az: float) -> dict[str, float]:
        """What must stay positive while the mode lasts."""
        k, (side, slide) = self.case, mode
        r = self.reactions(mode, y[0], y[1], ax, az)
        found = {"lift_off": self.carried(r, side, y)}
        if k.wall is not None and (side or slide):
            found["touches_wall"] = k.before_wall(side, y[0], y[2])
        if side:
            found |= {"impact": side * y[0], "friction_paradox": r.regularity}
            found["balance"] = self.lean(side) - side * y[0]
            if self.outer(side):
                found["overturned"] = k.overturn - side * (k.tilt + y[0])
            else:
                found["roll"] = k.gap(side) - side * y[0]
        else:
            found |= {"uplift_right": r.vertical_left, "uplift_left": r.vertical_right}
        if self.slides and slide:
            found["halt"] = slide * y[3]
        elif self.slides:
            reserve = k.mu_static * self.pressing(r, az)
            found |= {"slip_forward": reserve + r.friction, "slip_backward": reserve - r.friction}
        return found

    def pressing(self, r: Reactions, az: float) -> float:
        """The normal force that limits friction."""
        k = self.case
        return r.normal if k.normal == "dynamic" else (self.m1 + k.m2) * (k.gravity + az)

    def candidates(self, y: Array, ax: float, az: float, spent: str) -> tuple[list[tuple[int, int]], str]:
        """Modes whose reactions and accelerations are consistent with contact and friction, sticking ones first, and the
        ending where none is."""
        k = self.case
        pair = y[0] or y[1]
        tilts = (0, 1, -1) if not pair else (1,) if pair > 0 else (-1,)
        slips = (0, 1, -1) if not y[3] else (1,) if y[3] > 0 else (-1,)
        if spent.startswith("slip"):  # its direction is known, and its acceleration may start at zero
            slips = (1,) if spent == "slip_forward" else (-1,)
        found: list[tuple[int, int]] = []
        ending = ""
        for slide in slips if self.slides else (0,):
            for side in tilts:
                r = self.reactions((side, slide), y[0], y[1], ax, az)
                if r.regularity <= 0.0:
                    ending = "friction_paradox"
                    continue
                if self.carried(r, side, y) <= 0.0:
                    ending = ending or "lift_off"
                    continue
                contact = (
                    min(r.vertical_left, r.vertical_right) >= 0.0
                    if side == 0
                    else bool(pair) or side * r.theta_dd > 0.0
                )
                if not self.slides:
                    grip = True
                elif slide == 0:
                    grip = abs(r.friction) <= k.mu_static * self.pressing(r, az)
                else:
                    grip = bool(y[3]) or spent.startswith("slip") or slide * r.u_dd > 0.0
                if contact and grip:
                    found.append((side, slide))
        return found, ending

    def impact(self, side: int, y: Array, stuck: bool) -> tuple[float, float]:
        """(θ̇⁺, u̇⁺): first the new corner alone, then both corners if the rotation would have to reverse."""
        rate, v = self._impact(side, y, stuck, hold_both=False)
        if rate * y[1] > 0.0:
            return rate, v
        return 0.0, self._impact(side, y, stuck, hold_both=True)[1]

    def _impact(self, side: int, y: Array, stuck: bool, *, hold_both: bool) -> tuple[float, float]:
        """Solve for (ẋ⁺, ż⁺, θ̇⁺, u̇⁺, I_x, I_new, I_old, P_f, P_n) of the statue's and the pedestal's momenta."""
        k = self.case
        old, new = (k.b_right, -k.b_left) if side > 0 else (-k.b_left, k.b_right)
        omega, v = float(y[1]), float(y[3])
        x_before, z_before = v + k.h * omega, old * omega  # of the centroid, turning about the old corner
        a = np.zeros((9, 9))
        b = np.zeros(9)
        a[0, 0], a[0, 4], b[0] = k.m2, -1.0, k.m2 * x_before
        a[1, 1], a[1, 5], a[1, 6], b[1] = k.m2, -1.0, -1.0, k.m2 * z_before
        a[2, 2], a[2, 4], a[2, 5], a[2, 6], b[2] = k.inertia, k.h, new, old, k.inertia * omega
        a[3, 3], a[3, 4], a[3, 7], b[3] = self.m1, 1.0, -1.0, self.m1 * v
        a[4, 8], a[4, 5], a[4, 6] = 1.0, -1.0, -1.0
        a[5, 0], a[5, 2], a[5, 3] = 1.0, -k.h, -1.0
        a[6, 1], a[6, 2] = 1.0, -new
        if hold_both:
            a[7, 2] = 1.0
        elif k.ratio is None:
            a[7, 6] = 1.0
        else:
            a[7, 2], b[7] = 1.0, k.ratio * omega
            a[2] = 0.0  # the prescribed ratio replaces the balance about the new corner
            a[2, 6], b[2] = 1.0, 0.0
        return self._floor_impulse(a, b, v, stuck)

    def _floor_impulse(self, a: Array, b: Array, v: float, stuck: bool) -> tuple[float, float]:
        k = self.case
        if not self.slides or k.pedestal_at_impact == "unchanged":
            kept = v if self.slides else 0.0
            a[8, 3], b[8] = 1.0, kept
            return float(solved(a, b)[2]), kept
        a[8, 3] = 1.0
        x = solved(a, b)
        if abs(x[7]) <= (k.mu_static if stuck else k.mu_kinetic) * x[8]:
            return float(x[2]), 0.0
        found = []
        for sign in (1.0, -1.0):
            a[8] = 0.0
            a[8, 7], a[8, 8] = 1.0, sign * (k.mu_impact if stuck and k.mu_impact is not None else k.mu_kinetic)
            x = solved(a, b)
            if sign * x[3] > 0.0:
                found.append((float(x[2]), float(x[3])))
        if len(found) != 1:
            raise AssertionError(f"{len(found)} sliding directions after the impact")
        return found[0]
