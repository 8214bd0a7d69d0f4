"""Scenes that tests build directly: the surveyed statue, with or without its pedestal, and a rectangular block."""

from pathlib import Path

import numpy as np

from analytic.block import GRAVITY_M_S2
from analytic.excitation import Excitation, Harmonic, ZeroExcitation
from harness.model import BaseExcitation, Contact, Form, Initial, Pedestal, Scene, Statue, Wall

SCENES = Path(__file__).parents[1] / "scenes"
"""The scenes that are shipped."""


def block(
    *,
    mass_kg: float,
    corner_left_m: float,
    corner_right_m: float,
    centroid_height_m: float,
    inertia_kg_m2: float,
    height_m: float,
    depth_m: float,
) -> Statue:
    """A statue known by its numbers alone: a rectangular silhouette, four base vertices."""
    left, right, half = corner_left_m, corner_right_m, 0.5 * depth_m
    section = np.array([[-left, 0.0], [right, 0.0], [right, height_m], [-left, height_m]])
    footprint = np.array([[-left, -half, 0.0], [right, -half, 0.0], [right, half, 0.0], [-left, half, 0.0]])
    across = mass_kg * ((left + right) ** 2 / 12.0)
    along = mass_kg * depth_m**2 / 12.0
    lean = max(inertia_kg_m2 - across, 0.0)
    tensor = np.diag([along + lean, inertia_kg_m2, along + across])
    return Statue(mass_kg, centroid_height_m, left, right, inertia_kg_m2, height_m, depth_m, section, footprint, tensor)


def rectangle(width_m: float, height_m: float, *, mass_kg: float = 1000.0, depth_m: float = 0.5) -> Statue:
    """A homogeneous rectangular block."""
    half = 0.5 * width_m
    return block(
        mass_kg=mass_kg,
        corner_left_m=half,
        corner_right_m=half,
        centroid_height_m=0.5 * height_m,
        inertia_kg_m2=mass_kg * (width_m**2 + height_m**2) / 12.0,
        height_m=height_m,
        depth_m=depth_m,
    )


PAESTUM = block(
    mass_kg=707.0,
    corner_left_m=0.3585,
    corner_right_m=0.0682,
    centroid_height_m=0.774,
    inertia_kg_m2=152.4,
    height_m=1.46,
    depth_m=0.72,
)
PAESTUM_PEDESTAL = Pedestal(mass_kg=250.0, width_m=0.60, depth_m=0.80, height_m=0.20)


def paestum(
    amplitude_g: float = 0.429,
    frequency_hz: float = 3.0,
    *,
    pedestal: bool = True,
    mu: float | tuple[float, float] = 0.15,
    restitution: float | None = None,
    duration_s: float = 1.0,
    form: Form | None = None,
    output_dt_s: float = 0.001,
) -> Scene:
    """The surveyed statue under a horizontal harmonic motion; `mu` is one coefficient or (static, kinetic)."""
    motion = Harmonic(amplitude_g * GRAVITY_M_S2, frequency_hz) if amplitude_g else ZeroExcitation()
    return scene(
        PAESTUM,
        motion,
        pedestal=PAESTUM_PEDESTAL if pedestal else None,
        mu=mu,
        restitution=restitution,
        duration_s=duration_s,
        form=form,
        output_dt_s=output_dt_s,
    )


def scene(
    statue: Statue,
    motion_x: Excitation | None = None,
    motion_z: Excitation | None = None,
    *,
    pedestal: Pedestal | None = None,
    mu: float | tuple[float, float] = 0.15,
    mu_statue: float = 1.0,
    restitution: float | None = None,
    duration_s: float = 1.0,
    theta_rad: float = 0.0,
    theta_rate_rad_s: float = 0.0,
    form: Form | None = None,
    wall: Wall | None = None,
    output_dt_s: float = 0.001,
) -> Scene:
    """A scene of its parts."""
    static, kinetic = (mu, mu) if isinstance(mu, float) else mu
    return Scene(
        title="test",
        duration_s=duration_s,
        gravity_m_s2=GRAVITY_M_S2,
        form=form or Form(),
        statue=statue,
        pedestal=pedestal,
        contact=Contact(static, kinetic, mu_statue, restitution),
        base_excitation=BaseExcitation(x=motion_x or ZeroExcitation(), z=motion_z or ZeroExcitation()),
        wall=wall,
        initial=Initial(theta_rad, theta_rate_rad_s),
        output_dt_s=output_dt_s,
    )
