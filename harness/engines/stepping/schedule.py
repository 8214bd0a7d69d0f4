"""Impulses of the table's motion, step by step, for an engine's own integrator read as a leapfrog.

A step changes velocities first and places after, v ← v + g Δt, x ← x + v Δt. Read as velocities half a step before their
places it is of second order; so the gravity of the step from t_n to t_{n+1} is the mean over the time from the middle of the
step before to the middle of this one. The first step begins with synchronous velocities: half of its time lies before t_0.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Final

import numpy as np

from analytic.excitation import ZeroExcitation
from harness.engines.stepping import frame
from harness.engines.stepping.step_log import Vector
from harness.model.scene import Scene

SAME_INSTANT: Final = 1e-6
"""Share of a step by which two instants may differ and be one."""


@dataclass(frozen=True, eq=False)
class Schedule:
    """Steps of `step_s` from number `first` to `count`; `moving` says that the table itself moves, so that gravity is constant.

    A gravity is what acts for a whole step, m/s².
    """

    scene: Scene
    step_s: float
    first: int
    count: int

    @property
    def moving(self) -> bool:
        """Whether the table moves instead of the frame."""
        return self.scene.table == "moving"

    @cached_property
    def coarse(self) -> list[Vector]:
        """Gravity of every whole step that follows a whole step, from number `first` on."""
        middles = (np.arange(self.first, self.count) + 0.5) * self.step_s
        # From the middle of one step to that of the next; the first begins at its own instant, with half the time.
        edges_s = np.concatenate([[self.first * self.step_s], middles])
        share = np.diff(edges_s)[:, None] / self.step_s
        if self.moving:
            gravity = np.array([0.0, 0.0, -self.scene.gravity_m_s2]) * share
        else:
            gravity = frame.apparent_gravity(self.scene, edges_s) * share
        return list(zip(*gravity.T.tolist(), strict=True))

    @cached_property
    def _jumps_s(self) -> list[float]:
        """Instants at which the floor's acceleration jumps, in order."""
        end_s = (self.count + 1) * self.step_s
        return sorted({float(t) for part in self.scene.base_excitation.parts for t in part.jumps_s(end_s)})

    def jump_after_s(self, kick_s: float) -> float:
        """The first instant after `kick_s` at which the floor's acceleration jumps; infinite for none."""
        # What is nearer is where the velocities stand already.
        number = bisect_right(self._jumps_s, kick_s + SAME_INSTANT * self.step_s)
        return self._jumps_s[number] if number < len(self._jumps_s) else math.inf

    def between(self, start_s: float, end_s: float, step_s: float) -> Vector:
        """Gravity of a step of `step_s` that takes velocities from `start_s` to `end_s`."""
        if end_s <= start_s:
            return 0.0, 0.0, 0.0
        pull = [0.0, 0.0, -self.scene.gravity_m_s2 * (end_s - start_s) / step_s]
        for (axis, after), (_, before) in zip(self._velocities(end_s), self._velocities(start_s), strict=True):
            pull[axis] -= (after - before) / step_s
        return pull[0], pull[1], pull[2]

    @cached_property
    def _velocities(self) -> Callable[[float], list[tuple[int, float]]]:
        """What gives, at a time, the axes along which the frame is accelerated, each with its motion's velocity, m/s."""
        parts = () if self.moving else self.scene.base_excitation.parts
        moving = [(axis, part.velocity_at) for axis, part in enumerate(parts) if not isinstance(part, ZeroExcitation)]

        # One step begins where the last one ended.
        @lru_cache(maxsize=2)
        def at(t_s: float) -> list[tuple[int, float]]:
            return [(axis, velocity(t_s)) for axis, velocity in moving]

        return at

    def table(self, t_s: float, kick_s: float, step_s: float) -> tuple[Vector, Vector]:
        """Displacement of a moving table at the start of a step, and its mean velocity in it; that of the instant `kick_s`, to
        which the step takes velocities, where this is not its middle: at impacts, and where the floor's acceleration jumps.
        """
        (here, there, _), (_, _, at_kick) = frame.table_motion(self.scene, np.array([t_s, t_s + step_s, kick_s]))
        rate = (there - here) / step_s
        if abs(kick_s - t_s - 0.5 * step_s) > SAME_INSTANT * self.step_s or kick_s in self._jumps_s:
            rate = at_kick
        return (float(here[0]), float(here[1]), float(here[2])), (float(rate[0]), float(rate[1]), float(rate[2]))
