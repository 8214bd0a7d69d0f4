"""Files that are written whole or not at all, and that prove to be ours: nothing else is ever replaced.

Every file of a kind that has room for it carries a seal: the checksum of all its bytes before the seal, in a comment (of JSON: in
the last key). A file of which one byte was changed, or that only holds our words, has none.
"""

import errno
import hashlib
import os
import zlib
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path
from secrets import token_hex
from typing import BinaryIO, Final

from harness.model.errors import require

FRESH: Final = ".writing-"
"""What the names begin with of files that are not whole yet."""
MARK: Final = "made by rockcheck, sha256 "
ENDS: Final = {
    ".html": b"",
    ".svg": b"",
    ".pdf": b"",
    ".json": b"\n}\n",
    ".gif": b";",
    ".png": b"\0\0\0\0IEND\xaeB`\x82",
}
"""With what a file of each sealed kind ends: the seal comes before it."""
CHUNK: Final = 1 << 20
NO_ROOM: Final = frozenset({errno.ENOSPC, errno.EDQUOT, errno.EFBIG})
"""What the system says of a disk that is full, or of a file that may not grow."""


def checksum(path: Path) -> str:
    """SHA-256 of a file's bytes."""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def is_sealed(path: Path) -> bool:
    """Whether a file is, byte for byte, as it was written and sealed."""
    kind = path.suffix
    if kind not in ENDS:
        return False
    with path.open("rb") as stream:
        size = stream.seek(0, os.SEEK_END) - len(_seal(kind, "0" * 64))
        return size >= 0 and stream.seek(size) == size and stream.read() == _seal(kind, _digest(stream, size))


def is_own(path: Path, sums: Collection[str] = ()) -> bool:
    """Whether a file may be replaced: none is there, or it is sealed, or has one of these checksums; a link is another's."""
    if not os.path.lexists(path):
        return True
    if path.is_symlink() or not path.is_file():
        return False
    return is_sealed(path) or (bool(sums) and checksum(path) in sums)


def check_own(path: Path, sums: Collection[str] = (), option: str = "") -> None:
    """Raise `InputError` unless a file may be replaced (see `is_own`)."""
    require(
        is_own(path, sums),
        option or str(path),
        "a new file, or one that is as rockcheck wrote it",
        f"{path}, which is another's, or was changed since",
        "move it away",
    )


@contextmanager
def writing(path: Path, sums: Collection[str] = (), *, new: bool = False) -> Iterator[Path]:
    """A name beside `path` that becomes it when all is written, and is removed when not; sealed where its kind can be.

    With `new` a file that is there stays. Raises `InputError` where a file would be lost (see `is_own`); an
    `OSError` names the file.
    """
    if not new:
        check_own(path, sums)
    fresh = path.with_name(f"{FRESH}{token_hex(8)}{path.suffix}")
    try:
        fresh.touch(exist_ok=False)
        yield fresh
        if path.suffix in ENDS:
            _add_seal(fresh, path.suffix)
        if new:
            try:
                os.link(fresh, path)
            except FileExistsError:
                pass
            except OSError:  # a file system without links
                fresh.replace(path)
        else:
            check_own(path, sums)
            fresh.replace(path)
    except OSError as error:
        if error.errno is None or error.filename not in (None, str(fresh)):
            raise
        raise OSError(error.errno, error.strerror, str(path)) from error
    finally:
        if fresh.exists():  # on a read-only file system even what is not there cannot be removed
            fresh.unlink()


def write_text(path: Path, text: str) -> None:
    """Replace a text file in one step, whole or not at all (see `writing`)."""
    # A file's name may be no UTF-8: its odd bytes stand in the text as escapes.
    with writing(path) as fresh, fresh.open("w", encoding="utf-8", errors="backslashreplace") as stream:
        stream.write(text)


def _add_seal(path: Path, kind: str) -> None:
    """Seal a file in its place."""
    with path.open("r+b") as stream:
        size = stream.seek(0, os.SEEK_END) - len(ENDS[kind])
        digest = _digest(stream, size)
        if stream.read() != ENDS[kind]:
            raise ValueError(f"{path}: no end of a {kind}")
        stream.truncate(size)
        stream.seek(size)
        stream.write(_seal(kind, digest))


def _digest(stream: BinaryIO, size: int) -> str:
    """SHA-256 of the first `size` bytes, at the end of which the stream then is."""
    state = hashlib.sha256()
    stream.seek(0)
    while size and (piece := stream.read(min(size, CHUNK))):
        state.update(piece)
        size -= len(piece)
    return state.hexdigest()


def _seal(kind: str, digest: str) -> bytes:
    """The last bytes of a sealed file of that kind."""
    said = (MARK + digest).encode()
    chunk = b"tEXtComment\0" + said
    seals = {
        ".json": b',\n "seal": "%b"' % said,
        ".pdf": b"\n%%%b\n" % said,
        ".gif": b"!\xfe%c%b\0" % (len(said), said),
        ".png": (len(chunk) - 4).to_bytes(4, "big") + chunk + zlib.crc32(chunk).to_bytes(4, "big"),
    }
    return seals.get(kind, b"<!-- %b -->\n" % said) + ENDS[kind]
