"""Packed histories come back bit for bit, and take less room than they did."""

import zlib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from harness.runs.store import pack, unpack

SHAPES = st.tuples(st.integers(1, 4), st.integers(1, 30))


@given(arrays(np.float64, SHAPES, elements=st.floats(allow_nan=False)))
def test_every_bit_comes_back(table: np.ndarray) -> None:
    again = unpack(pack(table), *table.shape)
    assert again.tobytes() == np.ascontiguousarray(table).tobytes()


def test_a_smooth_history_is_smaller_than_its_numbers() -> None:
    t = np.arange(10001) * 0.001
    table = np.stack([t, 0.1 * np.sin(3.0 * t), 0.3 * np.cos(3.0 * t), np.zeros_like(t)])
    # Of four columns one is all noise in its low bytes, one is constant.
    assert len(pack(table)) < 0.75 * table.nbytes


def test_damage_is_no_history() -> None:
    data = pack(np.ones((2, 50)))
    for bad in (data[:-8], data[:100], data[:510] + b"\xff" * 20):
        with pytest.raises((ValueError, zlib.error)):
            unpack(bad, 2, 50)
