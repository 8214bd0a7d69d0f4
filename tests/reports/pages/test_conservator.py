"""The conservator's page follows from the scene, the histories and the rows, and says it without jargon."""

import math
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analytic import Harmonic
from harness import Outcome, Verdict
from harness.model import BaseExcitation, Initial, Pedestal, caution, changes_answer
from harness.questions.scene.scene_run import run_scene, write_result
from harness.records.assess import Assessment
from harness.records.run import HorizonRecord, balance_share, has_answer
from harness.records.study import SupportRecord
from reports import source as reading
from reports.drawing.kinematics import body_m, posed_m, poses, sampled, silhouette_m
from reports.drawing.pictures import (
    bearing,
    compass,
    floor_plan,
    levels,
    order_words,
    slips,
    support_of,
    weakest_pushes,
    weakest_words,
)
from reports.messages import ENGLISH, language
from reports.pages import conservator
from reports.pages.conservator import of_run, of_study
from reports.pages.study_page import pedestal_effect
from reports.source import Answers, RunSource, run_source
from tests.budgets_reports import PUSH, SAMPLED_M, SHADOW_SHARE
from tests.reports.page_parts import answer, form, lines, pictures, spoken
from tests.scenes_for_tests import GRAVITY_M_S2, rectangle, scene

JARGON = ("rad", "kHz", "μ", "horizon", "integrat", "slenderness", "restitution", "theta", "θ")


def test_what_gives_way_first_is_ordered(source: RunSource, record_of: Callable[[str], Any]) -> None:
    scene = source.scene
    found = levels(scene, support_of(scene))
    # Both as one body about the pedestal's right edge, 0.3 m from its own centroid and 0.1548 m from the statue's.
    together = (250.0 * 0.3 + 707.0 * (0.3 - 0.14515)) / (250.0 * 0.1 + 707.0 * 0.974)
    assert [level.push for level in found] == pytest.approx([0.0682 / 0.774, 0.2, together, 0.3585 / 0.774])
    assert [level.cause for level in found] == ["statue_tips", "pedestal_slides", "pedestal_tips", "statue_tips"]
    bare = record_of("bare").scene
    assert {level.cause for level in levels(bare, support_of(bare))} == {"statue_tips"}
    # Shaken across too it may tip to the front or back: half its depth over the centroid's height.
    every = {level.words.rsplit(" ", 1)[-1]: level.push for level in levels(bare, support_of(bare), across=True)}
    assert every == pytest.approx(
        {"right": 0.0682 / 0.774, "left": 0.3585 / 0.774, "back": 0.36 / 0.774, "front": 0.36 / 0.774}
    )
    assert ENGLISH("order.nothing_slides") in " ".join(order_words(bare, support_of(bare), None))


@pytest.mark.parametrize(
    ("floor", "statue", "key"),
    [(0.05, 1.0, "fuse"), (0.2, 1.0, "part"), (0.6, 1.0, "no_protection"), (0.2, 0.06, "slides_stone")],
)
def test_the_pedestal_is_a_fuse_only_where_it_slides_first(
    source: RunSource, floor: float, statue: float, key: str
) -> None:
    scene = source.scene
    support = SupportRecord([True], (floor, floor), (statue, statue), [])
    assert ENGLISH(f"order.{key}") in order_words(scene, support, None)


def test_a_statue_on_the_floor_may_slide_before_it_tips(record_of: Callable[[str], Any]) -> None:
    scene = record_of("bare").scene
    for friction, key in ((0.05, "slides_floor"), (0.2, "weak_floor"), (0.6, "nothing_slides")):
        support = SupportRecord([False], None, (friction, friction), [])
        assert ENGLISH(f"order.{key}") in order_words(scene, support, None)


def test_a_slender_pedestal_tips_first(source: RunSource) -> None:
    own = source.scene
    assert own.pedestal is not None
    scene = replace(own, pedestal=replace(own.pedestal, height_m=3.0))
    support = support_of(scene)
    assert levels(scene, support)[0].words == ENGLISH("order.pedestal_tips", side="right")
    assert ENGLISH("order.stone_first") in " ".join(order_words(scene, support, None))


def test_frictions_that_differ_between_situations_are_told_one_by_one(source: RunSource) -> None:
    scene = source.scene
    support = SupportRecord([True], (0.05, 0.6), (1.0, 1.0), [])
    text = " ".join(order_words(scene, support, None)).lower()
    for push, key in (("5", "fuse"), ("60", "no_protection")):
        where = ENGLISH("order.floor_friction", push=f"{push} %")
        assert ENGLISH("order.case", where=where, meaning=ENGLISH(f"order.{key}")).lower() in text
    assert slips(support) == [(0.05, "pedestal"), (0.6, "pedestal")]


def test_the_push_borne_holds_the_centroid_over_the_base(source: RunSource) -> None:
    """In every direction, a push short of the area's edge keeps the force within the base, one beyond does not."""
    scene = source.scene
    safe = bearing(scene)
    h, foot = 0.774, np.asarray(scene.statue.footprint_m)[:, :2]
    low, high = foot.min(axis=0), foot.max(axis=0)
    for angle in np.linspace(0.0, 2.0 * np.pi, 17):
        towards = np.array([np.cos(angle), np.sin(angle)])
        edges = np.roll(safe, -1, axis=0) - safe
        normals = np.column_stack([edges[:, 1], -edges[:, 0]])
        gains = normals @ towards
        limit = min(np.einsum("ij,ij->i", normals, safe)[gains > 1e-12] / gains[gains > 1e-12])
        for factor, inside in ((0.999, True), (1.001, False)):
            foot_point = factor * limit * towards * h
            assert bool(np.all(foot_point >= low) and np.all(foot_point <= high)) is inside
    least, azimuths = weakest_pushes(safe)
    assert least == pytest.approx(0.0682 / h, abs=PUSH)
    assert azimuths == pytest.approx([0.0])
    # A record may be of a base that the centroid stands beside.
    assert weakest_pushes(safe + np.array([[0.0, 1.0]]))[1] == pytest.approx([-90.0])


