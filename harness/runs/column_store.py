"""Results in columns, for studies of millions of cases: one Parquet file for each block of cases; needs the extra [parquet]."""

from __future__ import annotations

import zlib
from collections.abc import Iterator, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Final

from harness.model.errors import InputError, Mistake
from harness.model.files import writing
from harness.records.result_folder import COLUMNS
from harness.runs.store import Packed

if TYPE_CHECKING:
    import pyarrow

COLUMNS_NAME: Final = COLUMNS
"""The folder of such stores in a result folder; each study has one of its own in it."""
SUFFIX: Final = ".parquet"
SECONDS: Final = b"seconds"
"""In the file's own metadata, what its block took."""


def installed() -> bool:
    """Whether columns can be written here."""
    return find_spec("pyarrow") is not None


class ColumnStore:
    """A folder of Parquet files, each a block of results that was written whole or is not there.

    Any program that reads a folder of Parquet files reads it. Raises `InputError` where a file cannot be written or read.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def keys(self) -> set[str]:
        """The blocks that are there; a file without its end (a power cut) counts as none."""
        return {path.stem.rpartition("-")[0] for path in self._files() if self._is_whole(path)}

    def add(self, results: Sequence[Packed], clock_s: float = 0.0) -> None:
        """Write blocks, each as a file of its own whose name holds its checksum."""
        for item in results:
            path = self.folder / f"{item.key}-{zlib.crc32(item.table):08x}{SUFFIX}"
            try:
                self.folder.mkdir(parents=True, exist_ok=True)
                # What is there of this block has no end, else it would not be asked for.
                for torn in self._files(item.key):
                    torn.unlink()
                with writing(path) as fresh:
                    fresh.write_bytes(item.table)
            except OSError as error:
                advice = "free some space and give the command again: what was finished is kept"
                raise InputError(Mistake(str(path), "", "a file that can be written", str(error), advice)) from error

    def tables(self) -> Iterator[pyarrow.Table]:
        """All blocks in the order of their names; what was changed since it was written is refused."""
        import pyarrow
        from pyarrow import parquet

        for path in self._files():
            try:
                data = path.read_bytes()
                if path.stem.rpartition("-")[2] != f"{zlib.crc32(data):08x}":
                    raise OSError("its checksum is another")
                yield parquet.read_table(pyarrow.BufferReader(data))
            except (pyarrow.ArrowException, OSError) as error:
                advice = "remove this file and run the study again: its block is computed anew"
                wanted = "a block of results as it was written"
                raise InputError(Mistake(str(path), "", wanted, str(error), advice)) from error

    def _files(self, key: str = "") -> list[Path]:
        # A write that was killed leaves a file whose name begins with a dot.
        return sorted(path for path in self.folder.glob(f"{key or '*'}-*{SUFFIX}") if not path.name.startswith("."))

    def _is_whole(self, path: Path) -> bool:
        import pyarrow
        from pyarrow import parquet

        try:
            return bool(parquet.read_metadata(path).num_rows)
        except (pyarrow.ArrowException, OSError):
            return False


def as_bytes(table: pyarrow.Table) -> bytes:
    """A block of results as the store keeps it: one row group."""
    import pyarrow
    from pyarrow import parquet

    sink = pyarrow.BufferOutputStream()
    parquet.write_table(table, sink, compression="zstd", row_group_size=table.num_rows)
    return bytes(sink.getvalue())
