"""Further networks' files, written line by line as heads of their originals show them, independently of the readers."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from tests.harness.input.motions.writers import GRAVITY, Floats, one_digit_exponent, rows


def _write(path: Path, lines: Sequence[str]) -> Path:
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def knet(path: Path, accel: Floats, rate_hz: int, direction: str, *, rest_counts: int = 12345) -> Path:
    """K-NET, or KiK-net by its direction's number: counts about a rest, eight to a line."""
    counts = np.round(accel * 100.0 / (2000.0 / 8388608)).astype(int)
    peak = np.abs(counts - counts.mean()).max() * 2000.0 / 8388608
    seconds = accel.size // rate_hz
    said = {
        "Origin Time": "2000/10/06 13:30:00", "Lat.": "35.278", "Long.": "133.345", "Depth. (km)": "11", "Mag.": "7.3",
        "Station Code": "AICH04", "Station Lat.": "34.9319", "Station Long.": "137.0568", "Station Height(m)": "5",
        "Record Time": "2000/10/06 13:31:24", "Sampling Freq(Hz)": f"{rate_hz}Hz", "Duration Time(s)": str(seconds),
        "Dir.": direction, "Scale Factor": "2000(gal)/8388608", "Max. Acc. (gal)": f"{peak:.3f}",
        "Last Correction": "2000/10/06 13:00:00", "Memo.": "",
    }  # fmt: skip
    head = [f"{key:<18}{value}" for key, value in said.items()]
    return _write(path, head + rows(counts + rest_counts, 8, "{:8d} "))


def volume1(path: Path, channels: Sequence[tuple[Floats, str]], dt_s: float, network: str) -> Path:
    """CSMIP's volume 1 of today or of film, RENADIC's, USC's (one channel) or BHRC's."""
    lines: list[str] = []
    for i, (accel, name) in enumerate(channels):
        tenths, n = accel / GRAVITY * 10.0, accel.size
        peak_g = accel[np.argmax(np.abs(accel))] / GRAVITY
        at_s = dt_s * int(np.argmax(np.abs(accel)))
        chan = f"CHAN {i + 1:2d}: {name}"
        points = f"NO. OF POINTS = {n:6d}  RECORD LENGTH = {n * dt_s:.3f} SEC"
        units = f"UNITS OF UNCOR ACCEL ARE SEC AND G/10.     MAX  = {peak_g:6.3f} G, AT {at_s:7.3f} SEC"
        head = [
            "UNCORRECTED ACCELEROGRAM DATA              PROCESSED: 05/24/2011",
            "AN EARTHQUAKE",
            "02/27/2010",
            "TRIGGER",
        ]
        head += ["STATION NO. 1", "A TOWN", chan, "AN EARTHQUAKE", "HYPOCENTER", "INSTR PERIOD", points, units, "RMS"]
        ints, reals = ["".join(f"{0:5d}" for _ in range(16))] * 7, ["".join(f"{0.0:10.3f}" for _ in range(8))] * 7
        pairs = np.column_stack([dt_s * np.arange(n), tenths]).ravel()
        body = rows(pairs, 10, "{:7.3f}")
        if network == "CSMIP of the 1990s":
            head[11] = f"UNITS OF UNCOR ACCEL IS G.                 MAX  = {peak_g:6.3f} G, AT {at_s:7.3f} SEC."
            body = [f"{n:5d} POINTS OF ACCEL DATA EQUALLY SPACED AT {dt_s:.3f} SEC.  (UNITS: G)"]
            body += rows(accel / GRAVITY, 8, "{:9.6f}")
        elif network == "CSMIP":
            body = [f" {n:5d} Accelerogram points at {1 / dt_s:.0f} pts/sec in units of g .      Format: (8f9.6)  "]
            body += rows(accel / GRAVITY, 8, "{:9.6f}")
            head = [line.title().replace("/10", "") if k == 11 else line.title() for k, line in enumerate(head)]
        elif network == "USC":
            head[0] = "FILE     1 OF UNCORRECTED ACCELEROGRAM DATA OF VOLUME I:                        "
            head[6] = f"COMP  {name}"
            head[10] = f"NO. OF POINTS =   {n}      DURATION =  {n * dt_s:.3f} SEC      50      "
            head[11] = "UNITS ARE SEC AND G/10                                                  22      "
            body = [" " + line for line in body]
        elif network == "RENADIC":
            head[7] = "UNIVERSIDAD DE CHILE - RENADIC"
        elif network == "BHRC":
            head = [
                "* VOL1DS FILE:  5523/01",
                "Inst Type = SSA-2",
                "Origin Time : 2012/08/11",
                "",
                name[:1],
                "",
                f"COMP {name}",
            ]
            head += [
                "Amand     Station   38.231 N 46.156 E   Altitude 1495m   Azimuth L 177   T 267",
                "Epicenter",
                "INSTR",
            ]
            head += [f"NO. OF POINTS =  {n}      DURATION =  {n * dt_s:.3f}    ", "UNITS ARE SECONDS AND G/10", ""]
            body = rows(tenths, 10, "{:13.6E}")
        lines += [*head, *ints, *reals, *body, f"/&  ----------  END OF DATA FOR CHANNEL {i + 1}  ----------"]
    return _write(path, lines)


