"""The record of a study of directions: amplitudes that overturn in 3D beside the planar models, and what moves them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Literal

from harness.model import Outcome
from harness.records.base import Record
from harness.records.scene import SceneRecord

BASELINE: Final = "shaken along one direction"
"""What every condition is compared with: the scene's motion along x alone."""
SOLID: Final = ("spatial", "pybullet", "pybullet:plain")
"""Engines that compute in three dimensions."""
Group = Literal["baseline", "components", "base", "inertia", "uncertainty", "numerical"]

Doubt = Literal["", "undecided", "change"]


@dataclass(frozen=True)
class Amplitude:
    """The least peak acceleration of the floor, g, at which an engine's statue overturns under a condition at an azimuth.

    None: it does not overturn up to the most tried; `stands_at_g` is the largest tried below it at which it stands. `doubt` is
    why the exact model's answer is not to be trusted alone: some of its runs came to no outcome (`undecided`), or outcomes
    `change` with a smaller local error.
    """

    condition: str
    azimuth_deg: float
    engine: str
    peak_g: float | None
    stands_at_g: float
    outcome: Outcome | Literal[""]
    runs: int
    doubt: Doubt = ""


@dataclass(frozen=True)
class Band:
    """Overturning peaks, g, of statues drawn at one azimuth: quantiles 5, 50 and 95 % (None: those stand), share that stands."""

    azimuth_deg: float
    low_g: float | None
    middle_g: float | None
    high_g: float | None
    stands_share: float
    runs: int


@dataclass(frozen=True)
class Departure:
    """How far a 3D run left the plane of shaking, and what stayed of it at the end.

    `corner_share` is the share of the rocking time spent on a single corner, the rest on an edge.
    """

    azimuth_deg: float
    engine: str
    peak_g: float
    outcome: Outcome
    peak_theta_rad: float
    out_of_plane_rad: float
    yaw_rad: float
    across_m: float
    yaw_left_rad: float
    walked_m: float
    corner_share: float


@dataclass(frozen=True)
class StaticLimit:
    """At one direction the peaks, g, at which a level push lifts the statue in 3D and in the plane, and the sides' planar answer.

    `projected_g` is the least amplitude of the planar model at a side (`side_deg`) for its share of the shaking.
    """

    azimuth_deg: float
    lifts_g: float
    planar_lifts_g: float
    projected_g: float | None
    side_deg: float | None


@dataclass(frozen=True)
class AmplitudeChange:
    """The relative change of the overturning amplitude at one direction."""

    azimuth_deg: float
    relative: float


@dataclass(frozen=True)
class Effect:
    """What one condition changes in one engine's amplitudes; `flips` are directions at which it no longer overturns."""

    engine: str
    condition: str
    group: Group
    changes: Sequence[AmplitudeChange]
    median: float | None
    least: float | None
    largest: float | None
    flips: int


@dataclass(frozen=True)
class SearchRecord:
    """Up to which peak, to which share and at which step amplitudes were looked for."""

    most_g: float
    resolution: float
    dt_s: float


@dataclass(frozen=True, kw_only=True)
class AskedRecord:
    """What the study's file asks."""

    kind: Literal["effects3d"]
    title: str
    scene: str
    directions: int
    every: int
    engines: Sequence[str]
    conditions: Sequence[str]
    samples: int
    share: float
    seed: int
    search: SearchRecord


@dataclass(frozen=True)
class ReplayRecord:
    """The case that can be watched, with the command that runs it by itself (empty where there is none)."""

    azimuth_deg: float
    engine: str
    peak_g: float
    outcomes: Mapping[str, Outcome]
    folder: str
    command: str


@dataclass(frozen=True)
class EffectsSummary:
    """What a call of the study did."""

    directions: int
    asked: int
    found: int
    runs: int
    failed: int
    cpu_s: float


@dataclass(frozen=True, kw_only=True, eq=False)
class EffectsRecord(Record):
    """`result.json` of `rockcheck study` for a file of `kind = "effects3d"`."""

    kind: Literal["effects3d"] = "effects3d"
    rows: Sequence[Amplitude]
    sides: Sequence[Amplitude]
    static: Sequence[StaticLimit]
    bands: Sequence[Band]
    departures: Sequence[Departure]
    effects: Sequence[Effect]
    left_out: Mapping[str, str]
    file: str
    scene: SceneRecord
    study: AskedRecord
    unit_g: float
    replay: ReplayRecord | None
    summary: EffectsSummary
    seconds: float

    @property
    def engines(self) -> list[str]:
        """The engines that answered, in the record's order."""
        return list(dict.fromkeys(row.engine for row in self.rows))

    @property
    def solid_engine(self) -> str:
        """The first engine of three dimensions: the one by which planar models are judged."""
        return next(name for name in SOLID if name in self.engines)

    def amplitudes(self, engine: str, condition: str) -> list[Amplitude]:
        """An engine's amplitudes under a condition, by direction."""
        return [row for row in self.rows if row.engine == engine and row.condition == condition]
