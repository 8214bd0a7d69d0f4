"""The analytic two-block model of a rocking statue on a sliding pedestal: plain numbers in, arrays out.

SI units; x to the right, z up; rotation θ clockwise positive (θ > 0 tips about the right corner). docs/model.md has the
equations and what they assume: a rigid body in one plane, no slip between statue and support, Coulomb friction of the
pedestal on the floor, impacts by angular momentum (or a prescribed ratio).

1. Describe the body: `Block.two_corners`, `Block.rectangle` or `Block.from_profile`; if it stands on one, a `Pedestal`.
2. Describe the floor's acceleration, m/s²: `Harmonic`, `Pulse`, `SampledAcceleration` (a record: linear between samples) or
   `ZeroExcitation`; `Record` and `Rest` are other names of the last two.
3. `simulate` gives a `Solution`: outcome, history, events, limits of the model; `solve` does the same for one `Problem` and its
   `Options`. `certify` adds how far its numbers hold.
   `ensemble` runs many parameter sets for their outcome.

A block 0.2 m wide and 1 m high, let go from half its balance angle, lands after 0.347 s and keeps 94 % of its rate:

>>> import math
>>> import analytic
>>> block = analytic.Block.rectangle(width_m=0.2, height_m=1.0, mass_kg=500.0)
>>> alpha_rad = block.alpha_rad(1)
>>> run = analytic.simulate(block, analytic.ZeroExcitation(), theta0_rad=0.5 * alpha_rad, duration_s=2.0)
>>> first = run.impacts[0]
>>> print(f"{first.time_s:.5f} s, {first.theta_rate_after_rad_s / first.theta_rate_before_rad_s:.4f}")
0.34709 s, 0.9423
>>> run.outcome
<Outcome.STANDS: 'stands'>

On a pedestal that slides, under a harmonic motion, with the certainty of the numbers:

>>> sure = analytic.certify(
...     block,
...     analytic.Harmonic(amplitude_m_s2=3.0, frequency_hz=2.0),
...     pedestal=analytic.Pedestal(mass_kg=200.0, width_m=0.4, height_m=0.2),
...     floor_static=0.25,
...     floor_kinetic=0.20,
...     duration_s=1.0,
... )
>>> sure.solution.peak_theta_rad > 0.0 and sure.uncertainty_rad < 1e-6
True

Which amplitudes and frequencies of a sine pulse overturn it:

>>> amplitude_m_s2, frequency_hz = [[2.0], [6.0]], [1.0, 8.0]
>>> runs = analytic.ensemble(
...     block,
...     analytic.Pulse("one_sine", 1.0, 1.0),
...     sweep={"amplitude_m_s2": amplitude_m_s2, "frequency_hz": frequency_hz},
...     duration_s=5.0,
... )
>>> runs.overturned.tolist()
[[False, False], [True, False]]

Closed-form answers are in `analytic.closed_form` (free rocking, Newmark sliding, similarity) and `analytic.pulse_response`
(sine pulses on a slender block, minimum overturning spectra). Numbers that cannot be run raise `AnalyticInputError`.

Names are loaded when first used, so that importing a motion does not start the compiler.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from analytic.block import AnalyticInputError, Block, Form, Friction, Pedestal, Wall
    from analytic.excitation import Excitation, Harmonic, Pulse, Record, Rest, SampledAcceleration, ZeroExcitation
    from analytic.problem import (
        CommonKeywords,
        Event,
        EventKind,
        Interval,
        Keywords,
        Options,
        Outcome,
        Problem,
        Solution,
        Validity,
    )
    from analytic.solver import Certified, certify, simulate, solve
    from analytic.sweep import Ensemble, ensemble

_NAMES: Final = {
    "analytic.block": "AnalyticInputError Block Form Friction Pedestal Wall",
    "analytic.excitation": "Excitation Harmonic Pulse Record Rest SampledAcceleration ZeroExcitation",
    "analytic.problem": "CommonKeywords Event EventKind Interval Keywords Options Outcome Problem Solution Validity",
    "analytic.solver": "Certified certify simulate solve",
    "analytic.sweep": "Ensemble ensemble",
}
"""The public names by their modules."""
_HOME: Final = {name: module for module, names in _NAMES.items() for name in names.split()}
__all__ = [
    "AnalyticInputError", "Block", "Certified", "CommonKeywords", "Ensemble", "Event", "EventKind", "Excitation",
    "Form", "Friction", "Harmonic", "Interval", "Keywords", "Options", "Outcome", "Pedestal", "Problem", "Pulse",
    "Record", "Rest", "SampledAcceleration", "Solution", "Validity", "Wall", "ZeroExcitation", "certify",
    "ensemble", "simulate", "solve",
]  # fmt: skip


def __getattr__(name: str) -> object:
    """Load a public name from its module."""
    if name not in _HOME:
        raise AttributeError(f"module 'analytic' has no attribute {name!r}")
    globals()[name] = value = getattr(import_module(_HOME[name]), name)
    return value


def __dir__() -> list[str]:
    """The public names too, loaded or not."""
    return sorted({*globals(), *__all__})
