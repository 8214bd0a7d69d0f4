"""Budgets of the analytic tests, each with the sentence that derives it."""

from typing import Final

QUADRATURE_REL: Final = 5e-8
"""A trapezoidal sum of 200 001 samples of the tested motions errs by (ωh)²/12 ≈ 1e-8 of the peak; five times that."""

EVENT_REL: Final = 1e-11
"""An event's own condition, from the state printed at it: its time is exact to the clock's 1e-15 s, and forces that change by
up to a hundred times their size per second leave 1e-13; a hundred times that."""

STICK_ONSET_M_S: Final = 0.0
"""A stick onset sets the pedestal's velocity to zero exactly."""

IMPACT_REL: Final = 1e-13
"""The impact map is a handful of operations on doubles."""

ENERGY_REL: Final = 1e-9
"""Simpson's rule at 1e-4 s on a power that oscillates at 20 rad/s errs by (ωh)⁴/180 ≈ 1e-13 per stretch, and by its
truncated panels at up to a hundred events; measured 1e-10 of the energy exchanged."""

ENERGY_RISE_REL: Final = 1e-12
"""Rounding of an energy of the order of m g h."""

SKIP_RAD: Final = 0.0
"""What is skipped must leave every bit as it was."""

STRESS_STEPS_PER_S: Final = 60
"""Steps and events for each second and hertz: a forced oscillation needs some ten steps for each period and each event adds
two, with room for the natural frequency of the smallest blocks."""

ROOT_REL: Final = 1e-7
"""numpy's companion matrix gives simple roots of degree 13 to some 1e-10 relative, and pairs 1e-5 apart to 1e-16 / 1e-5."""

SAMPLED_S: Final = 1e-6
"""An instant read off a history of 1 ms between two samples: the chord is off by the acceleration of at most 10 rad/s², over
eight times the rate of 0.5 rad/s or more, times the square of the step."""

CHORD_RAD: Final = 2e-6
"""A rotation read off such a history: the same acceleration over eight, times the square of the step, and half of that again."""

SINE_RELATIVE = 3e-16
"""The kernel's own sine and cosine: two roundings of the reduced angle and three of the sum, half a unit (1.1e-16) each at most
where they add up; measured: 2.9e-16."""
COARSE_ROOT = 1e-4
"""The root that sets a step's length: its two polynomials of third order leave 6e-5 together; a step may be off by that much."""

RESIDUAL_REL = 1e-13
"""An event's function at its root, relative to its terms: a dozen terms, each rounded once or twice (1e-16), and the root's own
place, known to 1e-16 of a step in which the function changes by no more than its terms; measured 1.4e-16."""

MODULES_OF_IMPORT: Final = 29
"""Modules that `simulate` loads beside those of numpy and of the loader of its machine code: 27 counted."""
SAMPLED_PULSE_RAD = 1e-6
"""Samples 0.1 ms apart miss a pulse of 7 m/s² and 16 rad/s by h² A ω²/8 = 2.2e-6 m/s² at most, and its jump by none; twice
integrated over 0.4 s that is below 2e-7 rad, times the growth of a rocking block's differences within 0.9 s, about 4."""
PRINTED_S: Final = 5.1e-7
"""Half a unit of the sixth decimal, and what rounding to it leaves."""
PRINTED_J: Final = 5.1e-4
"""The same of the third."""
