"""The analytic two-block model of a rocking statue on a sliding pedestal: plain numbers in, arrays out.

Names are loaded when first used, so that importing a motion does not start the compiler.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from analytic.block import Block as Block
    from analytic.block import Form as Form
    from analytic.block import Friction as Friction
    from analytic.block import Pedestal as Pedestal
    from analytic.block import Wall as Wall
    from analytic.certainty import Certified as Certified
    from analytic.certainty import certify as certify
    from analytic.errors import AnalyticInputError as AnalyticInputError
    from analytic.excitation import Excitation as Excitation
    from analytic.excitation import Harmonic as Harmonic
    from analytic.excitation import Pulse as Pulse
    from analytic.excitation import Record as Record
    from analytic.excitation import Rest as Rest
    from analytic.solution import Event as Event
    from analytic.solution import EventKind as EventKind
    from analytic.solution import Interval as Interval
    from analytic.solution import Outcome as Outcome
    from analytic.solution import Solution as Solution
    from analytic.solution import Validity as Validity
    from analytic.solver import simulate as simulate
    from analytic.sweep import Ensemble as Ensemble
    from analytic.sweep import ensemble as ensemble

_HOME: Final = {
    "AnalyticInputError": "analytic.errors",
    "Block": "analytic.block",
    "Certified": "analytic.certainty",
    "Ensemble": "analytic.sweep",
    "Event": "analytic.solution",
    "EventKind": "analytic.solution",
    "Excitation": "analytic.excitation",
    "Form": "analytic.block",
    "Friction": "analytic.block",
    "Harmonic": "analytic.excitation",
    "Interval": "analytic.solution",
    "Outcome": "analytic.solution",
    "Pedestal": "analytic.block",
    "Pulse": "analytic.excitation",
    "Record": "analytic.excitation",
    "Rest": "analytic.excitation",
    "Solution": "analytic.solution",
    "Validity": "analytic.solution",
    "Wall": "analytic.block",
    "certify": "analytic.certainty",
    "ensemble": "analytic.sweep",
    "simulate": "analytic.solver",
}
__all__ = sorted(_HOME)


def __getattr__(name: str) -> object:
    """Load a public name from its module."""
    if name not in _HOME:
        raise AttributeError(f"module 'analytic' has no attribute {name!r}")
    return getattr(import_module(_HOME[name]), name)
