"""Two answers scored: identical, spoilt, failed, without histories, from files."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from harness import InputError, Outcome, Verdict, compare, compare_files
from harness.input.history_file import resolution
from harness.model import to_plain
from reports.source import after_horizon_values
from tests import doubles
from tests.budgets_compare import IMPACT_S, PEAK_RAD, ROUNDING_REL, UPLIFT_S, WORK_PAIR_SAMPLES

ZERO_WHEN_PERFECT = (
    "rms_theta_rad",
    "largest_difference_rad",
    "rms_slip_m",
    "peak_time_difference_s",
    "residual_theta_difference_rad",
    "residual_slip_difference_m",
    "magnitude",
    "phase",
    "combined",
)


def test_identical_histories_score_perfect() -> None:
    history = doubles.rocking()
    scores = compare(history, history)
    assert history.t_s.size == WORK_PAIR_SAMPLES
    assert {name: getattr(scores, name) for name in ZERO_WHEN_PERFECT} == dict.fromkeys(ZERO_WHEN_PERFECT, 0.0)
    assert scores.peak_ratio == 1.0
    assert scores.coverage == 1.0
    assert scores.together_until_s == history.duration_s
    assert set(scores.impact_time_differences_s) == {0.0}
    assert scores.impact_energy_share_lost_a == scores.impact_energy_share_lost_b
    assert (scores.impacts_alone_a, scores.impacts_alone_b) == (0, 0)
    assert scores.verdict is Verdict.AGREE


def test_rest_against_rest_is_perfect() -> None:
    scores = compare(doubles.rest(), doubles.rest())
    assert scores.rms_theta_rad == 0.0
    assert scores.peak_ratio == 1.0
    assert scores.verdict is Verdict.AGREE


def test_each_double_is_told_by_its_own_score() -> None:
    history = doubles.rocking()
    later = compare(doubles.shifted(history, 0.004), history)
    larger = compare(doubles.scaled(history, 1.1), history)
    mirrored = compare(doubles.flipped(history), history)
    short = compare(doubles.truncated(history, 5.0), history)
    assert later.uplift_time_differences_s == pytest.approx([0.004], abs=UPLIFT_S)
    assert later.impact_time_differences_s == pytest.approx([0.004] * len(later.impact_times_a_s), abs=1e-6)
    assert later.peak_ratio == pytest.approx(1.0, abs=1e-4)
    assert larger.peak_ratio == pytest.approx(1.1, abs=PEAK_RAD)
    assert larger.impact_time_differences_s == pytest.approx([0.0] * len(larger.impact_times_a_s), abs=IMPACT_S)
    assert mirrored.phase == pytest.approx(1.0)
    assert mirrored.peak_ratio == pytest.approx(1.0, rel=ROUNDING_REL)
    assert short.coverage == pytest.approx(0.5, abs=1e-3)
    assert short.rms_theta_rad == 0.0
    assert short.verdict is Verdict.AGREE
    assert all(scores.verdict is Verdict.MODEL for scores in (later, larger, mirrored))


def test_combined_error_ranks_the_doubles() -> None:
    history = doubles.rocking()
    spoilt = [doubles.shifted(history, 0.002), doubles.shifted(history, 0.02), doubles.flipped(history)]
    combined = [compare(double, history).combined for double in spoilt]
    assert combined == sorted(combined, key=lambda value: value or 0.0)


def test_runs_bring_outcomes_and_no_return_times() -> None:
    history = doubles.rocking()
    a = doubles.run_of(history, "a", outcome=Outcome.OVERTURNED_LEFT, no_return_time_s=3.25)
    b = doubles.run_of(history, "b", outcome=Outcome.OVERTURNED_RIGHT, no_return_time_s=3.0)
    scores = compare(a, b)
    assert (scores.outcome_agrees, scores.side_agrees) == (True, False)
    assert scores.no_return_time_difference_s == 0.25
    assert scores.residual_theta_difference_rad is None
    assert (scores.a, scores.b) == ("a", "b")


def test_uncertainty_stands_beside_every_score() -> None:
    history = doubles.rocking()
    a = doubles.run_of(history, "a", numerical_uncertainty_rad=1e-4, reliable_until_s=10.0)
    b = doubles.run_of(history, "b", numerical_uncertainty_rad=3e-4, reliable_until_s=4.0)
    scores = compare(a, b)
    beside = scores.numerical_uncertainty
    assert beside["rms_theta_rad"] == pytest.approx(4e-4)
    assert (beside["peak_theta_a_rad"], beside["peak_theta_b_rad"]) == (1e-4, 3e-4)
    assert beside["peak_ratio"] == pytest.approx(4e-3)
    slowest = min(omega for _, end, _, omega in doubles.arcs(10.0, 0.1, 4.0, 0.9, 0.5) if end <= 4.0)
    assert beside["impact_times_a_s"] == pytest.approx(1e-4 / slowest)
    assert scores.horizon_s == 4.0


def test_scores_after_the_horizon_are_distributions() -> None:
    history = doubles.rocking()
    a = doubles.run_of(doubles.scaled(history, 1.2), "a", numerical_uncertainty_rad=1e-4, reliable_until_s=2.0)
    b = doubles.run_of(history, "b", numerical_uncertainty_rad=1e-4, reliable_until_s=2.0)
    scores = compare(a, b)
    after = scores.after_horizon
    peaks = [omega**2 / 8.0 for begin, _, _, omega in doubles.arcs(10.0, 0.1, 4.0, 0.9, 0.5) if begin > 2.0 - 1e-3]
    assert after.excursions_b == len(peaks)
    # Every value larger by a fifth: the area between the distributions is a fifth of the mean.
    assert after.peaks.area_rad == pytest.approx(0.2 * float(np.mean(peaks)), rel=1e-2)
    late = np.abs(history.theta_rad[history.t_s >= 2.0])
    assert after.rotation.area_rad == pytest.approx(0.2 * float(late.mean()), rel=1e-2)
    assert after.largest_a_rad == pytest.approx(1.2 * after.largest_b_rad, rel=1e-6)
    assert after.excursions_a == after.excursions_b == len(peaks)
    assert compare(history, history).after_horizon is None


def test_what_differs_only_beyond_the_horizon_moves_no_score_of_instants() -> None:
    """A run that goes wild after its horizon scores as perfect up to there; only the distributions tell."""
    history = doubles.rocking()
    wild = doubles.parted(history, 4.0, 0.05)
    known = {"numerical_uncertainty_rad": 1e-4, "reliable_until_s": 4.0}
    scores = compare(doubles.run_of(wild, "a", **known), doubles.run_of(history, "b", **known))
    touched = {"residual_theta_difference_rad", "residual_slip_difference_m"}
    for name in set(ZERO_WHEN_PERFECT) - touched:
        assert getattr(scores, name) == 0.0, name
    assert scores.compared_until_s == 4.0
    assert scores.peak_theta_a_rad == scores.peak_theta_b_rad
    assert set(scores.impact_time_differences_s) == {0.0}
    assert max(scores.impact_times_a_s) <= 4.0
    assert (scores.residual_theta_difference_rad, scores.residual_slip_difference_m) == (None, None)
    assert scores.verdict is Verdict.UNBOUNDED
    assert scores.after_horizon.last_difference_rad == pytest.approx(0.05 * 6.0)
    assert scores.after_horizon.largest_a_rad > 0.2


def test_a_difference_before_the_horizon_is_not_hidden_by_it() -> None:
    history = doubles.rocking()
    known = {"numerical_uncertainty_rad": 1e-4, "reliable_until_s": 4.0}
    early = doubles.run_of(doubles.parted(history, 3.0, 0.05), "a", **known)
    scores = compare(early, doubles.run_of(history, "b", **known))
    assert scores.largest_difference_rad == pytest.approx(0.05, rel=1e-9)
    assert scores.verdict is Verdict.MODEL


def test_many_excursions_after_the_horizon_stand_beside_chance() -> None:
    """Two samples of one population differ by no more than chance allows; one half as large again by more."""
    many = doubles.rocking(60.0, ratio=0.995)
    known = {"numerical_uncertainty_rad": 1e-4, "reliable_until_s": 1.0}
    same, larger = (
        compare(doubles.run_of(each, "a", **known), doubles.run_of(many, "b", **known)).after_horizon
        for each in (doubles.rocking(60.0, ratio=0.995, start_s=0.6), doubles.scaled(many, 1.5))
    )
    assert same.peaks.area_rad < same.peaks.area_by_chance_rad
    assert after_horizon_values(same)["kind"] == "chance"
    assert larger.peaks.area_rad > larger.peaks.area_by_chance_rad
    assert after_horizon_values(larger)["kind"] == "more"


def test_outcome_only_runs_are_compared_by_their_peaks() -> None:
    a = doubles.run_of(None, "a", peak_theta_rad=0.11, peak_time_s=2.0)
    b = doubles.run_of(None, "b", peak_theta_rad=0.10, peak_time_s=1.5)
    scores = compare(a, b)
    assert scores.peak_ratio == pytest.approx(1.1)
    assert scores.peak_time_difference_s == 0.5
    assert scores.rms_theta_rad is None
    assert scores.outcome_agrees is True
    assert scores.verdict is Verdict.MODEL


def test_a_failed_run_is_an_error_that_names_the_engine() -> None:
    failed = doubles.run_of(None, "pybullet", outcome=Outcome.CRASHED, message="segmentation fault")
    with pytest.raises(InputError, match=r"pybullet.*crashed.*segmentation fault"):
        compare(failed, doubles.run_of(doubles.rest(), "analytic"))


def test_a_run_whose_peak_is_no_number_is_an_error_that_names_the_engine() -> None:
    broken = doubles.run_of(None, "pymunk", peak_theta_rad=float("nan"))
    with pytest.raises(InputError, match=r"pymunk.*finite rotation"):
        compare(broken, doubles.run_of(doubles.rest(), "analytic"))


def test_files_of_other_software_are_compared(tmp_path: Path) -> None:
    history = doubles.rocking()
    history.write_csv(tmp_path / "mine.csv")
    rows = np.column_stack((history.t_s, 1.1 * history.theta_rad))
    np.savetxt(tmp_path / "theirs.csv", rows, delimiter=",", header="t_s,theta_rad", comments="")
    scores = compare_files(tmp_path / "theirs.csv", tmp_path / "mine.csv")
    assert scores.peak_ratio == pytest.approx(1.1, rel=1e-4)  # rates of the bare file are differences
    assert scores.a == "theirs.csv"
    json.dumps(to_plain(scores), allow_nan=False)


def test_files_of_one_name_are_told_apart_and_only_their_common_stretch_is_counted(tmp_path: Path) -> None:
    """What comes before one history begins, or after it ended, is missing from nothing."""
    whole = doubles.rocking()
    cut = (whole.t_s > 2.0) & (whole.t_s < 6.0)
    folders = tmp_path / "a", tmp_path / "b"
    for folder, rows in zip(folders, (np.ones_like(cut), cut), strict=True):
        folder.mkdir()
        columns = [whole.t_s[rows], whole.theta_rad[rows]]
        np.savetxt(folder / "history.csv", np.column_stack(columns), delimiter=",", header="t_s,theta_rad", comments="")
    scores = compare_files(*(folder / "history.csv" for folder in folders))
    assert (scores.a, scores.b) == tuple(str(folder / "history.csv") for folder in folders)
    assert len(scores.impact_times_a_s) > 3
    assert scores.impacts_alone_a == 0


def test_a_stated_error_of_files_decides_their_verdict(tmp_path: Path) -> None:
    history = doubles.rocking()
    history.write_csv(tmp_path / "mine.csv")
    doubles.raised(history, 1e-4).write_csv(tmp_path / "theirs.csv")
    files = tmp_path / "theirs.csv", tmp_path / "mine.csv"
    verdicts = {u: compare_files(*files, uncertainty_rad=u).verdict for u in (None, 1e-5, 1e-4)}
    assert verdicts == {None: Verdict.MODEL, 1e-5: Verdict.MODEL, 1e-4: Verdict.AGREE}
    assert compare_files(*files, uncertainty_rad=1e-4).numerical_uncertainty["rms_theta_rad"] == 2e-4
    doubles.rocking(slip_m=0.0101).write_csv(tmp_path / "theirs.csv")
    of_slip = {u: compare_files(*files, uncertainty_rad=1e-4, slip_uncertainty_m=u).verdict for u in (1e-5, 1e-4)}
    assert of_slip == {1e-5: Verdict.MODEL, 1e-4: Verdict.AGREE}
    with pytest.raises(InputError, match="--slip-uncertainty"):
        compare_files(*files, slip_uncertainty_m=math.nan)
    with pytest.raises(InputError, match="--uncertainty"):
        compare_files(*files, uncertainty_rad=-1.0)


@pytest.mark.parametrize("change", ["single precision", "every fifth sample"])
def test_neither_single_precision_nor_coarser_samples_are_another_model(tmp_path: Path, change: str) -> None:
    """With all digits written, what a narrower number or a longer step leaves open is still an error."""
    t_s = np.linspace(0.0, 5.0, 5001)
    theta = 0.1 * np.exp(-0.5 * t_s) * np.sin(6.0 * t_s)
    mine, every = (theta.astype(np.float32).astype(float), 1) if change == "single precision" else (theta, 5)
    for name, values, step in (("whole.csv", theta, 1), ("other.csv", mine, every), ("apart.csv", mine + 1e-4, every)):
        rows = np.column_stack((t_s, values))[::step]
        np.savetxt(tmp_path / name, rows, "%.17g", ",", header="t_s,theta_rad", comments="")
    scores = compare_files(tmp_path / "other.csv", tmp_path / "whole.csv")
    assert scores.verdict is Verdict.AGREE, scores.findings
    scores = compare_files(tmp_path / "apart.csv", tmp_path / "whole.csv")
    assert scores.verdict is Verdict.MODEL
    said = scores.findings[0]
    assert said.code == "pair_differs_unstated"
    assert said.values["difference_rad"] == pytest.approx(1e-4, rel=1e-2)


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A history of rocking and sliding with all its digits."""
    file = tmp_path_factory.mktemp("written") / "whole.csv"
    doubles.rocking(slip_m=0.0101).write_csv(file)
    return file


