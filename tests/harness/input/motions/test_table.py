"""Texts that no reader knows: read as the user says that they stand, and the options that fit said in the error."""

import re
import shlex
from pathlib import Path

import numpy as np
import pytest

from harness.input.motions.readers import read_file
from harness.input.motions.recordfile import Layout
from harness.input.motions.records import load
from harness.input.motions.spec import Source
from harness.model import InputError
from tests.budgets_motions import GAL_6
from tests.harness.input.motions.writers import GRAVITY as G_M_S2
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
    "times of day": [
        "timestamp,N (gal),E (gal)",
        *(f"2016-10-30T06:40:{18.0 + 0.01 * i:06.3f},{100 * n:.6f},0.1" for i, n in enumerate(NORTH)),
    ],
    "times of day and one channel": [
        "timestamp,N (gal)",
        *(f"2016-10-30T06:40:{18.0 + 0.01 * i:06.3f},{100 * n:.6f}" for i, n in enumerate(NORTH)),
    ],
    "dates beside times of day": [
        "Date;Time;N [mg];E [mg]",
        *(f"30/10/2016;06:40:{0.01 * i:06.3f};{v / G_M_S2 * 1e3:.6f};1".replace(".", ",") for i, v in enumerate(NORTH)),
    ],
    "count and step": ["TIME HISTORY", "gal", f"{NORTH.size} 0.0100", *rows(100.0 * NORTH, 5, "{:14.6f}")],
}
TIMES = 0.01 * np.arange(NORTH.size)
TABLES = {
    "units in a row of their own": (
        ["A place", "time,acc N,acc E", "ms,gal,gal"],
        [f"{1e3 * t:.0f},{100 * n:.6f},{100 * e:.6f}" for t, n, e in zip(TIMES, NORTH, EAST, strict=True)],
    ),
    "milliseconds, shares of g": (
        ["t (ms)|N (%g)|Z (%g)"],
        [f"{1e3 * t:.0f}|{100 * n / G_M_S2:.9f}|0.1" for t, n in zip(TIMES, NORTH, strict=True)],
    ),
    "quoted, a resultant": (
        ['"Time (s)","N (m/s^2)","Absolute acceleration (m/s^2)"'],
        [f'"{t:.3f}","{n:.9f}","{abs(n):.9f}"' for t, n in zip(TIMES, NORTH, strict=True)],
    ),
    "names with blanks, velocity beside": (
        ["A program", "Time [sec]  Acceleration N [g]  Velocity [cm/sec]"],
        [f"  {t:.3f}   {n / G_M_S2:.9E}   0.0" for t, n in zip(TIMES, NORTH, strict=True)],
    ),
    "columns of words": (
        ["station,t_s,flag,a_N_ms2,remark"],
        [f"ABC1,{t:.3f},OK,{n:.9f},{'no peak' if t else ''}" for t, n in zip(TIMES, NORTH, strict=True)],
    ),
    "words, decimal commas": (
        ["t [s];Bemerkung;N [m/s2]"],
        [f'{t:.3f};"ok";{n:.9f}'.replace(".", ",") for t, n in zip(TIMES, NORTH, strict=True)],
    ),
    "decimal commas": (
        ["t_s;a_N_gal;a_E_gal"],
        [line.replace(".", ",").replace(" ", ";") for line in TABLE],
    ),
    "minutes": (["time_min,a_N_ms2"], [f"{t / 60.0:.9f},{n:.9f}" for t, n in zip(TIMES, NORTH, strict=True)]),
    "milliseconds": (["t_ms,a_N_ms2"], [f"{1e3 * t:.3f},{n:.9f}" for t, n in zip(TIMES, NORTH, strict=True)]),
}


def _write(path: Path, lines: list[str]) -> Path:
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.mark.parametrize("name", TEXTS)
def test_the_error_names_the_options_that_read_the_file(tmp_path: Path, name: str) -> None:
    path = _write(tmp_path / "any text.txt", TEXTS[name])
    with pytest.raises(InputError, match=" rockcheck motion inspect ") as error:
        read_file(path)
    words = shlex.split(re.sub(r"( \(.*\))?; new and .*$", "", str(error.value).partition("rockcheck ")[2]))
    assert words[2] == str(path)
    said = dict(zip(words[3::2], words[4::2], strict=True))
    assert ("STEP" in said.values()) == (name == "no header"), "what the file does not say is left to its reader"
    dt_s = said.get("--dt", "").replace("STEP", "0.01")
    layout = Layout(
        float(dt_s) if dt_s else None, int(said.get("--skip-lines", 0)), said.get("--columns"),
        int(said["--time-column"]) if "--time-column" in said else None,
    )  # fmt: skip
    record = read_file(path, unit=said["--motion-unit"], layout=layout)
    assert record.channels[0].dt_s == pytest.approx(0.01)
    np.testing.assert_allclose(record.channels[0].accel_m_s2, NORTH, rtol=0.0, atol=GAL_6)


