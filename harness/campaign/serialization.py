"""Results as a store takes them, and histories as bytes and back, exact to the last bit."""

from __future__ import annotations

import json
import zlib
from dataclasses import dataclass
from typing import Final

import numpy as np

from harness.campaign.task import RUN, Answer
from harness.model.history import Array

NOISE_BYTES: Final = 5
"""Low bytes of a difference of neighbouring samples: no two are alike, so they are kept as they are (half the
time of writing a run would else go into compressing noise)."""


def pack(table: Array) -> bytes:
    """Columns (k, n) as bytes: differences of the numbers' bits along time, byte by byte; the high bytes compressed."""
    bits = np.ascontiguousarray(table, dtype="<f8").view("<i8")
    steps = np.diff(bits, axis=1, prepend=np.int64(0))
    planes = np.ascontiguousarray(steps.view(np.uint8).reshape(-1, 8).T)
    packer = zlib.compressobj(1, zlib.DEFLATED, zlib.MAX_WBITS, zlib.DEF_MEM_LEVEL, zlib.Z_RLE)
    return planes[:NOISE_BYTES].tobytes() + packer.compress(planes[NOISE_BYTES:].tobytes()) + packer.flush()


def unpack(data: bytes, columns: int, samples: int) -> Array:
    """The columns (k, n) that were packed. Raises `ValueError` or `zlib.error` for bytes that are damaged."""
    noise = NOISE_BYTES * columns * samples
    planes = np.empty((8, columns * samples), dtype=np.uint8)
    planes[:NOISE_BYTES] = np.frombuffer(data[:noise], dtype=np.uint8).reshape(NOISE_BYTES, -1)
    planes[NOISE_BYTES:] = np.frombuffer(zlib.decompress(data[noise:]), dtype=np.uint8).reshape(8 - NOISE_BYTES, -1)
    steps = np.ascontiguousarray(planes.T).view("<i8").reshape(columns, samples)
    table: Array = np.cumsum(steps, axis=1).view("<f8")
    return table


@dataclass(frozen=True)
class Packed:
    """One result as the store takes it: its row, the seconds that it took, its history with its checksum; or a table."""

    columns: tuple[str, str, str, int, int]
    seconds: float
    history: tuple[str, int, bytes, int] | None
    table: bytes = b""

    @property
    def key(self) -> str:
        """What names it."""
        return self.columns[0]


def record_sum(key: str, kind: str, record: str, has_history: int) -> int:
    """CRC-32 of a result's row."""
    return zlib.crc32(f"{key}\0{kind}\0{has_history}\0{record}".encode())


def history_sum(key: str, columns: str, samples: int, data: bytes) -> int:
    """CRC-32 of a history's row."""
    return zlib.crc32(data, zlib.crc32(f"{key}\0{columns}\0{samples}\0".encode()))


def packed(key: str, answer: Answer) -> Packed:
    """Pack an answer: what costs time is done where it was computed, and the store only writes."""
    # Of a run the order of keys says nothing; of another record it may be that of a table's columns.
    text = json.dumps(answer.record, sort_keys=answer.kind == RUN, allow_nan=False, separators=(",", ":"))
    has_history = int(answer.history is not None)
    row = key, answer.kind, text, has_history
    columns = (*row, record_sum(*row))
    if answer.history is None:
        return Packed(columns, answer.seconds, None, answer.table)
    table = answer.history.columns()
    row_of_history = ",".join(table), answer.history.t_s.size, pack(np.stack(list(table.values())))
    return Packed(columns, answer.seconds, (*row_of_history, history_sum(key, *row_of_history)))
