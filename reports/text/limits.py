"""Limits that runs met, what was left out of them, in words: what a fall itself adds is told apart; notes by their weight."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from harness.model.history import History
from harness.model.run import EngineRunRecord, Intervention
from harness.records.base import Table
from harness.records.run import RunRecord
from reports.blocks import Text, words
from reports.messages import ENGLISH, Language
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


def limit_rows(source: RunSource, say: Language = ENGLISH) -> dict[str, Sequence[tuple[str, str]]]:
    """Each model's limits as words and value; of one that overturns also what they were until its point of no return."""
    by_name: dict[str, Sequence[tuple[str, str]]] = {}
    for name, run in source.runs.items():
        if not run.validity:
            continue
        before = before_fall(run, source.histories.get(name))
        rows = validity_rows(run.validity, before, run.no_return_time_s, say)
        by_name[name] = [*rows, *interventions_row(run.interventions, run.validity, say)]
    return by_name


def interventions_row(
    written: Mapping[str, Intervention], validity: Table, say: Language = ENGLISH
) -> list[tuple[str, str]]:
    """What was written to the engine's bodies on the way, in one line; none for an unmodified engine."""
    if not written:
        return []
    kinds = say.listed(f"{kind.replace('_', ' ')} {item.count or item.steps_again}" for kind, item in written.items())
    parts = ("moved_m", "velocity_m_s", "rate_rad_s", "given_j", "taken_j")
    sums = {part: say.digits(sum(vars(item)[part] for item in written.values()), 2) for part in parts}
    lost = validity.get("lost_in_impacts_j")
    beside = say("text.impacts_lost", lost=say.digits(lost, 2)) if isinstance(lost, float) else ""
    again = sum(item.steps_again for item in written.values())
    return [(say("label.interventions"), say("text.interventions", kinds=kinds, again=again, beside=beside, **sums))]


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


def fall_times(source: RunSource, say: Language = ENGLISH) -> list[Text]:
    """When the statue passes its balance point for good, by model; nothing where none overturns."""
    falls = {name: run.no_return_time_s for name, run in source.runs.items() if run.no_return_time_s is not None}
    times = say.listed(f"{say.short(time_s, 3)} s ({name})" for name, time_s in falls.items())
    return [words(say, "fall", "caveat", times=times)] if falls else []


def plan_lines(record: RunRecord, say: Language = ENGLISH) -> list[str]:
    """What was left out and what was computed, for which engines (those of one reason together), and why; what each saved."""
    together: dict[tuple[bool, str, str], list[str]] = {}
    for step in record.plan:
        place = step.applies, say(f"skip.{step.skip}"), say.say(step.reason)
        together.setdefault(place, []).append(step.engine)
    lines = [
        say("text.plan_left_out" if applies else "text.plan_computed", what=what, reason=reason,
            engines="" if "*" in engines else f" ({say.listed(engines)})")
        for (applies, what, reason), engines in together.items()
    ]  # fmt: skip
    saved = {(name, skip): time_s for name, run in record.runs.items() for skip, time_s in run.skipped.items()}
    return lines + [
        f"{name}: {say(f'skip.{skip}')}" + ("" if time_s is None else f" ({say.value(time_s, 's')})")
        for (name, skip), time_s in saved.items()
    ]
