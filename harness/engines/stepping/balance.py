"""Whether each body's momentum, and its turning in the plane, changed by what the engine's own contacts gave it, and by the pull.

At every impact, with what was written after it, and over a whole step now and then. The impulses are those that the engine
reports, the pull is taken from the scene: what the layer believes of either is not asked. Both engines keep this balance to
rounding.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.engines.base import LayerFault
from harness.engines.stepping.rows import ALONE, Impulse, Row, Vector
from harness.model.scene import Scene

Array = NDArray[np.float64]

MOST_UNBALANCED: Final = 1e-4
"""Share of all impulses that may be missing in the balance: 1e-12 is, and 1e-3 where a pull or an inertia is off by it."""
ROUNDED_OFF: Final = 1e-6
"""Share of a body's own momentum that counts as impulse: of a body in flight the last digits are missing."""
SLOW_M_S: Final = 1e-3
"""Velocity that is added to a body's own in that: of one at rest, on which nothing acts, rounding is all there is."""
AFTER_STEPS: Final = 128
"""Whole steps from one that is looked at to the next."""
IMPACT, STEP = "impact", "step"


class Balance:
    """The sums of one run: what is missing, and the size of what there is, by what it is of."""

    def __init__(self, scene: Scene, axes: Array | None) -> None:
        """`axes` (3, 3) holds the statue's principal axes as columns (None: a planar engine)."""
        self.scene, self.planar, self.next = scene, axes is None, 0
        axes = np.eye(3) if axes is None else axes
        # In the frame of a row's quaternion.
        self.inertia = (axes.T @ scene.statue.inertia_tensor_kg_m2 @ axes).tolist()
        self.arm_m = scene.statue.centroid_height_m
        pedestal = scene.pedestal
        self.masses = [scene.statue.mass_kg, *([] if pedestal is None else [pedestal.mass_kg])]
        self.missing: dict[tuple[str, str], float] = {}
        self.size: dict[tuple[str, str], float] = {}

    def pull_m_s(self, from_s: float, to_s: float) -> Vector:
        """What weight and the motion of the floor's frame change velocities by; a table that moves is none."""
        motion = self.scene.base_excitation
        parts = [0.0, 0.0, -self.scene.gravity_m_s2 * (to_s - from_s)]
        if self.scene.table != "moving":
            for axis, part in enumerate((motion.x, motion.y, motion.z)):
                if axis == 1 and self.planar:
                    continue
                parts[axis] -= part.velocity_at(to_s) - part.velocity_at(from_s)
        return parts[0], parts[1], parts[2]

    def add(self, of: str, before: Row, after: Row, impulses: Sequence[Impulse], pull_m_s: Vector) -> None:
        """Compare two rows with what the contacts gave each body between them; none where the engine cannot say."""
        if not impulses:
            return
        # What acts on the pedestal from both sides may cancel.
        largest = max(math.hypot(*impulse) for impulse, _ in impulses)
        speeds = (math.hypot(*after[ALONE * k + 7 : ALONE * k + 10]) for k in range(len(impulses)))
        moved = sum(mass * (speed + SLOW_M_S) for mass, speed in zip(self.masses, speeds, strict=True))
        for k, (mass, (impulse, _)) in enumerate(zip(self.masses, impulses, strict=True)):
            at, name = ALONE * k + 7, "pedestal" if k else "statue"
            missing = [mass * (after[at + n] - before[at + n] - pull_m_s[n]) - impulse[n] for n in range(3)]
            self._count((of, f"{name}_momentum"), math.hypot(*missing), largest, moved)
        if of == IMPACT:
            inertia, moment = self._inertia(before), impulses[0][1][1]
            gained = sum(each * (after[10 + n] - before[10 + n]) for n, each in enumerate(inertia))
            turned = abs(sum(each * after[10 + n] for n, each in enumerate(inertia))) + self.arm_m * (largest + moved)
            self._count((of, "statue_turning"), abs(gained - moment), abs(moment), turned)

    def _inertia(self, row: Row) -> Vector:
        """Row of the statue's inertia in the world's axes, kg m², that gives the angular momentum about y."""
        x, y, z, w = row[3:7]
        turn = (
            (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)),
            (2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)),
            (2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)),
        )
        across = [sum(each * turn[1][n] for n, each in enumerate(line)) for line in self.inertia]
        a, b, c = (sum(each * across[n] for n, each in enumerate(line)) for line in turn)
        return a, b, c

    def _count(self, of: tuple[str, str], missing: float, impulse: float, moved: float) -> None:
        self.missing[of] = self.missing.get(of, 0.0) + missing
        self.size[of] = self.size.get(of, 0.0) + impulse + ROUNDED_OFF * moved

    def check(self) -> None:
        """Raise `LayerFault` where something is missing."""
        for (of, what), missing in self.missing.items():
            size = self.size[of, what]
            if not missing <= MOST_UNBALANCED * size:
                raise LayerFault(f"unbalanced_{what}", **{f"{of}_missing": missing, f"{of}_whole": size})
