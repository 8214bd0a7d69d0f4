"""Layouts of networks whose originals are not at hand: built from the heads of their files, read back, cut, and re-encoded."""

import gzip
import textwrap
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from harness.input.motions.readers import read_file, read_record, volumes
from harness.input.motions.recordfile import NUMERIC, ChannelOrientation
from harness.model import InputError
from tests.budgets_motions import CLOCK_S, COUNTS_M_S2, GAL_3, GAL_6, TENTH_G_3
from tests.doubles import codes
from tests.harness.input.motions import layouts, writers
from tests.harness.input.motions.writers import GRAVITY, Floats, wave

NORTH, EAST, UP = ChannelOrientation(0.0), ChannelOrientation(90.0), ChannelOrientation(vertical=True)
THREE = (wave(400, peak_m_s2=2.0), wave(400, peak_m_s2=3.0, phase=0.5), wave(400, peak_m_s2=1.0, phase=1.0))
BUILDERS: dict[str, Callable[[Path], Path]] = {
    "K-NET": lambda path: layouts.knet(path / "AOM001.EW", THREE[0], 100, "E-W"),
    "KiK-net": lambda path: layouts.knet(path / "AICH04.UD2", THREE[0], 200, "6"),
    "CSMIP V1": lambda path: layouts.volume1(path / "a.V1", [(THREE[0], "90 DEG"), (THREE[1], "Up")], 0.01, "CSMIP"),
    "CSMIP V1 film": lambda path: layouts.volume1(path / "a.RAW", [(THREE[0], "90 DEG")], 0.005, "film"),
    "CSMIP V1 1990s": lambda path: layouts.volume1(path / "a.RAW", [(THREE[0], "90 DEG")], 0.005, "CSMIP of the 1990s"),
    "USC V1": lambda path: layouts.volume1(path / "017m30bt.s0a", [(THREE[0], "N00W")], 0.01, "USC"),
    "RENADIC V1": lambda path: layouts.volume1(path / "a.v1", [(THREE[0], "NS"), (THREE[1], "V")], 0.01, "RENADIC"),
    "BHRC V1": lambda path: layouts.volume1(path / "b.V1", [(THREE[0], "L1"), (THREE[1], "V2"), (THREE[2], "T3")], 0.005, "BHRC"),
    "GeoNet V1A": lambda path: layouts.geonet(
        path / "a.V1A", [(THREE[0], "S90E"), (8.0 * THREE[1], "Up")], 0.005, corrected=False
    ),
    "GeoNet V2A": lambda path: layouts.geonet(
        path / "a.V2A", [(THREE[0], "N28W"), (THREE[1], "Up")], 0.02, corrected=True
    ),
    "NSMN (AFAD)": lambda path: layouts.nsmn(path / "a.txt", THREE, 0.01),
    "UNAM": lambda path: layouts.unam(path / "ACAC1709.191", THREE, 0.005),
    "CWB": lambda path: layouts.cwb(path / "2-ECU.dat", THREE, 0.005),
    "USGS SMC, uncorrected": lambda path: layouts.smc_pairs(path / "a.smc", 0.005 * np.arange(400), THREE[0]),
    "COSMOS": lambda path: layouts.cosmos_of_today(
        path / "a.V1C", THREE[0] / GRAVITY, 0.005, 360,
        "   {n} acceleration pts, approx  {s} secs, units=g.     (02)Format=(8f9.6)   ",
    ),
    "COSMOS V0": lambda path: layouts.cosmos_of_today(
        path / "a.v0c", np.round(THREE[0] * 1e5).astype(int) - 982416, 0.005, 90,
        "   {n} raw accel.   pts, approx  {s} secs, units=counts (50),Format=(10I8)",
    ),
    "USC V2": lambda path: layouts.usc_v2(
        path / "usc0003.v2", [(THREE[0], "S00E")], 0.02,
        "{n:5d} POINTS OF ACC DATA EQUALLY SPACED AT  {dt:.4f} SEC.  (UNITS: CM/SEC/SEC)",
    ),
    "CSMIP V2": lambda path: layouts.usc_v2(
        path / "a.v2", [(THREE[0], "90"), (THREE[1], "Up")], 0.02, layouts.CSMIP_V2, whole=True
    ),
    "AT2": lambda path: writers.at2(path / "a.AT2", THREE[0], 0.01, "090", stuck=True),
    "SMC": lambda path: writers.smc(path / "b.smc", THREE[0], 100.0, 45, 90, 200.0),
    "COSMOS 1.20": lambda path: writers.cosmos(path / "a.V2", [(THREE[0], 90), (THREE[1], 0)], 0.01, milliseconds=False),
    "ESM": lambda path: writers.esm(path / "a.ASC", THREE[0], 0.01, "HNE", "20190728_160919.870"),
}  # fmt: skip
OTHER_NAMES = {
    "AT2": "PEER AT2", "SMC": "USGS SMC", "ESM": "ITACA/ESM ASCII",
    "COSMOS 1.20": "COSMOS", "CSMIP V1 film": "CSMIP V1", "CSMIP V1 1990s": "CSMIP V1",
}  # fmt: skip


