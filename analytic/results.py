"""From a finished task to its solution."""

from __future__ import annotations

import math
from functools import cached_property
from typing import Final, NamedTuple, final

import numpy as np

from analytic.kernel import layout as at
from analytic.solution import KINDS, OUTCOMES, Doubts, Event, Outcome, Solution, Validity, Work

LEFT_BY: Final = ("", "the statue slides on its support", "contact is lost", "the pedestal itself tips")
"""Sentence of each of the kernel's codes for a limit passed."""


class Finished(NamedTuple):
    """A task and all that the kernel's ``run`` is called with."""

    runs: at.Runs
    arguments: tuple[at.Floats, ...]
    """Parameters, two motions, base (3), samples (4), history (5, n), events (m, N_EVENT)."""

    @property
    def s(self) -> at.Floats:
        """State."""
        return np.asarray(self.runs[0]["s"])

    @property
    def c(self) -> at.Ints:
        """Counts."""
        return np.asarray(self.runs[0]["c"])


def _optional(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _event(row: list[float]) -> Event:
    pivot = int(row[at.E_PIVOT])
    return Event(
        time_s=row[at.E_TIME],
        kind=KINDS[int(row[at.E_KIND])],
        pivot=pivot if pivot >= 0 else None,
        facet=int(row[at.E_FACET]),
        slide=int(row[at.E_SLIDE]),
        theta_rad=row[at.E_THETA],
        theta_rate_before_rad_s=row[at.E_OMEGA_BEFORE],
        theta_rate_after_rad_s=row[at.E_OMEGA_AFTER],
        slip_m=row[at.E_SLIP],
        slip_rate_before_m_s=row[at.E_RATE_BEFORE],
        slip_rate_after_m_s=row[at.E_RATE_AFTER],
        energy_j=row[at.E_ENERGY],
        feasible_states=int(row[at.E_TIED]),
        residual=row[at.E_RESIDUAL],
    )


@final
class Kept:
    """The kernel's results r, counts c and event rows, told as objects when they are asked for."""

    def __init__(self, r: list[float], c: list[int], rows: at.Floats, based: bool, valid: bool) -> None:
        """Keep them; based: on a pedestal; valid: whether the validity was kept."""
        self._r, self._c, self._rows, self._based, self._valid = r, c, rows, based, valid

    @cached_property
    def events(self) -> tuple[Event, ...]:
        """Every event."""
        return tuple(_event(row) for row in self._rows[: self._c[at.EVENTS]].tolist())

    @cached_property
    def validity(self) -> Validity | None:
        """How far the run stayed inside the model, None where that was not kept."""
        r, based = self._r, self._based
        if not self._valid:
            return None
        return Validity(
            pivot_friction_needed=r[at.PIVOT_FRICTION],
            pivot_friction_needed_at_impact=r[at.PIVOT_FRICTION_IMPACT],
            least_pivot_force_n=r[at.LEAST_V],
            least_floor_force_n=r[at.LEAST_N],
            pedestal_tipping_margin_m=_optional(r[at.TIP_MARGIN]) if based else None,
            pedestal_tipping_margin_at_impact_m=_optional(r[at.TIP_MARGIN_IMPACT]) if based else None,
            left_domain_s=_optional(r[at.LEFT_TIME]),
            left_domain_by=LEFT_BY[int(r[at.LEFT_BY])],
        )

    @cached_property
    def work(self) -> Work:
        """What the run cost and what it left out."""
        c = self._c
        return Work(
            steps=c[at.STEPS],
            taylor_coefficients=c[at.COEFFICIENTS],
            events=c[at.EVENTS],
            impacts=c[at.IMPACTS],
            quiet_samples_skipped=c[at.QUIET_SAMPLES],
            skipped_s=self._r[at.SKIPPED_S],
            ended_by_energy=bool(c[at.BY_ENERGY]),
        )

    @cached_property
    def doubts(self) -> Doubts:
        """What may make the run's numbers unsafe."""
        r, c = self._r, self._c
        return Doubts(
            ambiguous_states=c[at.TIES],
            near_tangent_steps=c[at.TANGENTS],
            dropped_rebounds=c[at.ZENO],
            worst_residual=r[at.RESIDUAL],
            outcome_margin=_optional(r[at.OUTCOME_MARGIN]),
            gave_up=bool(c[at.GAVE_UP]),
        )


def read(task: Finished) -> Solution:
    """The solution that a finished task holds; its arrays are read-only."""
    record, p, history, table = task.runs[0], task.arguments[0], task.arguments[-2], task.arguments[-1]
    s, r, q, c = (record[name].tolist() for name in "srqc")
    history.setflags(write=False)
    t, theta, theta_rate, slip, slip_rate = history[:, : q[at.GRID]]
    outcome = OUTCOMES[q[at.OUTCOME]]
    fell = outcome in (Outcome.OVERTURNED_LEFT, Outcome.OVERTURNED_RIGHT)
    return Solution(
        outcome=outcome,
        end_s=s[at.T],
        t_s=t,
        theta_rad=theta,
        theta_rate_rad_s=theta_rate,
        slip_m=slip,
        slip_rate_m_s=slip_rate,
        peak_theta_rad=abs(r[at.PEAK]),
        peak_signed_rad=r[at.PEAK],
        peak_time_s=r[at.PEAK_TIME],
        peak_slip_m=r[at.PEAK_SLIP],
        final_slip_m=s[at.S_U],
        overturn_time_s=_optional(r[at.OVERTURN_TIME]),
        no_return_time_s=_optional(r[at.NO_RETURN]) if fell else None,
        energy_lost_j=r[at.ENERGY_LOST],
        energy_gained_j=r[at.ENERGY_GAINED],
        details=Kept(r, c, table, p[at.HAS_BASE] > 0.0, p[at.WANT_VALIDITY] > 0.0),
    )
