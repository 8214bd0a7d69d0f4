"""Seeded scenes whose pedestal tips: light, narrow and tall, on a floor that holds it."""

from __future__ import annotations

from typing import Final

import numpy as np

from analytic.constants import GRAVITY_M_S2
from analytic.excitation import Excitation, Harmonic, Pulse
from harness.bench.coverage import block
from harness.model.scene import BaseExcitation, Contact, Form, Pedestal, Scene

DURATION_S: Final = 2.0


def tipping_scene(seed: int, duration_s: float = DURATION_S) -> Scene:
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
    return Scene(
        title=f"tipping pedestal, seed {seed}",
        duration_s=duration_s,
        gravity_m_s2=GRAVITY_M_S2,
        form=Form(),
        statue=block(float(mass), left, right, float(height), float(inertia), depth),
        pedestal=pedestal,
        contact=Contact(static, static * float(rng.uniform(0.8, 1.0)), 2.0),
        base_excitation=BaseExcitation(x=motion),
    )
