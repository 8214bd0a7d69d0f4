"""Limits that runs met, what was left out of them, in words: what a fall itself adds is told apart; notes by their weight."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Final

import numpy as np

from harness.model.finding import Finding, Severity, weighed
from harness.model.history import History
from harness.model.run import EngineRunRecord, Intervention
from harness.records.base import Table
from harness.statics.plan import Step
from reports.messages import ENGLISH
from reports.messages.numbers import digits, short, unit
from reports.source import RunSource
from reports.text.glossary import validity_rows

FOLLOWED: Final[Mapping[str, str]] = {
    "yaw_rad": "yaw_rad",
    "out_of_plane_rad": "out_of_plane_rad",
    "statue_across_m": "statue_y_m",
    "statue_slip_m": "statue_slip_m",
    "pedestal_tilt_rad": "pedestal_tilt_rad",
}
"""Limits that a history follows, with its column: there the part before the outcome was decided can be told."""

TIPS_RAD: Final = 1e-3
"""A pedestal that tips by more is said to."""
HEADINGS: Final = {
    Severity.CHANGES_ANSWER: "Changes the answer",
    Severity.CAUTION: "Beware",
    Severity.INFO: "For the record",
}


def limit_rows(source: RunSource) -> dict[str, Sequence[tuple[str, str]]]:
    """Each model's limits as words and value; of one that overturns also what they were until its point of no return."""
    by_name: dict[str, Sequence[tuple[str, str]]] = {}
    for name, run in source.runs.items():
        if not run.validity:
            continue
        before = before_fall(run, source.histories.get(name))
        rows = validity_rows(run.validity, before, run.no_return_time_s)
        by_name[name] = [*rows, *interventions_row(run.interventions, run.validity)]
    return by_name


def interventions_row(written: Mapping[str, Intervention], validity: Table) -> list[tuple[str, str]]:
    """What was written to the engine's bodies on the way, in one line; none for an unmodified engine."""
    if not written:
        return []
    every = written.values()
    kinds = ENGLISH.listed(
        f"{kind.replace('_', ' ')} {item.count or item.steps_again}" for kind, item in written.items()
    )
    lost = validity.get("lost_in_impacts_j")
    beside = f", where impacts lost {digits(lost, 2)} J" if isinstance(lost, float) else ""
    sentence = (
        f"{kinds} times: in all {digits(sum(item.moved_m for item in every), 2)} m, "
        f"{digits(sum(item.velocity_m_s for item in every), 2)} m/s, "
        f"{digits(sum(item.rate_rad_s for item in every), 2)} rad/s; "
        f"{digits(sum(item.given_j for item in every), 2)} J given and "
        f"{digits(sum(item.taken_j for item in every), 2)} J taken"
        f"{beside}; {sum(item.steps_again for item in every)} steps solved again"
    )
    return [("written to its bodies", sentence)]


def before_fall(run: EngineRunRecord, history: History | None) -> dict[str, float]:
    """Largest values, until the balance point is passed for good, of the limits that a fallen statue's history follows."""
    until = run.no_return_time_s
    if history is None or until is None:
        return {}
    upright = history.t_s <= until
    rows = {}
    for key, column in FOLLOWED.items():
        if key in run.validity and column in history.extra and upright.any():
            values = np.asarray(history.extra[column])
            start = float(values[0]) if key == "yaw_rad" else 0.0
            rows[key] = float(np.max(np.abs(values[upright] - start)))
    return rows


def tilt_rad(run: EngineRunRecord, history: History | None) -> float:
    """The pedestal's largest tilt, of a statue that falls until it passes its balance point; 0 for a model that has none."""
    until, whole = before_fall(run, history), run.validity.get("pedestal_tilt_rad")
    return until.get("pedestal_tilt_rad", whole if isinstance(whole, float) else 0.0)


def fall_times(source: RunSource) -> str:
    """When the statue passes its balance point for good, by model; nothing where none overturns."""
    falls = {name: run.no_return_time_s for name, run in source.runs.items() if run.no_return_time_s is not None}
    return ENGLISH.listed(f"{short(time_s, 3)} s ({name})" for name, time_s in falls.items()) if falls else ""


def plan_rows(plan: Iterable[Step]) -> list[tuple[bool, str, str, str]]:
    """The plan in words: whether it was left out, what, for which engines (those of one reason together), and why."""
    together: dict[tuple[bool, str, str], list[str]] = {}
    for step in plan:
        words = ENGLISH.strings[f"skip.{step.skip}"]
        together.setdefault((step.applies, words, ENGLISH.say(step.reason)), []).append(step.engine)
    return [
        (applies, words, "" if "*" in engines else ENGLISH.listed(engines), reason)
        for (applies, words, reason), engines in together.items()
    ]


def skipped_rows(runs: Mapping[str, EngineRunRecord]) -> list[tuple[str, str]]:
    """What each engine left out, by engine, with the time that it saved."""
    return [
        (name, ENGLISH.strings[f"skip.{skip}"] + ("" if time_s is None else f" ({unit(time_s, 's')})"))
        for name, run in runs.items()
        for skip, time_s in run.skipped.items()
    ]


def by_severity(findings: Iterable[Finding]) -> Mapping[str, list[str]]:
    """The sentences under the heading of their severity, with the engine that each is of."""
    lists: dict[str, list[str]] = {heading: [] for heading in HEADINGS.values()}
    for each in weighed(findings):
        owner = f"{each.engine}: " if each.engine and "_vs_" not in each.engine else ""
        lists[HEADINGS[each.severity]].append(f"{owner}{each.text}")
    return lists if any(lists.values()) else {}