def test_directions_are_named_counter_clockwise_from_the_right() -> None:
    assert [compass(angle) for angle in (0.0, 44.0, 90.0, 180.0, -90.0, 359.0)] == [
        "right", "back right", "back", "left", "front", "right",
    ]  # fmt: skip


def test_the_weakest_side_is_told_in_the_scans_own_axes_where_the_scene_turned_it(source: RunSource) -> None:
    scene = source.scene
    assert form("push.weakest").search(weakest_words(scene))["sides"] == "right"
    assert not form("push.turned").search(weakest_words(scene))
    # Turned by 90 degrees counter-clockwise, the scan's own direction of -90 degrees came to lie to the right.
    turned = replace(scene, toml={"statue": {"mesh": {"file": "a.ply", "azimuth_deg": 90.0}}})
    text = weakest_words(turned)
    assert ENGLISH("push.turned", turn="90") in text
    assert ENGLISH("push.own", angles="270°") in text


def test_two_edges_towards_one_side_are_one_direction_of_the_scan(source: RunSource) -> None:
    scene = replace(source.scene, toml={"statue": {"mesh": {"file": "a.ply", "azimuth_deg": 90.0}}})
    bulged = [[-0.3, -0.3, 0.0], [0.1, -0.3, 0.0], [0.103, 0.0, 0.0], [0.1, 0.3, 0.0], [-0.3, 0.3, 0.0]]
    text = weakest_words(replace(scene, statue=replace(scene.statue, footprint_m=bulged)))
    assert form("push.own").search(text)["angles"] in ("269°", "271°")


def test_sides_that_are_equally_weak_are_all_named(source: RunSource) -> None:
    scene = source.scene
    half = 0.1
    square = [[-half, -half, 0.0], [half, -half, 0.0], [half, half, 0.0], [-half, half, 0.0]]
    angles = np.radians(np.arange(0.0, 360.0, 15.0))
    circle = (half * np.column_stack([np.cos(angles), np.sin(angles), 0.0 * angles])).tolist()
    told = (weakest_words(replace(scene, statue=replace(scene.statue, footprint_m=feet))) for feet in (square, circle))
    assert form("push.weakest").search(next(told))["sides"] == "front, right, back and left"
    assert form("push.round").search(next(told))


def test_the_free_space_is_that_of_standing_runs_and_falls_are_said(written: Callable[[str], Path]) -> None:
    source = run_source(written("apart"))
    scene, text = source.scene, spoken(of_run(source))
    body = body_m(scene)
    farthest = [
        float(posed_m(scene, body, poses(scene, sampled(item)))[:, :, 0].max() - body[:, 0].max())
        for name, item in source.histories.items()
        if name != "pybullet"
    ]
    assert ENGLISH("plan.right", length=f"{100 * max(farthest):.3g}\u00a0cm") in text
    assert ENGLISH("reach.fell_one", total="three") in text
    assert form("run.may_fall").search(text)
    assert ENGLISH("run.some", end=ENGLISH("end.stands"), count="two", total="three") in text
    assert not re.search("analytic|pymunk|pybullet", text), "which model says it stands in the engineer's report"


def test_a_model_in_which_nothing_moves_is_no_stillness_beside_a_fall(written: Callable[[str], Path]) -> None:
    """Two of three models stand still, one overturns: "it does not move visibly, leans 0°" stood beside 99 of 100."""
    source = run_source(written("apart"))
    still = {
        name: replace(each, theta_rad=0.0 * each.theta_rad, slip_m=0.0 * each.slip_m)
        for name, each in source.histories.items()
    }
    runs = {name: replace(run, peak_theta_rad=0.0, peak_slip_m=0.0) for name, run in source.runs.items()}
    stands = {name: replace(run, outcome=Outcome.STANDS) for name, run in runs.items()}
    for each, falls in ((runs, True), (stands, False)):
        shown = replace(source, record=replace(source.record, runs=each, assessment=None), histories=still)
        drawn = conservator.reach_picture(shown, ENGLISH)
        moves = drawn.caption.index(ENGLISH("reach.still"))
        assert (ENGLISH("run.of_standing") in drawn.caption[:moves]) is falls
        assert (ENGLISH("reach.lean", degrees="0°") in drawn.svg) is not falls
        plan = conservator.plan_picture(shown, floor_plan(shown, shown.standing), [], ENGLISH)
        assert (plan.caption[0] == ENGLISH("run.of_standing")) is falls


def test_no_line_crosses_the_words_of_what_gives_way(source: RunSource) -> None:
    drawn = str(conservator.order_picture(source.scene, support_of(source.scene), ENGLISH, source.record.motion).svg)
    assert drawn.rindex("stroke-dasharray") < drawn.index("<text")


def test_a_shaking_is_told_by_direction(source: RunSource) -> None:
    """The floor's rise and fall is no part of its level push, and may be the stronger."""
    motion, g_m_s2 = source.record.motion, source.scene.gravity_m_s2
    up = replace(motion, z_m_s2=[2.0 * each for each in motion.x_m_s2], z_peak_m_s2=1.83 * g_m_s2)
    text = spoken(of_run(replace(source, record=replace(source.record, motion=up))))
    level = ENGLISH("shaking.x", push=ENGLISH.percent(motion.peak_m_s2("x") / g_m_s2))
    assert f"{level} {ENGLISH.strings['and']} {ENGLISH('shaking.z', push='183 %')}" in text
    alone = replace(up, x_m_s2=None, x_peak_m_s2=None, push=None)
    assert ENGLISH("shaking.z", push="183 %") in spoken(
        of_run(replace(source, record=replace(source.record, motion=alone)))
    )


