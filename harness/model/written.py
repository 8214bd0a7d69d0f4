"""What a scene's file says, read as it was written."""

from __future__ import annotations

from collections.abc import Mapping

from harness.model.scene import Scene


def written(scene: Scene, *keys: str) -> object:
    """What the file has under keys, each in the table of the one before; None where it has nothing."""
    value: object = scene.given
    for key in keys:
        value = value.get(key) if isinstance(value, Mapping) else None
    return value


def scan_azimuth_deg(scene: Scene) -> float:
    """By how much the file turns the scan about the vertical."""
    value = written(scene, "statue", "mesh", "azimuth_deg")
    return float(value) if isinstance(value, int | float) else 0.0
