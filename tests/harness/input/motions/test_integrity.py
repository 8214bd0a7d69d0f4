"""Damaged, mislabelled and doubtful files: refused with the line, or said."""

import gzip
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from harness.input.motions.readers import read_record
from harness.model import InputError
from tests.budgets_motions import CSV_DIGITS, RATE_DIGITS
from tests.doubles import codes
from tests.harness.input.motions import writers
from tests.harness.input.motions.writers import wave


def csv(path: Path, accel: writers.Floats, t_s: writers.Floats | None = None, header: str = "t_s,a_UP_ms2") -> Path:
    t_s = 0.01 * np.arange(accel.size) if t_s is None else t_s
    path.write_text("\n".join([header, *(f"{t:.9g},{a:.9g}" for t, a in zip(t_s, accel, strict=True))]) + "\n")
    return path


def _line(number: int, text: str) -> Callable[[list[str]], list[str]]:
    return lambda lines: [*lines[: number - 1], text, *lines[number:]]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (_line(50, "0.48,nan"), "line 50, a_UP_ms2: wanted "),
        (_line(50, "0.48,"), "line 50, a_UP_ms2: wanted "),
        (_line(50, "0.48"), "line 50: wanted 2 "),
        (_line(50, "0,48;1,0"), "line 50, t_s: wanted "),
        (_line(50, "0.47,1.0"), "line 50: wanted "),
        (_line(50, "0.10,1.0"), "line 50: wanted "),
        (lambda lines: [*lines[:60], *lines[90:]], "a gap of 0.31 s from 0.58 s"),
        (lambda lines: [*lines[:-1], "1.9"], "the file is cut off"),
        (lambda lines: lines[:2], "two samples or more"),
        (lambda lines: lines[:1], "a.csv"),
        (lambda lines: [lines[0].replace("_ms2", ""), *lines[1:]], "wanted an acceleration unit"),
        (lambda lines: [lines[0].replace("t_s", "x"), *lines[1:]], "a column of times"),
        (lambda lines: [lines[0], *(f"{line.split(',')[0]},0" for line in lines[1:])], "nothing but zeros"),
        (lambda lines: [""], "an empty file"),
        (lambda lines: ["some words", "and more"], "wanted one of GeoNet V2A"),
    ],
)  # fmt: skip
def test_a_damaged_csv_is_refused(tmp_path: Path, change: Callable[[list[str]], list[str]], said: str) -> None:
    path = csv(tmp_path / "a.csv", wave(200))
    assert read_record(path).channels[0].accel_m_s2.size == 200
    path.write_text("\n".join(change(path.read_text().splitlines())))
    with pytest.raises(InputError) as error:
        read_record(path)
    assert said in str(error.value)
    assert str(path) in str(error.value)


def test_three_hundred_g_names_the_likely_unit(tmp_path: Path) -> None:
    path = csv(tmp_path / "a.csv", wave(peak_m_s2=300.0), header="t_s,a_UP_g")
    with pytest.raises(InputError, match=r"a_UP_g: .* got 300 g in g — .* cm/s2 \(0\.306 g\)"):
        read_record(path)
    limit = csv(tmp_path / "b.csv", wave(peak_m_s2=9.99), header="t_s,a_UP_g")
    assert read_record(limit).unit == "g"


def test_a_unit_that_contradicts_the_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="leave unit out"):
        read_record(csv(tmp_path / "a.csv", wave()), unit="g")
    with pytest.raises(InputError, match=r": unit: .* g, got m/s2"):
        read_record(writers.at2(tmp_path / "a.AT2", wave(), 0.01, "UP"), unit="m/s2")


@pytest.mark.parametrize(
    ("accel", "said"),
    [
        (wave(peak_m_s2=0.001), "record_small"),
        (wave(400)[:150], "record_abrupt"),
        (wave(400)[150:], "record_abrupt"),
        (np.where((np.arange(400) > 180) & (np.arange(400) < 200), 0.5, wave(400)), "record_flat"),
    ],
)
def test_doubtful_records_are_said(tmp_path: Path, accel: writers.Floats, said: str) -> None:
    assert said in codes(read_record(csv(tmp_path / "a.csv", accel)).findings)
    assert read_record(csv(tmp_path / "b.csv", wave(400))).findings == ()