def geonet(path: Path, channels: Sequence[tuple[Floats, str]], dt_s: float, *, corrected: bool) -> Path:
    """GeoNet V1A, or V2A with blocks for velocities and displacements; its numbers touch where they are large."""
    lines: list[str] = []
    kind, step = ("Corrected", "Instrument corrected data at") if corrected else (
        "Uncorrected", "Raw readings in units of 1.00 mm/s/s  at intervals of",
    )  # fmt: skip
    for accel, name in channels:
        peak = accel[np.argmax(np.abs(accel))] * 1000.0
        lines += [
            f"{kind} accelerogram 20161113_110256_THZ_20 GNS Science", "Site THZ       41 45 45S  172 54 19E", "Top House",
            "Instrument", "Resolution", "Accelerogram", "Near", "2016 November 13         11:02:56 UT", "Epicentre",
            f"Number of points  {accel.size}    Duration {accel.size * dt_s:.2f} s",
            f"{step} {dt_s:.3f} s", "Data is unfiltered", f"Component {name}",
            f"Acceleration:  Peak {peak:8.1f} mm/s/s at {dt_s * np.argmax(np.abs(accel)):6.2f} s     RMS    54.28 mm/s/s",
            "Velocity record unevaluated", "Displacement record unevaluated",
        ]  # fmt: skip
        lines += ["".join(f"{0:8d}" for _ in range(10))] * 10
        lines += rows(accel * 1000.0, 10, "{:8.1f}") * (3 if corrected else 1)
    return _write(path, lines)


def nsmn(path: Path, three: Sequence[Floats], dt_s: float) -> Path:
    """Türkiye's network, with its accents."""
    gal = np.column_stack(three) * 100.0
    peaks = " ".join(f"({n}) {np.abs(c).max():.6f}" for n, c in zip(("N-S", "E-W", "U-D"), gal.T, strict=True))
    head = [
        "STRONG GROUND MOTION RECORDS OF TURKIYE", "PLACE                   : KüTAHYA GEDİZ", "STATION ID              : 4304",
        "EARTHQUAKE DATE         : 2017/07/20 22:31:09 (GMT)", f"NUMBER OF DATA          : {len(gal)}",
        f"SAMPLING INTERVAL (sec) : {dt_s}", f"RAW PGA VALUES (gal)    : {peaks}", "Copyright",
        "       N-S          E-W          U-D",
    ]  # fmt: skip
    return _write(path, head + ["".join(f"{value:13.6f}" for value in row) for row in gal])


def unam(path: Path, three: Sequence[Floats], dt_s: float) -> Path:
    """UNAM's standard file; columns of ten characters, which touch."""
    gal = np.column_stack(three) * 100.0
    at = [int(np.argmax(np.abs(column))) for column in gal.T]
    peaks = "".join(f"/{column[i]:.4f}" for column, i in zip(gal.T, at, strict=True))
    rule = "---------+" * 8
    head = [
        "*" * 86, "                       INSTITUTO DE INGENIERIA, UNAM", "*" * 86, "ARCHIVO ESTANDAR DE ACELERACION:",
        "VERSION DEL FORMATO                    : 2.0", "CLAVE DE LA ESTACION                   : ACAC",
        "                                       : ICACOS, A 300M DEL CICI", "NUMERO DE CANALES                      : 3",
        "ORIENTACION C1-C6 (rumbo;orientacion)  : /V/N00E/N90E", "ORIENTACION C7-C12 (rumbo;orientacion) : ",
        f"INTERVALO DE MUESTREO, C1-C6 (s)       : {f'/{dt_s}' * 3}", "INTERVALO DE MUESTREO, C7-C12 (s)      : ",
        f"NUM. TOTAL DE MUESTRAS, C1-C6          : {f'/{len(gal)}' * 3}", "NUM. TOTAL DE MUESTRAS, C7-C12         : ",
        f"ACEL. MAX.(Gal), C1-C6                 : {peaks}",
        f"ACEL. MAX., C1-C6, EN LA MUESTRA       : {''.join(f'/{i + 1}' for i in at)}",
        "UNIDADES DE LOS DATOS                  : Gal (cm/s/s)", "FORMATO DATOS (FORTRAN,10 campos/dato) : 3F10.4",
        "DATOS DE ACELERACION:", rule, "   CANAL-1   CANAL-2   CANAL-3", "         V      N00E      N90E", rule,
    ]  # fmt: skip
    return _write(path, head + ["".join(f"{value:10.4f}" for value in row) for row in gal])