@pytest.mark.parametrize("name", TABLES)
def test_a_table_of_another_program_is_read_by_what_its_header_says(tmp_path: Path, name: str) -> None:
    head, body = TABLES[name]
    record = read_file(_write(tmp_path / "a.csv", head + body))
    first = record.channels[0]
    assert first.dt_s == pytest.approx(0.01)
    np.testing.assert_allclose(first.accel_m_s2, NORTH, rtol=0.0, atol=GAL_6)
    names = head[-2 if "row" in name else 0]
    assert len(record.channels) == 1 + ("E" in names or "Z" in names)
    if "E" in names:
        np.testing.assert_allclose(record.channels[1].accel_m_s2, EAST, rtol=0.0, atol=GAL_6)
    left_out = [each for each in record.findings if each.values.get("words") is False]
    assert len(left_out) == ("beside" in name or "resultant" in name)


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        (["t_s,a_N", *TABLE], r'say --motion-unit cm/s2, or unit = "cm/s2" in a scene, if its source says so: the peak is'),
        (["t_s,N", *(line.replace(".", "") for line in TABLE)], r"in none: counts need the recorder's factor first"),
        (["t_s,a_N_gal,a_E_gal", *TABLE, "END OF RECORD"], r"line 405: .* words among numbers: take out line 405"),
        (["t_s,v_N_ms", *TABLE], r"wanted a time column and an acceleration column, got the columns t_s, v_N_ms"),
    ],
)  # fmt: skip
def test_what_keeps_a_table_from_being_read_is_said_with_its_cure(tmp_path: Path, lines: list[str], said: str) -> None:
    columns = 1 + lines[0].count(",")
    path = _write(
        tmp_path / "a.csv", [",".join(line.split()[:columns]) if line[0].isdigit() else line for line in lines]
    )
    with pytest.raises(InputError, match=said):
        read_file(path)


def test_columns_are_named_and_a_scene_says_the_same(tmp_path: Path) -> None:
    path = _write(tmp_path / "a.txt", TEXTS["columns"])
    record = read_file(path, unit="gal", layout=Layout(skip_lines=2, time_column=1, columns="2:N,3:E"))
    assert [(c.name, c.orientation.azimuth_deg) for c in record.channels] == [("N", 0.0), ("E", 90.0)]
    keys = {"file": "a.txt", "unit": "gal", "skip_lines": 2, "time_column": 1, "columns": "2:N,3:E", "column": "E"}
    series, _ = load(Source.model_validate(keys), base_dir=tmp_path, where="scene", key="motion.x")
    np.testing.assert_allclose(series.accel_m_s2, EAST, rtol=0.0, atol=GAL_6)
    flat = read_file(path, unit="cm/s2", layout=Layout(dt_s=0.005, skip_lines=2, columns="3"))
    np.testing.assert_allclose(flat.channels[0].accel_m_s2, EAST, rtol=0.0, atol=GAL_6)
    assert flat.channels[0].dt_s == 0.005


@pytest.mark.parametrize(
    ("text", "layout", "unit", "said"),
    [
        ("columns", Layout(skip_lines=2, time_column=1), None, r"unit: wanted m/s2"),
        ("columns", Layout(skip_lines=2, time_column=1), "inch", r"unit: .* got inch"),
        ("columns", Layout(skip_lines=2), "gal", r"wanted the step, or the column of times, got neither"),
        ("columns", Layout(0.01, 2, None, 1), "gal", r"got both"),
        ("columns", Layout(0.01, 2, "4"), "gal", r"columns: wanted .* 1 to 3"),
        ("columns", Layout(0.01, 2, "2,2"), "gal", r"columns: wanted "),
        ("columns", Layout(None, 2, None, 7), "gal", r"time_column: .* got 7"),
        ("columns", Layout(None, 2, "all", 1), "gal", r"wanted --dt beside --columns all"),
        ("columns", Layout(0.01, 999), "gal", r"skip_lines: wanted "),
        ("columns", Layout(0.01, 1), "gal", r"line 2: wanted numbers, got 'in'"),
        # Dates stand only in columns that are not asked for.
        ("times of day", Layout(0.01, 1, "1,2"), "gal", r"columns: wanted .* in 1"),
        ("times of day", Layout(None, 1, "2", 1), "gal", r"time_column: wanted .*--dt"),
        ("times of day", Layout(0.01, 1), "gal", r"line 2: wanted numbers, got '2016-10-30T06:40:18.000'"),
    ],
)
def test_what_is_missing_or_wrong_is_named(
    tmp_path: Path, text: str, layout: Layout, unit: str | None, said: str
) -> None:
    path = _write(tmp_path / "a.txt", TEXTS[text])
    with pytest.raises(InputError, match=said):
        read_file(path, unit=unit, layout=layout)


