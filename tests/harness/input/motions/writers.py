"""Record files written as the networks lay them out, independently of the readers."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
GRAVITY = 9.80665


def wave(n: int = 200, dt_s: float = 0.01, peak_m_s2: float = 2.0, phase: float = 0.0) -> Floats:
    """A burst that begins and ends at zero, with a definite largest value."""
    share = np.linspace(0.0, 1.0, n)
    values = np.sin(np.pi * share) ** 2 * np.sin(2.0 * np.pi * 2.0 * dt_s * np.arange(n) + phase)
    return np.asarray(values / np.abs(values).max() * peak_m_s2)


def at2(path: Path, accel_m_s2: Floats, dt_s: float, component: str, *, old: bool = False, stuck: bool = False) -> Path:
    """PEER AT2, either header; `stuck` leaves no blanks between values."""
    head = [
        "PEER NGA STRONG MOTION DATABASE RECORD",
        f"Somewhere-01, 1/2/1983, A Station, {component}",
        "ACCELERATION TIME SERIES IN UNITS OF G",
    ]
    n = accel_m_s2.size
    head.append(f"{n:5d}    {dt_s:.4f}    NPTS, DT" if old else f"NPTS= {n:6d}, DT= {dt_s:8.4f} SEC,")
    form = "{:+.7E}" if stuck else "{:15.7E}"
    path.write_text("\n".join(head + rows(accel_m_s2 / GRAVITY, 5, form)) + "\n")
    return path


def rows(values: Floats, per_line: int, form: str) -> list[str]:
    """Numbers in lines."""
    parts = [form.format(value) for value in values]
    return ["".join(parts[i : i + per_line]) for i in range(0, len(parts), per_line)]


def smc(
    path: Path,
    accel_m_s2: Floats,
    rate_hz: float,
    azimuth: int,
    from_vertical: int,
    stated_cm_s2: float,
    *,
    apart: bool = False,
) -> Path:
    """USGS SMC with two comment lines; exponents of one digit make neighbours touch, as in the network's files, or `apart`."""
    text = ["2 CORRECTED ACCELEROGRAM", "*", "CODE", "     1989  10  18    0004 Somewhere", "Moment Mag=      7.1"]
    text += [f"station = Town, 12 Street              component= {azimuth:6d}", "epicentral dist =", "inst type="]
    text += ["*", "*", "*"]
    ints = [-32768] * 48
    ints[12], ints[13], ints[15], ints[16] = from_vertical, azimuth, 2, accel_m_s2.size
    reals = [1.7e38] * 50
    at = int(np.argmax(accel_m_s2)) / rate_hz, int(np.argmin(accel_m_s2)) / rate_hz
    reals[1], reals[28], reals[29], reals[30], reals[31] = rate_hz, at[0], stated_cm_s2, at[1], -1.0
    values = [f"{100.0 * v:10.3f}" if apart else one_digit_exponent(100.0 * v) for v in accel_m_s2]
    body = ["".join(values[i : i + 8]) for i in range(0, len(values), 8)]
    numbers = ["".join(f"{v:10d}" for v in ints[i : i + 8]) for i in range(0, 48, 8)]
    numbers += ["".join(f"{v:15.7E}" for v in reals[i : i + 5]) for i in range(0, 50, 5)]
    path.write_text("\n".join([*text, *numbers, "|", "| a comment", *body]) + "\n")
    return path


def one_digit_exponent(value: float) -> str:
    """Ten characters with an exponent of one digit, as SMC has them."""
    mantissa, exponent = f"{value:.4E}".split("E")
    sign, digits = exponent[0], exponent[1:].lstrip("0") or "0"
    return f"{mantissa}E{sign}{digits}".rjust(10) if len(digits) == 1 else " 0.0000E+0"


def esm(path: Path, accel_m_s2: Floats, dt_s: float, stream: str, first_sample: str) -> Path:
    """ITACA/ESM ASCII with a header of 64 lines."""
    peak = accel_m_s2[np.argmax(np.abs(accel_m_s2))] * 100.0
    known = {
        "EVENT_NAME": "SOMEWHERE", "EVENT_ID": "X-1", "NETWORK": "IT", "STATION_CODE": "ABC",
        "DATE_TIME_FIRST_SAMPLE_YYYYMMDD_HHMMSS": first_sample, "SAMPLING_INTERVAL_S": f"{dt_s:.6f}",
        "NDATA": str(accel_m_s2.size), "STREAM": stream, "UNITS": "cm/s^2", "PGA_CM/S^2": f"{peak:.6f}",
        "TIME_PGA_S": f"{dt_s * np.argmax(np.abs(accel_m_s2)):.6f}", "DATA_TYPE": "ACCELERATION",
    }  # fmt: skip
    filler = [f"USER{i}: " for i in range(64 - len(known))]
    head = [f"{key}: {value}" for key, value in known.items()]
    path.write_text("\n".join([*head, *filler, *(f"{100.0 * value:.6f}" for value in accel_m_s2)]) + "\n")
    return path


def cosmos(path: Path, channels: Sequence[tuple[Floats, int]], dt_s: float, *, milliseconds: bool) -> Path:
    """COSMOS with fixed-width values that touch, one block per channel and direction code."""
    lines: list[str] = []
    for accel, code in channels:
        lines.append("Corrected acceleration   (Format v01.20 with 13 text lines) Src:")
        lines += [f"Corrected acceleration line {i}" for i in range(1, 13)]
        ints = [-999] * 100
        ints[53] = code
        reals = [-999.0] * 100
        reals[33] = dt_s * (1000.0 if milliseconds else 1.0)
        lines.append(" 100 Integer-header values follow on  10 lines, Format= (10I8)")
        lines += ["".join(f"{v:8d}" for v in ints[i : i + 10]) for i in range(0, 100, 10)]
        lines.append(" 100 Real-header values follow on  20 lines, Format= (5F15.6)")
        lines += ["".join(f"{v:15.6f}" for v in reals[i : i + 5]) for i in range(0, 100, 5)]
        lines += ['   1 Comment line(s) follow, each starting with a "|":', "| nothing"]
        seconds = int(accel.size * dt_s)
        lines.append(f"{accel.size:8d} acceleration pts, approx {seconds:4d} secs, units=cm/s^2 (04),Format=(8F10.5)")
        lines += [*rows(100.0 * accel, 8, "{:10.5f}"), "End-of-data for Chan 1 acceleration"]
    path.write_text("\n".join(lines) + "\n")
    return path
