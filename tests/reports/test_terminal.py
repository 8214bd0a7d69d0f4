"""What a run prints fits a terminal: at most 16 lines of at most 100 columns; `--verbose` prints every finding."""

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from harness import Outcome, RunRecord
from harness.input.motions.inspect import inspect_file
from harness.model import caution, changes_answer, info, texted
from harness.records.scores import Verdict
from reports.messages import ENGLISH
from reports.terminal import COLUMNS, LINES, motion_lines, record_lines, table


@pytest.fixture(scope="module")
def record(record_of: Callable[[str], Any]) -> RunRecord:
    return record_of("apart")


def printed(record: RunRecord) -> list[str]:
    """All lines, that of the report's path among them."""
    return [*record_lines(record), "report: out/run/report.html"]


def test_title_answer_engines_and_pairs_stand_in_this_order(record: RunRecord) -> None:
    lines = printed(record)
    assert lines[0] == record.title
    assert record.answer.text.startswith(lines[1][:40])
    rows = [line.split()[0] for line in lines if line.startswith("  ")]
    assert rows[: 1 + len(record.runs)] == ["engine", *record.runs]
    assert len(lines) <= LINES


def test_a_stand_that_a_model_does_not_follow_is_counted_as_no_stand(record_of: Callable[[str], Any]) -> None:
    map_of, tips = record_of("map"), {"left_domain_s": 0.1, "left_domain_by": "pedestal_tips"}
    rows = [replace(row, run=row.run and replace(row.run, validity=tips, no_return_time_s=None)) for row in map_of.rows]
    for found, stands in ((map_of, True), (replace(map_of, rows=rows), False)):
        (heading,) = [line for line in record_lines(found) if line.split()[:1] == ["model"]]
        assert (ENGLISH("ends.stands") in heading) == stands
        assert (ENGLISH("ends.other") in heading) != stands


@pytest.mark.parametrize(("models", "further"), [(5, ""), (6, "1 further model "), (7, "2 further models ")])
def test_models_that_are_not_shown_are_counted(record_of: Callable[[str], Any], models: int, further: str) -> None:
    map_of = record_of("map")
    rows = [replace(row, engine=f"m{k % models}") for k, row in enumerate(map_of.rows)]
    found = [line.strip() for line in record_lines(replace(map_of, rows=rows)) if "further model" in line]
    assert found == ([f"{further}(--verbose)"] if further else [])


def test_many_findings_engines_and_long_names_still_fit(record: RunRecord) -> None:
    many = [caution("engine_failed", outcome=f"{k}", message="long " * 60) for k in range(30)]
    heavy = [changes_answer("near_tie", margin=1e-4).of("analytic")]
    runs = {**record.runs, **{f"{name}:plain": run for name, run in record.runs.items()}}
    pair = record.scores["analytic_vs_pymunk"]
    scores = {**record.scores, **{f"{name}_vs_{name}:plain": pair for name in record.runs}}
    long = replace(record, title="x" * 300, findings=[*record.findings, *many, *heavy], runs=runs, scores=scores)
    lines = printed(long.texted(ENGLISH.say))
    assert len(lines) <= LINES
    assert max(map(len, lines)) <= COLUMNS
    assert sum("further finding" in line for line in lines) == 1
    few = printed(replace(long, runs=record.runs, scores=record.scores).texted(ENGLISH.say))
    assert any(ENGLISH.say(heavy[0])[:30] in line for line in few), "the heaviest finding is shown first"


def test_a_line_that_is_a_little_too_long_loses_no_number() -> None:
    cells = ["x" * 30, "y" * 30, "z" * 24, "0.00054 s"]
    (line,) = table([cells])
    assert len(line) <= COLUMNS
    assert line.split() == [*cells[:3], "0.00054", "s"]
    assert table([cells[:2]]) == [f"  {cells[0]}  {cells[1]}"]


