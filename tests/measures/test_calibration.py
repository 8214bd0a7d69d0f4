"""The calibration of probabilities: rows kept and read again, the diagram, and the table that the page shows."""

import re
from pathlib import Path

from tests.measures.calibration import row_of, shaken
from tests.measures.pages import begin

SEED = 780_000


def test_a_row_is_seeded_and_its_observation_is_no_draw_of_its_probability() -> None:
    one = row_of(SEED, "pymunk:plain")
    assert one == row_of(SEED, "pymunk:plain")
    assert 0.0 <= one.probability <= 1.0
    assert one.fell in (True, False)
    assert shaken(SEED).base_excitation.x.peak_m_s2 > 0.0


def test_the_page_s_diagram_lies_within_its_band_in_every_bin(root: Path) -> None:
    page = (root / "docs" / "measured" / "calibration.md").read_text(encoding="utf-8")
    part = page.partition(begin("tests.measures.calibration"))[2].partition("<!-- end -->")[0]
    rows = [
        [cell.strip() for cell in line.strip("|").split("|")] for line in part.splitlines() if line.startswith("| 0.")
    ]
    assert len(rows) == 5
    judged, scenes, left = map(int, re.findall(r"(?:are|of) (\d+)", part)[:3])
    assert sum(int(row[1]) for row in rows) == judged >= 0.95 * (scenes - left)
    assert left <= 0.4 * scenes == 168
    for row in rows:
        low, _, high = row[4].partition(" to ")
        assert float(low) <= float(row[3]) <= float(high)
        assert row[5] == "yes"
