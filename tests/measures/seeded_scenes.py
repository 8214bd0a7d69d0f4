"""Seeded scenes that no setting was tuned on: three generators of planar ones (the first is the bench's own, `random_scene`), one
of scenes in three dimensions."""

import math
from collections.abc import Callable, Mapping
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from analytic.block import GRAVITY_M_S2
from analytic.excitation import Excitation, Harmonic, Pulse, SampledAcceleration
from harness.model import BaseExcitation, Contact, Pedestal, Scene, Statue
from meshes.footprint import reach_m
from tests.measures.coverage import DURATION_S, block, random_scene, seeded

Array = NDArray[np.float64]

TIPPING_S: Final = 2.0
"""A statue that tips with its pedestal has fallen, or come to rest, by then."""
_WIDE: Final = 17
"""Keeps the seeds of wide scenes apart from those of the others."""
_SPACE: Final = 23
"""The same of scenes in three dimensions."""
_RARE: Final = 1
"""Keeps the draws of what few wide scenes have apart from those that all of them make."""
_TIPPING_SHARE: Final = 1.0 / 6.0
_SPATIAL_SHARE: Final = 0.25
_MOST_UP: Final = 0.5
"""More than half of gravity upwards and downwards is a question of flight, not of rocking."""


def wide_scene(seed: int, duration_s: float = DURATION_S) -> Scene:
    """A reproducible scene wider than `random_scene`: sizes 0.1 to 5 m, slenderness 1 to 12 (one in five below 2), any friction.

    Pedestals of 0.05 to 3 statues' mass, half of them with one coefficient of friction, one in six so tall and narrow that it may
    tip; motions by the statue's own frequency, records (and a quarter of the others) along all three axes; a statue that may
    slip on its support. Not all stay in the model's domain.
    """
    rng = np.random.default_rng([seed, _WIDE])
    rare = np.random.default_rng([seed, _WIDE, _RARE])
    height = 0.5 * _log_uniform(rng, 0.1, 5.0)
    slenderness = _log_uniform(rng, 1.0, 2.0) if rng.random() < 0.2 else _log_uniform(rng, 2.0, 12.0)
    base = 2.0 * height / slenderness
    left = base * float(rng.uniform(0.3, 0.7))
    right, depth = base - left, base * float(rng.uniform(0.6, 1.5))
    mass = 2000.0 * 2.0 * height * base * depth
    inertia = mass * (4.0 * height**2 + base**2) / 12.0 * float(rng.uniform(0.7, 1.2))
    statue = block(mass, left, right, height, inertia, depth)
    pedestal = None
    if rng.random() < 0.6:
        width, tall = base * float(rng.uniform(1.1, 2.5)), height * float(rng.uniform(0.1, 0.5))
        if rare.random() < _TIPPING_SHARE:
            width, tall = base * float(rare.uniform(0.9, 1.3)), height * float(rare.uniform(0.6, 2.0))
        pedestal = Pedestal(mass * _log_uniform(rng, 0.05, 3.0), width, 1.2 * depth, tall)
    kinetic = _log_uniform(rng, 0.05, 1.0)
    static = kinetic if rng.random() < 0.5 else kinetic * float(rng.uniform(1.0, 1.4))
    on_support = 2.0 if rng.random() < 0.5 else _log_uniform(rng, 0.3, 1.0)
    own_rad_s = math.sqrt(mass * GRAVITY_M_S2 * math.hypot(height, 0.5 * base) / (inertia + mass * height**2))
    peak = GRAVITY_M_S2 * min(left, right) / height * float(rng.uniform(1.05, 3.0))
    excitation = _wide_motion(rng, peak, own_rad_s * _log_uniform(rng, 1.0, 8.0) / (2.0 * math.pi))
    if rare.random() < _SPATIAL_SHARE and excitation.y.peak_m_s2 == 0.0:
        across, up = (float(share) for share in rare.uniform(0.2, 0.6, 2))
        along = excitation.x
        upwards = min(up, _MOST_UP * GRAVITY_M_S2 / along.peak_m_s2)
        excitation = BaseExcitation(along, along.scaled(across), along.scaled(upwards))
    return seeded(f"wide seed {seed}", duration_s, statue, pedestal, Contact(static, kinetic, on_support), excitation)


