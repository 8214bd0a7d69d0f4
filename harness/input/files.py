"""The files that a user hands in: where they are, how much of one is read, its encoding, and the numbers in its text."""

import gzip
import io
import math
import os
import re
import stat
import zipfile
import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import IO, Final

import numpy as np
from numpy.typing import NDArray
from pydantic import JsonValue

from harness.model import InputError, Mistake, require, translated

# Where the files that a scene names are: beside the scene, absolute, or in the data folder.

DATA_VARIABLE = "ROCKCHECK_DATA"
_PREFIX = "${" + DATA_VARIABLE + "}"


def data_folder() -> Path:
    """The folder of real scans and records: the variable ROCKCHECK_DATA, else `../shared/data` beside the project."""
    named = os.environ.get(DATA_VARIABLE)
    return Path(named) if named else Path(__file__).resolve().parents[3] / "shared" / "data"


def is_file(path: Path) -> bool:
    """Whether there is such a file; a name too long or with a NUL in it, which the system refuses to look up, is none."""
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def existing_file(file: str, *, base_dir: Path, where: str, key: str) -> Path:
    """The existing file that `file` names: absolute, relative to `base_dir`, or starting with "${ROCKCHECK_DATA}/".

    Raises InputError (with `where` and `key`) where there is no such file.
    """
    require(
        not file.startswith("$") or file.startswith(_PREFIX + "/"),
        where,
        f'a path, of variables only "{_PREFIX}/…"',
        repr(file),
        "write it out",
        key=key,
    )
    path = _named(file, base_dir)
    require(
        is_file(path),
        where,
        "an existing file",
        str(path),
        f"set {DATA_VARIABLE} to the folder of scans and records"
        if file.startswith(_PREFIX)
        else ("" if Path(file).is_absolute() else "a relative path starts at the scene's folder"),
        key=key,
    )
    return path.resolve()


def read_files(content: Mapping[str, JsonValue], source: Path | None) -> list[Path]:
    """The existing files that a scene's content (as read from `source`) names, whatever their keys, and the scene's own."""
    folder = Path() if source is None else source.parent
    named = (_named(text, folder) for text in _texts(content))
    return [*([] if source is None else [source]), *filter(is_file, named)]


def _named(file: str, base_dir: Path) -> Path:
    """The path that a scene's text names."""
    if file.startswith(_PREFIX):
        return data_folder() / file[len(_PREFIX) + 1 :]
    # Unlike that of a Path, it leaves a title that begins with a tilde as it is.
    return base_dir / os.path.expanduser(file)


def _texts(value: object) -> list[str]:
    if isinstance(value, str):
        return [value]
    inside = value.values() if isinstance(value, Mapping) else value if isinstance(value, list) else ()
    return [text for item in inside for text in _texts(item)]


# The text of one, and the numbers in it.

MOST_BYTES: Final = 64 * 2**20
"""Largest text read, unpacked: three components of 20 minutes at 200 Hz with velocities and displacements take 17 MB."""
GZIP_MARK: Final = b"\x1f\x8b"
ZIP_MARK: Final = b"PK\x03\x04"
PACKED: Final = {
    ZIP_MARK: "a ZIP archive",
    b"BZh": "a bzip2 file",
    b"\xfd7zXZ": "an xz file",
    b"7z\xbc\xaf": "a 7z archive",
}
UTF16_MARKS: Final = (b"\xff\xfe", b"\xfe\xff")
FOREIGN: Final = re.compile(r"[^0-9+\-.eE \t]")
"""What no decimal number holds. Python's float also takes underscores, "nan", "infinity" and the digits of other scripts."""
_DOUBLE = re.compile(r"(?<=[0-9.])[dD](?=[+-]?[0-9])")
"""Fortran's mark of an exponent in double precision."""
_BARE_EXPONENT = re.compile(r"(?<=[0-9.])([+-][0-9]{3})$|(?<=\.)([0-9]*)([+-][0-9]{1,2})$")
"""Fortran leaves the E out where an exponent takes three digits; some programs always do (1.234+5)."""


def decimal(text: str) -> float:
    """The decimal number that `text` is, blanks around it and an exponent after D allowed; ValueError for anything else."""
    plain = _DOUBLE.sub("E", text)
    if FOREIGN.search(plain):
        raise ValueError(f"{text!r} is no decimal number")
    return float(plain)


def decimals(texts: Sequence[str]) -> list[float]:
    """`decimal` of each."""
    return list(map(decimal if FOREIGN.search(" ".join(texts)) else float, texts))


def numbers(texts: Sequence[str]) -> list[float]:
    """The same; NaN for one that is no decimal number."""
    try:
        return decimals(texts)
    except ValueError:
        return [decimal(text) if is_decimal(text) else math.nan for text in texts]


