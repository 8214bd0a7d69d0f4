"""The least that a compiled, cached function can be: what a first call costs at all."""

import numba


@numba.njit(cache=True)
def add(x: float) -> float:
    """One more."""
    return x + 1.0
