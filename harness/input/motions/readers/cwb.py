"""Taiwan's Central Weather Bureau (CWB, today CWA): "#key: value" lines, then time and three columns in gal."""

import re

from harness.input.motions.process import clock_of
from harness.input.motions.recordfile import Channel, Header, RecordFile, columns, parse_orientation
from harness.model import require

MARK = re.compile(r"(?=(?s:.{0,4000}?)#stationcode)(?s:.{0,4000}?)#(?:datasequence|amplitudeunit)", re.IGNORECASE)


def read(lines: list[str], where: str) -> RecordFile:
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
            clock.on(values[:, i]), unit, _stated(head, name), clock.start_s,
        )
        for i, (name, sense) in enumerate(named, start=1)
    ]  # fmt: skip
    facts = {"event": head.words(r"^#\s*Origin Time[^:]*:\s*(.*)"), "station": head.words(r"^#\s*StationCode:\s*(.*)")}
    return RecordFile(where, "CWB", unit, tuple(channels), facts, findings=clock.said)


def _stated(head: Header, name: str) -> tuple[float | None, None]:
    """The larger of the two peaks, "1.196~ -1.017", that the header claims."""
    most, _ = head.peak(rf"AmplitudeMAX\.\s*{name}:\s*([-+.\d]+)\s*~")
    least, _ = head.peak(rf"AmplitudeMAX\.\s*{name}:\s*[-+.\d]+\s*~\s*([-+.\d]+)")
    return max((peak for peak in (most, least) if peak is not None), key=abs, default=None), None
