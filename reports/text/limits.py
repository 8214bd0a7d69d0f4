"""The limits that runs met and what was left out of them, in words: what a fall itself adds is told apart."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Final

import numpy as np

from harness.model.history import History
from reports.source import RunSource
from reports.text.glossary import REASON_WORDS, SKIP_WORDS, validity_rows
from reports.text.numbers import digits, listed, short

FOLLOWED: Final[Mapping[str, str]] = {
    "yaw_rad": "yaw_rad",
    "out_of_plane_rad": "out_of_plane_rad",
    "statue_across_m": "statue_y_m",
    "statue_slip_m": "statue_slip_m",
}
"""Limits that a history follows, with its column: there the part before the outcome was decided can be told."""


def limit_rows(source: RunSource) -> dict[str, Sequence[tuple[str, str]]]:
    """Each model's limits as words and value; of one that overturns also what they were until its point of no return."""
    found: dict[str, Sequence[tuple[str, str]]] = {}
    for name, run in source.runs.items():
        if not run["validity"]:
            continue
        before = before_fall(run, source.histories.get(name))
        found[name] = [*validity_rows(run["validity"], before, run["no_return_time_s"]), *interventions_row(run)]
    return found


def interventions_row(run: Mapping[str, Any]) -> list[tuple[str, str]]:
    """What was written to the engine's bodies on the way, in one line; none for an engine as it comes."""
    written: Mapping[str, Mapping[str, Any]] = run.get("interventions") or {}
    if not written:
        return []
    total = {key: sum(item[key] for item in written.values()) for key in next(iter(written.values()))}
    kinds = listed(f"{kind.replace('_', ' ')} {item['count'] or item['steps_again']}" for kind, item in written.items())
    lost = run["validity"].get("lost_in_impacts_j")
    beside = "" if lost is None else f", where impacts lost {digits(lost, 2)} J"
    told = (
        f"{kinds} times: in all {digits(total['moved_m'], 2)} m, {digits(total['velocity_m_s'], 2)} m/s, "
        f"{digits(total['rate_rad_s'], 2)} rad/s; {digits(total['given_j'], 2)} J given and {digits(total['taken_j'], 2)} J taken"
        f"{beside}; {total['steps_again']} steps solved again"
    )
    return [("written to its bodies", told)]


def before_fall(run: Mapping[str, Any], history: History | None) -> dict[str, float]:
    """Largest values, until the balance point is passed for good, of the limits that a fallen statue's history follows."""
    until = run["no_return_time_s"]
    if history is None or until is None:
        return {}
    upright = history.t_s <= until
    found = {}
    for key, column in FOLLOWED.items():
        if key in run["validity"] and column in history.extra and upright.any():
            values = np.asarray(history.extra[column])
            start = float(values[0]) if key == "yaw_rad" else 0.0
            found[key] = float(np.max(np.abs(values[upright] - start)))
    return found


def fall_sentence(source: RunSource) -> str:
    """What to make of the limits of models whose statue overturns; nothing when none does."""
    fallen = {name: run for name, run in source.runs.items() if run["no_return_time_s"] is not None}
    if not fallen:
        return ""
    times = listed(f"{short(run['no_return_time_s'], 3)} s ({name})" for name, run in fallen.items())
    return (
        f"The outcome is decided once the statue passes its balance point for good, at {times}. The runs go on until the body "
        "lies, or falls past its support's edge: forces, energy gained, turn, slip, flight and penetration may be those of that "
        "fall alone and then say nothing of the rocking before it. Where a history follows them, their values until that moment "
        "stand beside."
    )


def plan_rows(plan: Iterable[Mapping[str, Any]]) -> list[tuple[bool, str, str, str]]:
    """The plan in words: whether it was left out, what, for which engines (those of one reason together), and why."""
    together: dict[tuple[bool, str, str], list[str]] = {}
    for step in plan:
        words = SKIP_WORDS.get(step["skip"], step["skip"].replace("_", " "))
        reason = REASON_WORDS.get(step["reason"], step["reason"])
        together.setdefault((step["applies"], words, reason), []).append(step["engine"])
    return [
        (applies, words, "" if "*" in engines else listed(engines), reason)
        for (applies, words, reason), engines in together.items()
    ]


def skipped_rows(runs: Mapping[str, Any]) -> list[tuple[str, str]]:
    """What each engine says it left out, by engine, with the skip's name in words."""
    rows = []
    for name, run in runs.items():
        for text in run["skipped"]:
            skip, colon, rest = text.partition(": ")
            rows.append((name, f"{SKIP_WORDS[skip]}: {rest}" if colon and skip in SKIP_WORDS else text))
    return rows
