"""The survey of colours: a row is made of real pages, and a green page over a probable fall is counted."""

from __future__ import annotations

from pathlib import Path

from tests.measures.colours import DRAWS, PAGES, ColourRow, dangerous, text
from tests.measures.seeded_rows import measured


def invented(generator: str, seed: int) -> ColourRow:
    """Green on all pages but every third assessment; falls grow with the seed."""
    green = {page: page != "assess" or seed % 3 > 0 for page in PAGES}
    return ColourRow(generator, seed, green, seed * DRAWS // 100, 0, [False, None, seed > 5])


def test_green_pages_over_probable_falls_are_counted(tmp_path: Path) -> None:
    wanted = [("random", seed) for seed in range(10)]
    rows = measured(tmp_path / "rows.jsonl", ColourRow, wanted, invented)
    assert rows == measured(tmp_path / "rows.jsonl", ColourRow, wanted, invented), "rows that were kept"
    assert [item.seed for item in rows if dangerous(item)] == [6, 7, 8, 9], "5 of 100 is not shown to be more than 5 %"
    assert "| run | 10 | 10 | 9.0 % | 4 | 4 of 20 |" in text(rows)
    assert "| assess | 10 | 6 | 8.0 % | 2 | 2 of 12 |" in text(rows)
