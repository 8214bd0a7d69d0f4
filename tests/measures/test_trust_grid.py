"""The table of a trust map against a full grid: what it counts, and that rows are kept as they are."""

from tests.measures.pages import begin
from tests.measures.trust_grid import MODULE, ROWS, plane_of, read, text


def test_the_page_shows_the_table_of_the_rows_beside_it() -> None:
    page = ROWS.with_suffix(".md").read_text(encoding="utf-8")
    assert f"{begin(MODULE)}\n{text(read(ROWS))}\n" in page


def test_the_grid_is_the_plane_of_a_map() -> None:
    own, floor = plane_of("pedestal", 3), plane_of("floor", 3)
    assert own.amplitudes_g == floor.amplitudes_g == [0.05, 0.224, 1.0]
    assert (own.scene.pedestal is None, floor.scene.pedestal is None) == (False, True)
