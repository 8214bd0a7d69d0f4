"""The page of a run shows what its record holds, and nothing else."""

import json
import re
import shutil
from collections.abc import Callable
from dataclasses import replace
from html import unescape
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analytic import Harmonic
from harness import InputError, read_result
from harness.engines.stepping.loop import IMPOSED_LABEL
from harness.model import RUN_FIELDS, Pattern, Pedestal, caution, info, texted, write_json
from harness.questions.scene.scene_run import run_scene, write_result
from harness.records.base import plain
from harness.records.run import HorizonRecord
from reports import source as reading
from reports.blocks import owned
from reports.drawing.kinematics import MOST_FACES, read_mesh
from reports.drawing.pictures import BESIDE_CORNER, WIDTH, scene_svg
from reports.messages import ENGLISH, language
from reports.pages.conservator import of_run
from reports.pages.page import write_report
from reports.pages.run_page import chip, pattern_strip
from reports.source import RunSource, run_source, run_verdict
from tests.budgets_reports import DRAWN_RAD, PAGE_BYTES, PAGE_WORDS
from tests.reports.charts.parts import part
from tests.reports.invented_run import write_invented
from tests.reports.page_parts import form, lines
from tests.reports.unpacking import numbers, unpacked
from tests.scenes_for_tests import GRAVITY_M_S2, rectangle, scene

SQUARE_M = [[-0.5, 0.0], [0.5, 0.0], [0.5, 1.0], [-0.5, 1.0]]


@pytest.fixture(scope="module")
def folder(page_of: Callable[[str], Path]) -> Path:
    return page_of("run").parent


@pytest.fixture(scope="module")
def html(page_of: Callable[[str], Path]) -> str:
    return page_of("run").read_text(encoding="utf-8")


def without_data(html: str) -> str:
    return re.sub(r"<script.*?</script>", "", html, flags=re.S)


def test_an_italian_page_writes_its_numbers_with_a_comma(folder: Path, tmp_path: Path) -> None:
    """In sentences, tables, lists and the drawing of the scene; a scene's own text and versions stand as they are."""
    there = tmp_path / "run"
    shutil.copytree(folder, there)
    text = re.sub(r"<(script|style|pre).*?</\1>", "", write_report(there, "it").read_text(encoding="utf-8"), flags=re.S)
    below = text[text.index('id="outcomes"') : text.index('id="repeat"')]
    assert re.search(r"O <tspan[^>]*>α 0,\d+", below)
    assert not re.findall(r">([^<>]*\d\.\d[^<>]*)<", below)
    assert '<html lang="it">' in (there / "conservator.html").read_text(encoding="utf-8")


def figure_of(html: str) -> Any:
    found = re.search(r'data-chart="histories">(.*?)</script>', html, re.S)
    return json.loads(unpacked(found[1]))


def test_it_is_one_file_that_asks_for_nothing(html: str) -> None:
    assert len(html.encode()) < PAGE_BYTES
    shown = without_data(html)
    assert set(re.findall(r'(?:src|href)="((?!#|data:)[^"]*)', shown)) == {"conservator.html"}, "the page beside it"
    assert "url(http" not in shown
    assert "@import" not in shown


def test_the_verdict_comes_first(html: str) -> None:
    shown = without_data(html)
    places = [
        shown.index(f'id="{name}"')
        for name in ("verdict", "replay", "histories", "outcomes", "scene", "details", "repeat")
    ]
    assert places == sorted(places)


def words_beside_tables(html: str) -> list[str]:
    """The words that a page shows beside tables, lists of values, drawings, code and the choices of its replay."""
    for tag in ("style", "script", "noscript", "table", "dl", "svg", "pre", "select"):
        html = re.sub(rf"<{tag}\b.*?</{tag}>", " ", html, flags=re.S)
    return re.sub(r"<[^>]+>", " ", html[html.index("<body") :]).split()


def test_a_page_is_read_in_five_minutes_and_its_scores_are_folded(html: str) -> None:
    assert len(words_beside_tables(html)) <= PAGE_WORDS
    scores = html.partition('<details id="scores">')[2].partition("</details>")[0]
    assert scores.count("<tr") > 5
    for name in ("limits", "skips", "repeat"):
        assert f'<details id="{name}">' in html


def test_every_skip_and_reason_is_there(folder: Path, html: str) -> None:
    shown = unescape(without_data(html))
    record = run_source(folder).record
    for name, run in record.runs.items():
        assert name in shown
        for skip in run.skipped:
            assert ENGLISH.strings[f"skip.{skip}"] in shown
    assert all(ENGLISH.say(step.reason) in shown for step in record.plan)


