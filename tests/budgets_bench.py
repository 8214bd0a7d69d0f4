"""Budgets of work that do not depend on the machine's mood, each with the sentence that derives it."""

from __future__ import annotations

from typing import Final

ANALYTIC_STEPS: Final = 30
"""Taylor steps of 1 s of the paper's statue on its pedestal: 20 counted, two for each of ten events."""
ANALYTIC_TERMS: Final = 560
"""Taylor coefficients of the same run: 377 counted, some nineteen for each step at 1e-12."""
ACCURACY_STEPS: Final = 600
"""Steps of all runs together that 1e-3 rad may take on an easy scene of half a second: 403 counted."""
SPARE: Final = 1.15
"""Steps of a contact engine over duration/dt: what splitting impacts and halts may add."""
SPARE_SUBSTEPS: Final = 1.4
"""The same for an engine that sub-steps through impacts: 20 sub-steps at each impact or halt (1.16 counted at 0.25 ms)."""
ACCURACY_RUNS: Final = 2
"""Runs that 1e-3 rad may take on an easy scene: a rung and a finer one to check it."""
MODULES_OF_HELP: Final = 250
"""Modules imported to answer --help: 156 counted, 743 with scipy's integrators, which a run needs and --help does not."""
OUTCOME_ALLOCATED_KB: Final = 400
"""Peak of memory that an outcome of the analytic model allocates through Python: the motion's coefficients, no history."""
SAME_RAD: Final = 1e-9
"""What a skip may change of a peak that is integrated either way: the certified model's own reliable error is 1e-6."""
SKIP_RAD: Final = 2e-4
"""What a skip may change in a contact engine: contacts settle anew where integration begins, within the rung's own error."""

RIVAL_RAD: Final = 1e-6
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
