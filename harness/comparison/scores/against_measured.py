"""A simulation against a measurement: the comparison error E = S − D and the uncertainties of both (ASME V&V 20)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from harness.comparison.scores.pointwise import Peak, rms
from harness.model.errors import InputError, Mistake
from harness.model.finding import Finding, caution, info
from harness.model.history import Pair
from harness.records.scores import ComparisonError

RECTANGLE: Final = 1.0 / math.sqrt(3.0)
"""Standard uncertainty of what is only known to lie within ± 1 (GUM, 4.3.7): a stated numerical error is such a bound."""
COVERAGE: Final = 2.0
"""Standard uncertainties within which 95 % of errors lie."""
LARGEST_RAD: Final = 1.0


@dataclass(frozen=True)
class Measured:
    """Standard uncertainties, rad, of a measured rotation, and of a computed one because its inputs are not known."""

    data_rad: float
    input_rad: float = 0.0

    def __post_init__(self) -> None:
        for name, value in (("--measured-uncertainty", self.data_rad), ("--input-uncertainty", self.input_rad)):
            if not 0.0 <= value < LARGEST_RAD:
                raise InputError(Mistake(name, "", f"a rotation from 0 to {LARGEST_RAD:g} rad", f"{value!r}"))


def comparison_error(
    within: Pair, peaks: tuple[Peak, Peak], numerical_rad: float, measured: Measured
) -> tuple[ComparisonError, Finding]:
    """E of the largest rotation and over the history of a simulation (first) against a measurement, and what it says.

    `numerical_rad` bounds the simulation's numerical error. ASME V&V 20-2009, section 1: u_val² = u_num² + u_input² + u_D², and
    the model's own error lies within E ± 2 u_val.
    """
    simulated, seen = (abs(each.theta_rad) for each in peaks)
    own = RECTANGLE * numerical_rad
    total = math.hypot(own, measured.input_rad, measured.data_rad)
    beyond = np.abs(within.difference_rad) > COVERAGE * total
    found = ComparisonError(
        simulated_rad=simulated,
        measured_rad=seen,
        error_rad=simulated - seen,
        rms_error_rad=rms(within, within.difference_rad),
        beyond_share=float(within.weights_s @ beyond / within.weights_s.sum()),
        u_num_rad=own,
        u_input_rad=measured.input_rad,
        u_data_rad=measured.data_rad,
        u_val_rad=total,
    )
    apart = abs(found.error_rad) > COVERAGE * total
    values = {
        "error_rad": found.error_rad,
        "u_val_rad": total,
        "beyond_share": found.beyond_share,
        "low_rad": found.error_rad - COVERAGE * total,
        "high_rad": found.error_rad + COVERAGE * total,
        "u_num_rad": own,
        "u_input_rad": measured.input_rad,
        "u_data_rad": measured.data_rad,
    }
    return found, caution("model_error", **values) if apart else info("model_error_not_told", **values)