@pytest.mark.parametrize("name", BUILDERS)
def test_a_network_s_layout_is_read_in_every_wrapping(tmp_path: Path, name: str) -> None:
    path = BUILDERS[name](tmp_path)
    plain = path.read_bytes()
    first = read_file(path)
    assert first.format == OTHER_NAMES.get(name, name)
    with zipfile.ZipFile(tmp_path / "in.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(path.name, plain)
    text = plain.decode()
    lines = text.splitlines()
    numbers = next(i for i, line in enumerate(lines) if NUMERIC.fullmatch(line))
    wrappings = {
        "crlf": text.replace("\n", "\r\n").encode(), "utf-16": text.encode("utf-16"), "mark": text.encode("utf-8-sig"),
        "latin": text.encode("latin-1", "replace"), "blanks": text.replace("\n", "     \n").encode(),
        "gz": gzip.compress(plain), "zip": (tmp_path / "in.zip").read_bytes(),
        "DOS": text.replace("\n", "\r\n").encode() + b"\x1a", "old Mac": text.replace("\n", "\r").encode(),
        "blank lines first": f"\n \n\f{text}".encode(), "blank lines last": f"{text}\n \n".encode(),
        "a blank line after the first": text.replace("\n", "\n\n", 1).encode(),
        "a blank line above the numbers": "\n".join([*lines[:numbers], "", *lines[numbers:]]).encode(),
        "double spaced": text.replace("\n", "\n\n").encode(), "indented": textwrap.indent(text, " ").encode(),
        "capitals": text.upper().encode(), "small letters": text.lower().encode(),
    }  # fmt: skip
    for wrapping, content in wrappings.items():
        path.write_bytes(content)
        again = read_file(path)
        assert again.format == first.format, wrapping
        for one, other in zip(first.channels, again.channels, strict=True):
            np.testing.assert_array_equal(one.accel_m_s2, other.accel_m_s2, err_msg=wrapping)
            assert one.orientation == other.orientation


@pytest.mark.parametrize("name", BUILDERS)
def test_a_network_s_file_that_is_cut_is_refused_in_its_reader_s_words(tmp_path: Path, name: str) -> None:
    path = BUILDERS[name](tmp_path)
    lines = path.read_text().splitlines()
    body = [i for i, line in enumerate(lines) if not line.startswith(("/&", "End-of-data"))]
    middle = body[int(0.45 * len(body))]
    for keep in (body[-1], body[-4], middle) if name != "CWB" else (middle,):
        path.write_text("\n".join(lines[:keep]))
        with pytest.raises(InputError, match=r"cut off|as its header says") as error:
            read_file(path)
        assert len(str(error.value).splitlines()) == 1
        assert "--skip-lines" not in str(error.value)


@pytest.mark.parametrize("name", BUILDERS)
def test_any_damaged_byte_is_read_or_refused(tmp_path: Path, name: str) -> None:
    path = BUILDERS[name](tmp_path)
    whole = path.read_bytes()
    generator = np.random.default_rng(7)
    said: list[str] = []
    for _ in range(60):
        raw = bytearray(whole)
        for at in generator.integers(0, min(len(raw), 4000), 3):
            raw[at] = generator.integers(0, 256)
        path.write_bytes(bytes(raw))
        try:
            read_record(path)
        except InputError as error:
            said.append(str(error))
    assert said
    assert all(str(path) in each for each in said)


def _same(found: Floats, expected: Floats, within: float) -> None:
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=within)


