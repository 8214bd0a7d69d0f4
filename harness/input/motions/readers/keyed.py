"""Networks whose files begin with keys and their values; then the numbers of one channel, or columns of several."""

import re
from datetime import datetime
from typing import Final

from harness.input.files import fortran
from harness.input.motions.process import clock_of
from harness.input.motions.recordfile import (
    STANDARD_GRAVITY_M_S2,
    UNITS_M_S2,
    Channel,
    ChannelOrientation,
    Header,
    RecordFile,
    columns,
    first_of,
    fixed_width,
    fortran_format,
    free_format,
    header_count,
    header_number,
    mistake,
    parse_orientation,
)
from harness.model import caution, info, require, required

# PEER's AT2: four header lines, then accelerations in g, one channel in a file.

_NPTS_DT = re.compile(
    r"NPTS\s*=\s*([^\s,]*)[\s,]*DT\s*=\s*([^\s,]*?(?:\s+(?:[ED]?[+-]?\d|M(?:ILLI)?S)[^\s,]*)?)(?=[\s,]|SEC|$)",
    re.IGNORECASE,
)
"""A step goes on to the next word where that is the rest of its number, or a unit that is not the second: neither is left out."""
_NPTS_DT_OLD = re.compile(r"^\s*(\S+?),?\s+(\S+?),?\s+NPTS\s*,\s*DT", re.IGNORECASE)
_ACCELERATION = re.compile(r"ACCEL.*UNITS?\s+OF\s+G\b", re.IGNORECASE)
_AT2_HEADER_LINES = 4


def at2(lines: list[str], where: str) -> RecordFile:
    """The one channel of an AT2 file; InputError where values are missing or are no accelerations in g."""
    points = _NPTS_DT.search(lines[3]) or _NPTS_DT_OLD.search(lines[3])
    wanted, got = "NPTS= …, DT= … with a positive step", repr(lines[3].strip())
    number, step = required(points, where, wanted, got, key="line 4").groups()
    count = header_count(number, where, "line 4", "NPTS")
    dt_s = header_number(step, where, "line 4", "DT in seconds")
    require(
        _ACCELERATION.search(lines[2]),
        where,
        "an acceleration in units of g",
        repr(lines[2].strip()),
        "AT2 is always in g; VT2 and DT2 hold velocities and displacements",
        key="line 3",
    )
    every = free_format(lines[_AT2_HEADER_LINES:], where=where, first_line=_AT2_HEADER_LINES + 1)
    values = first_of(every, count, where, "accelerations")
    found = (caution("record_values_left_out", values=every.size, stated=count),) if every.size > count else ()
    parts = [part.strip() for part in lines[1].split(",")]
    channel = Channel.read(parts[-1] or "1", None, dt_s, values, "g")
    facts = {"event": parts[0], "station": ", ".join(parts[2:-1]) if len(parts) > 3 else parts[1] if parts[1:] else ""}
    return RecordFile(where, "PEER AT2", "g", (channel,), facts, group="|".join(parts[:-1]), findings=found)


# ITACA and ESM (DYNA): header lines "KEY: value", then one acceleration per line, one channel in a file.

_ESM_KEY = re.compile(r"^\s*([A-Z][A-Z0-9_/^() ]*):(.*)$", re.IGNORECASE)
_EPOCH: Final = datetime(1970, 1, 1)
_STAMPS: Final = ("%Y%m%d_%H%M%S.%f", "%d/%m/%Y %H:%M:%S.%f", "%Y/%m/%d %H:%M:%S.%f", "%Y-%m-%d %H:%M:%S.%f")
"""Of DYNA as a rule; the second in files of its version 1.2."""
_CLOCK_KEY = "DATE_TIME_FIRST_SAMPLE_YYYYMMDD_HHMMSS"


