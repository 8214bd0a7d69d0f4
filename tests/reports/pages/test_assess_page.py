"""The page of an assessment: its headline and colour follow from the probability, never from one run."""

from dataclasses import replace
from pathlib import Path

import pytest

from harness.model import Severity
from harness.questions.assess.assessment import answer_of, assess, findings_of
from harness.records.assess import Assessment, AssessRecord, Index, ProbabilityDifference
from reports.blocks import Table
from reports.messages import ENGLISH
from reports.pages.assess_page import assess_page, assess_verdict
from reports.source import tone_of_answers, tone_of_probability
from tests.reports.page_parts import cell_text, every
from tests.scenes_for_tests import paestum


@pytest.fixture(scope="module")
def shaken() -> AssessRecord:
    """The paper's pedestal as the model assesses it."""
    return assess(paestum(0.429, 3.0, duration_s=3.0), ["analytic"], draws=40).record


def answer(p: float, low: float, high: float) -> Assessment:
    return Assessment(p, low, high, level=0.9, draws=100, engine_runs=100)


@pytest.mark.parametrize(
    ("p", "high", "colour"),
    [
        (0.0, 0.01, "agree"),
        (0.05, 0.09, "agree"),
        (0.05, 0.10, "differ"),
        (0.051, 0.06, "differ"),
        (0.5, 0.6, "failed"),
    ],
)
def test_green_needs_a_fall_that_is_improbable_and_known_to_be(p: float, high: float, colour: str) -> None:
    assert tone_of_probability(answer(p, 0.0, high)) == colour


def test_draws_without_an_end_are_said_and_are_no_reason_for_green() -> None:
    half = replace(answer(0.0, 0.0, 0.5), undecided=0.5)
    assert half.tells
    assert tone_of_probability(half) == "differ"
    most = replace(half, high=0.9, undecided=0.9)
    assert not most.tells
    assert tone_of_answers({"analytic": replace(half, undecided=1.0)}, "agree") == "differ"


def test_the_most_probable_fall_decides_the_colour(shaken: AssessRecord) -> None:
    record = replace(
        shaken,
        assessment={"analytic": answer(0.01, 0.0, 0.02), "pymunk": answer(0.3, 0.25, 0.35)},
        difference_from_model={"pymunk": ProbabilityDifference(-0.29, -0.34, -0.24, 0.9)},
    )
    answer_told = answer_of(record)
    assert answer_told.findings[0].values["model"] == "pymunk"
    assert assess_verdict(replace(record, answer=answer_told).texted(ENGLISH.say)).tone == "differ"
    (difference,) = (each for each in findings_of(record) if each.code == "probability_difference")
    assert (difference.severity, difference.values["shown"]) == (Severity.CAUTION, "under")
    assert [difference.values[key] for key in ("low", "difference", "high")] == [0.24, 0.29, 0.34]


def test_what_the_model_alone_answers_is_its_own_where_another_contradicts_it(shaken: AssessRecord) -> None:
    """Of a statue that pybullet says to fall in 29 of 100 draws more nothing is "a reserve", and options are the model's."""
    options = replace(shaken.options, options=[replace(each, high=0.0) for each in shaken.options.options])
    for apart, kind in ((ProbabilityDifference(-0.29, -0.34, -0.24, 0.9), "alone"), (None, "some")):
        differences = {} if apart is None else {"pybullet": apart}
        reserved = replace(shaken.fragility, factor_at={"0.05": 2.0}, soonest_at={"0.05": 2.0})
        mine = replace(shaken, difference_from_model=differences, options=options, fragility=reserved)
        told = {each.code: each.values for each in (*answer_of(mine).findings, *findings_of(mine))}
        assert told["reserve"]["kind"] == kind
        assert ("options_contradicted" in told) is (apart is not None)


def test_answer_and_findings_name_what_helps_what_room_it_needs_and_what_decides(shaken: AssessRecord) -> None:
    inputs = {"contact.floor": Index(0.4, 0.02, 0.77), "motion.scale": Index(0.1, 0.02, 0.4)}
    record = replace(shaken, indices=inputs)
    told = answer_of(record)
    assert told.code == told.findings[0].code
    assert [each.code for each in told.findings[-3:]] == ["reserve", "best_option", "clearance"]
    assert told.findings[-3].values["kind"] == "none"
    (decides,) = (each for each in findings_of(record) if each.code == "decisive_input")
    assert decides.values == {"input": "contact.floor", "share": 0.77, "planar": False, "equal": []}
    # With another seed it would be the other that matters most.
    near = replace(record, indices={**inputs, "motion.scale": Index(0.1, 0.09, 0.71)})
    (decides,) = (each for each in findings_of(near) if each.code == "decisive_input")
    assert decides.values["equal"] == ["motion.scale"]


def test_every_option_that_was_compared_stands_in_a_table(shaken: AssessRecord, tmp_path: Path) -> None:
    names = {ENGLISH.word(each.name) for each in shaken.options.options}
    for record, there in ((shaken, names), (replace(shaken, options=None), set())):
        tables = every(assess_page(tmp_path, record, ENGLISH), Table)
        assert names & {cell_text(row[0]) for each in tables for row in each.rows} == there


@pytest.mark.parametrize(("p", "high", "colour"), [(0.01, 0.02, "agree"), (0.3, 0.32, "differ"), (0.9, 0.95, "failed")])
def test_a_runs_colour_follows_the_probability(p: float, high: float, colour: str) -> None:
    item = answer(p, 0.0, high)
    assert tone_of_answers({"analytic": item}, "agree") == colour
    assert tone_of_answers({"analytic": item}, "failed") == "failed"
