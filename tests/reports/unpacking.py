"""Packed data of a page as page.js unpacks it."""

from __future__ import annotations

import gzip

import numpy as np

from reports.pages.assets import LETTERS


def unpacked(packed: str) -> str:
    """The text that `pack_text` packed."""
    size, letters = packed.split(" ")
    places = np.searchsorted(LETTERS, np.frombuffer(letters.encode("ascii"), dtype=np.uint8)).reshape(-1, 2)
    words = (places @ np.array([1, 91])).astype("<u2")
    bits = np.unpackbits(words.view(np.uint8).reshape(-1, 2), axis=1, bitorder="little")[:, :13]
    return gzip.decompress(np.packbits(bits, bitorder="little")[: int(size)].tobytes()).decode("utf-8")