def cwb(path: Path, three: Sequence[Floats], dt_s: float) -> Path:
    """Taiwan's, in the order U, N, E."""
    gal = np.column_stack(three) * 100.0
    head = ["#Earthquake Information", "#Origin Time(GMT+08): 2018/02/06-23:50:42", "", "#StationCode: ECU"]
    head += [
        f"#RecordLength(sec): {len(gal) * dt_s:.0f}",
        f"#SampleRate(Hz): {1 / dt_s:.0f}",
        "#AmplitudeUnit:  gal. DCoffset(corr)",
    ]
    head += [f"#AmplitudeMAX. {n}: {c.max():8.3f}~ {c.min():8.3f}" for n, c in zip("UNE", gal.T, strict=True)]
    head += ["#DataSequence: Time U(+); N(+); E(+)", "#Data: 4F10.3 "]
    body = ["".join(f"{value:10.3f}" for value in (dt_s * i, *row)) for i, row in enumerate(gal)]
    return _write(path, head + body)


def smc_pairs(path: Path, t_s: Floats, accel: Floats) -> Path:
    """USGS SMC, uncorrected: times and accelerations in turn, five digits each."""
    text = ["1 UNCORRECTED ACCELEROGRAM", "*", "SOB0D", "     1989  10  18    0004 Somewhere", "Moment Mag=      7.1"]
    text += [
        "station = Town                           component=     45",
        "epicentral dist =",
        "inst type=",
        "*",
        "*",
        "*",
    ]
    ints, reals = [-32768] * 48, [1.7e38] * 50
    ints[12], ints[13], ints[15], ints[16] = 90, 45, 1, 2 * t_s.size
    gal = accel * 100.0
    most, least = int(np.argmax(gal)), int(np.argmin(gal))
    reals[28:32] = [float(t_s[most]), float(gal[most]), float(t_s[least]), float(gal[least])]
    pairs = np.column_stack([t_s, gal]).ravel()
    numbers = ["".join(f"{v:10d}" for v in ints[i : i + 8]) for i in range(0, 48, 8)] + rows(
        np.array(reals), 5, "{:15.7E}"
    )
    body = [one_digit_exponent(float(value)) for value in pairs]
    return _write(path, [*text, *numbers, "|", *("".join(body[i : i + 8]) for i in range(0, len(body), 8))])


CSMIP_V2 = "{n:5d} POINTS OF ACCEL DATA EQUALLY SPACED AT  {dt:.3f} SEC.  (UNITS: CM/SEC/SEC)"
"""The line above the accelerations that CSMIP's second volume has."""


def usc_v2(path: Path, channels: Sequence[tuple[Floats, str]], dt_s: float, line: str, *, whole: bool = False) -> Path:
    """USC's volume 2: 25 text lines, 7 of integers, 13 of reals, then accelerations; last, if `whole`, velocities and so on.

    `line` is the one above the accelerations, {n} and {dt} in it.
    """
    lines: list[str] = []
    for accel, name in channels:
        at = int(np.argmax(np.abs(accel)))
        text = ["CORRECTED ACCELEROGRAM   USC 0003   94.017.1", "NORTHRIDGE", "JANUARY 17, 1994", *["-"] * 21]
        text[8], text[14] = (
            f"COMP {name}",
            f"PEAK ACCELERATION = {100.0 * accel[at]:9.3f} CM/SEC/SEC AT {at * dt_s:7.3f} SEC",
        )
        lines += [
            *text,
            "-",
            *["".join(f"{0:5d}" for _ in range(16))] * 7,
            *["".join(f"{0.0:10.3f}" for _ in range(8))] * 13,
        ]
        lines += [line.format(n=accel.size, dt=dt_s), *rows(100.0 * accel, 8, "{:10.3f}")]
        for what in ("VEL", "DIS") if whole or accel is not channels[-1][0] else ():
            lines += [
                f"{accel.size:5d} POINTS OF {what} DATA EQUALLY SPACED AT {dt_s:.3f} SEC",
                *rows(accel, 8, "{:10.3f}"),
            ]
    return _write(path, lines)


def cosmos_of_today(path: Path, numbers: Floats, dt_s: float, code: int, line: str, *, seed: str = "HNN") -> Path:
    """One COSMOS channel with the data line as CGS and NCSN write it ({n} and {s} in `line`), and what scales counts."""
    ints, reals = [-999] * 100, [-999.0] * 100
    ints[53] = code
    reals[21], reals[41], reals[46], reals[61], reals[62] = 0.794729, 1.2, 1.0, 1000.0 * dt_s, numbers.size * dt_s
    lines = ["Uncorrected acceleration  (Format v01.20 with 13 text lines)", *(f"line {i}" for i in range(2, 14))]
    lines += [" 100 Integer-header values follow on  10 lines, Format = (10I8)"]
    lines += ["".join(f"{v:8d}" for v in ints[i : i + 10]) for i in range(0, 100, 10)]
    lines += [" 100 Real-header values follow on  17 lines, Format =(6F13.6)", *rows(np.array(reals), 6, "{:13.6f}")]
    lines += [" 1 Comment line(s) follow, each starting with a |", f"|<SCNL>23837.{seed}.CE.--   <AUTH>"]
    lines += [line.format(n=numbers.size, s=round(numbers.size * dt_s))]
    form = "{:8d}" if "counts" in line else "{:9.6f}"
    return _write(path, [*lines, *(each.ljust(80) for each in rows(numbers, 10 if "counts" in line else 8, form))])
