"""The record of a run: everything a comparison or a page may say stands here first."""

from __future__ import annotations

import json
import math
import os
import platform
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields, is_dataclass, replace
from enum import Enum
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any, ClassVar, Final, Literal, NamedTuple

from harness.model.errors import required
from harness.model.files import write_text
from harness.model.finding import Axes, Finding, Shown
from harness.model.history import History, Outcome

# What is asked of a run, what it may leave out, and what an engine is able to do.

SKIPS: Final[Mapping[str, str]] = {
    "quiet_start": "nothing is integrated before the motion first reaches a limit of rest",
    "quiet_rest": "nothing is integrated while the statue is at rest and the motion stays below its limits of rest",
    "quiet_end": "the run ends when the statue is at rest and the motion that is left cannot move it",
    "base_only": "collision shapes other than the base are left out while nothing else can touch",
    "mirror": "half of a scene that is its own mirror image across the rocking plane is computed in 3D",
    "no_history": "no history is kept when only the outcome is asked",
    "planar": "a planar question is not computed in 3D",
    "stop_at_overturn": "the run ends when the statue has overturned",
    "lazy_engines": "engines that were not asked are not imported",
    "cached": "a result that is stored is not computed again",
}


MOST_TIMES: Final = 40.0
"""Steps of all runs of a climb to a target over those of its first level, at most, unless told otherwise: a level nearly twenty
times as fine is reached."""


@dataclass(frozen=True)
class RunOptions:
    """What is asked of a run: the history or only the outcome; whether its numerical error is stated; which skips are on.

    Without `stated` one run is made, at the level that is expected to meet the target: enough for one draw of many.
    `stop` is asked now and then with the time, s, and the rotation, rad: a run that only checks another one ends where it says
    so. An engine may go on to the scene's end all the same. A climb to a target makes at most `most_times` the steps of its first
    run. From `coarser_from_s` on no step bounds the error any more: an engine may go on by its coarsest level.
    """

    history: bool = True
    skips: frozenset[str] = field(default_factory=lambda: frozenset(SKIPS))
    stop: Callable[[float, float], bool] | None = None
    stated: bool = True
    most_times: float = MOST_TIMES
    coarser_from_s: float = math.inf

    def allows(self, name: str) -> bool:
        """Whether the named skip is on; raises `KeyError` for an unknown one."""
        if name not in SKIPS:
            raise KeyError(name)
        return name in self.skips


@dataclass(frozen=True)
class Capabilities:
    """What an engine computes; every flag is checked by a shared test.

    `dimensions` 2 or 3; `certifies` states its own uncertainty (no refinement levels needed); `uses_mesh` takes base and inertia
    from the statue's mesh; `own_impact` finds the impact from contact instead of a law; `pedestal_tips`, `statue_slips`, `flies`
    compute what the two-block model only reports; `pedestal` takes a statue that stands on one; `posed_start` begins from a pose
    in space; `moving_table` can move the table instead of the frame; `forces` records contact forces; `edge_shape` says what of
    the statue meets a pedestal's edge where that is the same in every scene (empty: no contact at all, or chosen by
    `statics.plan`); `skips` are those of `SKIPS` that it has, each with its switch in `RunOptions`.
    """

    dimensions: int
    certifies: bool = False
    uses_mesh: bool = False
    own_impact: bool = False
    pedestal_tips: bool = False
    statue_slips: bool = False
    flies: bool = False
    posed_start: bool = False
    pedestal: bool = True
    moving_table: bool = False
    forces: bool = False
    edge_shape: str = ""
    skips: frozenset[str] = frozenset()


# What the harness wrote into an engine's bodies while it ran: an unmodified contact engine has none.


@dataclass(frozen=True)
class Intervention:
    """The writes of one kind: how many, and the sums of what they changed, each taken without its sign.

    `moved_m`, `turned_rad`: places and rotations; `velocity_m_s`, `rate_rad_s`: velocities and angular velocities; `given_j`,
    `taken_j`: energy, kinetic and of height, that they added and removed; `steps_again`: steps solved again.
    """

    count: int = 0
    moved_m: float = 0.0
    turned_rad: float = 0.0
    velocity_m_s: float = 0.0
    rate_rad_s: float = 0.0
    given_j: float = 0.0
    taken_j: float = 0.0
    steps_again: int = 0


SCHEMA_VERSION: Final = 1
OMITTED: Final = {"omitted": True}
"""The metadata of a dataclass's field that is absent from the JSON while it is None."""
APART: Final = {"exclude": True}
"""The metadata of a field that is never in the JSON, nor (by pydantic's own word) in its schema."""
MANY: Final = 1000
"""A longer list in a record is a table: one line an item."""
DISTRIBUTIONS: Final = ("rockcheck", "numpy", "scipy", "numba", "pybullet", "pymunk", "trimesh")

PatternName = Literal["rest", "rocking", "sliding", "both", "statue_slides"]


