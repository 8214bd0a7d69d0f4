"""The model's impact map on both bodies, to be imposed in a contact engine (docs/model.md, sections 3 and 4)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from harness.model.scene import Scene

IMPOSED_LABEL: Final = "impact law imposed"
"""Label of a run whose impacts are the model's: it tests the motion between impacts, not the impact."""


@dataclass(frozen=True)
class Impact:
    """State after an impact: rates, and the floor's impulses."""

    theta_rate_rad_s: float
    slip_rate_m_s: float
    normal_n_s: float
    friction_n_s: float


def impact(scene: Scene, *, old_side: int, theta_rate_rad_s: float, slip_rate_m_s: float, stuck: bool) -> Impact:
    """Rates after the statue, rocking about the corner `old_side` (+1 right, −1 left), meets its support.

    With `scene.contact.restitution` a number that ratio is prescribed, else angular momentum about the new corner is kept.
    Without a pedestal the support is held. `stuck` is the pedestal's state before the impact (docs/model.md, section 3).
    """
    statue, pedestal = scene.statue, scene.pedestal
    m, h = statue.mass_kg, statue.centroid_height_m
    old, new = statue.corner_m(old_side), statue.corner_m(-old_side)
    j_new = statue.inertia_kg_m2 + m * (h * h + new * new)
    j_cross = statue.inertia_kg_m2 + m * (h * h - old * new)
    ratio = scene.contact.restitution
    held = ratio if ratio is not None else j_cross / j_new
    rate, slip = theta_rate_rad_s, slip_rate_m_s
    if pedestal is None or scene.form.pedestal_at_impact == "unchanged":
        after = held * rate
        both = held < 0.0
        after = 0.0 if both else after
        normal = m * ((0.0 if both else new * abs(after)) + old * abs(rate))
        return Impact(after, slip, normal, 0.0)
    total = m + pedestal.mass_kg
    limit = scene.contact.floor_static if stuck else scene.contact.floor_kinetic
    slides = scene.contact.at_impact if stuck else scene.contact.floor_kinetic

    # The pedestal is held: the friction impulse that this takes must be within the limit.
    after = ratio * rate if ratio is not None else (j_cross * rate + m * h * slip) / j_new
    normal = m * (new * abs(after) + old * abs(rate))
    friction = m * h * (after - rate) - total * slip
    if after * rate >= 0.0 and abs(friction) <= limit * normal:
        return Impact(after, 0.0, normal, friction)
    for sign in (1, -1):
        jump = _sliding(sign, rate, slip, (m, h, old, new, total, slides), (j_new, j_cross, ratio))
        if jump is not None:
            return jump
    return _both_corners(rate, slip, (m, h, old, total), limit, slides)


def _sliding(
    sign: int,
    rate: float,
    slip: float,
    body: tuple[float, float, float, float, float, float],
    law: tuple[float, float, float | None],
) -> Impact | None:
    """Solve the impact with P_f = −μ_k P_n·sign; None where the solution contradicts its own signs."""
    m, h, old, new, total, kinetic = body
    j_new, j_cross, ratio = law
    turn = 1.0 if rate > 0.0 else -1.0
    # total·(u⁺ − u⁻) + m h (w⁺ − w⁻) = −μ_k·sign·m(new·w⁺ + old·w⁻)·turn, where w⁺ keeps the sign of w⁻.
    drag = kinetic * sign * turn * m
    if ratio is not None:
        after = ratio * rate
    else:
        # j_new w⁺ + m h u⁺ = j_cross w⁻ + m h u⁻, with u⁺ − u⁻ from the line above.
        slope = -(m * h + drag * new) / total
        gained = (m * h - drag * old) * rate / total
        denominator = j_new + m * h * slope
        if denominator <= 0.0:
            return None
        after = (j_cross * rate - m * h * gained) / denominator
    slip_after = slip + (m * h * (rate - after) - drag * (new * after + old * rate)) / total
    if after * turn < 0.0 or slip_after * sign <= 0.0:
        return None
    normal = m * (new * abs(after) + old * abs(rate))
    return Impact(after, slip_after, normal, -kinetic * normal * sign)


def _both_corners(
    rate: float, slip: float, body: tuple[float, float, float, float], limit: float, kinetic: float
) -> Impact:
    """Both corners hold: the rotation ends, the pedestal takes the horizontal momentum."""
    m, h, old, total = body
    normal = m * old * abs(rate)
    free = slip + m * h * rate / total
    needed = -total * free
    if abs(needed) <= limit * normal:
        return Impact(0.0, 0.0, normal, needed)
    sign = 1.0 if free > 0.0 else -1.0
    slip_after = free - kinetic * normal * sign / total
    if slip_after * sign < 0.0:
        return Impact(0.0, 0.0, normal, needed)
    return Impact(0.0, slip_after, normal, -kinetic * normal * sign)
