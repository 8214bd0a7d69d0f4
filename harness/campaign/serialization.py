"""Histories as bytes and back, exact to the last bit: half the time of writing a run would else go into compressing noise."""

from __future__ import annotations

import zlib
from typing import Final

import numpy as np

from harness.model.history import Array

NOISE_BYTES: Final = 5
"""Low bytes of a difference of neighbouring samples: no two are alike, so they are kept as they are."""


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
