"""A small map: the command's record and files, checks, and a second call that computes nothing."""

import csv
import json
import math
import re
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w
from typer.testing import CliRunner

import harness
from harness import InputError, Scene, engines, load_scene, read_result
from harness.accuracy.forecast import Range
from harness.accuracy.horizon import MODEL
from harness.model import Severity
from harness.questions import trust
from harness.questions.assess.probability import crossing
from harness.questions.trust import (
    Map,
    Plane,
    Point,
    Said,
    answer_of,
    confirmed_up_to_g,
    contour,
    doubtful,
    engines_of,
    explored,
    falls,
    findings_of,
)
from harness.records.scores import Interval
from harness.records.trust import CLASSES, CONTOURS, Rotation, Saved, TrustRecord, TrustSummary
from harness.runs.progress import duration_words
from harness.runs.runner import InlinePool
from harness.runs.store import STORE_NAME, Store
from reports.cli import app
from reports.messages import ENGLISH
from reports.pages.page import write_report
from reports.pages.study_page import point_figure, trust_map
from reports.terminal import COLUMNS, LINES, record_lines
from tests.harness.questions.trust.test_plane import BLOCK
from tests.reports import invented_records
from tests.reports.charts.parts import kind_at

KEYS = {"amplitude_g", "frequency_hz", "class", "basis", "amplitude_over_g_tan_alpha", "frequency_over_p"}


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """The file of a scene of which a map has two frequencies and three strengths, computed here."""
    monkeypatch.setattr(trust, "RESOLUTION", {True: 4.5})
    monkeypatch.setattr(trust, "FREQUENCIES", {True: 2})
    monkeypatch.setattr(trust, "LocalPool", lambda jobs: InlinePool())
    path = tmp_path / "block.toml"
    path.write_text(tomli_w.dumps({key: value for key, value in BLOCK.items() if key != "uncertainty"}))
    return path


def called(*words: object) -> Any:
    return CliRunner().invoke(app, ["trust", *map(str, words), "--coarse", "-e", "pymunk"])


