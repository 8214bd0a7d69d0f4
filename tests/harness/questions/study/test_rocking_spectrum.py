"""A rocking spectrum: each block as by itself, probabilities counted, map and page written, mistakes told."""

import csv
import json
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from analytic import Block, Form, simulate
from harness import InputError, read_result
from harness.comparison.statistics import wilson
from harness.input.tables import read_model
from harness.questions.study.rocking_spectrum import RING_DOWN_S, SpectrumFile, compute, motions_of, run_file
from harness.records.study import RockingSpectrumRecord
from harness.runs.execute import silent
from harness.runs.runner import LocalPool
from reports.cli import app
from reports.messages import ENGLISH
from reports.pages.study_page import spectrum_verdict
from tests import budgets_assess as budget
from tests.harness.questions.validate.experiments import write_motion

FILE = """
kind = "rocking_spectrum"
title = "Two bursts"
size_m = {{ start = 0.4, stop = 2.0, count = {sizes}, spacing = "log" }}
slenderness = {{ start = 3.0, stop = 9.0, count = {shapes} }}
{more}
[[motion]]
file = "weak.csv"
column = "table"
unit = "m/s2"
[[motion]]
file = "strong.csv"
column = "table"
unit = "m/s2"
"""


def written(folder: Path, sizes: int = 4, shapes: int = 5, more: str = "") -> Path:
    write_motion(folder / "weak.csv", amplitude_m_s2=2.0, frequency_hz=1.5)
    write_motion(folder / "strong.csv", amplitude_m_s2=5.0, frequency_hz=1.5)
    path = folder / "bursts.toml"
    path.write_text(FILE.format(sizes=sizes, shapes=shapes, more=more))
    return path


def test_every_block_is_what_it_is_by_itself(tmp_path: Path) -> None:
    """Against single runs of a rectangle of sides 2R sin α and 2R cos α: fallen of two motions, and the lower of both peaks."""
    path = written(tmp_path)
    spectrum = read_model(SpectrumFile, path)
    excitations = motions_of(spectrum, path)
    answer = compute(spectrum, excitations, threads=1)
    assert answer.cases == 2
    for i, size in enumerate(spectrum.size_m.values()):
        for j, slenderness in enumerate(spectrum.slenderness.values()):
            alpha = np.arctan(1.0 / slenderness)
            block = Block.rectangle(width_m=2.0 * size * np.sin(alpha), height_m=2.0 * size * np.cos(alpha))
            runs = [simulate(block, item, duration_s=item.end_s + RING_DOWN_S) for item in excitations]
            fell = [run.outcome.startswith("overturned") for run in runs]
            assert answer.probability[i, j] == np.mean(fell)
            peaks = [np.inf if down else abs(run.peak_theta_rad) / alpha for run, down in zip(runs, fell, strict=True)]
            assert answer.median[i, j] == pytest.approx(min(peaks), rel=budget.SWEPT_REL)
            assert answer.high[i, j] == pytest.approx(max(peaks), rel=budget.SWEPT_REL)
    assert 0.0 < answer.probability.mean() < 1.0


def test_a_ratio_given_as_a_number_is_each_block_s(tmp_path: Path) -> None:
    """It ended in a traceback."""
    path = written(tmp_path, more="restitution = 0.9")
    spectrum = read_model(SpectrumFile, path)
    (motion, *_) = motions_of(spectrum, path)
    answer = compute(spectrum, [motion], threads=1)
    for i, j in np.ndindex(answer.median.shape):
        size, alpha = spectrum.size_m.values()[i], np.arctan(1.0 / spectrum.slenderness.values()[j])
        block = Block.rectangle(width_m=2.0 * size * np.sin(alpha), height_m=2.0 * size * np.cos(alpha))
        run = simulate(block, motion, duration_s=motion.end_s + RING_DOWN_S, form=Form(restitution=0.9))
        peak = np.inf if run.outcome.startswith("overturned") else abs(run.peak_theta_rad) / alpha
        assert answer.median[i, j] == pytest.approx(peak, rel=budget.SWEPT_REL)


def test_a_drawn_strength_makes_a_probability_of_one_motion(tmp_path: Path) -> None:
    path = written(tmp_path, more="draws = 20\nstrength_cov = 0.3")
    spectrum = read_model(SpectrumFile, path)
    excitations = motions_of(spectrum, path)[1:]
    answer = compute(spectrum, excitations, threads=1)
    factors = np.exp(np.sqrt(np.log1p(0.09)) * np.random.default_rng(0).standard_normal(20))
    each = [
        compute(read_model(SpectrumFile, written(tmp_path)), [excitations[0].scaled(f)], threads=1) for f in factors
    ]
    assert answer.probability.tolist() == np.mean([item.probability for item in each], axis=0).tolist()
    assert np.any((answer.probability > 0.0) & (answer.probability < 1.0))