def test_k_net_s_three_files_are_one_record_by_any_of_them(tmp_path: Path) -> None:
    for accel, name in zip(THREE, ("N-S", "E-W", "U-D"), strict=True):
        layouts.knet(tmp_path / f"AOM001.{name.replace('-', '')}", accel, 100, name)
        layouts.knet(tmp_path / f"AOM002.{name.replace('-', '')}", accel, 100, name)
    for ending in ("EW", "NS", "UD"):
        record = read_record(tmp_path / f"AOM001.{ending}")
        assert {c.name: c.orientation for c in record.channels} == {"N-S": NORTH, "E-W": EAST, "U-D": UP}
        assert not {"record_peak_stated", "record_peak_time"} & set(codes(record.findings))
    north = next(c for c in record.channels if c.name == "N-S")
    _same(north.accel_m_s2, THREE[0] - THREE[0].mean(), COUNTS_M_S2)


def test_kik_net_s_borehole_and_surface_are_two_records(tmp_path: Path) -> None:
    for number, name in enumerate(("NS1", "EW1", "UD1", "NS2", "EW2", "UD2"), start=1):
        layouts.knet(tmp_path / f"AICH04.{name}", THREE[0], 200, str(number))
    surface = read_record(tmp_path / "AICH04.EW2")
    assert sorted(channel.name for channel in surface.channels) == ["EW2", "NS2", "UD2"]
    assert surface.facts["sensor"] == "surface"
    assert {c.name: c.orientation for c in surface.channels} == {"NS2": NORTH, "EW2": EAST, "UD2": UP}
    assert read_record(tmp_path / "AICH04.UD1").facts["sensor"] == "borehole"


def test_volumes_1(tmp_path: Path) -> None:
    nineties = read_file(BUILDERS["CSMIP V1 1990s"](tmp_path)).channels[0]
    assert nineties.dt_s == 0.005
    _same(nineties.accel_m_s2, THREE[0], 1e-6 * GRAVITY)
    csmip = read_file(BUILDERS["CSMIP V1"](tmp_path))
    assert [c.orientation for c in csmip.channels] == [EAST, UP]
    _same(csmip.channels[0].accel_m_s2, THREE[0], 1e-6 * GRAVITY)
    for name, direction, within in (
        ("CSMIP V1 film", EAST, TENTH_G_3), ("USC V1", NORTH, TENTH_G_3),
        ("RENADIC V1", ChannelOrientation(0.0, sense_assumed=True), TENTH_G_3),
    ):  # fmt: skip
        channel = read_file(BUILDERS[name](tmp_path)).channels[0]
        assert channel.orientation == direction
        assert channel.dt_s == (0.005 if "film" in name else 0.01)
        _same(channel.accel_m_s2, THREE[0], within)
    bhrc = read_file(BUILDERS["BHRC V1"](tmp_path))
    assert [c.orientation for c in bhrc.channels] == [ChannelOrientation(177.0), UP, ChannelOrientation(267.0)]
    assert bhrc.channels[2].dt_s == 0.005
    _same(bhrc.channels[2].accel_m_s2, THREE[2], 1e-6 * GRAVITY)


def test_times_of_100_s_touch_the_value_before_them(tmp_path: Path) -> None:
    accel = wave(10_400, peak_m_s2=9.0)
    path = layouts.volume1(tmp_path / "a.v1", [(accel, "NS")], 0.01, "RENADIC")
    path.write_text(path.read_text().replace(" 100.000", "100.000"))
    found = read_file(path).channels[0]
    assert found.dt_s == 0.01
    _same(found.accel_m_s2, accel, TENTH_G_3)


