"""A motion as the compiled kernel sees it: one row of numbers, and the samples of a record."""

from __future__ import annotations

from typing import Final

import numpy as np

from analytic.errors import AnalyticInputError
from analytic.excitation import Excitation, Harmonic, Pulse, Record, Rest
from analytic.kernel.layout import (
    AMPLITUDE,
    COSINE,
    END,
    HARMONIC,
    KIND,
    N_FORCING,
    RECTANGULAR,
    RICKER,
    SAMPLED,
    SCALE,
    SINE,
    START,
    Floats,
)

_PULSES: Final = {"rectangular": RECTANGULAR, "one_sine": SINE, "one_cosine": COSINE, "ricker": RICKER}


def encode(motion: Excitation) -> tuple[Floats, Floats, Floats]:
    """The motion's row of numbers (8,), and its samples' times (n,) and accelerations (n,), empty unless it is a record.

    Raises AnalyticInputError for a motion that the kernel does not know.
    """
    row, empty = np.zeros(N_FORCING), np.empty(0)
    if isinstance(motion, Rest) or motion.peak_m_s2 == 0.0:
        return row, empty, empty
    row[AMPLITUDE], row[SCALE] = motion.peak_m_s2, 1.0
    if isinstance(motion, Harmonic):
        row[:5] = HARMONIC, motion.amplitude_m_s2, motion.omega_rad_s, motion.phase_rad, motion.ramp_s
    elif isinstance(motion, Pulse):
        row[:4] = _PULSES[motion.shape], motion.amplitude_m_s2, motion.omega_rad_s, 0.0
        row[START], row[END] = motion.start_s, motion.end_s
    elif isinstance(motion, Record):
        row[KIND] = SAMPLED
        # Copies: a read-only array is another type, for which the whole kernel would be compiled again.
        return row, np.array(motion.t_s), np.array(motion.samples_m_s2)
    else:
        known = "Rest, Harmonic, Pulse or Record"
        raise AnalyticInputError(f"motion: {known} is wanted, {type(motion).__name__} came: sample it into a Record.")
    return row, empty, empty
