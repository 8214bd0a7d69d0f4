"""What pymunk's steps say at one instant: positions lag velocities by half a step and are brought forward by it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from harness.engines.contact import frame
from harness.engines.contact.trajectory import Trajectory
from harness.model.scene import Scene

if TYPE_CHECKING:
    from harness.engines.pymunk.world import World

Array = NDArray[np.float64]


def trajectory(scene: Scene, world: World, states: Array, t_s: Array, lag_s: Array) -> Trajectory:
    """Recorded states (n, 6·bodies) as samples in the table's frame at `t_s` (n,), positions brought forward by `lag_s` (n,)."""
    forward = lag_s[:, None]
    body = states[:, world.statue_slice]
    place, rate = body[:, 0:2] + forward * body[:, 3:5], body[:, 3:5]
    moving = scene.table == "moving"
    if moving:
        speed = frame.table_velocity(scene, t_s)[:, ::2]
        # Places are older than velocities by the lag: the table's own is taken at that instant and brought forward alike.
        shift = frame.table_displacement(scene, t_s - lag_s)[:, ::2] + forward * speed
        place, rate = place - shift, rate - speed
    slip, slip_rate = np.zeros(t_s.size), np.zeros(t_s.size)
    pedestal_place, pedestal_rate, extra = None, None, {}
    if world.pedestal is not None:
        other = states[:, world.pedestal_slice]
        pedestal_place, pedestal_rate = other[:, 0:2] + forward * other[:, 3:5], other[:, 3:5]
        if moving:
            pedestal_place, pedestal_rate = pedestal_place - shift, pedestal_rate - speed
        slip, slip_rate = pedestal_place[:, 0] - pedestal_place[0, 0], pedestal_rate[:, 0]
        extra = {"pedestal_tilt_rad": -(other[:, 2] + lag_s * other[:, 5])}
    return Trajectory(
        t_s,
        -(body[:, 2] + lag_s * body[:, 5]),
        -body[:, 5],
        slip,
        slip_rate,
        frame.apparent_gravity(scene, t_s)[:, ::2],
        place,
        rate,
        pedestal_place,
        pedestal_rate,
        extra,
    )
