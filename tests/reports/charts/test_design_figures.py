"""A design map marks where the pedestal would tip, and names the design that slides least of those that hold."""

import re

from reports.messages import ENGLISH
from reports.pages.study_page import best_designs, design_figures
from reports.source import Answers, Condition
from tests.reports.charts.parts import kind_at, part
from tests.reports.invented_study import case_row, case_run

MODEL = "analytic (own)"
AXES = ("pedestal.width_m", "pedestal.height_m")


def condition(width_m: float, height_m: float, *, slip_m: float, stands: bool = True) -> Condition:
    # A pedestal tips where it is taller than wide.
    validity = {"pedestal_tipping_margin_m": width_m - height_m, "pedestal_tipping_margin_at_impact_m": 1.0}
    run = case_run("stands" if stands else "overturned_left", peak_slip_m=slip_m, validity=validity)
    return Condition({AXES[0]: width_m, AXES[1]: height_m}, {MODEL: case_row("analytic", run)})


def designs(cases: list[Condition], axes: tuple[str, str] = AXES) -> Answers:
    """These among further places of a map that nobody was asked."""
    further = [Condition(dict.fromkeys(axes, value)) for value in (1.0, 2.0, 3.0)]
    return Answers([MODEL], [*cases, *further], axes)


DESIGNS = [
    condition(0.4, 0.5, slip_m=0.001),
    condition(0.8, 0.5, slip_m=0.03),
    condition(0.8, 0.2, slip_m=0.02),
    condition(0.4, 0.2, slip_m=0.01, stands=False),
]


def test_the_best_design_stands_and_does_not_tip() -> None:
    (found,) = best_designs(designs(DESIGNS))
    assert found.code == "best_design"
    assert (found.values["good"], found.values["designs"], found.values["slip_m"]) == (2, 4, 0.02)
    assert found.values["at"] == dict(zip(AXES, (0.8, 0.2), strict=True))
    assert re.search("0.8\u00a0m .* 0.2\u00a0m", ENGLISH.say(found))


def test_none_of_several_designs_that_slide_alike_is_named_and_no_shaking_is_a_design() -> None:
    alike = [*DESIGNS, condition(0.8, 0.1, slip_m=0.0), condition(0.8, 0.3, slip_m=0.0)]
    (found,) = best_designs(designs(alike))
    assert (found.values["slip_m"], found.values["at"]) == (0.0, {})
    shaken = ("pedestal.width_m", "motion.x.amplitude_g")
    rows = [Condition(dict(zip(shaken, each.varied.values(), strict=True)), each.answers) for each in DESIGNS]
    assert best_designs(designs(rows, shaken)) == []


def test_where_no_design_holds_that_is_said() -> None:
    (found,) = best_designs(designs([DESIGNS[0], DESIGNS[3]]))
    assert (found.code, found.values["designs"]) == ("no_design_stands", 2)


def test_the_map_marks_the_places_that_tip() -> None:
    (_, peak), (_, slip) = design_figures(designs(DESIGNS))
    assert kind_at(peak, 0.4, 0.2) is None, "of a statue that falls no rotation is told"
    assert all(kind_at(peak, *place) is not None for place in ((0.8, 0.2), (0.4, 0.5), (0.8, 0.5)))
    told = {(x, y): tip for x, y, tip in zip(*(part(slip, "tips")[key] for key in ("x", "y", "tip")), strict=True)}
    assert [told[place].rpartition("\n")[2] for place in ((0.4, 0.2), (0.8, 0.2), (0.4, 0.5))] == [
        "10 mm",
        "20 mm",
        "1 mm",
    ]
    shades = [kind_at(slip, *place) for place in ((0.4, 0.5), (0.4, 0.2), (0.8, 0.2), (0.8, 0.5))]
    assert shades == sorted(shades, key=float), "the darker the larger"
    assert part(slip, "tipping") == {"x": [0.4], "y": [0.5]}
    assert "tipping" not in peak["datasets"]


def test_nothing_that_slides_makes_no_design_map() -> None:
    still = [condition(0.4, 0.2, slip_m=0.0), condition(0.8, 0.2, slip_m=0.0)]
    assert best_designs(designs(still)) == []
    ((words, _),) = design_figures(designs(still))
    assert words == ENGLISH("chart.map_peak", model=MODEL)
