"""Pages of studies, validations, benches and stress runs say what their rows say."""

import itertools
import re
from collections.abc import Callable
from dataclasses import replace
from html import unescape
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from harness import Outcome, read_result
from harness.comparison.statistics import score_outcomes, wilson
from harness.model import Answer, caution, info, write_json
from harness.questions.study.study_record import answer_of, findings_of, score_sets
from harness.questions.validate.validation_run import answer_of as validation_answer
from harness.records.base import as_file, plain
from harness.records.bench import TOGETHER, BenchRecord, KnownFailure, Measure, PartRow, ScalingRow, StressRecord
from harness.records.bench import StabilityCell as Found
from harness.records.bench import answer_of as stress_answer
from harness.records.bench import findings_of as stress_findings
from harness.records.scores import Interval
from harness.records.study import StudyWitness, WitnessCount
from harness.records.validation import SetScores, ValidationRecord
from reports.blocks import Cell, Chart, Facts, Group, Table, Text, Verdict, verdict
from reports.messages import ENGLISH, language
from reports.pages import conservator
from reports.pages.bench_page import explanations, measured, on_front, precision_figure, scaling_figure
from reports.pages.page import page_blocks, write_report
from reports.pages.study_page import fragility_figure, map_figures, matrix, rose_picture
from reports.source import Answers, Condition
from tests.reports import invented_records, invented_study
from tests.reports.charts.parts import part
from tests.reports.invented_study import case_row, case_run
from tests.reports.page_parts import every, form, lines, rows
from tests.reports.pages.test_run_page import without_data
from tests.reports.svg_parts import elements


def shown(folder: Path) -> str:
    return without_data(write_report(folder).read_text(encoding="utf-8"))


def test_a_study_says_what_unmodified_engines_confirm(record_of: Callable[[str], Any]) -> None:
    record = record_of("map")
    counts = {"pymunk:plain": WitnessCount(confirmed=8, differ=1, silent=0)}
    parts = caution("witness_parts", witness="pymunk", models=["pymunk"], from_s=1.2, case=7)
    seen = StudyWitness(scenes=9, of=90, counts=counts, differing=[parts], seconds=1.0)
    told = [each for each in findings_of(replace(record, witness=seen)) if "witness" in each.code]
    assert [each.code for each in told] == ["study_witness", "study_witness_count", "witness_parts"]
    assert told[1].values == {"witness": "pymunk", "confirmed": 8, "differ": 1, "silent": 0}


def test_what_a_study_scatters_is_told_as_varied(record_of: Callable[[str], Any], tmp_path: Path) -> None:
    record, key = record_of("map"), "contact.floor_static"
    assert key not in record.vary
    facts = [pair for block in every(page_blocks(tmp_path, record), Facts) for pair in block.pairs]
    assert (ENGLISH.value(key, "key"), "0.97 to 1.04") in facts
    plain_words = " ".join(text for block in every(conservator.of_study(record), Verdict) for text in block.points)
    assert ENGLISH.key(key) in plain_words


def test_every_claim_and_model_has_its_computed_verdict(
    page_of: Callable[[str], Path], record_of: Callable[[str], Any]
) -> None:
    record, html = record_of("table"), without_data(page_of("table").read_text(encoding="utf-8"))
    assert len(re.findall(r'<td class="claim ', html)) == len(record.claims or ())
    for item in record.claims or ():
        assert ENGLISH.say(item.evidence) in unescape(html)


def test_the_headline_follows_the_claims(record_of: Callable[[str], Any]) -> None:
    record = record_of("table")
    record = replace(record, headline=dict.fromkeys(record.headline or (), "holds"))
    told = answer_of(record)
    assert (told.code, told.findings[0].values) == ("claims", {"groups": {"holds": [*(record.headline or ())]}})


