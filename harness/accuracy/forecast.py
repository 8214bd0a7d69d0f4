"""What a run of an engine is expected to take: steps of its climb by the analytic model, seconds of a step as timed here."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from typing import Final, NamedTuple

from harness.accuracy.horizon import MODEL, last_s, outgrown_s
from harness.accuracy.refinement import (
    DEFAULT_ACCURACY_RAD,
    LONG_STEPS,
    START_SHARE,
    first_level,
    second_level,
    simulate,
)
from harness.engines import EXACT_IN_SPACE, load
from harness.engines.base import EngineFailure, Settings
from harness.model import MOST_TIMES, Run, RunOptions, Scene, number
from harness.statics.plan import LimitsOfRest, asymmetry, first_motion_s

CERTIFIED_S: Final[Mapping[str, float]] = {MODEL: 6e-5, EXACT_IN_SPACE: 3e-3}
"""Processor seconds per second of motion of models that certify their own error: an order of magnitude."""
TIMED_STEPS: Final = 60_000
"""From so many steps on a step is timed in the scene itself, else as its engine says (`Engine.step_s`), in"""
TRIAL_STEPS: Final = (100, 300, 1000)
"""runs of so many: the first loads the engine, the others differ by steps alone."""
CALM_TIMES: Final = (4.2, 20.0)
"""Steps of a climb over those of its first level: where that and the run that checks it agree, and where the third level does."""
SPACE_TIMES: Final = (4.2, 30.0)
"""The same of a body that turns out of the plane: of 40 seeded `space_scene`s 3.6 to 39 and, of two that fall, 54 and 79."""
TIPPING_TIMES: Final = (8.0, MOST_TIMES)
"""The same where the pedestal tips: runs agree for a while only, so a climb goes on until it may take no more steps, or gives up
before. Of 60 seeded `tipping_scene`s 8.7 to 39.1 in Chipmunk, of ten in Bullet 8.4 to 18.5."""
OUTGROWN_TIMES: Final = (3.0, 4.7)
"""Steps of a climb over those of its whole run up to where errors outgrow that, where they outgrow every level: on the paper's
conditions, 3.1 to 4.6 in Chipmunk."""
LONGER_TIMES: Final = 2.0
"""So many times later than the model's an engine's statue may fall there."""
REST_S: Final = 3.0
"""A statue that stands has come to rest so long after its last impact and the motion's end."""
START_S: Final = 0.9
"""To start a process that has an engine's code: its imports."""
ASKED_S: Final = 30.0
"""The model is asked of so much of a scene at most: what does not outgrow by then hardly does; and"""
LOOK_S: Final = 1e-3
"""for no more samples than these."""


class Range(NamedTuple):
    """From the least to the most that is expected, of steps or processor seconds."""

    least: float
    most: float

    @property
    def middle(self) -> float:
        """As many times the least as the most is its: what many such pieces of work take on average."""
        return float((self.least * self.most) ** 0.5)

    def times(self, factor: float) -> Range:
        """So many times the work."""
        return Range(factor * self.least, factor * self.most)

    def and_also(self, *others: Range | float) -> Range:
        """All of it, a plain number being certain."""
        both = [each if isinstance(each, Range) else Range(each, each) for each in (self, *others)]
        return Range(sum(each.least for each in both), sum(each.most for each in both))


NONE: Final = Range(0.0, 0.0)


def run_s(
    engine: str, scene: Scene, accuracy_rad: float | None = None, dt_s: float | None = None, *, timed: bool = True
) -> Range:
    """The processor seconds that an engine is expected to take for a scene, without what its history takes.

    Steps of a long run are `timed` in the scene itself, which takes some of them.
    """
    if engine in CERTIFIED_S:
        seconds = CERTIFIED_S[engine] * scene.duration_s
        return Range(seconds, seconds)
    if load(engine).missing() is not None:
        return NONE
    steps = expected_steps(engine, scene, accuracy_rad, dt_s)
    if steps.most < TIMED_STEPS or not timed:
        return steps.times(load(engine).step_s(scene))
    return steps.times(timed_step_s(engine, scene, accuracy_rad, dt_s))


def worth_a_process(engine: str, taken: Range) -> bool:
    """Whether a run is made beside the others in a process of its own: where it takes longer than the process to start.

    What certifies may have to be compiled first.
    """
    return engine in CERTIFIED_S or taken.middle > START_S


