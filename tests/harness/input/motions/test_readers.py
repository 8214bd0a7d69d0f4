"""Every format recognised by content, with units, directions, clocks and touching numbers; damaged files refused by line."""

from pathlib import Path

import numpy as np
import pytest

from harness.input.motions.readers import FORMATS, read_record
from harness.input.motions.recordfile import ChannelOrientation, fixed_width, free_format, parse_orientation
from harness.input.motions.records import aligned, channel_named, turned
from harness.model import InputError
from tests.budgets_motions import SAME_MOTION, WRITTEN_DIGITS_G
from tests.doubles import codes
from tests.harness.input.motions import layouts, writers
from tests.harness.input.motions.writers import GRAVITY, wave

DIGITS = WRITTEN_DIGITS_G * GRAVITY


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("N28W", ChannelOrientation(332.0)), ("S62W", ChannelOrientation(242.0)),
        ("N60E", ChannelOrientation(60.0)), ("S10E", ChannelOrientation(170.0)),
        ("067", ChannelOrientation(67.0)), ("360", ChannelOrientation(0.0)),
        ("UP", ChannelOrientation(vertical=True)), ("Z", ChannelOrientation(vertical=True)),
        ("HNE", ChannelOrientation(90.0)), ("HNN", ChannelOrientation(0.0)),
        ("HLZ", ChannelOrientation(vertical=True)), ("EW", ChannelOrientation(90.0, sense_assumed=True)),
        ("DWN", ChannelOrientation(vertical=True, sign=-1)), ("L", ChannelOrientation()),
        ("400", ChannelOrientation()),
    ],
)  # fmt: skip
def test_directions(text: str, expected: ChannelOrientation) -> None:
    assert parse_orientation(text) == expected


def test_touching_numbers() -> None:
    lines = ["1.234-5.678 .5E-3-2.0E-03", "-.1D+01+3.", "1.5-103"]
    found = free_format(lines, where="f", first_line=1)
    np.testing.assert_array_equal(found, [1.234, -5.678, 5e-4, -2e-3, -1.0, 3.0, 1.5e-103])


@pytest.mark.parametrize("bad", ["1.0 2.0 x", "1.0--2.0", "0.1 ****** 0.2", "1.2.3"])
def test_what_is_no_number_is_refused_with_its_line(bad: str) -> None:
    with pytest.raises(InputError, match=r"^f: line 8: "):
        free_format(["1.0 2.0", bad], where="f", first_line=7)


def test_fixed_width_reads_what_touches_and_names_a_bad_field() -> None:
    for filled_up in ("", "   0.0"):
        found = fixed_width(["-11024.7 12.5   1.0", filled_up], 8, 3, where="f", first_line=1)
        np.testing.assert_array_equal(found, [-11024.7, 12.5, 1.0])
    with pytest.raises(InputError, match=r"^f: accelerations: wanted 3 .* 2 lines"):
        fixed_width(["-11024.7 12.5   1.0", "   2.5"], 8, 3, where="f", first_line=1)
    with pytest.raises(InputError, match="line 5, column 9"):
        fixed_width(["     1.0********"], 8, 2, where="f", first_line=5)
    with pytest.raises(InputError, match=r"^f: line 5, column 1: .*\\t.* tabs "):
        fixed_width(["1.0\t2.0-3.0"], 8, 3, where="f", first_line=5)
    np.testing.assert_array_equal(fixed_width(["1.0\t2.0"], 8, 2, where="f", first_line=5), [1.0, 2.0])


@pytest.mark.parametrize("old", [False, True])
@pytest.mark.parametrize("stuck", [False, True])
def test_at2(tmp_path: Path, old: bool, stuck: bool) -> None:
    accel = wave(203)
    record = read_record(writers.at2(tmp_path / "RSN1_A_B067.AT2", accel, 0.01, "67", old=old, stuck=stuck))
    assert record.format == "PEER AT2"
    assert record.channels[0].orientation.azimuth_deg == 67.0
    assert record.channels[0].dt_s == 0.01
    np.testing.assert_allclose(record.channels[0].accel_m_s2, accel, atol=DIGITS)


def test_three_at2_files_make_one_record_and_downwards_is_turned_up(tmp_path: Path) -> None:
    up = wave(200, phase=1.0)
    path = writers.at2(tmp_path / "RSN1_PLACE_STA067.AT2", wave(203), 0.01, "67")
    writers.at2(tmp_path / "RSN1_PLACE_STA337.AT2", wave(201), 0.01, "337")
    writers.at2(tmp_path / "RSN1_PLACE_STADWN.AT2", -up, 0.01, "DWN")
    other = writers.at2(tmp_path / "RSN1_PLACE_STB067.AT2", wave(150), 0.01, "67")
    other.write_text(other.read_text().replace("A Station", "Another"))
    record = read_record(path)
    assert [channel.name for channel in record.channels] == ["67", "337", "DWN"]
    assert {series.accel_m_s2.size for series in aligned(record).values()} == {200}
    np.testing.assert_allclose(record.verticals[0].accel_m_s2, up, atol=DIGITS)


