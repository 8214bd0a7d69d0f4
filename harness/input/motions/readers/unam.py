"""UNAM's standard acceleration file (Mexico, also of CICESE's RAC): Spanish "KEY : value" lines, then columns in gal."""

import re

from harness.input.files import fortran
from harness.input.motions.recordfile import (
    Channel,
    Header,
    RecordFile,
    fixed_width,
    fortran_format,
    header_count,
    header_number,
)
from harness.model import require

MARK = re.compile(r"(?s:.{0,4000}?)ARCHIVO ESTANDAR DE ACELERACI", re.IGNORECASE)


def read(lines: list[str], where: str) -> RecordFile:
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
            values[:size, i], unit, _stated(peaks, at, i, step),
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


def _stated(peaks: list[str], samples: list[str], i: int, step: str) -> tuple[float | None, float | None]:
    """The header's peak of channel i and its time; the header counts samples from 1."""
    try:
        return fortran(peaks[i]), (fortran(samples[i]) - 1.0) * fortran(step)
    except (IndexError, ValueError):
        return None, None
