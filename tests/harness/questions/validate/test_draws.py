"""What a draw's run is given and what is kept of it: fewer samples of its motion, an outcome and a peak."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from analytic.excitation import SampledAcceleration, ZeroExcitation
from harness import Outcome, RunOptions, simulate
from harness.questions.validate.scenes import (
    SHIFT_M,
    Drawn,
    Inputs,
    TrialVariant,
    asked_of,
    lost_draws,
    motion_of,
    parse_model,
    read_table,
    scene_of,
    thinned,
)
from harness.records.study import CaseRun
from harness.runs.runner import Crash
from tests.harness.questions.validate.experiments import variant, write_experiments
from tests.measures.invented_stones import write_shaking, write_tests

OUTCOME = RunOptions(history=False, stated=False)
STATED = TrialVariant(Inputs(), stated=True)


def shaking(tmp_path: Path, lines: int, seed: int) -> SampledAcceleration:
    write_shaking(tmp_path / "motion.csv", seed, lines)
    t_s, a = np.loadtxt(tmp_path / "motion.csv", delimiter=",", skiprows=1).T
    return SampledAcceleration(t_s, a)


@pytest.mark.parametrize("uneven", [False, True])
def test_fewer_samples_keep_the_displacement_all_along(tmp_path: Path, uneven: bool) -> None:
    record = shaking(tmp_path, 39_000, 3)
    if uneven:  # a logger that leaves out what it was too slow for
        kept = np.sort(np.random.default_rng(1).choice(39_000, 30_000, replace=False))
        record = SampledAcceleration(record.t_s[kept], record.samples_m_s2[kept])
    fewer = thinned(record)
    assert isinstance(fewer, SampledAcceleration)
    assert len(fewer.t_s) < len(record.t_s) / 4
    at = np.linspace(0.0, record.end_s + 2.0, 100_000)
    assert np.abs(fewer.displacement_m(at) - record.displacement_m(at)).max() < 1.5 * SHIFT_M
    assert (fewer.t_s[0], fewer.end_s) == (record.t_s[0], record.end_s)
    end = record.end_s
    assert fewer.velocity_m_s(end) == pytest.approx(record.velocity_m_s(end), abs=1e-12)
    assert fewer.displacement_m(end) == pytest.approx(record.displacement_m(end), abs=1e-10)


def test_a_record_without_a_sample_too_many_stays(tmp_path: Path) -> None:
    record = shaking(tmp_path, 500, 4)
    assert thinned(record) is record
    rest = ZeroExcitation()
    assert thinned(rest) is rest


def test_fewer_samples_change_no_probability(tmp_path: Path) -> None:
    """Of stones that rock for long some draws fall where they stood, and as many the other way (McNemar)."""
    path, inputs = write_tests(tmp_path, 3, 4, 39_000, seed=5)
    changed, more, fell = [], [], []
    for trial, true in zip(read_table(path), inputs, strict=True):
        own = replace(true, scale=1.6)
        motions = [motion_of(trial, own, fewer) for fewer in (True, False)]
        for sample in range(1, 61):
            scenes = (scene_of(trial, TrialVariant(own, sample), 0, motion) for motion in motions)
            few, all_ = (simulate(scene, "analytic", options=OUTCOME).outcome.overturned for scene in scenes)
            changed.append(few != all_)
            more.append(int(few) - int(all_))
            fell.append(all_)
    assert 0.1 < np.mean(fell) < 0.9
    assert abs(sum(more)) <= 3.0 * max(sum(changed), 1) ** 0.5


def test_draws_of_a_test_are_one_result_and_the_nominal_run_its_own(tmp_path: Path) -> None:
    trials = read_table(write_experiments(tmp_path, [2.0, 4.0]))
    pairs = [(trial, one) for trial in trials for one in (STATED, *(variant(trial, k) for k in range(1, 6)))]
    asked = asked_of(pairs, parse_model("analytic"), seed=0)
    assert [(each.trial.name, len(each.variants), each.task.runs) for each in asked] == [
        ("t0", 1, 1), ("t0", 5, 5), ("t1", 1, 1), ("t1", 5, 5),
    ]  # fmt: skip
    nominal, drawn = (dict(each.read(each.task.work(each.task.argument).record)) for each in asked[:2])
    assert isinstance(nominal["t0", STATED], CaseRun)
    for (name, one), run in drawn.items():
        assert isinstance(run, Drawn)
        alone = simulate(scene_of(trials[0], one), "analytic", options=OUTCOME)
        assert (name, run.outcome) == ("t0", alone.outcome)
        assert run.peak_theta_rad == pytest.approx(alone.peak_theta_rad, rel=0.02)
    # Of another engine each draw is a result: a worker that dies takes one with it.
    assert [each.task.runs for each in asked_of(pairs, parse_model("pybullet"), seed=0)] == [1] * 12


def test_other_draws_or_another_seed_are_other_results(tmp_path: Path) -> None:
    (trial,) = read_table(write_experiments(tmp_path, [2.0]))
    model = parse_model("analytic")

    def key(samples: int, seed: int) -> str:
        pairs = [(trial, variant(trial, k)) for k in range(1, samples + 1)]
        return asked_of(pairs, model, seed)[0].task.key

    assert len({key(5, 0), key(6, 0), key(5, 1), key(5, 0)}) == 3
    nominal = {asked_of([(trial, STATED)], model, seed)[0].task.key for seed in (0, 1)}
    assert len(nominal) == 1


def test_draws_whose_worker_died_say_so(tmp_path: Path) -> None:
    (trial,) = read_table(write_experiments(tmp_path, [2.0]))
    (each,) = asked_of([(trial, variant(trial, k)) for k in (1, 2)], parse_model("analytic"), seed=0)
    answer = lost_draws(each.task.argument, Crash("ended"))
    assert answer.failed == 2
    assert [run.outcome for _, run in each.read(answer.record)] == [Outcome.CRASHED] * 2
