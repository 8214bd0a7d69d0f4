"""The record of measured tosses: by model what was fitted on a share of them, and how far its poses are off on the others."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

from harness.model.run import OMITTED
from harness.records.base import Record


@dataclass(frozen=True)
class Quartiles:
    """Lower quartile, median and upper quartile."""

    low: float
    median: float
    high: float


@dataclass(frozen=True)
class Missed:
    """Median distance of the body's points, m, with each coefficient tried (None: most frames could not be computed).

    `by_friction` with plastic impacts, `by_restitution` at the fitted friction.
    """

    by_friction: Mapping[str, float | None]
    by_restitution: Mapping[str, float]


@dataclass(frozen=True, kw_only=True)
class PoseErrors:
    """Errors of rotation and place: of all frames (`count`), at the ends, or at one instant `t_s` of so many `tosses`."""

    t_s: float | None = field(default=None, metadata=OMITTED)
    tosses: int | None = field(default=None, metadata=OMITTED)
    count: int | None = field(default=None, metadata=OMITTED)
    rotation_rad: Quartiles
    place_m: Quartiles


@dataclass(frozen=True)
class TossRow:
    """One scored toss: the median of its frames, and its end."""

    toss: str
    rotation_rad: float
    end_rotation_rad: float
    end_place_m: float


@dataclass(frozen=True)
class TrajectoryMeans:
    """Mean and standard deviation over tosses of each toss's mean over its frames: place in widths of the body, rotation."""

    place_share: float
    place_share_sd: float
    rotation_rad: float
    rotation_rad_sd: float


@dataclass(frozen=True)
class TossFit:
    """Coefficients with which the points of the fitted tosses are missed least (`missed_m`), and what they make of the others."""

    friction: float
    restitution: float
    missed_m: float
    means: TrajectoryMeans | None


@dataclass(frozen=True)
class TossModel:
    """A model with the coefficients fitted for it: `failed` tosses with why, those of which the run `ended_s` before the last
    frame (its last pose is held); errors over all frames, at the end, over time.

    `fits` by what they look at: the whole `trajectory` (the model's own coefficients), or what the `first_impact` leaves.
    """

    engine: str
    dt_s: float | None
    friction: float
    restitution: float
    missed_m: Missed
    failed: Mapping[str, str]
    ended_s: Mapping[str, float] = field(default_factory=dict)
    fits: Mapping[str, TossFit] = field(default_factory=dict)
    frames: PoseErrors | None = None
    end: PoseErrors | None = None
    over_time: Sequence[PoseErrors] = ()
    rows: Sequence[TossRow] = ()


@dataclass(frozen=True)
class Clock:
    """Free fall by the table's clock, its standard error, and the rate of frames with which it is the scene's gravity."""

    fall_m_s2: float
    error_m_s2: float
    stated_hz: float
    rate_hz: float


@dataclass(frozen=True, kw_only=True, eq=False)
class TossesRecord(Record):
    """`result.json` of `rockcheck validate` on a table of tosses; `raised_m` was added to their heights.

    `published` are other simulators' means on the same set, where it is known.
    """

    kind: Literal["tosses"] = "tosses"
    title: str = ""
    tosses: str
    body: str
    count: int
    fitted_on: Sequence[str]
    raised_m: Quartiles
    clock: Clock | None = None
    published: Mapping[str, TrajectoryMeans] = field(default_factory=dict)
    models: Mapping[str, TossModel]
    absent: Mapping[str, str]
    seed: int = 0
    seconds: float
