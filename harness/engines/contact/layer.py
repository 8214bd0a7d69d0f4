"""When a run left what its events are located for: a statue that turns about a corner at rest on an upright pedestal."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from harness.engines.contact.trajectory import Trajectory

Array = NDArray[np.float64]

LEFT_M: Final = 1e-4
"""Slip of the statue on its support, or gap under it, that counts: without either, steps of 4 ms leave some 1e-5 m."""
LEFT_RAD: Final = 1e-3
"""Tilt of the pedestal beyond which impacts are left to plain steps."""


def layer_left(motion: Trajectory, slip_m: Array, gap_m: Array) -> dict[str, Any]:
    """Since when (`layer_left_s`) and by what (`layer_left_by`), from a trajectory of n samples; nothing where it never did.

    `slip_m`, `gap_m`: slip of the statue on its support and gap under it, shape (n,).
    """
    limits = {
        "the statue slides on its support": (np.abs(slip_m), LEFT_M),
        "the statue lifts off": (gap_m, LEFT_M),
        "the pedestal tips": (np.abs(motion.extra.get("pedestal_tilt_rad", np.zeros(1))), LEFT_RAD),
    }
    beyond = {by: np.flatnonzero(values > limit) for by, (values, limit) in limits.items()}
    first = {by: float(motion.t_s[samples[0]]) for by, samples in beyond.items() if samples.size}
    by = min(first, key=lambda each: first[each], default=None)
    return {} if by is None else {"layer_left_s": first[by], "layer_left_by": by}
