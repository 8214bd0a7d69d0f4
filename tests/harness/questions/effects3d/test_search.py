"""The amplitude that overturns: windows found, bracketed and followed, from where nothing lifts."""

import math
from dataclasses import replace

import numpy as np
import pytest

import harness
from harness import Outcome, Scene
from harness.questions import effects3d
from harness.questions.effects3d import (
    Search,
    SpaceOutcomes,
    amplified,
    changed_scene,
    find,
    first_crossing,
    nearest_crossing,
    peak_g,
    start_factor,
)
from harness.records.effects3d import BASELINE

SEARCH = Search(most_g=1.0, resolution=0.02)


class FallsIn:
    """A statue that overturns at the factors inside these windows only; `asked` are those that were asked."""

    def __init__(self, *windows: tuple[float, float]) -> None:
        self._windows = windows
        self.asked: set[float] = set()

    def __call__(self, factor: float) -> Outcome | None:
        self.asked.add(factor)
        inside = any(low <= factor <= high for low, high in self._windows)
        return Outcome.OVERTURNED_RIGHT if inside else None


def test_the_first_window_is_found_and_bracketed() -> None:
    windows = FallsIn((0.7, 0.8), (1.5, 9.0))
    above, below = first_crossing(windows, np.geomspace(0.2, 4.0, 63).tolist(), 1e-3)
    assert above == pytest.approx(0.7, rel=1e-3)
    assert below < 0.7 <= above <= below * 1.001
    assert len(windows.asked) < 50
    coarse, _ = first_crossing(windows, np.geomspace(0.2, 4.0, 9).tolist(), 1e-3)
    assert coarse > 0.8, "a grid coarser than the window steps over it"


def test_no_window_is_said() -> None:
    assert first_crossing(FallsIn(), np.geomspace(0.2, 4.0, 18).tolist(), 1e-3) == (None, 4.0)
    assert first_crossing(FallsIn((0.0, 9.0)), [0.2, 4.0], 1e-3) == (0.2, 0.0), "nothing stands below it"


@pytest.mark.parametrize("near", [0.5, 0.69, 0.7, 0.75, 1.4])
def test_the_crossing_is_followed_from_nearby(near: float) -> None:
    window = FallsIn((0.7, 9.0))
    above, below = nearest_crossing(window, near, 0.2, 4.0, 1e-3)
    assert above == pytest.approx(0.7, rel=1e-3)
    assert below < 0.7 <= above <= below * 1.001
    assert len(window.asked) <= 20
    assert nearest_crossing(FallsIn(), near, 0.2, 4.0, 1e-3) == (None, 4.0)
    assert nearest_crossing(FallsIn((0.0, 9.0)), near, 0.2, 4.0, 1e-3) == (0.2, 0.0)


def test_the_amplitude_found_overturns_and_the_one_below_stands(block: Scene) -> None:
    row = find(block, BASELINE, 0.0, "analytic", SEARCH)
    assert row.stands_at_g < row.peak_g <= row.stands_at_g * (1.0 + SEARCH.resolution) * 1.0001
    base = changed_scene(block, BASELINE, 0.0)
    for peak, outcome in ((row.peak_g, row.outcome), (row.stands_at_g, "stands")):
        assert harness.simulate(amplified(base, peak / peak_g(base)), "analytic").outcome.value == outcome
    back = find(block, BASELINE, 180.0, "analytic", SEARCH)
    assert back.peak_g == pytest.approx(row.peak_g, rel=1e-12)
    assert back.outcome == row.outcome, "half a turn takes a block into itself"


def test_a_fall_before_a_flat_base_would_lift_is_bracketed_from_where_it_stands(
    block: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An uneven base rocks at less: the amplitude was that from which the search began, and stood at 0 g."""
    known = find(block, BASELINE, 0.0, "analytic", SEARCH)
    above = 1.3 * (known.peak_g or math.nan)
    monkeypatch.setattr(effects3d, "start_factor", lambda scene: above / peak_g(scene))
    found = find(block, BASELINE, 0.0, "analytic", SEARCH, 1.2 * above)
    assert found.peak_g == pytest.approx(known.peak_g, rel=2 * SEARCH.resolution)
    assert 0.0 < found.stands_at_g < known.peak_g


def test_the_exact_model_asked_in_the_plane_is_the_planar_model(block: Scene) -> None:
    exact, planar = (find(block, BASELINE, 90.0, name, SEARCH) for name in ("spatial", "analytic"))
    assert exact.peak_g == pytest.approx(planar.peak_g, rel=1e-12)
    assert exact.outcome == planar.outcome
    assert not exact.doubt


def test_a_statue_that_still_falls_at_the_end_of_its_run_falls(block: Scene) -> None:
    """As a single run says. It was taken for one that stands, and the least that falls in time for the least that falls."""
    short = replace(block, duration_s=1.0)
    exact, planar = (find(short, BASELINE, 90.0, name, SEARCH) for name in ("spatial", "analytic"))
    assert (exact.peak_g, exact.outcome, exact.doubt) == (pytest.approx(planar.peak_g, rel=1e-12), planar.outcome, "")


def test_a_run_without_an_outcome_or_one_that_changes_is_told(block: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    space = SpaceOutcomes(block)
    assert space.doubt(1e-3, 1e-4) == "change", "neither overturns: the one above was said to"
    monkeypatch.setattr(space, "unanswered", [0.7])
    assert space.doubt(None, 1e-4) == "undecided"


def test_below_the_start_nothing_lifts(scene: Scene) -> None:
    """Shaken obliquely the body lifts where the push leaves the footprint, before the planar limit of that direction."""
    oblique = changed_scene(scene, BASELINE, 45.0)
    solid = oblique.statue.solid
    assert solid is not None
    along = 0.0682 * math.sqrt(2.0) / 0.774
    assert start_factor(oblique) * peak_g(oblique) == pytest.approx(0.95 * along, rel=1e-3)
    assert along < oblique.statue.corner_right_m / oblique.statue.centroid_height_m
