"""Whether the coefficient that acts as an impact breaks the pedestal loose decides the answer: the model by another one.

Where the floor has two coefficients, which of them acts there is a choice between laws (docs/model.md, section 3). Unmodified
engines take the static one, as the step of an impact begins stuck: they are held against the model with that one.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

from harness import engines
from harness.engines.analytic import by_other_impact
from harness.engines.base import EngineFailure
from harness.model.finding import Finding, changes_answer
from harness.model.run import Run, RunOptions
from harness.model.scene import Scene
from harness.records.run import DecidedBy, LawChoice, has_answer, outcome_family

KEY: Final = "contact.floor_impact"
MODEL: Final = "analytic"


def _by_another(scene: Scene) -> tuple[Run, float] | None:
    """The model by the other coefficient, and when an impact first makes the choice; None where none does, or it fails."""
    # Only with two coefficients, and where an impact moves the pedestal at all.
    two = scene.contact.floor_kinetic < scene.contact.floor_static
    if not two or scene.pedestal is None or scene.form.pedestal_at_impact != "momentum":
        return None
    try:
        other, at_s = by_other_impact(scene)
    except EngineFailure:
        return None
    return None if at_s is None else (other, at_s)


def decided_by(scene: Scene, runs: Mapping[str, Run]) -> DecidedBy | None:
    """Outcomes of the model by the scene's choice and by another, from one run more; None where no impact makes the choice.

    It decides where both tell what becomes of the statue, and not the same: one that still falls at the end tells nothing.
    """
    model = runs.get(MODEL)
    found = None if model is None or model.outcome.failed else _by_another(scene)
    if model is None or found is None:
        return None
    (other, at_s), contact = found, scene.contact
    another = "kinetic" if contact.at_impact == contact.floor_static else "static"
    outcomes = {str(contact.floor_impact): model, another: other}
    said = {name: LawChoice(run.outcome, run.end_s, run.peak_theta_rad) for name, run in outcomes.items()}
    told = {outcome_family(run.outcome) for run in outcomes.values() if has_answer(run)}
    return DecidedBy(KEY, at_s, said, len(told) > 1)


def findings_of(choice: DecidedBy | None) -> list[Finding]:
    """That the choice decides the outcome, with both."""
    if choice is None or not choice.decides:
        return []
    outcomes = {name: each.outcome.value for name, each in choice.outcomes.items()}
    return [changes_answer("floor_impact_decides", outcomes=outcomes)]


def under_static(scene: Scene, runs: Mapping[str, Run]) -> tuple[Scene, dict[str, Run]]:
    """The scene as unmodified engines act, and the runs to hold against them: the model's anew, every other one's until an
    impact makes the choice otherwise.
    """
    contact = scene.contact
    found = None if contact.at_impact == contact.floor_static else _by_another(scene)
    if found is None:
        return scene, dict(runs)
    static = replace(scene, contact=replace(contact, floor_impact="static"))
    held = {name: replace(run, reliable_until_s=min(run.bounded_until_s, found[1])) for name, run in runs.items()}
    if MODEL in runs:
        engine = engines.load(MODEL)
        try:
            held[MODEL] = engine.simulate(static, engine.refinement_levels(static)[-1], RunOptions())
        except EngineFailure:
            return scene, dict(runs)
    return static, held
