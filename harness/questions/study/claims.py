"""Claims of publications, each tested by each model from the rows of a study: what it asks of one model's answers, how many cases
held, of how many, and the evidence. Verdicts are computed, never typed.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import chain, pairwise
from typing import Final

import numpy as np

from harness.engines.stepping.loop import IMPOSED_LABEL
from harness.model import Finding, Outcome, grouped, info
from harness.records.run import in_domain
from harness.records.study import CaseRun, ClaimAnswer, ClaimVerdict, StudyRow, Value

LOW_HZ: Final = 3.0
"""The paper's bound between the frequencies at which the pedestal helps and those at which it does not."""
FEW_CENTIMETRES_M: Final = 0.05
"""What "a few centimetres" of pedestal displacement is taken to mean."""
WALL_RAD: Final = 0.50
WALL_M: Final = 0.70
WALL_SLACK: Final = 0.05
"""The paper rounds its distance to the wall to a decimetre."""
AT_REST_M: Final = 1e-3
"""A pedestal that moves less than this is at rest: the paper's figures would not show it."""
ROCKS_RAD: Final = 1e-3
"""A statue that turns less than this does not rock: a millimetre at the top of one of a metre."""
KINDS: Final = ("rocking", "sliding", "rocking_and_sliding")
"""The kinds of motion of the paper's figure 3."""
LASTING: Final = 0.9
"""A statue that still strikes in the last tenth of the run goes on rocking."""

FREQUENCY: Final = "motion.x.frequency_hz"
RATIO: Final = "contact.restitution"
AZIMUTH: Final = "statue.mesh.azimuth_deg"
SUPPORT: Final = "pedestal"
Condition = tuple[tuple[str, Value], ...]
Counted = tuple[int, int, Finding]
"""How many parts or cases held, of how many that were tested, and the evidence."""
InParts = tuple[int, int, Finding, tuple[str, ...]]
"""The same of a claim of several parts, and those of which there was no case."""
Test = Callable[[Sequence["ClaimRun"]], Counted | InParts]


@dataclass(frozen=True)
class ClaimRun:
    """One run of the table: what was set and what came out."""

    varied: Mapping[str, Value]
    run: CaseRun
    peak_rad: float
    error_rad: float
    overturned: bool
    stands: bool
    no_return_s: float
    no_return_error_s: float

    @property
    def frequency_hz(self) -> float:
        """Of the motion."""
        return float(self.varied[FREQUENCY])

    @property
    def pedestal(self) -> bool:
        """Whether it stands on one."""
        return bool(self.varied.get(SUPPORT, "none") != "none")

    def without(self, *keys: str) -> Condition:
        """What was set apart from these keys: the same for answers that are compared over them."""
        return tuple(sorted((key, value) for key, value in self.varied.items() if key not in keys))


def answer(run: CaseRun, varied: Mapping[str, Value]) -> ClaimRun:
    """A row of a study as the tests of claims read it.

    The error of a fall is a shift in time, largest in rotation at its end, where it is fastest: its bound over the mean rate.
    """
    no_return_s = run.no_return_time_s if run.outcome.overturned else None
    error_rad = run.numerical_uncertainty_rad or 0.0
    fall_s = 0.0 if no_return_s is None else (run.overturn_time_s or run.end_s or 0.0) - no_return_s
    return ClaimRun(
        varied={key: value for key, value in varied.items() if key != "variant"},
        run=run,
        peak_rad=abs(run.peak_theta_rad),
        error_rad=error_rad,
        overturned=run.outcome.overturned,
        stands=run.outcome is Outcome.STANDS,
        no_return_s=math.inf if no_return_s is None else no_return_s,
        no_return_error_s=error_rad * fall_s / abs(run.peak_theta_rad) if fall_s else 0.0,
    )


def _pairs(answers: Sequence[ClaimRun]) -> list[tuple[ClaimRun, ClaimRun]]:
    """(without, with) pedestal of the same condition."""
    floor = {item.without(SUPPORT): item for item in answers if not item.pedestal}
    stones = [(item.without(SUPPORT), item) for item in answers if item.pedestal]
    return [(floor[condition], item) for condition, item in stones if condition in floor]