@pytest.mark.parametrize(
    ("more", "x", "told"),
    [
        ({}, {}, "record"),
        ({"scale": 1.0}, {"scale": -1.0}, "record"),
        ({"scale": 1.75}, {}, "altered"),
        ({}, {"scale": 2.0}, "altered"),
        ({}, {"pga_g": 1.0}, "altered"),
        ({}, {"floor": [{"period_s": 0.5}]}, "altered"),
    ],
)
def test_a_record_is_told_as_recorded_only_where_nothing_alters_it(
    source: RunSource, more: dict[str, Any], x: dict[str, Any], told: str
) -> None:
    toml = source.scene.toml | {"motion": more | {"x": {"kind": "record", "file": "a.csv"} | x}}
    scene = replace(source.record.scene, toml=toml)
    said = spoken(of_run(replace(source, record=replace(source.record, scene=scene))))
    assert f"{ENGLISH(f'shaking.{told}')}, for" in said


def test_a_model_of_space_tells_the_room_all_round(source: RunSource) -> None:
    """A body that is carried 3 cm to the back and turned by nothing needs just that, and nothing at the front."""
    (name, own), *_ = source.histories.items()
    zero = np.zeros_like(own.theta_rad)
    ends = np.linspace(0.0, 0.03, len(zero))
    corner = {
        "corner_right_x_m": zero + source.scene.statue.corner_right_m,
        "corner_right_y_m": ends,
        "corner_right_z_m": zero,
    }
    moved = replace(own, extra={"pitch_rad": zero, "roll_rad": zero, "yaw_rad": zero, **corner})
    plan = floor_plan(replace(source, histories={name: moved}), [name])
    assert plan.room_m == pytest.approx({"left": 0.0, "right": 0.0, "front": 0.0, "back": 0.03}, abs=PUSH)
    assert set(floor_plan(source, [name]).room_m) == {"left", "right"}, "a model of a plane knows nothing of the others"
    assert ENGLISH("plan.planar") in spoken(of_run(source))


def test_the_room_holds_every_position_of_a_long_history(source: RunSource) -> None:
    """Lean and slip come together somewhere between the largest of each; 240 poses of each told of a hundredth less."""
    name, t_s = next(iter(source.histories)), np.arange(20_001) * 1e-3
    theta, slip = 0.02 * np.sin(19.0 * t_s) * np.sin(0.3 * t_s), 0.05 * np.sin(14.5 * t_s + 1.0)
    long = replace(
        source.histories[name], t_s=t_s, theta_rad=theta, theta_rate_rad_s=0 * t_s, slip_m=slip, slip_rate_m_s=0 * t_s, extra={}
    )  # fmt: skip
    room_m, scene = floor_plan(replace(source, histories={name: long}), [name]).room_m, source.scene
    x, rest = posed_m(scene, body_m(scene), poses(scene, sampled(long)))[:, :, 0], body_m(scene)[:, 0]
    assert room_m == pytest.approx({"left": rest.min() - x.min(), "right": x.max() - rest.max()}, abs=PUSH)


def test_what_remains_before_the_wall_is_said(source: RunSource) -> None:
    """The same on both pages: of the outline that the models move, not of the mesh that is drawn."""
    text, wall = spoken(of_run(source)), source.scene.wall
    (engineers,) = [each.values["left_m"] for each in reading._reach(source) if each.code == "room_to_wall"]
    assert ENGLISH("reach.remain", left=ENGLISH.length(engineers)) in text
    assert engineers < 0.99 * wall.distance_m
    (found,) = [each for each in reading._reach(source) if each.code == "room_to_wall"]
    assert "a sinistra: " in language("it").say(found), "the side stood in English"
    assert ENGLISH("reach.free", gap="70\u00a0cm") in text


def test_the_room_towards_a_wall_that_is_struck_is_more_than_there_is(source: RunSource) -> None:
    """By models in which it stands 4 cm were to be kept free towards a wall at 6 cm that it strikes by others."""
    one, *_ = source.standing
    struck = {**source.runs, one: replace(source.runs[one], outcome=Outcome.TOUCHES_WALL)}
    page = of_run(replace(source, record=replace(source.record, runs=struck)))
    more = ENGLISH("plan.left", length=ENGLISH("plan.more", length=ENGLISH.length(0.7)))
    assert more in " ".join(answer(page).todo)
    assert any(f">&gt;\u00a0{ENGLISH.length(0.7)}<" in each.svg for each in pictures(page))
    assert more not in spoken(of_run(source))


@pytest.mark.parametrize("kind", ["agreed", "table", "map"])
def test_four_pictures_at_most_no_jargon_and_both_pages_know_each_other(
    page_of: Callable[[str], Path], record_of: Callable[[str], Any], kind: str
) -> None:
    page, plain = page_of(kind), page_of(f"plain {kind}").read_text()
    told = conservator.blocks(page.parent, record_of(kind))
    assert 2 <= len(pictures(told)) <= 4
    text = spoken(told)
    assert [word for word in JARGON if re.search(rf"(?<![a-z]){word}", text)] == []
    assert 'href="conservator.html"' in page.read_text()
    assert 'href="report.html"' in plain
    assert "<script" not in plain, "it needs no scripts"
    assert plain.count('<svg class="plain"') + plain.count('<svg class="still"') == len(pictures(told))