def test_smc(tmp_path: Path) -> None:
    accel = wave(333, peak_m_s2=3.0)
    stated = 100.0 * float(accel.max())
    path = writers.smc(tmp_path / "0111a.smc", accel, 100.0, 360, 90, stated)
    writers.smc(tmp_path / "0111b.smc", accel, 100.0, 90, 90, stated)
    writers.smc(tmp_path / "0111u.smc", accel, 100.0, 0, 0, stated)
    record = read_record(path)
    assert record.format == "USGS SMC"
    assert [channel.orientation for channel in record.channels] == [
        ChannelOrientation(0.0), ChannelOrientation(90.0), ChannelOrientation(vertical=True),
    ]  # fmt: skip
    np.testing.assert_allclose(record.channels[0].accel_m_s2, accel, rtol=1e-4, atol=1e-7)
    assert record.channels[0].dt_s == 0.01


def test_esm_files_with_different_starts_are_put_on_one_clock(tmp_path: Path) -> None:
    east, north = wave(300), wave(300, phase=0.7)
    path = writers.esm(tmp_path / "IT.ABC..HNE.ASC", east, 0.01, "HNE", "20190728_235959.900")
    writers.esm(tmp_path / "IT.ABC..HNN.ASC", north, 0.01, "HNN", "20190729_000000.000")
    series = aligned(read_record(path))
    np.testing.assert_allclose(series["HNE"].accel_m_s2, east[10:], atol=1e-8)
    np.testing.assert_allclose(series["HNN"].accel_m_s2, north[:290], atol=1e-8)


@pytest.mark.parametrize(("milliseconds", "code", "name", "sign"), [(False, 400, "UP", 1), (True, 401, "DOWN", -1)])
def test_cosmos(tmp_path: Path, milliseconds: bool, code: int, name: str, sign: int) -> None:
    accel = wave(1000, 0.005, peak_m_s2=5.0)
    channels = [(accel, 90), (accel, 180), (accel, code)]
    record = read_record(writers.cosmos(tmp_path / "a.V2", channels, 0.005, milliseconds=milliseconds))
    assert record.format == "COSMOS"
    assert [channel.name for channel in record.channels] == ["090", "180", name]
    assert record.channels[0].dt_s == pytest.approx(0.005, rel=1e-12)
    np.testing.assert_allclose(record.channels[2].accel_m_s2, sign * accel, atol=1e-7)


@pytest.mark.parametrize(("unit", "factor"), [("ms2", 1.0), ("cms2", 0.01), ("g", GRAVITY)])
@pytest.mark.parametrize("mark", [",", ";", "\t", "  "])
def test_csv_units_and_separators(tmp_path: Path, unit: str, factor: float, mark: str) -> None:
    accel = wave(100)
    lines = ["# a comment", mark.join(("t_s", f"a_N28W_{unit}", f"a_UP_{unit}"))]
    lines += [mark.join(f"{v:.9g}" for v in (0.01 * i, a / factor, -a / factor)) for i, a in enumerate(accel)]
    path = tmp_path / "a.txt"
    path.write_text("\n".join(lines))
    record = read_record(path)
    np.testing.assert_allclose(record.channels[0].accel_m_s2, accel, rtol=1e-8, atol=1e-12)
    assert record.channels[0].orientation == ChannelOrientation(332.0)
    assert record.channels[1].orientation.vertical


def test_readers_without_originals_say_so(tmp_path: Path) -> None:
    assert dict(FORMATS) == {
        "GeoNet V2A": True, "GeoNet V1A": False, "K-NET": True, "KiK-net": False, "USGS SMC": True,
        "USGS SMC, uncorrected": False,
        "CSMIP V1": False, "USC V1": False, "RENADIC V1": False, "BHRC V1": False, "CSMIP V2": True, "USC V2": False,
        "COSMOS": True,
        "COSMOS V0": False, "ITACA/ESM ASCII": True, "PEER AT2": True, "NSMN (AFAD)": False, "UNAM": False, "CWB": False,
        "CSV": True, "miniSEED/SAC": False,
    }  # fmt: skip
    record = read_record(layouts.nsmn(tmp_path / "a.txt", [wave(), wave(), wave()], 0.01))
    assert "record_reader_untested" in codes(record.findings)
    record = read_record(writers.at2(tmp_path / "a.AT2", wave(), 0.01, "UP"))
    assert "record_reader_untested" not in codes(record.findings)


def test_turning_recovers_the_motion_that_two_oblique_channels_saw(tmp_path: Path) -> None:
    east, north = wave(200), wave(200, phase=0.9)
    first = {name: np.radians(azimuth) for name, azimuth in (("N28W", 332.0), ("S70W", 250.0))}
    table = np.column_stack([0.01 * np.arange(200), *(north * np.cos(a) + east * np.sin(a) for a in first.values())])
    path = tmp_path / "a.csv"
    np.savetxt(path, table, delimiter=",", header="t_s,a_N28W_ms2,a_S70W_ms2", comments="", fmt="%.15g")
    record = read_record(path)
    for azimuth, expected in ((90.0, east), (0.0, north), (180.0, -north)):
        found = turned(record, azimuth, where="s", key="k").accel_m_s2
        np.testing.assert_allclose(found, expected, atol=10.0 * SAME_MOTION)
    assert channel_named(record, "332", where="s", key="k").name == "a_N28W_ms2"
    with pytest.raises(InputError, match=r"a_N28W_ms2 .*a_S70W_ms2"):
        channel_named(record, "45", where="s", key="k")
