"""A study's pages count every variant and model, and tell the supports of all its cases, not those of its scene."""

import json
import re
from pathlib import Path
from typing import Any

import pytest

from harness.questions.study.cases import base_of, expand, load_study
from harness.records.base import as_file
from reports.cli import studies
from reports.messages import ENGLISH
from reports.pages.conservator import blocks
from reports.pages.page import write_report
from reports.pages.study_page import study_verdict
from reports.source import Answers, doubted
from tests.reports.claim_scenes import content, write_scene
from tests.reports.invented_study import study as study_record
from tests.reports.page_parts import answer, form, pictures

VARIED = """
title = "two keys"
scene = "scene.toml"
[[vary]]
key = "motion.x.amplitude_g"
values = [0.05, 0.2, 0.3, 0.4]
[[vary]]
key = "{key}"
values = {values}
{also}
"""
SLIPPERY_AND_ROUGH = """
[[variant]]
name = "slippery [/]"
engines = ["analytic"]
set = { "contact.floor_static" = 0.2, "contact.floor_kinetic" = 0.1 }
[[variant]]
name = "=rough"
engines = ["analytic"]
set = { "contact.floor_static" = 0.6, "contact.floor_kinetic" = 0.5 }
"""
ONE = """
[[variant]]
name = "own"
engines = ["analytic"]
"""
STUDIES = {
    "frictions by variant": ("motion.x.frequency_hz", "[1.5, 3.0]", "", SLIPPERY_AND_ROUGH),
    "with and without": ("pedestal", '["none", "keep"]', "", ONE),
    "friction and what follows": (
        "contact.floor_kinetic",
        "[0.05, 0.3]",
        'also = { "contact.floor_static" = 1.5 }',
        ONE,
    ),
    "the statue": ("statue.corner_right_m", "[0.05, 0.2]", "", ONE),
    "under the statue": ("contact.statue", "[0.04, 0.3]", "", ONE),
    "statue and pedestal": ("pedestal", '["none", "keep"]', "", SLIPPERY_AND_ROUGH),
}


