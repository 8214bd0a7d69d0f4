"""What a verdict knows of one of its two answers."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from harness.comparison.scores.pointwise import Peak, peak
from harness.model.history import History, Outcome
from harness.model.run import Run, number
from harness.records.run import STILL_RAD, standing

if TYPE_CHECKING:
    from harness.records.study import CaseRun

ACROSS: Final = (Outcome.OVERTURNED_FRONT, Outcome.OVERTURNED_BACK)
"""Falls of which the rotation in the rocking plane tells nothing."""


@dataclass(frozen=True)
class Side:
    """What the verdict needs to know of one run; None: not stated.

    `uncertainty_rad` and `slip_uncertainty_m` bound the numerical errors up to `reliable_until_s`; `horizon_s` is how far the
    model's own perturbed starts stay together; `left_domain_s` is when the model first broke one of its assumptions,
    `left_domain_by` which. `axes` are the axes of the floor's motion that it was given; `across_s` is when it
    left the rocking plane's balance across it: fell for good over its front or back, or ends leaning beyond it.
    `resolution_rad` and `resolution_m` are how far the digits of a file leave its history open. `floor_impact` is the coefficient
    of the floor that an engine takes at impacts, whatever the scene's choice; empty of one that takes the scene's.
    Of what no slip and no rotation that is compared tells, `statue_slip_m` is how far a statue that stands slid on its support,
    `slip_across_m` how far it slid across the plane, alone or with its pedestal, `out_of_plane_rad` how far it left the plane.
    """

    name: str
    peak: Peak
    outcome: Outcome | None = None
    uncertainty_rad: float | None = None
    slip_uncertainty_m: float | None = None
    reliable_until_s: float | None = None
    horizon_s: float | None = None
    left_domain_s: float | None = None
    left_domain_by: str = ""
    axes: tuple[str, ...] | None = None
    across_s: float | None = None
    resolution_rad: float = 0.0
    resolution_m: float = 0.0
    floor_impact: str = ""
    statue_slip_m: float = 0.0
    slip_across_m: float = 0.0
    out_of_plane_rad: float = 0.0
    no_return_s: float | None = None

    @property
    def rests(self) -> bool:
        """Whether the run was ended early because nothing moves any more, so that its last value holds."""
        return self.outcome is Outcome.STANDS

    @property
    def is_still(self) -> bool:
        """Whether its statue stands and is not said to rock, in the plane or out of it."""
        return self.rests and max(abs(self.peak.theta_rad), self.out_of_plane_rad) < STILL_RAD

    @property
    def open_rad(self) -> float:
        """How far the rotation may be off: its numerical error, zero where none is stated, and the digits it was written with."""
        return (self.uncertainty_rad or 0.0) + self.resolution_rad

    @property
    def open_m(self) -> float:
        """The same of the slip."""
        return (self.slip_uncertainty_m or 0.0) + self.resolution_m

    @property
    def until_s(self) -> float:
        """The time up to which this side's uncertainty holds and its problem is predictable."""
        known = [t for t in (self.reliable_until_s, self.horizon_s) if t is not None]
        return min(known, default=math.inf)


def side_of(
    answer: Run | CaseRun | History,
    name: str,
    horizon_s: float | None = None,
    uncertainty_rad: float | None = None,
    slip_uncertainty_m: float | None = None,
) -> Side:
    """What is known of one answer; a bare history states no outcome, and of its uncertainties only what is given here."""
    if isinstance(answer, History):
        return Side(
            name,
            peak(answer),
            uncertainty_rad=uncertainty_rad,
            slip_uncertainty_m=slip_uncertainty_m,
            horizon_s=horizon_s,
            resolution_rad=answer.resolution_rad,
            resolution_m=answer.resolution_m,
        )
    left_s, by = left_domain(answer)
    return Side(
        name,
        Peak(answer.peak_theta_rad, math.nan if answer.peak_time_s is None else answer.peak_time_s),
        answer.outcome,
        answer.numerical_uncertainty_rad,
        answer.slip_uncertainty_m,
        answer.reliable_until_s,
        horizon_s,
        left_s,
        by,
        None if answer.motion_axes is None else tuple(answer.motion_axes),
        _across_s(answer),
        floor_impact=str(answer.settings.get("floor_impact") or "") if isinstance(answer, Run) else "",
        statue_slip_m=standing(answer, "statue_slip_m") or 0.0,
        slip_across_m=number(answer.validity, "slip_across_m", 0.0),
        out_of_plane_rad=number(answer.validity, "out_of_plane_rad", 0.0),
        no_return_s=answer.no_return_time_s,
    )


def _across_s(run: Run | CaseRun) -> float | None:
    """When a run's statue left its balance across the rocking plane, untold by its rotation in that plane; else None."""
    if run.outcome in ACROSS:
        return run.no_return_time_s
    history = run.history if isinstance(run, Run) else None
    if run.outcome is not Outcome.UNDECIDED or history is None or "roll_rad" not in history.extra:
        return None
    return run.end_s if abs(history.extra["roll_rad"][-1]) > abs(history.theta_rad[-1]) else None


def left_domain(run: Run | CaseRun) -> tuple[float | None, str]:
    """When a run first left its model's domain (docs/model.md, section 5) and by what; (None, "") when it never did.

    By what is a code of `analytic.solution.LEFT_BY` or an outcome. Engines state it as `validity["left_domain_s"]` and
    `validity["left_domain_by"]`; a run that ends by lift-off or in the friction paradox leaves at its end.
    """
    stated = run.validity.get("left_domain_s")
    if isinstance(stated, (int, float)):
        return float(stated), str(run.validity.get("left_domain_by") or "")
    if run.outcome in (Outcome.LIFT_OFF, Outcome.FRICTION_PARADOX):
        return run.end_s, run.outcome.value
    return None, ""