def esm(lines: list[str], where: str) -> RecordFile:
    """The one channel of an ESM file; InputError where keys or values are missing."""
    first = next((i for i, line in enumerate(lines) if line.strip() and not _ESM_KEY.match(line)), len(lines))
    head = Header(lines[:first], where)
    kind = _esm_words(head, "DATA_TYPE") or "ACCELERATION"
    require(
        kind.upper() == "ACCELERATION",
        where,
        "ACCELERATION",
        kind,
        "take the file whose name holds .ACC.",
        key="DATA_TYPE",
    )
    dt_s = head.number(_esm_key("SAMPLING_INTERVAL_S"), "SAMPLING_INTERVAL_S and a step")
    count = head.count(_esm_key("NDATA"), "NDATA and how many")
    stream = head.needed(_esm_key("STREAM|COMPONENT|CHANNEL_CODE|CHANNEL"), "STREAM and a channel such as HNE")[0]
    unit = head.unit(_esm_key("UNITS"), "UNITS of cm/s^2, m/s^2 or g")
    values = free_format(lines[first:], where=where, first_line=first + 1)
    require(
        values.size == count,
        where,
        f"{count} accelerations",
        str(values.size),
        "the file is cut off: download it again" if values.size < count else "",
        key="NDATA",
    )
    peak, _ = head.peak(_esm_key(r"PGA_CM/S\^2"))
    peak_s, _ = head.peak(_esm_key("TIME_PGA_S"))
    stated = None if peak is None else peak * UNITS_M_S2["cm/s2"] / UNITS_M_S2[unit]
    start_s = _clock_s(_esm_words(head, _CLOCK_KEY), where)
    channel = Channel.read(stream, None, dt_s, values, unit, (stated, peak_s), start_s)
    facts = {
        "event": _esm_words(head, "EVENT_NAME"),
        "station": f"{_esm_words(head, 'NETWORK')}.{_esm_words(head, 'STATION_CODE')}",
    }
    group = "|".join(
        (_esm_words(head, "EVENT_ID"), facts["station"], _esm_words(head, "LOCATION"), _esm_words(head, "PROCESSING"))
    )
    return RecordFile(where, "ITACA/ESM ASCII", unit, (channel,), facts, group)


def _esm_key(names: str) -> str:
    """The pattern of a line's value by its key, blanks or underscores between the key's words."""
    return rf"^\s*(?:{names.replace('_', '[_ ]')})\s*:(.*)$"


def _esm_words(head: Header, key: str) -> str:
    return head.words(_esm_key(key))


def _clock_s(stamp: str, where: str) -> float:
    """Time of the first sample since _EPOCH, s, so that a record's three files share one clock; 0 where it is not said."""
    if not stamp:
        return 0.0
    whole = stamp if "." in stamp else stamp + ".0"
    for form in _STAMPS:
        try:
            return (datetime.strptime(whole, form) - _EPOCH).total_seconds()
        except ValueError:
            continue
    raise mistake(where, _CLOCK_KEY, "YYYYMMDD_HHMMSS.sss, or DD/MM/YYYY HH:MM:SS.sss", repr(stamp))


# K-NET and KiK-net ASCII (NIED): 17 header lines, then counts times a scale factor; one component in a file.

_SCALE = re.compile(r"([0-9.]+)\s*\(gal\)\s*/\s*([0-9.]+)", re.IGNORECASE)
# NIED's manual: north, east and up are positive. KiK-net numbers its components: 1 to 3 in the borehole, 4 to 6 above it.
_KNET_DIRECTIONS: Final = {
    "N-S": ChannelOrientation(0.0), "E-W": ChannelOrientation(90.0), "U-D": ChannelOrientation(vertical=True),
    **{str(place + add): ChannelOrientation(90.0 * place) for place in (0, 1) for add in (1, 4)},
    "3": ChannelOrientation(vertical=True), "6": ChannelOrientation(vertical=True),
}  # fmt: skip
_KIKNET_NAMES: Final = {"1": "NS1", "2": "EW1", "3": "UD1", "4": "NS2", "5": "EW2", "6": "UD2"}
_KNET_HEADER_LINES: Final = 17


def knet(lines: list[str], where: str) -> RecordFile:
    """The one component of a K-NET or KiK-net file, its mean taken off as NIED does for its peak; InputError where incomplete."""
    first = next((i + 1 for i, line in enumerate(lines) if line.lower().startswith("memo")), _KNET_HEADER_LINES)
    head = Header(lines[:first], where)
    dt_s = 1.0 / head.number(r"^Sampling Freq\D*([0-9.]+)", "'Sampling Freq(Hz)' and the rate")
    scale, place = head.needed(r"^Scale Factor\s+(.*)", "'Scale Factor' and gal for a number of counts")
    factor = "a factor such as 3920(gal)/6182761"
    match = required(_SCALE.fullmatch(scale), where, factor, repr(scale), "the header is damaged", key=place)
    gal, counts = (header_number(part, where, place, "a part of the scale factor") for part in match.groups())
    values = free_format(lines[first:], where=where, first_line=first + 1) * (gal / counts)
    code = head.needed(r"^Dir\.\s+(\S+)", "'Dir.' and N-S, E-W, U-D or 1 to 6")[0].upper()
    require(code in _KNET_DIRECTIONS, where, "N-S, E-W, U-D or 1 to 6", repr(code), "the header is damaged", key="Dir.")
    seconds = head.number(r"^Duration Time\D*([0-9.]+)", "'Duration Time(s)' and the length")
    require(
        values.size >= round(seconds / dt_s),
        where,
        f"{round(seconds / dt_s)} numbers, as {seconds:g} s at {dt_s:g} s have",
        str(values.size),
        "the file is cut off",
        key="accelerations",
    )
    mean = float(values.mean())
    kik = code in _KIKNET_NAMES
    channel = Channel.read(
        _KIKNET_NAMES.get(code, code),
        _KNET_DIRECTIONS[code],
        dt_s,
        values - mean,
        "cm/s2",
        head.peak(r"^Max\. Acc\.\D*([0-9.]+)"),
    )
    facts = {"event": head.words(r"^Origin Time\s+(.*)"), "station": head.words(r"^Station Code\s+(.*)")}
    if kik:
        facts["sensor"] = "borehole" if code in "123" else "surface"
    found = (
        info("record_rest_taken_off", channel=channel.name, rest_g=mean * UNITS_M_S2["cm/s2"] / STANDARD_GRAVITY_M_S2),
    )
    name = "KiK-net" if kik else "K-NET"
    group = "|".join((*facts.values(), head.words(r"^Record Time\s+(.*)")))
    return RecordFile(where, name, "cm/s2", (channel,), facts, group, found)


