"""The probability beside every single run: the analytic model's, and in three dimensions the exact body's."""

from __future__ import annotations

from typing import Final

from harness.model.scene import Scene
from harness.probability.in_space import SPACE, assess_in_space, assessment, shaken_across
from harness.probability.inputs import uncertain_inputs
from harness.probability.model_draws import ModelDraws, draws_of, model_draws
from harness.records.assess import Assessment

MODEL: Final = "analytic"
RUN_DRAWS: Final = 10_000
"""Draws beside every single run: ± 0.8 % at a half, in half a second for a harmonic motion of 10 s."""


def assess_models(scene: Scene, draws: int = RUN_DRAWS, seed: int = 0) -> dict[str, Assessment]:
    """The analytic model's own probability, and the exact body's where the scene is shaken across its rocking plane.

    Empty where nothing of the scene is uncertain, or it begins from a pose in space.
    """
    inputs = uncertain_inputs(scene)
    if not inputs or scene.initial.pose is not None:
        return {}
    values = draws_of(scene, inputs, draws, seed)
    own = probability_of(model_draws(scene, values), plane_only=shaken_across(scene))
    in_space = assess_in_space(scene, values)
    answers = {MODEL: own, SPACE: None if in_space is None else in_space.answer}
    return {name: answer for name, answer in answers.items() if answer is not None}


def probability_of(model: ModelDraws, *, plane_only: bool = False) -> Assessment | None:
    """The share of the model's draws that overturn, with its interval; None without draws."""
    size = model.overturned.size
    return (
        assessment(int(model.overturned.sum()), size, 1.0 - float(model.decided.mean()), plane_only) if size else None
    )
