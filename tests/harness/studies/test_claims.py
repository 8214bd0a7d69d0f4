"""The paper's claims are judged by what the rows say: rows made to hold, to fail and to hold for some."""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import Any

import pytest

from harness.engines.contact.impact import IMPOSED_LABEL
from harness.model.history import Outcome
from harness.records.study import StudyRow, Value
from harness.studies import claims
from tests import doubles

FREQUENCIES = (1.5, 2.0, 3.0, 4.5, 6.0)


def row(frequency: float, pedestal: bool, peak: float, *, fell_s: float | None = None, slip: float = 0.01) -> StudyRow:
    varied: dict[str, Value] = {
        "contact.restitution": 0.85,
        "motion.x.amplitude_g": 0.334,
        "motion.x.frequency_hz": frequency,
        "pedestal": "keep" if pedestal else "none",
        "variant": "own impact",
    }
    outcome = Outcome.STANDS if fell_s is None else Outcome.OVERTURNED_RIGHT
    run = doubles.case_run(outcome=outcome, peak_theta_rad=peak, no_return_time_s=fell_s, peak_slip_m=slip)
    return StudyRow(number=0, engine="analytic", reason="", varied=varied, run=run)


def with_run(row: StudyRow, **fields: Any) -> StudyRow:
    assert row.run is not None
    return replace(row, run=replace(row.run, **fields))


def paper_rows() -> list[StudyRow]:
    """What the paper describes: the floor's statue rotates more and falls at low frequency, and all fades."""
    found = []
    for frequency in FREQUENCIES:
        fell = 1.0 if frequency <= 2.0 else None
        found.append(row(frequency, False, 1.5 if fell else 0.4 / frequency, fell_s=fell))
        found.append(row(frequency, True, 0.3 / frequency))
    return found


def verdicts(rows: list[StudyRow], top_m: float = 0.70) -> dict[str, claims.Verdict]:
    return {v.claim: v for v in claims.judge(rows, lambda theta_rad: top_m)}


def test_rows_as_the_paper_describes_them_hold_every_claim() -> None:
    found = verdicts(paper_rows())
    assert {v.verdict for v in found.values()} == {claims.HOLDS}
    assert set(claims.headline(list(found.values())).values()) == {claims.HOLDS}


@pytest.mark.parametrize(
    ("claim", "change"),
    [
        ("i", {"peak_theta_rad": 0.5, "no_return_time_s": None, "outcome": Outcome.STANDS}),
        ("ii", {"no_return_time_s": 2.0, "outcome": Outcome.OVERTURNED_LEFT}),
        ("v", {"peak_slip_m": 0.2}),
    ],
)
def test_a_claim_fails_when_its_rows_say_otherwise(claim: str, change: dict[str, Any]) -> None:
    rows = [with_run(item, **change) for item in paper_rows()]
    assert verdicts(rows)[claim].verdict == claims.FAILS


def test_an_advantage_that_grows_above_three_hertz_does_not_fade() -> None:
    rows = [row(f, False, 0.1 * f) for f in FREQUENCIES] + [row(f, True, 0.05) for f in FREQUENCIES]
    found = verdicts(rows)
    assert found["iii"].verdict == claims.FAILS
    assert found["iv"].held == len(
        list(itertools.pairwise(FREQUENCIES))
    )  # only the pedestal's flat series does not rise


def test_the_walls_limit_wants_geometry_and_no_deeper_return() -> None:
    assert verdicts(paper_rows(), top_m=0.9)["vi"].verdict == claims.SOME
    deep = [*paper_rows(), row(1.0, True, 0.6)]
    assert verdicts(deep)["vi"].verdict == claims.SOME
    assert verdicts(deep, top_m=0.9)["vi"].verdict == claims.FAILS


def test_models_of_a_variant_with_an_imposed_law_do_not_enter_the_headline() -> None:
    beside = [replace(r, varied={**r.varied, "variant": "one ratio"}) for r in paper_rows()]
    imposed = [replace(with_run(r, labels=[IMPOSED_LABEL]), engine="pymunk") for r in beside]
    judged = claims.judge([*imposed, *beside], lambda theta_rad: 0.70)
    assert all(v.imposed for v in judged)
    assert set(claims.headline(judged).values()) == {claims.UNTESTED}
    assert not any(v.imposed for v in claims.judge(beside, lambda theta_rad: 0.70))
