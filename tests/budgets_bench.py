"""Budgets of work that do not depend on the machine's mood, each with the sentence that derives it."""

from typing import Final

# Counts are the same on every machine, but for the last bits of a processor that fuses products and sums: each budget down to
# OUTCOME_ALLOCATED_KB is a twentieth above what was counted, so that a tenth more work fails.
ANALYTIC_STEPS: Final = 21
"""Taylor steps of 1 s of the paper's statue on its pedestal: 20 counted, two for each of ten events."""
ANALYTIC_TERMS: Final = 396
"""Taylor coefficients of the same run: 377 counted, some nineteen for each step at 1e-12."""
ACCURACY_STEPS: Final = 564
"""Steps of all runs together that 1e-3 rad may take on an easy scene of half a second: pymunk 531, pybullet 537 counted."""
SPARE: Final = 1.05
"""Steps of a contact engine over duration/dt: splitting impacts and stick onsets adds 6 and 10 to 4000."""
REPEATED: Final = {"pymunk": 14, "pybullet": 14}
"""Steps of these that are tried again: 13 and 12 counted, at two impacts and four stick onsets, a release twice."""
MOST_ITERATIONS: Final = {"pymunk": 50_200, "pybullet": 338_300}
"""Solver iterations that 1e-3 rad may take there, at most so many a step: 531 × 90 and 537 × 600 counted."""
ACCURACY_RUNS: Final = 3
"""Runs that 1e-3 rad may take on an easy scene: a level, a finer one to check it, and one under a stronger motion."""
MODULES_OF_HELP: Final = 172
"""Modules imported to answer --help: 167 counted (ten of them the command line's), 170 from an editable installation, which has
a finder of its own; 743 with scipy's integrators, which a run needs and --help does not."""
MODULES_OF_LATER_PYTHON: Final = 8
"""Modules that --help may load more on CPython 3.12 and later: 6 counted on 3.13, which divides its own library finer."""
OWN_MODULES_OF_RUN: Final = 150
"""Modules of ours in a process that runs a scene with two engines and writes its pages: 148 are."""
MODULES_OF_RUN: Final = {"pymunk": 568, "pybullet": 828, "analytic": 499}
"""Modules that a run of one engine has loaded: 541, 789 and 475 counted; a run's end is asked of the model, which is among
them."""
OUTCOME_ALLOCATED_KB: Final = {"analytic": 23.4, "pymunk": 496.0, "pybullet": 620.0}
"""Peak of memory, KiB, that an outcome allocates through Python: 22.3 for 20 s of the analytic model (a frozen
problem, its options, and one packed record of named numbers); 472 and 591 for 2 s of the
contact engines on their coarsest level, whose recorded states make the outcome; pybullet's instants of rest among them."""
SAME_RAD: Final = 1e-9
"""What a skip may change of a peak that is integrated either way: the certified model's own reliable error is 1e-6."""
SKIP_RAD: Final = 2e-4
"""What a skip may change in a contact engine: contacts settle anew where integration begins, within the level's own error."""

OTHER_INTEGRATOR_RAD: Final = 1e-6
"""DOP853 asked for 1e-10 errs by up to ten thousand times that: it finds events on an interpolant of lower order."""

KERNEL_WORK: Final = {
    "block, harmonic": {1e-6: (86, 1050), 1e-9: (100, 1540)},
    "block, record of 60 s": {1e-6: (1450, 8000), 1e-9: (1550, 10200)},
    "two blocks, harmonic": {1e-6: (142, 1755), 1e-9: (173, 2590)},
    "two blocks, record of 60 s": {1e-6: (1650, 8000), 1e-9: (2050, 11100)},
}
"""Steps and Taylor coefficients of each case of the bench: a tenth above what was counted."""

MAP_STEPS: Final = 335
"""Steps of a run of the 10 × 10 overturning map on a pedestal: a tenth above what was counted."""
MAP_STEPS_ON_FLOOR: Final = 160
"""The same without a pedestal."""
GIVEN_UP_SHARE = {"pymunk": 0.25, "pybullet": 0.12}
"""Steps of a target that no level is expected to meet over those of the two runs on the finest level: two runs with a twelfth of
their steps, and a third, of the coarser one, that shows how differences grow; of pymunk, whose errors fall with the square of the
step there, one finer."""
