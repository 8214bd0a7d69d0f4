"""Tolerances of the harness's own tests, each with the sentence that derives it."""

from __future__ import annotations

from typing import Final

HERMITE_ROUNDING: Final = 4e-16
"""A cubic is reproduced exactly; a handful of operations on numbers below one leave a few units of 1.1e-16."""
LIMIT_ROUNDING: Final = 1e-15
"""A limit is two or three products of numbers given exactly: a few units of 1.1e-16."""

FILE_LINES: Final = 300
"""Lines of a module: some five screens, which one reader holds at once."""

MEDIAN_FILE_LINES: Final = 150
"""Half of all modules are shorter: two screens and a half."""

LEAST_FILE_LINES: Final = 25
"""A module of fewer lines that serves one other only is a detour for its reader."""

FUNCTION_LINES: Final = 60
"""Lines of a function with its docstring: one screen."""

COMPLEXITY: Final = 10
"""McCabe's own bound for the independent paths through a function (IEEE Trans. Softw. Eng. SE-2, 1976)."""

COMPLEX_SHARE: Final = 0.02
"""Functions that may pass it, for loops that step through time: 0.3 % do."""

IMPACT_LOSS_REL: Final = 1e-2
"""Drawn out over 4 ms a rate misses by half its second derivative, 60 rad/s³, times 16e-6 s²: 5e-4 of 0.2, twice in energy."""
