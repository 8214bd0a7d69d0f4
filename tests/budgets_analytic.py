"""Budgets of the analytic tests, each with the sentence that derives it."""

from typing import Final

QUADRATURE_REL: Final = 5e-8
"""A trapezoidal sum of 200 001 samples of the tested motions errs by (ωh)²/12 ≈ 1e-8 of the peak; five times that."""