def test_a_study_says_what_happens_before_how_often_its_models_agree(record_of: Callable[[str], Any]) -> None:
    found = record_of("map")
    keyed: Any = [SimpleNamespace(**vars(row), key="") for row in found.rows]
    record = replace(found, scores=score_sets(keyed))
    said = [(each.code, each.values["model"]) for each in answer_of(record).findings[:2]]
    assert said == [("overturns_in", "analytic (own)"), ("same_outcome", "pymunk")]
    rows = [
        replace(row, run=row.run and replace(row.run, outcome=Outcome.UNDECIDED)) if row.engine == "analytic" else row
        for row in found.rows
    ]
    told = answer_of(replace(record, rows=rows)).findings[0].values
    assert (told["model"], told["open"]) == ("pymunk (own)", None), "one that knows none of the falls told of them"


def test_the_matrix_marks_where_models_of_a_variant_differ(tmp_path: Path, record_of: Callable[[str], Any]) -> None:
    record = record_of("table")
    found = next(each for each in every(page_blocks(tmp_path, record), Table) if each.style == "matrix")
    assert len(found.rows) == 60
    keys = [[cell for cell in row[:4] if isinstance(cell, Cell)] for row in found.rows]
    assert {tuple(cell.text for cell in row[2:]) for row in keys if row[0].style == "differs"} == {("2", "none")}


def test_outside_its_domain_a_run_is_in_brackets_and_differs_from_none() -> None:
    tips = {"left_domain_s": 0.1, "left_domain_by": "pedestal_tips"}
    answers = {"analytic (own)": case_run(validity=tips), "pymunk (own)": case_run("overturned_left")}
    rows = {name: case_row(name.split()[0], run) for name, run in answers.items()}
    case = Condition({"motion.x.amplitude_g": 0.3}, rows)
    other = Condition({"motion.x.amplitude_g": 0.4})
    (varied, left, _), _ = matrix(Answers(list(rows), [case, other]), ENGLISH).rows
    assert isinstance(varied, Cell)
    assert isinstance(left, Cell)
    assert (varied.style, left.style) == ("", "o-other")
    assert left.sign.startswith("(")
    keys = ["motion.x.amplitude_g", "motion.x.frequency_hz"]
    grid = itertools.product((0.3, 0.4, 0.5), (1.0, 2.0, 3.0))
    places = [Condition(dict(zip(keys, place, strict=True)), rows) for place in grid]
    figures = map_figures(Answers(list(rows), places, keys))
    assert set(part(dict(figures)["analytic (own)"], "cells")["kind"]) == {ENGLISH("text.map_other")}


def test_a_map_shows_what_was_not_asked(written: Callable[[str], Path], record_of: Callable[[str], Any]) -> None:
    charts = {each.name: each.figure for each in every(page_blocks(written("map"), record_of("map")), Chart)}
    assert "not asked" not in part(charts["map-1"], "cells")["kind"]
    assert "not asked" in part(charts["map-2"], "cells")["kind"]
    assert charts["map-1"]["encoding"]["x"]["scale"]["type"] == "log"
    assert any(name.startswith("fragility") for name in charts)


def test_a_rose_gives_the_least_overturning_amplitude(record_of: Callable[[str], Any]) -> None:
    record = record_of("rose")
    drawn = rose_picture(Answers.of(record.rows))
    assert drawn is not None
    told = [str(each.text) for each in elements(drawn, "title")]
    assert [text.partition(", ")[2] for text in told if ", 0°" in text or ", 180°" in text] == [
        "0°: 0.600 g",
        "180°: 0.200 g",
    ]


def validation(folder: Path) -> ValidationRecord:
    record = read_result(folder)
    assert isinstance(record, ValidationRecord)
    return record


def test_a_validation_is_held_against_the_bare_threshold(tmp_path: Path) -> None:
    good = validation(invented_records.write_validation(tmp_path / "good", skill=1.0))
    told = validation_answer(good)
    assert (told.code, told.findings[-1].values["models"]) == ("better", ["analytic", "pymunk"])
    assert verdict(replace(good, answer=told)).tone == "agree"
    poor = validation(invented_records.write_validation(tmp_path / "poor", skill=0.5))
    told = validation_answer(poor)
    assert (told.code, told.findings[-1].values["models"]) == ("worse", ["analytic", "pymunk"])
    assert verdict(replace(poor, answer=told)).tone == "differ"
    html = shown(tmp_path / "good")
    assert html.count('class="o-stands"') == 120
    assert 'class="o-overturns"' not in html
    assert 'class="o-overturns"' in shown(tmp_path / "poor")


