"""The corner that stands: where it is, and how it is kept at the depth at which contacts last.

A step moves a turning body along the tangent of its corner's circle, ω² h dt²/2 off the support. A contact that is lost so for
one step lets the statue fall freely and comes back as a blow: an impact met in such a step has the wrong ratio, by up to a tenth.
"""

from __future__ import annotations

import math
from typing import Final

from harness.engines.munk2d import native
from harness.engines.munk2d.drive import Drive

UPRIGHT_RAD: Final = 1e-6
"""Below this rotation both corners stand."""
LEANING_RAD: Final = 2.0
"""Beyond this rotation no corner stands any more."""
SLOW_STEPS: Final = 10.0
"""A rate that gravity changes in so many steps takes a corner nowhere. Held up in each of them, a statue that comes to rest in
swings of a few steps would rock for ever."""
RISES: Final = 4.0
"""A corner that goes this many times as far as its circle takes it, and its depth, lifts off: it is left alone."""


class Standing:
    """Asked before a step: brings the standing corner to its depth where the step will take it.

    Both corners of a flat base count from the centroid: `left_m` and `right_m` along it, `height_m` above it.
    """

    def __init__(self, drive: Drive) -> None:
        world, statue = drive.world, drive.scene.statue
        self.statue, self.floor = native.body_of(world.statue), native.body_of(world.floor)
        self.pedestal = None if world.pedestal is None else native.body_of(world.pedestal)
        self.left_m, self.right_m, self.height_m = (
            -statue.corner_left_m,
            statue.corner_right_m,
            statue.centroid_height_m,
        )
        self.depth_m, self.slop_m = drive.settings.depth_m, drive.settings.slop_m
        self.half_m = 0.0 if drive.scene.pedestal is None else 0.5 * drive.scene.pedestal.height_m
        self.moving = drive.moving
        arms = ((statue.corner_m(side), drive.scene.pivot_inertia_kg_m2[side]) for side in (-1, 1))
        fall = max(statue.mass_kg * drive.scene.gravity_m_s2 * arm / inertia for arm, inertia in arms)
        self.slow_rad_s = SLOW_STEPS * fall * drive.settings.dt_s

    def support(self, length_s: float = 0.0) -> float:
        """Height of what the statue stands on, m, after a further move of `length_s`."""
        below = self.pedestal
        if below is None:
            if not self.moving:
                return 0.0
            below = self.floor
        return float(native.get_place(below).y + native.get_velocity(below).y * length_s + self.half_m)

    def gap(self, side: int) -> tuple[float, float]:
        """Height of a corner (+1 right, −1 left) over its support, m, and its rate, m/s."""
        angle, spin = native.get_angle(self.statue), native.get_spin(self.statue)
        x, z = self.right_m if side > 0 else self.left_m, -self.height_m
        cos, sin = math.cos(angle), math.sin(angle)
        rise = 0.0
        if self.pedestal is not None:
            rise = native.get_velocity(self.pedestal).y
        elif self.moving:
            rise = native.get_velocity(self.floor).y
        height = native.get_place(self.statue).y + x * sin + z * cos - self.support()
        return float(height), float(native.get_velocity(self.statue).y + spin * (x * cos - z * sin) - rise)

    def keep(self, length_s: float, support_m: float | None = None) -> None:
        """Place the statue so that a move of `length_s` takes its standing corner to its depth.

        `support_m`: the support's height after that move, where the table's own motion gives it.
        """
        body = self.statue
        spin = native.get_spin(body)
        if -self.slow_rad_s < spin < self.slow_rad_s:
            return
        angle = native.get_angle(body) + spin * length_s
        if not (UPRIGHT_RAD < abs(angle) < LEANING_RAD):
            return
        x = self.left_m if angle > 0.0 else self.right_m
        place = native.get_place(body)
        top = self.support(length_s) if support_m is None else support_m
        height = place.y + native.get_velocity(body).y * length_s
        excess = height + x * math.sin(angle) - self.height_m * math.cos(angle) - top + self.depth_m
        turn = spin * length_s
        if -self.slop_m < excess < RISES * (self.depth_m + self.height_m * turn * turn):
            native.set_place(body, (place.x, place.y - excess))
