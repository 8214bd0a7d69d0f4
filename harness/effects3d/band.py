"""The planar model's overturning amplitude of many statues that differ by a survey's errors: the band around a rose."""

from __future__ import annotations

import math
from typing import Any, Final

import numpy as np

from harness.effects3d.conditions import GEOMETRY_REL, changed_scene
from harness.effects3d.search import STEPS, Search, peak_g, start_factor
from harness.model.scene import Scene
from harness.records.effects3d import BASELINE, Band

SIGMAS: Final = 2.0
"""The stated uncertainty of a length or an inertia is this many standard deviations."""


def band(scene: Scene, azimuth_deg: float, search: Search, samples: int, seed: int) -> Band:
    """The band at one azimuth; h, each corner and J drawn independently, normal, two standard deviations being 3 %.

    Every statue has two corners (a ragged base counts as its outer ones). Raises `InputError`.
    """
    from analytic import Block, ensemble
    from harness.engines.analytic import keywords

    changed = changed_scene(scene, BASELINE, azimuth_deg)
    statue, unit = changed.statue, peak_g(changed)
    block = Block.two_corners(
        mass_kg=statue.mass_kg,
        centroid_height_m=statue.centroid_height_m,
        inertia_kg_m2=statue.inertia_kg_m2,
        corner_left_m=statue.corner_left_m,
        corner_right_m=statue.corner_right_m,
    )
    draws = 1.0 + GEOMETRY_REL / SIGMAS * np.random.default_rng([seed, round(azimuth_deg)]).standard_normal(
        (4, samples, 1)
    )
    least, most = min(start_factor(changed), 0.5 * search.most_g / unit), search.most_g / unit
    count = math.ceil(math.log(most / least) / math.log(STEPS["analytic"]))
    factors = np.geomspace(least, most, count + 1)
    given: dict[str, Any] = {name: value for name, value in keywords(changed).items() if name not in UNUSED}
    drawn = ensemble(
        block,
        changed.base_excitation.x,
        sweep={
            "scale": factors[None, :],
            "centroid_height_m": statue.centroid_height_m * draws[0],
            "corner_left_m": statue.corner_left_m * draws[1],
            "corner_right_m": statue.corner_right_m * draws[2],
            "inertia_kg_m2": statue.inertia_kg_m2 * draws[3],
        },
        threads=1,
        **given,
    )
    falls = drawn.overturned.any(axis=1)
    first = np.where(falls, factors[np.argmax(drawn.overturned, axis=1)] * unit, np.inf)
    low, middle, high = (
        None if math.isinf(value) else value
        for value in (float(np.quantile(first, q, method="inverted_cdf")) for q in (0.05, 0.5, 0.95))
    )
    return Band(float(azimuth_deg), low, middle, high, float(np.mean(~falls)), int(drawn.steps.size))


UNUSED: Final = frozenset({"statue_friction", "pedestal", "wall"})
"""Keywords that an effects scene leaves at rest: the statue stands on the floor."""
