"""The paper's statue and pedestal, and a few blocks, as the library's own classes."""

import math
from dataclasses import replace
from typing import Any, Final

from analytic import Block, Harmonic, Pedestal, Solution, simulate
from analytic.block import GRAVITY_M_S2 as GRAVITY

STATUE: Final = Block.two_corners(
    mass_kg=707.0, centroid_height_m=0.774, inertia_kg_m2=152.4, corner_left_m=0.3585, corner_right_m=0.0682
)
PEDESTAL: Final = Pedestal(250.0, 0.60, 0.20)
FREE: Final = Block.rectangle(width_m=0.2, height_m=1.0, mass_kg=100.0)


def shaken(amplitude_g: float, frequency_hz: float, **changes: Any) -> Solution:
    """The statue on its pedestal under a harmonic motion."""
    scene: dict[str, Any] = {
        "pedestal": PEDESTAL,
        "floor_static": 0.20,
        "floor_kinetic": 0.15,
        "duration_s": 4.0,
        "gravity_m_s2": GRAVITY,
    }
    return simulate(STATUE, Harmonic(amplitude_g * GRAVITY, frequency_hz), **(scene | changes))


def rectangle(radius_m: float, alpha_rad: float) -> Block:
    """A homogeneous rectangle of half diagonal R and slenderness α."""
    return Block.rectangle(width_m=2.0 * radius_m * math.sin(alpha_rad), height_m=2.0 * radius_m * math.cos(alpha_rad))


def mirror_image(block: Block) -> Block:
    """The same statue with left and right exchanged."""
    profile = tuple((-x, z) for x, z in reversed(block.profile_m))
    return replace(block, profile_m=profile, base_ends_rad=block.base_ends_rad[::-1])
