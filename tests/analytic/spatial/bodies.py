"""Bodies of the spatial tests."""

import math
from typing import Any, Final

import numpy as np

from tests.analytic.spatial.reference import Run, initial_state, simulate
from tests.analytic.spatial.reference_body import Array, Case

G: Final = 9.81
MASS, WIDTH, DEPTH, HEIGHT = 500.0, 0.30, 0.40, 1.20
INERTIA: Final = np.diag([77.9167, 75.0, 10.4167])


def base(width: float, depth: float, height: float) -> Array:
    """The four vertices of a block's base, round it from (−, −)."""
    corners = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    return np.array([[sx * width / 2, sy * depth / 2, -height / 2] for sx, sy in corners])


def block_inertia(mass: float, width: float, depth: float, height: float) -> Array:
    """Of a homogeneous block."""
    return np.diag([depth**2 + height**2, width**2 + height**2, width**2 + depth**2]) * mass / 12.0


def one_sine(amplitude_m_s2: float, period_s: float) -> Any:
    """A sin(2πt/T) for one period."""
    return lambda t: amplitude_m_s2 * math.sin(2.0 * math.pi * t / period_s) if t < period_s else 0.0


def known_block(friction: float, **changes: Any) -> Case:
    """A block of 500 kg under one sine along x (0.5 g, 0.5 s) and one along y (0.45 g, 0.6 s)."""
    parts: dict[str, Any] = {
        "accel_x_m_s2": one_sine(0.5 * G, 0.5),
        "accel_y_m_s2": one_sine(0.45 * G, 0.6),
        "breaks_s": (0.5, 0.6),
    }
    return Case(MASS, INERTIA, base(WIDTH, DEPTH, HEIGHT), friction, friction, **(parts | changes))


def standing(case: Case, end_s: float, step_s: float = 0.001) -> Run:
    """A run from rest on the floor."""
    start = initial_state(np.array([0.0, 0.0, -case.vertices_m[0, 2]]))
    return simulate(case, start, np.linspace(0.0, end_s, round(end_s / step_s) + 1))
