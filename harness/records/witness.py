"""The record of a witness: what an engine as it comes says of the runs beside it, and its sentences."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

PLAIN: Final = ":plain"
"""What the name of an engine as it comes adds to that of the event-located one."""
LEAST_S: Final = 1e-9
"""A shorter time is none."""


@dataclass(frozen=True)
class Judged:
    """One run held against a plain engine: whether they agree, until when, and how far the run is from that engine at most.

    `parts_s`: when they part by more than twice their joint numerical error, while both are bounded. `convention_s`: the instant
    of the choice that decided it, where it is one between conventions; `other`: what the model gives with the other choice.
    """

    agrees: bool
    until_s: float
    to_rad: float
    parts_s: float | None = None
    convention: str = ""
    convention_s: float | None = None
    other: str = ""


@dataclass(frozen=True)
class Witness:
    """What one plain engine says: until when it was computed and bounded, its own error, and each run judged against it.

    `reason` says why it says nothing, or why no further than `until_s`. `steps`: of all its runs.
    """

    engine: str
    until_s: float
    to_rad: float | None
    agrees: bool | None
    reason: str
    dt_s: float | None = None
    uncertainty_rad: float | None = None
    steps: int = 0
    runs: Mapping[str, Judged] = field(default_factory=dict)


def sentences(witnesses: Mapping[str, Witness]) -> list[str]:
    """What the witnesses say, one sentence for each engine as it comes and kind of answer; for terminals and pages."""
    sentences = []
    for item in witnesses.values():
        name = item.engine.removesuffix(PLAIN)
        agree = {run: judged for run, judged in item.runs.items() if judged.agrees and judged.until_s > LEAST_S}
        if agree:
            until_s, to_rad = min(each.until_s for each in agree.values()), max(each.to_rad for each in agree.values())
            further = f" ({item.reason})" if item.reason else ""
            sentences.append(
                f"{name} as it comes confirms {_and(agree)} until {until_s:.4g} s, to {to_rad:.1g} rad{further}."
            )
        parted = {run: judged for run, judged in item.runs.items() if not judged.agrees}
        if parted:
            sentences.append(_parted(name, parted))
        if not agree and not parted:
            sentences.append(f"{name} as it comes confirms nothing: {item.reason}.")
    return sentences


def _parted(name: str, parted: Mapping[str, Judged]) -> str:
    first = min(parted.values(), key=lambda each: each.until_s)
    text = f"{name} as it comes does not confirm {_and(parted)} from {first.until_s:.4g} s on"
    if first.convention and first.convention_s is not None:
        text += f"; by convention, at {first.convention_s:.4g} s: {first.convention}. "
        text += f"With the other choice the model says: {first.other}"
    return f"{text}."


def _and(names: Mapping[str, Judged]) -> str:
    *before, last = names
    return f"{', '.join(before)} and {last}" if before else last