@pytest.mark.parametrize(("cell", "count"), [("", "1"), ("1.0-2.0", "3")])
def test_a_gap_or_two_numbers_in_one_cell_beside_a_date_are_refused(tmp_path: Path, cell: str, count: str) -> None:
    lines = [f"06:40:{0.01 * i:06.3f},{100 * n:.6f},0.1" for i, n in enumerate(NORTH)]
    lines[7] = f"06:40:00.070,{cell},0.1"
    path = _write(tmp_path / "text.csv", lines)
    with pytest.raises(InputError, match=f"line 8: wanted 2 .*, got {count}"):
        read_file(path, unit="gal", layout=Layout(columns="2", dt_s=0.01))
    with pytest.raises(InputError, match=r"text\.csv"):
        read_file(path)


def test_words_stand_beside_the_columns_asked_for_and_in_a_first_line_of_data(tmp_path: Path) -> None:
    lines = [f"{t:.2f} A {n:.9f}" for t, n in zip(TIMES, NORTH, strict=True)]
    named = _write(tmp_path / "named.txt", ["seconds quality north", *lines])
    chosen = read_file(named, unit="m/s2", layout=Layout(skip_lines=1, time_column=1, columns="3:N"))
    bare = read_file(_write(tmp_path / "bare.txt", lines), unit="m/s2")
    assert [each.values for each in bare.findings] == [{"column": "2", "words": True}]
    for record in (chosen, bare):
        np.testing.assert_allclose(record.channels[0].accel_m_s2, NORTH, rtol=0.0, atol=GAL_6)
    with pytest.raises(InputError, match=r": line 1: .* got 'seconds'"):
        read_file(named, unit="m/s2", layout=Layout(0.01, 0, "3"))


def test_nothing_is_proposed_for_a_damaged_table_or_prose(tmp_path: Path) -> None:
    for name, lines in {
        "headed": ["t_s,a_N_gal", *(line.replace(" ", ",", 1).split()[0] for line in TABLE[:50]), "0.9,x"],
        "prose": ["some words", "and more"],
        "broken": [*TABLE[:200], "nan nan nan", *TABLE[200:]],
        "velocity and displacement alone": ["sample;v (cm/s);d (cm)", *(line.replace(" ", ";") for line in TABLE)],
    }.items():
        with pytest.raises(InputError) as error:
            read_file(_write(tmp_path / f"{name}.txt", lines), unit="gal")
        assert "read by:" not in str(error.value), name


@pytest.mark.parametrize("per_line", [1, 2, 3])
def test_numbers_that_run_on_in_even_lines_are_told_from_columns(tmp_path: Path, per_line: int) -> None:
    """By how neighbours follow each other: along the lines, or down them."""
    along = _write(tmp_path / "along.txt", ["dt = 0.01 s, gal", *rows(100.0 * NORTH[:402], per_line, "{:14.6f}")])
    three = np.stack([NORTH[:134], EAST[:134], -NORTH[:134]], axis=1).ravel()
    down = _write(tmp_path / "down.txt", ["dt = 0.01 s, gal", *rows(100.0 * three, 3, "{:14.6f}")])
    with pytest.raises(InputError, match=r"--columns all"):
        read_file(along)
    with pytest.raises(InputError, match=r"--skip-lines 1 --dt"):
        read_file(down)


ONE = [f"{100 * v:.6f}" for v in NORTH]
COUNTS = {
    "in words": ["NPTS= 403, DT= .01 SEC"],
    "alone": ["403 0.01"],
    "alone, turned": ["1.0D-02, 403"],
    "one below the other": ["403", "0.01"],
    "as in AT2 of old": ["403   0.0100   NPTS, DT"],
    "by its rate": ["No. of points: 403", "band-pass 0.1 - 25 Hz", "Sampling rate: 100 Hz"],
    "beside an instrument": ["INSTR PERIOD = .049 SEC  DAMPING = .57  peak 0.204 g at 0.05 s", "DT = 10 ms"],
}