@pytest.mark.parametrize(
    ("x", "key", "told"),
    [
        ({"kind": "harmonic", "amplitude_g": 0.1}, "motion.x.amplitude_g", ("weight", 2.0)),
        ({"kind": "harmonic", "amplitude_g": -0.1}, "motion.scale", ("weight", 0.1)),
        ({"kind": "record", "scale": 3.0}, "motion.x.scale", ("record", 2.0)),
        ({"kind": "record", "scale": 3.0}, "motion.scale", ("record", 3.0)),
        ({"kind": "record", "pga_g": 0.3}, "motion.scale", ("weight", 0.3)),
        ({"kind": "spectrum"}, "motion.scale", ("other", 1.0)),
    ],
)
def test_a_strength_holds_all_that_the_scene_multiplies_the_shaking_by(
    record_of: Callable[[str], Any], x: dict[str, Any], key: str, told: tuple[str, float]
) -> None:
    record = record_of("table")
    loud = replace(record, scene=replace(record.scene, toml={"motion": {"scale": 2.0, "x": x}}))
    assert conservator._strength_unit(loud, key) == told


def test_what_the_pedestal_prevents_is_counted_by_condition(record_of: Callable[[str], Any]) -> None:
    record = record_of("table")
    found = pedestal_effect(record, Answers.of(record.rows))
    told = found[0].values
    assert (told["total"], told["bare"], told["prevented"], told["caused"]) == (30, 12, 6, 0)
    figures = {each.name: each.figure for each in found[1]}
    assert figures["saved"]["datasets"]["falls"][0]["count"] == ["6/6", "6/6", "0/6", "0/6", "0/6"]


def test_a_run_without_an_end_is_neither_prevented_nor_a_stand(record_of: Callable[[str], Any]) -> None:
    """Its statue still leans as it ends."""
    record = record_of("table")
    rows = [
        replace(row, run=replace(row.run, outcome=Outcome.UNDECIDED))
        if row.run and row.varied["pedestal"] == "keep"
        else row
        for row in record.rows
    ]
    found = pedestal_effect(record, Answers.of(rows))
    assert found is not None
    told, charts = found
    assert (told.values["total"], told.values["prevented"]) == (0, 0)
    figures = {each.name: each.figure for each in charts}
    assert figures["saved"]["datasets"]["falls"][1]["count"] == []


def test_a_pedestal_that_tips_is_no_stand_of_a_model_that_holds_it_upright(record_of: Callable[[str], Any]) -> None:
    record, tips = record_of("table"), {"left_domain_s": 0.1, "left_domain_by": "pedestal_tips"}
    rows = [
        replace(row, run=replace(row.run, validity=tips))
        if row.engine == "analytic" and row.varied["pedestal"] == "keep"
        else row
        for row in record.rows
    ]
    found = pedestal_effect(record, Answers.of(rows))
    assert found is not None
    assert found[0].values["model"].startswith("pymunk"), "which knows what becomes of it"
    assert found[0].values["total"] == 30
    alone = [row for row in rows if row.model == "analytic (own impact)"]
    told = pedestal_effect(record, Answers.of(alone))
    assert told is not None
    assert (told[0].values["total"], told[0].values["prevented"]) == (0, 0)
    borne = answer(conservator.of_study(replace(record, rows=alone))).points
    assert not [each for each in borne if each.startswith(ENGLISH("study.borne", level="")[:10])]


def test_answers_outside_a_model_s_domain_are_told_of_a_study(record_of: Callable[[str], Any]) -> None:
    record = record_of("table")
    left = [
        caution("left_domain_in_runs", left=n, cases=6, causes={"pedestal_tips": n}).of(f"model {n}") for n in (1, 2)
    ]
    text = spoken(of_study(replace(record, findings=left)))
    assert ENGLISH("study.outside", left=3, cases=12) in text
    assert not form("study.outside").search(spoken(of_study(replace(record, findings=[]))))
    # They are counted in no headline, as on the engineer's page: 0 to 8 of 16 was told beside 0.
    outside = {"left_domain_s": 0.0, "left_domain_by": "statue_slides"}
    own = [row for row in record.rows if row.varied["variant"] == "own impact"]
    fell = [replace(row, run=replace(row.run, outcome=Outcome.OVERTURNED_LEFT, validity=outside)) for row in own]
    rows = [left if row.engine == "analytic" else row for row, left in zip(own, fell, strict=True)]
    told, without = (
        answer(of_study(replace(record, rows=each)))
        for each in (rows, [row for row in own if row.engine != "analytic"])
    )
    assert told.headline == without.headline
    # A model that failed knows no more than one outside its domain.
    failed = [replace(row, run=replace(row.run, outcome=Outcome.CRASHED)) for row in own]
    rows = [lost if row.engine == "analytic" else row for row, lost in zip(own, failed, strict=True)]
    assert answer(of_study(replace(record, rows=rows))).headline == without.headline
    headline = answer(of_study(replace(record, rows=fell))).headline
    assert form("study.falls").match(headline)["falls"] == "0"
    assert headline.endswith(ENGLISH("study.more_outside", count=60))


def test_what_a_headline_says_of_one_variant_is_not_said_again(record_of: Callable[[str], Any]) -> None:
    record = record_of("map")
    rows = [row for row in record.rows if row.run is not None and row.engine == "analytic"]
    again = ENGLISH("study.by_one", falls="·", total=len(rows), more="").split("·")[0]
    points = answer(of_study(replace(record, rows=rows))).points
    assert not any(each.startswith(again) for each in points)
    ended = replace(rows[0], run=replace(rows[0].run, outcome=Outcome.LEFT_PEDESTAL))
    assert any(each.startswith(again) for each in answer(of_study(replace(record, rows=[ended, *rows[1:]]))).points)