def test_verbose_prints_every_finding_by_severity(record: RunRecord) -> None:
    light, heavy = info("histories_agree"), changes_answer("near_tie", margin=1e-4)
    said = replace(record, findings=[light, heavy])
    text = " ".join(record_lines(said.texted(ENGLISH.say), verbose=True))
    assert text.index(ENGLISH.say(heavy)) < text.index(ENGLISH.say(light))


def test_a_peak_of_a_fall_and_of_a_failure_is_not_told(record: RunRecord, tmp_path: Path) -> None:
    lines = record_lines(record)
    row = next(line for line in lines if line.lstrip().startswith("pybullet"))
    assert "overturns right at" in row
    assert " rad to " in row
    failed = replace(record.runs["pybullet"], outcome=Outcome.UNAVAILABLE, message="no wheels")
    row = next(
        line
        for line in record_lines(replace(record, runs={**record.runs, "pybullet": failed}))
        if line.lstrip().startswith("pybullet")
    )
    assert "not installed" in row
    assert "rad" not in row


def test_what_a_run_took_of_the_processor_is_told(record: RunRecord) -> None:
    """Not of the clock, which a busy machine stretches; of a run that a store kept it is not known."""
    own = record.runs["analytic"]
    for cpu_s, told in ((0.25, "0.25 s"), (None, "–")):
        found = replace(record, runs={**record.runs, "analytic": replace(own, cpu_s=cpu_s, wall_s=7.5)})
        line = next(line for line in record_lines(found) if line.startswith("  analytic  "))
        assert line.endswith(f"  {told}")


def test_a_motion_of_many_findings_fits(data_dir: Path) -> None:
    found = inspect_file(data_dir / "records" / "20161113_110259_WTMC_20.V2A.gz")
    many = texted(
        [*found.findings, *(caution("record_flat", channel=f"C{k}", lasts_s=0.2) for k in range(9))], ENGLISH.say
    )
    lines = [*motion_lines(found, many), "picture: out/quake/motion.png"]
    assert found.source["unit"] in lines[0]
    assert len(lines) <= LINES
    assert max(map(len, lines)) <= COLUMNS
    assert sum("further finding" in line for line in lines) == 1
    whole = motion_lines(found, many, verbose=True)
    assert all(any(each.text.replace("\u00a0", " ")[:60] in line for line in whole) for each in many)


def test_an_outcome_outside_the_models_domain_stands_in_brackets(record: RunRecord) -> None:
    tips = {"left_domain_s": 0.5, "left_domain_by": "pedestal_tips"}
    own = record.runs["analytic"]
    for validity, told in ((own.validity, "  analytic  stands "), ({**own.validity, **tips}, "  analytic  (stands) ")):
        run = replace(own, outcome=Outcome.STANDS, no_return_time_s=None, validity=validity)
        lines = record_lines(replace(record, runs={**record.runs, "analytic": run}))
        line = next(line for line in lines if line.startswith(told))
        assert bool(re.search(r"\([\d.]+ [cm]?m\)", line)) is (validity is not own.validity)


@pytest.mark.parametrize(
    ("verdict", "times", "told"),
    [
        (Verdict.MODEL, {"exceeded_s": 1.25}, "from 1.25 s"),
        (Verdict.HORIZON, {"exceeded_s": 3.0, "horizon_s": 2.5}, "until 2.50 s"),
        (Verdict.DOMAIN, {"left_domain_s": 0.75}, "from 0.750 s"),
        (Verdict.UNBOUNDED, {}, "bounded"),
    ],
)
def test_a_pair_that_differs_says_from_or_until_when(
    record: RunRecord, verdict: Verdict, times: dict[str, float], told: str
) -> None:
    name, pair = next(iter(record.scores.items()))
    unknown = {"exceeded_s": None, "horizon_s": None, "left_domain_s": None}
    differs = replace(pair, verdict=verdict, evidence=replace(pair.evidence, **(unknown | times)))
    lines = record_lines(replace(record, scores={**record.scores, name: differs}))
    (row,) = [line for line in lines if line.startswith(f"  {pair.a} – {pair.b}")]
    assert row.endswith(told)