def test_film_keeps_every_sample_and_its_peak(tmp_path: Path) -> None:
    """USC's steps of 4.26 ms are printed to 1 ms: a clock of 1 ms meets every printed sample (fails: the smallest step)."""
    t_s = np.array([float(f"{0.00426 * i:.3f}") for i in range(400)])
    path = layouts.volume1(tmp_path / "017m30bt.s0a", [(THREE[0], "N00W")], 0.00426, "USC")
    channel = read_file(path).channels[0]
    assert channel.dt_s == pytest.approx(0.001)
    _same(np.interp(t_s, channel.t_s, channel.accel_m_s2), THREE[0], TENTH_G_3)


def test_smc_in_pairs_keeps_its_peak_where_no_clock_meets_all_times(tmp_path: Path) -> None:
    t_s = np.array([float(f"{t:.4e}") for t in 0.00149731 * np.arange(9000)])
    accel = wave(9000, 0.0015, peak_m_s2=2.5)
    record = read_record(layouts.smc_pairs(tmp_path / "a.smc", t_s, accel))
    found = record.channels[0].accel_m_s2
    assert np.abs(found).max() == pytest.approx(2.5, rel=1e-4)
    assert not {"record_peak_stated", "record_peak_time"} & set(codes(record.findings))


def test_tables_of_three_columns(tmp_path: Path) -> None:
    nsmn, unam, cwb = (read_file(BUILDERS[name](tmp_path)) for name in ("NSMN (AFAD)", "UNAM", "CWB"))
    assert [c.name for c in nsmn.channels] == ["N-S", "E-W", "U-D"]
    assert [c.orientation for c in unam.channels] == [UP, NORTH, EAST]
    assert [c.orientation for c in cwb.channels] == [UP, NORTH, EAST]
    for record, dt_s, within in ((nsmn, 0.01, GAL_6), (unam, 0.005, GAL_6 * 100.0), (cwb, 0.005, GAL_3)):
        for channel, accel in zip(record.channels, THREE, strict=True):
            assert channel.dt_s == dt_s
            assert channel.stated_peak_m_s2 is not None
            assert abs(channel.stated_peak_m_s2) == pytest.approx(np.abs(accel).max(), rel=1e-4)
            _same(channel.accel_m_s2, accel, within)


def test_cosmos_of_today(tmp_path: Path) -> None:
    in_g = read_file(BUILDERS["COSMOS"](tmp_path))
    assert in_g.unit == "g"
    _same(in_g.channels[0].accel_m_s2, THREE[0], 1e-6 * GRAVITY)
    counts = read_file(BUILDERS["COSMOS V0"](tmp_path))
    factor = 0.794729e-6 / 1.2 * GRAVITY
    expected = np.round(THREE[0] * 1e5) * factor
    _same(counts.channels[0].accel_m_s2, expected - expected.mean(), 1e-12)
    (told,) = [each for each in counts.findings if each.code == "record_rest_taken_off"]
    assert told.values["rest_g"] == pytest.approx(-0.65, abs=0.01)
    line = "   {n} acceleration pts, approx  {s} secs, units=cm/sec2(04),Format=(8f9.6)"
    upright = read_file(layouts.cosmos_of_today(tmp_path / "z.V2C", THREE[0], 0.005, 0, line, seed="BNZ")).channels[0]
    assert upright.orientation == UP


def refused(path: Path, there: str, changed: str, match: str) -> None:
    """A file with other words in the place of some is refused, and why."""
    text = path.read_text()
    assert there in text
    path.write_text(text.replace(there, changed))
    with pytest.raises(InputError, match=match):
        read_file(path)


