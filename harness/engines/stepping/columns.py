"""From the loop's rows to the trajectory, with the columns that only three dimensions have."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from harness.engines.stepping import frame
from harness.engines.stepping.frame import matrices, planar, statue_columns
from harness.engines.stepping.step_log import StepLog
from harness.model import Array, Scene, centroid_shift_m

# What a contact engine's loop recorded, before it becomes a run.


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Samples at the engine's own steps, in the table's frame, all of length n, `t_s` strictly increasing from 0.

    `statue_xz_m`, `statue_rate_m_s` (n, 2): the statue's centroid; `pedestal_xz_m`, `pedestal_rate_m_s` (n, 2): the
    pedestal's centroid, `pedestal_spin_rad_s` its rotation's rate, None without one; `gravity_xz_m_s2` (n − 1, 2): apparent
    gravity of each step. `slip_m` is of the edge on which a pedestal stands, zero without one. `extra`: further columns of
    the history by name with unit (n,), of a pedestal `pedestal_tilt_rad`.
    """

    t_s: Array
    theta_rad: Array
    theta_rate_rad_s: Array
    slip_m: Array
    slip_rate_m_s: Array
    gravity_xz_m_s2: Array
    statue_xz_m: Array
    statue_rate_m_s: Array
    pedestal_xz_m: Array | None = None
    pedestal_rate_m_s: Array | None = None
    pedestal_spin_rad_s: Array | None = None
    extra: Mapping[str, Array] = field(default_factory=dict)

    @property
    def tilt_rad(self) -> Array:
        """The support's rotation (n,), clockwise: the pedestal's."""
        return self.extra.get("pedestal_tilt_rad", np.zeros_like(self.t_s))

    def until(self, count: int, end_s: float) -> Trajectory:
        """The first `count` samples, the last of them at `end_s` where it lies beyond."""
        before_s, last_s = self.t_s[max(count - 2, 0)], self.t_s[count - 1]
        share = (end_s - before_s) / (last_s - before_s) if before_s < end_s < last_s else 1.0

        def ended(column: Array) -> Array:
            if share == 1.0:
                return column[:count]
            cut = column[:count].copy()
            cut[-1] = share * cut[-1] + (1.0 - share) * cut[-2]
            return cut

        return self._changed(ended, count)

    def up_to(self, count: int, t_s: float) -> Trajectory:
        """The first `count` samples (two at least), and one at `t_s`, as the last two of them go on."""
        last, before = count - 1, count - 2
        share = (t_s - self.t_s[last]) / (self.t_s[last] - self.t_s[before])

        def longer(column: Array) -> Array:
            return np.concatenate(
                [column[:count], column[last:count] + share * (column[last:count] - column[before:last])]
            )

        return self._changed(longer, count + 1)

    def _changed(self, change: Callable[[Array], Array], count: int) -> Trajectory:
        """Every column changed alike, to `count` samples."""
        columns = {
            name: value if value is None else change(value) for name, value in vars(self).items() if name != "extra"
        }
        # A gravity belongs to the step between two samples: there is one fewer.
        columns["gravity_xz_m_s2"] = self.gravity_xz_m_s2[: max(count - 1, 0)]
        extra = {name: change(value) for name, value in self.extra.items()}
        return Trajectory(**columns, extra=extra)  # type: ignore[arg-type]


JUMP_IN_G: Final = 10.0
PULLS: Final = 2.0
"""An acceleration above this many g, and this many times what weight and table can do together, is an impact's: velocities on
its two sides are not averaged."""