def tipping_scene(seed: int, duration_s: float = TIPPING_S) -> Scene:
    """A reproducible scene in which statue and pedestal tip together, or the pedestal under the rocking statue.

    The pedestal is about as wide as the statue's base, 0.6 to 2 times as high as the statue's centroid, of 0.05 to 0.6 times its
    mass; friction holds it up to more than it needs to tip. A harmonic motion or a pulse of 1.1 to 2.5 times what tips both as
    one body.
    """
    rng = np.random.default_rng(seed)
    height = rng.uniform(0.3, 1.2)
    left, right = (float(value) for value in height * rng.uniform(0.15, 0.4, 2))
    mass = rng.uniform(50.0, 900.0)
    depth = 0.8 * (left + right)
    inertia = mass * (height**2 + 0.25 * (left + right) ** 2) / 3.0 * rng.uniform(0.7, 1.2)
    width = float((left + right) * rng.uniform(0.9, 1.3))
    pedestal = Pedestal(float(mass * rng.uniform(0.05, 0.6)), width, depth, float(height * rng.uniform(0.6, 2.0)))
    # Both as one body about the pedestal's edge: the horizontal pull at the common centroid's height against the weight.
    total = mass + pedestal.mass_kg
    common_m = (mass * (pedestal.height_m + height) + 0.5 * pedestal.mass_kg * pedestal.height_m) / total
    arm_m = 0.5 * width - abs(0.5 * (right - left)) * mass / total
    tips = max(arm_m, 0.1 * width) / common_m
    static = float(rng.uniform(1.2, 2.0))
    motion: Excitation
    peak = float(GRAVITY_M_S2 * tips * rng.uniform(1.1, 2.5))
    if rng.random() < 0.5:
        motion = Harmonic(peak, float(rng.uniform(1.0, 4.0)))
    else:
        motion = Pulse("one_sine", peak, float(rng.uniform(0.3, 1.0)), float(rng.uniform(0.0, 0.3)))
    statue = block(float(mass), left, right, float(height), float(inertia), depth)
    contact = Contact(static, static * float(rng.uniform(0.8, 1.0)), 2.0)
    return seeded(f"tipping pedestal, seed {seed}", duration_s, statue, pedestal, contact, BaseExcitation(x=motion))


def space_scene(seed: int, duration_s: float = TIPPING_S) -> Scene:
    """A reproducible scene in three dimensions on the floor: a body turned about the vertical, shaken along x or x and y.

    A convex base of four corners (half of them a rectangle) to eight, slenderness 1.5 to 8, products of inertia in half of them,
    friction from 0.2 to 1.2; a pulse or harmonic of 1.1 to 2.5 times what lifts the body from the base's nearest edge.
    """
    rng = np.random.default_rng([seed, _SPACE])
    height = _log_uniform(rng, 0.2, 1.2)
    half_m = height / _log_uniform(rng, 1.5, 8.0)
    base = _base(rng, half_m)
    mass = 8.0 * 2000.0 * height * half_m * half_m
    statue = _standing(rng, mass, height, base)
    nearest = float(np.min(reach_m(statue.footprint_m, np.arange(0.0, 360.0, 1.0))))
    own_rad_s = math.sqrt(0.75 * GRAVITY_M_S2 / math.hypot(height, half_m))
    motions: list[Excitation] = []
    for share in (1.0, float(rng.uniform(0.2, 1.0)))[: int(rng.integers(1, 3))]:
        peak = share * GRAVITY_M_S2 * nearest / height * float(rng.uniform(1.1, 2.5))
        frequency_hz = own_rad_s * _log_uniform(rng, 1.0, 5.0) / math.tau
        if rng.random() < 0.5:
            motions.append(Harmonic(peak, frequency_hz))
        else:
            motions.append(Pulse("one_sine", peak, 1.0 / frequency_hz, float(rng.uniform(0.0, 0.2))))
    friction = _log_uniform(rng, 0.2, 1.2)
    contact = Contact(friction, friction, friction)
    return seeded(f"space seed {seed}", duration_s, statue, None, contact, BaseExcitation(*motions))


