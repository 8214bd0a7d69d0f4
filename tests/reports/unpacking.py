"""Packed data of a page as page.js unpacks it."""

import base64
import gzip
from collections.abc import Mapping
from typing import Any

import numpy as np


def unpacked(packed: str) -> str:
    """The text that `pack_text` packed."""
    return gzip.decompress(base64.b64decode(packed)).decode("utf-8")


def numbers(values: Any) -> Any:
    """The values of a curve: packed arrays unpacked (n,), lists as they are."""
    if not isinstance(values, Mapping):
        return values
    steps = np.asarray(values["deltas"], dtype=np.int64)
    for _ in range(values["order"]):
        steps = np.cumsum(steps)
    return steps * values["step"]
