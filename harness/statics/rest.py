"""What a statue at rest bears: the floor's acceleration below which nothing can move, and when a motion passes it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Self

import numpy as np
from numpy.typing import NDArray

from analytic.excitation import Excitation, ZeroExcitation
from harness.model.history import Array
from harness.model.scene import Scene, Statue
from harness.statics.push import tipping_of_pedestal
from meshes.footprint import margin_m, outward_sides

LEVEL_M: Final = 1e-9
"""Feet within this height of each other are level: what is left is rounding."""
WINDOW: Final = 256
"""Samples looked at together: the first that moves a statue at rest mostly comes soon."""


def limit_of_rest_m_s2(scene: Scene) -> float:
    """Horizontal acceleration, in whatever direction, below which nothing can move while the floor moves horizontally only.

    The least of uplift, g b / h with b the distance of the base's nearest edge (of its two corners when the motion stays in the
    plane), and, on a pedestal, slip, μ_s g (docs/model.md, section 2).
    """
    statue, gravity = scene.statue, scene.gravity_m_s2
    corner = min(statue.corner_left_m, statue.corner_right_m)
    if not isinstance(scene.base_excitation.y, ZeroExcitation):
        corner = min(corner, margin_m(statue.footprint_m))
    uplift = gravity * corner / statue.centroid_height_m
    return min(uplift, _holding_friction(scene) * gravity)


def _holding_friction(scene: Scene) -> float:
    """The least coefficient of static friction between statue and floor."""
    contact = scene.contact
    return contact.statue if scene.pedestal is None else min(contact.floor_static, contact.statue)


@dataclass(frozen=True, eq=False)
class LimitsOfRest:
    """A statue at rest on its lowest vertices `polygon_m` (k, 2) under records: their accelerations (n, 3) at all their samples.

    Between two samples a record is linear, so that what both bear is borne between them too.
    """

    scene: Scene
    polygon_m: Array
    times_s: Array
    accel_m_s2: Array

    @classmethod
    def of(cls, scene: Scene) -> Self | None:
        """None where a component is a formula, or the statue tilts off its lowest vertices: nothing is known of rest then."""
        components = (scene.base_excitation.x, scene.base_excitation.y, scene.base_excitation.z)
        times = _knots(components, scene.duration_s)
        polygon = None if times is None else resting_polygon_m(scene.statue)
        if times is None or polygon is None:
            return None
        accel = np.stack([np.asarray(item.accel_m_s2(times), dtype=np.float64) for item in components], axis=1)
        return cls(scene, polygon, times, accel)

    def until_s(self, t_s: float, yaw_rad: float = 0.0) -> float:
        """A time up to which a statue at rest at `t_s`, turned about the vertical, stays so: the last sample before the first
        that moves it; the scene's duration where none does.
        """
        first = max(int(np.searchsorted(self.times_s, t_s, side="right")) - 1, 0)
        if not self.accel_m_s2[first:].any():
            return self.scene.duration_s
        for begin in range(first, self.times_s.size, WINDOW):
            passed = np.flatnonzero(self._moves(self.accel_m_s2[begin : begin + WINDOW], yaw_rad))
            if passed.size:
                return max(float(self.times_s[max(begin + int(passed[0]) - 1, 0)]), t_s)
        return self.scene.duration_s

    def _moves(self, accel_m_s2: Array, yaw_rad: float) -> NDArray[np.bool_]:
        """At which samples the floor's acceleration passes what friction holds or what the base bears, statue or pedestal.

        A base bears it while the weight's line, leant by the acceleration, meets the floor inside the polygon that it rests on.
        A planar body bears at least as much: its ends are the polygon's outermost points.
        """
        scene, statue = self.scene, self.scene.statue
        weight = np.maximum(scene.gravity_m_s2 - np.abs(accel_m_s2[:, 2]), 0.0)
        push = -accel_m_s2[:, :2]
        slips = np.hypot(push[:, 0], push[:, 1]) >= _holding_friction(scene) * weight
        # What pushes, in the frame of a statue that has turned.
        cosine, sine = math.cos(yaw_rad), math.sin(yaw_rad)
        turned = push @ np.array([[cosine, -sine], [sine, cosine]])
        normals, reach = outward_sides(self.polygon_m)
        moves: NDArray[np.bool_] = slips | np.any(
            statue.centroid_height_m * turned @ normals.T >= reach * weight[:, None], axis=1
        )
        if scene.pedestal is not None:
            sides = tipping_of_pedestal(statue.mass_kg, statue.centroid_height_m, statue.base_centre_m, scene.pedestal)
            for (axis, direction), share in sides.items():
                moves |= direction * push[:, axis] >= share * weight
        return moves


def first_motion_s(scene: Scene) -> float:
    """A time before which nothing can move, from the samples' own values (0 when the statue starts off rest).

    A body with a rough base rests on its lowest vertices, which lie nearer than its corners; where its centroid is not above
    them it tilts at once: 0 too.

    For piecewise linear records the time is the last sample before a limit is first exceeded; for formulas it is 0.
    """
    limits = LimitsOfRest.of(scene) if scene.initial.still else None
    return 0.0 if limits is None else limits.until_s(0.0)


def resting_polygon_m(statue: Statue) -> Array | None:
    """The polygon (k, 2), counter-clockwise, of the lowest vertices, which the statue rests on; None where it tilts off it."""
    from meshes import MeshError
    from meshes.footprint import footprint

    try:
        polygon = footprint(statue.feet_m, LEVEL_M)
    except MeshError:  # fewer than three vertices, or all on a line
        return None
    return polygon[:, :2] if margin_m(polygon) > 0.0 else None


def _knots(components: Sequence[Excitation], duration_s: float) -> Array | None:
    """All sample times of records, or None when a component is a formula (its extremes lie between knots)."""
    knots = [np.zeros(1)]
    for item in components:
        if isinstance(item, ZeroExcitation):
            continue
        samples = getattr(item, "t_s", None)
        if samples is None:
            return None
        knots.append(np.asarray(samples))
    return np.unique(np.clip(np.concatenate(knots), 0.0, duration_s))
