"""Where the contact is the one that events are located for: a statue that turns about a corner at rest on an upright pedestal.

Elsewhere steps are those of any loop, and errors fall at first order: of events inside them only a foot that comes down while the
statue slides is met at its instant.
"""

from __future__ import annotations

from typing import Final, TypedDict

import numpy as np
from numpy.typing import NDArray

from harness.engines.stepping.support import Corners
from harness.engines.stepping.trajectory import Trajectory
from harness.model.scene import Pedestal

Array = NDArray[np.float64]

LEFT_M: Final = 1e-4
"""Slip of the statue on its support, or gap under it, that counts: without either, steps of 4 ms leave some 1e-5 m."""
LEFT_RAD: Final = 2e-4
"""Tilt of the pedestal that counts; events are located up to less than this (`EventSettings.tipped_rad`)."""
SLIDES_M_S: Final = 1e-3
"""Slower than this the statue's slip goes on as a solver's remainder does: less than 1e-5 m/s at rest."""


class PlainSpells(TypedDict):
    """When events were not located: from when on, for how long altogether, and why."""

    plain_from_s: float | None
    plain_for_s: float
    plain_because: list[str]


def plain_spells(
    motion: Trajectory, slip_m: Array, gap_m: Array, at: Corners, pedestal: Pedestal | None
) -> PlainSpells:
    """`plain_from_s`, the first instant at which the steps were plain (None: never), `plain_for_s`, for how long altogether, and
    `plain_because`, the reasons in the order in which they came.

    `slip_m`, `gap_m`: slip of the statue on its support and gap under it, shape (n,).
    """
    t_s = motion.t_s
    lengths = np.diff(t_s, prepend=t_s[0])
    slides = np.abs(np.diff(slip_m, prepend=slip_m[0])) > SLIDES_M_S * lengths
    slid, lifted = np.abs(slip_m) > LEFT_M, gap_m > LEFT_M
    if slid.any():
        # The slip that passes the limit began a little before.
        passed = int(slid.argmax())
        slid[np.flatnonzero(~slides[:passed]).max(initial=-1) + 1 : passed] = True
    # By reason: since when it counts, and while it does.
    causes = {
        "the statue slides on its support": (slid, slid & slides),
        "the statue has left its support": (lifted, lifted),
    }
    if pedestal is not None and motion.pedestal_xz_m is not None:
        tips = np.abs(motion.tilt_rad) > LEFT_RAD
        place = np.where(at.lean_rad >= 0.0, at.right_x, at.left_x)
        beside = np.abs(place) > 0.5 * pedestal.width_m + LEFT_M
        causes |= {"the pedestal tips": (tips, tips), "the statue stands beyond its pedestal's edge": (beside, beside)}
    first = {name: float(t_s[since.argmax()]) for name, (since, _) in causes.items() if since.any()}
    plain = np.any([while_it for _, while_it in causes.values()], axis=0)
    return {
        "plain_from_s": min(first.values(), default=None),
        "plain_for_s": float(lengths[plain].sum()),
        "plain_because": sorted(first, key=lambda name: first[name]),
    }
