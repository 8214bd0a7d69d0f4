"""Many problems with their certificates, for the outcome alone: what `certify` says of each, by two compiled sweeps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple, final

import numpy as np
from numpy.typing import NDArray

from analytic.certainty import PARTED, SAFETY, SECOND_RUN_SHARE, Certified, certified, longest_step_s, rounding
from analytic.encode import encode, encode_base, encode_motion
from analytic.excitation import Excitation
from analytic.kernel.layout import BASE, MOTION_PARAMS, PARAMS, row
from analytic.kernel.records import Counts, Floats, Params, Records, Results, State
from analytic.problem import Options, Problem
from analytic.results import Solution, solution_of
from analytic.sweep import Out, Rows, run_rows

Motions = tuple[Excitation, Excitation]
"""The floor's accelerations along x and z."""


class Body(NamedTuple):
    """A problem without its motion, as its two runs read it: what many problems share is encoded once."""

    problem: Problem
    params: Params
    checked: Params
    """Of the run that checks the first, except its gravity, which follows from the steps of that."""


def body_of(problem: Problem, accuracy_rad: float) -> Body:
    """Encode a problem for runs of that accuracy; its motion is left out."""
    first = Options(accuracy_rad=accuracy_rad, dt_s=None, events=False)
    cap_s = 0.5 * longest_step_s(problem.block, problem.gravity_m_s2)
    finer = replace(first, accuracy_rad=accuracy_rad * SECOND_RUN_SHARE, step_cap_s=cap_s, validity=False)
    return Body(problem, encode(problem, first), encode(problem, finer))


@final
@dataclass(frozen=True, eq=False)
class CertifiedRows:
    """The answers of many problems, (n,): of the run that counts and of the one that checks it, and what their difference says.

    Uncertainties of peak rotation, rad, and peak slip, m, and until when they hold, s.
    """

    bodies: Sequence[Body]
    body: NDArray[np.int64]
    """Of each row, by its place in `bodies`."""
    first: Out
    other: Out
    uncertainty_rad: Floats
    slip_uncertainty_m: Floats
    reliable_until_s: Floats
    accuracy_rad: float

    @property
    def doubtful(self) -> NDArray[np.bool_]:
        """Whether there is anything to warn of."""
        first, counts = self.first.results, self.first.counts
        unsure = self.first.states["outcome"] != self.other.states["outcome"]
        unsure |= self.reliable_until_s < self.first.states["time_s"]
        for name in ("given_up", "tangents", "ties", "dropped_rebounds"):
            unsure |= counts[name] > 0
        unsure |= np.isfinite(first["outcome_margin"]) | np.isfinite(first["left_domain_s"])
        return np.asarray(unsure | (first["energy_gained_j"] > 0.0))

    def certified(self, i: int) -> Certified:
        """One of them, as ``certify`` gives it."""
        one = self.bodies[self.body[i]]
        first, other = _solution(one.params, self.first, i), _solution(one.checked, self.other, i)
        accuracy = self.accuracy_rad, self.accuracy_rad * one.problem.block.centroid_height_m
        return certified(first, (other,), accuracy)


def certify_rows(
    bodies: Sequence[Body], body: NDArray[np.int64], motions: Sequence[Motions], accuracy_rad: float
) -> CertifiedRows:
    """Run every problem twice: of row i the body is `bodies[body[i]]`, the motion `motions[i]` (equal objects are encoded once).

    `accuracy_rad` is the error up to which a peak counts as reliable, as in ``certify``.
    """
    sides = _encoded(motions)
    bases = np.array([row(encode_base(one.problem)) for one in bodies], BASE)[body]
    params = np.array([row(one.params) for one in bodies], PARAMS)[body]
    first = _run(Rows(params, *sides[:2], bases, sides[2]))
    finer = np.array([row(one.checked) for one in bodies], PARAMS)[body]
    finer["gravity_m_s2"] *= 1.0 + rounding(first.counts["steps"])
    finer["time_scale_s"] = _time_scale_s(bodies, body, finer["gravity_m_s2"])
    other = _run(Rows(finer, *sides[:2], bases, sides[2]))
    a, b = first.results, other.results
    turned = SAFETY * np.abs(np.abs(b["peak_theta_rad"]) - np.abs(a["peak_theta_rad"]))
    slid = SAFETY * np.abs(b["peak_slip_m"] - a["peak_slip_m"])
    most = PARTED * np.maximum(a["energy_lost_j"], b["energy_lost_j"])
    parted = np.abs(b["energy_lost_j"] - a["energy_lost_j"]) > most
    until = np.where(parted, np.minimum(a["peak_time_s"], b["peak_time_s"]), first.states["time_s"])
    until = np.where(turned <= accuracy_rad, until, 0.0)
    return CertifiedRows(bodies, body, first, other, turned, slid, until, accuracy_rad)


def _encoded(motions: Sequence[Motions]) -> tuple[Records, Records, tuple[Floats, ...]]:
    """Motions along x and z row by row, and the samples that the kernel knows by their address."""
    known: dict[int, tuple[object, ...]] = {}
    samples: list[Floats] = []

    def values(motion: Excitation) -> tuple[object, ...]:
        if id(motion) not in known:
            params, times, accels = encode_motion(motion)
            samples.extend((times, accels))
            known[id(motion)] = row(params)
        return known[id(motion)]

    sides = [np.array([values(pair[k]) for pair in motions], MOTION_PARAMS) for k in (0, 1)]
    return sides[0], sides[1], tuple(samples)


def _run(rows: Rows) -> Out:
    out = Out.of(rows.params.size)
    run_rows(rows, out, 0, rows.params.size)
    return out


def _time_scale_s(bodies: Sequence[Body], body: NDArray[np.int64], gravity_m_s2: Floats) -> Floats:
    """1/p of each row's faster outer corner, s, to the last bit as `Block.p_rad_s` has it."""
    p = np.zeros(body.size)
    mass = np.array([one.problem.block.mass_kg for one in bodies])[body]
    for side in (1, -1):
        radius = np.array([one.problem.block.radius_m(side) for one in bodies])[body]
        inertia = np.array([one.problem.block.inertia_corner_kg_m2(side) for one in bodies])[body]
        p = np.maximum(p, np.sqrt(mass * gravity_m_s2 * radius / inertia))
    return np.asarray(1.0 / p)


def _solution(params: Params, out: Out, i: int) -> Solution:
    state, results, counts = (rows[i].item() for rows in out)
    return solution_of(params, State(*state), Results(*results), Counts(*counts))
