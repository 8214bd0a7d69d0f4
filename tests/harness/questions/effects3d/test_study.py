"""A study of directions: its sides, effects, band and ledger, its mistakes, and a whole one resumed."""

import inspect
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from harness.model import Scene
from harness.questions.effects3d import (
    WORK,
    EffectsFile,
    Search,
    answers_of,
    checked_azimuths,
    effects,
    run_file,
    scan_directions,
    side_azimuths,
    static_rose,
)
from harness.records.effects3d import BASELINE, Amplitude
from harness.runs.runner import InlinePool

SEARCH = Search(most_g=1.0, resolution=0.02)


def test_sides_and_their_share_of_the_shaking(scene: Scene) -> None:
    assert side_azimuths(scene) == pytest.approx([0.0, 90.0, 180.0, 270.0])
    sides = [
        Amplitude(BASELINE, azimuth, "analytic", peak, 0.1, "", 1) for azimuth, peak in ((0.0, 0.25), (90.0, None))
    ]
    rows = {row.azimuth_deg: row for row in static_rose(scene, [0.0, 60.0, 180.0], sides)}
    assert rows[0.0].projected_g == pytest.approx(0.25)
    assert rows[60.0].projected_g == pytest.approx(0.5)
    assert rows[180.0].projected_g is None
    assert rows[60.0].lifts_g < rows[60.0].planar_lifts_g


def test_effects_are_changes_of_the_same_direction_and_engine() -> None:
    def row(condition: str, azimuth: float, peak: float | None) -> Amplitude:
        return Amplitude(condition, azimuth, "pybullet", peak, 0.1, "", 1)

    name = "centroid 3 % higher"
    rows = [row(BASELINE, a, p) for a, p in ((0.0, 0.2), (90.0, 0.4), (180.0, 0.5))]
    rows += [row(name, 0.0, 0.19), row(name, 90.0, 0.40), row(name, 180.0, None)]
    (found,) = effects(rows, [name])
    assert found.median == pytest.approx(-0.025)
    assert (found.least, found.largest) == (pytest.approx(-0.05), pytest.approx(0.0))
    assert found.flips == 1


def test_other_engines_are_asked_where_the_exact_model_doubts_and_where_the_plane_errs_most() -> None:
    exact, planar = {0.0: 0.2, 90.0: 0.4, 180.0: 0.3, 270.0: None}, {0.0: 0.2, 90.0: None, 180.0: 0.9, 270.0: 0.5}
    rows = [Amplitude(BASELINE, a, "spatial", p, 0.1, "", 1) for a, p in exact.items()]
    rows += [Amplitude(BASELINE, a, "analytic", p, p or 1.3, "", 1) for a, p in planar.items()]
    assert checked_azimuths(rows) == [90.0]
    rows[3] = replace(rows[3], doubt="undecided")
    assert checked_azimuths(rows) == [90.0, 270.0]
    assert checked_azimuths(rows[:3]) == []


@pytest.mark.parametrize(("up", "turn_deg", "said"), [
    ("z", 0.0, ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0])),
    ("z", 90.0, ([0.0, -1.0, 0.0], [1.0, 0.0, 0.0])),
    ("y", 0.0, ([1.0, 0.0, 0.0], [0.0, 0.0, -1.0])),
])  # fmt: skip
def test_directions_are_named_on_the_scan_as_its_file_has_it(
    scene: Scene, up: str, turn_deg: float, said: tuple[list[float], list[float]]
) -> None:
    turned = replace(scene, given={"statue": {"mesh": {"file": "scan.ply", "up": up, "azimuth_deg": turn_deg}}})
    found = scan_directions(turned).values
    assert (found["along_0"], found["along_90"]) == said


def test_each_engine_is_asked_what_the_one_before_leaves_open(scene: Scene) -> None:
    """No engine runs: the study's questions are answered by whoever is given."""
    asked: dict[tuple[str, str], list[float]] = {}

    def ask(kind: type, questions: Iterable[tuple[Any, ...]]) -> list[Amplitude]:
        found, questions = [], list(questions)
        for each in questions:  # whoever answers takes what is asked
            inspect.signature(WORK[kind][1]).bind(scene, *each)
        for condition, azimuth, engine, *_ in questions if kind is Amplitude else ():
            asked.setdefault((engine, condition), []).append(azimuth)
            # Towards 90° nothing overturns; towards 270° the plane errs most.
            peak = None if azimuth == 90.0 else 0.3 + 0.001 * azimuth * (engine == "analytic")
            found.append(Amplitude(condition, azimuth, engine, peak, 0.2, "", 3))
        return found

    name, shorter = "centroid 3 % higher", "half the time step"
    study = EffectsFile(
        kind="effects3d", title="rose", scene="scene.toml", directions=4, every=1, samples=0,
        engines=["pymunk", "analytic", "spatial"], conditions=[name, shorter, "base planed flat"],
    )  # fmt: skip
    found = answers_of(study, scene, ask)
    every = [0.0, 90.0, 180.0, 270.0]
    assert asked["spatial", BASELINE] == every
    assert asked["pymunk", BASELINE] == [270.0]
    assert asked["analytic", BASELINE] == [*every, *side_azimuths(scene)]
    # An amplitude is followed from the one found before; the exact model has no step, and the base is flat.
    assert asked["spatial", name] == asked["analytic", name] == [0.0, 180.0, 270.0]
    assert {condition for _, condition in asked} == {BASELINE, name}
    assert {*found["left_out"]} == {shorter, "base planed flat"}


def test_a_search_that_is_asked_twice_is_counted_once(
    root: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Directions across the sides of the base (0°, 90°, ...) are directions of the rose, too."""

    def stands(scene: Scene, condition: str, azimuth_deg: float, engine: str, *asked: object) -> Amplitude:
        return Amplitude(condition, azimuth_deg, engine, None, 0.5, "", runs=3)

    monkeypatch.setitem(WORK, Amplitude, ("search", stands))
    path = tmp_path / "effects.toml"
    path.write_text(
        f'kind = "effects3d"\ntitle = "rose"\nscene = "{root / "scenes" / "3d_effects_base.toml"}"\ndirections = 8\n'
        'engines = ["analytic", "spatial"]\nconditions = []\nsamples = 0\n'
    )
    for found in (0, 16):
        summary = run_file(path, tmp_path / "out", InlinePool()).summary
        assert (summary.asked, summary.found, summary.runs) == (16, found, 48)