def _base(rng: np.random.Generator, half_m: float) -> Array:
    """A convex base (k, 2) about the origin, counter-clockwise: a rectangle, or corners on an ellipse a tenth apart at least."""
    sides = np.array([half_m, half_m * float(rng.uniform(0.7, 1.5))])
    if rng.random() < 0.5:
        plain = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]) * sides
    else:
        corners = int(rng.integers(4, 9))
        angles = math.tau * (np.arange(corners) + rng.uniform(0.0, 0.5, corners)) / corners
        plain = np.column_stack([np.cos(angles), np.sin(angles)]) * sides
    turn = float(rng.uniform(0.0, math.tau))
    c, s = math.cos(turn), math.sin(turn)
    return np.asarray(plain @ np.array([[c, s], [-s, c]]))


def _standing(rng: np.random.Generator, mass: float, height: float, base: Array) -> Statue:
    """A prism on that base with its centroid at mid-height, moments near the box's, tilted by up to 10° in half of them."""
    extent = np.ptp(base, axis=0)
    # Drawn as mass is spread along each axis: no moment exceeds the other two's sum.
    squares = np.array([*extent**2, 4.0 * height**2]) * rng.uniform(0.8, 1.2, 3)
    tensor = np.diag(mass / 12.0 * (squares.sum() - squares))
    if rng.random() < 0.5:
        axis = rng.normal(size=3)
        tilt = Rotation.from_rotvec(math.radians(10.0) * float(rng.random()) * axis / np.linalg.norm(axis)).as_matrix()
        tensor = tilt @ tensor @ tilt.T
    left, right = -float(base[:, 0].min()), float(base[:, 0].max())
    section = np.array([[-left, 0.0], [right, 0.0], [right, 2.0 * height], [-left, 2.0 * height]])
    feet = np.column_stack([base, np.zeros(len(base))])
    inertia = float(tensor[1, 1])
    return Statue(mass, height, left, right, inertia, 2.0 * height, float(extent[1]), section, feet, tensor)


GENERATORS: Final[Mapping[str, Callable[[int], Scene]]] = {
    "random": random_scene,
    "wide": wide_scene,
    "tipping": tipping_scene,
}


def _log_uniform(rng: np.random.Generator, least: float, most: float) -> float:
    return float(math.exp(rng.uniform(math.log(least), math.log(most))))


def _wide_motion(rng: np.random.Generator, peak_m_s2: float, frequency_hz: float) -> BaseExcitation:
    """A harmonic, a pulse or a record of the given peak along x and main frequency; a record moves along y and z, too."""
    kind = int(rng.integers(3))
    if kind == 0:
        return BaseExcitation(x=Harmonic(peak_m_s2, frequency_hz))
    if kind == 1:
        return BaseExcitation(x=Pulse("one_sine", peak_m_s2, 1.0 / frequency_hz, float(rng.uniform(0.0, 0.3))))
    axes = [_noise(rng, share * peak_m_s2, frequency_hz) for share in (1.0, *rng.uniform(0.2, 0.6, 2))]
    axes[2] = axes[2].scaled(min(1.0, _MOST_UP * GRAVITY_M_S2 / axes[2].peak_m_s2))
    return BaseExcitation(*axes)


def _noise(rng: np.random.Generator, peak_m_s2: float, frequency_hz: float) -> SampledAcceleration:
    """Smoothed noise between no motion at both ends of `DURATION_S`; its samples follow the frequency."""
    count = round(8.0 * frequency_hz * DURATION_S) + 9
    times = np.linspace(0.0, DURATION_S, count)
    smooth = np.convolve(rng.normal(size=count), np.hanning(7), mode="same") * np.sin(np.pi * times / DURATION_S)
    return SampledAcceleration(times, peak_m_s2 * smooth / np.max(np.abs(smooth)))