def test_the_axes_of_a_map_have_units(record_of: Callable[[str], Any]) -> None:
    """A distance of 0.16 stood on an axis without a unit."""
    of_map = record_of("map")
    for key, words in (
        ("motion.x.amplitude_g", ENGLISH("plain.strength")),
        ("wall.distance_m", f"{ENGLISH('key.distance_m')} (m)"),
    ):

        def named(varied: Any, key: str = key) -> dict[str, Any]:
            return {key if name == "motion.x.amplitude_g" else name: value for name, value in varied.items()}

        rows = [replace(row, varied=named(row.varied)) for row in of_map.rows]
        page = of_study(replace(of_map, rows=rows, vary=named(of_map.vary)))
        assert any(f">{words}<" in each.svg for each in pictures(page))


def test_a_frequency_that_is_kept_is_no_number(record_of: Callable[[str], Any]) -> None:
    record = record_of("table")
    rows = [replace(row, varied={**row.varied, "motion.x.frequency_hz": "keep"}) for row in record.rows]
    found = pedestal_effect(record, Answers.of(rows))
    assert not found[1]


def test_a_study_without_pedestals_has_no_such_effect(record_of: Callable[[str], Any]) -> None:
    record = record_of("map")
    assert pedestal_effect(record, Answers.of(record.rows)) is None


def test_the_silhouette_is_the_meshs_shadow(written: Callable[[str], Path]) -> None:
    source = run_source(written("meshed"))
    assert source.mesh is not None
    outline, hull = silhouette_m(source.scene, source.mesh), np.asarray(source.scene.statue.section_m)

    def area(points: np.ndarray[Any, Any]) -> float:
        x, y = points.T
        return abs(0.5 * float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))))

    assert area(outline) < 0.97 * area(hull), "a figure is not convex"
    assert np.ptp(outline, axis=0) == pytest.approx(np.ptp(hull, axis=0), rel=SHADOW_SHARE)
    assert silhouette_m(source.scene, None) == pytest.approx(hull)


def test_the_page_is_green_exactly_where_a_fall_is_improbable(source: RunSource) -> None:
    """Over probabilities, intervals and draws without an end on both sides of 5 and 10 %; all runs shown stand."""
    seen = set()
    for p in (0.0, 0.01, 0.0499, 0.05, math.nextafter(0.05, 1.0), 0.06, 0.2, 0.5, 1.0):
        for wide in (0.0, 0.0499, 0.05, 0.051):
            for undecided in (0.0, 0.03, 0.1):
                item = Assessment(p, max(p - wide, 0.0), min(p + wide + undecided, 1.0), 0.9, 1000, 1000, undecided)
                record = replace(source.record, assessment={"analytic": item})
                green = answer(of_run(replace(source, record=record))).tone == "agree"
                assert green == (p <= 0.05 and min(p + wide + undecided, 1.0) < 0.10), item
                seen.add(green)
    assert seen == {True, False}


def test_one_model_that_doubts_takes_the_green_away(source: RunSource) -> None:
    # The doubt of one may be a probability above 5 % while the other has the wider interval, below 10 %.
    safe, unsafe = Assessment(0.03, 0.0, 0.09, 0.9, 1000, 1000), Assessment(0.051, 0.045, 0.06, 0.9, 1000, 1000)
    for answers in ({"analytic": safe, "pymunk": unsafe}, {"analytic": unsafe, "pymunk": safe}):
        record = replace(source.record, assessment=answers)
        assert answer(of_run(replace(source, record=record))).tone != "agree"


def test_models_that_differ_take_the_green_away(source: RunSource) -> None:
    """Of runs that all stand, and a fall that is improbable."""
    record = replace(source.record, assessment={"analytic": Assessment(0.01, 0.0, 0.02, 0.9, 1000, 1000)})
    for code, tone in (("agree_until", "agree"), ("differ_by_model", "differ"), ("plane_left_out", "differ")):
        said = replace(record, answer=replace(record.answer, code=code))
        assert answer(of_run(replace(source, record=said))).tone == tone


def test_a_shaking_whose_danger_was_not_computed_is_not_green(source: RunSource) -> None:
    """`--no-assess`: that every run stands says nothing of how probable a fall is."""
    page = of_run(replace(source, record=replace(source.record, assessment=None)))
    assert answer(page).tone == "differ"
    assert ENGLISH("chance.unknown") in lines(page, "basis")


def test_the_few_draws_that_ended_are_no_headline(source: RunSource) -> None:
    few = Assessment(0.0026, 0.0019, 1.0, 0.9, 1000, 1000, 0.9974, plane_only=True)
    page = of_run(replace(source, record=replace(source.record, assessment={"analytic": few})))
    assert answer(page).headline == ENGLISH("chance.open")
    assert answer(page).tone == "differ"
    assert not re.search("0[.]0026|0[.]26|0[.]19", spoken(page)), "a share of the few draws that ended"
    assert not re.search("analytic|pymunk|pybullet", spoken(page)), "an engine"
    # An end of the values as given is told before that: it is more than no answer.
    off = {name: replace(run, outcome=Outcome.LEFT_PEDESTAL) for name, run in source.runs.items()}
    for undecided in (0.9974, 1.0):
        open_ = {"analytic": replace(few, undecided=undecided)}
        page = of_run(replace(source, record=replace(source.record, assessment=open_, runs=off)))
        assert answer(page).headline.endswith(ENGLISH(f"end.{Outcome.LEFT_PEDESTAL}"))