def test_what_holds_no_accelerations_is_said_to(tmp_path: Path) -> None:
    of_accelerations, of_velocities = "ACCELERATION TIME SERIES IN UNITS OF G", "VELOCITY TIME SERIES IN UNITS OF CM/S"
    said = r"line 3: wanted an acceleration in units of g, got 'VELOCITY .* VT2 and DT2"
    refused(BUILDERS["AT2"](tmp_path), of_accelerations, of_velocities, said)
    said = r"line 1: wanted 1 UNCORRECTED or 2 CORRECTED ACCELEROGRAM"
    refused(BUILDERS["SMC"](tmp_path), "2 CORRECTED ACCELEROGRAM", "3 VELOCITY", said)
    spectra = tmp_path / "a.V3"
    spectra.write_text("RESPONSE AND FOURIER AMPLITUDE SPECTRA   CHAN 1\n1 2 3\n")
    with pytest.raises(InputError, match=r"RESPONSE AND FOURIER .*V1, V2"):
        read_file(spectra)


def test_a_record_that_drifts_is_said_to_with_the_cure(tmp_path: Path) -> None:
    def told(accel: Floats) -> bool:
        path = writers.at2(tmp_path / "a.AT2", accel, 0.01, "090")
        return "record_drifts" in codes(read_record(path).findings)

    assert not told(wave(2000))
    assert told(wave(2000) + 0.02)
    assert told(wave(2000) + 0.02 * np.linspace(-1.0, 1.0, 2000))


def test_a_zip_of_several_files_names_them(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "a.zip", "w") as archive:
        for name in ("one.AT2", "two.AT2"):
            archive.writestr(name, "x")
    with pytest.raises(InputError, match=r"a\.zip: .* got 2 files \(one\.AT2, two\.AT2\)"):
        read_file(tmp_path / "a.zip")
    (tmp_path / "cut.zip").write_bytes((tmp_path / "a.zip").read_bytes()[:40])
    with pytest.raises(InputError, match="does not unpack"):
        read_file(tmp_path / "cut.zip")


def test_a_damaged_width_or_time_asks_for_no_endless_memory(tmp_path: Path) -> None:
    """What mutated files found (fail: MemoryError, a warning of numpy's): a width of eleven digits, one row, a time of 1e12 s."""
    refused(BUILDERS["UNAM"](tmp_path), "3F10.4", "3F99999999999.4", "wanted a Fortran format such as")
    table = tmp_path / "a.csv"
    table.write_text(
        "t_s,a_N_g\n" + "".join(f"{t},0.1\n" for t in (0, 1e-9, 3e-9, 1e-8, 1.2e-8)) + "4e-8,0.2\n1e-7,0.2\n"
    )
    with pytest.raises(InputError, match=r"a gap of|steps that make at most"):
        read_file(table)
    refused(BUILDERS["USC V1"](tmp_path), "  3.990", "99999999999.990", r"steps that make at most|increasing times")
    cwb = BUILDERS["CWB"](tmp_path)
    lines = cwb.read_text().splitlines()
    cwb.write_text("\n".join(lines[: next(i for i, line in enumerate(lines) if line[:1] == " ") + 1]))
    with pytest.raises(InputError, match=r": wanted .*, got 1 "):
        read_file(cwb)


@pytest.mark.parametrize(
    "line",
    [
        "{n} POINTS OF ACC DATA EQUALLY SPACED AT {dt} SEC",
        "{n} POINTS OF ACC DATA, EQUALLY SPACED AT {dt} SEC (CM/SEC**2)",
        " {n} POINTS OF ACC DATA EQUALLY SPACED AT .0200 SECONDS, IN CM/SEC/SEC (8F10.3)",
        "{n} POINTS OF INSTRUMENT AND BASELINE CORRECTED ACCEL. DATA EQUALLY SPACED AT  .020 SEC.",
    ],
)
def test_usc_s_second_volume_has_its_unit_on_the_line_or_in_the_peak(tmp_path: Path, line: str) -> None:
    path = layouts.usc_v2(tmp_path / "a.v2", [(THREE[0], "S00E"), (THREE[1], "N90E")], 0.02, line)
    record = read_file(path)
    assert [(channel.name, channel.dt_s) for channel in record.channels] == [("S00E", 0.02), ("N90E", 0.02)]
    for channel, accel in zip(record.channels, THREE, strict=False):
        np.testing.assert_allclose(channel.accel_m_s2, accel, rtol=0.0, atol=GAL_3)
    if "CM" not in line:
        path.write_text(path.read_text().replace("CM/SEC/SEC AT", "G AT"))
        with pytest.raises(InputError, match=r" 10 g, got |line \d+: "):
            read_record(path)
        refused(path, "PEAK ACC", "PEAK POT", "accelerations in cm/sec/sec or g")


