"""Tolerances of the spatial reference, each with the sentence that derives it."""

from __future__ import annotations

INTEGRATED = 1e-10
"""DOP853 at rtol 1e-12 over a second without impact errs by some 1e-12 of quantities of order one; a hundred times that."""

PLANAR_RAD = 1e-10
"""Against the planar model over impacts: each multiplies an error of 1e-12 by less than ten (largest measured: 2e-12 rad)."""

PRINTED_TIME_S = 5.1e-5
"""Times, ratios and coefficients known to four decimals."""

PRINTED_FRICTION = 5.1e-3
"""Coefficients known to three digits, 1.10 to 3.06, of instants known to 1e-4 s."""

BALANCE_RELATIVE = 1e-12
"""Impulses solve six linear equations: their balance holds to rounding times the condition of the base (some hundred)."""

CONE_RELATIVE = 1e-8
"""Signs of a joint state are kept to this share of the scale by the reference's own rule."""

SYMMETRY = 1e-8
"""Mirrored and turned runs differ by integration (1e-12), grown through a few impacts and the stiff start of sliding."""

SLIDING = 1e-8
"""Sliding begins with a first step of 3e-5 s of fourth order and ends at 1e-10 m/s: both below 1e-9 m over a second."""

THRESHOLD = 1e-5
"""A closed-form threshold is tried this much above and below."""

CONE_PROGRAM = 1e-6
"""The cutting planes end within 1e-9 of the force; the solver's own feasibility is 1e-7."""