def _series(answers: Sequence[ClaimRun], key: str) -> list[list[ClaimRun]]:
    """Answers that differ by the number of a key alone, by its size."""
    ordered = sorted(answers, key=lambda item: float(item.varied[key]))
    return [*grouped((item.without(key), item) for item in ordered).values()]


def _more(one: ClaimRun, other: ClaimRun) -> float:
    """By how much one turns more than another (rad); 0 where the stated errors of both may make the difference."""
    difference_rad = one.peak_rad - other.peak_rad
    return difference_rad if abs(difference_rad) > one.error_rad + other.error_rad else 0.0


def _sooner(one: ClaimRun, other: ClaimRun) -> bool:
    """Whether one is past its point of no return before another, by more than the stated errors of both make."""
    return other.no_return_s - one.no_return_s > one.no_return_error_s + other.no_return_error_s


def _rocks(one: ClaimRun, other: ClaimRun) -> bool:
    """Whether either statue rocks: two at rest are no comparison."""
    return max(one.peak_rad, other.peak_rad) >= ROCKS_RAD


def rotates_more(answers: Sequence[ClaimRun]) -> Counted:
    low = [(f, p) for f, p in _pairs(answers) if f.frequency_hz <= LOW_HZ and _rocks(f, p)]
    held = sum(_sooner(f, p) if f.overturned or p.overturned else _more(f, p) > 0.0 for f, p in low)
    both = sum(f.overturned and p.overturned for f, p in low)
    return held, len(low), info("evidence_i", held=held, cases=len(low), limit_hz=LOW_HZ, both=both)


def prevents(answers: Sequence[ClaimRun]) -> Counted:
    # A run that comes to no end, or ends at a wall, did not fall, and was not kept from it.
    pairs = [pair for pair in _pairs(answers) if all(run.overturned or run.stands for run in pair)]
    saved = sum(f.overturned and p.stands for f, p in pairs)
    lost = sum(p.overturned and f.stands for f, p in pairs)
    falling = sum(f.overturned for f, _ in pairs)
    # One case is enough for "in some cases"; where nothing overturns nothing could be prevented.
    return min(saved, 1), min(falling, 1), info("evidence_ii", prevented=saved, falling=falling, caused=lost)


def fades(answers: Sequence[ClaimRun]) -> Counted:
    """(iii): the pedestal's advantage is greater in the mean at low frequencies than above."""
    pairs = _pairs(answers)
    low, high = (
        grouped((f.without(SUPPORT, FREQUENCY), _more(f, p)) for f, p in pairs if (f.frequency_hz <= LOW_HZ) == below)
        for below in (True, False)
    )
    rocking = dict.fromkeys(f.without(SUPPORT, FREQUENCY) for f, p in pairs if _rocks(f, p))
    series = [each for each in rocking if each in low and each in high]
    if not series:
        return _untested("pairs")
    held = sum(bool(np.mean(low[each]) > np.mean(high[each])) for each in series)
    low_rad, high_rad = (float(np.mean([*chain(*(gains[each] for each in series))])) for gains in (low, high))
    values = {"low_rad": low_rad, "high_rad": high_rad, "limit_hz": LOW_HZ, "held": held, "cases": len(series)}
    return held, len(series), info("evidence_iii", **values)


def falls_with_frequency(answers: Sequence[ClaimRun]) -> Counted:
    falls = steps = fallen = 0
    for ordered in _series(answers, FREQUENCY):
        rocking = [pair for pair in pairwise(ordered) if _rocks(*pair)]
        steps += len(rocking)
        falls += sum(_more(after, before) <= 0.0 for before, after in rocking)
        fallen += sum(after.overturned and before.overturned for before, after in rocking)
    return falls, steps, info("evidence_iv", held=falls, cases=steps, both=fallen)


