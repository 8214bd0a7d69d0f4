"""From a finished task to its solution."""

from __future__ import annotations

import ctypes
import math
from functools import cached_property
from struct import Struct
from typing import Any, Final, NamedTuple, Self, final

import numpy as np
from numpy.typing import NDArray

from analytic.kernel.layout import EVENT_ROW, TASK, packing
from analytic.kernel.records import Base, Counts, EventRow, MotionParams, Output, Params, Records, Results, State
from analytic.machine_code import Entry
from analytic.solution import KINDS, OUTCOMES, Doubts, Event, Outcome, Solution, Validity, Work

LEFT_BY: Final = ("", "the statue slides on its support", "contact is lost", "the pedestal itself tips")
"""Sentence of each of the kernel's codes for a limit passed."""


run: Final = Entry("analytic.kernel.entries", "run")
ALONE: Final = (0, 0, 0, 0, 0, 1, 0, 0, 0)
"""Arguments after a task that is run as it stands."""


def address(memory: bytearray) -> int:
    """Where it stands, for as long as it lives."""
    return ctypes.addressof(ctypes.c_char.from_buffer(memory))


def _offset(*names: str) -> int:
    """Where a record stands in a task, bytes."""
    place, record = 0, TASK
    for name in names:
        assert record.fields is not None
        place, record = place + record.fields[name][1], record.fields[name][0]
    return place


_PARAMS, _STATE, _RESULTS = _offset("params"), _offset("state"), _offset("results")
_BASE, _OUTPUT = _offset("base"), _offset("output")
_COUNTS, _EVENTS, _SAMPLES = _offset("counts"), _offset("counts", "events"), _offset("output", "next_sample")
_MOTION_X, _MOTION_Z = _offset("motion_x", "params"), _offset("motion_z", "params")
_PACKING: Final = {each: packing(each) for each in (Params, MotionParams, Base, Output, State, Results, Counts)}
_INTEGER: Final = Struct("q")
NO_HISTORY: Final[NDArray[np.float64]] = np.zeros((5, 0))
NO_EVENTS: Final[Records] = np.zeros(0, EVENT_ROW)


class Prepared(NamedTuple):
    """The memory of a task, and what it knows by address only."""

    memory: bytearray
    history: NDArray[np.float64]
    """Rows of t, θ, θ̇, u, u̇, (5, n)."""
    events: Records
    """(m,)"""
    owners: tuple[object, ...]
    """Whose numbers motions and base name by address: kept alive."""

    @classmethod
    def of(
        cls,
        params: Params,
        motions: tuple[MotionParams, MotionParams],
        base: Base,
        instants: int,
        event_rows: int,
        *owners: object,
    ) -> Self:
        """A task with its parameters written, and room for so many instants and events."""
        memory = bytearray(TASK.itemsize)
        history, events = np.zeros((5, instants)), np.zeros(event_rows, EVENT_ROW)
        output = Output(history.ctypes.data, max(instants - 1, 0), 0, events.ctypes.data, event_rows)
        places = (_PARAMS, params), (_MOTION_X, motions[0]), (_MOTION_Z, motions[1]), (_BASE, base), (_OUTPUT, output)
        for place, record in places:
            _PACKING[type(record)].pack_into(memory, place, *vars(record).values())
        return cls(memory, history, events, owners)

    def run(self) -> None:
        """Run the task."""
        run(address(self.memory), *ALONE)

    @property
    def state(self) -> State:
        """The state that the run ended in."""
        return State(*_PACKING[State].unpack_from(self.memory, _STATE))

    @property
    def results(self) -> Results:
        """What the run left behind."""
        return Results(*_PACKING[Results].unpack_from(self.memory, _RESULTS))

    @property
    def counts(self) -> Counts:
        """How often what happened."""
        return Counts(*_PACKING[Counts].unpack_from(self.memory, _COUNTS))

    @property
    def n_samples(self) -> int:
        """Output samples written."""
        return int(_INTEGER.unpack_from(self.memory, _SAMPLES)[0])

    @property
    def n_events(self) -> int:
        """Events of the run, whether or not the table had room for them."""
        return int(_INTEGER.unpack_from(self.memory, _EVENTS)[0])