@pytest.mark.parametrize("kind", ["f", "g"])
@pytest.mark.parametrize("digits", [3, 4, 5])
@pytest.mark.parametrize(("unit", "factor"), [("rad", 1.0), ("deg", 180.0 / math.pi), ("mrad", 1e3)])
def test_a_rounded_copy_of_a_history_is_no_other_model(
    tmp_path: Path, written: Path, kind: str, digits: int, unit: str, factor: float
) -> None:
    history, form = doubles.rocking(slip_m=0.0101), f"%.{digits}{kind}"
    rows = np.column_stack((history.t_s, factor * history.theta_rad, 100.0 * history.slip_m))
    np.savetxt(
        tmp_path / "rounded.csv", rows, fmt=["%.6f", form, form], delimiter=",",
        header=f"t_s,theta_{unit},slip_cm", comments="",
    )  # fmt: skip
    scores = compare_files(tmp_path / "rounded.csv", written)
    assert scores.verdict is Verdict.AGREE, scores.findings
    counted = [each for each in scores.findings if each.code == "digits_counted"]
    assert "rounded.csv" in [each.values["model"] for each in counted]
    # What the digits do not hide is still seen.
    apart = 10.0 * scores.evidence.limit_rad
    doubles.raised(history, apart).write_csv(tmp_path / "other.csv")
    assert compare_files(tmp_path / "rounded.csv", tmp_path / "other.csv").verdict is Verdict.MODEL