def small_displacement(answers: Sequence[ClaimRun]) -> Counted:
    slips = [item.run.peak_slip_m for item in answers if item.pedestal]
    if not slips:
        return _untested("pedestal")
    held = sum(slip <= FEW_CENTIMETRES_M for slip in slips)
    values = {"largest_m": max(slips), "limit_m": FEW_CENTIMETRES_M, "held": held, "cases": len(slips)}
    return held, len(slips), info("evidence_v", **values)


def wall_limit(answers: Sequence[ClaimRun], top_m: float) -> InParts:
    """Two parts: the geometry, and that no statue which comes back leans further than the limit."""
    geometry = abs(top_m / WALL_M - 1.0) <= WALL_SLACK
    back = [item.peak_rad for item in answers if item.stands]
    within = bool(back) and max(back) <= WALL_RAD
    evidence = info("evidence_vi", top_m=top_m, limit_rad=WALL_RAD, largest_rad=max(back, default=None))
    return int(geometry) + int(within), 1 + bool(back), evidence, () if back else ("returning",)


def only_rocks(answers: Sequence[ClaimRun]) -> Counted:
    """(vii): on a pedestal above 3 Hz the statue rocks and the pedestal does not slide."""
    high = [item for item in answers if item.pedestal and item.frequency_hz > LOW_HZ]
    if not high:
        return _untested("pedestal")
    held = sum(item.run.peak_slip_m < AT_REST_M and item.peak_rad >= ROCKS_RAD for item in high)
    slides = sum(item.run.peak_slip_m >= AT_REST_M for item in high)
    largest_m = max(item.run.peak_slip_m for item in high)
    return held, len(high), info("evidence_vii", slides=slides, cases=len(high), limit_hz=LOW_HZ, largest_m=largest_m)


def goes_on_rocking(answers: Sequence[ClaimRun]) -> Counted:
    """(viii): above 3 Hz the statue still strikes its support at the end of the run, and stands."""
    high = [item for item in answers if item.frequency_hz > LOW_HZ and item.run.last_impact_s is not None]
    if not high:
        return _untested("histories")
    held = sum(item.stands and (item.run.last_impact_s or 0.0) >= LASTING * (item.run.end_s or 0.0) for item in high)
    fallen, end_s = sum(item.overturned for item in high), max(item.run.end_s or 0.0 for item in high)
    values = {"limit_hz": LOW_HZ, "held": held, "cases": len(high), "end_s": end_s, "falls": fallen}
    return held, len(high), info("evidence_viii", **values)


def reduces(answers: Sequence[ClaimRun]) -> Counted:
    """(ix): where neither overturns, the statue on its pedestal turns less; one case is enough for "in some cases"."""
    stand = [(f, p) for f, p in _pairs(answers) if f.stands and p.stands and f.peak_rad >= ROCKS_RAD]
    if not stand:
        return _untested("standing")
    less = sum(_more(f, p) > 0.0 for f, p in stand)
    share = float(np.median([p.peak_rad / f.peak_rad for f, p in stand]))
    return min(less, 1), 1, info("evidence_ix", less=less, cases=len(stand), share=share)


def weakest_plane(answers: Sequence[ClaimRun]) -> Counted:
    """(x): in no other plane does the same motion turn the statue more, or overturn it sooner."""
    lateral = {item.without(AZIMUTH): item for item in answers if float(item.varied.get(AZIMUTH, 0.0)) == 0.0}
    others = [
        item for item in answers if float(item.varied.get(AZIMUTH, 0.0)) != 0.0 and item.without(AZIMUTH) in lateral
    ]
    both = [(lateral[item.without(AZIMUTH)], item) for item in others]
    pairs = [(first, other) for first, other in both if _rocks(first, other)]
    held = sum(
        not _sooner(other, first) if first.overturned or other.overturned else _more(other, first) <= 0.0
        for first, other in pairs
    )
    falls = sum(item.overturned for item in lateral.values())
    values = {"falls": falls, "lateral": len(lateral), "other_falls": sum(item.overturned for item in others)}
    return held, len(pairs), info("evidence_x", **values, others=len(others), held=held, cases=len(pairs))