class Pattern(NamedTuple):
    """One stretch of one motion pattern."""

    start_s: float
    end_s: float
    name: PatternName


class Column(NamedTuple):
    """What a run says under one name: its unit, and whether it is one value, a column of tables.

    What people call it stands in the catalogues of messages, by its name.
    """

    name: str
    unit: str
    single: bool


def said(unit: str = "", *, single: bool = True) -> dict[str, Column]:
    """The metadata of a run's field."""
    return {"column": Column("", unit, single)}


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class RunRow:
    """What tables keep of one engine's answer to one scene. A field that is added here is in records, stores, tables and exports.

    `validity` holds the model's limits met in this run (docs/model.md, section 5) by name with unit; `numerical_uncertainty_rad`
    and `slip_uncertainty_m` bound the numerical errors of rotation and slip up to `reliable_until_s` (None: not estimated).
    `steps` counts integration steps; `findings` are what to know of it. `motion_axes` are the axes along which the floor moves in
    the motion that the engine was given (None: not stated).
    """

    engine: str = field(metadata=said())
    outcome: Outcome = field(metadata=said())
    peak_theta_rad: float = field(metadata=said("rad"))
    peak_time_s: float | None = field(default=None, metadata=said("s"))
    end_s: float = field(metadata=said("s"))
    overturn_time_s: float | None = field(default=None, metadata=said("s"))
    no_return_time_s: float | None = field(default=None, metadata=said("s"))
    peak_slip_m: float = field(default=0.0, metadata=said("m"))
    residual_slip_m: float = field(default=0.0, metadata=said("m"))
    numerical_uncertainty_rad: float | None = field(default=None, metadata=said("rad"))
    slip_uncertainty_m: float | None = field(default=None, metadata=said("m"))
    reliable_until_s: float | None = field(default=None, metadata=said("s"))
    steps: int = field(metadata=said())
    validity: Mapping[str, Any] = field(default_factory=dict, metadata=said(single=False))
    findings: Sequence[Finding] = field(default=(), metadata=said(single=False))
    labels: Sequence[str] = field(default=(), metadata=said(single=False))
    motion_axes: Sequence[str] | None = field(default=None, metadata=said(single=False))


SAME_END: Final = 1e-6
"""Runs that end at one event end at times that differ by their errors: no part of a history lies between them."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Run(RunRow, Shown):
    """One engine's answer to one scene; `history` is None when only the outcome was asked, and in no record.

    `work` counts by name (evaluations, iterations, ...). `skipped` is what was left out though the result is the same, by its
    name in `options.SKIPS`, with the time that it saved, s (None: no stretch of time). `cpu_s` is the processor time of all that
    was integrated for it (None: read from a store), `wall_s` what its steps took by the clock. `interventions` is what
    the harness wrote to the engine's bodies, by kind; empty for an unmodified engine.
    """

    __pydantic_config__: ClassVar[Mapping[str, bool]] = {
        "strict": True, "allow_inf_nan": False, "arbitrary_types_allowed": True
    }  # fmt: skip
    """As of a record (`harness.records.base`); arrays are of the history, which no record holds."""
    settings: Mapping[str, Any] = field(metadata=said(single=False))
    wall_s: float = field(metadata=said("s"))
    cpu_s: float | None = field(default=None, metadata=said("s"))
    impact_times_s: Sequence[float] = field(default=(), metadata=said("s", single=False))
    uplift_times_s: Sequence[float] = field(default=(), metadata=said("s", single=False))
    patterns: Sequence[Pattern] = field(default=(), metadata=said(single=False))
    work: Mapping[str, int] = field(default_factory=dict, metadata=said(single=False))
    skipped: Mapping[str, float | None] = field(default_factory=dict, metadata=said(single=False))
    message: str = field(default="", metadata=said())
    interventions: Mapping[str, Intervention] = field(default_factory=dict, metadata=said(single=False))
    history: History | None = field(default=None, metadata=APART)

    @property
    def impacts(self) -> int:
        """Number of impacts; a run for the outcome alone counts them and lists none."""
        return len(self.impact_times_s) or int(self.work.get("impacts", 0))

    @property
    def peaks_until_s(self) -> float:
        """When its rotation was largest; its end where that is yet to come."""
        return self.end_s if self.peak_time_s is None else self.peak_time_s

    @property
    def bounded_until_s(self) -> float:
        """Until when its stated numerical errors hold; to its end where none is stated, or but rounding is left."""
        until_s = self.end_s if self.reliable_until_s is None else self.reliable_until_s
        return until_s if until_s < self.end_s * (1.0 - SAME_END) else self.end_s

    def facts(self) -> dict[str, str]:
        """Engine, outcome, peak with its numerical error, slip."""
        error = "" if self.numerical_uncertainty_rad is None else f" ± {self.numerical_uncertainty_rad:.1g}"
        facts = {"engine": self.engine, "outcome": self.outcome.value}
        if self.outcome.failed:
            return facts | {"because": self.message}
        at = "" if self.peak_time_s is None else f" at {self.peak_time_s:.4g} s"
        facts["largest rotation"] = f"{self.peak_theta_rad:.4g}{error} rad{at}"
        return facts | ({"largest slip": f"{1e3 * self.peak_slip_m:.4g} mm"} if self.peak_slip_m else {})

    def columns(self) -> dict[str, object]:
        """The columns of the history. Raises `InputError` where none was kept."""
        return dict(self._its_history().columns())

    def plot(self, ax: Axes | None = None, **style: Any) -> Axes:
        """Draw the rotation over time, labelled with the engine. Raises `InputError` where no history was kept."""
        return self._its_history().plot(ax, **{"label": self.engine, **style})

    def _its_history(self) -> History:
        got = self.message or "its outcome alone"
        return required(self.history, f"run of {self.engine}", "a run with its history", got, key="history")

    def with_uncertainty(self, of_rotation_rad: float, of_slip_m: float, until_s: float, *findings: Finding) -> Run:
        """The same run with its numerical uncertainty stated."""
        return replace(
            self,
            numerical_uncertainty_rad=of_rotation_rad,
            slip_uncertainty_m=of_slip_m,
            reliable_until_s=until_s,
            findings=(*self.findings, *findings),
        )


RUN_FIELDS: Final = tuple(
    each.metadata["column"]._replace(name=each.name) for each in fields(Run) if "column" in each.metadata
)
"""All that a run says beside its history: records, stores, tables and exports are made by it."""
NUMBERS: Final = {
    each.name: each.default if isinstance(each.default, float) else math.nan
    for each in fields(RunRow)
    if each.metadata["column"].unit
}
"""What a table tells of each run in numbers with a unit, beside its outcome and counts: what each is where nobody says it."""


def number(table: Mapping[str, object], name: str, default: float | None = None) -> float:
    """A number of a run's settings or validity, `default` where there is none. Raises `TypeError` for what is not a number."""
    value = table.get(name)
    if value is None and default is not None:
        return default
    if not isinstance(value, int | float):
        raise TypeError(f"{name} is not a number: {value!r}")
    return float(value)


