"""A set of cases scored against a reference model, from records as a store keeps them."""

from dataclasses import replace
from typing import Any

import pytest

from harness import History, Outcome, Verdict
from harness.model import to_plain
from harness.questions.study.study_record import KeyedRow, score_sets
from harness.questions.study.study_record import _falls as falls_in
from harness.records.study import CaseRun
from tests import doubles

CASES = 12


def row(number: int, engine: str, history: History, **fields: Any) -> KeyedRow:
    known = {"numerical_uncertainty_rad": 1e-4, "reliable_until_s": 10.0}
    run = CaseRun.stored(to_plain(doubles.run_of(history, engine, **known | fields)))
    key = f"{engine}{number}"
    return KeyedRow(number=number, engine=engine, reason="", varied={"variant": ""}, run=run, key=key)


def test_a_set_is_scored_by_outcome_verdict_and_distribution() -> None:
    """Of twelve cases three are 20 % larger, one of which falls; one falls after its error's bound; the rest agree."""
    rows, histories = [], {}
    for number in range(CASES):
        reference = doubles.rocking(amplitude_rad=0.05 + 0.005 * number)
        fields: dict[str, Any] = {}
        tested = reference
        if number < 3:
            tested = doubles.scaled(reference, 1.2)
            fields = {"outcome": Outcome.OVERTURNED_LEFT, "no_return_time_s": 3.0} if number == 0 else {}
        elif number == 3:
            tested = doubles.parted(reference, 6.0, 0.01)
            fields = {"outcome": Outcome.OVERTURNED_RIGHT, "reliable_until_s": 5.0}
        histories |= {f"analytic{number}": reference, f"pymunk{number}": tested}
        rows += [row(number, "analytic", reference), row(number, "pymunk", tested, **fields)]
    found = score_sets(rows, history=histories.get)["pymunk"]
    assert found.cases == CASES
    assert found.verdicts == {
        Verdict.AGREE.value: pytest.approx(8 / 12),
        Verdict.MODEL.value: pytest.approx(3 / 12),
        Verdict.UNBOUNDED.value: pytest.approx(1 / 12),
        Verdict.HORIZON.value: 0.0,
        Verdict.DOMAIN.value: 0.0,
        Verdict.PLANE.value: 0.0,
    }
    assert found.flips == 1
    assert found.outcomes.within_uncertainty == 1
    assert found.outcomes.confusion["stands"]["overturned_left"] == 1
    assert found.outcomes.accuracy.value == pytest.approx(10 / 11)
    assert found.peaks.area.value > 0.0
    # What the terminal says is what the page counts: all cases, whatever their outcomes are worth.
    assert (found.same, found.cases) == (10, 12)
    told = found.findings("pymunk")[0]
    assert told.code == "peaks_alike"
    assert (told.values["model"], told.values["reference"]) == ("pymunk", "analytic")
    assert told.values["area"] == found.peaks.area.value


def test_a_model_whose_maxima_are_larger_over_a_suite_of_motions_is_told_apart() -> None:
    """Thirty motions of unlike strength; twice the rotation in each differs by more than chance, the same by nothing."""
    rows = []
    for number in range(30):
        reference = doubles.rocking(amplitude_rad=0.02 + 0.001 * number)
        rows += [row(number, "analytic", reference), row(number, "pymunk", doubles.scaled(reference, 2.0))]
        rows.append(row(number, "pybullet", reference))
    found = score_sets(rows)
    assert found["pymunk"].peaks.differ
    assert "peaks_differ" in [each.code for each in found["pymunk"].findings("pymunk")]
    assert found["pybullet"].peaks.ks == found["pybullet"].peaks.area.value == 0.0
    assert "peaks_alike" in [each.code for each in found["pybullet"].findings("pybullet")]