def test_nuls_that_fill_lines_or_the_last_block_are_no_text(tmp_path: Path) -> None:
    path = BUILDERS["SMC"](tmp_path)
    plain, text = read_file(path).channels[0].accel_m_s2, path.read_bytes()
    for filled in (
        text + bytes(700), text.rstrip(b"\n") + bytes(3) + b"\x1a" + bytes(90), text.replace(b"\n", bytes(2) + b"\r\n"),
        text.replace(b"\n", b"\n" + bytes(5)),
    ):  # fmt: skip
        path.write_bytes(filled)
        assert np.array_equal(read_file(path).channels[0].accel_m_s2, plain)
    path.write_bytes(text.replace(b" ", b"\0", 900))
    with pytest.raises(InputError, match="got binary data"):
        read_file(path)


@pytest.mark.parametrize("stamp", ["14/11/2010 23:09:19.300", "14/11/2010 23:09:19", "2010-11-14 23:09:19.300"])
def test_dyna_may_write_its_first_sample_as_a_date(tmp_path: Path, stamp: str) -> None:
    plain = read_file(writers.esm(tmp_path / "a.ASC", THREE[0], 0.01, "HNE", "20101114_230919.300")).channels[0]
    dated = read_file(writers.esm(tmp_path / "b.ASC", THREE[0], 0.01, "HNE", stamp)).channels[0]
    assert plain.start_s - dated.start_s == pytest.approx(0.0 if stamp.endswith("300") else 0.3, abs=CLOCK_S)
    assert np.array_equal(plain.accel_m_s2, dated.accel_m_s2)
    with pytest.raises(InputError, match=r"DD/MM/YYYY HH:MM:SS"):
        read_file(writers.esm(tmp_path / "c.ASC", THREE[0], 0.01, "HNE", "14 Nov 2010"))


def test_the_standard_file_of_mexico_needs_no_peaks(tmp_path: Path) -> None:
    path = BUILDERS["UNAM"](tmp_path)
    plain, text = read_file(path), path.read_text()
    others = {
        "none": "\n".join(line for line in text.splitlines() if not line.startswith("ACEL. MAX.")),
        "other": text.replace("ACEL. MAX.(Gal), C1-C6", "ACEL. MAX. (Gal) C1-C6").replace(
            "MAX., C1-C6, EN", "MAX. C1-C6, EN"
        ),
    }
    for name, other in others.items():
        path.write_text(other)
        found = read_file(path)
        assert [c.stated_peak_m_s2 for c in found.channels] == [
            None if name == "none" else c.stated_peak_m_s2 for c in plain.channels
        ]
        assert all(
            np.array_equal(a.accel_m_s2, b.accel_m_s2) for a, b in zip(found.channels, plain.channels, strict=True)
        )


def test_a_text_without_commas_is_not_told_to_have_decimal_ones(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    for line in ("0.02 1.0", "0.02 1.0 2.0 3.0"):
        path.write_text(f"0.00 0.1 0.2\n0.01 0.3 0.4\n{line}\n0.03 0.5 0.6\n")
        with pytest.raises(InputError, match=r": line 3: [^,]*, got \S+ [^,]*$"):
            read_file(path, unit="g")


@pytest.mark.parametrize(("unit", "theirs"), [("mm/s/s", True), ("gal", False)])
def test_without_its_first_line_a_file_of_geonet_is_known_by_its_unit_too(unit: str, theirs: bool) -> None:
    lines = [*["-"] * 12, "Component S90E", f"Accelerations in {unit}", "-", "-"]
    assert (volumes.GEONET.match("\n".join(lines)) is not None) is theirs
