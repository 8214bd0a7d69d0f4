"""The model's impact in place of the engine's own, for a scene that prescribes a ratio."""

from __future__ import annotations

import math

from harness.engines.stepping.impact import impact
from harness.engines.stepping.rows import Row, bodies
from harness.engines.stepping.stepper import Stepper
from harness.model.scene import Scene


def impose(stepper: Stepper, scene: Scene, row: Row, lean_rad: float) -> Row:
    """Put both bodies upright with the velocities after the model's impact; `lean_rad` is what little is left to fall."""
    # It came down from the side against which it turns, whether or not the last digits of the lean have passed zero.
    was, statue, side = row, scene.statue, 1 if row[11] < 0.0 else -1
    body, pedestal = bodies(row)
    table_x, table_y = stepper.table_rate[0], stepper.table_rate[1]
    slip = 0.0 if pedestal is None else pedestal.velocity_m_s[0] - table_x
    jump = impact(scene, old_side=side, theta_rate_rad_s=row[11], slip_rate_m_s=slip, stuck=stepper.stuck)
    rate, base = jump.theta_rate_rad_s, jump.slip_rate_m_s + table_x
    # The old corner stays where it stands; the centroid comes to lie over the base again.
    old, new = side * statue.corner_m(side), -side * statue.corner_m(-side)
    shift = old * math.cos(lean_rad) - statue.centroid_height_m * math.sin(lean_rad) - old
    top = 0.0
    if pedestal is not None and scene.pedestal is not None:
        top = pedestal.place_m[2] + 0.5 * scene.pedestal.height_m
        stepper.set_sliding(jump.slip_rate_m_s != 0.0)
        row = (*row[:20], base, table_y, 0.0, 0.0, 0.0, 0.0)
    height = top - stepper.backend.depth_m + statue.centroid_height_m
    place = (body.place_m[0] + shift, body.place_m[1], height)
    velocity = (base + rate * statue.centroid_height_m, table_y, rate * new)
    upright = (*place, *_level(body.turn, lean_rad), *velocity, 0.0, rate, 0.0)
    stepper.writer.write("imposed_impact", was, upright + row[len(upright) :])
    return stepper.backend.read()


def _level(turn: tuple[float, float, float, float], lean_rad: float) -> tuple[float, float, float, float]:
    """A quaternion turned back by a lean about y."""
    x, y, z, w = turn
    s, c = math.sin(-0.5 * lean_rad), math.cos(-0.5 * lean_rad)
    return (c * x + s * z, c * y + s * w, c * z - s * x, c * w - s * y)