def _optional(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _event(given: tuple[Any, ...]) -> Event:
    event = EventRow(*given)
    return Event(
        time_s=event.time_s,
        kind=KINDS[event.kind],
        pivot=event.pivot if event.pivot >= 0 else None,
        facet=event.facet,
        slide=event.slide,
        theta_rad=event.theta_rad,
        theta_rate_before_rad_s=event.theta_rate_before_rad_s,
        theta_rate_after_rad_s=event.theta_rate_after_rad_s,
        slip_m=event.slip_m,
        slip_rate_before_m_s=event.slip_rate_before_m_s,
        slip_rate_after_m_s=event.slip_rate_after_m_s,
        energy_j=event.energy_j,
        feasible_states=event.feasible_states,
        residual=event.residual,
    )


@final
class RunDetails:
    """The kernel's results, counts and event rows, as objects when they are asked for."""

    def __init__(self, params: Params, results: Results, counts: Counts, events: Records) -> None:
        """Keep them."""
        self._params, self._results, self._counts, self._rows = params, results, counts, events

    @cached_property
    def events(self) -> tuple[Event, ...]:
        """Every event."""
        return tuple(_event(each) for each in self._rows.tolist())

    @cached_property
    def validity(self) -> Validity | None:
        """How far the run stayed inside the model, None where that was not kept."""
        r, on_pedestal = self._results, self._params.has_pedestal
        if not self._params.keep_validity:
            return None
        return Validity(
            pivot_friction_needed=r.pivot_friction,
            pivot_friction_needed_at_impact=r.pivot_friction_at_impact,
            least_pivot_force_n=r.least_pivot_normal_n,
            least_floor_force_n=r.least_floor_normal_n,
            pedestal_tipping_margin_m=_optional(r.tipping_margin_m) if on_pedestal else None,
            pedestal_tipping_margin_at_impact_m=_optional(r.tipping_margin_at_impact_m) if on_pedestal else None,
            left_domain_s=_optional(r.left_domain_s),
            left_domain_by=LEFT_BY[r.left_domain_by],
        )

    @cached_property
    def work(self) -> Work:
        """What the run cost and what it left out."""
        c = self._counts
        return Work(
            steps=c.steps,
            taylor_coefficients=c.coefficients,
            events=c.events,
            impacts=c.impacts,
            quiet_samples_skipped=c.quiet_samples,
            skipped_s=self._results.skipped_s,
            ended_by_energy=c.energy_endings > 0,
        )

    @cached_property
    def doubts(self) -> Doubts:
        """What may make the run's numbers unsafe."""
        r, c = self._results, self._counts
        return Doubts(
            ambiguous_states=c.ties,
            near_tangent_steps=c.tangents,
            dropped_rebounds=c.dropped_rebounds,
            worst_residual=r.event_residual,
            outcome_margin=_optional(r.outcome_margin),
            gave_up=c.given_up > 0,
        )


def read(params: Params, finished: Prepared) -> Solution:
    """The solution that a finished task holds; its arrays are read-only."""
    history, events = finished.history, finished.events
    history.setflags(write=False)
    written = history[:, : finished.n_samples], events[: finished.n_events]
    return solution_of(params, finished.state, finished.results, finished.counts, *written)


def solution_of(
    params: Params,
    state: State,
    results: Results,
    counts: Counts,
    history: NDArray[np.float64] = NO_HISTORY,
    events: Records = NO_EVENTS,
) -> Solution:
    """The solution that the kernel's records say; without a history (5, n) and events (m,) that of the outcome alone."""
    t, theta, theta_rate, slip, slip_rate = history
    outcome = OUTCOMES[state.outcome]
    overturned = outcome in (Outcome.OVERTURNED_LEFT, Outcome.OVERTURNED_RIGHT)
    return Solution(
        outcome=outcome,
        end_s=state.time_s,
        t_s=t,
        theta_rad=theta,
        theta_rate_rad_s=theta_rate,
        slip_m=slip,
        slip_rate_m_s=slip_rate,
        peak_theta_rad=abs(results.peak_theta_rad),
        peak_signed_rad=results.peak_theta_rad,
        peak_time_s=results.peak_time_s,
        peak_slip_m=results.peak_slip_m,
        final_slip_m=state.slip_m,
        overturn_time_s=_optional(results.overturn_time_s),
        no_return_time_s=_optional(results.no_return_time_s) if overturned else None,
        energy_lost_j=results.energy_lost_j,
        energy_gained_j=results.energy_gained_j,
        details=RunDetails(params, results, counts, events),
    )
