"""The coefficients of DOP853: an explicit Runge-Kutta step of order 8 with errors of order 5 and 3 inside it.

Hairer, Nørsett and Wanner, Solving Ordinary Differential Equations I, 2nd ed., section II.10.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from scipy.integrate import DOP853

from analytic.kernel.records import Floats

STAGES: Final = 12
"""Evaluations of a step; the next step's first is one more."""
C: Final[Floats] = DOP853.C[:STAGES].copy()
"""Places of the stages in the step."""
# Contiguous, as compiled code reads them; scipy keeps those of its dense output in the same table.
A: Final[Floats] = np.ascontiguousarray(DOP853.A[:STAGES, :STAGES])
"""What each stage takes of those before it."""
B: Final[Floats] = DOP853.B.copy()
"""What the step takes of its stages."""
# Scipy's weights have one more, of the next step's first stage, which is nought.
E3: Final[Floats] = DOP853.E3[:STAGES].copy()
"""Weights of the error of order 3, and"""
E5: Final[Floats] = DOP853.E5[:STAGES].copy()
"""of order 5."""
