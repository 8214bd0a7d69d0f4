"""Other bodies made of a statue and its pedestal: both as one, its base widened, another side before the shaking."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from harness.model.history import Array
from harness.model.scene import Pedestal, Scene, Statue


def as_one(statue: Statue, pedestal: Pedestal) -> Statue:
    """The statue fixed to its pedestal: mass, centroid and inertia of both (parallel axes), on the pedestal's base."""
    mass = statue.mass_kg + pedestal.mass_kg
    middle = statue.base_centre_m + pedestal.offset_m
    centres = np.array(
        [[0.0, 0.0, pedestal.height_m + statue.centroid_height_m], [middle, 0.0, pedestal.centroid_height_m]]
    )
    masses = np.array([statue.mass_kg, pedestal.mass_kg])
    centroid = masses @ centres / mass
    w, d, h = pedestal.width_m, pedestal.depth_m, pedestal.height_m
    tensor = statue.inertia_tensor_kg_m2 + pedestal.mass_kg / 12.0 * np.diag(
        [d * d + h * h, w * w + h * h, w * w + d * d]
    )
    for each, centre in zip(masses, centres - centroid, strict=True):
        tensor = tensor + each * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    left, right = float(centroid[0] - middle + 0.5 * w), float(middle + 0.5 * w - centroid[0])
    raised = statue.section_m + np.array([-centroid[0], h])
    return Statue(
        mass_kg=mass,
        centroid_height_m=float(centroid[2]),
        corner_left_m=left,
        corner_right_m=right,
        inertia_kg_m2=float(tensor[1, 1]),
        height_m=statue.height_m + h,
        depth_m=d,
        section_m=np.vstack([[[-left, 0.0], [right, 0.0]], raised]),
        footprint_m=_rectangle(left, right, 0.5 * d, 0.5 * d),
        inertia_tensor_kg_m2=tensor,
    )


def sliding(scene: Scene) -> Scene:
    """The scene's body as one that slides and cannot rock: its mass shared by a pedestal and a plate too flat to lift.

    A rigid body that slides knows no mass: only friction and the floor's motion decide its path.
    """
    half = 0.5 * scene.statue.mass_kg
    low, wide = 0.01, 1.0
    section = np.array([[-wide, 0.0], [wide, 0.0], [wide, 2.0 * low], [-wide, 2.0 * low]])
    plate = Statue(
        half,
        low,
        wide,
        wide,
        half * wide**2 / 3.0,
        2.0 * low,
        wide,
        section,
        _rectangle(wide, wide, 0.5 * wide, 0.5 * wide),
        half * np.eye(3),
    )
    return replace(scene, statue=plate, pedestal=Pedestal(half, 2.0 * wide, wide, low))


def widened(statue: Statue, by_m: float) -> Statue:
    """The statue on a plate fixed to it that reaches `by_m` beyond both corners; the plate itself weighs nothing here."""
    left, right = statue.corner_left_m + by_m, statue.corner_right_m + by_m
    front, back = -float(statue.footprint_m[:, 1].min()) + by_m, float(statue.footprint_m[:, 1].max()) + by_m
    section = np.vstack([[[-left, 0.0], [right, 0.0]], statue.section_m])
    return replace(
        statue,
        corner_left_m=left,
        corner_right_m=right,
        section_m=section,
        footprint_m=_rectangle(left, right, front, back),
        solid=None,
    )


def turned_block(statue: Statue) -> Statue:
    """A block turned by 90 degrees: its depth lies in the rocking plane, and its moment about x decides."""
    half, across = 0.5 * statue.depth_m, statue.corner_left_m + statue.corner_right_m
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    tensor = turn @ statue.inertia_tensor_kg_m2 @ turn.T
    return replace(
        statue,
        corner_left_m=half,
        corner_right_m=half,
        depth_m=across,
        inertia_kg_m2=float(tensor[1, 1]),
        section_m=np.array([[-half, 0.0], [half, 0.0], [half, statue.height_m], [-half, statue.height_m]]),
        # What was left is now in front.
        footprint_m=_rectangle(half, half, statue.corner_left_m, statue.corner_right_m),
        inertia_tensor_kg_m2=tensor,
    )


def _rectangle(left: float, right: float, front: float, back: float) -> Array:
    return np.array([[-left, -front, 0.0], [right, -front, 0.0], [right, back, 0.0], [-left, back, 0.0]])
