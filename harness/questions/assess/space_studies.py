"""Options and fragility of a statue on the floor that is shaken across its rocking plane, by the exact body."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Final

import numpy as np

from harness.model.scene import Scene, Uncertain
from harness.questions.assess.in_space import SPACE, Ends, ends_in_space, without_end
from harness.questions.assess.model_draws import Array, ModelDraws, draw, file_scale, uncertain_inputs
from harness.questions.assess.options import DIFFERENCE_LEVEL, Answered, Option, answer_of, common
from harness.questions.assess.sensitivity import fragility_of
from harness.questions.assess.stratified import LEVEL
from harness.records.assess import FragilityRecord, OptionsRecord

OPTION_DRAWS: Final = 300
"""Draws of each option: a difference of 10 points at a half is then shown where half of what falls is the same in both."""
OPTION_STEPS: Final = 400_000
"""Steps of each option's runs together: some fifteen seconds of one core."""
FACTORS: Final = tuple(float(value) for value in np.geomspace(0.25, 4.0, 13))
"""Factors on the motion: every second of the planar model's."""
FRAGILITY_DRAWS: Final = 64
"""Draws at each factor: ± 10 % at a half."""
FRAGILITY_STEPS: Final = 80_000
"""Steps of the runs at one factor together: some three seconds of one core."""


def compare_in_space(
    scene: Scene,
    inputs: Sequence[Uncertain],
    options: Sequence[Option],
    left_out: Mapping[str, str],
    draws: Mapping[str, Array],
    own: Ends,
    seed: int,
    on_progress: Callable[[str], None],
) -> OptionsRecord:
    """Every option's probability of a fall on the first of the draws (n,) of the scene as it is, which ended as `own` (n,)."""
    values = {key: column[:OPTION_DRAWS] for key, column in draws.items()}
    before, unknown = _answered(own), dict(left_out)
    answers = [answer_of(None, before, None)]
    for option in options:
        on_progress(f"option {option.name}, in space")
        if option.user:
            other = option.change(scene)
            ends = ends_in_space(other, common(inputs, values, uncertain_inputs(other), seed), OPTION_STEPS)
        else:
            ends = ends_in_space(scene, values, OPTION_STEPS, option.change)
        if ends is None:
            unknown[option.name] = "unknown_in_space"
        else:
            answers.append(answer_of(option, _answered(ends), before))
    return OptionsRecord(answers, own.size, LEVEL, DIFFERENCE_LEVEL, unknown, model=SPACE)


def _answered(ends: Ends) -> Answered:
    fell, unknown = ends == "overturned", np.full(ends.size, np.nan)
    return Answered(
        ModelDraws(fell | (ends == "stands"), fell, unknown, unknown, *np.zeros((2, ends.size), dtype=bool))
    )


def fragility_in_space(scene: Scene, inputs: Sequence[Uncertain], seed: int) -> FragilityRecord | None:
    """Probability of overturning by a factor on all axes together; None for a scene that the exact body does not know."""
    draws = draw(inputs, FRAGILITY_DRAWS, seed)
    own = draws.get("motion.scale", np.full(FRAGILITY_DRAWS, file_scale(scene)))
    counts = []
    for factor in FACTORS:
        ends = ends_in_space(scene, {**draws, "motion.scale": own * factor}, FRAGILITY_STEPS)
        if ends is None:
            return None
        counts.append((int((ends == "overturned").sum()), without_end(ends), ends.size))
    return fragility_of(FACTORS, counts, SPACE)
