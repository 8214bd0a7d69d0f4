"""The networks' own files agree with the CSVs made of them, with their own headers, and with their own velocities."""

import sys
from pathlib import Path

import numpy as np
import pytest

from harness.input.motions.readers import read_file, read_record
from harness.input.motions.recordfile import FORMATS, STANDARD_GRAVITY_M_S2
from harness.input.motions.records import aligned, load
from harness.input.motions.spec import Source
from harness.input.motions.spectra import peak_velocity_m_s
from harness.model import InputError
from tests.budgets_motions import (
    CSV_DIGITS,
    HEADER_DIGITS,
    HEADER_PEAK,
    SAME_MOTION,
    SINGLE_PRECISION_M_S2,
    STATED_VELOCITY,
)
from tests.doubles import codes

GEONET, GEONET_CSV = "20161113_110259_WTMC_20.V2A.gz", "kaikoura2016_WTMC.csv"
CSMIP, CSMIP_CSV = "ce36456p_CE36456.V2.gz", "coalinga1983_PFZ14.csv"


@pytest.fixture(scope="module")
def records(data_dir: Path) -> Path:
    return data_dir / "records"


@pytest.mark.parametrize(
    ("files", "name", "column", "start"),
    [
        *(((GEONET, GEONET_CSV), name, f"a_{name}_ms2", 1000) for name in ("N28W", "S62W", "Up")),
        *(((CSMIP, CSMIP_CSV), name, f"a_{name}_ms2", 0) for name in ("90", "UP", "0")),
    ],
)
def test_an_original_agrees_with_its_csv(
    records: Path, files: tuple[str, str], name: str, column: str, start: int
) -> None:
    (original,) = (each for each in read_record(records / files[0]).channels if each.name == name)
    (csv,) = (each for each in read_record(records / files[1]).channels if each.name == column)
    window = original.accel_m_s2[start : start + csv.accel_m_s2.size]
    np.testing.assert_allclose(csv.accel_m_s2, window, rtol=CSV_DIGITS, atol=CSV_DIGITS)
    assert original.orientation == csv.orientation
    if files[0] == GEONET:
        assert original.dt_s == csv.dt_s == 0.02


def test_channels_of_unequal_length_share_a_clock(records: Path) -> None:
    record = read_record(records / CSMIP)
    assert {c.accel_m_s2.size for c in record.channels} == {3250, 3251}
    assert {series.accel_m_s2.size for series in aligned(record).values()} == {3250}


@pytest.mark.parametrize(
    ("file", "peaks_g"),
    [(GEONET, (0.992, 0.812, 1.838)), (CSMIP, (0.273, 0.097, 0.261)), ("elcentro1940_NS.csv", (0.319,))],
)
def test_published_peaks(records: Path, file: str, peaks_g: tuple[float, ...]) -> None:
    record = read_record(records / file)
    found = [float(np.abs(c.accel_m_s2).max()) / STANDARD_GRAVITY_M_S2 for c in record.channels]
    assert [round(value, 3) for value in found] == list(peaks_g)


@pytest.mark.parametrize(
    ("file", "name", "stated_m_s"), [(GEONET, "N28W", 1.01655), (GEONET, "S62W", 0.68643), (CSMIP, "90", 0.28253)]
)
def test_velocity_agrees_with_the_networks_own(records: Path, file: str, name: str, stated_m_s: float) -> None:
    series = aligned(read_record(records / file))[name]
    assert peak_velocity_m_s(series) == pytest.approx(stated_m_s, rel=STATED_VELOCITY)


def test_the_headers_clock_five_seconds_off_is_said(records: Path) -> None:
    told = [each.values for each in read_record(records / GEONET).findings if each.code == "record_peak_time"]
    assert [each["at_s"] - each["stated_s"] for each in told] == pytest.approx([5.0] * 3, abs=0.005)
    assert not {"record_peak_stated", "record_peak_time"} & set(codes(read_record(records / CSMIP).findings))


def test_the_librarys_reader_still_fails_where_numbers_touch(records: Path, tmp_path: Path) -> None:
    """Why V2A is read here: eqsig splits at blanks, and this file has none between "-6454.0-10565.6" (fails: use eqsig)."""
    import gzip

    from eqsig.loader import load_3_comp_values_and_dt_from_v2a

    plain = tmp_path / "record.V2A"
    plain.write_bytes(gzip.decompress((records / GEONET).read_bytes()))
    with pytest.raises(ValueError, match="inhomogeneous"):
        load_3_comp_values_and_dt_from_v2a(str(plain))


def test_a_motion_is_told_what_concerns_its_own_channel(records: Path) -> None:
    def told(**chosen: object) -> set[str]:
        source = Source.model_validate({"file": GEONET, **chosen})
        found = load(source, base_dir=records, where="scene", key="motion.x")[1]
        return {each.values["channel"] for each in found}

    assert told(column="S62W") == {"S62W"}
    assert told(azimuth_deg=30.0) >= {"N28W", "S62W"}


