"""The page on the paper's forms is what the program computes, and its readings differ from one another."""

import pytest

from tests.measures import paper_forms
from tests.measures.pages import DOCS, renewed


@pytest.fixture(scope="module")
def tables() -> dict[str, str]:
    """Every table of the page, computed once."""
    return {name: make() for name, make in paper_forms.TABLES.items()}


@pytest.mark.parametrize("name", paper_forms.TABLES)
def test_the_page_in_the_documentation_shows_the_computed_table(tables: dict[str, str], name: str) -> None:
    page = (DOCS / paper_forms.PAGE).read_text(encoding="utf-8")
    command = f"{paper_forms.MODULE} {name}"
    assert renewed(page, command, tables[name]) == page, f"run `python -m {command}`"


def test_every_reading_stands_on_the_page(tables: dict[str, str]) -> None:
    computed = "\n\n".join(tables.values())
    for name, meaning, reading in paper_forms.READINGS[1:]:
        matters = any(reading is other for _, _, other in paper_forms.readings(pedestal=False))
        assert computed.count(f"| {name} | {meaning} |") == 1
        assert computed.count(f"| {name} | ") == 1 + matters
    left_out = {n for n, _, _ in paper_forms.READINGS} - {n for n, _, _ in paper_forms.readings(pedestal=False)}
    assert left_out == {"N = M g", "ratio", "u̇ unchanged", "slip at μ_k"}, "on the floor `ratio` is `paper`"


def test_a_reading_is_used_by_the_run() -> None:
    """Each reading gives another path with pedestal than the consistent one, in at least one case."""
    grid = [(a, f) for a, f, _ in paper_forms.cases(pedestal=True)]
    base = [paper_forms.run(paper_forms.CONSISTENT, a, f, pedestal=True).peak_theta_rad for a, f in grid]
    for name, _, reading in paper_forms.READINGS[1:]:
        peaks = [paper_forms.run(reading, a, f, pedestal=True).peak_theta_rad for a, f in grid]
        assert any(abs(a - b) > 1e-4 for a, b in zip(peaks, base, strict=True)), name


def test_only_prescribed_impacts_gain_energy() -> None:
    """The consistent form never raises the energy at an impact; the paper's does on its own cases."""
    grid = [(a, f) for a, f, _ in paper_forms.cases(pedestal=True)]
    assert sum(paper_forms.run(paper_forms.CONSISTENT, a, f, pedestal=True).energy_gained_j for a, f in grid) == 0.0
    assert sum(paper_forms.run(paper_forms.PAPER, a, f, pedestal=True).energy_gained_j for a, f in grid) > 0.0


def test_printed_signs_agree_with_the_model_where_they_are_right() -> None:
    """For θ < 0 the printed coupling is the corrected one: the two differ only where the pedestal slides against sgn θ."""
    lines = [line.split("|") for line in paper_forms.printed_signs().splitlines()[2:]]
    same = [cells[3].split("/")[0].strip() == cells[3].split("/")[1].strip() for cells in lines]
    assert same == [False, False, False, True]
    powers = [[float(x) for x in cells[5].split("/")] for cells in lines]
    assert all(corrected < 0.0 for _, corrected in powers)
    assert sum(printed > 0.0 for printed, _ in powers) == 2