def test_the_command_writes_page_record_and_map(tmp_path: Path) -> None:
    path = written(tmp_path)
    path.write_text(path.read_text().replace('"weak.csv"', '"weak.csv"\npga_g = 0.2'))
    answer = CliRunner().invoke(app, ["study", str(path), "-j", "1", "--out", str(tmp_path / "out")])
    assert answer.exit_code == 0, answer.output
    assert "40 runs" in answer.output
    record = json.loads((tmp_path / "out" / "result.json").read_text(encoding="utf-8"))
    assert record["motions"][0]["pga_g"] == pytest.approx(0.2, rel=1e-12), "in the g in which it was asked"
    with (tmp_path / "out" / "spectrum.csv").open(newline="", encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == 4 * 5
    shares = [float(row["probability_overturned"]) for row in rows]
    assert shares == [p for line in record["probability_overturned"] for p in line]
    for row in rows:
        assert float(row["low"]) <= float(row["probability_overturned"]) <= float(row["high"])
        # Both motions overturn it: it has no median.
        assert (row["peak_median_over_alpha"] == "") == (row["probability_overturned"] == "1.0")
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert ENGLISH("text.spectrum_falls") in page
    assert "weak.csv" in page
    assert "<code>rockcheck study bursts.toml</code>" in page
    answered = read_result(tmp_path / "out")
    assert isinstance(answered, RockingSpectrumRecord)
    for fell, cases in ((0, 2), (0, 20), (0, 100), (4, 100), (6, 100), (49, 100), (1, 1)):
        shares = [[0.0] * 5] * 3 + [[0.0, fell / cases, 0.0, 0.0, 0.0]]
        green = (
            spectrum_verdict(replace(answered, probability_overturned=shares, cases=cases, undecided=0.0)).tone
            == "agree"
        )
        interval = wilson(fell, cases, 0.9)
        assert green == (fell / cases <= 0.05 and interval.high < 0.10), (fell, cases)


def test_a_motion_that_was_asked_by_its_peak_velocity_has_it(tmp_path: Path) -> None:
    """The peak of a short burst in a long record was passed over."""
    path = written(tmp_path, sizes=2, shapes=2)
    t_s = np.arange(0.0, 60.0, 0.01)
    burst = np.where(np.abs(t_s - 30.0) < 0.03, np.sin(100.0 * (t_s - 30.0)), 0.0)
    rows = [f"{t:.2f},{a:.9f}" for t, a in zip(t_s, burst, strict=True)]
    (tmp_path / "weak.csv").write_text("\n".join(["t_s,table", *rows]))
    path.write_text(path.read_text().replace('"weak.csv"', '"weak.csv"\npgv_m_s = 0.01'))
    with closing(LocalPool(1)) as pool:
        record = run_file(path, tmp_path / "out", pool, silent)
    assert record.motions[0].pgv_m_s == pytest.approx(0.01, rel=1e-4)


@pytest.mark.parametrize(
    ("more", "says"),
    [
        ("draws = 5", "draws and strength_cov together"),
        ('restitution = "plastic"', "restitution"),
        ("frictions = 0.3", "frictions"),
    ],
)
def test_a_wrong_file_is_told_and_nothing_written(tmp_path: Path, more: str, says: str) -> None:
    path = written(tmp_path, more=more)
    answer = CliRunner().invoke(app, ["study", str(path), "--out", str(tmp_path / "out")])
    assert isinstance(answer.exception, InputError)
    assert says in str(answer.exception)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("option", [["--resume"], ["--dask", "local"], ["--export", "x.csv"], ["--witness"]])
def test_options_of_other_studies_are_refused(tmp_path: Path, option: list[str]) -> None:
    answer = CliRunner().invoke(app, ["study", str(written(tmp_path)), *option, "--out", str(tmp_path / "out")])
    assert isinstance(answer.exception, InputError)
    assert option[0] in str(answer.exception)


def test_every_lost_motion_is_told_at_once(tmp_path: Path) -> None:
    path = written(tmp_path)
    for name in ("weak.csv", "strong.csv"):
        (tmp_path / name).write_text("t_s,table\n0,0\n")
    with pytest.raises(InputError) as caught:
        motions_of(read_model(SpectrumFile, path), path)
    assert all(name in str(caught.value) for name in ("weak.csv", "strong.csv"))