@pytest.mark.parametrize("decimals", [3, 4])
def test_times_that_were_rounded_are_no_other_model(tmp_path: Path, decimals: int) -> None:
    history = doubles.rocking()
    t_s = history.t_s * (1.0 + 1.0 / 1024.0)
    for name, fmt in (("rounded.csv", f"%.{decimals}f"), ("whole.csv", "%.17g")):
        np.savetxt(tmp_path / name, np.column_stack((t_s, history.theta_rad)), fmt=[fmt, "%.17g"], delimiter=",",
                   header="t_s,theta_rad", comments="")  # fmt: skip
    scores = compare_files(tmp_path / "rounded.csv", tmp_path / "whole.csv")
    assert scores.verdict is Verdict.AGREE, scores.findings


@pytest.mark.parametrize(
    ("cells", "half"),
    [(("0.10", "0.20"), 0.005), (("0.1", "0.123"), 5e-4), (("12.3", "0.0123"), 0.05), (("1.5e-3", "2e-3"), 5e-5),
     (("0", "0"), 0.0), (("0.00", "0.0"), 0.005), (("100.5", "-3"), 0.05), (("0.000", "0.001"), 5e-4)],
)  # fmt: skip
def test_the_last_digit_written_is_a_columns_resolution(cells: tuple[str, ...], half: float) -> None:
    assert resolution(cells) == pytest.approx(half, rel=ROUNDING_REL)


