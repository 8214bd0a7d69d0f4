"""The record of one run: the resolved scene, every engine's answer, scores of each pair, and what was left out and why."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Final, Literal, Self

from harness.input.mistakes import agree
from harness.model import OMITTED, Array, Finding, Outcome, Run, RunRow, Say, number
from harness.records.assess import Assessment
from harness.records.base import Record
from harness.records.scene import MotionRecord, SceneRecord
from harness.records.scores import Scores
from harness.statics.plan import Step

# The record of a witness: what an unmodified engine says of the runs beside it.

PLAIN: Final = ":plain"
"""What the name of an unmodified engine adds to that of the event-located one."""
LEAST_S: Final = 1e-9
"""A shorter time is none."""


@dataclass(frozen=True)
class Judged:
    """One run held against a plain engine: whether they agree, until when, and how far the run is from that engine at most.

    `parts_s`: when they part by more than twice their joint numerical error, while both are bounded. `floor_impact`: the
    coefficient at impacts with which the model was run for it, where it is another than the scene's.
    """

    agrees: bool
    until_s: float
    to_rad: float
    parts_s: float | None = None
    floor_impact: str = ""


@dataclass(frozen=True)
class Witness:
    """What one plain engine says: until when it was computed and bounded, its own error, and each run judged against it.

    `reasons` say why it says nothing, or why no further than `until_s`. `steps`: of all its runs. `floor_impact`: which of two
    coefficients of the floor acts in it as an impact breaks the pedestal loose; empty where there is one.
    """

    engine: str
    until_s: float
    to_rad: float | None
    agrees: bool | None
    reasons: Sequence[Finding] = ()
    dt_s: float | None = None
    uncertainty_rad: float | None = None
    steps: int = 0
    runs: Mapping[str, Judged] = field(default_factory=dict)
    floor_impact: str = ""


def tips_s(run: RunRow) -> float | None:
    """When a model that holds the pedestal upright says that it tips, s; None where it does not say so."""
    left_s = run.validity.get("left_domain_s")
    return left_s if isinstance(left_s, float) and run.validity.get("left_domain_by") == "pedestal_tips" else None


STILL_RAD: Final = 1e-5
"""A smaller lean is the give of a contact engine at rest (some 0.01 mm at the top of a statue of one metre)."""
SLIDES_M: Final = 1e-3
"""A statue that slides or hops less on its support does so as contact engines let it while it rocks."""
OWN_MOVES: Final = {
    "statue_slides": ("statue_slip_m", SLIDES_M),
    "statue_hops": ("statue_flight_m", SLIDES_M),
    "statue_turns": ("yaw_rad", 0.01),
}
"""What is told of a statue that moves on its support, the value of its run that shows it, and from where on it is seen."""


def standing(run: RunRow, name: str) -> float | None:
    """A value of `OWN_MOVES` of a statue that stands; None where its model holds it still there, or it fell."""
    most = run.validity.get(name)
    return most if isinstance(most, float) and run.outcome is Outcome.STANDS else None


def own_moves(runs: Mapping[str, RunRow]) -> dict[str, dict[str, float]]:
    """By each of `OWN_MOVES` that is seen the models in which the statue stands and does so, with how far."""
    found = {
        code: {model: most for model, run in runs.items() if (most := standing(run, name) or 0.0) > least}
        for code, (name, least) in OWN_MOVES.items()
    }
    return {code: models for code, models in found.items() if models}


def peak_slip_m(run: RunRow) -> float:
    """The pedestal's largest slip, m: along the rocking plane, by an engine in space in any direction."""
    return max(run.peak_slip_m, number(run.validity, "pedestal_slip_m", 0.0))


def peak_lean_rad(run: RunRow) -> float:
    """The statue's largest lean, rad: in the rocking plane, by an engine in space in any direction."""
    return max(run.peak_theta_rad, number(run.validity, "peak_lean_rad", 0.0))


def balance_share(run: RunRow, theta_rad: Array, slenderness_rad: Callable[[int], float]) -> float:
    """The largest share of the angle at which the statue balances on a side (`slenderness_rad`) that its rotation (n,) reached,
    or by an engine in space its lean in any direction, or its pedestal with it as one body: an unsymmetric statue may lean
    further to the side that bears more. Between coarse samples the model knows its own peak's.
    """
    right, left = (float((side * theta_rad).max()) / slenderness_rad(side) for side in (1, -1))
    told = "peak_lean_share", "pedestal_tilt_share", "peak_over_slenderness"
    return max(right, left, *(number(run.validity, name, 0.0) for name in told))


UNKNOWN: Final = (Outcome.LIFT_OFF, Outcome.FRICTION_PARADOX, Outcome.UNDECIDED)
"""Outcomes that say what became of the run, not of the statue."""