def numbers_at_once(lines: Sequence[str], mark: str | None) -> NDArray[np.float64] | None:
    """The numbers (n, k) of lines of one width whose cells `mark` parts (None: blanks); None where a cell is anything else."""
    if not lines or FOREIGN.search(" ".join(lines).replace(mark or " ", " ")):
        return None
    try:
        table = np.loadtxt(lines, delimiter=mark, comments=None, ndmin=2)
    except ValueError:
        return None
    return table if len(table) == len(lines) and np.isfinite(table).all() else None


def is_decimal(text: str) -> bool:
    """Whether a text is a decimal number."""
    try:
        decimal(text)
    except ValueError:
        return False
    return True


def fortran(text: str) -> float:
    """The number that Fortran wrote, its exponent also as D (1D-2) or without a letter (1.0-102); else ValueError."""
    bare = text.strip().replace("D", "E").replace("d", "E")
    return decimal(_BARE_EXPONENT.sub(lambda match: f"{match[2] or ''}E{match[1] or match[3]}", bare))


def must_be_named_in_utf8(path: Path) -> None:
    """InputError for a name that is no text: neither a record nor a page could hold it."""
    try:
        path.name.encode("utf-8")
    except UnicodeEncodeError:
        shown = ascii(str(path).encode("utf-8", "surrogateescape"))[2:-1]
        raise InputError(Mistake(shown, "", "a file name in UTF-8", "other bytes", "rename the file")) from None


def read_bytes(path: Path, what: str, most: int = MOST_BYTES) -> bytes:
    """All of a file, unpacked where it is gzip or a ZIP of one file; InputError for none, one over `most` bytes, a damaged one.

    `what` says in messages what was wanted. No more than `most` bytes are ever unpacked.
    """
    must_be_named_in_utf8(path)
    where, limit = str(path), f"{what} of at most {most / 2**20:.3g} MiB"
    try:
        status = path.stat()
        require(stat.S_ISREG(status.st_mode), where, f"{what} in a file", "something that is no file")
        require(status.st_size <= most, where, limit, f"{status.st_size / 2**20:.3g} MiB")
        raw = path.read_bytes()
    except OSError as error:
        raise InputError(Mistake(where, "", f"{what} that can be read", error.strerror or str(error))) from error
    if not raw.startswith((GZIP_MARK, ZIP_MARK)):
        return raw
    try:
        with _unpacked(raw, where) as stream:
            raw = stream.read(most + 1)
    except InputError:
        raise
    # zipfile asks for a place before the file's begin where a cut archive names one that is not there: a ValueError.
    except (OSError, EOFError, RuntimeError, ValueError, zlib.error, zipfile.BadZipFile) as error:
        got = f"one that does not unpack ({error})"
        raise InputError(Mistake(where, "", "a whole gzip or ZIP file", got, "download it again")) from error
    require(len(raw) <= most, where, limit, "more than that once unpacked", "cut it, or take another file")
    return raw


def _unpacked(raw: bytes, where: str) -> gzip.GzipFile | IO[bytes]:
    """The one file in a gzip or ZIP file, open; InputError for a ZIP of several."""
    if raw.startswith(GZIP_MARK):
        return gzip.open(io.BytesIO(raw))
    archive = zipfile.ZipFile(io.BytesIO(raw))
    names = [name for name in archive.namelist() if not name.endswith("/") and not name.startswith("__MACOSX/")]
    shown = ", ".join(ascii(name)[1:-1] for name in names[:4]) + (", …" if len(names) > 4 else "")
    require(
        len(names) == 1,
        where,
        "a ZIP archive of one file",
        f"{len(names)} files ({shown})",
        "unpack it and name one of them: files of one record find each other",
    )
    return archive.open(names[0])


def decoded(raw: bytes, where: str, what: str, *, latin: bool = False) -> str:
    """Text of UTF-8, of UTF-16 by its mark, where `latin` else of Latin-1; InputError for all else, an empty file too."""
    require(raw.strip(), where, what, "an empty file")
    if raw.startswith(UTF16_MARKS):
        got = "UTF-16 that is cut off or damaged"
        with translated(UnicodeDecodeError, where, "a text file", got, "save it as UTF-8"):
            return raw.decode("utf-16")
    for mark, name in PACKED.items():
        require(not raw.startswith(mark), where, "a text file", name, "unpack it first")
    if b"\x00" in raw:
        # Every other byte of ASCII in UTF-16 is nought; other binary data has no such order.
        half = max(raw[:4096:2].count(0), raw[1:4096:2].count(0)) > 0.9 * len(raw[:4096]) / 2
        got = "UTF-16 without its mark" if half else "binary data"
        advice = "save it as UTF-8" if half else "export it as text"
        raise InputError(Mistake(where, "", "a text file", got, advice))
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        if latin:
            return raw.decode("latin-1")
        got = "text that is not UTF-8"
        raise InputError(Mistake(where, "", "a readable text file", got, "save it as CSV in UTF-8")) from error