def test_draws_that_strike_the_wall_are_no_open_answer(source: RunSource) -> None:
    for wall, headline in ((0.9983, ENGLISH("chance.wall_always")), (0.7, ENGLISH("chance.wall_mostly", share="70"))):
        item = Assessment(0.0, 0.0, wall + 0.01, 0.9, 1000, 1000, wall + 0.005, touches_wall=wall)
        page = of_run(replace(source, record=replace(source.record, assessment={"analytic": item})))
        assert answer(page).headline == headline
        assert answer(page).tone == "differ"
        assert ENGLISH("chance.undecided", share="0.5") in spoken(page)
    some = Assessment(0.1, 0.09, 0.32, 0.9, 1000, 1000, 0.2, touches_wall=0.2)
    page = of_run(replace(source, record=replace(source.record, assessment={"analytic": some})))
    assert answer(page).headline == ENGLISH("chance.between", share="10", low="9", high="32")
    assert answer(page).points[0] == ENGLISH("chance.wall", share="20"), "beside a share that does not tell of it"
    assert ENGLISH("todo.wall") in answer(page).todo
    assert ENGLISH("chance.undecided", share="0") not in spoken(page)


def test_next_to_none_and_next_to_all_have_no_digits(source: RunSource) -> None:
    for p, low, high, undecided, key, values in (
        (0.0, 0.0, 0.00027, 0.0, "rarely", ()),
        (0.0, 0.0, 0.02, 0.02, "up_to", (0, 0, 2)),
        (0.9983, 0.9975, 0.9989, 0.0, "mostly", ()),
        (0.434, 0.426, 0.441, 0.0, "falls", (43,)),
        (0.4, 0.3, 0.5, 0.0, "between", (40, 30, 50)),
    ):
        answers = {"analytic": Assessment(p, low, high, 0.9, 10_000, 10_000, undecided)}
        page = of_run(replace(source, record=replace(source.record, assessment=answers)))
        said = dict(zip(("share", "low", "high"), values, strict=False))
        assert answer(page).headline == ENGLISH(f"chance.{key}", **said)


def test_shaking_that_the_plane_leaves_out_is_told_only_of_a_number_without_it(source: RunSource) -> None:
    plane, space = (Assessment(0.0, 0.0, 0.01, 0.9, 10_000, 10_000, plane_only=only) for only in (True, False))
    missing, how = ENGLISH("chance.plane"), ENGLISH("chance.plane_open")
    for answers, said in (
        ({"analytic": plane}, (True, True)),
        ({"analytic": plane, "spatial": space}, (False, False)),
        # That of the model that knows all of the shaking is told where it tells, whatever the other's.
        ({"analytic": replace(plane, probability_overturned=0.005), "spatial": space}, (False, False)),
        ({"analytic": plane, "spatial": replace(space, undecided=0.9, high=0.91)}, (False, False)),
    ):
        text = spoken(of_run(replace(source, record=replace(source.record, assessment=answers))))
        assert (missing in text, how in text) == said
    few = replace(plane, high=0.005)
    for item, key in ((few, "rarely_in_plane"), (replace(few, plane_only=False), "rarely")):
        page = of_run(replace(source, record=replace(source.record, assessment={"analytic": item})))
        assert answer(page).headline == ENGLISH(f"chance.{key}")


def test_a_chance_in_the_plane_is_no_headline_where_a_fall_in_space_contradicts_it(source: RunSource) -> None:
    """It falls as given, over its back: "in up to 3 of 100 possible cases" was the answer."""
    item = Assessment(0.0, 0.0, 0.034, 0.9, 10_000, 10_000, 0.017, plane_only=True)
    for planar in ("in_plane", "contradicted_in_space"):
        finding = caution("probability_between", planar=[planar])
        told = replace(source.record.answer, findings=[finding])
        page = of_run(replace(source, record=replace(source.record, assessment={"analytic": item}, answer=told)))
        chance = ENGLISH("chance.up_to", share="0", low="0", high="3")
        assert (answer(page).headline == chance) is (planar == "in_plane")
        assert chance in spoken(page)
        assert ENGLISH("chance.plane") in spoken(page)


def test_a_fall_is_reckoned_with_by_the_chance_that_the_headline_tells(source: RunSource) -> None:
    """Draws outside the domain widen the interval of a model that leaves a part of the shaking out; another knows all of it."""
    wide = Assessment(0.0, 0.0, 0.026, 0.9, 10_000, 10_000, plane_only=True)
    space = Assessment(0.0, 0.0, 0.0095, 0.9, 281, 281)
    runs = {name: replace(run, outcome=Outcome.STANDS) for name, run in source.runs.items()}
    fall = ENGLISH("todo.fall", height=ENGLISH.length(1.66))
    for answers, reckoned in (({"analytic": wide}, True), ({"analytic": wide, "spatial": space}, False)):
        page = of_run(replace(source, record=replace(source.record, runs=runs, assessment=answers)))
        assert (answer(page).headline == ENGLISH("chance.rarely")) != reckoned
        assert (fall in answer(page).todo) == reckoned


def test_one_that_leans_past_its_balance_at_the_end_is_not_said_to_stay_upright(source: RunSource) -> None:
    """Its run decided no outcome; the others' leans are those of the models in which it stays upright."""
    name = next(iter(source.histories))
    over_rad = 1.1 * source.scene.statue.slenderness_rad(1)
    ends = {each: replace(run, outcome=Outcome.STANDS) for each, run in source.record.runs.items()}
    ends[name] = replace(ends[name], outcome=Outcome.UNDECIDED)
    for lean_rad, said in ((over_rad, True), (0.5 * over_rad, False)):
        end = replace(source.histories[name], theta_rad=np.linspace(0.0, lean_rad, source.histories[name].t_s.size))
        record = replace(source.record, runs=ends, assessment=None)
        text = spoken(of_run(replace(source, record=record, histories=source.histories | {name: end})))
        assert (ENGLISH("run.disagree") in text) is said
        assert (ENGLISH("run.of_standing") in text) is said