# Türkiye's strong-motion network (AFAD, NSMN): "KEY : value" lines, then three columns in gal under N-S, E-W, U-D.

_NSMN_NAMES = re.compile(r"^\s*([NSEWUD]-[NSEWUD])\s+([NSEWUD]-[NSEWUD])\s+([NSEWUD]-[NSEWUD])\s*$", re.IGNORECASE)


def nsmn(lines: list[str], where: str) -> RecordFile:
    """The three channels; InputError where the header or a column is incomplete."""
    named = required(
        next((i for i, line in enumerate(lines) if _NSMN_NAMES.match(line)), None),
        where,
        "a line that names the columns, 'N-S E-W U-D'",
        "none",
        "the file is damaged",
    )
    names = lines[named].upper().split()
    head = Header(lines[:named], where)
    count = head.count(r"^NUMBER OF DATA\s*:(.*)", "'NUMBER OF DATA' and how many")
    dt_s = head.number(r"^SAMPLING INTERVAL\s*\((?i:sec)\)\s*:(.*)", "'SAMPLING INTERVAL (sec)' and a step")
    require(
        head.words(r"PGA VALUES\s*\((gal)\)"),
        where,
        "'PGA VALUES (gal)', which says the unit",
        "none",
        "the header is damaged",
        key="header",
    )
    values = columns(lines[named + 1 :], len(names), where=where, first_line=named + 2)
    require(
        len(values) == count,
        where,
        f"{count} lines of numbers",
        str(len(values)),
        "the file is cut off",
        key="NUMBER OF DATA",
    )
    channels = [
        Channel.read(
            name, None, dt_s, values[:, i], "cm/s2",
            head.peak(rf"PGA VALUES.*\({re.escape(name)}\)\s*([-+.\d]+)"),
        )
        for i, name in enumerate(names)
    ]  # fmt: skip
    facts = {"event": head.words(r"^EARTHQUAKE DATE\s*:(.*)"), "station": head.words(r"^STATION ID\s*:(.*)")}
    return RecordFile(where, "NSMN (AFAD)", "cm/s2", tuple(channels), facts)


# Taiwan's Central Weather Bureau (CWB, today CWA): "#key: value" lines, then time and three columns in gal.


def cwb(lines: list[str], where: str) -> RecordFile:
    """All channels; InputError where the header or a column is incomplete."""
    first = next((i for i, line in enumerate(lines) if line.strip() and not line.lstrip().startswith("#")), len(lines))
    head = Header(lines[:first], where)
    unit = head.unit(r"^#\s*AmplitudeUnit:\s*([^\s,]+?)\.?(?:\s|$)", "'#AmplitudeUnit:' and gal")
    sequence, place = head.needed(r"^#\s*DataSequence:\s*(.*)", "'#DataSequence:' and the columns")
    named = re.findall(r"\b([UNE])\(([+-])\)", sequence.upper())
    require(
        sequence.lower().startswith("time") and named,
        where,
        "'Time U(+); N(+); E(+)'",
        repr(sequence),
        "the header is damaged",
        key=place,
    )
    values = columns(lines[first:], 1 + len(named), where=where, first_line=first + 1)
    clock = clock_of(values[:, 0], where)
    seconds = head.number(r"^#\s*RecordLength\(sec\):\s*([0-9.]+)", "'#RecordLength(sec):' and the length")
    require(
        clock.dt_s * clock.count >= seconds - 1.0,
        where,
        f"about {seconds:g} s",
        f"{clock.dt_s * clock.count:g} s",
        "the file is cut off",
        key="RecordLength(sec)",
    )
    channels = [
        Channel.read(
            name, parse_orientation(name if sense == "+" else {"U": "DOWN", "N": "S", "E": "W"}[name]), clock.dt_s,
            clock.on(values[:, i]), unit, _cwb_peak(head, name), clock.start_s,
        )
        for i, (name, sense) in enumerate(named, start=1)
    ]  # fmt: skip
    facts = {"event": head.words(r"^#\s*Origin Time[^:]*:\s*(.*)"), "station": head.words(r"^#\s*StationCode:\s*(.*)")}
    return RecordFile(where, "CWB", unit, tuple(channels), facts, findings=clock.said)


