"""What is to be computed (`Problem`) and how (`Options`), each stated once for one run, its certificate and an ensemble."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import Any, Final, Literal, Required, TypedDict, final

from analytic.block import Block, Form, Friction, Pedestal, Wall, positive
from analytic.constants import GRAVITY_M_S2, OVERTURN_RAD
from analytic.errors import AnalyticInputError
from analytic.excitation import Excitation, ZeroExcitation

CONSISTENT: Final = Form()
"""The form in which no event raises the energy (docs/model.md, section 4)."""


@final
@dataclass(frozen=True)
class Problem:
    """A statue on a moving floor, from its initial state to the end; SI units, rotations clockwise positive.

    floor_static, floor_kinetic, floor_impact: friction of the pedestal on the floor (`Friction`); statue_friction: between
    statue and support, assumed to hold and compared with what was needed. Raises AnalyticInputError for numbers that cannot be
    run.
    """

    block: Block
    motion_x: Excitation
    motion_z: Excitation
    duration_s: float
    pedestal: Pedestal | None = None
    floor_static: float = 0.0
    floor_kinetic: float = 0.0
    floor_impact: float | Literal["kinetic", "static"] = "kinetic"
    statue_friction: float = math.inf
    form: Form = CONSISTENT
    theta0_rad: float = 0.0
    theta_rate0_rad_s: float = 0.0
    gravity_m_s2: float = GRAVITY_M_S2
    wall: Wall | None = None
    overturn_rad: float = OVERTURN_RAD

    def __post_init__(self) -> None:
        """Check the numbers."""
        Friction(self.floor_static, self.floor_kinetic, self.floor_impact)
        theta0_rad, rate_rad_s, overturn_rad = self.theta0_rad, self.theta_rate0_rad_s, self.overturn_rad
        positive(duration_s=self.duration_s, gravity_m_s2=self.gravity_m_s2, overturn_rad=overturn_rad)
        if not overturn_rad < 0.5 * math.pi or not abs(theta0_rad) < overturn_rad or not math.isfinite(rate_rad_s):
            wanted = (
                f"|theta0_rad| < overturn_rad < π/2 and a finite rate are wanted, {theta0_rad!r}, {overturn_rad!r},"
            )
            raise AnalyticInputError(f"{wanted} {rate_rad_s!r} came.")
        if not self.statue_friction >= 0.0:
            raise AnalyticInputError(f"statue_friction: a number from 0 is wanted, {self.statue_friction!r} came.")
        if self.wall is not None:
            self._check_wall(self.wall)

    def _check_wall(self, wall: Wall) -> None:
        gap_m = wall.gap_m(self.block, self.theta0_rad)
        if not gap_m > 0.0:
            wanted = "wall: a start before it is wanted"
            raise AnalyticInputError(f"{wanted}, a statue that reaches {-gap_m:.6g} m beyond it came.")
        if self.pedestal is not None and not (gap_m := wall.pedestal_gap_m(self.block, self.pedestal)) > 0.0:
            raise AnalyticInputError(f"wall: one beside the pedestal is wanted, one {-gap_m:.6g} m inside it came.")


@final
@dataclass(frozen=True)
class Options:
    """How a problem is solved and what is kept.

    accuracy_rad: aimed global error (errors grow after many impacts: see ``certify``); dt_s: output step, None for the outcome
    only; step_cap_s: longest step; skip_start, skip_rest: leave out the times in which nothing can move, before anything has
    moved and after; skip_energy: without a history, let the energy decide once the motion is over; events, validity: keep them.
    Raises AnalyticInputError for numbers that cannot be used.
    """

    accuracy_rad: float = 1e-12
    dt_s: float | None = 0.001
    step_cap_s: float = math.inf
    skip_start: bool = True
    skip_rest: bool = True
    skip_energy: bool = True
    events: bool = True
    validity: bool = True

    def __post_init__(self) -> None:
        """Check the numbers."""
        positive(accuracy_rad=self.accuracy_rad)
        if self.dt_s is not None:
            positive(dt_s=self.dt_s)
        if not self.step_cap_s > 0.0:
            raise AnalyticInputError(f"step_cap_s: a positive number is wanted, {self.step_cap_s!r} came.")


class CommonKeywords(TypedDict, total=False):
    """The fields of `Problem` and `Options` as keywords of ``simulate``, ``certify`` and ``ensemble``."""

    duration_s: Required[float]
    pedestal: Pedestal | None
    floor_static: float
    floor_kinetic: float
    floor_impact: float | Literal["kinetic", "static"]
    statue_friction: float
    form: Form | None
    theta0_rad: float
    theta_rate0_rad_s: float
    gravity_m_s2: float
    wall: Wall | None
    overturn_rad: float
    dt_s: float | None
    skip_start: bool
    skip_rest: bool
    skip_energy: bool
    events: bool
    validity: bool


class Keywords(CommonKeywords, total=False):
    """Those too by which ``certify`` tells its own runs apart."""

    accuracy_rad: float
    step_cap_s: float


OPTIONS: Final = tuple(item.name for item in fields(Options))
DEFAULT_OPTIONS: Final = Options()


def stated(
    block: Block, motion_x: Excitation, motion_z: Excitation | None, keywords: Keywords
) -> tuple[Problem, Options]:
    """The problem and the options that keywords state; raises TypeError for an unknown one."""
    rest: dict[str, Any] = dict(keywords)
    options = Options(**{name: rest.pop(name) for name in OPTIONS if name in rest})
    if rest.get("form", True) is None:
        del rest["form"]
    return Problem(block, motion_x, motion_z if motion_z is not None else ZeroExcitation(), **rest), options
