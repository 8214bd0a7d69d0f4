"""The paper's six claims, each tested by each model from the rows of its study; verdicts are computed, never typed."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import Any, Final

import numpy as np

from harness.engines.contact.impact import IMPOSED_LABEL
from harness.model.history import Outcome
from harness.records.study import CaseRun, ClaimAnswer, ClaimVerdict, StudyRow, Value

LOW_HZ: Final = 3.0
"""The paper's bound between the frequencies at which the pedestal helps and those at which it does not."""
FEW_CENTIMETRES_M: Final = 0.05
"""What "a few centimetres" of pedestal displacement is taken to mean."""
WALL_RAD: Final = 0.50
WALL_M: Final = 0.70
WALL_SLACK: Final = 0.05
"""The paper rounds its distance to the wall to a decimetre."""

HOLDS: Final[ClaimAnswer] = "holds"
FAILS: Final[ClaimAnswer] = "does not hold"
SOME: Final[ClaimAnswer] = "holds for some"
UNTESTED: Final[ClaimAnswer] = "not tested"

SENTENCES: Final[Mapping[str, str]] = {
    "i": "up to 3 Hz the statue without pedestal rotates more and overturns sooner",
    "ii": "in some cases the pedestal prevents overturning",
    "iii": "the pedestal's advantage fades above 3 Hz",
    "iv": "the rotation falls with frequency",
    "v": "the pedestal's displacement stays within a few centimetres",
    "vi": "0.50 rad, 0.70 m at the top, is the limit set by the wall",
}


Test = Callable[[Sequence["Answer"]], tuple[int, int, str]]


@dataclass(frozen=True)
class Answer:
    """One run of the table: what was set and what came out."""

    restitution: float
    amplitude_g: float
    frequency_hz: float
    pedestal: bool
    peak_rad: float
    overturned: bool
    stands: bool
    no_return_s: float
    slip_m: float

    @property
    def condition(self) -> tuple[float, float, float]:
        """What both settings share."""
        return self.restitution, self.amplitude_g, self.frequency_hz


def judge(rows: Iterable[StudyRow], top_displacement_m: Callable[[float], float]) -> list[ClaimVerdict]:
    """All claims by all models of a study's rows.

    Where an engine had the impact law imposed on it, all models of that variant count as imposed: they are there to be compared
    with it. The paper's form alone has its ratio as its own law.

    `top_displacement_m(theta_rad)` is the horizontal displacement of the statue's top at a rotation towards the wall.
    """
    models: dict[tuple[str, str], list[Answer]] = {}
    imposed_variants = set()
    for row in rows:
        if row.run is not None:
            variant = str(row.varied["variant"])
            models.setdefault((row.engine, variant), []).append(_answer(row.run, row.varied))
            if IMPOSED_LABEL in row.run.labels:
                imposed_variants.add(variant)
    verdicts = []
    for (engine, variant), answers in models.items():
        model, imposed = f"{engine} ({variant})", variant in imposed_variants
        tests: tuple[Test, ...] = (_i, _ii, _iii, _iv, _v, partial(_vi, top_displacement_m=top_displacement_m))
        for claim, test in zip(SENTENCES, tests, strict=True):
            held, cases, evidence = test(answers)
            verdicts.append(
                ClaimVerdict(claim, SENTENCES[claim], model, imposed, _verdict(held, cases), held, cases, evidence)
            )
    return verdicts


def headline(verdicts: Sequence[ClaimVerdict]) -> dict[str, str]:
    """One verdict for each claim from the models whose impact was not imposed: what they all say, or that they differ."""
    said_by_claim: dict[str, str] = {}
    for claim in SENTENCES:
        said = {v.verdict for v in verdicts if v.claim == claim and not v.imposed and v.verdict != UNTESTED}
        said_by_claim[claim] = said.pop() if len(said) == 1 else ("the models differ" if said else UNTESTED)
    return said_by_claim


def _answer(run: CaseRun, varied: Mapping[str, Value]) -> Answer:
    overturned = run.outcome.overturned
    return Answer(
        restitution=float(varied["contact.restitution"]),
        amplitude_g=float(varied["motion.x.amplitude_g"]),
        frequency_hz=float(varied["motion.x.frequency_hz"]),
        pedestal=varied["pedestal"] != "none",
        peak_rad=abs(run.peak_theta_rad),
        overturned=overturned,
        stands=run.outcome is Outcome.STANDS,
        no_return_s=run.no_return_time_s if overturned and run.no_return_time_s is not None else math.inf,
        slip_m=run.peak_slip_m,
    )