@pytest.mark.parametrize("name", COUNTS)
@pytest.mark.parametrize("body", [ONE, rows(100.0 * NORTH, 5, "{:14.6f}")])
def test_a_line_of_count_and_step_is_no_sample(tmp_path: Path, name: str, body: list[str]) -> None:
    head = ["made up", "cm/s2", *COUNTS[name]]
    with pytest.raises(InputError) as error:
        read_file(_write(tmp_path / "a.txt", [*head, *body]))
    assert f"--skip-lines {len(head)} --columns all --dt 0.01 --motion-unit cm/s2;" in str(error.value)


@pytest.mark.parametrize(
    ("lines", "wanted", "got"),
    [
        (["gal", "NPTS= 500, DT=.01", *ONE], "500 numbers, as the lines above them say", "403"),
        (["gal", "500 .01", *ONE], "500 numbers, as the lines above them say", "403"),
        (["gal", "dt=.01", "Sampling rate: 200 Hz", *ONE], "one step", "0.01 s and 0.005 s"),
        (["gal", "dt=.005", *TABLE], "one step", "0.01 s and 0.005 s"),
        (["values in cm/s2 or g", "dt=.01", *ONE], "one unit in all columns", "cm/s2 and g"),
        (["when;N (m/s2);E [gal]", *(line.replace(" ", ";") for line in TABLE)], "one unit in all columns", "cm/s2 and m/s2"),
        (["in gal", *TABLE[:200], *TABLE[300:]], "a step of about 0.01 s", "a gap of 1.01 s from 1.99 s"),
        (["in gal", *TABLE[:200], *TABLE[100:]], "increasing times", "1 s after 1.99 s"),
        (["gal, 100 Hz", *ONE[:50], "999.99", *ONE[51:]], "an acceleration",
         "999.99 (1 such), which programs write where a sample is missing"),
    ],
)  # fmt: skip
def test_what_contradicts_itself_is_named_and_nothing_proposed(
    tmp_path: Path, lines: list[str], wanted: str, got: str
) -> None:
    with pytest.raises(InputError) as error:
        read_file(_write(tmp_path / "a.txt", lines))
    assert [(each.wanted, each.got) for each in error.value.mistakes] == [(wanted, got)]
    assert "read by:" not in str(error.value)


@pytest.mark.parametrize(
    ("line", "options"),
    [
        ("{n} {t:.3f}", "--skip-lines 1 --time-column 2 --motion-unit cm/s2;"),
        ("{k};{t:.3f};{n}", "--skip-lines 1 --time-column 2 --columns 3 --motion-unit cm/s2;"),
        ("{t:.2f}\t{n}", "--skip-lines 1 --time-column 1 --motion-unit cm/s2;"),
        ("{k} {n}", "--skip-lines 1 --columns 2 --dt STEP --motion-unit cm/s2 (STEP in seconds as its source says);"),
    ],
)
def test_the_column_of_times_is_kept_wherever_it_stands_and_the_samples_numbers_are_none(
    tmp_path: Path, line: str, options: str
) -> None:
    lines = [line.format(k=k, t=0.01 * k, n=n) for k, n in enumerate(ONE)]
    with pytest.raises(InputError) as error:
        read_file(_write(tmp_path / "a.txt", ["values in cm/s2", *lines]))
    assert options in str(error.value)


def test_a_unit_against_the_header_that_is_skipped_is_refused(tmp_path: Path) -> None:
    path = _write(tmp_path / "a.txt", ["Zeitpunkt;N (m/s2);E (m/s2)", *(line.replace(" ", ";") for line in TABLE)])
    with pytest.raises(InputError) as error:
        read_file(path, unit="g", layout=Layout(skip_lines=1, time_column=1))
    assert [(each.key, each.got) for each in error.value.mistakes] == [("N (m/s2)", "g")]
    assert read_file(path, unit="m/s2", layout=Layout(skip_lines=1, time_column=1)).unit == "m/s2"


def test_a_single_column_of_decimal_commas_is_one_number_a_line(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    path.write_text("\n".join(f"0,{k:02d}" for k in range(20)))
    (channel,) = read_file(path, unit="g", layout=Layout(dt_s=0.01)).channels
    np.testing.assert_allclose(channel.accel_m_s2, 0.01 * G_M_S2 * np.arange(20))
