"""The record of a rocking spectrum: how far blocks of every size and slenderness rock in a set of motions, and which fall."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from harness.records.base import Record

Numbers = Sequence[Sequence[float]]
"""A number for each size (rows) and slenderness (columns)."""


@dataclass(frozen=True)
class SpectrumMotion:
    """One motion of the set."""

    name: str
    pga_g: float
    pgv_m_s: float
    duration_s: float


@dataclass(frozen=True)
class SpectrumSummary:
    """What a call computed."""

    runs: int
    cpu_s: float
    failed: int = 0


@dataclass(frozen=True, kw_only=True, eq=False)
class RockingSpectrumRecord(Record):
    """`result.json` of `rockcheck study` for a file of `kind = "rocking_spectrum"`.

    Sizes are half diagonals R, slendernesses h/b of homogeneous blocks. `cases` are motions × draws; over them the share
    that overturns, and the median and 84 % quantile of the peak rotation over α (None: more than that share overturns).
    `undecided` is the share of all runs that still leaned beyond α at the end.
    """

    kind: Literal["rocking_spectrum"] = "rocking_spectrum"
    title: str
    restitution: float | Literal["momentum"]
    motions: Sequence[SpectrumMotion]
    strength_cov: float
    draws: int
    seed: int
    cases: int
    size_m: Sequence[float]
    slenderness: Sequence[float]
    probability_overturned: Numbers
    peak_median: Sequence[Sequence[float | None]]
    peak_high: Sequence[Sequence[float | None]]
    undecided: float
    summary: SpectrumSummary
