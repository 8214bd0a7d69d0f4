"""The paper's claims are judged by what the rows say: rows made to hold, to fail and to hold for some."""

from __future__ import annotations

import itertools
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from harness import InputError, Outcome
from harness.engines.stepping.loop import IMPOSED_LABEL
from harness.questions.study import claims
from harness.questions.study.cases import load_study
from harness.records.study import StudyRow, Value
from tests import doubles
from tests.harness.questions.study.small_study import STUDY, written

FREQUENCIES = (1.5, 2.0, 3.0, 4.5, 6.0)


def row(
    frequency: float,
    pedestal: bool,
    peak: float,
    *,
    fell_s: float | None = None,
    slip: float | None = None,
    **more: Value,
) -> StudyRow:
    varied: dict[str, Value] = {
        "contact.restitution": 0.85,
        "motion.x.amplitude_g": 0.334,
        "motion.x.frequency_hz": frequency,
        "pedestal": "keep" if pedestal else "none",
        "variant": "own impact",
    }
    outcome = Outcome.STANDS if fell_s is None else Outcome.OVERTURNED_RIGHT
    slip_m = (0.01 if pedestal and frequency <= 3.0 else 0.0) if slip is None else slip
    run = doubles.case_run(outcome=outcome, peak_theta_rad=peak, no_return_time_s=fell_s, peak_slip_m=slip_m)
    run = replace(run, end_s=10.0, last_impact_s=9.9)
    return StudyRow(number=0, engine="analytic", reason="", varied=varied | more, run=run)


def with_run(row: StudyRow, **fields: Any) -> StudyRow:
    assert row.run is not None
    return replace(row, run=replace(row.run, **fields))


def paper_rows() -> list[StudyRow]:
    """What the paper describes: the floor's statue rotates more and falls at low frequency, and all fades."""
    found = []
    for frequency in FREQUENCIES:
        fell = 1.0 if frequency <= 2.0 else None
        found.append(row(frequency, False, 1.5 if fell else 0.4 / frequency, fell_s=fell))
        found.append(row(frequency, True, 0.3 / frequency))
    return found


def calm_rows() -> list[StudyRow]:
    """The same under a shaking that moves nothing."""
    return [row(f, pedestal, 0.0, **{"motion.x.amplitude_g": 0.01}) for f in FREQUENCIES for pedestal in (False, True)]


def verdicts(rows: list[StudyRow], top_m: float = 0.70) -> dict[str, claims.Verdict]:
    return {v.claim: v for v in claims.judge(rows, top_m)}


def test_rows_as_the_paper_describes_them_hold_every_claim() -> None:
    found = verdicts(paper_rows())
    assert {name for name, v in found.items() if v.verdict == "holds"} == {*found} - {"xi", "xii"}
    # On the pedestal nothing of these rows reaches the wall, and no impact was weighed.
    assert (found["xi"].verdict, found["xii"].verdict) == ("holds for some", claims.UNTESTED)
    assert claims.headline(list(found.values())) == {name: v.verdict for name, v in found.items()}


@pytest.mark.parametrize(
    ("claim", "change"),
    [
        ("i", {"peak_theta_rad": 0.5, "no_return_time_s": None, "outcome": Outcome.STANDS}),
        ("ii", {"no_return_time_s": 2.0, "outcome": Outcome.OVERTURNED_LEFT}),
        ("v", {"peak_slip_m": 0.2}),
        ("vii", {"peak_slip_m": 2e-3}),
        ("vii", {"peak_theta_rad": 5e-4}),
        ("viii", {"last_impact_s": 8.9}),
        ("viii", {"outcome": Outcome.OVERTURNED_LEFT, "no_return_time_s": 9.0}),
        ("ix", {"peak_theta_rad": 0.05}),
        ("xi", {"peak_theta_rad": 0.49, "outcome": Outcome.STANDS}),
    ],
)
def test_a_claim_fails_when_its_rows_say_otherwise(claim: str, change: dict[str, Any]) -> None:
    rows = [with_run(item, **change) for item in paper_rows()]
    assert verdicts(rows)[claim].verdict == "does not hold"


def test_an_advantage_that_grows_above_three_hertz_does_not_fade() -> None:
    rows = [row(f, False, 0.1 * f) for f in FREQUENCIES] + [row(f, True, 0.05) for f in FREQUENCIES]
    found = verdicts(rows)
    assert found["iii"].verdict == "does not hold"
    assert found["iv"].held == len(
        list(itertools.pairwise(FREQUENCIES))
    )  # only the pedestal's flat series does not rise


def test_the_walls_limit_wants_geometry_and_no_deeper_return() -> None:
    assert verdicts(paper_rows(), top_m=0.9)["vi"].verdict == "holds for some"
    deep = [*paper_rows(), row(1.0, True, 0.6)]
    assert verdicts(deep)["vi"].verdict == "holds for some"
    assert verdicts(deep, top_m=0.9)["vi"].verdict == "does not hold"


