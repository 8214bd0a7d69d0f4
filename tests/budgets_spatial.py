"""Budgets of the tests of `analytic.spatial`, each with the sentence that derives it."""

from typing import Final

PLANAR_RAD: Final = 1e-10
"""Asked: both models solve the same equations to local errors of 1e-13 and 1e-15 rad, which a rocking history of some ten impacts
amplifies by up to a hundred; measured at most 1e-11."""

AUDIT: Final = 1e-9
"""Asked of the balances of energy and momentum; measured 3e-13 and 1e-14."""

IMPULSE: Final = 1e-12
"""A small system of well-scaled equations is solved to some thousand roundings."""

CLOSED_FORM: Final = 1e-10
"""Two seconds of flight at a local error of 1e-13 take some hundred steps."""

MIRROR: Final = 1e-9
"""Mirrored and turned scenes differ by rounding, which the slip onsets and impacts of a second amplify by some thousands."""

THRESHOLD: Final = 1e-3
"""Share to either side of a printed threshold of four digits at which the outcome must differ."""

TIME_S: Final = 6e-5
"""Half the last of the four digits to which the specification's times are given, and as much again for where it rounded."""

FRICTION_REL: Final = 5e-3
"""Half the last of the three digits to which the least friction is given, where it grows by its own size within 4 ms."""

SLIDE_M: Final = 1e-11
"""A second of sliding at a local error of 1e-13 m, with two events."""

TWO_SOLVERS: Final = 1e-9
"""Asked of two solvers up to the first impact, rad and m: local errors of 1e-13 and 1e-12, and a choice 1 µs after each onset."""

SEQUENCE_STEPS: Final = 10_000
"""Steps of a run of two seconds whose impacts come by turns to their end: 3 100 at the most at a local error of 1e-13, three
times that for others; one that does not end them took over 500 000."""

ENERGY_REL: Final = 1e-14
"""Of one sum of products: some tens of roundings."""