def test_models_that_are_right_equally_often_are_all_named(record_of: Callable[[str], Any]) -> None:
    record = record_of("validation")
    names = list(record.models)

    def with_accuracies(*values: float) -> ValidationRecord:
        models = {
            name: replace(item, outcomes=replace(item.outcomes, accuracy=Interval(value, 0.7, 0.9)))
            for (name, item), value in zip(record.models.items(), values, strict=True)
        }
        bare = replace(record.baseline.outcomes, accuracy=Interval(0.85, 0.75, 0.92))
        return replace(record, models=models, baseline=replace(record.baseline, outcomes=bare))

    tied = validation_answer(with_accuracies(0.8, 0.8))
    assert tied.code == "alike"
    assert tied.findings[0].values == {"alone": False, "models": names, "right": [0.8, 0.7, 0.9]}
    assert tied.findings[1].values["right"] == [0.85, 0.75, 0.92]
    best = validation_answer(with_accuracies(0.8, 0.81)).findings[0].values
    assert (best["alone"], best["models"]) == (True, names[1:])


def test_a_model_is_better_than_the_threshold_beyond_the_chance_in_both(record_of: Callable[[str], Any]) -> None:
    """13 and 8 of 24 tests: the model's interval leaves the threshold's share out, yet both overlap by half."""
    record = record_of("validation")
    model, bare = wilson(13, 24), wilson(8, 24)
    models = {
        name: replace(item, outcomes=replace(item.outcomes, accuracy=model)) for name, item in record.models.items()
    }
    outcomes = replace(record.baseline.outcomes, accuracy=bare)
    held = replace(record, models=models, baseline=replace(record.baseline, outcomes=outcomes))
    assert model.low > bare.value
    assert validation_answer(held).code == "alike"


def test_the_front_holds_what_nothing_beats() -> None:
    every_row = invented_records.bench_rows()
    front = [row for row in every_row if on_front(row, every_row)]
    assert {row.engine for row in front} == {"pymunk"}
    assert all(row.group == "level" for row in front)


def test_a_bench_names_who_meets_the_target_and_keeps_failures(page_of: Callable[[str], Path]) -> None:
    record = invented_records.bench()
    assert verdict(record).tone == "agree"
    assert "diverged" in without_data(page_of("bench").read_text(encoding="utf-8"))
    missed = replace(record, answer=Answer("not_met", [caution("no_engine_timed")]))
    assert verdict(missed).tone == "differ"


def test_a_stress_run_is_sound_or_says_what_is_wrong(tmp_path: Path) -> None:
    sound, wrong = (invented_records.stress(sound=sound) for sound in (True, False))
    invented_records.write_stress(tmp_path / "wrong", sound=False)
    assert (sound.answer and sound.answer.findings[0].values) == {"right": 2, "scenes": 2}
    assert verdict(wrong).tone == "failed"
    assert {"hard_scene_wrong", "cell_unexplained"} <= {each.code for each in wrong.findings}
    assert shown(tmp_path / "wrong").count('class="claim does-not-hold"') == 1


def test_runs_outside_the_models_domain_are_counted_by_cause(record_of: Callable[[str], Any]) -> None:
    rows = [
        invented_study.case_row(
            "analytic",
            invented_study.case_run(validity={"left_domain_by": cause, "left_domain_s": 0.5 if cause else None}),
        )
        for cause in ("statue_slides", "statue_slides", "pedestal_tips", "", None)
    ]
    record = record_of("map")
    (told,) = (each for each in findings_of(replace(record, rows=rows)) if each.code == "left_domain_in_runs")
    assert told.engine == "analytic (own)"
    assert told.values == {"left": 3, "cases": 5, "causes": {"statue_slides": 2, "pedestal_tips": 1}}
    fallen = {"outcome": "overturned_left", "no_return_time_s": 0.8}
    left = {"left_domain_by": "statue_slides", "left_domain_s": 1.8}
    # A statue that slides as it falls decides nothing any more.
    rows[3] = invented_study.case_row("analytic", invented_study.case_run(validity=left, **fallen))
    assert "left_domain_in_runs" not in [each.code for each in findings_of(replace(record, rows=rows[3:]))]


