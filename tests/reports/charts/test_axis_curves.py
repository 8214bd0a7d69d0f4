"""Where one axis of numbers varies, its curves hold each model's outcome, rotation and slip; two axes make a map instead."""

from harness.records.run import falls
from reports.charts.figure import Json
from reports.pages.study_page import curve_figures, design_figures
from reports.source import Answers, Condition
from tests.reports.charts.parts import part
from tests.reports.invented_study import case_row, case_run

MODEL, KEY, OTHER = "analytic (own)", "motion.x.amplitude_g", "motion.x.frequency_hz"


def condition(value: float, other: float = 1.0) -> Condition:
    falls = value > 0.35
    run = case_run("overturned_left" if falls else "stands", 1.5 if falls else value, peak_slip_m=0.01 * value)
    return Condition({KEY: value, OTHER: other}, {MODEL: case_row("analytic", run)})


def lines(figure: Json) -> list[Json]:
    """The marks of its lines."""
    return [layer["mark"] for row in figure["vconcat"] for layer in row["layer"] if layer["mark"]["type"] == "line"]


def test_one_axis_has_outcome_rotation_and_slip() -> None:
    cases = [condition(value) for value in (0.4, 0.2, 0.3)]
    ((words, figure),) = curve_figures(Answers([MODEL], cases, [KEY]))
    assert words == "By amplitude [g]"
    assert len(figure["vconcat"]) == 3
    runs = part(figure, "runs", MODEL)
    assert runs["x"] == [0.2, 0.3, 0.4]
    assert runs["outcome"] == ["stands", "stands", "overturns left"]
    assert runs["theta"] == [0.2, 0.3, None], "of a statue that falls no rotation is told"
    assert runs["slip"] == [2.0, 3.0, None]
    assert {each["orient"] for each in lines(figure)} == {"vertical"}, "from left to right, over an axis of names too"


def test_of_a_run_outside_its_domain_no_rotation_and_no_slip_are_drawn() -> None:
    """Its sign stood in brackets, and its rotation in the chart as any other."""
    slides = {"left_domain_s": 0.1, "left_domain_by": "statue_slides"}
    run = case_run("stands", 0.2, peak_slip_m=0.002, validity=slides)
    cases = [condition(0.3), condition(0.25), Condition({KEY: 0.2, OTHER: 1.0}, {MODEL: case_row("analytic", run)})]
    ((_, figure),) = curve_figures(Answers([MODEL], cases, [KEY]))
    runs = part(figure, "runs", MODEL)
    assert runs["outcome"] == ["(stands)", "stands", "stands"]
    assert (runs["theta"], runs["slip"]) == ([None, 0.25, 0.3], [None, 2.5, 3.0])
    assert falls(run) is None
    assert falls(case_run("stands", 0.2)) is False


def test_rounding_of_a_statue_at_rest_is_no_curve_and_no_map() -> None:
    """Charts of 3e-10 rad and 1e-6 mm filled their height, with axes of eleven decimals."""
    still = case_row("analytic", case_run("stands", 3e-10, peak_slip_m=1e-9))
    cases = [Condition({KEY: value, OTHER: other}, {MODEL: still}) for value in (1, 2, 3) for other in (1, 2, 3)]
    ((_, figure),) = curve_figures(Answers([MODEL], cases[::3], [KEY]))
    assert len(figure["vconcat"]) == 1
    assert design_figures(Answers([MODEL], cases, [OTHER, KEY])) == []


def test_draws_of_one_place_are_joined_by_no_line() -> None:
    ((_, figure),) = curve_figures(Answers([MODEL], [condition(value) for value in (0.2, 0.2, 0.3, 0.4)], [KEY]))
    assert not lines(figure)
    assert len(part(figure, "runs", MODEL)["x"]) == 4


def test_two_axes_make_a_map_and_no_curve() -> None:
    cases = [condition(value, other) for value in (0.2, 0.3, 0.4) for other in (1.0, 2.0, 3.0)]
    assert Answers([MODEL], cases, [KEY, OTHER]).plane == (OTHER, KEY)
    assert curve_figures(Answers([MODEL], cases, [KEY, OTHER])) == []


def test_two_values_beside_an_axis_are_a_chart_each() -> None:
    cases = [condition(value, other) for value in (0.2, 0.3, 0.4) for other in (1.0, 2.0 / 3.0)]
    assert [words for words, _ in curve_figures(Answers([MODEL], cases, [KEY, OTHER]))] == [
        "By amplitude [g] · frequency [Hz] 1", "By amplitude [g] · frequency [Hz] 0.6667",
    ]  # fmt: skip
