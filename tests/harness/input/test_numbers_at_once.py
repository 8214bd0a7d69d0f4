"""Numbers of many lines at once: those that each line's own reading gives, and nothing else."""

import numpy as np
import pytest

from harness.input.files import decimals, numbers_at_once
from harness.input.motions.readers import table


def test_they_are_the_same_to_the_last_bit() -> None:
    lines = [",".join(map(repr, row)) for row in np.random.default_rng(0).normal(size=(50, 3)).tolist()]
    found = numbers_at_once(lines, ",")
    assert found is not None
    np.testing.assert_array_equal(found, [decimals(line.split(",")) for line in lines])


@pytest.mark.parametrize(
    "odd", ["1_0,2", "nan,2", "inf,2", "1e999,2", "0x1,2", "1,", "1", "1,2,3", "a,2", '"1",2', "# 1,2", "1 2,3"]
)
def test_anything_else_is_left_to_who_can_say_what_is_wrong(odd: str) -> None:
    assert numbers_at_once(["1,2", odd, "3,4"], ",") is None


@pytest.mark.parametrize("mark", [",", ";", "\t", " ", "decimal comma"])
def test_a_table_reads_the_same_line_by_line(mark: str, monkeypatch: pytest.MonkeyPatch) -> None:
    rows = [["0.00", "1.5"], ["0.01", "-2.25"], ["0.02", "0.75"]]
    between = ";" if mark == "decimal comma" else mark
    text = between.join(["t_s", "ax_(g)"]) + "\n" + "\n".join(between.join(row) for row in rows) + "\n"
    text = text.replace(".", ",") if mark == "decimal comma" else text
    at_once = table.headed_columns(text, "a.csv").channels[0]
    monkeypatch.setattr(table, "numbers_at_once", lambda lines, between: None)
    by_line = table.headed_columns(text, "a.csv").channels[0]
    np.testing.assert_array_equal(at_once.accel_m_s2, by_line.accel_m_s2)
    assert at_once.accel_m_s2[1] == pytest.approx(-2.25 * 9.80665)