def test_runs_without_an_end_are_told_and_no_share_of_falls_counts_them_as_standing(
    record_of: Callable[[str], Any],
) -> None:
    ends = ("overturned_left", "stands", *["undecided"] * 10, *["overturned_left"] * 9)
    rows = [
        replace(
            invented_study.case_row("analytic", invented_study.case_run(end)),
            number=21 * k + place, varied={"motion.x.amplitude_g": level, "draw": float(place), "variant": "own"},
        )
        for k, level in enumerate((0.1, 0.2, 0.3)) for place, end in enumerate(ends)
    ]  # fmt: skip
    record = record_of("map")
    told = answer_of(replace(record, headline=None, scores=None, rows=rows)).findings[0]
    assert (told.values["falls"], told.values["cases"], told.values["open"]) == (30, 63, 30)
    whole = answer_of(replace(record, headline=None, scores=None, rows=rows[:2])).findings[0]
    assert whole.values["open"] is None
    figure = fragility_figure(Answers.of(rows), "motion.x.amplitude_g")
    assert figure is not None
    assert part(figure, "points")["y"] == [pytest.approx(10 / 11)] * 3


@pytest.mark.parametrize("levels", [(-0.1, -0.2, -0.3), (0.0, 0.2, 0.3)])
def test_a_shaking_is_as_strong_either_way_and_none_fits_nothing(levels: tuple[float, ...]) -> None:
    rows = [
        replace(
            invented_study.case_row("analytic", invented_study.case_run(end)),
            number=20 * k + place, varied={"motion.x.amplitude_g": level, "draw": float(place), "variant": "own"},
        )
        for k, level in enumerate(levels)
        for place, end in enumerate(["overturned_left"] * (5 * k) + ["stands"] * (20 - 5 * k))
    ]  # fmt: skip
    figure = fragility_figure(Answers.of(rows), "motion.x.amplitude_g")
    assert figure is not None
    assert part(figure, "points")["x"] == sorted(map(abs, levels))
    assert part(figure, "fits")["y"][-1] == pytest.approx(0.5, abs=0.2)


def test_findings_of_runs_that_differ_in_numbers_are_one(record_of: Callable[[str], Any]) -> None:
    found = [info("target_met_until_fall", until_s=value) for value in (1.5, 2.25)] + [info("motion_across_left_out")]
    rows = [invented_study.case_row("analytic", invented_study.case_run(findings=[plain(each)])) for each in found]
    record = record_of("map")
    told = {each.code: each for each in findings_of(replace(record, rows=rows))}
    assert told["target_met_until_fall"].values == {"until_s": 1.875, "in_runs": 2}
    assert told["motion_across_left_out"].values == {"in_runs": 1}


def test_a_number_that_some_runs_do_not_know_is_the_median_of_the_others(record_of: Callable[[str], Any]) -> None:
    found = [info("target_met_until_fall", until_s=value) for value in (None, 1.5, 2.25)]
    rows = [invented_study.case_row("analytic", invented_study.case_run(findings=[plain(each)])) for each in found]
    record = record_of("map")
    told = {each.code: each for each in findings_of(replace(record, rows=rows))}
    assert told["target_met_until_fall"].values == {"until_s": 1.875, "in_runs": 3}


