"""Budgets of the tests of scores, verdicts and statistics, each with the sentence that derives it."""

from typing import Final

ROUNDING_REL: Final = 1e-12
"""Sums of ten thousand doubles err by some 1e4 × 1e-16 of their size."""

TRAPEZOID_REL: Final = 1e-5
"""The trapezoid over whole periods of a sine is exact; over parabolic arcs at 1 kHz it errs by dt²θ̈²T/12 ≈ 1e-6 of the mean
square, and its last incomplete step by less than dt/T = 1e-4 of that; ten times the first."""

IMPACT_S: Final = 1e-9
"""Parabolic arcs are what the detector extrapolates with, so only rounding is left: 1e-16 of 10 s over rates near 0.05 rad/s."""

UPLIFT_S: Final = 1e-4
"""The uplift is interpolated linearly within one sample of an arc that has bent by θ̈ dt²/8 = 5e-7 rad at 0.9 rad/s; and the
threshold of 1e-4 rad is passed 1.1e-4 s after the arc starts: within one tenth of a sample of that."""

PEAK_RAD: Final = 1e-9
"""Hermite cubics hold a parabolic arc exactly; where the peak's time is exact to rounding its value is too."""

ENERGY_SHARE: Final = 1e-9
"""Rates on both sides of an impact are extrapolated exactly on parabolic arcs: rounding alone."""

ENGINE_SHARE: Final = 2e-3
"""Rates of an engine's history are extrapolated by lines over two samples: under 3 Hz they bend by θ⃛dt² ≈ 1e-4 rad/s, which is
some 5e-4 of the share at 0.4 rad/s; a step of 1 ms errs by as much again. A sample inside an impact costs 1e-2 and more."""

SMALL_SHARE: Final = 1e-2
"""Under 8 Hz, and at rates of some 0.02 rad/s, the lines miss up to 1e-4 rad/s of either: 1 % of the share, from both."""

WORK_PAIR_SAMPLES: Final = 10_001
"""A history of 10 s at 1 kHz, the size that the speed target names."""

QUANTILE_SE: Final = 4.0
"""A seeded random check may miss by four standard errors: one seed in 16 000 would."""
SAMPLED_SINE_REL: Final = 4e-5
"""The velocity of a sine of 2 Hz, sampled 800 times a second and joined by lines, is too small by (ωdt)²/12 = 2e-5: twice."""
COUNTED: Final = 0.03
"""A share of 0.95 of 500 bins has a standard error of 0.01: three of them."""
SUITES: Final = 100
"""Suites of 40 motions whose medians and dispersions are compared, each interval at 95 %."""
LEAST_SUITES: Final = 85
"""A percentile bootstrap of 40 cases covers some points less than it says: 95 less three, less three standard errors of 2.4."""
