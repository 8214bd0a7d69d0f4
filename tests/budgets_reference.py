"""Tolerances of the independent reference solver and of the closed forms, each with the sentence that derives it."""

CLOSED_M = 1e-9
"""Of a slip in closed form: driven by motions of some m/s² for a second, integrated to 1e-12."""

KERNEL_RAD = 1e-8
"""What is claimed of the compiled kernel over the first 2 s of the paper's cases."""

KERNEL_M = 1e-8
"""The same claim for the pedestal's slip in metres."""

EVENT_TIME_S = 1e-8
"""An event is crossed at not less than about 0.1 rad/s (or its equivalent): a rotation of 1e-9 rad over that rate."""

PRINTED_DIGITS = 0.5
"""A published number is met to its printed digits when it differs by at most half a unit of the last."""

QUADRATURE_RELATIVE = 1e-12
"""Adaptive quadrature of a smooth integrand at epsrel 1e-13; a factor of ten for the elliptic form's own rounding."""

SLENDER_RELATIVE = 3e-6
"""At α = 1e-3 rad the linearised block errs by α² = 1e-6 in its stiffness; thresholds move by up to three times that."""

STEADY_SLIP_RELATIVE = 1e-6
"""A transient of sliding loses a fixed share of its offset per cycle; after 12 cycles less than 1e-6 of it is left."""

DIFFERENCE_RELATIVE = 1e-6
"""Central differences with a step of 1e-4 turns err by (2π·1e-4)²/6 ≈ 7e-8 of the differentiated term, a few of which add."""

FINEST_RTOL = 3e-14
"""Just above the least tolerance that DOP853 takes (100 roundings): reference A is then within 1e-14 of the kernel where motions
do not grow."""

CERTIFIED_SEEDS = (504, 505, 508, 519, 525, 526, 542)
"""Of 68 random cases those on which what three runs differ by, without the rounding that they share, was exceeded by most: by up
to sixteen times (519: 2.8e-13 rad against 1.7e-14)."""

CERTIFIED_RAD = 1e-10
"""What may be stated there: growth of a thousand on some 5e-14 of rounding; 1.7e-11 rad measured at the most."""
LEFT_DOMAIN_S = 1e-6
"""Instant at which a limit of the model's domain is passed, at two aimed errors: measured 2e-8, where the samples of a
step are 2e-3 to 2e-2 apart."""
