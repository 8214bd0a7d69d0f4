"""The one place from which an engine's bodies are written to while a run goes on, and the account of what is written."""

from __future__ import annotations

import math

from harness.engines.stepping.backend import Backend
from harness.engines.stepping.forces import pedestal_inertia_kg_m2
from harness.engines.stepping.interventions import Ledger
from harness.engines.stepping.rows import ALONE, Row
from harness.model.scene import Scene


class RowWriter:
    """Writes rows to statue and pedestal of one world of an engine."""

    def __init__(self, backend: Backend, scene: Scene) -> None:
        self.backend, self.ledger, self.gravity_m_s2 = backend, Ledger(), scene.gravity_m_s2
        statue, pedestal = scene.statue, scene.pedestal
        self.inertias = [(statue.mass_kg, statue.inertia_kg_m2)]
        if pedestal is not None:
            self.inertias.append((pedestal.mass_kg, pedestal_inertia_kg_m2(pedestal)))

    def write(self, kind: str, before: Row, after: Row) -> None:
        """Change both bodies from the row that they have, `before`."""
        moved_m = turned_rad = velocity_m_s = rate_rad_s = joules = 0.0
        for k, (mass, inertia) in enumerate(self.inertias):
            old, new = before[ALONE * k : ALONE * (k + 1)], after[ALONE * k : ALONE * (k + 1)]
            if old[:7] != new[:7]:
                chord = min(math.dist(old[3:7], new[3:7]), math.dist(old[3:7], [-q for q in new[3:7]]))
                moved_m += math.dist(old[0:3], new[0:3])
                turned_rad += 4.0 * math.asin(0.5 * chord)
                joules += mass * self.gravity_m_s2 * (new[2] - old[2])
            if old[7:] != new[7:]:
                velocity_m_s += math.dist(old[7:10], new[7:10])
                rate_rad_s += math.dist(old[10:13], new[10:13])
                joules += 0.5 * mass * (sum(v * v for v in new[7:10]) - sum(v * v for v in old[7:10]))
                # Angular velocities are changed in the rocking plane alone, about y.
                joules += 0.5 * inertia * (new[11] ** 2 - old[11] ** 2)
        self.ledger.of(kind).write(moved_m, turned_rad, velocity_m_s, rate_rad_s, joules)
        self.backend.place(after)
