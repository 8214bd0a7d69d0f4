"""The same motion in a bare pymunk loop: what the harness's cost is measured against."""

from __future__ import annotations

import time

import numpy as np

from harness.engines.contact import frame
from harness.engines.pymunk.settings import MunkSettings
from harness.engines.pymunk.world import build
from harness.model.scene import Scene


def bare_loop(scene: Scene, settings: MunkSettings) -> tuple[float, list[tuple[float, ...]]]:
    """Seconds and read-outs of a plain loop: pymunk's own step and properties, same bodies, settings and motion.

    No friction that switches, no split steps, no reduction. The motion's accelerations are computed within the time.
    """
    world = build(scene, settings)
    space, bodies = world.space, [body for body in (world.statue, world.pedestal) if body is not None]
    dt = settings.dt_s
    rows: list[tuple[float, ...]] = []
    begin = time.perf_counter()
    edges = np.arange(frame.step_count(scene.duration_s, dt) + 1, dtype=np.float64) * dt
    gravity = frame.apparent_gravity(scene, edges)[:, [0, 2]].tolist()
    for x, z in gravity:
        space.gravity = (x, z)
        space.step(dt)
        row: list[float] = []
        for body in bodies:
            place, velocity = body.position, body.velocity
            row += (place.x, place.y, body.angle, velocity.x, velocity.y, body.angular_velocity)
        rows.append(tuple(row))
    return time.perf_counter() - begin, rows