def reaches_the_wall(answers: Sequence[ClaimRun]) -> InParts:
    """(xi): each kind of motion (the paper's figure 3) turns the statue as far as the wall under some condition.

    The paper's figures show the size of a rotation and not which way the wall is: either side counts.
    """
    kinds: dict[str, list[ClaimRun]] = {name: [] for name in KINDS}
    for item in answers:
        rocks, slides = item.overturned or item.peak_rad >= ROCKS_RAD, item.run.peak_slip_m >= AT_REST_M
        if rocks or slides:
            kinds[KINDS[2 if rocks and slides else 0 if rocks else 1]].append(item)
    counts = {
        name: sum(item.overturned or item.peak_rad >= WALL_RAD for item in some) for name, some in kinds.items() if some
    }
    untested = tuple(name for name in KINDS if name not in counts)
    reached = {name: [count, len(kinds[name])] for name, count in counts.items()}
    text = info("evidence_xi", limit_rad=WALL_RAD, reached=reached, untested=list(untested))
    return sum(count > 0 for count in counts.values()), len(counts), text, untested


def loses_less(answers: Sequence[ClaimRun]) -> Counted:
    """(xii): at the next higher ratio the mean loss of an impact is not greater. A model's own impact knows no ratio."""
    held = steps = 0
    lost: list[tuple[float, float]] = []
    known = [item for item in answers if item.run.impact_loss_j is not None and RATIO in item.varied]
    for ordered in _series(known, RATIO):
        losses = [float(item.run.impact_loss_j or 0.0) for item in ordered]
        # The same runs under each ratio: it is not used.
        if len(set(losses)) > 1:
            steps += len(losses) - 1
            held += sum(after <= before for before, after in pairwise(losses))
            lost += zip([float(item.varied[RATIO]) for item in ordered], losses, strict=True)
    if not steps:
        return _untested("ratio")
    lost_j = {f"{ratio:g}": float(np.mean(losses)) for ratio, losses in sorted(grouped(lost).items())}
    return held, steps, info("evidence_xii", held=held, cases=steps, lost_j=lost_j)


def _untested(lacking: str) -> Counted:
    return 0, 0, info("evidence_none", lacking=lacking)


TESTS: Final[Mapping[str, Test]] = {
    "i": rotates_more,
    "ii": prevents,
    "iii": fades,
    "iv": falls_with_frequency,
    "v": small_displacement,
    "vii": only_rocks,
    "viii": goes_on_rocking,
    "ix": reduces,
    "x": weakest_plane,
    "xi": reaches_the_wall,
    "xii": loses_less,
}
"""By claim; (vi) asks for the statue's geometry as well."""


# The sets of claims, and their verdicts.

UNTESTED: Final[ClaimAnswer] = "not tested"

SETS: Final[Mapping[str, tuple[str, ...]]] = {
    "paper": ("i", "ii", "iii", "iv", "v", "vi", "vii", "viii", "ix", "xi", "xii"),
    "pedestal": ("i", "ii", "iii", "iv", "v", "vii", "viii", "ix"),
    "planes": ("x",),
}
"""By the key `claims` of a study: all of the paper but the plane, those that need no wall and no ratio, the plane."""


def judge(rows: Iterable[StudyRow], top_m: float, asked: str = "paper") -> list[ClaimVerdict]:
    """The claims of the set `asked` by all models of a study's rows.

    Where an engine had the impact law imposed on it, all models of that variant count as imposed: they are there to be compared
    with it. The paper's form alone has its ratio as its own law.

    `top_m` is the horizontal displacement of the statue's top at the rotation `WALL_RAD`.
    """
    told = [(row, run) for row in rows if (run := row.run) is not None and in_domain(run)]
    models = grouped(((row.engine, str(row.varied["variant"])), answer(run, row.varied)) for row, run in told)
    imposed_variants = {str(row.varied["variant"]) for row, run in told if IMPOSED_LABEL in run.labels}
    by_claim: dict[str, Test] = {**TESTS, "vi": partial(wall_limit, top_m=top_m)}
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
    if held == cases and not untested:
        return "holds"
    return "holds for some" if held else "does not hold"