def test_the_curves_are_the_recorded_histories(folder: Path, html: str) -> None:
    for name, history in run_source(folder).histories.items():
        columns = part(figure_of(html), "histories", name)
        t, theta = numbers(columns["t"]), numbers(columns["theta"])
        assert np.allclose(np.interp(t, history.t_s, history.theta_rad), theta, atol=1e-4, rtol=0.0)
        assert theta.max() == pytest.approx(history.theta_rad.max(), abs=DRAWN_RAD)
        assert theta.min() == pytest.approx(history.theta_rad.min(), abs=DRAWN_RAD)


def test_the_horizon_is_shaded_from_the_least_reliable_time(folder: Path, html: str) -> None:
    shaded = [layer for row in figure_of(html)["vconcat"] for layer in row["layer"] if layer["mark"]["type"] == "rect"]
    least = min(run.reliable_until_s for run in run_source(folder).runs.values())
    assert shaded
    assert {item["data"]["values"][0]["from"] for item in shaded} == {least}


def test_uncertainty_bands_have_the_recorded_width(html: str) -> None:
    sizes = [each["size"] for each in figure_of(html)["datasets"]["histories"]]
    assert sizes == [1e-10, 4e-4, 2e-3]
    band = next(layer for layer in figure_of(html)["vconcat"][0]["layer"] if layer["mark"]["type"] == "area")
    assert [step.get("calculate") for step in band["transform"]][1:] == [
        "datum.theta - datum.size",
        "datum.theta + datum.size",
    ]


def test_the_replay_holds_the_mesh_and_every_models_motion(folder: Path, html: str) -> None:
    found = re.search(r'id="replay-data">(.*?)</script>', html, re.S)
    payload = json.loads(unpacked(found[1]))
    assert payload["mesh"]["own"] is True
    mesh = run_source(folder).mesh
    assert mesh is not None
    assert len(payload["mesh"]["index"][0]["deltas"]) <= MOST_FACES < len(read_mesh(mesh)[1])
    assert max(numbers(column).max() for column in payload["mesh"]["index"]) < len(
        payload["mesh"]["positions"][0]["deltas"]
    )
    for model in payload["models"]:
        history = run_source(folder).histories[model["name"]]
        theta = numbers(model["frames"]["theta_rad"])
        assert model["end_s"] == history.t_s[-1]
        assert theta[-1] == pytest.approx(history.theta_rad[-1], abs=DRAWN_RAD)
        assert theta[100] == pytest.approx(np.interp(0.5, history.t_s, history.theta_rad), abs=DRAWN_RAD)


def test_writing_again_gives_the_same_page(folder: Path, html: str) -> None:
    assert write_report(folder).read_text(encoding="utf-8") == html


HORIZON = HorizonRecord(
    tolerance_rad=0.01,
    duration_s=10.0,
    perturbations=[1e-9],
    until_s=[5.0],
    growth_per_s=None,
    outcomes=[],
    failed=0,
    intrinsic_s=5.0,
)


def changed(folder: Path, **runs: dict[str, Any]) -> Any:
    """The source of a record with keys of its runs changed."""
    record = plain(read_result(folder))
    for name, changes in runs.items():
        record["runs"][name] |= changes
    write_json(folder / "result.json", record)
    return run_source(folder)


def test_a_run_alone_is_never_green_and_a_page_without_shaking_may_be(
    source: RunSource, written: Callable[[str], Path]
) -> None:
    assert run_verdict(source).tone == "differ", "shaken, and how probable a fall is was not computed"
    still = replace(source.record, motion=replace(source.record.motion, x_m_s2=None, y_m_s2=None, z_m_s2=None))
    assert run_verdict(replace(source, record=still)).tone == "agree"
    apart = run_verdict(run_source(written("apart")))
    assert apart.tone == "differ"
    assert apart.headline == source.record.answer.findings[0].text or "disagree" in apart.headline


def test_a_missed_target_is_no_horizon_of_prediction(tmp_path: Path) -> None:
    folder = write_invented(tmp_path)
    source = changed(folder, pymunk={"reliable_until_s": 6.0}, pybullet={"reliable_until_s": 4.6})
    assert not form("run.unpredictable").search(" ".join(lines(of_run(source), "basis")))
    record = plain(read_result(folder))
    write_json(folder / "result.json", record | {"horizons": {"analytic": plain(HORIZON)}})
    source = run_source(folder)
    assert ENGLISH("run.unpredictable", time="5") in " ".join(lines(of_run(source), "basis"))


def test_a_scene_without_pedestal_has_no_slip(page_of: Callable[[str], Path]) -> None:
    html = page_of("bare").read_text(encoding="utf-8")
    assert "slip u" not in json.dumps(figure_of(html))
    assert not any(f">{ENGLISH.label(each.name)}<" in html for each in RUN_FIELDS if "slip" in each.name)
    assert ENGLISH("text.no_pedestal") in without_data(html)


