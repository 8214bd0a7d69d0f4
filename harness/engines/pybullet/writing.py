"""The one place from which Bullet's bodies are written to."""

from __future__ import annotations

import pybullet

from harness.engines.stepping.step_log import Body


def place(body: int, state: Body, client: int) -> None:
    """Put a body into a state."""
    pybullet.resetBasePositionAndOrientation(body, state.place_m, state.turn, physicsClientId=client)
    pybullet.resetBaseVelocity(body, state.velocity_m_s, state.rate_rad_s, physicsClientId=client)


def twist(body: int, torque_n_m: tuple[float, float, float], client: int) -> None:
    """Add a torque, world axes, to the step that follows: Bullet forgets it with that."""
    # In the world's axes: Bullet would turn one given in the body's by the rotation at the step's beginning.
    pybullet.applyExternalTorque(body, -1, torque_n_m, pybullet.WORLD_FRAME, client)
