"""The calibration of probabilities: rows kept and read again, the diagram, and the table that the page shows."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tests.measures.calibration import CalibrationRow, diagram, row_of, shaken, text
from tests.measures.pages import begin
from tests.measures.seeded_rows import measured

SEED = 780_000


def test_rows_are_of_one_engine(tmp_path: Path) -> None:
    made: list[tuple[int, str]] = []

    def invented(seed: int, engine: str) -> CalibrationRow:
        made.append((seed, engine))
        return CalibrationRow(seed, engine, 0.1 * (seed % 10), seed % 2 == 0)

    path = tmp_path / "rows.jsonl"
    for engine in ("pymunk:plain", "pymunk"):
        assert [row.engine for row in measured(path, CalibrationRow, [(0, engine)], invented)] == [engine]
    assert made == [(0, "pymunk:plain"), (0, "pymunk")], "another engine's row was taken"


def test_a_row_is_seeded_and_its_observation_is_no_draw_of_its_probability() -> None:
    one = row_of(SEED, "pymunk:plain")
    assert one == row_of(SEED, "pymunk:plain")
    assert 0.0 <= one.probability <= 1.0
    assert one.fell in (True, False)
    assert shaken(SEED).base_excitation.x.peak_m_s2 > 0.0


def test_bins_of_false_probabilities_are_named() -> None:
    """A model that says 10 % of what always falls: its bin lies outside the band, and the failed run is left out."""
    random = np.random.default_rng(1)
    rows = [CalibrationRow(k, "e", 0.1, True) for k in range(40)]
    rows += [CalibrationRow(k, "e", 0.5, bool(random.random() < 0.5)) for k in range(40, 80)]
    rows.append(CalibrationRow(80, "e", 0.9, None))
    assert [(item.cases, item.holds) for item in diagram(rows)] == [(40, False), (40, True)]
    words = text(rows)
    assert "which decided 80 of 81" in words
    assert "1 of 2 bins lie within their band" in words


def test_the_page_s_diagram_lies_within_its_band_in_every_bin(root: Path) -> None:
    page = (root / "docs" / "measured" / "calibration.md").read_text(encoding="utf-8")
    part = page.partition(begin("tests.measures.calibration"))[2].partition("<!-- end -->")[0]
    rows = [
        [cell.strip() for cell in line.strip("|").split("|")] for line in part.splitlines() if line.startswith("| 0.")
    ]
    assert len(rows) == 5
    decided, _, scenes = part.partition("which decided ")[2].partition(":")[0].partition(" of ")
    assert sum(int(row[1]) for row in rows) == int(decided) >= 0.95 * int(scenes)
    assert int(scenes) == 300
    for row in rows:
        low, _, high = row[4].partition(" to ")
        assert float(low) <= float(row[3]) <= float(high)
        assert row[5] == "yes"