def trajectory(scene: Scene, record: StepLog, axes: Array | None, step_s: float) -> Trajectory:
    """The trajectory in the table's frame; `axes` (3, 3) holds the statue's principal axes as columns (None: a planar engine)."""
    t_s, rows = _whole_steps(record, step_s, scene)
    # Of a moving frame the table's own motion is none.
    place = table_rate = np.zeros((t_s.size, 3))
    if scene.table == "moving":
        place, table_rate = frame.table_motion(scene, t_s)
    turn = matrices(rows[:, 3:7]) @ (np.eye(3) if axes is None else axes.T)
    spin = rows[:, 10:13]
    centroid, velocity = rows[:, 0:3] - place, rows[:, 7:10] - table_rate
    theta, theta_rate = planar(turn[:, :, 2], spin)
    extra = {} if axes is None else statue_columns(scene.statue, turn, centroid)
    slip = slip_rate = np.zeros_like(t_s)
    pedestal = pedestal_rate = pedestal_spin = None
    if scene.pedestal is not None:
        below, moving = rows[:, 13:16] - place, rows[:, 20:23] - table_rate
        pedestal, pedestal_rate, pedestal_spin = below[:, [0, 2]], moving[:, [0, 2]], rows[:, 24]
        top = matrices(rows[:, 16:20])
        columns = {
            "pedestal_tilt_rad": np.arctan2(top[:, 0, 2], top[:, 2, 2]),
            "pedestal_yaw_rad": np.arctan2(top[:, 1, 0], top[:, 0, 0]),
            "pedestal_y_m": below[:, 1] - below[0, 1],
        }
        tilt, (half_width, _, half_height) = columns["pedestal_tilt_rad"], scene.pedestal.half_m
        # What slips is the edge on which it stands.
        slip = below[:, 0] - below[0, 0] - centroid_shift_m(scene.pedestal, tilt)
        slip_rate = moving[:, 0] - pedestal_spin * (half_height * np.cos(tilt) + half_width * np.abs(np.sin(tilt)))
        # A planar engine has none but the tilt.
        extra |= {name: columns[name] for name in (("pedestal_tilt_rad",) if axes is None else columns)}
    return Trajectory(
        t_s=t_s,
        theta_rad=theta,
        theta_rate_rad_s=theta_rate,
        slip_m=slip,
        slip_rate_m_s=slip_rate,
        gravity_xz_m_s2=frame.apparent_gravity(scene, t_s)[:, [0, 2]],
        statue_xz_m=centroid[:, [0, 2]],
        statue_rate_m_s=velocity[:, [0, 2]],
        pedestal_xz_m=pedestal,
        pedestal_rate_m_s=pedestal_rate,
        pedestal_spin_rad_s=pedestal_spin,
        extra=extra,
    )


def _whole_steps(record: StepLog, step_s: float, scene: Scene) -> tuple[Array, Array]:
    """Times (n,) and rows (n, 13 or 26) at whole steps, with velocities of those times instead of half a step before."""
    t_s, kick_s, rows = np.array(record.t_s), np.array(record.kick_s), record.rows.copy()
    jump = max(JUMP_IN_G * scene.gravity_m_s2, PULLS * frame.greatest_pull_m_s2(scene))
    for columns, limit in (
        (slice(7, 10), jump),
        (slice(10, 13), jump / scene.statue.centroid_height_m),
        (slice(20, 23), jump),
        (slice(23, 26), jump / (math.inf if scene.pedestal is None else scene.pedestal.centroid_height_m)),
    ):
        if columns.stop <= rows.shape[1]:
            rows[:, columns] = _synchronous(rows[:, columns], t_s, kick_s, limit)
    whole = t_s == np.round(t_s / step_s) * step_s
    whole[-1] = True
    t_s, rows = t_s[whole], rows[whole]
    if t_s[0] > 0.0:
        # What came before was not integrated: nothing moved.
        t_s, rows = np.concatenate([[0.0], t_s]), np.vstack([rows[:1], rows])
    return t_s, rows


def _synchronous(values: Array, t_s: Array, kick_s: Array, jump: float) -> Array:
    """Velocities (n, 3) at the samples' own times from those of `kick_s`, at most half a step before.

    Between two samples the value is interpolated, except where the acceleration is an impact's: there the one before holds. The
    last goes on as it did before.
    """
    result = values.copy()
    between = np.diff(kick_s)
    # An impact's step takes no time for velocities.
    accel = np.diff(values, axis=0) / np.where(between > 0.0, between, 1.0)[:, None]
    smooth = (between > 0.0) & (np.max(np.abs(accel), axis=1) < jump)
    slope = np.where(smooth[:, None], accel, 0.0)
    # A run of one sample has no acceleration: its velocities stay.
    last = slope[-1:] if len(slope) else np.zeros_like(values)
    result += np.vstack([slope, last]) * (t_s - kick_s)[:, None]
    return result
