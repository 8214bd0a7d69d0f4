"""The points of a map, the scene of each, and where engines are asked: at the ends of what the model says alike, and halved."""

from __future__ import annotations

import json
import math
from collections.abc import Hashable, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import groupby, pairwise
from typing import Any, Final

import numpy as np
from pydantic import JsonValue

from harness.model import Scene, require
from harness.questions.study.cases import BaseScene
from harness.questions.study.file import Value
from harness.statics.plan import LimitsOfRest, limit_of_rest_m_s2
from harness.statics.standstill import resting_polygon_m

WEAKEST_G, STRONGEST_G = 0.05, 1.0
SLOWEST_HZ, FASTEST_HZ = 0.8, 8.0
"""A museum floor's strengths and frequencies in an earthquake."""
RESOLUTION: Final = {False: 1.05, True: 1.25}
"""Ratio of neighbouring strengths, of a whole and of a coarse map: a border between classes is known to that."""
FREQUENCIES: Final = {False: 10, True: 5}
FARTHEST: Final = {False: 2.0, True: 3.0}
"""Engines are asked at least once for each such factor of strength and frequency, whatever the model says."""
RING_DOWN_S: Final = 5.0
"""Time after a pulse in which rocking may still decide."""

Point = tuple[int, ...]
"""Number of the frequency, and of the strength."""


@dataclass(frozen=True)
class Plane:
    """Strengths, g, and frequencies, Hz (one None: the scene's own motion), and the scenes at them."""

    base: BaseScene
    scene: Scene
    motion: str
    amplitudes_g: Sequence[float]
    frequencies_hz: Sequence[float | None]
    farthest_ratio: float = FARTHEST[False]
    on_floor: bool = False

    @classmethod
    def of(cls, scene: Scene, motion: str, *, coarse: bool) -> Plane:
        """The map of a loaded scene. Raises `InputError` for an own motion that is none, or a statue not on its base."""
        require(scene.initial.pose is None, str(scene.source), "a statue on its base", "a pose in space", key="initial")
        require(
            motion != "scene" or scene.base_excitation.x.peak_m_s2 > 0.0,
            str(scene.source),
            "a motion along x to make stronger",
            "none",
            key="motion.x",
        )
        limits_g = [limit_of_rest_m_s2(each) / scene.gravity_m_s2 for each in (scene, replace(scene, pedestal=None))]
        low, high = min(WEAKEST_G, 0.8 * min(limits_g)), max(STRONGEST_G, 2.0 * max(limits_g))
        steps = math.ceil(math.log(high / low) / math.log(RESOLUTION[coarse]))
        frequencies: list[float | None] = [None]
        if motion != "scene":
            frequencies = [*_rounded(np.geomspace(SLOWEST_HZ, FASTEST_HZ, FREQUENCIES[coarse]))]
        amplitudes = _rounded(np.geomspace(low, high, steps + 1))
        return cls(BaseScene(scene.source, scene.given), scene, motion, amplitudes, frequencies, FARTHEST[coarse])

    def without_pedestal(self) -> Plane:
        """The same plane for the statue on the floor. Raises `InputError` where that is no scene."""
        floor = replace(self, on_floor=True)
        return replace(floor, scene=self.base.scene({"pedestal": "none", **floor._known()}))

    @property
    def points(self) -> list[Point]:
        """All points, frequency by frequency."""
        return [(i, j) for i in range(len(self.frequencies_hz)) for j in range(len(self.amplitudes_g))]

    def setting(self, point: Point) -> dict[str, Value]:
        """The keys of the scene at a point: `rockcheck run SCENE --set` takes the same."""
        return {**({"pedestal": "none"} if self.on_floor else {}), **self._shaking(point), **self._known()}

    def command(self, point: Point) -> list[str]:
        """The same as `--set` takes it."""
        return [f"{key}={value if value == 'none' else _toml(value)}" for key, value in self.setting(point).items()]

    def _shaking(self, point: Point) -> dict[str, Any]:
        amplitude, frequency = self.amplitudes_g[point[1]], self.frequencies_hz[point[0]]
        if frequency is None:
            factor = amplitude * self.scene.gravity_m_s2 / self.scene.base_excitation.x.peak_m_s2
            motion = self.base.content["motion"]
            own = motion.get("scale", 1.0) if isinstance(motion, Mapping) else 1.0
            return {"motion.scale": factor * float(own)}  # type: ignore[arg-type]
        if self.motion == "sine":
            return {"motion": {"x": {"kind": "harmonic", "amplitude_g": amplitude, "frequency_hz": frequency}}}
        duration_s = 1.0 / frequency
        x = {"kind": "pulse", "shape": "one_sine", "amplitude_g": amplitude, "duration_s": duration_s}
        return {"motion": {"x": x}, "duration_s": max(self.scene.duration_s, duration_s + RING_DOWN_S)}

    def _known(self) -> dict[str, Any]:
        """The scene's table of uncertainties without what is not there: its own motion where another shakes, its pedestal."""
        unknown = self.base.content.get("uncertainty")
        gone = [
            name for name, there in (("motion.", self.motion == "scene"), ("pedestal.", not self.on_floor)) if not there
        ]
        if not isinstance(unknown, Mapping) or not gone:
            return {}
        kept = {key: item for key, item in unknown.items() if not key.startswith(tuple(gone))}
        return {"uncertainty": {key: _alone(item, kept.keys()) for key, item in kept.items()}}

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

    @cached_property
    def shaken(self) -> Scene:
        """The scene under what shakes it on this map: nothing in it is of a motion whose place another takes."""
        return self.scene if self.motion == "scene" else self.at(self.points[0])

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
    def farthest(self) -> tuple[int, int]:
        """How many frequencies and strengths may lie from one at which engines were asked to the next."""
        return _steps(self.frequencies_hz, self.farthest_ratio), _steps(self.amplitudes_g, self.farthest_ratio)


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


def _alone(spread: JsonValue, kept: Set[str]) -> JsonValue:
    """The distribution of a number without its correlation with what is not there."""
    if isinstance(spread, dict) and spread.get("correlated_with", "") not in ("", *kept):
        return {key: value for key, value in spread.items() if key not in ("correlated_with", "rho")}
    return spread


def _toml(value: object) -> str:
    """A value as TOML writes it in one line."""
    if isinstance(value, Mapping):
        items = (f"{json.dumps(key) if '.' in key else key}={_toml(item)}" for key, item in value.items())
        return f"{{{','.join(items)}}}"
    return f"[{','.join(map(_toml, value))}]" if isinstance(value, list) else json.dumps(value)


def _steps(values: Sequence[float | None], ratio: float) -> int:
    """How many values lie within a factor."""
    low, high = values[0], values[-1]
    return (
        max(1, round(math.log(ratio) * (len(values) - 1) / math.log(high / low))) if low and high and high > low else 1
    )


def _rounded(values: np.ndarray[tuple[int], np.dtype[np.float64]]) -> list[float]:
    """Three digits: a point reads the same in a table, on a command line and in the store."""
    return [float(f"{value:.3g}") for value in values]