def test_a_validation_says_how_to_repeat_it_and_how_far_histories_are_apart(
    tmp_path: Path, record_of: Callable[[str], Any]
) -> None:
    record = record_of("validation")
    found = page_blocks(tmp_path, replace(record, samples=3, seed=7))
    assert lines(found, "repeat") == ["rockcheck validate invented.csv -e analytic -e pymunk --samples 3 --seed 7"]
    histories = next(each for each in every(found, Group) if each.heading == ENGLISH("text.measured_histories"))
    told = str(histories.blocks)
    assert " 0.5" in told
    assert "−0.5" in told


def test_settings_of_one_engine_look_different() -> None:
    from reports.pages.validation_page import styles

    coarse, fine = styles({"pymunk@dt=0.001": "pymunk", "pymunk@dt=0.0005": "pymunk"}).values()
    assert coarse.colour == fine.colour
    assert coarse.dash != fine.dash


def test_a_bench_shows_what_skips_gain_and_what_the_target_takes(tmp_path: Path) -> None:
    found = page_blocks(tmp_path, invented_records.bench())
    skips = rows(found, ENGLISH("table.skips"))
    names = [TOGETHER, ENGLISH("skip.quiet_end"), ENGLISH("skip.quiet_start")]
    assert [row[0] for row in skips] == [
        f"{name}, {engine}" for name, engine in zip(names, ("analytic", "pymunk", "pymunk"), strict=True)
    ]
    texts = ["the same", "stands, without overturned_left, 1·10⁻⁷ rad apart", "no record here"]
    assert [row[-1] for row in skips] == texts
    choice = rows(found, ENGLISH("table.target", target="0.001"))
    assert choice[0][1:5] == ["3 of 3", "0.300", "1.20", "0.250"]
    assert choice[1][3:] == ["–", "–", "–", "–", "–"]


def test_a_stress_run_of_one_part_does_not_say_that_hard_scenes_come_out() -> None:
    left = PartRow("scenes", 0.0, 0, ["600 s at rest", "floor friction 0"])
    missing = {"pybullet": "no wheel here"}
    record = replace(invented_records.stress(), scenes=[], parts=[left], absent=missing)
    told = stress_answer(record)
    assert (told.code, verdict(replace(record, answer=told)).tone) == ("not_run", "differ")
    found = {each.code: each.values for each in stress_findings(record)}
    assert found["parts_left"] == {"parts": {"scenes": 2}}
    assert found["not_measured"] == {"what": "pybullet", "reason": "no wheel here"}


def test_a_known_failure_is_seen_on_the_page(tmp_path: Path) -> None:
    record = invented_records.stress()
    avoided = KnownFailure(1e-3, 3000, 1.0, [Measure("creep_rad", True, 1e-9, 1e-6, until_s=0.5)])
    creeps = {"pybullet": [Measure("creep_rad", False, 1e-5, 1e-6)]}
    scenes = [replace(record.scenes[0], known={"pybullet": avoided}, checks=creeps)]
    assert scenes[0].right("pybullet")
    assert not replace(scenes[0], known={}).right("pybullet")
    record = replace(record, scenes=scenes, command="rockcheck stress --quick")
    write_json(tmp_path / "result.json", as_file(record))
    page = without_data(write_report(tmp_path).read_text(encoding="utf-8"))
    assert f"{ENGLISH('text.known', name='pybullet').removeprefix('* ')}</summary>" in page
    assert form("text.more_iterations").search(page)["count"] == "3000"
    assert measured(avoided.checks[0], ENGLISH) in page
    assert "<code>rockcheck stress --quick</code>" in page


def test_a_run_that_is_compared_with_itself_stands_in_no_plot_and_on_no_front() -> None:
    rows = invented_records.bench_rows()
    best = min((row for row in rows if row.failed is None), key=lambda row: row.error_rad)
    itself = replace(best, error_rad=0.0, cpu_s=1e-9, label="itself")
    assert not on_front(itself, [*rows, itself])
    assert [on_front(row, [*rows, itself]) for row in rows] == [on_front(row, rows) for row in rows]
    drawn = precision_figure(best.scene, [*rows, itself], 1e-3)["datasets"]
    assert all(value > 0.0 for name in ("settings", "levels", "front") for line in drawn[name] for value in line["y"])
    assert not any("itself" in tip for line in drawn["settings"] for tip in line["tip"])