def test_uneven_steps_are_said_and_evened(tmp_path: Path) -> None:
    t_s = np.sort(np.concatenate([0.01 * np.arange(200), [0.505, 0.605]]))
    accel = np.interp(t_s, 0.01 * np.arange(200), wave(200))
    record = read_record(csv(tmp_path / "a.csv", accel, t_s))
    assert codes(record.findings) == ["record_times_uneven"]
    assert record.channels[0].dt_s == pytest.approx(0.005)
    np.testing.assert_allclose(record.channels[0].accel_m_s2[::2], wave(200), atol=1e-8)


def test_times_of_few_digits_are_not_uneven(tmp_path: Path) -> None:
    t_s = np.round(np.arange(400) / 200.0, 4)
    record = read_record(csv(tmp_path / "a.csv", wave(400, 0.005), t_s))
    assert record.findings == ()


@pytest.mark.parametrize("lost", [1, 2, 3])
def test_a_file_that_ends_within_its_last_number_is_refused(tmp_path: Path, lost: int) -> None:
    at2 = writers.at2(tmp_path / "a.AT2", wave(800), 0.01, "UP")
    smc = writers.smc(tmp_path / "a.smc", wave(800), 100.0, 0, 0, 200.0)
    esm = writers.esm(tmp_path / "a.ASC", wave(200), 0.01, "HNE", "20190728_160919.870")
    for path in (at2, smc, esm):
        whole = path.read_text().rstrip()
        path.write_text(whole)
        read_record(path)
        path.write_text(whole[:-lost])
        with pytest.raises(InputError, match=r"cut off|the file is damaged"):
            read_record(path)


@pytest.mark.parametrize("lost", [1, 2, 3])
def test_counts_in_columns_and_even_decimals_tell_that_the_last_number_was_cut(
    data_dir: Path, tmp_path: Path, lost: int
) -> None:
    counts = data_dir / "records" / "originals" / "AOM0011801241951.NS"
    whole = {
        "a.NS": counts.read_text().rstrip(),
        "a.csv": "t_s,a_ms2\n" + "\n".join(f"{0.01 * k:.2f},{value:.4f}" for k, value in enumerate(wave(200))),
        "b.csv": "t_s;a_ms2\n" + "\n".join(f"{k / 100:.2f};{a:.4f}".replace(".", ",") for k, a in enumerate(wave(200))),
    }
    for name, text in whole.items():
        path = tmp_path / name
        path.write_text(text)
        read_record(path)
        path.write_text(text[:-lost])
        with pytest.raises(InputError, match="cut off"):
            read_record(path)
        path.unlink()


@pytest.mark.parametrize("last", ["0.5", "-0.25", "10"])
def test_a_last_number_of_fewer_digits_is_read_where_others_have_as_few(tmp_path: Path, last: str) -> None:
    values = [f"{value:.4g}" for value in wave(200)[:-1]]
    path = tmp_path / "a.csv"
    path.write_text("t_s,a_ms2\n" + "\n".join(f"{0.01 * k:.2f},{value}" for k, value in enumerate([*values, last])))
    assert read_record(path).channels[0].accel_m_s2[-1] == float(last)


def test_a_cut_gzip_and_binary_data_are_refused(tmp_path: Path) -> None:
    whole = gzip.compress(writers.at2(tmp_path / "a.AT2", wave(), 0.01, "UP").read_bytes())
    (tmp_path / "cut.gz").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(InputError, match="does not unpack"):
        read_record(tmp_path / "cut.gz")
    (tmp_path / "binary").write_bytes(bytes(range(256)))
    with pytest.raises(InputError, match="a text file"):
        read_record(tmp_path / "binary")