_PLAIN: Final = frozenset({str, int, bool, type(None)})


def to_plain(value: Any) -> Any:
    """Turn numpy scalars, arrays, tuples, mappings, enumerations and dataclasses into what JSON holds.

    A number that is not finite becomes None; a dataclass's field marked `OMITTED` is left out while it is None.
    """
    kind = type(value)
    # Nearly all values of a record are one of these, and a study asks a million times.
    if kind is float:
        return value if math.isfinite(value) else None
    if kind in _PLAIN:
        return value
    if isinstance(value, Mapping):
        return {str(key): to_plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [to_plain(item) for item in value]
    if isinstance(value, (frozenset, set)):
        return sorted(to_plain(item) for item in value)
    if isinstance(value, Enum):
        return value.value
    if is_dataclass(value):
        own = [(each, getattr(value, each.name)) for each in fields(value) if "exclude" not in each.metadata]
        return {each.name: to_plain(item) for each, item in own if item is not None or "omitted" not in each.metadata}
    if hasattr(value, "tolist"):
        return to_plain(value.tolist())
    return value


def write_json(path: Path, record: Mapping[str, object]) -> None:
    """Write a record so that the file is either the old one or the whole new one; of a long list each item is one line."""
    try:
        text = _json(record)
    except (TypeError, ValueError):
        text = _json(to_plain(record))
    write_text(path, text + "\n")


def _json(record: Mapping[str, object]) -> str:
    lines = [f" {json.dumps(str(key), ensure_ascii=False)}: {_value(value)}" for key, value in record.items()]
    return "{\n" + ",\n".join(lines) + "\n}" if lines else "{}"


def _value(value: Any) -> str:
    """Indented for people; but a hundred thousand rows are written in seconds, one line each."""
    if isinstance(value, list) and len(value) > MANY:
        return "[\n" + ",\n".join(json.dumps(item, ensure_ascii=False, allow_nan=False) for item in value) + "\n]"
    return json.dumps(value, indent=1, ensure_ascii=False, allow_nan=False).replace("\n", "\n ")


@cache
def versions() -> Mapping[str, str]:
    """Versions of this project, of Python and of what computes."""
    # Asked for every key of a study; looking it up opens files.
    versions = {"python": platform.python_version()}
    for name in DISTRIBUTIONS:
        try:
            versions[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            continue
    return versions


def machine() -> dict[str, str | int]:
    """What computed: system, processor, cores."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        names = [platform.processor()]
    else:
        names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return {
        "system": platform.system(),
        "processor": next(filter(None, names), platform.machine()),
        "cores": os.cpu_count() or 1,
    }
