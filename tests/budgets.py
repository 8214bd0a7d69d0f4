"""Tolerances of the harness's own tests, each with the sentence that derives it."""

from typing import Final

HERMITE_ROUNDING: Final = 4e-16
"""A cubic is reproduced exactly; a handful of operations on numbers below one leave a few units of 1.1e-16."""
LIMIT_ROUNDING: Final = 1e-15
"""A limit is two or three products of numbers given exactly: a few units of 1.1e-16."""

IMPACT_LOSS_REL: Final = 1e-2
"""Drawn out over 4 ms a rate misses by half its second derivative, 60 rad/s³, times 16e-6 s²: 5e-4 of 0.2, twice in energy."""

OWN_MOTION_REL: Final = 1e-15
"""An array divided by the scene's factor and multiplied again: two roundings of 1.1e-16."""
HOLED_REL: Final = 1e-6
"""A box in single precision, as PLY holds it: 6e-8 of each of its sizes."""
DIFFERENCED: Final = 1e-12
"""Differences over steps of 5 ms of numbers up to 0.5: their rounding, 1.1e-16, over the step."""

FORECAST_TIMES = 1.5
"""What a run takes may pass either end of what was told by this factor: who plans by it waits half as long again at most."""
