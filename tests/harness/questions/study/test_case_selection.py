"""A map refined where it changes finds the same boundary as the whole map, with fewer runs."""

import itertools

import pytest

from harness.questions.study import cases as selection
from harness.questions.study.cases import Place, PlaceAnswer, StudyFile

SIZE = 41


def places() -> list[Place]:
    return [(i, j, 0) for i, j in itertools.product(range(SIZE), repeat=2)]


def truth(place: Place) -> str:
    # A boundary that bends, as overturning maps have: fell above a parabola.
    return "fell" if place[1] > 5 + (place[0] - 12) ** 2 / 30 else "stands"


def explore() -> dict[Place, str]:
    known: dict[Place, str] = {}
    while True:
        asked = selection.refined(places(), known, (0, 1))
        new = [place for place in asked if place not in known]
        if not new:
            return known
        known |= {place: truth(place) for place in new}


def test_the_refined_map_equals_the_whole_map() -> None:
    filled = selection.filled(places(), explore(), (0, 1))
    wrong = [place for place in places() if filled[place] != truth(place)]
    # A place that was not computed takes its nearest neighbour's outcome: cells that were not cut are uniform.
    assert wrong == []


def test_the_refined_map_computes_a_fraction_of_the_places() -> None:
    assert len(explore()) < 0.4 * SIZE**2


def test_a_uniform_map_stays_coarse() -> None:
    asked = selection.refined(places(), {}, (0, 1))
    known = dict.fromkeys(asked, "stands")
    assert selection.refined(places(), known, (0, 1)).keys() == known.keys()
    assert len(known) == 36


def test_maps_of_other_axes_are_refined_apart() -> None:
    both = [(i, j, k) for i, j, k in itertools.product(range(17), range(17), range(2))]
    known: dict[Place, str] = {}
    for _ in range(5):
        asked = selection.refined(both, known, (0, 1))
        known |= {p: "fell" if p[2] and p[0] > 3 else "stands" for p in asked if p not in known}
    counts = [sum(place[2] == k for place in known) for k in (0, 1)]
    assert counts[0] == 9
    assert counts[1] > counts[0]


def test_the_boundary_takes_changes_margins_and_a_random_audit() -> None:
    known = {(i, 0): PlaceAnswer("fell" if i >= 5 else "stands", 2.0 if i >= 5 else 0.1) for i in range(10)}
    known[(1, 0)] = PlaceAnswer("stands", 0.9)
    found = selection.near_boundary(known, margin=0.25, share=0.0, seed=1)
    assert found == {(1, 0): selection.MARGIN, (4, 0): selection.NEAR, (5, 0): selection.NEAR}
    everything = selection.near_boundary(known, margin=0.25, share=1.0, seed=1)
    assert set(everything) == set(known)
    assert everything[(8, 0)] == selection.RECHECK


def test_the_audit_is_the_same_every_time() -> None:
    assert selection.rechecked(places(), 0.1, seed=3) == selection.rechecked(reversed(places()), 0.1, seed=3)
    share = len(selection.rechecked(places(), 0.1, seed=3)) / SIZE**2
    assert share == pytest.approx(0.1, abs=0.03)  # 4 standard deviations of a binomial share of 1681 places


def test_an_adaptive_map_wants_two_grids() -> None:
    content = {
        "title": "t",
        "scene": "s.toml",
        "variant": [{"name": "v", "engines": ["analytic"]}],
        "vary": [{"key": "a", "start": 0.0, "stop": 1.0, "count": 3}],
        "ask": {"cases": "adaptive"},
    }
    with pytest.raises(ValueError, match="two grids"):
        StudyFile.model_validate(content)
