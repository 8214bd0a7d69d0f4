"""Limits and what was left out, in words: what a fall adds is told apart from what was before it."""

from collections.abc import Callable
from dataclasses import replace
from html import unescape
from pathlib import Path

import numpy as np
import pytest

from harness.model import History, Intervention, Outcome, Run, changes_answer, info, texted
from harness.records.run import RunRecord
from harness.statics.plan import Step
from reports.blocks import Details, Group, Text, notes
from reports.messages import ENGLISH
from reports.source import RunSource, before_fall, interventions_text, limits, plan_lines
from tests.reports.invented_run import invented_history, invented_run

VALIDITY = {"yaw_rad": 0.9, "statue_slip_m": 0.02, "energy_gained_j": 9.6, "touching_vertices": 12}


@pytest.fixture
def fallen() -> tuple[Run, History]:
    """A run that falls; its turn and slip grow in the fall alone, and are small before."""
    history = invented_history(0.0, falls=True)
    run = invented_run("pybullet", history, Outcome.OVERTURNED_RIGHT, 1e-3)
    run = replace(run, validity=VALIDITY)
    late = history.t_s > run.no_return_time_s
    extra = {"yaw_rad": 1.0 + np.where(late, 0.9, 0.003), "statue_slip_m": np.where(late, 0.02, -0.001)}
    extra["yaw_rad"][0] = 1.0
    return run, replace(history, extra=extra)


def test_before_the_fall_stands_what_the_history_says(fallen: tuple[Run, History]) -> None:
    run, history = fallen
    assert before_fall(run, history) == pytest.approx({"yaw_rad": 0.003, "statue_slip_m": 0.001})
    assert before_fall(run, None) == {}
    # Of one that slid across the plane the column, along it, said nothing: 79 cm before its fall were 2e-9 m.
    aside = replace(run, validity={**run.validity, "slip_across_m": 0.79})
    assert before_fall(aside, history) == pytest.approx({"yaw_rad": 0.003})
    assert before_fall(replace(run, no_return_time_s=None), history) == {}


def test_a_fall_is_told_beside_what_was_before(fallen: tuple[Run, History]) -> None:
    run, history = fallen
    shown = limits(run, history)
    assert shown["yaw_rad"] == f"0.0030 until {run.no_return_time_s:.3f} s; with the fall 0.9000"
    assert shown["energy_gained_j"] == VALIDITY["energy_gained_j"]
    needed = {**run.validity, "statue_friction_needed": 124.6}
    for each, said in ((run, "124.6, with the fall"), (replace(run, no_return_time_s=None), 124.6)):
        assert limits(replace(each, validity=needed), history)["statue_friction_needed"] == said
    assert limits(run, None)["yaw_rad"] == VALIDITY["yaw_rad"], "what no history follows is told as it is"


def test_the_limits_of_every_model_stand_on_its_page(
    page_of: Callable[[str], Path], record_of: Callable[[str], RunRecord]
) -> None:
    _, _, page = unescape(page_of("apart").read_text(encoding="utf-8")).partition(ENGLISH("text.limits"))
    for name, run in record_of("apart").runs.items():
        _, _, own = page.partition(f"<h3>{name}</h3>")
        assert run.validity
        for key, value in run.validity.items():
            told = value is None or f"<dt>{ENGLISH.label(key)}</dt><dd>{ENGLISH.plain(value)}" in own
            assert told, f"{name}: {key}"


def test_engines_of_one_reason_stand_together_with_what_each_left_out_and_saved(source: RunSource) -> None:
    plan = [Step("no_history", name, False, info("plan_histories_asked")) for name in ("analytic", "pymunk")]
    plan.append(Step("base_only", "pybullet", True, info("plan_shape", shape="base")))
    run = invented_run("pybullet", invented_history(0.0), Outcome.STANDS, 1e-3)
    runs = {"pybullet": replace(run, skipped={"base_only": None, "quiet_start": 0.25})}
    record = replace(source.record, plan=plan, runs=runs, histories=[])
    histories, base, quiet = (ENGLISH(f"skip.{name}") for name in ("no_history", "base_only", "quiet_start"))
    assert plan_lines(record) == [
        f"computed: {histories} (analytic and pymunk): {ENGLISH.say(plan[0].reason)}",
        f"left out: {base} (pybullet): {ENGLISH.say(plan[-1].reason)}",
        f"pybullet: {base}",
        f"pybullet: {quiet} (0.250\u00a0s)",
    ]


def test_findings_stand_under_their_severity_and_the_lightest_are_folded() -> None:
    heavy, light = changes_answer("near_tie", margin=1e-4), info("histories_agree")
    first, last = notes(ENGLISH, texted([light, heavy.of("analytic"), light], ENGLISH.say))
    heading = ENGLISH("severity.changes_answer")
    assert first == Group("", [Text([f"analytic: {ENGLISH.say(heavy)}"], "warnings")], heading)
    assert isinstance(last, Details)
    assert last.blocks == [Text([ENGLISH.say(light)], "notes")]
    assert notes(ENGLISH, []) == []


def test_what_was_written_to_bodies_is_one_line() -> None:
    written = {
        "turn_on": Intervention(count=4, velocity_m_s=0.25, given_j=2.0),
        "friction_release": Intervention(steps_again=3),
    }
    run = invented_run("pymunk", invented_history(0.0), Outcome.STANDS, 1e-3)
    done = replace(run, interventions=written, validity={"lost_in_impacts_j": 13.0})
    kinds = f"{ENGLISH('wrote.turn_on')}: 4 and {ENGLISH('wrote.friction_release')}: 3"
    sums = {"moved_m": "0", "velocity_m_s": "0.25", "rate_rad_s": "0", "given_j": "2.0", "taken_j": "0"}
    beside = ENGLISH("text.impacts_lost", lost="13")
    assert interventions_text(done) == ENGLISH("text.interventions", kinds=kinds, beside=beside, again=3, **sums)
    assert interventions_text(replace(done, interventions={})) == ""
