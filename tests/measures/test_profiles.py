"""The analytic model beside a contact engine on bases of more than two vertices (docs/model.md, section 8)."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from analytic import ZeroExcitation
from harness import RunOptions, engines
from harness.comparison.scores import errors
from tests.budgets_engines import PROFILE_FINE_RAD, PROFILE_RAD, REST_ANGLE_RAD, ROUNDING_RAD
from tests.measures import profiles as bench

PAGE = Path(__file__).resolve().parents[2] / "docs" / "measured" / "profiles.md"
NAMES = ("bulging", "worn", "uneven", "keeled")


@pytest.mark.parametrize("base", bench.BASES)
def test_a_contact_engine_converges_to_the_model_on_the_same_polygon(base: str) -> None:
    for row in bench.rows((base,), (1e-3, 1e-4)):
        coarse, fine = row.differences_rad
        assert row.impacts >= 1
        assert row.peak_theta_rad > 0.09
        assert coarse <= PROFILE_RAD, row
        assert fine <= PROFILE_FINE_RAD, row


@pytest.mark.parametrize("base", NAMES)
def test_the_comparison_sees_a_vertex_that_stands_a_centimetre_elsewhere(base: str) -> None:
    points = [*bench.BASES[base]]
    lowest = next(i for i, (_, z) in enumerate(points) if z == 0.0)
    points[lowest] = (points[lowest][0] + 1e-2, 0.0)
    exact, other = (bench.statue(shape) for shape in (bench.BASES[base], points))
    worst = 0.0
    for motion in bench.MOTIONS.values():
        worst = max(worst, errors(bench.model(bench.scene(other, motion)), bench.model(bench.scene(exact, motion)))[0])
    assert worst > 10.0 * PROFILE_FINE_RAD, worst


def test_the_comparison_sees_an_impact_that_keeps_five_percent_more() -> None:
    each = bench.scene(bench.statue(bench.BASES["bulging"]), ZeroExcitation())
    exact = bench.model(each)
    ratio = 1.05 * float(np.mean(exact.validity["impact_ratios"]))
    livelier = bench.model(replace(each, contact=replace(each.contact, restitution=min(ratio, 1.0))))
    assert errors(livelier, exact)[0] > PROFILE_RAD


@pytest.mark.parametrize("side", [1, -1])
def test_both_come_to_rest_on_the_same_inclined_facet(side: int) -> None:
    keel = [(-side * 0.2, 0.03), (0.0, 0.0), (side * 0.2, 0.012)][::side]
    each = bench.scene(bench.statue(keel), ZeroExcitation(), duration_s=8.0)
    each = replace(each, initial=replace(each.initial, theta_rad=-side * bench.TILT_RAD))
    engine = engines.load("pymunk")
    runs = [bench.model(each), engine.simulate(each, engine.settings_for_dt(each, 5e-4), RunOptions())]
    ends = [float(run.history.theta_rad[-1]) for run in runs if run.history is not None]
    assert ends[0] == -side * math.atan2(0.03, 0.2), "the model rests exactly on the facet"
    assert ends[1] == pytest.approx(ends[0], abs=REST_ANGLE_RAD)


def test_a_chip_that_is_never_rolled_over_leaves_a_block_of_two_corners() -> None:
    body = bench.statue(bench.BASES["chipped"])
    motion = bench.MOTIONS["0.5 g, 2 Hz"]
    block = replace(body, corner_right_m=float(body.solid.base_profile_m[1, 0]), solid=None)
    rolled, plain = bench.model(bench.scene(body, motion)), bench.model(bench.scene(block, motion))
    assert rolled.peak_theta_rad > 0.1
    assert errors(rolled, plain)[0] <= 10.0 * ROUNDING_RAD


def test_the_page_shows_what_the_model_computes() -> None:
    """The engine's columns are measured; those of the model stand on the page digit by digit."""
    page = PAGE.read_text(encoding="utf-8")
    for base, impacts, peaks, *_ in bench.lines_of(bench.rows(steps_s=())):
        assert f"| {base} | {impacts} | {peaks} |" in page