def test_models_of_a_variant_with_an_imposed_law_do_not_enter_the_headline() -> None:
    beside = [replace(r, varied={**r.varied, "variant": "one ratio"}) for r in paper_rows()]
    imposed = [replace(with_run(r, labels=[IMPOSED_LABEL]), engine="pymunk") for r in beside]
    judged = claims.judge([*imposed, *beside], 0.70)
    assert all(v.imposed for v in judged)
    assert set(claims.headline(judged).values()) == {claims.UNTESTED}
    assert not any(v.imposed for v in claims.judge(beside, 0.70))


def test_whether_rocking_lasts_is_not_judged_without_histories() -> None:
    """A run for its outcome alone lists no impacts: it was taken for one at rest."""
    rows = [with_run(item, last_impact_s=None) for item in paper_rows()]
    assert verdicts(rows)["viii"].verdict == claims.UNTESTED


def test_every_kind_of_motion_is_looked_for_at_the_wall() -> None:
    """Rocking alone, sliding alone and both: each counts once, by whether any of its conditions reaches the wall."""
    slid = row(1.5, True, 0.0, slip=0.3)
    reached = verdicts([row(1.5, False, 0.5), row(2.0, True, 0.6, slip=0.01), slid])["xi"]
    assert (reached.held, reached.cases) == (2, 3)
    assert reached.evidence.values["reached"]["sliding"] == [0, 1]


def test_a_part_without_a_case_is_not_tested() -> None:
    """Two kinds of motion that reach the wall are not every kind; a limit that nobody came back from is none."""
    rows = [row(1.5, False, 0.5), row(2.0, True, 0.6, slip=0.01)]
    reached = verdicts(rows)["xi"]
    assert (reached.held, reached.cases, reached.verdict) == (2, 2, "holds for some")
    assert list(reached.untested) == ["sliding"]
    all_kinds = verdicts([*rows, row(1.5, True, 0.6, slip=0.3)])["xi"]
    assert all_kinds.untested == reached.untested, "one that rocks too is no sliding alone"
    fallen = verdicts([row(1.5, False, 1.5, fell_s=1.0)])["vi"]
    assert (fallen.held, fallen.cases, fallen.verdict) == (1, 1, "holds for some")
    assert fallen.untested
    assert not verdicts(paper_rows())["vi"].untested


def test_where_nothing_overturns_nothing_can_be_prevented() -> None:
    standing = [row(1.5, False, 0.1), row(1.5, True, 0.05)]
    assert verdicts(standing)["ii"].verdict == claims.UNTESTED


def test_what_numerical_error_may_make_is_no_more_and_no_less() -> None:
    """A statue that does the same with and without its pedestal, to the last digits; and one at rest that trembles."""
    same = [row(f, pedestal, 0.1 / f - pedestal * 1e-17) for f in FREQUENCIES for pedestal in (False, True)]
    at_rest = [row(f, pedestal, 1e-6 * f) for f in FREQUENCIES for pedestal in (False, True)]
    judged = verdicts([with_run(item, numerical_uncertainty_rad=1e-6) for item in same])
    assert [judged[name].held for name in ("i", "iii", "iv", "ix")] == [0, 0, 8, 0]
    trembles = verdicts([with_run(item, numerical_uncertainty_rad=1e-3) for item in at_rest])
    assert [trembles[name].cases for name in ("i", "iii", "iv")] == [0, 0, 0], "at rest is no comparison"
    judged = verdicts([*paper_rows(), *calm_rows()])
    assert [judged[name].cases for name in ("i", "iii", "iv")] == [3, 1, 8]


def test_falls_that_numerical_error_may_part_are_sooner_for_neither() -> None:
    """An error of 1e-3 rad at 1.5 rad in a second is one of 0.67 ms in each fall."""

    def fall(pedestal: bool, fell_s: float, azimuth: float = 0.0) -> StudyRow:
        found = row(2.0, pedestal, 1.5, fell_s=fell_s, **{"statue.mesh.azimuth_deg": azimuth})
        return with_run(found, overturn_time_s=fell_s + 1.0, numerical_uncertainty_rad=1e-3)

    for apart_s, sooner in ((-0.001, 0), (0.0, 0), (0.001, 0), (0.0015, 1)):
        assert verdicts([fall(False, 1.0), fall(True, 1.0 + apart_s)])["i"].held == sooner
        (plane,) = claims.judge([fall(False, 1.0), fall(False, 1.0 - apart_s, 60.0)], 0.70, "planes")
        assert plane.held == 1 - sooner


