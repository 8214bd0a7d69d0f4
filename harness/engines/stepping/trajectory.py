"""What a contact engine's loop recorded, before it becomes a run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


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

    def until(self, count: int) -> Trajectory:
        """The first `count` samples."""
        # A gravity belongs to the step between two samples: there is one fewer.
        per_step = self.gravity_xz_m_s2[: max(count - 1, 0)]
        cut = {
            name: None if value is None else value[:count]
            for name, value in vars(self).items()
            if name not in ("gravity_xz_m_s2", "extra")
        }
        extra = {name: value[:count] for name, value in self.extra.items()}
        return Trajectory(**cut, gravity_xz_m_s2=per_step, extra=extra)  # type: ignore[arg-type]