@pytest.mark.parametrize(
    ("file", "peaks_cm_s2", "dt_s"),
    [
        ("CIWLT.V2.gz", (82.584, -115.845, 69.662), 0.02),
        ("CE58667.V2.gz", (27.114, 11.244, -26.411), 0.01),
        ("Cosmos12TimeSeriesTest.v1", (-161.962,), 0.01),
        ("us1000hyfh_akbmrp_AKBMR--n.1000hyfh.BNZ.--.acc.V2c.gz", (-6.851512,), 0.005),
        ("0111a.smc", (104.4078,), 0.005),
        ("AOM0011801241951.EW", (4.078, 4.954, 2.240), 0.01),
        ("AOM0011801241951.NS", (4.954, 4.078, 2.240), 0.01),
        ("AOM0011801241951.UD", (2.240, 4.078, 4.954), 0.01),
        ("HI.ARS1..HNE.D.20190728.160908.C.ACC.ASC", (0.300022, 0.359017, 0.202093), 0.005),
        ("RSN763_LOMAP_GIL067.AT2", (351.57, 320.31), 0.005),
    ],
)
def test_files_as_networks_write_them_today_have_the_peaks_of_their_headers(
    records: Path, file: str, peaks_cm_s2: tuple[float, ...], dt_s: float
) -> None:
    record = read_record(records / "originals" / file)
    found = [100.0 * float(np.abs(c.accel_m_s2).max()) for c in record.channels]
    np.testing.assert_allclose(found, np.abs(peaks_cm_s2), rtol=HEADER_DIGITS)
    assert {c.dt_s for c in record.channels} == {dt_s}
    assert FORMATS[record.format]


def test_every_original_has_its_header_s_peak_and_sign_to_a_thousandth(records: Path) -> None:
    """All of them but AT2, whose headers state none (fails: K-NET's counts without their mean; V0's with it)."""
    stated: list[str] = []
    for path in sorted((records / "originals").iterdir()):
        record = read_record(path)
        for channel in record.channels:
            if channel.stated_peak_m_s2 is not None:
                stated.append(path.name)
                largest = channel.accel_m_s2[np.argmax(np.abs(channel.accel_m_s2))]
                signed = record.format not in ("K-NET", "KiK-net")  # NIED states sizes
                found, claimed = (float(x if signed else abs(x)) for x in (largest, channel.stated_peak_m_s2))
                assert found == pytest.approx(claimed, rel=HEADER_PEAK), path.name
        assert record.format == "PEER AT2" or path.name in stated


def test_a_vertical_channel_that_its_header_calls_north_is_told(records: Path) -> None:
    record = read_record(records / "originals" / "us1000hyfh_akbmrp_AKBMR--n.1000hyfh.BNZ.--.acc.V2c.gz")
    assert record.channels[0].orientation.vertical
    assert [each.values["seed"] for each in record.findings if each.code == "record_vertical_by_name"] == ["BNZ"]


def test_obspy_reads_the_same_numbers(records: Path) -> None:
    """An oracle: ObsPy's K-NET reader, counts times its calibration, in m/s²."""
    obspy = pytest.importorskip("obspy", reason="ObsPy, the oracle, is not installed")
    for ending in ("EW", "NS", "UD"):
        path = records / "originals" / f"AOM0011801241951.{ending}"
        trace = obspy.read(str(path), apply_calib=True)[0]
        found = read_file(path).channels[0]
        np.testing.assert_allclose(found.accel_m_s2, trace.data - trace.data.mean(), rtol=0.0, atol=SAME_MOTION)
        assert found.dt_s == trace.stats.delta


def test_sac_and_miniseed_are_read_through_obspy(records: Path, tmp_path: Path) -> None:
    """Files that ObsPy wrote of a K-NET record, in m/s²; counts and a missing unit are refused."""
    obspy = pytest.importorskip("obspy", reason="ObsPy, which reads miniSEED and SAC, is not installed")
    source = records / "originals" / "AOM0011801241951.EW"
    expected = read_file(source).channels[0].accel_m_s2
    trace = obspy.read(str(source), apply_calib=True)[0]
    trace.data -= trace.data.mean()
    trace.stats.channel = "HNE"
    for name in ("SAC", "MSEED"):
        path = tmp_path / f"record.{name.lower()}"
        trace.write(str(path), format=name)
        channel = read_file(path, unit="m/s2").channels[0]
        assert channel.orientation.azimuth_deg == 90.0
        np.testing.assert_allclose(channel.accel_m_s2, expected, rtol=0.0, atol=SINGLE_PRECISION_M_S2)
        with pytest.raises(InputError, match=r": unit: .*--motion-unit"):
            read_file(path)
    trace.data = np.round(trace.data * 1e6).astype(np.int32)
    trace.write(str(tmp_path / "counts.mseed"), format="MSEED")
    with pytest.raises(InputError, match=r": HNE: .* remove_sensitivity"):
        read_file(tmp_path / "counts.mseed", unit="m/s2")
    (tmp_path / "cut.mseed").write_bytes((tmp_path / "counts.mseed").read_bytes()[:40])
    with pytest.raises(InputError, match=r"wanted .* miniSEED .*, got \w+: [^<]+$"):
        read_file(tmp_path / "cut.mseed", unit="m/s2")


def test_without_obspy_its_files_are_refused_with_the_cure(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "obspy", None)
    path = tmp_path / "record.mseed"
    path.write_bytes(b"000001D " + bytes(504))
    with pytest.raises(InputError, match=r"wanted ObsPy.*rockcheck\[seed\]"):
        read_file(path)