def test_what_a_contact_engine_gives_at_rest_is_no_other_distribution() -> None:
    """Of twelve statues eight rest, at 0 by the model and at 1e-6 rad by the engine."""
    peaks = [0.0 if number < 8 else 0.01 * number for number in range(CASES)]
    rested = [
        row(number, name, doubles.rocking(), peak_theta_rad=max(peak, least))
        for number, peak in enumerate(peaks)
        for name, least in (("analytic", 0.0), ("pymunk", 1e-6))
    ]
    found = score_sets(rested)["pymunk"].peaks
    assert (found.ks, found.ks_p, found.area.value) == (0.0, 1.0, 0.0)


def test_without_histories_peaks_and_outcomes_decide() -> None:
    same = doubles.rocking()
    rows = [row(0, "analytic", same), row(0, "pymunk", doubles.scaled(same, 1.2))]
    found = score_sets(rows)["pymunk"]
    assert found.verdicts[Verdict.MODEL.value] == 1.0
    assert found.peaks is None


def test_failed_runs_and_runs_not_sent_are_left_out() -> None:
    history = doubles.rocking()
    rows = [row(k, "analytic", history) for k in range(3)]
    rows += [row(0, "pymunk", history), row(1, "pymunk", history, outcome=Outcome.CRASHED)]
    rows.append(replace(row(2, "pymunk", history), run=None, key=None))
    assert score_sets(rows)["pymunk"].cases == 1


def test_a_model_that_left_its_domain_is_not_blamed() -> None:
    history = doubles.rocking()
    short = doubles.truncated(history, 3.0)
    rows = [row(0, "analytic", short, outcome=Outcome.LIFT_OFF), row(0, "pymunk", history)]
    found = score_sets(rows, history={"analytic0": short, "pymunk0": history}.get)["pymunk"]
    assert found.verdicts[Verdict.DOMAIN.value] == 1.0
    assert found.outcomes.undecided == 1


@pytest.mark.parametrize("cause", ["pedestal_tips", "statue_slides"])
def test_a_run_outside_its_domain_has_no_outcome_to_compare(cause: str) -> None:
    """Held upright, a pedestal that tips has the model's statue stand: neither the same as an engine's outcome nor another."""
    tips: dict[str, Any] = {"validity": {"left_domain_s": 1.0, "left_domain_by": cause}}
    falls: dict[str, Any] = {"outcome": Outcome.OVERTURNED_LEFT, "no_return_time_s": 0.5, "peak_theta_rad": 1.5}
    history = doubles.rocking()
    rows = []
    for number in range(2 * CASES):
        # Of those that tip half would be the same by chance; one falls before its pedestal tips.
        model = {} if number < CASES else tips | (falls if number == CASES else {})
        engine = falls if CASES <= number < 2 * CASES - 4 else {}
        rows += [row(number, "analytic", history, **model), row(number, "pymunk", history, **engine)]
    found = score_sets(rows)["pymunk"]
    assert (found.same, found.cases) == (CASES + 1, CASES + 1)
    assert found.outcomes.undecided == CASES - 1
    assert sum(sum(each.values()) for each in found.outcomes.confusion.values()) == CASES + 1
    assert found.outcomes.accuracy is not None
    assert found.outcomes.accuracy.value == 1.0
    assert found.peaks is not None
    assert found.peaks.area.value == 0.0


def test_a_fall_outside_its_domain_is_none_that_a_study_counts() -> None:
    slides: dict[str, Any] = {"validity": {"left_domain_s": 0.5, "left_domain_by": "statue_slides"}}
    falls: dict[str, Any] = {"outcome": Outcome.OVERTURNED_LEFT, "no_return_time_s": 1.0}
    wall: dict[str, Any] = {"outcome": Outcome.TOUCHES_WALL}
    fields = (falls, falls | slides, slides, {}, wall, wall | slides)
    (told,) = falls_in([row(k, "analytic", doubles.rocking(), **each) for k, each in enumerate(fields)])
    assert [told.values[key] for key in ("falls", "cases", "wall", "open")] == [1, 6, 1, 3]