@pytest.fixture(scope="module", params=STUDIES)
def study(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """The study's file and its result folder, run by the analytic model."""
    key, values, also, variants = STUDIES[request.param]
    folder = tmp_path_factory.mktemp("study")
    write_scene(folder, content(0) | standing())
    path = folder / "study.toml"
    path.write_text(VARIED.format(key=key, values=values, also=also) + variants, encoding="utf-8")
    studies.run(path, folder / "out", jobs=1, quiet=True)
    write_report(folder / "out")
    return path, folder / "out"


def standing() -> dict[str, Any]:
    """A block on its pedestal under a harmonic motion: it stands at the least amplitude tried and may fall at the others."""
    mass, h, left, right = 700.0, 0.77, 0.35, 0.1
    statue = {"mass_kg": mass, "centroid_height_m": h, "corner_left_m": left, "corner_right_m": right, "depth_m": 0.7}
    inertia = {"inertia_kg_m2": mass * ((left + right) ** 2 + 4.0 * h * h) / 12.0, "height_m": 2.0 * h}
    return {
        "statue": statue | inertia,
        "pedestal": {"mass_kg": 250.0, "width_m": 0.8, "depth_m": 0.8, "height_m": 0.2},
        "contact": {"floor_static": 0.25, "floor_kinetic": 0.2, "statue": 1.0},
        "motion": {"x": {"kind": "harmonic", "amplitude_g": 0.3, "frequency_hz": 1.5}},
    }


def test_falls_are_counted_in_every_variant_and_colour_the_page(study: tuple[Path, Path]) -> None:
    record = study_record(study[1])
    said = answer(blocks(study[1], record))
    falls: dict[str, list[bool]] = {}
    for row in record.rows:
        # Outside the model's domain it is not known how it ends.
        fell = row.run.outcome.startswith("overturned") and not doubted(row.run)
        falls.setdefault(row.varied["variant"], []).append(fell)
    counts = sorted({sum(each) for each in falls.values()})
    asked = len(next(iter(falls.values())))
    told = form("study.falls" if len(counts) == 1 else "study.falls_between").match(said.headline)
    assert list(map(int, told.groups()[:-1] if len(counts) > 1 else told.groups())) == [
        *dict.fromkeys((counts[0], counts[-1])),
        asked,
    ]
    for variant, each in falls.items():
        again = ENGLISH("study.by_variant", variant=variant, falls=sum(each), total=len(each), more="").rstrip(".")
        assert any(again in point for point in said.points) is (len(falls) > 1), "of one variant the headline says it"
    left = any(doubted(row.run) for row in record.rows)
    assert (ENGLISH("study.more_outside", count="").strip() in said.headline) is left
    assert said.tone != "agree"
    assert study_verdict(record, Answers.of(record.rows, record.vary), ENGLISH).tone != "agree", (
        "it holds no probability of a fall"
    )


def test_a_shaking_is_called_borne_where_no_model_falls_in_any_variant(study: tuple[Path, Path]) -> None:
    record = study_record(study[1])
    said = " ".join(answer(blocks(study[1], record)).points)
    levels: dict[float, set[str]] = {}
    for row in record.rows:
        ends = levels.setdefault(row.varied["motion.x.amplitude_g"], set())
        ends.add("outside" if doubted(row.run) else row.run.outcome)
    borne = [level for level in levels if all(levels[low] == {"stands"} for low in levels if low <= level)]
    match = form("study.borne").search(said)
    assert bool(match) is bool(borne)
    if match is not None:
        assert float(form("study.level_weight").match(match["level"])["push"].removesuffix(" %")) == pytest.approx(
            100.0 * max(borne)
        )


def test_the_supports_told_are_those_of_all_cases(study: tuple[Path, Path]) -> None:
    record = study_record(study[1])
    file = load_study(study[0])
    base = base_of(file, study[0])
    scenes = [base.scene(case.setting) for case in expand(file, base)]
    floors = [scene.contact.floor_static for scene in scenes if scene.pedestal is not None]
    told = record.supports
    assert told.floor_static == pytest.approx([min(floors), max(floors)])
    assert told.statue == (min(s.contact.statue for s in scenes), max(s.contact.statue for s in scenes))
    assert told.pedestal == sorted({scene.pedestal is not None for scene in scenes})
    words = " ".join(text for item in pictures(blocks(study[1], record)) for text in item.caption)
    slips = {
        scene.contact.statue if scene.pedestal is None else min(scene.contact.floor_static, scene.contact.statue)
        for scene in scenes
    }
    for slip in (min(slips), max(slips)):
        assert slip >= 1.0 or f" {100.0 * slip:.2g} %" in words, slip
    assert (ENGLISH("order.study") in words) is (told.pedestal == [True])
    assert bool(form("push.varied").search(words)) is bool(told.statue_keys)


def test_what_the_pedestal_changes_is_told_without_a_frequency_too(study: tuple[Path, Path]) -> None:
    record = study_record(study[1])
    words = " ".join(text for item in pictures(blocks(study[1], record)) for text in item.caption)
    assert bool(form("study.saved").search(words)) is ("pedestal" in record.vary)


def test_no_warning_of_a_study_leaves_numbers_out(study: tuple[Path, Path]) -> None:
    page = (study[1] / "report.html").read_text(encoding="utf-8")
    warnings = re.findall(r'<ul class="warnings">(.*?)</ul>', page, re.S)
    assert "…" not in "".join(warnings)


def test_a_study_is_read_as_it_was_written(study: tuple[Path, Path]) -> None:
    content = json.loads((study[1] / "result.json").read_text(encoding="utf-8"))
    assert as_file(study_record(study[1])) == {key: value for key, value in content.items() if key != "seal"}
