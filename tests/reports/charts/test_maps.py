"""A map tells computed places from those whose surroundings agree, and one picture holds the boundary of every model."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from harness.questions.study import cases as selection
from harness.records.study import Panel
from reports.charts.figure import DARK, SURFACES
from reports.messages import ENGLISH, language
from reports.pages.study_page import LINES, map_figures, number_map, panel_place, trust_map
from reports.source import Answers, Condition
from tests.budgets_reports import LEAST_OF_LINES
from tests.reports.charts.parts import kind_at, part
from tests.reports.invented_records import trust
from tests.reports.invented_study import case_row, case_run

SIZE = 17
BOUNDARY = {"analytic": 8.5, "pybullet": 9.5}
"""The statue overturns above this amplitude."""


def outcome(engine: str, y: int) -> str:
    return "overturned_right" if y > BOUNDARY[engine] else "stands"


def explored() -> set[selection.Place]:
    """The places that pybullet is asked on its way to the boundary."""
    places: list[selection.Place] = [(x, y) for x in range(SIZE) for y in range(SIZE)]
    known: dict[selection.Place, str] = {}
    while new := selection.refined(places, known, (0, 1)).keys() - known.keys():
        known |= {place: outcome("pybullet", place[1]) for place in new}
    return set(known)


def condition(x: int, y: int, asked: set[selection.Place]) -> Condition:
    answers = {}
    for engine in BOUNDARY:
        run = case_run(outcome(engine, y))
        known = engine == "analytic" or (x, y) in asked
        answers[f"{engine} (own)"] = case_row(engine, run if known else None, selection.SAME_CELL)
    return Condition({"motion.x.frequency_hz": 1.0 + x, "motion.x.amplitude_g": float(y)}, answers)


@pytest.fixture(scope="module")
def figures() -> dict[str, dict[str, Any]]:
    asked = explored()
    found = [condition(x, y, asked) for x in range(SIZE) for y in range(SIZE)]
    keys = ["motion.x.frequency_hz", "motion.x.amplitude_g"]
    return dict(map_figures(Answers(["analytic (own)", "pybullet (own)"], found, keys)))


def test_where_nothing_falls_no_boundary_is_drawn() -> None:
    """A study with and without a pedestal showed an empty chart for the half in which nothing fell."""
    models, keys = ["analytic (own)", "pybullet (own)"], ["motion.x.frequency_hz", "motion.x.amplitude_g"]
    for least, words in ((0, models), (8, [ENGLISH("chart.boundaries"), *models])):
        places = [(x, y) for x in range(4) for y in range(least, least + 4)]
        found = [condition(x, y, set(places)) for x, y in places]
        assert [name for name, _ in map_figures(Answers(models, found, keys))] == words


def test_what_a_pointer_is_told_is_written_in_the_readers_language() -> None:
    """Italian pages had 0,3 on the axis, and 0.3 under the pointer."""
    drawn = number_map(np.array([[0.25, 0.5]]), ("f", [1.5, 2.5]), ("a", [0.3]), "rad", language("it"))
    assert drawn["datasets"]["tips"][0]["tip"] == ["f 1,5\na 0,3\n0,25 rad", "f 2,5\na 0,3\n0,5 rad"]
    assert panel_place(Panel(0.9, 0.334, 2.5, {}), language("it")) == "0,334 g; 2,5 Hz"


def test_places_that_were_not_computed_are_pale(figures: dict[str, dict[str, Any]]) -> None:
    map_ = figures["pybullet (own)"]
    assert kind_at(map_, 1.0, 16.0) == "overturns"
    assert kind_at(map_, 4.0, 3.0) == ENGLISH("text.map_around", what="stands")
    assert kind_at(map_, 4.0, 9.0) == "stands"
    assert set(part(figures["analytic (own)"], "cells")["kind"]) == {"stands", "overturns"}
    key = map_["layer"][0]["encoding"]["fill"]["scale"]["domain"]
    assert set(key) == set(part(map_, "cells")["kind"]), "the key names what the map shows"


def test_one_picture_holds_the_boundary_of_every_model(figures: dict[str, dict[str, Any]]) -> None:
    picture = figures[ENGLISH("chart.boundaries")]
    for name, least in (("analytic (own)", 8.5), ("pybullet (own)", 9.5)):
        line = part(picture, "borders", name)
        assert line["y"] == line["y2"] == [least] * SIZE


def contrast(one: str, other: str) -> float:
    """How many times as bright the one colour is as the other (WCAG 2)."""

    def light(colour: str) -> float:
        parts = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
        linear = [part / 12.92 if part <= 0.03928 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
        return 0.05 + 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    low, high = sorted((light(one), light(other)))
    return high / low


def test_a_level_met_at_one_frequency_alone_is_drawn() -> None:
    (found, *_) = trust().maps
    drawn = trust_map(replace(found, contours={"horizon": [None, 0.2], "peak_half": [0.1, None]}))
    ((lines,),) = [[each for each in drawn["layer"] if each.get("data") == {"name": "contours"}]]
    assert lines["mark"]["point"], "a line of one point shows nothing"
    assert [part["y"] for part in drawn["datasets"]["contours"]] == [[0.1, None], [None, 0.2]], "nor is a gap bridged"


def test_the_lines_of_a_trust_map_stand_out_from_every_class_on_either_screen() -> None:
    assert not set(SURFACES) & set(DARK), "on a dark screen a class would take the colour of a line"
    for name, drawn in LINES.items():
        dark, least = DARK[drawn.colour.lower()], LEAST_OF_LINES["horizon" if name == "horizon" else "line"]
        assert min(contrast(drawn.colour, surface) for surface in SURFACES) >= least, name
        assert min(contrast(dark, surface) for surface in SURFACES.values()) >= LEAST_OF_LINES["line"], name
