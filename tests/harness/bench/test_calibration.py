"""The calibration of probabilities: rows kept and read again, the diagram, and the table that the page shows."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from harness.bench import calibration
from harness.bench.calibration import CalibrationRow, diagram, measured, row_of, shaken, text
from harness.bench.pages import begin

SEED = 780_000


def test_rows_are_kept_and_not_computed_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "rows.jsonl"
    made: list[int] = []

    def invented(seed: int, engine: str) -> CalibrationRow:
        made.append(seed)
        return CalibrationRow(seed, engine, 0.1 * (seed % 10), seed % 2 == 0)

    monkeypatch.setattr(calibration, "row_of", invented)
    first = measured(path, range(3), "pymunk:plain")
    again = measured(path, range(5), "pymunk:plain")
    assert made == [0, 1, 2, 3, 4]
    assert again[:3] == first
    assert [row.seed for row in measured(path, range(1), "pymunk")] == [0]
    assert made[-1] == 0, "another engine's rows were taken"


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
    page = (root / "docs" / "probability.md").read_text(encoding="utf-8")
    part = page.partition(begin("harness.bench.calibration"))[2].partition("<!-- end -->")[0]
    rows = [
        [cell.strip() for cell in line.strip("|").split("|")] for line in part.splitlines() if line.startswith("| 0.")
    ]
    assert len(rows) == 5
    assert sum(int(row[1]) for row in rows) == 300
    for row in rows:
        low, _, high = row[4].partition(" to ")
        assert float(low) <= float(row[3]) <= float(high)
        assert row[5] == "yes"
