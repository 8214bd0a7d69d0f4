"""The record of a trust map: how far the analytic model is confirmed, over strength and frequency of a shaking."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Literal, Self, get_args

from typing_extensions import TypedDict

from harness.records.base import Record
from harness.records.scene import SceneRecord
from harness.records.scores import Interval

MOTIONS: Final = ("sine", "pulse", "scene")
"""What shakes: a harmonic motion along x, one sine of it, or the scene's own motion made weaker or stronger."""
TrustClass = Literal[
    "nothing_moves",
    "confirmed",
    "outcome_confirmed",
    "probability",
    "left_domain",
    "plane_left_out",
    "refuted",
    "no_answer",
]
CLASSES: Final[tuple[TrustClass, ...]] = get_args(TrustClass)
"""In this order from what is known to what is not; `no_answer`: what was asked there failed."""
HELD: Final = frozenset(("nothing_moves", "confirmed", "outcome_confirmed"))
"""Classes in which the model's outcome is confirmed."""
Basis = Literal["rest", "runs", "between", "checked"]


@dataclass(frozen=True)
class Rotation:
    """One model's rotation at a point, rad, from 0 to `end_s`: whole, or the least and largest of equal stretches of time."""

    end_s: float
    theta_rad: Sequence[float]


# `class` is no name of an attribute: so a cell is a typed table.
TrustCell = TypedDict(
    "TrustCell",
    {
        "amplitude_g": float,
        "frequency_hz": float | None,
        "class": TrustClass,
        "basis": Basis,
        "answer": str,
        "why": Sequence[str],
        "outcomes": Mapping[str, str],
        "peak_rad": float | None,
        "peak_over_alpha": float | None,
        "peaks_apart_rad": float | None,
        "agree_until_s": float | None,
        "horizon_s": float | None,
        "probability": Mapping[str, Interval],
        "amplitude_over_g_tan_alpha": float,
        "frequency_over_p": float | None,
        "set": Sequence[str],
        "paths": Mapping[str, Rotation],
    },
)
"""One point: its class; `basis` is what that rests on: limits of rest, runs of engines, such runs at the points around, which
agree (`between`), or runs that check what was said between (`checked`).

`answer` is the code of `rockcheck run` there, `why` the causes of its class, `outcomes` those of every model that ran, `peak_rad`
the analytic model's (none of a fall), `peaks_apart_rad` how far the models' peaks are apart, `horizon_s` the model's own,
`probability` that of a fall over what the scene does not know, by the analytic model and, where an engine was asked, corrected by
its runs. `set` are the keys of the scene there, as `rockcheck run SCENE --set` takes them.
"""


CONTOURS: Final = {
    "peak_quarter": 0.25,
    "peak_half": 0.5,
    "horizon": 0.0,
    "probability_5": 0.05,
    "probability_50": 0.5,
    "probability_95": 0.95,
}
"""Lines on the map, all of the analytic model: its peak over α, the share of the run that lies beyond its horizon (any), and the
probability of a fall."""


@dataclass(frozen=True)
class Saved:
    """Of `total` conditions asked with and without the pedestal: falls without it, those prevented by it, and caused."""

    total: int
    bare: int
    prevented: int
    caused: int

    @classmethod
    def of(cls, falls: Sequence[tuple[bool | None, bool | None]]) -> Self:
        """Counted from whether the statue falls under each condition: without the pedestal, with it; None: not known."""
        known = Counter(each for each in falls if None not in each)
        prevented, caused = known[True, False], known[False, True]
        return cls(known.total(), known[True, True] + prevented, prevented, caused)


def knows_most(saved: Mapping[str, Saved], preferred: str) -> str | None:
    """The model that knows what becomes of the statue under most conditions, of several the preferred one: on a pedestal that
    tips the analytic one knows next to nothing. None where there is no model."""
    return max(saved, key=lambda name: (saved[name].total, name == preferred), default=None)


@dataclass(frozen=True)
class TrustMap:
    """The plane of one statue: `shares` of it by class, each frequency's strengths evenly in their logarithm.

    `confirmed_up_to_g`: the largest strength up to which outcome and peak are confirmed at every frequency; None: at no strength.
    `contours`: by name of `CONTOURS` the least strength, g, at each frequency at which its value is passed; None: at none.
    """

    stands_on: Literal["pedestal", "floor"]
    shares: Mapping[TrustClass, float]
    confirmed_up_to_g: float | None
    contours: Mapping[str, Sequence[float | None]]
    cells: Sequence[TrustCell]


@dataclass(frozen=True)
class TrustSummary:
    """What a map cost: points, those at which engines were asked, those that checked the others and how many of these changed,
    results found finished, processor time of all answers; at how many all engines were asked, those in space too."""

    points: int
    asked: int
    checked: int
    changed: int
    found: int
    cpu_s: float
    failed: int = 0
    whole: int = 0


@dataclass(frozen=True, kw_only=True, eq=False)
class TrustRecord(Record):
    """`result.json` of `rockcheck trust`: the map of the scene, and of a statue on a pedestal also that without it, over the same
    strengths and frequencies; `saved`, by model: the points at which the pedestal prevents or causes a fall.

    `overrides` are the keys of the scene that the user set, as `rockcheck run` takes them.
    """

    kind: Literal["trust"] = "trust"
    scene: SceneRecord
    overrides: Sequence[str] = ()
    motion: str
    coarse: bool
    engines: Sequence[str]
    seed: int
    maps: Sequence[TrustMap]
    saved: Mapping[str, Saved]
    summary: TrustSummary
    seconds: float