def _cwb_peak(head: Header, name: str) -> tuple[float | None, None]:
    """The larger of the two peaks, "1.196~ -1.017", that the header claims."""
    most, _ = head.peak(rf"AmplitudeMAX\.\s*{name}:\s*([-+.\d]+)\s*~")
    least, _ = head.peak(rf"AmplitudeMAX\.\s*{name}:\s*[-+.\d]+\s*~\s*([-+.\d]+)")
    return max((peak for peak in (most, least) if peak is not None), key=abs, default=None), None


# UNAM's standard acceleration file (Mexico, also of CICESE's RAC): Spanish "KEY : value" lines, then columns in gal.


def unam(lines: list[str], where: str) -> RecordFile:
    """All channels; InputError where the header or a column is incomplete."""
    rules = [i for i, line in enumerate(lines) if re.match(r"\s*-{5,}\+", line)]
    require(
        len(rules) >= 2,
        where,
        "two ruled lines about the columns' names",
        f"{len(rules)} of them",
        "the file is cut off",
    )
    first = rules[1] + 1
    head = Header(lines[:first], where)
    oriented, _ = head.needed(r"^ORIENTACION C1-C6[^:]*:(.*)", "an orientation")
    names = [part.split(";")[0].strip() for part in _behind_slashes(oriented)]
    steps = _behind_slashes(head.needed(r"^INTERVALO DE MUESTREO, C1-C6[^:]*:(.*)", "a sampling interval")[0])
    counts = _behind_slashes(head.needed(r"^NUM\. TOTAL DE MUESTRAS, C1-C6[^:]*:(.*)", "a number of samples")[0])
    peaks = _behind_slashes(head.words(r"^ACEL\. MAX\.?\s*\(Gal\)[^:]*:(.*)"))
    at = _behind_slashes(head.words(r"^ACEL\. MAX[^:]*EN LA MUESTRA[^:]*:(.*)"))
    require(
        len({len(each) for each in (names, steps, counts)}) <= 1,
        where,
        "as many orientations, intervals and numbers of samples",
        f"{len(names)}, {len(steps)} and {len(counts)}",
        key="header",
    )
    unit = head.unit(r"^UNIDADES DE LOS DATOS\s*:\s*(\S+)", "'UNIDADES DE LOS DATOS' and Gal (cm/s/s)")
    form, place = head.needed(r"^FORMATO DATOS[^:]*:(.*)", "'FORMATO DATOS' and a format such as 3F10.4")
    _, width = fortran_format(form, where, place)
    sizes = [header_count(count, where, "NUM. TOTAL DE MUESTRAS", "a number of samples") for count in counts]
    rows = max(sizes)
    body = [line.ljust(width * len(names))[: width * len(names)].rstrip() for line in lines[first : first + rows]]
    values = fixed_width(body, width, rows * len(names), where=where, first_line=first + 1).reshape(rows, len(names))
    channels = [
        Channel.read(
            name, None, header_number(step, where, "INTERVALO DE MUESTREO", "a step"),
            values[:size, i], unit, _unam_peak(peaks, at, i, step),
        )
        for i, (name, step, size) in enumerate(zip(names, steps, sizes, strict=True))
    ]  # fmt: skip
    facts = {
        "event": head.words(r"^FECHA DEL SISMO[^:]*:(.*)"),
        "station": head.words(r"^CLAVE DE LA ESTACION\s*:(.*)"),
    }
    return RecordFile(where, "UNAM", unit, tuple(channels), facts)


def _behind_slashes(text: str) -> list[str]:
    """The channels' values, which stand behind a slash each."""
    return [part.strip() for part in text.split("/") if part.strip()]


def _unam_peak(peaks: list[str], samples: list[str], i: int, step: str) -> tuple[float | None, float | None]:
    """The header's peak of channel i and its time; the header counts samples from 1."""
    try:
        return fortran(peaks[i]), (fortran(samples[i]) - 1.0) * fortran(step)
    except (IndexError, ValueError):
        return None, None