@lru_cache(maxsize=8)
def expected_steps(name: str, scene: Scene, accuracy_rad: float | None = None, dt_s: float | None = None) -> Range:
    """Steps of all runs that a contact engine is expected to make of a scene, to a target or with an expert's own step."""
    # A body that leaves the plane, or is shaken across it, falls sooner or later than in the plane.
    space = load(name).capabilities.dimensions == 3 and scene.pedestal is None and asymmetry(scene) is not None
    model = simulate(_asked(scene), EXACT_IN_SPACE if space else MODEL)
    if space and model.outcome.failed:  # it computes no wall, and no prescribed ratio
        model = simulate(_asked(scene), MODEL)
    least_s, most_s = moving_s(scene, model)
    rests = "quiet_rest" in load(name).capabilities.skips and scene.table == "frame"
    if rests and LimitsOfRest.of(scene) is not None:
        # Of what stands between two crests that move it nothing is integrated.
        moved_s = sum(each.end_s - each.start_s for each in model.patterns if each.name != "rest")
        least_s = min(least_s, moved_s) if moved_s > 0.0 else least_s
    if dt_s is not None:
        return Range(least_s / dt_s, most_s / dt_s)
    target_rad, levels = accuracy_rad or DEFAULT_ACCURACY_RAD, load(name).refinement_levels(scene)
    first, index = first_level(levels, target_rad, START_SHARE)
    second = levels[second_level(levels, index)]
    finest_rad = levels[-1].expected_error_rad
    if scene.duration_s >= LONG_STEPS * second.dt_s and outgrown_s(_asked(scene), finest_rad, target_rad) < math.inf:
        # Where errors outgrow every level the engine may stand where the model falls, for some while at least.
        longer_s = min(most_s, LONGER_TIMES * least_s)
        # As a time of motion, like the others: nothing is integrated before the first push.
        coarser_s = outgrown_s(_asked(scene), second.expected_error_rad, target_rad) - first_motion_s(scene)

        def steps(times: float, end_s: float) -> float:
            return times * min(end_s, coarser_s) / second.dt_s + max(end_s - coarser_s, 0.0) / levels[0].dt_s

        return Range(steps(OUTGROWN_TIMES[0], least_s), steps(OUTGROWN_TIMES[1], longer_s))
    tips = model.validity.get("left_domain_by") == "pedestal_tips" and not _falls(model)
    return Range(*(SPACE_TIMES if space else TIPPING_TIMES if tips else CALM_TIMES)).times(least_s / first.dt_s)


def moving_s(scene: Scene, run: Run | None = None) -> tuple[float, float]:
    """Seconds of a scene that engines step through: from the first push to a fall by the model, and to rest if it stands.

    `run` is the model's, where it is known.
    """
    run = run or simulate(_asked(scene), MODEL)
    begin_s = min(first_motion_s(scene), scene.duration_s)
    # What still moves when the model is asked no longer may move to the end.
    moves = run.outcome.failed or (run.end_s < scene.duration_s and not run.outcome.overturned)
    impacts = (scene.duration_s,) if moves else run.impact_times_s or (0.0,)
    rest_s = min(max(scene.base_excitation.end_s, impacts[-1], begin_s) + REST_S, scene.duration_s)
    end_s = min(run.end_s, rest_s) if _falls(run) else rest_s
    return max(end_s - begin_s, 0.0), rest_s - begin_s


def _asked(scene: Scene) -> Scene:
    return replace(scene, duration_s=min(scene.duration_s, ASKED_S), output_dt_s=max(scene.output_dt_s, LOOK_S))


def _falls(run: Run) -> bool:
    """Whether the model's statue falls, told before the model left its domain."""
    return run.outcome.overturned and last_s(run) <= number(run.validity, "left_domain_s", run.end_s)


def first_settings(name: str, scene: Scene, accuracy_rad: float | None = None, dt_s: float | None = None) -> Settings:
    """The settings of the first run of a contact engine, to a target or with an expert's own step."""
    engine = load(name)
    if dt_s is not None:
        return engine.settings_for_dt(scene, dt_s)
    return first_level(engine.refinement_levels(scene), accuracy_rad or DEFAULT_ACCURACY_RAD, START_SHARE)[0]


def timed_step_s(name: str, scene: Scene, accuracy_rad: float | None = None, dt_s: float | None = None) -> float:
    """Processor seconds of a step of an engine in this scene, timed here over its first steps."""
    engine, begin_s, spent = load(name), first_motion_s(scene), list[tuple[int, float]]()
    settings = first_settings(name, scene, accuracy_rad, dt_s)
    for count in TRIAL_STEPS:
        short = replace(scene, duration_s=min(begin_s + count * settings.dt_s, scene.duration_s))
        begin = time.thread_time()
        try:
            steps = engine.simulate(short, settings, RunOptions()).steps
        except EngineFailure:  # its run will say why
            return engine.step_s(scene)
        spent.append((steps, time.thread_time() - begin))
    (few, few_s), (many, many_s) = spent[-2:]
    return (many_s - few_s) / (many - few) if many > few and many_s > few_s else engine.step_s(scene)