def test_a_header_that_claims_another_peak_is_said(tmp_path: Path) -> None:
    accel = wave(333, peak_m_s2=3.0)
    accel = accel if accel.max() == np.abs(accel).max() else -accel
    true = read_record(writers.smc(tmp_path / "a.smc", accel, 100.0, 0, 0, 300.0))
    assert "record_peak_stated" not in codes(true.findings)
    false = read_record(writers.smc(tmp_path / "b.smc", accel, 100.0, 0, 0, 310.0))
    (told,) = [each for each in false.findings if each.code == "record_peak_stated"]
    assert told.values["stated_m_s2"] == pytest.approx(3.1)


@pytest.mark.parametrize(
    ("name", "share"),
    [
        *(("ce36456p_CE36456.V2.gz", share) for share in (0.05, 0.5, 0.673, 0.99)),
        *(("20161113_110259_WTMC_20.V2A.gz", share) for share in (0.05, 0.5, 0.673, 0.99)),
        ("20161113_110259_WTMC_20.V2A.gz", 1.0),
    ],
)  # fmt: skip
def test_a_file_that_ends_early_is_refused_even_if_accelerations_are_whole(
    data_dir: Path, tmp_path: Path, name: str, share: float
) -> None:
    """Cut in accelerations, velocities, a channel's header, the last displacements: channels after it were lost in silence."""
    lines = gzip.decompress((data_dir / "records" / name).read_bytes()).decode().splitlines()
    cut = tmp_path / name.removesuffix(".gz")
    cut.write_text("\n".join(lines[: int(share * len(lines) - (share == 1.0))]))
    with pytest.raises(InputError, match="cut off"):
        read_record(cut)


@pytest.mark.parametrize("twice", [False, True])
@pytest.mark.parametrize("share", [0.3, 0.6, 0.75, 0.9])
def test_a_line_lost_or_doubled_anywhere_in_a_geonet_file_is_refused(
    data_dir: Path, tmp_path: Path, share: float, twice: bool
) -> None:
    """All channels after one that was lost began ten samples late."""
    whole = gzip.decompress((data_dir / "records" / "20161113_110259_WTMC_20.V2A.gz").read_bytes())
    lines = whole.decode().splitlines()
    at = int(share * len(lines))
    path = tmp_path / "a.V2A"
    path.write_text("\n".join([*lines[: at + twice], *lines[at + 1 - twice :]]))
    with pytest.raises(InputError):
        read_record(path)


@pytest.mark.parametrize("after", [1, 20])
def test_a_cosmos_file_that_ends_in_a_header_is_refused(tmp_path: Path, after: int) -> None:
    path = writers.cosmos(tmp_path / "a.V2", [(wave(800), 90), (wave(800), 0)], 0.01, milliseconds=False)
    text = path.read_text()
    lines = text.splitlines()
    second = next(i for i in range(1, len(lines)) if "text lines" in lines[i])
    path.write_text("\n".join(lines[: second + after]))
    with pytest.raises(InputError, match="cut off"):
        read_record(path)


@pytest.mark.parametrize("digits", [1, 2, 3])
@pytest.mark.parametrize("dt_s", [0.005, 0.0025, 1.0 / 128.0, 0.001, 0.012])
@pytest.mark.parametrize("start_s", [0.0, 12.347])
def test_times_of_too_few_digits_keep_their_clock(tmp_path: Path, dt_s: float, digits: int, start_s: float) -> None:
    printed = np.round(start_s + dt_s * np.arange(2000), digits)
    record = read_record(csv(tmp_path / "a.csv", wave(2000), printed))
    assert record.channels[0].dt_s == pytest.approx(dt_s, rel=RATE_DIGITS)
    np.testing.assert_allclose(record.channels[0].accel_m_s2, wave(2000), rtol=CSV_DIGITS, atol=CSV_DIGITS)
    assert len(record.channels) == 1


def test_rounded_times_with_samples_missing_are_no_even_clock(tmp_path: Path) -> None:
    kept = np.delete(np.arange(2000), range(900, 907))
    with pytest.raises(InputError, match="increasing times"):
        read_record(csv(tmp_path / "a.csv", wave(2000)[kept], np.round(0.005 * kept, 2)))


