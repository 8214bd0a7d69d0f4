"""The verdict of a run's page: the record's answer, and how far the statue and its pedestal move."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Final

import numpy as np

from harness.model.finding import Finding, info
from harness.model.history import Array, History, Outcome
from harness.model.in_space import support_m
from harness.model.run import EngineRunRecord
from harness.records.run import has_answer
from reports.blocks import Chip, Verdict, code, verdict
from reports.drawing.kinematics import section
from reports.messages import ENGLISH, Language
from reports.source import RunSource
from reports.text.chance import Tone, tone_of_outcomes, worse_tone
from reports.text.limits import TIPS_RAD, tilt_rad
from reports.text.study_rows import family

STUCK_M: Final = 1e-5
"""Slips of a pedestal, and ways of a top, below this are the give of a contact engine at rest."""


def run_verdict(source: RunSource, chips: Sequence[Chip] = (), say: Language = ENGLISH) -> Verdict:
    """The record's answer as a headline with points, coloured by what happens and by how probable a fall is."""
    moved = [say.say(each) for each in (*_reach(source), *_slip(source))]
    return verdict(source.record, tone(source), moved, chips)


def tone(source: RunSource) -> str:
    """The colour of a run: one run is one draw: a shaking that it stands is no reason for green, nor are models that differ."""
    answered = [run for run in source.runs.values() if has_answer(run)]
    colour: Tone = tone_of_outcomes(family(run.outcome) for run in answered)
    if colour == "agree" and code(source.record) not in ("agree", "agree_until", "one_model"):
        colour = "differ"
    if source.record.assessment:
        return worse_tone(source.record.assessment, colour)
    return "differ" if colour == "agree" and source.record.motion.accel_m_s2 else colour


def _reach(source: RunSource) -> list[Finding]:
    """How far the top moves where the statue stands, and what room is left to the wall."""
    shape, wall, found = section(source.scene), source.scene.wall, []

    def moved(item: History) -> Array:
        return support_m(source.scene.pedestal, item.slip_m, item.extra)

    tops = {
        name: float(np.abs(shape.top_displacement_m(item.theta_rad, moved(item))).max())
        for name, item in source.histories.items()
        if source.runs[name].outcome == Outcome.STANDS
    }
    if tops and max(tops.values()) > STUCK_M:
        name = max(tops, key=lambda item: tops[item])
        found.append(info("top_moves", top_m=tops[name], model=name))
    if (
        wall is not None
        and source.histories
        and not any(r.outcome is Outcome.TOUCHES_WALL for r in source.runs.values())
    ):
        side = 1 if wall.side == "right" else -1
        left = min(
            wall.distance_m - float(shape.overhang_m(item.theta_rad, moved(item), side).max())
            for item in source.histories.values()
        )
        found.append(info("room_to_wall", side=wall.side, left_m=max(left, 0.0)))
    return found


def _slip(source: RunSource) -> list[Finding]:
    """How far the pedestal slides, and whether it tips."""
    answered = {name: run for name, run in source.runs.items() if has_answer(run)}
    if source.scene.pedestal is None or not answered:
        return []
    peaks = [run.peak_slip_m for run in answered.values()]
    slides = info("pedestal_slips", slip_m=[min(peaks), max(peaks)]) if max(peaks) >= STUCK_M else None
    tilts = {name: tilt_rad(run, source.histories.get(name)) for name, run in answered.items()}
    most = max(tilts, key=lambda name: tilts[name])
    tips = [info("pedestal_tilts", tilt_rad=tilts[most], model=most)] if tilts[most] > TIPS_RAD else []
    return [info("pedestal_still") if slides is None else slides, *tips]


def unlike_motions(runs: Iterable[EngineRunRecord]) -> bool:
    """Whether not all models were given the same axes of the floor's motion."""
    return len({tuple(run.motion_axes) for run in runs if run.motion_axes is not None}) > 1


def prediction_s(source: RunSource) -> float | None:
    """The measured horizon of prediction: from then on nobody can follow the motion; None where none was measured."""
    return min((each.intrinsic_s for each in (source.record.horizons or {}).values()), default=None)


def horizon_s(source: RunSource) -> float | None:
    """Up to when every model's history is reliable: the least `reliable_until_s`; None when no model states one."""
    times = [
        run.reliable_until_s
        for run in source.runs.values()
        if run.reliable_until_s is not None and run.reliable_until_s < run.end_s
    ]
    return min(times) if times else None
