"""The analytic two-block model of a rocking statue on a sliding pedestal: plain numbers in, arrays out.

Names are loaded when first used, so that importing a motion does not start the compiler.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from analytic.errors import AnalyticInputError as AnalyticInputError
    from analytic.excitation import Excitation as Excitation
    from analytic.excitation import Harmonic as Harmonic
    from analytic.excitation import Pulse as Pulse
    from analytic.excitation import Record as Record
    from analytic.excitation import Rest as Rest

_HOME: Final = {
    "AnalyticInputError": "analytic.errors",
    "Excitation": "analytic.excitation",
    "Harmonic": "analytic.excitation",
    "Pulse": "analytic.excitation",
    "Record": "analytic.excitation",
    "Rest": "analytic.excitation",
}
__all__ = sorted(_HOME)


def __getattr__(name: str) -> object:
    """Load a public name from its module."""
    if name not in _HOME:
        raise AttributeError(f"module 'analytic' has no attribute {name!r}")
    return getattr(import_module(_HOME[name]), name)
