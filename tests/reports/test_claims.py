"""Every sentence of a conservator's page is held against the record, over varied scenes: colours, counts, per cents, hints."""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analytic.excitation import ZeroExcitation
from harness import Outcome, Run, Scene, load_scene
from harness.questions.scene.scene_run import run_scene, write_result
from harness.records.run import has_answer
from reports.blocks import Block
from reports.messages import ENGLISH
from reports.pages.conservator import blocks
from reports.pages.page import write_report
from reports.pages.run_page import histories_figure
from reports.source import RunSource, run_source, run_verdict
from tests.budgets_reports import LEAN_TOLD, LEAST_MOVES, PUSH_TOLD
from tests.reports.claim_scenes import HOSTILE, SEEDS, content, write_scene
from tests.reports.page_parts import answer, form, pictures, spoken

FINE = 300_001
"""Instants of a run of three seconds at which a push is looked for: a hundredth of a millisecond apart."""


@dataclass(frozen=True)
class Told:
    """One scene, its record and what its conservator's page says."""

    seed: int
    scene: Scene
    source: RunSource
    said: Sequence[Block]

    @property
    def run(self) -> Mapping[str, Any]:
        run: Run = self.source.runs["analytic"]
        return run

    @property
    def answers(self) -> bool:
        """Whether the model, which holds its pedestal upright, knows how this ends."""
        return has_answer(self.source.runs["analytic"])

    def words(self, heading: str) -> str:
        """The caption below a heading of the catalogue."""
        drawn = (item for item in pictures(self.said) if item.heading == ENGLISH(heading))
        return " ".join(text for item in drawn for text in item.caption)

    @property
    def text(self) -> str:
        return spoken(self.said)

    def found(self, code: str) -> Mapping[str, Any] | None:
        """The values of the record's finding of this code; None without one."""
        return next((each.values for each in self.source.record.findings if each.code == code), None)


@pytest.fixture(scope="module")
def told(tmp_path_factory: pytest.TempPathFactory) -> list[Told]:
    """All scenes, run by the analytic model; of hostile titles both pages are written."""
    return list(_told(tmp_path_factory.mktemp("claims")))


def _told(folder: Path) -> Iterator[Told]:
    for seed in SEEDS:
        place = folder / str(seed)
        scene = load_scene(write_scene(folder / f"scene-{seed}", content(seed)))
        write_result(run_scene(scene, ["analytic"]), place)
        if scene.title == HOSTILE:
            write_report(place)
        source = run_source(place)
        yield Told(seed, scene, source, blocks(place, source.record))


def test_the_scenes_are_varied(told: list[Told]) -> None:
    """What the other tests look for is there."""
    ends = {item.run.outcome for item in told}
    assert {"stands", "overturned_left", "overturned_right"} <= ends
    assert any(item.scene.contact.floor_static == 0.0 for item in told)
    assert any(item.scene.wall for item in told)
    assert any(abs(item.scene.initial.theta_rad) >= 0.5 for item in told)
    assert sum(not isinstance(item.scene.base_excitation.y, ZeroExcitation) for item in told) >= 5
    assert any(item.found("nothing_moves") for item in told)
    assert any(item.found("no_model_moves") for item in told)
    assert {bool(item.scene.pedestal) for item in told} == {item.answers for item in told} == {True, False}


def test_green_is_a_statue_that_stays_upright(told: list[Told]) -> None:
    """And green only where nothing shakes it: these records hold no probability, and one run is one draw."""
    for item in told:
        still = not item.source.record.motion.accel_m_s2
        assert (answer(item.said).tone == "agree") is (item.run.outcome == Outcome.STANDS and still), item.seed
        if item.answers:
            assert (ENGLISH("end.stands") in answer(item.said).headline) is (item.run.outcome == Outcome.STANDS), (
                item.seed
            )
            assert (ENGLISH("end.overturns") in answer(item.said).headline) is item.run.outcome.overturned, item.seed


def test_a_model_that_holds_a_tipping_pedestal_upright_tells_no_end(told: list[Told]) -> None:
    for item in told:
        assert (ENGLISH("run.none") in answer(item.said).headline) is not item.answers, item.seed
        told = ("run.leans", "run.leans_past", "run.put", "run.no_rocking")
        assert item.answers or not any(form(key).search(item.text) for key in told)
        assert item.answers or f"{ENGLISH('end.stands')}." not in item.text


def test_no_shaking_is_said_of_a_still_floor(told: list[Told]) -> None:
    for item in (each for each in told if each.answers):
        base_excitation = item.scene.base_excitation
        moves = not all(
            isinstance(part, ZeroExcitation) for part in (base_excitation.x, base_excitation.y, base_excitation.z)
        )
        shaking = ("begin.shaking_alone", "begin.shaking_lean", "begin.shaking_lean_turn", "begin.shaking_turn")
        assert any(form(key).match(answer(item.said).headline) for key in shaking) is moves, item.seed
        lean = abs(math.degrees(item.scene.initial.theta_rad))
        assert (f" {lean:.2g}°" in answer(item.said).headline) is (lean > 0.0), item.seed