def test_the_command_writes_a_row_for_each_point_and_goes_on_with_what_it_has(small: Path, tmp_path: Path) -> None:
    out = tmp_path / "map"
    done = called(small, "--out", out)
    assert done.exit_code == 0, done.output
    lines = [line for line in done.stdout.splitlines() if not line.startswith("report: ")]
    assert len(lines) < LINES
    assert max(map(len, lines)) <= COLUMNS
    record = json.loads((out / "result.json").read_text())
    assert record["answer"]["text"]
    assert [each["stands_on"] for each in record["maps"]] == ["floor"]
    cells = record["maps"][0]["cells"]
    assert len(cells) == 6
    assert all(cell.keys() >= KEYS and cell["class"] in CLASSES for cell in cells)
    assert sum(record["maps"][0]["shares"].values()) == pytest.approx(1.0)
    # The least strength is below the limit of rest, and no engine is needed there but as a check.
    assert [cell["class"] for cell in cells if cell["amplitude_over_g_tan_alpha"] < 1.0] == ["nothing_moves"] * 2
    asked = [cell for cell in cells if cell["basis"] in ("runs", "checked")]
    assert {*asked[0]["outcomes"]} == {"analytic", "pymunk"}
    assert len(asked) == record["summary"]["asked"] == record["summary"]["whole"]
    with (out / "cells.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    assert [row["class"] for row in rows] == [cell["class"] for cell in cells]
    assert 'id="map"' in write_report(out).read_text()
    again = called(small, "--out", out, "--resume", "--json")
    second = json.loads(again.stdout)
    assert second["maps"][0]["cells"] == cells
    with Store(out / STORE_NAME, "trust") as store:
        assert second["summary"]["found"] == len(store.keys())


def test_at_how_many_points_an_engine_in_space_was_asked_is_told() -> None:
    """It is asked on a coarse grid: not all models ran at each point at which those in the plane did."""
    for whole, some in ((4, 4), (12, None)):
        asked, *_ = findings_of([], {}, TrustSummary(24, 12, 1, 0, 0, 1.0, whole=whole), 0)
        assert asked.values == {"points": 24, "asked": 12, "some": some}


def test_what_a_map_takes_is_told_before_it_begins(monkeypatch: pytest.MonkeyPatch) -> None:
    """Runs of 100 s at half of the points in the plane, at a quarter in space; without its pedestal as often again."""
    monkeypatch.setattr(trust, "run_s", lambda name, scene: Range(50.0, 200.0))
    on = Plane.of(load_scene(Path(__file__).parents[4] / "scenes" / "paestum_pedestal.toml"), "sine", coarse=True)
    count = 2 * len(on.points)
    shares = trust.ASKED
    for names, share in (
        (("analytic", "pymunk"), shares[2]),
        (("analytic", "pymunk", "pybullet"), shares[2] + shares[3]),
    ):
        cpu_s = count * (trust.POINT_S + 100.0 * share)
        told = trust.cost_words(on, names, 2, coarse=True)
        spent, clock = duration_words(cpu_s), duration_words(cpu_s / 2)
        assert re.fullmatch(rf"{count} .*{re.escape(spent)} .*{re.escape(clock)} .*\b2\b.*", told)
    whole = trust.cost_words(on, ("analytic", "pymunk"), 1, coarse=False)
    chances_s = 2 * trust.CHANCE_S * len(on.frequencies_hz)
    assert duration_words(count * (trust.POINT_S + 100.0 * shares[2]) + chances_s) in whole
    # Where the model leaves its domain an engine's draws are of its probability: at a half of these points.
    monkeypatch.setattr(trust, "has_answer", lambda run: abs(run.peak_theta_rad) < np.median(peaks))
    drawn = np.random.default_rng(0).permutation(len(on.points))[: trust.TRIALS]
    peaks = [abs(harness.simulate(on.at(on.points[k]), "analytic").peak_theta_rad) for k in drawn]
    monkeypatch.setattr(trust, "planes_of", lambda plane: ([on], []))
    more_s = len(on.points) * (trust.POINT_S + 100.0 * shares[2] + 0.5 * trust.SAMPLE_S)
    assert duration_words(more_s) in trust.cost_words(on, ("analytic", "pymunk"), 1, coarse=True)


def test_a_point_says_what_a_run_of_it_says(small: Path, tmp_path: Path) -> None:
    record = trust.run_trust(small, tmp_path / "map", ["pymunk"], coarse=True, quiet=True)
    cell = record.maps[0].cells[-1]
    result = harness.run_scene(load_scene(small, cell["set"]), ["analytic", "pymunk"])
    assert cell["answer"] == result.answer().code
    assert {*cell["paths"]} == {"analytic", "pymunk"}
    for name, path in cell["paths"].items():
        ran = result.runs[name]
        assert path.end_s == ran.end_s
        assert np.abs(path.theta_rad).max() == pytest.approx(np.abs(ran.history.theta_rad).max(), rel=5e-3)


@pytest.mark.parametrize(
    ("words", "where"), [(("--motion", "square"), "--motion"), (("--set", "statue.mass_kg=-1"), "--set")]
)
def test_what_is_wrong_is_told_and_nothing_is_written(
    small: Path, tmp_path: Path, words: Sequence[str], where: str
) -> None:
    error = called(small, "--out", tmp_path / "map", *words).exception
    assert isinstance(error, InputError)
    assert error.mistakes[0].where == where
    assert not (tmp_path / "map").exists()


def test_the_model_is_held_against_somebody_and_not_against_its_twin(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = harness.scene({**BLOCK, "uncertainty": {}})
    assert engines_of(scene, None, coarse=False) == ("analytic", "pymunk")
    assert engines_of(scene, ["pymunk"], coarse=False) == ("analytic", "pymunk")
    monkeypatch.setattr(type(engines.load("pybullet")), "missing", lambda engine: "not installed here")
    for names in (["analytic"], ["pymunk", "pybullet"]):
        with pytest.raises(InputError) as caught:
            engines_of(scene, names, coarse=False)
        assert caught.value.mistakes[0].where == "--engine"


def test_a_shaking_across_the_plane_is_asked_of_space_even_on_a_coarse_map() -> None:
    across = {**BLOCK["motion"], "y": {"kind": "harmonic", "amplitude_g": 0.1, "frequency_hz": 2.0}}
    scene = harness.scene({**BLOCK, "motion": across, "uncertainty": {}})
    for motion, wanted in (("scene", ("analytic", "pymunk", "spatial")), ("sine", ("analytic", "pymunk"))):
        whole = Plane.of(scene, motion, coarse=True)
        assert engines_of(whole.at(whole.points[-1]), None, coarse=True) == wanted


def word(kind: str, *, still: bool = False, apart_rad: float = 0.0) -> Said:
    return Said(kind, "agree", [], {"analytic": "stands"}, still, ("stands", still), 0.1, 0.5, apart_rad, 1.0, 1.0)  # type: ignore[arg-type]


def found(kinds: dict[int, str], rest: int = 0) -> Map:
    """Nine strengths at one frequency that the model says alike, the least of them at rest; what engines said at some."""
    whole = Plane(None, None, "sine", [0.1 * 1.05**j for j in range(9)], [1.0])  # type: ignore[arg-type]
    model = {(0, j): word("no_answer", still=j < rest) for j in range(9)}
    ran = {(0, j): word(kind) for j, kind in kinds.items()}
    return Map(whole, NAMES, model, {(0, j) for j in range(rest)}, ran, dict(ran))


NAMES = ("analytic", "pymunk")


@dataclass(frozen=True)
class Told:
    """What is kept of a point whose class by each set of models is that."""

    kinds: dict[tuple[str, ...], str]
    paths: dict[str, Rotation] = field(default_factory=dict)

    def said(self, scene: Scene, names: tuple[str, ...]) -> Said:
        return word(self.kinds[names])


def checked(known: Map, point: Point, kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Plane, "at", lambda plane, point: None)
    known.check([point], {point: Told({known.names: kind, known.quick: kind})})  # type: ignore[dict-item]


@pytest.mark.parametrize(
    ("names", "said"),
    [(("analytic", "pymunk"), True), (("analytic", "pymunk", "pybullet"), False), (("analytic", "spatial"), False)],
)
def test_a_map_of_a_scan_that_no_engine_in_space_was_asked_for_says_so(
    names: tuple[str, ...], said: bool, root: Path
) -> None:
    maps = invented_records.trust().maps
    scan, block = (load_scene(root / "scenes" / f"paestum_{name}.toml") for name in ("pedestal", "block"))
    for scene, told in ((scan, said), (block, False)):
        answer = answer_of(Plane.of(scene, "sine", coarse=True), names, maps, {})
        assert ("trust_in_plane" in {each.code for each in answer.findings}) is told


def test_between_points_that_agree_the_class_is_theirs() -> None:
    known = found({2: "confirmed", 8: "confirmed"}, rest=2)
    words = known.words()
    assert [words[0, j][:2] for j in (0, 2, 5)] == [
        ("nothing_moves", "rest"), ("confirmed", "runs"), ("confirmed", "between"),
    ]  # fmt: skip
    assert not known.unasked(NAMES)


def test_a_check_that_agrees_changes_nothing_and_another_class_is_refined(monkeypatch: pytest.MonkeyPatch) -> None:
    known = found({2: "confirmed", 8: "confirmed"}, rest=2)
    checked(known, (0, 5), "confirmed", monkeypatch)
    assert not known.changed
    assert known.words()[0, 5][1] == "checked"
    checked(known, (0, 1), "refuted", monkeypatch)
    assert known.changed == {(0, 1)}
    # Nor do the limits of rest decide along that frequency any longer.
    assert known.unasked(NAMES) == {(0, 0)}


ALL = ("analytic", "pymunk", "pybullet")


def wide() -> Map:
    """Three frequencies and nine strengths, all confirmed by the engines in the plane at their ends."""
    whole = Plane(None, None, "sine", [0.1 * 1.08**j for j in range(9)], [1.0, 1.5, 2.0])  # type: ignore[arg-type]
    model = {point: word("no_answer") for point in whole.points}
    return Map(whole, ALL, model, set(), {(i, j): word("confirmed") for i in range(3) for j in (0, 8)})


@dataclass
class Invented:
    """Answers as `Points` gives them, of no run: at these points engines refute the model, at all others they confirm it."""

    refuted: set[Point]
    asked: dict[tuple[str, ...], set[Point]] = field(default_factory=dict)
    horizons: dict[str, Any] = field(default_factory=dict)
    paths: dict[str, Rotation] = field(default_factory=dict)

    def kept(self, plane: Plane, points: Sequence[Point], names: tuple[str, ...], horizons: object = None) -> Any:
        self.asked.setdefault(names, set()).update(points)
        return {at: replace(self, refuted={at} & self.refuted) for at in points}

    def said(self, scene: Scene, names: tuple[str, ...]) -> Said:
        return word("refuted" if self.refuted and names != (MODEL,) else "confirmed")


def test_a_whole_map_is_asked_from_its_ends_and_what_a_check_finds_is_bracketed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """No engine runs: the questions of a map are answered by whoever is given."""
    monkeypatch.setattr(Plane, "at", lambda plane, point: None)
    monkeypatch.setattr(Plane, "at_rest", lambda plane, point: False)
    whole = Plane(None, None, "sine", [0.1 * 1.02**j for j in range(33)], [1.0, 1.3, 1.7, 2.2])  # type: ignore[arg-type]
    calm = Invented(set())
    found = explored(whole, NAMES, calm, 0)  # type: ignore[arg-type]
    assert calm.asked[MODEL,] == set(whole.points)
    assert calm.asked[NAMES] == {(i, j) for i in range(4) for j in (0, 32)} | found.checks
    # Between the ends of a frequency, at which the model says the same.
    odd = Invented({(1, j) for j in range(9, 25)})
    found = explored(whole, NAMES, odd, 1)  # type: ignore[arg-type]
    assert found.changed
    assert {at for at, (kind, _, _) in found.words().items() if kind == "refuted"} == odd.refuted
    assert len(odd.asked[NAMES]) < len(whole.points) / 2


def test_where_all_run_those_in_the_plane_are_not_asked_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """Their runs are among those of all."""
    monkeypatch.setattr(Plane, "at", lambda plane, point: None)
    monkeypatch.setattr(Plane, "at_rest", lambda plane, point: False)
    whole = Plane(None, None, "sine", [0.1 * 1.02**j for j in range(33)], [1.0, 1.3, 1.7, 2.2])  # type: ignore[arg-type]
    calm = Invented(set())
    found = explored(whole, ALL, calm, 0)  # type: ignore[arg-type]
    assert calm.asked[ALL] | calm.asked[NAMES] == found.ran.keys()
    assert not calm.asked[ALL] & calm.asked[NAMES]


def test_an_engine_in_space_is_asked_where_it_says_another_class(monkeypatch: pytest.MonkeyPatch) -> None:
    """On a coarse grid first, then around the points where it does; elsewhere what those in the plane say is the class."""
    monkeypatch.setattr(Plane, "at", lambda plane, point: None)
    known = wide()
    assert known.quick == NAMES
    assert not known.unasked(NAMES)
    first = known.unasked(ALL)
    assert first == {(i, j) for i in (0, 2) for j in (0, 8)}
    refuted = {(2, 7), (2, 8)}
    while asked := known.unasked(ALL):
        told = {at: Told({ALL: "refuted" if at in refuted else "confirmed", NAMES: "confirmed"}) for at in asked}
        known.take(ALL, told)  # type: ignore[arg-type]
    assert len(known.whole) < len(known.plane.points)
    words = known.words()
    assert {point for point, (kind, _, _) in words.items() if kind == "refuted"} == refuted
    # What the engines in the plane say stands beside it, and refines nothing.
    assert {said.kind for said in known.ran.values()} == {"confirmed"}
    assert not known.unasked(NAMES)


def test_between_points_that_one_engine_refutes_the_model_is_refuted() -> None:
    known = wide()
    known.whole = {(i, j): word("refuted") for i in (0, 2) for j in (0, 8)}
    assert not known.unasked(ALL)
    words = known.words()
    assert {kind for kind, _, _ in words.values()} == {"refuted"}
    assert words[1, 4][1] == "between"


def test_what_engines_in_the_plane_leave_open_is_not_confirmed_by_points_around() -> None:
    """One in space bounds its error nowhere, so nothing is confirmed to the end; a matter of probability stays one."""
    known = wide()
    known.ran |= {(1, 4): word("probability"), (1, 5): word("confirmed")}
    known.whole = {(i, j): word("outcome_confirmed") for i in (0, 2) for j in (0, 8)}
    words = known.words()
    assert [words[1, j][0] for j in (4, 5)] == ["probability", "outcome_confirmed"]


def test_the_strength_up_to_which_a_model_holds_ends_at_the_first_doubt() -> None:
    kinds = {0: "confirmed", 4: "outcome_confirmed", 5: "probability", 6: "confirmed", 8: "confirmed"}
    known = found(kinds)
    assert confirmed_up_to_g(known, known.words()) == pytest.approx(0.1 * 1.05**4)
    known.whole[0, 4] = word("outcome_confirmed", apart_rad=0.5)
    assert confirmed_up_to_g(known, known.words()) == pytest.approx(0.1 * 1.05**3)
    known.model[0, 2].outcomes["analytic"] = "overturned"
    assert confirmed_up_to_g(known, known.words()) == pytest.approx(0.1 * 1.05)
    known.whole[0, 0] = word("refuted")
    assert confirmed_up_to_g(known, known.words()) is None


def test_an_engine_is_asked_for_a_probability_where_it_is_nearest_a_half() -> None:
    chances = {(0, 0): 0.0, (0, 1): 0.2, (0, 2): 0.6, (0, 3): 1.0, (1, 0): 0.01, (1, 1): 0.97}
    assert doubtful({at: Interval(p, p, p) for at, p in chances.items()}) == [(0, 2)]


def test_a_pedestal_s_map_stands_beside_that_of_the_statue_on_the_floor(small: Path, tmp_path: Path) -> None:
    content = tomllib.loads(small.read_text())
    pedestal = {"mass_kg": 100.0, "width_m": 0.6, "depth_m": 0.6, "height_m": 0.2}
    unknown = {key: {"kind": "assumed"} for key in ("pedestal.offset_m", "contact.floor", "statue.mass_kg")}
    floor = {"floor_static": 0.15, "floor_kinetic": 0.15, "statue": 1.0}
    small.write_text(tomli_w.dumps({**content, "pedestal": pedestal, "contact": floor, "uncertainty": unknown}))
    record = trust.run_trust(small, tmp_path / "map", ["pymunk"], coarse=True, quiet=True)
    own, without = record.maps
    assert (own.stands_on, without.stands_on) == ("pedestal", "floor")
    at = [[(cell["amplitude_g"], cell["frequency_hz"]) for cell in each.cells] for each in record.maps]
    assert at[0] == at[1]
    scene = load_scene(small, without.cells[-1]["set"])
    assert (scene.pedestal, {item.key for item in scene.uncertainty}) == (None, {"contact.floor", "statue.mass_kg"})
    # It slides from 0.15 g on; the block on the floor rocks from 0.2 g on and falls at the strongest shaking.
    assert [falls(each.cells[2], "analytic") for each in record.maps] == [False, True]
    assert record.saved["analytic"].prevented > record.saved["analytic"].caused == 0
    with (tmp_path / "map" / "cells.csv").open() as stream:
        assert [row["stands_on"] for row in csv.DictReader(stream)] == ["pedestal"] * 6 + ["floor"] * 6


def test_a_contour_lies_where_its_value_is_first_passed() -> None:
    at = [0.1, 0.2, 0.4, 0.8]
    assert crossing([0.0, 0.1, 0.2, 0.1], 0.15, at) == pytest.approx(0.2 * 2.0**0.5)
    assert crossing([0.0, 0.1, math.inf, math.inf], 0.5, at) == pytest.approx(0.2 * 2.0**0.5)
    assert crossing([0.3, 0.1, 0.2, 0.1], 0.15, at) == 0.1
    assert crossing([0.0, 0.1, 0.1, 0.1], 0.15, at) is None


def test_a_map_has_a_contour_of_each_kind_at_each_frequency(small: Path, tmp_path: Path) -> None:
    """The block rocks from 0.2 g on: a fall is past every share of α, and where none moves nothing is."""
    (only,) = trust.run_trust(small, tmp_path / "map", ["pymunk"], coarse=True, quiet=True).maps
    assert {*only.contours} == {*CONTOURS}
    first = [only.contours[name][0] for name in ("peak_quarter", "peak_half")]
    assert all(only.cells[0]["amplitude_g"] < at <= only.cells[2]["amplitude_g"] for at in first if at is not None)
    assert None not in first


def test_a_lean_that_the_model_does_not_know_passes_no_contour(root: Path) -> None:
    """A pedestal that tips leaves the model's domain, and the statue stands; it was said to lean to half of its balance angle."""
    whole = Plane.of(load_scene(root / "scenes" / "paestum_block.toml"), "scene", coarse=True)
    ends: list[Any] = [("stands", 0.1), ("stands", None), ("stands", 0.4), ("overturned", None)]
    pairs = zip(ends, (0.1, 0.2, 0.4, 0.8), strict=True)
    cells: Any = [{"amplitude_g": at, "outcomes": {MODEL: end}, "peak_over_alpha": share} for (end, share), at in pairs]
    four = replace(whole, amplitudes_g=[0.1, 0.2, 0.4, 0.8])
    found = [contour(name, cells, four) for name in ("peak_quarter", "peak_half")]
    assert found == [[pytest.approx(0.2)], [pytest.approx(0.4 * 2.0**0.5)]]


def test_only_a_map_over_frequencies_speaks_of_every_frequency(root: Path) -> None:
    maps = invented_records.trust().maps
    for motion, spoken in (("scene", False), ("sine", True)):
        whole = Plane.of(load_scene(root / "scenes" / "paestum_block.toml"), motion, coarse=True)
        held = [each for each in answer_of(whole, ("analytic",), maps, {}).findings if each.code == "trust_up_to"]
        assert [("from_hz" in each.values) for each in held] == [spoken] * len(maps)


def test_what_a_pedestal_saves_is_told_by_the_model_that_knows_it_of_most_points(root: Path) -> None:
    maps, whole = (
        invented_records.trust().maps,
        Plane.of(load_scene(root / "scenes" / "paestum_block.toml"), "sine", coarse=True),
    )
    few, many = Saved(25, 0, 0, 0), Saved(51, 7, 4, 2)
    for saved, first in (({"analytic": few, "pymunk": many}, "pymunk"), ({"pymunk": few, "analytic": few}, "analytic")):
        told = [each for each in answer_of(whole, [*saved], maps, saved).findings if each.code == "pedestal_saves"]
        assert [each.values["model"] for each in told] == [first]


def test_a_model_s_outcome_is_that_of_its_own_run_or_of_rest() -> None:
    cell: Any = {"class": "outcome_confirmed", "basis": "between", "outcomes": {"analytic": "overturned"}}
    assert falls(cell, "analytic") is True
    assert falls(cell, "pymunk") is None, "what its neighbours say was counted as a condition"
    for end, known in (("overturned", True), ("stands", False), ("undecided", None)):
        assert (
            falls({**cell, "basis": "runs", "outcomes": {"analytic": "overturned", "pymunk": end}}, "pymunk") is known
        )
    assert falls({**cell, "basis": "rest", "outcomes": {"analytic": "stands"}}, "pymunk") is False


def test_the_map_s_picture_has_a_colour_and_a_name_for_each_class(small: Path, tmp_path: Path) -> None:
    folder = tmp_path / "map"
    called(small, "--out", folder, "--motion", "scene", "--json")
    record = read_result(folder)
    assert isinstance(record, TrustRecord)
    (only,) = record.maps
    assert {cell["frequency_hz"] for cell in only.cells} == {None}
    drawn = trust_map(only)
    shown = [kind_at(drawn, 0.0, cell["amplitude_g"]) for cell in only.cells]
    assert shown == [ENGLISH.word(cell["class"]) for cell in only.cells]
    key = drawn["layer"][0]["encoding"]["fill"]["scale"]["domain"]
    assert set(key) == set(shown)
    changed = replace(only, shares={**only.shares, "refuted": 0.5})
    assert trust_map(changed)["layer"][0]["encoding"]["fill"]["scale"]["domain"] == [*key, ENGLISH.word("refuted")]


def test_a_map_s_picture_has_its_contours_and_where_the_statue_falls_without_the_pedestal() -> None:
    own, floor = invented_records.trust().maps
    drawn = trust_map(own, floor, "rockcheck run a.toml")
    names = {part["name"] for key in ("border", "contours") for part in drawn["datasets"][key]}
    assert names == {ENGLISH.word(f"line_{name}") for name in (*CONTOURS, "border", "floor")}
    (line,) = [part for part in drawn["datasets"]["contours"] if part["name"] == ENGLISH.word("line_horizon")]
    # At the second frequency no strength passes it: the line has a gap there.
    assert (line["x"], line["y"]) == ([1.0, 2.0], [0.12, None])
    (tips,) = drawn["datasets"]["tips"]
    assert tips["more"] == ["rockcheck run a.toml --set motion.x.amplitude_g=0.1"] * len(tips["tip"])
    assert "more" not in trust_map(own)["datasets"]["tips"][0]
    # A point that is clicked opens its run in the chart of that name.
    figure = point_figure([own, floor])
    runs = {part["point"] for part in figure["datasets"]["runs"]}
    assert set(tips["point"][1:]) <= runs, "the first does not move"
    assert drawn["usermeta"]["opens"] == figure["params"][-1]["name"]
    still = [replace(own, cells=[{**cell, "paths": {"analytic": Rotation(4.0, [0.0, 0.0])}} for cell in own.cells])]
    assert point_figure(still) is None


def test_a_map_of_every_class_fits_the_terminal_and_its_page_names_each(tmp_path: Path) -> None:
    record = invented_records.trust().texted(ENGLISH.say)
    lines = record_lines(record)
    assert len(lines) < LINES
    assert max(map(len, lines)) <= COLUMNS
    assert record.answer.code == "refuted"
    assert record.answer.findings[0].severity is Severity.CHANGES_ANSWER
    html = write_report(invented_records.write_trust(tmp_path / "map")).read_text()
    assert 'class="verdict failed"' in html
    shares = ENGLISH.row([f"{ENGLISH.percent(0.125)} {ENGLISH(f'chart.on_{on}')}" for on in ("pedestal", "floor")])
    assert all(f"<dt>{ENGLISH.word(kind)}, {shares}</dt>" in html for kind in CLASSES)