def test_scaling_is_one_plot_of_time_and_memory_with_a_table(tmp_path: Path) -> None:
    points = [
        ScalingRow(engine, quantity, value, 1e-3 * value, 50.0 + value)
        for engine, quantity in (("pymunk", "duration_s"), ("pymunk", "workers"), ("analytic", "runs"))
        for value in (2.0, 8.0)
    ]  # fmt: skip
    figure = scaling_figure(points)
    lines = figure["datasets"]["sizes"]
    assert [line["name"] for line in lines] == ["pymunk", "pymunk", "analytic"]
    assert all(line["x"] == [1.0, 4.0] for line in lines)
    assert (lines[0]["wall_s"], lines[0]["memory_mb"]) == ([2e-3, 8e-3], [52.0, 58.0])
    upright = [row["layer"][0]["encoding"]["y"] for row in figure["vconcat"]]
    assert [(each["field"], each["scale"]["type"]) for each in upright] == [("wall_s", "log"), ("memory_mb", "log")]
    assert all(row["encoding"]["x"]["scale"]["type"] == "log" for row in figure["vconcat"])
    write_json(tmp_path / "result.json", as_file(replace(invented_records.bench(), scaling=points)))
    (first, *_) = rows(page_blocks(tmp_path, read_result(tmp_path)), ENGLISH("table.scaling"))
    assert first == ["pymunk, duration [s]", "2.00", "0.00200", "52.0"]


def test_every_explanation_of_a_map_stands_below_it_once() -> None:
    cell = Found("pybullet", "1/60 s", "at rest", "inaccurate", remedy="step", stable="1 ms")
    cells = [
        cell, replace(cell, setting="1/240 s"), replace(cell, setting="1/120 s", remedy="iterations", stable="9000 it."),
        replace(cell, setting="1 ms", remedy=None), replace(cell, engine="pymunk", stable="another"),
    ]  # fmt: skip
    told = explanations("pybullet", cells, ENGLISH)
    assert [each.partition(": ")[0] for each in told] == ["at rest, 1/60 s; 1/240 s", "at rest, 1/120 s"]
    assert "1 ms" in told[0]
    assert "9000 it." in told[1]


def test_the_conservators_page_counts_as_the_terminal_does(tmp_path: Path, record_of: Callable[[str], Any]) -> None:
    """How often models end alike stands in the record once; rows may be a coarser grid."""
    given = record_of("table")
    scores = SetScores(
        reference="analytic", cases=1234, same=1201, outcomes=score_outcomes([]), verdicts={}, flips=0, peaks=None
    )
    said = conservator.blocks(tmp_path, replace(given, scores={"pymunk": scores}))
    told = [line for each in every(said, Text) for line in each.lines]
    assert ENGLISH("study.agree", count="Two", same=1201, total=1234) in told


def test_no_name_of_a_scene_or_a_skip_stands_in_english_on_an_italian_page(tmp_path: Path) -> None:
    stressed = invented_records.stress()
    hard = replace(stressed.scenes[0], note="a table that moves away at 0.1 g for 48 s, below every limit of rest")
    cells = [replace(cell, difficulty="at rest") for cell in stressed.cells]
    stressed = replace(stressed, title=StressRecord.title, scenes=[hard], cells=cells)
    timed = invented_records.bench()
    rows = [replace(row, scene="free rocking") for row in timed.rows]
    timed = replace(timed, title=BenchRecord.title, rows=rows)
    italian = language("it")
    for folder, record, words in (
        ("stress", stressed, (stressed.title, hard.name, hard.note, "at rest")),
        ("bench", timed, (timed.title, "free rocking", TOGETHER)),
    ):
        (tmp_path / folder).mkdir()
        write_json(tmp_path / folder / "result.json", as_file(record))
        page = unescape(without_data(write_report(tmp_path / folder, "it").read_text(encoding="utf-8")))
        for word in words:
            assert italian.word(word) in page
            assert f">{word}<" not in page