def test_a_gap_in_a_file_is_told(tmp_path: Path) -> None:
    history = doubles.rocking()
    keep = (history.t_s < 0.6) | (history.t_s > 0.8)
    rows = np.column_stack((history.t_s, history.theta_rad))[keep]
    np.savetxt(tmp_path / "torn.csv", rows, delimiter=",", header="t_s,theta_rad", comments="")
    history.write_csv(tmp_path / "whole.csv")
    torn = compare_files(tmp_path / "torn.csv", tmp_path / "whole.csv").findings
    (told,) = [each.values for each in torn if each.code == "no_samples"]
    assert told == {"file": "torn.csv", "from_s": pytest.approx(0.599), "until_s": pytest.approx(0.801)}
    whole = compare_files(tmp_path / "whole.csv", tmp_path / "whole.csv").findings
    assert "no_samples" not in doubles.codes(whole)


@pytest.mark.parametrize(("text", "says"), [("t_s,theta_rad\n", "row"), ("t_s,theta_rad\n0,nan\n1,0\n", "finite")])
def test_an_empty_or_broken_file_is_an_error_that_names_it(tmp_path: Path, text: str, says: str) -> None:
    (tmp_path / "bad.csv").write_text(text)
    doubles.rest(1.0).write_csv(tmp_path / "good.csv")
    with pytest.raises(InputError, match=f"bad.csv.*{says}"):
        compare_files(tmp_path / "bad.csv", tmp_path / "good.csv")


def test_a_pair_costs_a_bounded_number_of_passes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Speed is held by counting: each history is searched for excursions once, and no sample is interpolated on equal grids."""
    from harness.comparison import comparator
    from harness.model import History

    counts = {"excursions": 0, "slip_at": 0}
    real = comparator.excursions_of

    def counted(history: object) -> object:
        counts["excursions"] += 1
        return real(history)  # type: ignore[arg-type]

    def refused(*_: object) -> None:
        counts["slip_at"] += 1

    monkeypatch.setattr(comparator, "excursions_of", counted)
    monkeypatch.setattr(History, "slip_at", refused)
    compare(doubles.rocking(), doubles.rocking(amplitude_rad=0.12))
    assert counts == {"excursions": 2, "slip_at": 0}
