"""Varied valid scenes for the tests that hold every sentence of a page against the record: all seeds, nothing chosen by hand."""

import json
from pathlib import Path
from typing import Any

import numpy as np

SEEDS = range(40)
HOSTILE = 'x [/] y <b> "$a_{" \x1b[31m\nred \u202e'
"""A title that would end rich's markup, colour a terminal, begin a formula and turn the direction of writing."""


def content(seed: int) -> dict[str, Any]:
    """The content of a scene file; each seed draws supports, frictions, motions, start and wall of its own."""
    rng = np.random.default_rng(seed)
    h = float(rng.uniform(0.3, 1.2))
    left, right = (float(rng.uniform(0.08, 0.5)) * h for _ in range(2))
    mass = float(rng.uniform(50.0, 2000.0))
    scene: dict[str, Any] = {
        "title": HOSTILE if seed % 5 == 0 else f"scene {seed}",
        "duration_s": 3.0,
        "statue": {
            "mass_kg": mass,
            "centroid_height_m": h,
            "corner_left_m": left,
            "corner_right_m": right,
            "inertia_kg_m2": mass * ((left + right) ** 2 + 4.0 * h * h) / 12.0,
            "height_m": 2.0 * h,
            "depth_m": float(rng.uniform(0.2, 1.0)) * h,
        },
        "contact": {"statue": float(rng.choice([0.15, 0.6, 1.0]))},
        "motion": {},
    }
    if seed % 2:
        floor = 0.0 if seed % 10 == 1 else float(rng.uniform(0.05, 0.7))
        slender = {"width_m": 1.1 * (left + right), "depth_m": h, "height_m": 3.0 * h}
        low = {"width_m": 2.0 * h, "depth_m": 2.0 * h, "height_m": 0.2}
        scene["pedestal"] = {"mass_kg": 0.5 * mass, **(slender if seed % 8 == 5 else low)}
        scene["contact"] |= {"floor_static": floor, "floor_kinetic": 0.8 * floor}
    strength = float(rng.choice([0.02, 0.1, 0.3, 0.8, 50.0], p=[0.3, 0.2, 0.25, 0.2, 0.05]))
    axes = ("x", "y", "z")[: int(rng.choice([0, 1, 1, 1, 2, 3]))]
    for axis in axes:
        scene["motion"][axis] = _motion(rng, strength * (0.5 if axis == "z" else 1.0))
    if seed % 4 == 3 or not axes:
        scene["initial"] = {"theta_rad": float(rng.choice([0.02, -0.05, 0.6, -1.2, 1.49]))}
    if seed % 3 == 2:
        # Beyond the pedestal, and far from a statue that starts at a large lean.
        beyond = max(0.5 * (scene.get("pedestal", {}).get("width_m", 0.0) - left - right), 0.0)
        beyond += 3.0 if abs(scene.get("initial", {}).get("theta_rad", 0.0)) > 0.1 else 0.0
        side = str(rng.choice(["left", "right"]))
        scene["wall"] = {"side": side, "distance_m": beyond + float(rng.uniform(0.05, 0.6))}
    return scene


def _motion(rng: np.random.Generator, amplitude_g: float) -> dict[str, Any]:
    if rng.random() < 0.5:
        hz = float(rng.uniform(0.5, 6.0))
        return {
            "kind": "harmonic",
            "amplitude_g": amplitude_g,
            "frequency_hz": hz,
            "ramp_s": float(rng.choice([0.0, 2.0])),
        }
    shape = str(rng.choice(["rectangular", "one_sine", "ricker"]))
    # Some pulses end after the run does: what they reach then is no part of it.
    start = float(rng.choice([0.1, 2.7]))
    return {"kind": "pulse", "shape": shape, "amplitude_g": amplitude_g, "duration_s": 0.6, "start_s": start}


def scene_toml(scene: dict[str, Any]) -> str:
    """The scene as TOML; its strings are JSON's, its tables inline."""
    return "".join(f"{key} = {_value(value)}\n" for key, value in scene.items())


def _value(value: Any) -> str:
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {_value(item)}" for key, item in value.items()) + " }"
    return json.dumps(value) if isinstance(value, str) else repr(value)


def write_scene(folder: Path, scene: dict[str, Any]) -> Path:
    """The scene's file."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "scene.toml"
    path.write_text(scene_toml(scene), encoding="utf-8")
    return path