@pytest.mark.parametrize("missing", [[300], [300, 301], [20, 300, 550]])
def test_a_missing_sample_is_no_slower_clock(tmp_path: Path, missing: list[int]) -> None:
    kept = np.delete(np.arange(600), missing)
    record = read_record(csv(tmp_path / "a.csv", wave(600)[kept], np.round(0.01 * kept, 2)))
    assert record.channels[0].dt_s == pytest.approx(0.01, rel=RATE_DIGITS)
    np.testing.assert_allclose(record.channels[0].accel_m_s2[kept], wave(600)[kept], rtol=CSV_DIGITS, atol=CSV_DIGITS)


@pytest.mark.parametrize("times", [1, 4])
@pytest.mark.parametrize("filler", [999.99, -999.99, 9999.0, -9999.0, 99999.9, -999.0, -32768.0, 999999.0])
@pytest.mark.parametrize("unit", ["gal", "mms2"])
def test_what_programs_write_for_a_missing_sample_is_none(tmp_path: Path, unit: str, filler: float, times: int) -> None:
    values = np.round(wave(600, peak_m_s2=2.5) * {"gal": 100.0, "mms2": 1000.0}[unit], 4 if unit == "gal" else 0)
    header = f"t_s,a_N_{unit}"
    assert read_record(csv(tmp_path / "good.csv", values, header=header)).channels[0].accel_m_s2.size == 600
    values[100 : 100 + times] = filler
    with pytest.raises(InputError) as error:
        read_record(csv(tmp_path / "a.csv", values, header=header))
    assert [each.key for each in error.value.mistakes] == [f"line 102, a_N_{unit}"]
    assert error.value.mistakes[0].got.startswith(f"{filler:.10g} ({times} such)")


def test_a_sample_may_be_a_filler_s_number_and_a_spike_is_told(tmp_path: Path) -> None:
    passing = np.round(1000.0 * wave(600, peak_m_s2=1.5))
    passing[np.argmin(np.abs(passing - 999.0))] = 999.0
    assert read_record(csv(tmp_path / "a.csv", passing, header="t_s,a_N_mms2")).findings == ()
    spike = wave(600)
    spike[77] = 7.7 * np.abs(spike).max()
    (told,) = [each for each in read_record(csv(tmp_path / "b.csv", spike)).findings if each.code == "record_spikes"]
    assert (told.values["alone"], told.values["samples"]) == (1, 600)
    spike[77] = 1e10
    with pytest.raises(InputError, match=r"a_UP_ms2: .* 1 of 600"):
        read_record(csv(tmp_path / "c.csv", spike))


def test_fortran_s_double_precision_stands_in_a_csv(tmp_path: Path) -> None:
    path = csv(tmp_path / "a.csv", wave(200))
    plain = read_record(path).channels[0].accel_m_s2
    for mark in "Dd":
        path.write_text(
            "t_s,a_UP_ms2\n" + "".join(f"{0.01 * i:.3f},{v:.17E}\n".replace("E", mark) for i, v in enumerate(wave(200)))
        )
        np.testing.assert_allclose(read_record(path).channels[0].accel_m_s2, plain, rtol=CSV_DIGITS, atol=CSV_DIGITS)


def test_a_column_of_the_samples_numbers_is_no_channel_and_no_clock(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("n,t_s,a_N_ms2\n" + "".join(f"{i},{0.01 * i:.2f},{v:.9g}\n" for i, v in enumerate(wave(200), 1)))
    assert [channel.name for channel in read_record(path).channels] == ["a_N_ms2"]
    path.write_text("".join(f"{i} {v:.9g}\n" for i, v in enumerate(wave(200), 1)))
    with pytest.raises(InputError, match=r": column 1: .*--columns 2"):
        read_record(path, unit="m/s2")


@pytest.mark.parametrize("unit", ["(in/s2)", "[ft/s/s]", "(dm s-2)"])
def test_a_unit_that_is_not_known_is_not_replaced(tmp_path: Path, unit: str) -> None:
    with pytest.raises(InputError) as error:
        read_record(csv(tmp_path / "a.csv", wave(200), header=f"t_s,a_N {unit}"), unit="m/s2")
    assert error.value.mistakes[0].got == unit.strip("()[]")
