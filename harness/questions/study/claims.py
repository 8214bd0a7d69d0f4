"""Claims of publications, each tested by each model from the rows of a study; verdicts are computed, never typed.

One of them weighs impacts: what each costs, the energy of the rotation about the corner before and after, from a history.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.engines.stepping.loop import IMPOSED_LABEL
from harness.model.history import History
from harness.questions.study import claim_tests as tests
from harness.questions.study.claim_tests import ClaimRun, Test
from harness.records.run import in_domain
from harness.records.study import ClaimAnswer, ClaimVerdict, StudyRow

HOLDS: Final[ClaimAnswer] = "holds"
FAILS: Final[ClaimAnswer] = "does not hold"
SOME: Final[ClaimAnswer] = "holds for some"
UNTESTED: Final[ClaimAnswer] = "not tested"

SETS: Final[Mapping[str, tuple[str, ...]]] = {
    "paper": ("i", "ii", "iii", "iv", "v", "vi", "vii", "viii", "ix", "xi", "xii"),
    "pedestal": ("i", "ii", "iii", "iv", "v", "vii", "viii", "ix"),
    "planes": ("x",),
}
"""By the key `claims` of a study: all of the paper but the plane, those that need no wall and no ratio, the plane."""
SETTLING_S: Final = 0.003
"""The contact engines' impacts take up to two steps of 1 ms: rates are read this long before and after, and drawn out."""
RESTS_RAD_S: Final = 5e-3
"""A statue slower than this does not strike: the contact engines' statues tremble about rest at some 1e-3 rad/s."""


def judge(rows: Iterable[StudyRow], top_m: float, asked: str = "paper") -> list[ClaimVerdict]:
    """The claims of the set `asked` by all models of a study's rows.

    Where an engine had the impact law imposed on it, all models of that variant count as imposed: they are there to be compared
    with it. The paper's form alone has its ratio as its own law.

    `top_m` is the horizontal displacement of the statue's top at the rotation `WALL_RAD`.
    """
    models: dict[tuple[str, str], list[ClaimRun]] = {}
    imposed_variants = set()
    for row in rows:
        if row.run is not None and in_domain(row.run):
            variant = str(row.varied["variant"])
            models.setdefault((row.engine, variant), []).append(tests.answer(row.run, row.varied))
            if IMPOSED_LABEL in row.run.labels:
                imposed_variants.add(variant)
    by_claim: dict[str, Test] = {**tests.TESTS, "vi": partial(tests.wall_limit, top_m=top_m)}
    verdicts = []
    for (engine, variant), answers in models.items():
        model, imposed = f"{engine} ({variant})", variant in imposed_variants
        for claim in SETS[asked]:
            held, cases, evidence, *parts = by_claim[claim](answers)
            untested = parts[0] if parts else ()
            said = _verdict(held, cases, untested)
            verdicts.append(ClaimVerdict(claim, model, imposed, said, held, cases, evidence, untested))
    return verdicts


def headline(verdicts: Sequence[ClaimVerdict]) -> dict[str, str]:
    """One verdict for each claim from the models whose impact was not imposed: what they all say, or that they differ."""
    said_by_claim: dict[str, str] = {}
    for claim in dict.fromkeys(v.claim for v in verdicts):
        said = {v.verdict for v in verdicts if v.claim == claim and not v.imposed and v.verdict != UNTESTED}
        said_by_claim[claim] = said.pop() if len(said) == 1 else ("the models differ" if said else UNTESTED)
    return said_by_claim


def _verdict(held: int, cases: int, untested: Sequence[str]) -> ClaimAnswer:
    """A claim of which a part was never tested does not hold as a whole."""
    if cases == 0:
        return UNTESTED
    return HOLDS if held == cases and not untested else (SOME if held else FAILS)


def last_impact_s(history: History) -> float:
    """When the statue last struck its support: where θ changes its sign, faster than one that rests; 0 where it never did."""
    theta, rate = history.theta_rad, history.theta_rate_rad_s
    strikes = np.flatnonzero((theta[:-1] * theta[1:] < 0.0) & (np.abs(rate[:-1]) >= RESTS_RAD_S))
    return float(history.t_s[strikes[-1]]) if strikes.size else 0.0


def energy_lost_j(history: History, pivot_inertia_kg_m2: Mapping[int, float]) -> NDArray[np.float64]:
    """Energy lost in each impact (J): I_pivot θ̇²/2 before less that after, the inertia by the side turned to (docs/model.md).

    An impact is where θ changes its sign: the engines' own lists of impacts count contacts, and not at the same instant. Rates
    are drawn out to it in a straight line. Impacts nearer to another than four times `SETTLING_S` are chattering and left out.
    """
    t_s, theta, rate = history.t_s, history.theta_rad, history.theta_rate_rad_s
    if t_s.size < 3:
        return np.zeros(0)
    settling = max(1, round(SETTLING_S / float(t_s[1] - t_s[0])))
    crossing = np.flatnonzero(theta[:-1] * theta[1:] < 0.0)
    gaps = np.diff(crossing, prepend=0, append=t_s.size - 1)
    crossing = crossing[(gaps[:-1] >= 4 * settling) & (gaps[1:] >= 4 * settling)]
    crossing = crossing[np.abs(rate[crossing - settling]) >= RESTS_RAD_S]
    share = theta[crossing] / (theta[crossing] - theta[crossing + 1])
    impact_s = t_s[crossing] + share * (t_s[crossing + 1] - t_s[crossing])

    def energy(near: NDArray[np.int64], beyond: NDArray[np.int64]) -> NDArray[np.float64]:
        slope = (rate[near] - rate[beyond]) / (t_s[near] - t_s[beyond])
        at_impact = rate[near] + slope * (impact_s - t_s[near])
        inertia = np.where(theta[near] > 0.0, pivot_inertia_kg_m2[1], pivot_inertia_kg_m2[-1])
        return np.asarray(0.5 * inertia * at_impact**2)

    first, last = crossing - settling, crossing + 1 + settling
    return energy(first, first - 1) - energy(last, last + 1)
