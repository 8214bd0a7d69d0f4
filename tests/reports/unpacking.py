"""Packed data of a page as page.js unpacks it."""

from __future__ import annotations

import gzip
from collections.abc import Mapping
from typing import Any

import numpy as np

from reports.pages.assets import LETTERS


def unpacked(packed: str) -> str:
    """The text that `pack_text` packed."""
    size, letters = packed.split(" ")
    places = np.searchsorted(LETTERS, np.frombuffer(letters.encode("ascii"), dtype=np.uint8)).reshape(-1, 2)
    words = (places @ np.array([1, 91])).astype("<u2")
    bits = np.unpackbits(words.view(np.uint8).reshape(-1, 2), axis=1, bitorder="little")[:, :13]
    return gzip.decompress(np.packbits(bits, bitorder="little")[: int(size)].tobytes()).decode("utf-8")


def numbers(values: Any) -> Any:
    """The values of a curve: packed arrays unpacked (n,), lists as they are."""
    if not isinstance(values, Mapping):
        return values
    steps = np.asarray(values["deltas"], dtype=np.int64)
    for _ in range(values["order"]):
        steps = np.cumsum(steps)
    return steps * values["step"]