def pushes(scene: Scene) -> tuple[float, dict[str, float]]:
    """The strongest level push, and by cause its largest share of what moves a block: statics on a fine grid."""
    t_s = np.linspace(0.0, scene.duration_s, FINE)
    x, y, z = (
        np.asarray(part.accel_m_s2(t_s))
        for part in (scene.base_excitation.x, scene.base_excitation.y, scene.base_excitation.z)
    )
    g, statue, size = scene.gravity_m_s2, scene.statue, np.hypot(x, y)
    weight = np.maximum(g + z, 1e-300)
    lever = statue.centroid_height_m / weight
    tips = np.max(
        [
            -x * lever / statue.corner_right_m,
            x * lever / statue.corner_left_m,
            np.abs(y) * lever / (0.5 * statue.depth_m),
        ]
    )
    shares = {"cause_statue_tips": float(tips), "statue_slides": float((size / weight).max()) / scene.contact.statue}
    if scene.pedestal is not None:
        floor = scene.contact.floor_static
        stone, half = scene.pedestal, np.array([[scene.pedestal.width_m], [scene.pedestal.depth_m]]) / 2.0
        lever = stone.mass_kg * stone.height_m / 2.0 + statue.mass_kg * (stone.height_m + statue.centroid_height_m)
        # From the statue's centroid the edges lie the pedestal's half and the base's middle away.
        middle = np.array([[statue.base_centre_m], [0.0]])
        arms = {1: half + middle, -1: half - middle}
        holds = {side: stone.mass_kg * half + statue.mass_kg * arm for side, arm in arms.items()}
        turning = {side: np.max(-side * np.stack([x, y]) * lever / hold / weight) for side, hold in holds.items()}
        shares["cause_pedestal_tips"] = float(max(turning.values()))
        shares["pedestal_slides"] = float((size / weight).max()) / floor if floor else math.inf
    return float(size.max()) / g, shares


def test_the_strongest_push_is_that_of_the_whole_motion_within_the_run(told: list[Told]) -> None:
    seen = 0
    for item in told:
        told = item.words("order.heading") + item.words("order.heading_pedestal")
        match = form("order.pushes").search(told) or form("order.pushes_rising").search(told)
        free = form("order.any_push").search(told)
        level = not (
            isinstance(item.scene.base_excitation.x, ZeroExcitation)
            and isinstance(item.scene.base_excitation.y, ZeroExcitation)
        )
        assert bool(match or free) is level, item.seed
        if not level:
            continue
        peak, shares = pushes(item.scene)
        assert float((match or free)["peak"].removesuffix(" %")) == pytest.approx(100.0 * peak, rel=PUSH_TOLD), (
            item.seed
        )
        first = max(shares, key=lambda name: shares[name])
        assert (match or free)["words"].startswith(ENGLISH(f"order.{first}")), (item.seed, shares)
        assert bool(free) is (shares[first] > 1e6), item.seed
        if match is not None:
            number, unit, *_ = match["times"].split()
            share = float(number) * (0.01 if unit == "%" else 1.0)
            assert share == pytest.approx(shares[first], rel=PUSH_TOLD), item.seed
        seen += 1
    assert seen >= 25


def test_nothing_moves_is_said_where_nothing_can(told: list[Told]) -> None:
    """Below every limit, without a warning that something slides; above one, with what gives way."""
    for item in told:
        peak, shares = pushes(item.scene)
        if item.found("nothing_moves"):
            assert max(shares.values()) < 1.0, item.seed
            assert not item.found("left_domain"), item.seed
            assert item.run.peak_theta_rad == item.run.peak_slip_m == 0.0, item.seed
        if item.found("no_model_moves"):
            assert max(shares.values()) >= 1.0, item.seed
        # A model that left its domain at once says of no statue that it stays where it is.
        stands = item.run.outcome is Outcome.STANDS
        still = stands and item.run.peak_theta_rad == 0.0 and item.run.peak_slip_m == 0.0
        if still and peak > 0.0:
            assert item.found("nothing_moves") or item.found("no_model_moves"), item.seed


def test_the_hint_is_the_least_that_moves_the_statue(told: list[Told]) -> None:
    """At the value told the statics of the block give way, a hair below they do not; so does the model itself."""
    seen = 0
    for item in told:
        least = (item.found("nothing_moves") or {}).get("least") or ""
        hint = re.fullmatch(r"motion\.x\.(\S+)=(\S+)", least)
        if hint is None:
            continue
        changed = content(item.seed)
        # At the limit itself a model may hold, and one that looks at its steps only may miss the very crest.
        for factor, moves in ((1.0 + LEAST_MOVES, True), (1.0 - LEAST_MOVES, False)):
            changed["motion"]["x"][hint.group(1)] = float(hint.group(2)) * factor
            scene = load_scene(write_scene(item.source.folder / f"hint{moves:d}", changed))
            assert (max(pushes(scene)[1].values()) >= 1.0) is moves, (item.seed, factor)
            if scene.planar:
                run = run_scene(scene, ["analytic"]).runs["analytic"]
                left = bool(run.validity["left_domain_by"])
                assert (left or run.peak_theta_rad != 0.0 or run.peak_slip_m != 0.0) is moves, (item.seed, factor)
        seen += 1
    assert seen >= 5


