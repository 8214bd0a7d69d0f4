"""Records that were once read wrongly without a word: steps, cells, columns, directions, sisters."""

import gzip
from pathlib import Path

import numpy as np
import pytest

from harness.input.motions.readers import read_record
from harness.input.motions.recordfile import USUAL_STEPS_S, parse_orientation
from harness.input.motions.records import channel_named
from harness.model import InputError
from tests.doubles import codes
from tests.fuzz.records import at2
from tests.harness.input.motions import writers
from tests.harness.input.motions.writers import wave

COLUMNS = "0 0.1 0.2 0.3\n0.01 0.2 0.3 0.4\n0.02 0.1 0.1 0.1\n"


def _with_step(path: Path, step: bytes) -> Path:
    path.write_bytes(at2().replace(b"DT=   0.0200 SEC", b"DT= " + step))
    return path


@pytest.mark.parametrize("step", [b"1.E-02 SEC", b"1e-2", b"1d-2 SEC", b"1D-02,", b".01SEC", b"0.01 SEC", b"1.0-002"])
def test_a_step_is_read_however_fortran_wrote_it(tmp_path: Path, step: bytes) -> None:
    assert read_record(_with_step(tmp_path / "a.AT2", step)).channels[0].dt_s == 0.01


@pytest.mark.parametrize(
    "step", [b"1_0", b"0x1", b"nan", b"inf", b"-0.01", b"0", b"x", b"", b"1.0 E-02", b"1.0 -2", b"10 MSEC"]
)
def test_a_step_that_is_no_number_is_refused_in_the_reader_s_words(tmp_path: Path, step: bytes) -> None:
    with pytest.raises(InputError, match=r": line 4: wanted DT "):
        read_record(_with_step(tmp_path / "a.AT2", step))


def test_a_step_that_no_accelerograph_has_is_told(tmp_path: Path) -> None:
    slow = read_record(_with_step(tmp_path / "a.AT2", b"1. SEC"))
    (told,) = [each for each in slow.findings if each.code == "record_step"]
    assert (told.values["dt_s"], told.values["lasts_s"]) == (1.0, 39.0)
    usual = read_record(_with_step(tmp_path / "b.AT2", str(USUAL_STEPS_S[1]).encode()))
    assert "record_step" not in codes(usual.findings)


def test_a_cell_with_an_underscore_is_no_number(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("t_s,a_ms2\n0,0\n0.01,1_0.0\n0.02,1\n")
    with pytest.raises(InputError, match=r": line 3, a_ms2: .* got '1_0\.0'"):
        read_record(path)


def test_columns_are_named_by_a_comment_above_them(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    path.write_text(f"# any record\n# Time U N E\n# as recorded\n{COLUMNS}")
    record = read_record(path, unit="m/s2")
    assert [channel.name for channel in record.channels] == ["U", "N", "E"]
    assert [channel.name for channel in record.verticals] == ["U"]
    assert [channel.orientation.azimuth_deg for channel in record.horizontals] == [0.0, 90.0]


def test_a_column_s_place_is_no_azimuth(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    path.write_text(COLUMNS)
    record = read_record(path, unit="m/s2")
    assert record.horizontals == record.verticals == ()
    assert channel_named(record, "3", where="scene", key="motion.x").accel_m_s2.tolist() == [0.2, 0.3, 0.1]
    assert parse_orientation("3").azimuth_deg is None


@pytest.mark.parametrize("name", ["EW", "WE", "E-W", "W-E", "HNE", "E", "N90E", "090", "90 Deg"])
def test_every_name_of_the_east_is_the_east(name: str) -> None:
    assert parse_orientation(name).azimuth_deg == 90.0
    assert parse_orientation(name).sign == 1


@pytest.mark.parametrize(("unit", "factor"), [("m_s2", 1.0), ("cm_s2", 0.01), ("mm_s2", 0.001), ("[cm/s^2]", 0.01)])
def test_a_header_may_state_its_unit_as_names_of_columns_do(tmp_path: Path, unit: str, factor: float) -> None:
    path = tmp_path / "a.csv"
    path.write_text(f"t_s,accel_{unit}\n0,0\n0.01,1\n0.02,1\n")
    assert read_record(path).channels[0].accel_m_s2.tolist() == [0.0, factor, factor]


def test_a_line_s_name_and_a_turned_sign_are_told(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("t_s,WE_ms2,E_ms2,DOWN_ms2\n0,0,0,0\n0.01,1,1,1\n0.02,1,1,1\n")
    record = read_record(path)
    west_east, east, down = record.channels
    assert west_east.orientation.azimuth_deg == east.orientation.azimuth_deg
    assert np.array_equal(west_east.accel_m_s2, east.accel_m_s2)
    assert down.accel_m_s2.tolist() == [0.0, -1.0, -1.0]
    told = {(each.code, each.values.get("channel")) for each in record.findings}
    assert {("record_sense_assumed", "WE_ms2"), ("record_downwards", "DOWN_ms2")} <= told
    assert ("record_sense_assumed", "E_ms2") not in told


@pytest.mark.parametrize(
    "content", [b"", bytes(300), b"\x1f\x8b\x08", gzip.compress(bytes(2**20)) * 70, b"NPTS= 1_0, DT= x\n" * 9]
)
def test_a_bad_sister_costs_itself_only(tmp_path: Path, content: bytes) -> None:
    good = writers.at2(tmp_path / "RSN1_A_090.AT2", wave(), 0.01, "090")
    alone = read_record(good)
    (tmp_path / "RSN1_A_180.AT2").write_bytes(content)
    record = read_record(good)
    assert [channel.name for channel in record.channels] == ["090"]
    assert np.array_equal(record.channels[0].accel_m_s2, alone.channels[0].accel_m_s2)
    (told,) = [each for each in record.findings if each.code == "record_sister_unread"]
    assert told.values["file"] == "RSN1_A_180.AT2"
    with pytest.raises(InputError):
        read_record(tmp_path / "RSN1_A_180.AT2")