def has_answer(run: RunRow) -> bool:
    """Whether a run tells what becomes of the statue: it ended, and held upright no pedestal that tips before that was decided.

    Every page and the terminal count by this the models that answered.
    """
    ended = not run.outcome.failed and run.outcome not in UNKNOWN
    return ended and (tips_s(run) is None or not left_early(run))


def falls(run: RunRow) -> bool | None:
    """Whether the statue falls by a run; None where that does not tell it, or outside its model's domain."""
    return run.outcome.fell if in_domain(run) else None


def left_early(run: RunRow) -> bool:
    """Whether a run left its model's domain before it was decided what becomes of the statue."""
    decided_s = math.inf if run.no_return_time_s is None else run.no_return_time_s
    return number(run.validity, "left_domain_s", math.inf) < decided_s


def in_domain(run: RunRow) -> bool:
    """Whether a run tells what becomes of the statue, and its model knew all until that was decided: what is compared."""
    return has_answer(run) and not left_early(run)


def outcome_family(outcome: Outcome) -> str:
    """What happens to the statue: falls to different sides are one outcome."""
    return "overturned" if outcome.overturned else outcome.value


def unconfirmed(known: Mapping[str, Run]) -> list[str]:
    """The runs, of those that tell it, whose outcome is told outside a model's domain alone."""
    sure = {outcome_family(run.outcome) for run in known.values() if not left_early(run)}
    return [name for name, run in known.items() if outcome_family(run.outcome) not in sure]


def outside_domain(run: RunRow) -> bool:
    """Whether a run ended, but outside its model's domain, so that what it says of the statue does not count."""
    return not (has_answer(run) or run.outcome.failed or run.outcome in UNKNOWN)


def known_until_s(runs: Mapping[str, Run]) -> dict[str, float]:
    """Until when each run tells how far the statue leans: as long as it is within its model's domain, where one stays in it."""
    left = {name: number(run.validity, "left_domain_s", math.inf) for name, run in runs.items()}
    return left if math.inf in left.values() else dict.fromkeys(runs, math.inf)


@dataclass(frozen=True)
class HorizonRecord:
    """Until when perturbed runs of one model stay within `tolerance_rad` of the unperturbed one, by the perturbation's size.

    `until_s` (one for each of `perturbations`) is `duration_s` where they always do; the first of it, `intrinsic_s`, is the
    horizon of the problem itself: beyond it no two programs need agree. `growth_per_s` is the mean rate at which the largest
    difference grows, from its size to the tolerance, over the perturbations that reach it (None: none does). `outcomes` are the
    distinct outcomes among the runs: more than one says that the outcome itself is not predictable, by a perturbation of
    `outcome_from` and more.
    """

    tolerance_rad: float
    duration_s: float
    perturbations: Sequence[float]
    until_s: Sequence[float]
    growth_per_s: float | None
    outcomes: Sequence[Outcome]
    failed: int
    intrinsic_s: float
    outcome_from: float | None = field(default=None, metadata=OMITTED)


@dataclass(frozen=True)
class LawChoice:
    """What the model says by one choice: outcome, when its run ends, s, and the largest rotation, rad."""

    outcome: Outcome
    end_s: float
    peak_theta_rad: float


@dataclass(frozen=True)
class DecidedBy:
    """A choice between laws that acts in this scene: its `key`, when it first does, s, what each value of it gives, and whether
    it decides the outcome.
    """

    key: str
    at_s: float
    outcomes: Mapping[str, LawChoice]
    decides: bool


@dataclass(frozen=True, kw_only=True, eq=False)
class RunRecord(Record):
    """`result.json` of `rockcheck run`."""

    kind: Literal["run"] = "run"
    scene: SceneRecord
    motion: MotionRecord
    runs: Mapping[str, Run]
    histories: Sequence[str] = ()
    """The engines whose histories were kept."""
    scores: Mapping[str, Scores]
    horizons: Mapping[str, HorizonRecord] | None = field(default=None, metadata=OMITTED)
    assessment: Mapping[str, Assessment] | None = field(default=None, metadata=OMITTED)
    witness: Mapping[str, Witness] | None = field(default=None, metadata=OMITTED)
    decided_by: DecidedBy | None = field(default=None, metadata=OMITTED)
    plan: Sequence[Step]
    seconds: float

    def texted(self, say: Say) -> Self:
        """The record with its sentences, those of each pair's verdict among them."""
        return replace(super().texted(say), scores={pair: each.texted(say) for pair, each in self.scores.items()})

    def __post_init__(self) -> None:
        for key, names in (("histories", self.histories), ("horizons", self.horizons)):
            unknown = next((name for name in names or () if name not in self.runs), None)
            agree((unknown is None, key, "engines of `runs`", repr(unknown)))