def test_what_follows_a_fall_is_no_doubt_of_the_distances(source: RunSource) -> None:
    fell = {"outcome": Outcome.OVERTURNED_RIGHT, "reliable_until_s": 2.0}
    for passed_s, said in ((1.9, False), (2.1, True)):
        ends = {name: replace(run, no_return_time_s=passed_s, **fell) for name, run in source.record.runs.items()}
        record = replace(source.record, runs=ends, horizons=None)
        text = spoken(of_run(replace(source, record=record)))
        assert (ENGLISH("run.inexact", time="2") in text) is said


def test_rocking_is_called_sensitive_only_where_its_horizon_ends_before_the_run(source: RunSource) -> None:
    whole_s = source.scene.duration_s
    for until_s, said in ((0.5 * whole_s, True), (whole_s, False)):
        horizon = HorizonRecord(0.01, whole_s, (1e-6,), (until_s,), None, (Outcome.STANDS,), 0, until_s)
        text = spoken(of_run(replace(source, record=replace(source.record, horizons={"analytic": horizon}))))
        assert (ENGLISH("run.unpredictable", time=ENGLISH.short(until_s, 2)) in text) is said


@pytest.mark.parametrize(
    ("start", "kind"), [((0.1, 0.0), "lean"), ((0.0, 0.3), "turn"), ((0.1, 0.3), "lean_turn"), ((0.0, 0.0), "alone")]
)
def test_all_of_a_start_off_its_rest_is_told(source: RunSource, start: tuple[float, float], kind: str) -> None:
    begun = replace(source.record, scene=replace(source.scene, initial=Initial(*start)))
    told = ENGLISH(f"begin.shaking_{kind}", lean=ENGLISH.digits(math.degrees(start[0]), 2)).rstrip(",")
    assert told.lower() in spoken(of_run(replace(source, record=begun))).lower()


def test_an_outcome_that_the_smallest_changes_change_is_told(source: RunSource) -> None:
    told = source.record.answer
    assert told is not None
    tied = replace(
        told, findings=[*told.findings, changes_answer("outcome_not_predictable", outcomes=["overturned", "stands"])]
    )
    text = spoken(of_run(replace(source, record=replace(source.record, answer=tied))))
    assert ENGLISH("run.tie") in text
    assert ENGLISH("run.tie") not in spoken(of_run(source))


def test_the_room_is_that_of_models_within_their_domain(source: RunSource) -> None:
    """One that left it by a slide before anything moved tells of no room; where all left it, what they say is all there is."""

    def room_m(*names: str) -> dict[str, float]:
        gone = {"left_domain_by": "statue_slides", "left_domain_s": 0.0}
        runs = {
            name: replace(run, validity={**run.validity, **(gone if name in names else {})})
            for name, run in source.record.runs.items()
        }
        cut = replace(source, record=replace(source.record, runs=runs)).within_domain
        return floor_plan(cut, cut.standing).room_m

    one, *others = source.standing
    alone = replace(source, histories={name: source.histories[name] for name in others})
    assert room_m(one) == floor_plan(alone, others).room_m != room_m()
    assert room_m(*source.standing) == room_m()


def test_a_pedestal_slides_as_far_as_within_the_models_domain(source: RunSource) -> None:
    """The model alone pushed a pedestal by 3.5 cm, as its statue lay nearly flat."""
    one, run = next(iter(source.answered.items()))
    left = {"left_domain_by": "statue_slides", "left_domain_s": 0.0}
    gone = replace(run, peak_slip_m=0.035, validity={**run.validity, **left})
    told = replace(source, record=replace(source.record, runs={**source.runs, one: gone})).within_domain
    assert told.runs[one].peak_slip_m == abs(source.histories[one].slip_m[0])
    others = {name: each.peak_slip_m for name, each in source.runs.items() if name != one}
    assert {name: told.runs[name].peak_slip_m for name in others} == others


def test_a_slide_that_no_standing_model_computes_is_no_stillness(source: RunSource) -> None:
    runs = {
        name: replace(run, validity={**run.validity, "left_domain_by": "statue_slides", "left_domain_s": 0.0})
        for name, run in source.record.runs.items()
    }
    text = spoken(of_run(replace(source, record=replace(source.record, runs=runs))))
    for said in (ENGLISH("run.slides_unknown"), ENGLISH("run.outside", end=ENGLISH("end.stands"))):
        assert said in text
        assert said not in spoken(of_run(source))


@pytest.mark.parametrize("pedestal", [None, Pedestal(80.0, 0.6, 0.6, 0.3)])
def test_a_statue_that_slides_on_its_support_is_not_said_to_keep_still(
    tmp_path: Path, pedestal: Pedestal | None
) -> None:
    """The model's slip is the pedestal's alone: the statue's own is a finding, a sentence, and room in picture and plan."""
    motion, weak = (Harmonic(strength_g * GRAVITY_M_S2, 1.1) for strength_g in (0.28, 0.2))
    smooth = scene(rectangle(0.3, 0.6), motion, pedestal=pedestal, mu=0.6, mu_statue=0.1, duration_s=1.5)
    result = run_scene(smooth, ["analytic", "pymunk"])
    history = result.runs["pymunk"].history
    (found,) = [each for each in result.findings() if each.code == "statue_slides"]
    slid_m, _ = found.values["most"]
    assert found.values["models"] == ["pymunk"]
    assert slid_m == pytest.approx(float(np.abs(history.extra["statue_slip_m"]).max()), abs=SAMPLED_M)
    assert slid_m > 0.05
    # Neither rocks: only the slide parts them.
    (pair,) = run_scene(replace(smooth, base_excitation=BaseExcitation(weak)), ["analytic", "pymunk"]).scores.values()
    assert pair.verdict is Verdict.DOMAIN
    assert pair.evidence.left_domain_by == "statue_slides"
    write_result(result, tmp_path / "run")
    source = run_source(tmp_path / "run")
    text = spoken(of_run(source))
    assert ENGLISH("run.statue_slides", length=ENGLISH.length(slid_m)) in text
    assert ENGLISH("reach.still") not in text
    assert max(floor_plan(source, ["pymunk"]).room_m.values()) == pytest.approx(slid_m, abs=SAMPLED_M)


