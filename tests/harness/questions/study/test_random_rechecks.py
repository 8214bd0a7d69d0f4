"""An audit counts the left-out cases that would have said otherwise."""

from dataclasses import replace

import pytest

from harness.model import Outcome
from harness.questions.study import cases as selection
from harness.questions.study.cases import StudyFile, recheck
from harness.records.study import StudyRow, Value
from tests import doubles

SIZE = 17
KEYS = ("motion.x.frequency_hz", "motion.x.amplitude_g")


def study(cases: str) -> StudyFile:
    grids = [{"key": key, "start": 1.0, "stop": float(SIZE), "count": SIZE} for key in KEYS]
    variant = {"name": "own", "engines": ["analytic", "pymunk"]}
    content = {"title": "t", "scene": "s.toml", "vary": grids, "variant": [variant], "ask": {"cases": cases}}
    return StudyFile.model_validate(content)


def outcome(x: int, y: int, island: bool) -> str:
    inside = island and (x, y) == (3, 13)
    return "overturned_right" if (y > 8) != inside else "stands"


def rows(island: bool) -> list[StudyRow]:
    """A map refined for pymunk, with an audit that hits every place off the coarse grid's cells' corners at x = 3."""
    places: list[selection.Place] = [(x, y) for x in range(SIZE) for y in range(SIZE)]
    known: dict[selection.Place, str] = {}
    while new := selection.refined(places, known, (0, 1)).keys() - known.keys():
        known |= {place: outcome(place[0], place[1], island) for place in new}
    found = []
    for number, (x, y) in enumerate(places):
        varied: dict[str, Value] = {"variant": "own", KEYS[0]: 1.0 + x, KEYS[1]: 1.0 + y}
        run = doubles.case_run(outcome=Outcome(outcome(x, y, island)))
        asked = (x, y) in known or x == 3
        reason = selection.COARSE if (x, y) in known else selection.RECHECK if x == 3 else selection.SAME_CELL
        for engine, why, answer in (("analytic", selection.EVERY, run), ("pymunk", reason, run if asked else None)):
            found.append(StudyRow(number=number, engine=engine, reason=why, varied=varied, run=answer))
    return found


@pytest.mark.parametrize(("island", "differ"), [(False, 0), (True, 1)])
def test_an_audit_of_a_map_finds_what_its_cells_hide(island: bool, differ: int) -> None:
    found = recheck(study("adaptive"), rows(island))
    assert found.audited > 5
    assert found.differ == differ


def test_near_a_boundary_the_audit_is_held_against_the_analytic_outcome() -> None:
    other = [replace(row, run=doubles.case_run()) if row.engine == "pymunk" else row for row in rows(False)]
    audited = [row for row in other if row.reason == selection.RECHECK]
    found = recheck(study("boundary"), other)
    assert found.audited == len(audited)
    assert found.differ == sum(outcome(2, int(row.varied[KEYS[1]]) - 1, False) != "stands" for row in audited)


def test_where_every_case_is_asked_there_is_no_audit() -> None:
    assert recheck(study("all"), rows(False)) is None