def _verdict(held: int, cases: int) -> ClaimAnswer:
    if cases == 0:
        return UNTESTED
    return HOLDS if held == cases else (SOME if held else FAILS)


def _pairs(answers: Sequence[Answer]) -> list[tuple[Answer, Answer]]:
    """(without, with) pedestal of the same condition."""
    floor = {item.condition: item for item in answers if not item.pedestal}
    return [(floor[item.condition], item) for item in answers if item.pedestal and item.condition in floor]


def _i(answers: Sequence[Answer]) -> tuple[int, int, str]:
    low = [(f, p) for f, p in _pairs(answers) if f.frequency_hz <= LOW_HZ]
    held = sum(
        f.no_return_s <= p.no_return_s if f.overturned or p.overturned else f.peak_rad > p.peak_rad for f, p in low
    )
    both = sum(f.overturned and p.overturned for f, p in low)
    return held, len(low), f"{held} of {len(low)} conditions up to {LOW_HZ:g} Hz; in {both} both overturn"


def _ii(answers: Sequence[Answer]) -> tuple[int, int, str]:
    pairs = _pairs(answers)
    saved = [f.condition for f, p in pairs if f.overturned and not p.overturned]
    lost = sum(p.overturned and not f.overturned for f, p in pairs)
    falling = sum(f.overturned for f, _ in pairs)
    text = f"prevented in {len(saved)} of {falling} conditions that overturn without; caused in {lost}"
    # One case is enough for "in some cases".
    return min(len(saved), 1), 1 if pairs else 0, text


def _iii(answers: Sequence[Answer]) -> tuple[int, int, str]:
    held = cases = 0
    gains: dict[bool, list[float]] = {True: [], False: []}
    for restitution, amplitude in sorted({item.condition[:2] for item in answers}):
        mean: dict[bool, float] = {}
        for low in (True, False):
            advantages = [
                f.peak_rad - p.peak_rad
                for f, p in _pairs(answers)
                if f.condition[:2] == (restitution, amplitude) and (f.frequency_hz <= LOW_HZ) is low
            ]
            gains[low] += advantages
            mean[low] = float(np.mean(advantages)) if advantages else float("nan")
        if np.isfinite(mean[True]) and np.isfinite(mean[False]):
            cases += 1
            held += mean[True] > mean[False]
    if not cases:
        return 0, 0, "no pairs"
    low_text, high_text = (f"{np.mean(gains[low]):+.3f} rad" for low in (True, False))
    text = f"mean advantage {low_text} up to {LOW_HZ:g} Hz, {high_text} above (an overturned statue counts with the rotation "
    return held, cases, f"{text}at which its run ends); in {held} of {cases} series"


def _iv(answers: Sequence[Answer]) -> tuple[int, int, str]:
    series: dict[tuple[Any, ...], list[Answer]] = {}
    for item in answers:
        series.setdefault((item.restitution, item.amplitude_g, item.pedestal), []).append(item)
    falls = steps = fallen = 0
    for members in series.values():
        ordered = sorted(members, key=lambda item: item.frequency_hz)
        steps += len(ordered) - 1
        falls += sum(after.peak_rad <= before.peak_rad for before, after in pairwise(ordered))
        fallen += sum(after.overturned and before.overturned for before, after in pairwise(ordered))
    text = f"the peak does not rise in {falls} of {steps} steps to the next frequency; in {fallen} both overturn"
    return falls, steps, text


def _v(answers: Sequence[Answer]) -> tuple[int, int, str]:
    slips = [item.slip_m for item in answers if item.pedestal]
    if not slips:
        return 0, 0, "no pedestal"
    held = sum(slip <= FEW_CENTIMETRES_M for slip in slips)
    worst = 1000.0 * max(slips)
    return held, len(slips), f"largest {worst:.0f} mm; {held} of {len(slips)} within {1000 * FEW_CENTIMETRES_M:.0f} mm"


def _vi(answers: Sequence[Answer], top_displacement_m: Callable[[float], float]) -> tuple[int, int, str]:
    """Two parts: the geometry, and that no statue which comes back leans further than the limit."""
    top = top_displacement_m(WALL_RAD)
    geometry = abs(top / WALL_M - 1.0) <= WALL_SLACK
    back = [item.peak_rad for item in answers if item.stands]
    within = all(peak <= WALL_RAD for peak in back)
    largest = f"largest rotation of a statue that comes back {max(back):.3f} rad" if back else "none comes back"
    return int(geometry) + int(within), 2, f"top displaced {top:.3f} m at {WALL_RAD:g} rad; {largest}"
