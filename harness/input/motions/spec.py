"""What a scene may say about the floor's shaking: one validated component per axis (no file is opened here)."""

from __future__ import annotations

import math
from typing import Annotated, Any, Final, Literal

from pydantic import BeforeValidator, Field, model_validator

from analytic.excitation import PulseShape
from harness.input.mistakes import Contradiction, UserTable, agree
from harness.input.motions.recordfile import Layout, unit_named


def list_to_tuple(value: Any) -> Any:
    """Let a TOML array stand for a fixed tuple, which strict validation would refuse."""
    return tuple(value) if isinstance(value, list) else value


Pair = Annotated[tuple[float, float], BeforeValidator(list_to_tuple)]
Unit = Annotated[
    Literal["m/s2", "cm/s2", "mm/s2", "g", "mg", "%g"],
    BeforeValidator(lambda value: (unit_named(value) or value) if isinstance(value, str) else value),
]
Code = Literal["ntc2008", "ntc2018", "ec8"]
Soil = Literal["A", "B", "C", "D", "E"]
LARGEST_G: Final = 1e3
"""Far beyond any floor's acceleration, and far from where products of numbers overflow; so the next two."""
LARGEST_M_S2: Final = 1e4
LARGEST_SCALE: Final = 1e6
LARGEST_M_S: Final = 1e3
LONGEST_S: Final = 3600.0
PAIRS: Final = (
    ("window_s", 0.0, math.inf, "[from, to] with 0 <= from < to"),
    ("bandpass_hz", math.ulp(0.0), math.inf, "[low, high] with 0 < low < high"),
    ("significant", 0.0, 1.0, "[from, to], shares of the Arias intensity with 0 <= from < to <= 1"),
)
"""Keys of a source that hold two rising numbers, the least and the most that these may be, and what is wanted."""
MOST_SAMPLES: Final = 2_000_000
"""Samples that a scene holds itself: more stand in a file."""


class Oscillator(UserTable):
    """One mode of a building (docs/motions.md, "The building's filter").

    `share` is the mode's participation factor times its shape at the statue's floor; the shares of all modes sum to 1 where
    no rigid remainder is wanted.
    """

    period_s: float = Field(gt=0.0, le=10.0)
    damping: float = Field(default=0.05, gt=0.0, lt=1.0)
    share: float = 1.0


class _Filtered(UserTable):
    """Any component may pass through the building before it reaches the statue."""

    floor: Annotated[tuple[Oscillator, ...], BeforeValidator(list_to_tuple)] = ()


class RestSpec(UserTable):
    """No shaking along this axis."""

    kind: Literal["rest"]


class HarmonicSpec(_Filtered):
    """a = ramp·A·sin(2πft + phase) for ever, the ramp rising linearly from 0 to 1 over `ramp_s`."""

    kind: Literal["harmonic"]
    amplitude_g: float = Field(ge=-LARGEST_G, le=LARGEST_G)
    frequency_hz: float = Field(ge=1e-4, le=1e4)
    ramp_s: float = Field(default=0.0, ge=0.0, le=LONGEST_S)
    phase_deg: float = 0.0


class PulseSpec(_Filtered):
    """A single pulse; its amplitude is the peak acceleration and keeps its sign."""

    kind: Literal["pulse"]
    shape: PulseShape
    amplitude_g: float = Field(ge=-LARGEST_G, le=LARGEST_G)
    duration_s: float = Field(ge=1e-4, le=LONGEST_S)
    start_s: float = Field(default=0.0, ge=0.0, le=LONGEST_S)


class Source(UserTable):
    """A channel of a record file and what is done to it, in the order of the keys below.

    `column` is a CSV header, a component's name (N28W, UP) or its azimuth in degrees; `azimuth_deg` turns the two horizontal
    channels to that direction instead. `unit` is needed only where the file does not state it; `dt_s`, `skip_lines`, `columns`
    and `time_column` only for a text that no reader knows (docs/motions.md, "Any other text").
    """

    file: str = Field(min_length=1)
    column: str | None = None
    azimuth_deg: float | None = Field(default=None, ge=0.0, lt=360.0)
    unit: Unit | None = None
    dt_s: float | None = Field(default=None, ge=1e-6, le=1.0)
    skip_lines: int | None = Field(default=None, ge=0)
    columns: str | None = Field(default=None, min_length=1)
    time_column: int | None = Field(default=None, ge=1)
    window_s: Pair | None = None
    baseline: Literal["none", "mean", "linear", "quadratic", "rest"] = "none"
    bandpass_hz: Pair | None = None
    resample_dt_s: float | None = Field(default=None, ge=1e-5, le=0.1)
    significant: Pair | None = None
    sign: Literal[1, -1] = 1
    scale: float = Field(default=1.0, ge=-LARGEST_SCALE, le=LARGEST_SCALE)
    pga_g: float | None = Field(default=None, gt=0.0, le=LARGEST_G)
    pgv_m_s: float | None = Field(default=None, gt=0.0, le=LARGEST_M_S)

    @property
    def layout(self) -> Layout:
        """How the numbers of a text stand that no reader knows."""
        return Layout(self.dt_s, self.skip_lines, self.columns, self.time_column)

    @property
    def factors(self) -> list[str]:
        """The keys that make it stronger or weaker."""
        given = {"scale": self.scale != 1.0, "pga_g": self.pga_g is not None, "pgv_m_s": self.pgv_m_s is not None}
        return [name for name, there in given.items() if there]

    @model_validator(mode="after")
    def _consistent(self) -> Source:
        if self.column is not None and self.azimuth_deg is not None:
            wanted = "no azimuth beside column: a channel as recorded, or both horizontals turned"
            raise Contradiction("azimuth_deg", wanted, f"{self.azimuth_deg:g}")
        *earlier, last = ("", *self.factors)
        agree(
            (len(earlier) <= 1, last, "one factor: scale, pga_g or pgv_m_s", " and ".join(self.factors)),
            (self.scale != 0.0, "scale", 'a factor other than 0 (kind = "rest" is no shaking)', "0"),
        )
        for key, least, most, wanted in PAIRS:
            first, second = getattr(self, key) or (least, most)
            agree((least <= first < second <= most, key, wanted, str([first, second])))
        return self