def test_leans_and_slips_are_those_of_the_history(told: list[Told]) -> None:
    seen = 0
    for item in (each for each in told if each.answers):
        history, statue = item.source.histories["analytic"], item.scene.statue
        within = form("run.leans").search(item.text)
        lean = within or form("run.leans_past").search(item.text)
        assert bool(lean) is (item.run.outcome == Outcome.STANDS and float(np.abs(history.theta_rad).max()) > 1e-5)
        if lean is not None:
            theta = history.theta_rad
            shares = {1: theta.max() / statue.slenderness_rad(1), -1: -theta.min() / statue.slenderness_rad(-1)}
            side = max(shares, key=lambda name: float(shares[name]))
            angle = abs(math.degrees(theta.max() if side > 0 else theta.min()))
            assert float(lean["degrees"]) == pytest.approx(angle, rel=LEAN_TOLD), item.seed
            if within:
                # Below 10 % with a decimal.
                half = 0.051 if "." in within["share"] else 0.51
                assert float(within["share"]) == pytest.approx(100.0 * shares[side], abs=half), item.seed
            seen += 1
        slides = form("run.slides").search(item.text)
        if slides is not None:
            number, unit = slides["length"].split("\u00a0")
            assert float(number) * {"m": 1.0, "cm": 0.01, "mm": 0.001}[unit] == pytest.approx(
                item.run.peak_slip_m, rel=LEAN_TOLD
            ), item.seed
        assert (ENGLISH("run.put") in item.text) is (item.scene.pedestal is not None and item.run.peak_slip_m <= 1e-3)
    assert seen >= 8


def test_the_weakest_side_is_the_one_that_tips_first(told: list[Told]) -> None:
    for item in told:
        statue = item.scene.statue
        levels = {
            "right": statue.corner_right_m,
            "left": statue.corner_left_m,
            "back": 0.5 * statue.depth_m,
            "front": 0.5 * statue.depth_m,
        }
        least = min(levels.values())
        match = form("push.weakest").search(item.text)
        assert match is not None, item.seed
        named = set(re.findall(r"right|left|back|front", match["sides"]))
        assert {name for name, value in levels.items() if value == least} <= named, item.seed
        assert all(levels[name] <= 1.01 * least for name in named), item.seed
        assert float(match["push"].removesuffix(" %")) == pytest.approx(
            100.0 * least / statue.centroid_height_m, rel=LEAN_TOLD
        )


def test_what_slides_is_said_with_its_own_friction(told: list[Told]) -> None:
    for item in told:
        contact = item.scene.contact
        push = contact.statue if item.scene.pedestal is None else min(contact.floor_static, contact.statue)
        stone = "pedestal" if item.scene.pedestal is not None and contact.floor_static <= contact.statue else "statue"
        match = form("push.circle").search(item.text)
        assert bool(match) is (push < 1.0), item.seed
        if match is not None:
            slides = form(f"push.{stone}_slides").search(item.text)
            assert slides, item.seed
            assert float(slides["pushes"].removesuffix(" %")) == pytest.approx(100.0 * push, rel=LEAN_TOLD), item.seed


def test_a_title_reaches_no_page_with_its_control_characters(told: list[Told]) -> None:
    hostile = [item for item in told if item.scene.title == HOSTILE]
    assert len(hostile) >= 8
    for item in hostile:
        for name in ("report.html", "conservator.html"):
            page = (item.source.folder / name).read_text(encoding="utf-8")
            assert not re.search("[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]", page), (item.seed, name)
            assert r"x [/] y &lt;b&gt; &#34;$a_{&#34; \x1b[31m\nred \u202e" in page, (item.seed, name)


def test_the_first_view_of_a_history_shows_some_of_it(told: list[Told]) -> None:
    """Upwards, and over rotations that the statue takes: one let go beyond its balance points never comes near them."""
    for item in told:
        low, high = histories_figure(item.source)["usermeta"]["views"]["near"]
        theta = item.source.histories["analytic"].theta_rad
        assert low < high, item.seed
        assert ((theta >= low) & (theta <= high)).any(), item.seed


def test_one_model_alone_is_not_called_agreement(told: list[Told]) -> None:
    for item in told:
        verdict = run_verdict(item.source)
        # Nor is one run under a shaking: how probable a fall is was not computed here.
        still = not item.source.record.motion.accel_m_s2
        assert (verdict.tone == "agree") is (still and item.run.outcome == Outcome.STANDS), item.seed


def test_no_distance_on_a_page_is_negative(told: list[Told]) -> None:
    """A pedestal may slide into a wall that no model follows: it is said, not told as a distance below nought."""
    for item in told:
        text = " ".join(run_verdict(item.source).points)
        assert not re.search(r"[-−]\d\S*\u00a0(mm|cm|m)\b", text + item.text), item.seed
