"""What a scene does not know, and seeded draws of it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.excitation import Harmonic, ZeroExcitation
from harness.input.uncertain import assumption
from harness.model.scene import Scene, Uncertain, written
from harness.questions.assess.variation import IMPACT, file_scale

Array = NDArray[np.float64]

MOST: Final = {"contact.restitution": 1.0}
"""Draws above this are drawn again: no impact gives energy."""
LEAST_SHARE: Final = 1e-3
"""Draws of a positive number below this share of it are drawn again: a friction or a mass has no tail through zero."""


def uncertain_inputs(scene: Scene) -> tuple[Uncertain, ...]:
    """The scene's own `[uncertainty]`, or the assumed one: friction on the floor, strength and a harmonic motion's frequency.

    Which of two coefficients acts at an impact is drawn too, where it matters and the scene does not choose.
    """
    if scene.uncertainty:
        return tuple(scene.uncertainty)
    assumed = [] if scene.pedestal is None else [_assumed("contact.floor", scene.contact.floor_static)]
    contact, chosen = scene.contact, written(scene, "contact", "floor_impact")
    matters = contact.floor_kinetic < contact.floor_static and scene.form.pedestal_at_impact == "momentum"
    axes = {"x": scene.base_excitation.x, "y": scene.base_excitation.y, "z": scene.base_excitation.z}
    if not all(isinstance(item, ZeroExcitation) for item in axes.values()):
        assumed.append(_assumed("motion.scale", file_scale(scene)))
    for axis, item in axes.items():
        if isinstance(item, Harmonic):
            assumed.append(_assumed(f"motion.{axis}.frequency_hz", item.frequency_hz))
    if scene.pedestal is None and assumed:
        assumed.append(_assumed("contact.statue", scene.contact.statue))
    # The last, so that the others' draws are the same with it and without.
    if scene.pedestal is not None and matters and chosen is None:
        assumed.append(_assumed(IMPACT, 0.5))
    return tuple(item for item in assumed if item.value > 0.0)


def _assumed(key: str, value: float) -> Uncertain:
    given = assumption(key)
    if given is None:
        raise KeyError(key)
    return Uncertain(key, given.kind, value, given.width)


def draw(inputs: Sequence[Uncertain], count: int, seed: int) -> dict[str, Array]:
    """Values (count,) of every input by its key; more draws of one seed begin with the same values."""
    linked = {name for group in groups(inputs) if len(group) > 1 for name in group}
    values: dict[str, Array] = {}
    scores: dict[str, Array] = {}
    for k, item in enumerate(inputs):
        random = np.random.default_rng([seed, k])
        if item.key not in linked:
            values[item.key] = _values(item, count, random)
            continue
        own = random.standard_normal(count)
        other = scores.get(item.correlated_with or "")
        scores[item.key] = own if other is None else item.rho * other + math.sqrt(1.0 - item.rho**2) * own
        values[item.key] = _of_score(item, scores[item.key])
    return values


def groups(inputs: Sequence[Uncertain]) -> list[list[str]]:
    """The keys that depend on each other, each group independent of all others."""
    by_key: dict[str, list[str]] = {}
    for item in inputs:
        by_key[item.key] = by_key.get(item.correlated_with or "", [])
        by_key[item.key].append(item.key)
    return [group for key, group in by_key.items() if group[0] == key]


def _of_score(item: Uncertain, score: Array) -> Array:
    """The input at normal scores (n,): the same distribution as `_values` draws, by its quantiles."""
    from scipy.special import ndtr, ndtri

    least, most = _limits(item)
    if item.kind == "lognormal":
        return np.minimum(item.value * np.exp(math.sqrt(math.log1p(item.width**2)) * score), most)
    if item.kind == "uniform":
        low, high = max(item.value - item.width, least), min(item.value + item.width, most)
        return np.asarray(low + (high - low) * ndtr(score))
    below, up_to = ndtr((least - item.value) / item.width), ndtr((most - item.value) / item.width)
    return np.asarray(item.value + item.width * ndtri(below + (up_to - below) * ndtr(score)))


def _limits(item: Uncertain) -> tuple[float, float]:
    """Between which values a draw is kept."""
    return LEAST_SHARE * item.value if item.value > 0.0 else -math.inf, MOST.get(item.key, math.inf)


def _values(item: Uncertain, count: int, random: np.random.Generator) -> Array:
    least, most = _limits(item)
    if item.kind == "lognormal":
        # The median is the scene's value; cov² = exp(s²) − 1.
        s = math.sqrt(math.log1p(item.width**2))
        return np.minimum(item.value * np.exp(s * random.standard_normal(count)), most)
    values = np.empty(0)
    while values.size < count:
        unit = random.standard_normal(count) if item.kind == "normal" else random.uniform(-1.0, 1.0, count)
        drawn = item.value + item.width * unit
        values = np.concatenate([values, drawn[(drawn >= least) & (drawn <= most)]])
    return values[:count]


def row(draws: Mapping[str, Array], number: int) -> dict[str, float]:
    """The values of one draw by key."""
    return {key: float(values[number]) for key, values in draws.items()}