class RecordSpec(Source, _Filtered):
    """A recorded accelerogram."""

    kind: Literal["record"]


class SamplesSpec(_Filtered):
    """Samples of an acceleration that stand in the scene itself, every `dt_s` from t = 0, joined by straight lines."""

    kind: Literal["samples"]
    dt_s: float = Field(ge=1e-6, le=LONGEST_S)
    accel_m_s2: Annotated[
        tuple[Annotated[float, Field(ge=-LARGEST_M_S2, le=LARGEST_M_S2)], ...],
        Field(min_length=2, max_length=MOST_SAMPLES),
        BeforeValidator(list_to_tuple),
    ]


class Target(UserTable):
    """An elastic design spectrum from its parameters (docs/motions.md, "Target spectra").

    Either the shape itself (`S`, `TB_s`, `TC_s`, `TD_s`, for NTC also `F0`) or the site: `soil` (with `type` for ec8; with `F0`,
    `TC_star_s` and `topography` for NTC), from which the code gives the shape. `ag_g` is the acceleration on rock.
    """

    code: Code
    ag_g: float = Field(gt=0.0, le=3.0)
    damping: float = Field(default=0.05, gt=0.0, le=0.3)
    vertical: bool = False
    soil: Soil | None = None
    type: Literal[1, 2] | None = None
    topography: float | None = Field(default=None, ge=1.0, le=1.4)
    S: float | None = Field(default=None, gt=0.0)
    F0: float | None = Field(default=None, ge=1.0)
    TC_star_s: float | None = Field(default=None, gt=0.0)
    TB_s: float | None = Field(default=None, gt=0.0)
    TC_s: float | None = Field(default=None, gt=0.0)
    TD_s: float | None = Field(default=None, gt=0.0)

    @model_validator(mode="after")
    def _one_shape(self) -> Target:
        """The keys of exactly one way to say the shape (docs/motions.md lists them)."""
        ntc = self.code != "ec8"
        shape = {"S", "TB_s", "TC_s", "TD_s"}
        site = {"soil", "TC_star_s"} if ntc else {"soil", "type"}
        always = {"F0"} if ntc else set()
        optional = {"topography"} if ntc else set()
        if self.vertical:
            wanted = [always if ntc else {"type"}]
        else:
            wanted = [shape | always, site | always]
            optional = optional if self.soil is not None else set()
        every = {"soil", "type", "topography", "S", "F0", "TC_star_s", "TB_s", "TC_s", "TD_s"}
        given = {key for key in every if getattr(self, key) is not None}
        ways = ", or ".join(" ".join(sorted(way)) for way in wanted)
        said = " ".join(sorted(given)) or "none"
        # Where the site gives the shape there are none of these, in order too.
        corners = [period or 0.0 for period in (self.TB_s, self.TC_s, self.TD_s)]
        shown = ", ".join(f"{period:g}" for period in corners)
        agree(
            (given - optional in wanted, "code", f"beside it and ag_g exactly {ways}", said),
            (corners == sorted(corners), "TC_s", "TB_s <= TC_s <= TD_s", shown),
        )
        return self


class SpectrumSpec(Target, _Filtered):
    """A motion whose response spectrum follows a target: artificial from a seed, or a record matched or scaled to it."""

    kind: Literal["spectrum"]
    seed: int | None = Field(default=None, ge=0)
    duration_s: float | None = Field(default=None, ge=5.0, le=120.0)
    record: Source | None = None
    method: Literal["match", "scale"] | None = None

    @model_validator(mode="after")
    def _one_origin(self) -> SpectrumSpec:
        if self.record is None:
            seed = "the seed of an artificial motion, or a record to start from"
            agree(
                (self.seed is not None, "seed", seed, "neither"),
                (self.method is None, "method", "no method without a record", repr(self.method)),
            )
            return self
        key = next((key for key in ("seed", "duration_s") if getattr(self, key) is not None), "")
        factor = next(iter(self.record.factors), "")
        own, strength = (str(getattr(table, name, None)) for table, name in ((self, key), (self.record, factor)))
        agree(
            (not key, key, "no such key beside a record: it is of artificial motions", own),
            (not factor, f"record.{factor}", "no factor: the target gives the strength (sign = -1 mirrors)", strength),
        )
        return self


Component = Annotated[
    RestSpec | HarmonicSpec | PulseSpec | RecordSpec | SamplesSpec | SpectrumSpec, Field(discriminator="kind")
]


class Motion(UserTable):
    """The floor's acceleration along x (in the rocking plane), y (across it) and z (up); an absent axis is at rest.

    `scale` multiplies all of them together.
    """

    x: Component | None = None
    y: Component | None = None
    z: Component | None = None
    scale: float = Field(default=1.0, gt=0.0, le=1e3)
