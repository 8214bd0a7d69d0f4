"""The table of a trust map against a full grid: what it counts, and that rows are kept as they are."""

from __future__ import annotations

from pathlib import Path

from harness.records.trust import TrustClass
from tests.measures.pages import begin
from tests.measures.trust_grid import MODULE, ROWS, GridRow, plane_of, read, text, write


def row(grid: TrustClass, told: TrustClass, basis: str = "between") -> GridRow:
    return GridRow("floor", "analytic pymunk", 0.1, 2.0, grid, told, basis)


def test_points_of_another_class_are_counted_and_those_held_where_the_grid_refutes() -> None:
    rows = [row("confirmed", "confirmed", "runs")] * 7 + [row("refuted", "confirmed"), row("confirmed", "refuted")]
    cells = [cell.strip() for cell in text([*rows, row("probability", "confirmed")]).splitlines()[2].split("|")][1:-1]
    assert cells[2:5] == ["10", "7", "3 (30.0 %)"]
    assert cells[-1] == "1"


def test_rows_are_read_as_they_were_kept(tmp_path: Path) -> None:
    rows = [row("confirmed", "left_domain"), row("refuted", "refuted", "checked")]
    write(rows, tmp_path / "rows.csv")
    assert read(tmp_path / "rows.csv") == rows


def test_the_page_shows_the_table_of_the_rows_beside_it() -> None:
    page = ROWS.with_suffix(".md").read_text(encoding="utf-8")
    assert f"{begin(MODULE)}\n{text(read(ROWS))}\n" in page


def test_the_grid_is_the_plane_of_a_map() -> None:
    own, floor = plane_of("pedestal", 3), plane_of("floor", 3)
    assert own.amplitudes_g == floor.amplitudes_g == [0.05, 0.224, 1.0]
    assert (own.scene.pedestal is None, floor.scene.pedestal is None) == (False, True)
