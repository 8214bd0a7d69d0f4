"""Small valid record files as the networks lay them out, from which mutated ones are made."""

from typing import Final

import numpy as np

from tests.harness.input.motions.writers import rows

DT_S: Final = 0.02
SAMPLES: Final = 40


def wave(peak: float, phase: float = 0.0) -> list[float]:
    """A burst of samples that begins and ends near zero."""
    share = np.linspace(0.0, 1.0, SAMPLES)
    values = np.sin(np.pi * share) * np.sin(2.0 * np.pi * 3.0 * share + phase)
    return [float(value) for value in peak * values / np.max(np.abs(values))]


def _joined(lines: list[str]) -> bytes:
    return ("\n".join(lines) + "\n").encode()


def at2() -> bytes:
    """PEER AT2."""
    head = [
        "PEER NGA STRONG MOTION DATABASE RECORD",
        "Somewhere-01, 1/2/1983, A Station, 090",
        "ACCELERATION TIME SERIES IN UNITS OF G",
        f"NPTS= {SAMPLES:6d}, DT= {DT_S:8.4f} SEC,",
    ]
    return _joined([*head, *rows(wave(0.3), 5, "{:15.7E}")])


def v2() -> bytes:
    """CSMIP V2 with two channels."""
    lines: list[str] = []
    for number, azimuth in ((1, 90), (2, 360)):
        values = wave(250.0, 0.3 * number)
        peak = max(values, key=abs)
        head = [
            f"CORRECTED ACCELEROGRAM   00001-S0001-83001.01       CHAN  {number}: {azimuth:3d} DEG",
            "UNCORRECTED ACCELEROGRAM DATA", "SOMEWHERE EARTHQUAKE", "MAY 2, 1983", "00001", "STATION NO. 00001", "A TOWN",
            f"CHAN  {number}: {azimuth:3d} DEG",
        ]  # fmt: skip
        head += ["-"] * 9
        head += [f"PEAK ACCELERATION = {peak:10.3f}    CM/SEC/SEC  AT {DT_S * values.index(peak):8.3f}   SEC."]
        head += (
            ["-"] * 7 + ["".join(f"{0:5d}" for _ in range(16))] * 6 + ["".join(f"{0.0:10.3f}" for _ in range(8))] * 12
        )
        units = {"ACCEL": "CM/SEC/SEC", "VELOC": "CM/SEC", "DISPL": "CM"}
        lines += head
        for what, unit in units.items():
            lines.append(f"{SAMPLES:5d} POINTS OF {what} DATA EQUALLY SPACED AT  {DT_S:.3f} SEC.  (UNITS: {unit})")
            lines += rows(values, 8, "{:10.3f}")
        lines.append(f"/&  ----------  End of data for channel {number} ----------")
    return _joined(lines)


def v2a() -> bytes:
    """GeoNet V2A with two channels."""
    lines: list[str] = []
    for phase, component in ((0.0, "N28W"), (0.5, "Up")):
        values = wave(2500.0, phase)
        peak = max(values, key=abs)
        lines += [
            "Corrected accelerogram 00000000_000000_AAAA_20 GNS Science", "Site AAAA      42 37 10S  173 03 13E", "A farm",
            "Instrument", "Resolution: 18-bit", "Accelerogram", "Near", "2016 November 13         11:02:56 UT", "Epicentre",
            f"Number of points  {SAMPLES}    Duration {SAMPLES * DT_S:.2f} sec",
            f"Instrument corrected data at {DT_S:.3f} sec intervals", "Band-pass filter", f"Component {component}",
            f"Acceleration:  peak {peak:9.1f} mm/s/s at {DT_S * values.index(peak):6.2f} sec     rms    719.0 mm/s/s",
            "Velocity:      peak -1016.55 mm/s   at  46.58 sec", "Displacement:  peak  234.852 mm     at  46.36 sec",
        ]  # fmt: skip
        lines += ["".join(f"{0:8d}" for _ in range(10))] * 4 + ["".join(f"{0.0:8.2f}" for _ in range(10))] * 6
        lines += rows(values, 10, "{:8.1f}") * 3
    return _joined(lines)


def smc() -> bytes:
    """USGS SMC, one channel, one comment."""
    values = wave(90.0)
    most, least = max(values), min(values)
    ints, reals = [-32768] * 48, [1.7e38] * 50
    ints[12], ints[13], ints[15], ints[16] = 90, 45, 1, SAMPLES
    reals[1], reals[28:32] = 1.0 / DT_S, [DT_S * values.index(most), most, DT_S * values.index(least), least]
    head = ["2 CORRECTED ACCELEROGRAM", "*", "CODE", "     1989  10  18    0004 Somewhere", "Moment Mag=      7.1"]
    head += [
        "station = Town, 12 Street              component=     45",
        "epicentral dist =",
        "inst type=",
        "*",
        "*",
        "*",
    ]
    numbers = ["".join(f"{v:10d}" for v in ints[i : i + 8]) for i in range(0, 48, 8)]
    return _joined([*head, *numbers, *rows(reals, 5, "{:15.7E}"), "| a comment", *rows(values, 8, "{:10.3f}")])


def cosmos() -> bytes:
    """COSMOS with two channels."""
    lines: list[str] = []
    for number, code in ((1, 90), (2, 400)):
        ints, reals = [-999] * 100, [-999.0] * 100
        ints[53], reals[33] = code, DT_S
        lines += [f"Corrected acceleration line {i}" for i in range(13)]
        lines.append(" 100 Integer-header values follow on  10 lines, Format= (10I8)")
        lines += ["".join(f"{v:8d}" for v in ints[i : i + 10]) for i in range(0, 100, 10)]
        lines.append(" 100 Real-header values follow on  20 lines, Format= (5F15.6)")
        lines += rows(reals, 5, "{:15.6f}")
        lines += ['   1 Comment line(s) follow, each starting with a "|":', "| nothing"]
        lines.append(f"{SAMPLES:8d} acceleration pts, approx    1 secs, units=cm/s^2 (04),Format=(8F10.5)")
        lines += [*rows(wave(90.0, 0.4 * number), 8, "{:10.5f}"), f"End-of-data for Chan {number} acceleration"]
    return _joined(lines)


def esm() -> bytes:
    """ITACA/ESM ASCII with its header of 64 lines."""
    values = wave(150.0)
    peak = max(values, key=abs)
    known = {
        "EVENT_NAME": "SOMEWHERE", "EVENT_ID": "X-1", "NETWORK": "IT", "STATION_CODE": "ABC",
        "DATE_TIME_FIRST_SAMPLE_YYYYMMDD_HHMMSS": "20120529_070003.000", "SAMPLING_INTERVAL_S": f"{DT_S:.6f}",
        "NDATA": str(SAMPLES), "STREAM": "HNE", "UNITS": "cm/s^2", "PGA_CM/S^2": f"{peak:.6f}",
        "TIME_PGA_S": f"{DT_S * values.index(peak):.6f}", "DATA_TYPE": "ACCELERATION",
    }  # fmt: skip
    head = [f"{key}: {value}" for key, value in known.items()]
    return _joined([*head, *(f"USER{i}: " for i in range(64 - len(known))), *rows(values, 1, "{:.6f}")])


FORMATS: Final = {
    "AT2": ("mutated.at2", at2), "V2": ("mutated.v2", v2), "V2A": ("mutated.v2a", v2a), "SMC": ("mutated.smc", smc),
    "COSMOS": ("mutated.v2c", cosmos), "ESM": ("mutated.asc", esm),
}  # fmt: skip
"""File name and content of each format."""
