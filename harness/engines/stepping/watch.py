"""What a run in progress is looked at for, and what ends it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from harness.engines.stepping.columns import trajectory
from harness.engines.stepping.frame import matrices
from harness.engines.stepping.rows import Row, Vector, axis_of
from harness.engines.stepping.step_log import StepLog
from harness.engines.stepping.step_state import StepState
from harness.engines.stepping.support import wall_touch
from harness.model.scene import Scene
from harness.statics.rest import LimitsOfRest

if TYPE_CHECKING:
    from harness.engines.stepping.contact_gaps import ContactGaps


Array = NDArray[np.float64]

# Spells of rest inside a run: while the statue rests on its base and the motion cannot move it, nothing is
# integrated.


STILL_M_S: Final = 1e-5
"""Velocity, m/s and rad/s, below which everything counts as still."""
LEAN_RAD: Final = 1e-6
"""A statue at rest leans less than this from its pose at rest: measured, 1e-8 to 1e-7 rad on 16 vertices under a record."""
LEAST_STEPS: Final = 8
"""A shorter spell is not worth its look."""


@dataclass(eq=False)
class RestSpells:
    """Asked with a run in progress. `axes` (3, 3) are the statue's principal axes as columns, `axis` the vertical one in its
    principal frame, `rest` that axis in the world at rest. The statue is at rest when it is so at two looks, one after the other:
    where it only turns back, it moves in the next step.
    """

    limits: LimitsOfRest
    axes: Array
    axis: Vector
    rest: Vector
    still_at: int = -1
    look_from: int = 0

    def steps(self, state: StepState) -> int:
        """Whole steps from now on in which nothing can move; 0 where something moves, or soon may."""
        row, number = state.row, state.number
        if abs(row[11]) > STILL_M_S or number < self.look_from or not state.even:
            return 0
        velocities = row[7:13] + row[20:26]
        zx, zy, _ = axis_of(row, self.axis)
        if max(map(abs, velocities)) > STILL_M_S or math.hypot(zx - self.rest[0], zy - self.rest[1]) > LEAN_RAD:
            self.still_at = -1
            return 0
        if self.still_at < 0:
            self.still_at = number
            return 0
        self.still_at = -1
        # The sides over which the base may tip are where the statue has turned about the vertical.
        turn = matrices(np.array([row[3:7]]))[0] @ self.axes.T
        until_s = self.limits.until_s(state.t_s, math.atan2(turn[1, 0], turn[0, 0]))
        steps = int(until_s / state.step_s) - number
        self.look_from = number + max(steps, 1)
        return steps if steps >= LEAST_STEPS else 0


WALL_STEPS: Final = 256
"""Steps between two looks whether a wall was reached: a look costs what ten steps do."""
ACROSS: Final = 0.5
"""Share of the balance angle across the plane within which the statue is not on its way to a fall there, which would come
first."""


@dataclass(eq=False)
class WallWatch:
    """Whether the run has come to its end at a wall; `axes` and `step_s` as `columns.trajectory` takes them."""

    scene: Scene
    axes: Array | None
    step_s: float
    seen: int = 0
    touched: bool = False

    @classmethod
    def of(cls, scene: Scene, axes: Array | None, step_s: float) -> WallWatch | None:
        """None without a wall."""
        return None if scene.wall is None else cls(scene, axes, step_s)

    def ends(self, record: StepLog) -> bool:
        """Whether something touched the wall since the last look or before, and the statue does not fall across the plane."""
        path = trajectory(self.scene, record.tail(max(self.seen - 2, 0)), self.axes, self.step_s)
        self.seen = len(record.t_s)
        self.touched = self.touched or wall_touch(self.scene, path) is not None
        across, statue = path.extra.get("out_of_plane_rad"), self.scene.statue
        most_rad = ACROSS * math.atan2(0.5 * statue.depth_m, statue.centroid_height_m)
        return self.touched and (across is None or abs(float(across[-1])) < most_rad)


UPRIGHT: Final[Vector] = (0.0, 0.0, 1.0)
LOOK_STEPS: Final = 64
"""Steps between two questions whether the run may end: a statue that has fallen stays down."""


@dataclass(frozen=True, eq=False)
class Watch:
    """What a loop looks at: the statue's `axis` in its principal frame and in the world at `rest`, when and what to end.

    `impose` says that impacts are the model's. `quiet_from` is the number of the step from which the table is still (None: the
    run is not ended at rest). `leave` is asked now and then whether the statue may touch what this world leaves out, `stop`, with
    time and rotation, whether the run may end, `wall` whether one was reached. `gaps` finds impacts; None leaves them to whole
    steps, as they are while `edges` says that the pedestal's edges may be met. `spells` finds times of rest; `ends_fallen` ends a
    run whose statue has overturned.
    """

    axis: Vector = UPRIGHT
    rest: Vector = UPRIGHT
    quiet_from: int | None = None
    impose: bool = False
    leave: Callable[[Row], bool] | None = None
    stop: Callable[[float, float], bool] | None = None
    gaps: ContactGaps | None = None
    spells: RestSpells | None = None
    edges: Callable[[Row], bool] | None = None
    wall: WallWatch | None = None
    # Engines that do not say otherwise end there: what has fallen does not stand up again.
    ends_fallen: bool = True
