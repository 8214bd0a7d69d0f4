"""Texts that no reader knows: read as the user says that they stand, and the options that fit said in the error."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import numpy as np
import pytest

from harness.input.motions.layout import Layout
from harness.input.motions.readers import read_file
from harness.input.motions.records import load
from harness.input.motions.spec import Source
from harness.model.errors import InputError
from tests.budgets_motions import GAL_6
from tests.harness.input.motions.writers import rows, wave

NORTH, EAST = wave(403, peak_m_s2=2.0), wave(403, peak_m_s2=1.5, phase=0.7)
TABLE = [f"{0.01 * i:.3f} {100 * n:.6f} {100 * e:.6f}" for i, (n, e) in enumerate(zip(NORTH, EAST, strict=True))]
TEXTS = {
    "runs on": ["A place", "dt = 0.01 s, gal", *rows(100.0 * NORTH, 5, "{:14.6f}")],
    "touching": ["A place", "dt = 0.01 s, gal", *rows(100.0 * NORTH, 5, "{:+.6f}")],
    "exponents": [
        "A place",
        "100 Hz, gal",
        *[f"{100.0 * v:.9e}".replace("e-0", "-").replace("e+0", "+") for v in NORTH],
    ],
    "columns": ["Somewhere", "in gal", *TABLE],
    "decimal commas": ["Somewhere", "in gal", *(line.replace(".", ",") for line in TABLE)],
    "semicolons": ["Somewhere", "in gal", *(line.replace(".", ",").replace(" ", ";") for line in TABLE)],
    "no header": [f"{100.0 * v:.6f}" for v in NORTH],
}


def _write(path: Path, lines: list[str]) -> Path:
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.mark.parametrize("name", TEXTS)
def test_the_error_names_the_options_that_read_the_file(tmp_path: Path, name: str) -> None:
    path = _write(tmp_path / "any text.txt", TEXTS[name])
    with pytest.raises(InputError, match=r"its numbers alone are read by: rockcheck motion inspect ") as error:
        read_file(path)
    words = shlex.split(re.sub(r" \(.*\)$", "", str(error.value).partition("read by: ")[2]))
    assert words[3] == str(path)
    said = dict(zip(words[4::2], words[5::2], strict=True))
    layout = Layout(
        float(said["--dt"]) if "--dt" in said else None, int(said.get("--skip-lines", 0)), said.get("--columns"),
        int(said["--time-column"]) if "--time-column" in said else None,
    )  # fmt: skip
    record = read_file(path, unit=said["--unit"], layout=layout)
    assert record.channels[0].dt_s == pytest.approx(0.01)
    np.testing.assert_allclose(record.channels[0].accel_m_s2, NORTH, rtol=0.0, atol=GAL_6)


def test_columns_are_named_and_a_scene_says_the_same(tmp_path: Path) -> None:
    path = _write(tmp_path / "a.txt", TEXTS["columns"])
    record = read_file(path, unit="gal", layout=Layout(skip_lines=2, time_column=1, columns="2:N,3:E"))
    assert [(c.name, c.orientation.azimuth_deg) for c in record.channels] == [("N", 0.0), ("E", 90.0)]
    keys = {"file": "a.txt", "unit": "gal", "skip_lines": 2, "time_column": 1, "columns": "2:N,3:E", "column": "E"}
    loaded = load(Source.model_validate(keys), base_dir=tmp_path, where="scene", key="motion.x")
    np.testing.assert_allclose(loaded.series.accel_m_s2, EAST, rtol=0.0, atol=GAL_6)
    flat = read_file(path, unit="cm/s2", layout=Layout(dt_s=0.005, skip_lines=2, columns="3"))
    np.testing.assert_allclose(flat.channels[0].accel_m_s2, EAST, rtol=0.0, atol=GAL_6)
    assert flat.channels[0].dt_s == 0.005


@pytest.mark.parametrize(
    ("layout", "unit", "said"),
    [
        (Layout(skip_lines=2, time_column=1), None, r"unit: wanted m/s2 or cm/s2"),
        (Layout(skip_lines=2, time_column=1), "inch", r"unit: wanted m/s2 or cm/s2 .* got inch"),
        (Layout(skip_lines=2), "gal", r"wanted the step, or the column of times, got neither"),
        (Layout(0.01, 2, None, 1), "gal", r"got both"),
        (Layout(0.01, 2, "4"), "gal", r"columns: wanted columns from 1 to 3"),
        (Layout(0.01, 2, "2,2"), "gal", r"columns: wanted columns and names that differ"),
        (Layout(None, 2, None, 7), "gal", r"time_column: wanted a column from 1 to 3, got 7"),
        (Layout(None, 2, "all", 1), "gal", r"wanted --dt beside --columns all"),
        (Layout(0.01, 999), "gal", r"skip_lines: wanted numbers below the lines skipped"),
        (Layout(0.01, 1), "gal", r"line 2: wanted numbers, got 'in'"),
    ],
)
def test_what_is_missing_or_wrong_is_named(tmp_path: Path, layout: Layout, unit: str | None, said: str) -> None:
    path = _write(tmp_path / "a.txt", TEXTS["columns"])
    with pytest.raises(InputError, match=said):
        read_file(path, unit=unit, layout=layout)


def test_nothing_is_proposed_for_a_damaged_table_or_prose(tmp_path: Path) -> None:
    for name, lines in {
        "headed": ["t_s,a_N_gal", *(line.replace(" ", ",", 1).split()[0] for line in TABLE[:50]), "0.9,x"],
        "prose": ["some words", "and more"],
        "broken": [*TABLE[:200], "nan nan nan", *TABLE[200:]],
    }.items():
        with pytest.raises(InputError) as error:
            read_file(_write(tmp_path / f"{name}.txt", lines), unit="gal")
        assert "read by:" not in str(error.value), name


def test_decimal_commas_of_a_csv_need_no_options(tmp_path: Path) -> None:
    lines = ["t_s;a_N_gal;a_E_gal", *(line.replace(".", ",").replace(" ", ";") for line in TABLE)]
    record = read_file(_write(tmp_path / "a.csv", lines))
    np.testing.assert_allclose(record.channels[1].accel_m_s2, EAST, rtol=0.0, atol=GAL_6)
