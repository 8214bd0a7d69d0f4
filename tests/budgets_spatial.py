"""Budgets of the tests of `analytic.spatial` and of bodies that are thrown, each with the sentence that derives it."""

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

INTEGRATED: Final = 1e-10
"""DOP853 at rtol 1e-12 over a second without impact errs by some 1e-12 of quantities of order one; a hundred times that."""

SLIDES_M: Final = 1e-8
"""The reference's sliding begins with a first step of 3e-5 s of fourth order and ends at 1e-10 m/s: below 1e-9 m in a second."""

UPLIFT: Final = 1e-5
"""A closed-form threshold is tried this much above and below by the reference."""

FLIGHT_RAD_PER_S: Final = 10.0
"""Bullet's explicit gyroscopic term errs by 7.1 rad for each second of step over 2 s at (1, 0.5, 3) rad/s (measured)."""

FIRST_ORDER: Final = 0.55
"""Half the step leaves half of an error of first order, and a tenth of that."""

TUMBLE_RAD: Final = 1e-4
"""A block over four impacts in 0.8 s at 0.25 ms: 1.9e-5 rad measured, of which half is the flight's."""

ONE_IMPACT_RAD: Final = 1e-5
"""A nearly spherical body turns almost evenly in flight, so that one located impact on a vertex that sticks is met: 1e-6 rad
measured at 0.125 ms, 7e-5 at 0.5 ms."""

BOUNCE_RELATIVE: Final = 0.1
"""Bullet's contact acts from its reach above the floor: bounces of 0.1 m come to e² h within 10 % at 1 to 0.06 ms and at 0.3,
0.5, 0.8 (measured; not in order with the step)."""

TUMBLE_PLAIN_RAD: Final = 1e-3
"""The same with impacts inside a step: 2.1e-4 rad measured."""

SLOP_M: Final = 1e-6
"""What Bullet's contact leaves under a body at rest: 3e-8 m measured."""

SLOP_RAD: Final = 1e-5
"""The band in which a body that rests is left: the adapters' own `REST_BAND_RAD`."""

MIRRORED_RAD: Final = 1e-6
"""Bullet solves contacts in an order that a mirror does not change here: differences are rounding, grown through impacts."""

RAISED_RELATIVE: Final = 1e-9
"""Heights of 0.05 m written with 12 digits, and 2 mm between two of them: known to 1e-13 m of 2e-3 m, and less."""

THROWN_AGAIN_M: Final = 1e-4
"""A toss written with 12 digits and thrown again: its start differs by 1e-12 and by what its end leaves under the table (1e-7 m),
grown through some ten impacts."""

MEASURED_FRICTION: Final = (0.15, 0.21)
"""The cube's authors fitted 0.15 to 0.18; 0.18 on 48 tosses here, two tosses leave a little more."""

MEASURED_RESTITUTION: Final = 0.1
"""0 on 48 tosses; between 0 and 0.1 the points are missed by 0.5 mm more, of 17: two tosses cannot tell."""

TOSSED_RAD: Final = 0.4
"""Median over all frames: 0.13 rad on 95 tosses with an upper quartile of 0.31; four tosses stay below that and a third more."""

PLANE_LANDING_RAD: Final = 5e-4
"""A plastic landing on a corner of the base, which pymunk locates, at 0.25 ms: 8e-5 rad measured 0.09 s after it."""

PLANE_BOUNCING_RAD: Final = 1e-3
"""Chipmunk as it comes meets impacts inside its steps of 0.1 ms: 1.4e-4 rad measured after one."""

TWO_SOLVERS_RAD: Final = 5e-9
"""A cube's first impact off a sliding vertex: measured 5e-10 rad 0.04 s after it, ten times that."""

FLOWN_AGAIN: Final = 1e-8
"""A flight found again in twelve rounds, each leaving a sixth of the error, from 1 rad/s away: 5e-10 rad/s; twenty times that."""

TORQUE_FREE_RAD: Final = 1e-5
"""Asked after 2 s of flight at 1 ms; measured 3.0e-6 (pybullet), 1.1e-7 (spatial, as the harness asks it)."""

SCAN_RAD: Final = 2e-5
"""A scan's first impacts in space, pybullet at its finest level: measured 3.6e-6 rad; on the outline's points alone 2e-2."""

SCAN_ROCKS_RAD: Final = 5e-3
"""It rocks by a thousand times that, so that the comparison says something."""

SCAN_STEPS: Final = 20_000
"""Steps that a draw of a probability may take: 40 s of a real record take 500 to 2 800."""

FALL_READ_M_S2: Final = 0.01
"""A fall read from twelve frames written with nine digits: 1e-9 m over (0.05 s)² is 1e-6,
far below it; no other noise."""

START_READ: Final = 1e-4
"""Value and rate by least squares of the same frames: the rate's rounding is 1e-9 m over a frame of 4 ms."""

WEIGHED_RESTITUTION: Final = 0.05
"""Ends are told apart by 0.1 of restitution: half of that cannot be seen."""

PLATES_FALL_M_S2: Final = 0.25
"""125 falls between 8.5 and 9.7 m/s² of which the median is read."""

LIMESTONE: Final = 5e-4
"""Figures as printed in docs/scores.md."""

FITTED_AGAIN: Final = 0.005
"""One toss of friction 0.20 thrown again: the descent ends at simplices of 1e-3, its loss flat to rounding around the truth."""

FITTED_ON_ONE_IMPACT: Final = 0.05
"""The first impact of one toss, which may stick: the friction that it slid with is known to a quarter."""

CLOCK_REL: Final = 1e-5
"""Twelve places to twelve digits; a second before rounding."""
