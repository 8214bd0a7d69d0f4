"""The points of a map, the scene of each, and where engines are asked: at the ends of what the model says alike, and halved."""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise
from typing import Final

import numpy as np
from pydantic import JsonValue

from harness.model.errors import InputError, Mistake
from harness.model.scene import Scene
from harness.statics.rest import LimitsOfRest, limit_of_rest_m_s2, resting_polygon_m
from harness.studies.cases import Base
from harness.studies.file import Value

WEAKEST_G, STRONGEST_G = 0.05, 1.0
SLOWEST_HZ, FASTEST_HZ = 0.8, 8.0
"""A museum floor's strengths and frequencies in an earthquake."""
RESOLUTION: Final = {False: 1.05, True: 1.15}
"""Ratio of neighbouring strengths, of a whole and of a coarse map: a border between classes is known to that."""
FREQUENCIES: Final = {False: 10, True: 5}
FARTHEST: Final = math.log(2.0)
"""Engines are asked at least so often along the logarithm of the strength, whatever the model says."""
RING_DOWN_S: Final = 5.0
"""Time after a pulse in which rocking may still decide."""

Point = tuple[int, int]
"""Number of the frequency, and of the strength."""


@dataclass(frozen=True)
class Plane:
    """Strengths, g, and frequencies, Hz (one None: the scene's own motion), and the scenes at them."""

    base: Base
    scene: Scene
    motion: str
    amplitudes_g: Sequence[float]
    frequencies_hz: Sequence[float | None]

    @classmethod
    def of(cls, scene: Scene, motion: str, *, coarse: bool) -> Plane:
        """The map of a loaded scene. Raises `InputError` for an own motion that is none, or a statue not on its base."""
        if scene.initial.pose is not None:
            raise InputError(Mistake(str(scene.source), "initial", "a statue on its base", "a pose in space"))
        if motion == "scene" and scene.base_excitation.x.peak_m_s2 == 0.0:
            raise InputError(Mistake(str(scene.source), "motion.x", "a motion along x to make stronger", "none"))
        limit_g = limit_of_rest_m_s2(scene) / scene.gravity_m_s2
        low, high = min(WEAKEST_G, 0.8 * limit_g), max(STRONGEST_G, 2.0 * limit_g)
        steps = math.ceil(math.log(high / low) / math.log(RESOLUTION[coarse]))
        frequencies: list[float | None] = [None]
        if motion != "scene":
            frequencies = [*_rounded(np.geomspace(SLOWEST_HZ, FASTEST_HZ, FREQUENCIES[coarse]))]
        amplitudes = _rounded(np.geomspace(low, high, steps + 1))
        return cls(Base(scene.source, scene.given), scene, motion, amplitudes, frequencies)

    @property
    def points(self) -> list[Point]:
        """All points, frequency by frequency."""
        return [(i, j) for i in range(len(self.frequencies_hz)) for j in range(len(self.amplitudes_g))]

    def setting(self, point: Point) -> dict[str, Value]:
        """The keys of the scene at a point: `rockcheck run SCENE --set` takes the same."""
        amplitude, frequency = self.amplitudes_g[point[1]], self.frequencies_hz[point[0]]
        if frequency is None:
            factor = amplitude * self.scene.gravity_m_s2 / self.scene.base_excitation.x.peak_m_s2
            motion = self.base.content["motion"]
            own = motion.get("scale", 1.0) if isinstance(motion, Mapping) else 1.0
            return {"motion.scale": factor * float(own)}  # type: ignore[arg-type]
        x = {"kind": "harmonic", "amplitude_g": amplitude, "frequency_hz": frequency}
        setting: dict[str, object] = {"motion": {"x": x}}
        if self.motion == "pulse":
            duration_s = 1.0 / frequency
            x = {"kind": "pulse", "shape": "one_sine", "amplitude_g": amplitude, "duration_s": duration_s}
            setting = {"motion": {"x": x}, "duration_s": max(self.scene.duration_s, duration_s + RING_DOWN_S)}
        unknown = self.base.content.get("uncertainty")
        if isinstance(unknown, Mapping):
            setting["uncertainty"] = {
                key: _alone(item) for key, item in unknown.items() if not key.startswith("motion.")
            }
        return setting  # type: ignore[return-value]

    def at(self, point: Point) -> Scene:
        """The scene at a point. Raises `InputError` where it is none."""
        return self.base.scene(self.setting(point))

    def at_rest(self, point: Point) -> bool:
        """Whether nothing can move there: the floor's peaks, all at once, are below the limits of a statue at rest."""
        scene = self.at(point)
        polygon = resting_polygon_m(scene.statue) if scene.initial.still else None
        if polygon is None:
            return False
        floor = scene.base_excitation
        x, y, z = floor.x.peak_m_s2, floor.y.peak_m_s2, floor.z.peak_m_s2
        peaks = np.array([[a, b, z] for a in (x, -x) for b in (y, -y)])
        times = np.linspace(0.0, 0.5 * scene.duration_s, len(peaks))
        return LimitsOfRest(scene, polygon, times, peaks).until_s(0.0) >= scene.duration_s

    def without_dimension(self, point: Point) -> tuple[float, float | None]:
        """Strength over g tan α of the weaker side, frequency over p of that side, 1/s."""
        statue = self.scene.statue
        side = 1 if statue.corner_right_m <= statue.corner_left_m else -1
        corner, height = statue.corner_m(side), statue.centroid_height_m
        arm, gravity = math.hypot(corner, height), self.scene.gravity_m_s2
        p = math.sqrt(statue.mass_kg * gravity * arm / self.scene.pivot_inertia_kg_m2[side])
        frequency = self.frequencies_hz[point[0]]
        strength = self.amplitudes_g[point[1]] * height / corner
        return strength, None if frequency is None else frequency / p

    @property
    def farthest(self) -> int:
        """How many strengths may lie from one at which engines were asked to the next."""
        ratio = math.log(self.amplitudes_g[1] / self.amplitudes_g[0])
        return max(1, round(FARTHEST / ratio))


def to_ask(alike: Sequence[Hashable | None], found: Mapping[int, Hashable], farthest: int) -> set[int]:
    """Where engines are to be asked next along one frequency: at the ends of each stretch that the model says `alike` (None:
    decided without), and between two neighbours of what was `found` there that differ or lie too far apart."""
    wanted: set[int] = set()
    for key, stretch in groupby(range(len(alike)), key=lambda j: alike[j]):
        if key is None:
            continue
        inside = list(stretch)
        ends = {inside[0], inside[-1]}
        wanted |= ends - found.keys()
        if ends <= found.keys():
            known = [j for j in inside if j in found]
            wanted |= {
                (a + b) // 2 for a, b in pairwise(known) if b > a + 1 and (found[a] != found[b] or b - a > farthest)
            }
    return wanted


def below(j: int, found: Mapping[int, Hashable]) -> int:
    """The nearest strength under one at which engines were asked."""
    return max(k for k in found if k < j)


def _alone(spread: JsonValue) -> JsonValue:
    """The distribution of a number without what goes with the scene's own motion, which is not there."""
    if isinstance(spread, dict) and str(spread.get("correlated_with", "")).startswith("motion."):
        return {key: value for key, value in spread.items() if key not in ("correlated_with", "rho")}
    return spread


def _rounded(values: np.ndarray[tuple[int], np.dtype[np.float64]]) -> list[float]:
    """Three digits: a point reads the same in a table, on a command line and in the store."""
    return [float(f"{value:.3g}") for value in values]