def test_a_lean_to_the_front_is_told_on_both_pages(source: RunSource, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a model in space its largest lean in any direction counts, against the angle at which it balances there."""
    name = next(iter(source.histories))
    lean_rad, share = 0.9 * source.scene.statue.slenderness_rad(1), 0.75
    runs = {each: replace(run, outcome=Outcome.STANDS) for each, run in source.record.runs.items()}
    space = {"peak_lean_rad": lean_rad, "peak_lean_share": share, "slip_across_m": 0.03}
    runs[name] = replace(runs[name], peak_theta_rad=0.0, validity={**runs[name].validity, **space})
    still = {each: replace(item, theta_rad=np.zeros_like(item.theta_rad)) for each, item in source.histories.items()}
    leaning = replace(source, record=replace(source.record, runs=runs, assessment=None), histories=still)
    degrees = ENGLISH.digits(math.degrees(lean_rad), 2)
    balance = ENGLISH.digits(math.degrees(lean_rad / share), 2)
    drawn, whole = [], conservator.reach_sketch
    monkeypatch.setattr(conservator, "reach_sketch", lambda *given: drawn.append(given) or whole(*given))
    text = spoken(of_run(leaning))
    side = min((1, -1), key=source.scene.statue.slenderness_rad)
    assert drawn[0][2] == [side * source.scene.statue.slenderness_rad(side)], (
        "in the plane it balances on its weaker side"
    )
    assert ENGLISH("run.leans", degrees=degrees, share="75", balance=balance) in text
    assert ENGLISH("reach.aside") in text
    assert any(ENGLISH("reach.of", degrees=f"{balance}°") in each.svg for each in pictures(of_run(leaning)))
    assert ENGLISH("plan.seen") not in text, "no line is dashed where it keeps within its outline"
    statue = source.scene.statue
    assert balance_share(runs[name], still[name].theta_rad, statue.slenderness_rad) == share


def test_both_pages_tell_one_share_of_the_balance(source: RunSource) -> None:
    """Of an engine in space nearly in the plane, and of a model whose samples miss its peak: 58 % was told beside 61 %."""
    name, run = next(iter(source.answered.items()))
    for own in (
        {"peak_lean_rad": 1.02 * abs(run.peak_theta_rad), "peak_lean_share": 0.99},
        {"peak_over_slenderness": 0.99},
    ):
        runs = {**source.runs, name: replace(run, validity={**run.validity, **own})}
        told = replace(source, record=replace(source.record, runs=runs))
        assert conservator._worst_lean(told)[0] == 0.99
        assert "99 % of the" in spoken(of_run(told))
        late = replace(runs[name], validity={**runs[name].validity, "left_domain_s": 0.0})
        cut = replace(source, record=replace(source.record, runs={**runs, name: late}))
        assert conservator._worst_lean(cut.within_domain)[0] < 0.99, "what comes after the domain counts for nothing"


def test_a_pedestal_that_one_model_lets_tip_is_not_said_to_stay_put(source: RunSource) -> None:
    runs = source.record.runs
    name = next(iter(runs))
    still = {each: replace(run, peak_slip_m=0.0) for each, run in runs.items()}
    tips = still | {
        name: replace(
            still[name], validity={**still[name].validity, "left_domain_s": 0.5, "left_domain_by": "pedestal_tips"}
        )
    }
    put = [
        ENGLISH("run.put") in spoken(of_run(replace(source, record=replace(source.record, runs=each))))
        for each in (still, tips)
    ]
    assert put == [True, False]


def test_where_it_stands_in_no_model_no_room_is_drawn(source: RunSource) -> None:
    assert set(floor_plan(source, list(source.histories)).room_m) >= {"left", "right"}
    assert floor_plan(source, []).room_m == {}


def test_a_model_that_holds_upright_a_pedestal_that_tips_gives_no_answer(tmp_path: Path) -> None:
    motion = Harmonic(0.24 * GRAVITY_M_S2, 1.2)
    tall = scene(rectangle(0.25, 1.0), motion, pedestal=Pedestal(80.0, 0.35, 0.35, 1.1), mu=0.6, duration_s=2.0)
    said = {}
    for name, models in (("alone", ["analytic"]), ("beside", ["analytic", "pymunk"])):
        result = run_scene(tall, models)
        write_result(result, tmp_path / name)
        said[name] = of_run(run_source(tmp_path / name))
        # The record's answer, which the engineer's page and the terminal show, counts the same models as the conservator's.
        assert [each for each, run in result.runs.items() if has_answer(run)] == models[1:]
        told = run_source(tmp_path / name).record.answer
        assert told.code == ("one_model" if models[1:] else "no_answer")
    alone, beside = map(spoken, said.values())
    assert alone.startswith(ENGLISH("run.none"))
    assert ENGLISH("run.no_rocking") not in alone
    assert ENGLISH("run.put") not in alone + beside
    assert f"{ENGLISH('run.answered_one')} {ENGLISH('run.silent_one')}" in beside
    assert 4.0 <= float(form("run.tips").search(beside)["degrees"]) < 8.0
    # What moves is the pedestal's top, 1.1 m up; what falls with it reaches as far as both are high.
    room_cm = float(form("todo.slide").search(beside)["length"].removesuffix("\u00a0cm"))
    assert room_cm > 110.0 * math.sin(math.radians(4.0))
    assert ENGLISH("todo.fall", height=ENGLISH.length(2.1)) in beside
