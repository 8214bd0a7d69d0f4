"""The one place from which Bullet's bodies are written to, and the account of what is written while a run goes on."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import pybullet

from harness.engines.event_stepping.interventions import Ledger
from harness.engines.pybullet.pose import Body
from harness.model.scene import Scene

if TYPE_CHECKING:
    from harness.engines.pybullet.world import World

Row = tuple[float, ...]

ALONE = 13
"""Numbers in a row without a pedestal."""


def place(body: int, state: Body, client: int) -> None:
    """Put a body into a state."""
    pybullet.resetBasePositionAndOrientation(body, state.place_m, state.turn, physicsClientId=client)
    pybullet.resetBaseVelocity(body, state.velocity_m_s, state.rate_rad_s, physicsClientId=client)


def twist(body: int, torque_n_m: tuple[float, float, float], client: int) -> None:
    """Add a torque, world axes, to the step that follows: Bullet forgets it with that."""
    pybullet.applyExternalTorque(body, -1, torque_n_m, pybullet.WORLD_FRAME, client)


def bodies(row: Row) -> tuple[Body, Body | None]:
    """States of statue and pedestal in a row."""
    statue = Body(row[0:3], row[3:7], row[7:10], row[10:13])  # type: ignore[arg-type]
    if len(row) == ALONE:
        return statue, None
    return statue, Body(row[13:16], row[16:20], row[20:23], row[23:26])  # type: ignore[arg-type]


class RowWriter:
    """Writes rows to statue and pedestal of one world."""

    def __init__(self, world: World, scene: Scene) -> None:
        self.world, self.ledger, self.gravity_m_s2 = world, Ledger(), scene.gravity_m_s2
        statue, pedestal = scene.statue, scene.pedestal
        self.inertias = [(statue.mass_kg, statue.inertia_kg_m2)]
        if pedestal is not None:
            squares = pedestal.width_m**2 + pedestal.height_m**2
            self.inertias.append((pedestal.mass_kg, pedestal.mass_kg * squares / 12.0))

    def write(self, kind: str, before: Row, after: Row) -> None:
        """Change both bodies from the row that they have, `before`."""
        account, joules = self.ledger.of(kind), 0.0
        for k, (mass, inertia) in enumerate(self.inertias):
            old, new = before[ALONE * k : ALONE * (k + 1)], after[ALONE * k : ALONE * (k + 1)]
            if old[:7] != new[:7]:
                chord = min(math.dist(old[3:7], new[3:7]), math.dist(old[3:7], [-q for q in new[3:7]]))
                account.moved_m += math.dist(old[0:3], new[0:3])
                account.turned_rad += 4.0 * math.asin(0.5 * chord)
                joules += mass * self.gravity_m_s2 * (new[2] - old[2])
            if old[7:] != new[7:]:
                account.velocity_m_s += math.dist(old[7:10], new[7:10])
                account.rate_rad_s += math.dist(old[10:13], new[10:13])
                joules += 0.5 * mass * (sum(v * v for v in new[7:10]) - sum(v * v for v in old[7:10]))
                # Angular velocities are changed in the rocking plane alone, about y.
                joules += 0.5 * inertia * (new[11] ** 2 - old[11] ** 2)
        account.count += 1
        account.energy(joules)
        self.restore(after)

    def restore(self, row: Row) -> None:
        """Put both bodies back to where a step began that is solved again, or as a new world begins."""
        statue, pedestal = bodies(row)
        self.world.place(self.world.statue, statue)
        if pedestal is not None and self.world.pedestal is not None:
            self.world.place(self.world.pedestal, pedestal)