def test_a_body_that_leaves_its_support_is_not_said_to_slide_alone(source: RunSource) -> None:
    for flight_m, word in ((0.0, "statue_slides"), (0.15, "statue_off")):
        validity = {"statue_flight_m": flight_m}
        slides = [Pattern(0.0, 1.0, "statue_slides")]
        runs = {name: replace(run, validity=validity, patterns=slides) for name, run in source.runs.items()}
        drawn, *_ = pattern_strip(replace(source, record=replace(source.record, runs=runs)))
        assert drawn["kind"] == [ENGLISH(f"chart.pattern_{word}")]


def test_a_label_of_a_run_is_said_in_the_readers_language(source: RunSource) -> None:
    run = replace(source.runs["analytic"], labels=[IMPOSED_LABEL])
    said = [chip("analytic", ["analytic"], run, language(code)).labels for code in ("en", "it")]
    assert said == [[IMPOSED_LABEL], ["legge d'urto imposta"]]


def test_a_finding_of_a_pair_names_it_once() -> None:
    """Two causes of a difference stood below each other, and of which pairs was not told."""
    left_out = caution("motion_not_given", model="pymunk", axes=["y"])
    cause = caution("plane_cause", cause="the yaw", whole=True, until_s=1.0, share_without={"motion_across": 0.0})
    of_one = caution("motion_across_left_out")
    told = [
        owned(replace(each, engine=engine))
        for each, engine in zip(
            texted([left_out, cause, of_one], ENGLISH.say),
            ("pymunk_vs_pybullet", "pymunk_vs_pybullet", "pymunk"),
            strict=True,
        )
    ]
    assert [each.partition(" ")[0] + each.partition(": ")[0] for each in told][1:] == [
        "pymunkpymunk – pybullet",
        "pymunk:pymunk",
    ]
    assert told[0] == ENGLISH.say(left_out)


def test_the_angles_beside_a_squat_statue_stay_in_its_picture(source: RunSource) -> None:
    squat = replace(source.scene.statue, corner_left_m=0.5, corner_right_m=0.5, height_m=1.0, section_m=SQUARE_M)
    drawn = scene_svg(replace(source.scene, statue=squat, pedestal=None, wall=None), ENGLISH)
    corners = [float(x) for x in re.findall(r'cx="([\d.]+)"', drawn)]
    assert len(corners) == 2
    assert BESIDE_CORNER - 0.01 <= min(corners) < max(corners) <= WIDTH - BESIDE_CORNER + 0.01


def test_an_engine_that_failed_is_named_with_its_reason(tmp_path: Path) -> None:
    folder = write_invented(tmp_path)
    record = plain(read_result(folder))
    failed = dict(record["runs"]["pybullet"], outcome="unavailable", message="no wheels")
    record["runs"]["pybullet"] = failed | {"numerical_uncertainty_rad": None, "reliable_until_s": None}
    record["histories"].remove("pybullet")
    (folder / "history_pybullet.csv").unlink()
    write_json(folder / "result.json", record)
    html = without_data(write_report(folder).read_text(encoding="utf-8"))
    assert "not installed" in html


def test_a_folder_without_a_record_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"result\.json"):
        write_report(tmp_path)
    assert not (tmp_path / "report.html").exists()


def test_a_record_of_outcomes_alone_has_a_page_without_curves(tmp_path: Path) -> None:
    folder = write_invented(tmp_path)
    for path in folder.glob("history_*.csv"):
        path.unlink()
    write_json(folder / "result.json", plain(read_result(folder)) | {"histories": []})
    html = without_data(write_report(folder).read_text(encoding="utf-8"))
    assert "the statue stands" in html
    assert 'id="histories"' not in html
    assert 'id="replay"' not in html


def test_a_pedestal_that_tips_is_not_said_to_slide(tmp_path: Path) -> None:
    """Tall and narrow, on a floor that holds it: both lean by 0.11 rad as one."""
    narrow = Pedestal(100.0, 0.3, 0.5, 0.6)
    motion = Harmonic(0.6 * GRAVITY_M_S2, 2.0)
    on = scene(rectangle(0.25, 1.0), motion, pedestal=narrow, mu=1.0, mu_statue=2.0, duration_s=0.6)
    write_result(run_scene(on, ["pymunk"]), tmp_path / "run")
    source = run_source(tmp_path / "run")
    assert ENGLISH.say(info("pedestal_still")) in run_verdict(source).points
    (tilt_rad,) = (each.values["tilt_rad"] for each in reading._slip(source) if each.code == "pedestal_tilts")
    history = source.histories["pymunk"]
    until_s = source.runs["pymunk"].no_return_time_s or history.t_s[-1]
    most_rad = np.max(np.abs(history.extra["pedestal_tilt_rad"][history.t_s <= until_s]))
    assert tilt_rad == pytest.approx(most_rad, rel=DRAWN_RAD + 5e-3)