@pytest.mark.parametrize("cause", ["pedestal_tips", "statue_slides"])
def test_a_run_outside_its_domain_answers_no_claim(cause: str) -> None:
    """Held upright, a pedestal that tips has its statue stand."""
    tips = {"left_domain_s": 0.1, "left_domain_by": cause}
    held = with_run(row(1.5, True, 0.1), validity=tips)
    found = verdicts([row(1.5, False, 1.5, fell_s=1.0), held])
    assert [found[name].cases for name in ("i", "ii", "iv", "v", "ix")] == [0] * 5


@pytest.mark.parametrize("end", [Outcome.UNDECIDED, Outcome.TOUCHES_WALL])
def test_a_run_without_an_end_was_not_kept_from_falling(end: Outcome) -> None:
    """Nor did it fall."""
    open_end = with_run(row(1.5, True, 0.4), outcome=end)
    assert verdicts([row(1.5, False, 1.5, fell_s=1.0), open_end])["ii"].verdict == claims.UNTESTED


def weighed(ratio: float, frequency: float, loss_j: float) -> StudyRow:
    return with_run(row(frequency, False, 0.1, **{"contact.restitution": ratio}), impact_loss_j=loss_j)


@pytest.mark.parametrize(
    ("losses", "verdict"),
    [
        ((9.0, 8.0, 7.0), "holds"),
        ((9.0, 8.0, 8.5), "holds for some"),
        ((7.0, 8.0, 9.0), "does not hold"),
        ((8.0, 8.0, 8.0), claims.UNTESTED),  # the model's own impact: the same run under each ratio
    ],
)
def test_the_loss_of_an_impact_is_compared_over_the_ratio(losses: tuple[float, ...], verdict: str) -> None:
    rows = [weighed(r, 2.0, loss) for r, loss in zip((0.85, 0.875, 0.9), losses, strict=True)]
    judged = verdicts([*rows, weighed(0.85, 3.0, 20.0)])["xii"]  # alone at its frequency: nothing to compare
    assert judged.verdict == verdict


def test_the_weakest_plane_is_the_one_in_which_every_motion_does_most() -> None:
    def plane(azimuth: float, peak: float, fell_s: float | None = None) -> StudyRow:
        return row(2.0, False, peak, fell_s=fell_s, **{"statue.mesh.azimuth_deg": azimuth})

    def verdict(*rows: StudyRow) -> str:
        (judged,) = claims.judge(rows, 0.70, "planes")
        return judged.verdict

    assert verdict(plane(0.0, 1.5, 1.0), plane(60.0, 1.5, 2.0), plane(90.0, 0.1)) == "holds"
    assert verdict(plane(0.0, 0.2), plane(60.0, 1.5, 2.0), plane(90.0, 0.1)) == "holds for some"
    assert verdict(plane(0.0, 0.2), plane(90.0, 0.3)) == "does not hold"
    assert verdict(plane(0.0, 0.2)) == claims.UNTESTED
    assert verdict(plane(0.0, 0.0), plane(90.0, 1e-5)) == claims.UNTESTED, "two at rest are no comparison"


def test_pedestals_of_two_masses_are_each_compared_with_the_floor() -> None:
    """Whatever else varies belongs to the condition: here the mass, and (iii) and (iv) follow one mass over frequency."""
    masses = (1.0, 2.0)
    rows = [replace(item, varied={**item.varied, "pedestal.mass_kg": mass}) for item in paper_rows() for mass in masses]
    judged = {v.claim: v for v in claims.judge(rows, 0.70, "pedestal")}
    assert "vi" not in judged
    assert (judged["i"].cases, judged["iii"].cases, judged["iv"].cases) == (6, 2, 16)


def test_a_run_that_failed_answers_no_claim() -> None:
    """An engine that is not installed turned nothing and slid nowhere: that is no evidence."""
    absent = [replace(with_run(r, outcome=Outcome.UNAVAILABLE), engine="pybullet") for r in paper_rows()]
    assert {v.model for v in claims.judge([*paper_rows(), *absent], 0.70)} == {"analytic (own impact)"}


@pytest.mark.parametrize(
    ("claims", "old", "new", "key"),
    [
        ("pedestal", "motion.x.frequency_hz", "motion.x.phase_deg", "motion.x.frequency_hz"),
        ("pedestal", "start = 1.0\nstop = 4.0\ncount = 5", 'values = ["keep", 2.0]', "motion.x.frequency_hz"),
        ("planes", "", "", "statue.mesh.azimuth_deg"),
        ("paper", "values = [0.85, 0.9]", 'values = ["momentum", 0.9]', "contact.restitution"),
    ],
)
def test_claims_that_compare_what_is_not_varied_are_refused(
    tmp_path: Path, claims: str, old: str, new: str, key: str
) -> None:
    path = written(tmp_path, f'claims = "{claims}"\n' + STUDY.replace(old, new))
    with pytest.raises(InputError) as refused:
        load_study(path)
    assert [mistake.key for mistake in refused.value.mistakes] == ["claims"]
    assert refused.value.mistakes[0].wanted.startswith(key)
