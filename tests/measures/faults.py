"""Scenes with one known fault, to prove that the comparator finds it: the verdict must not excuse a wrong model."""

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any, Final

import numpy as np

from harness import Run, Scene, Verdict, compare
from harness.comparison.comparator import COVERAGE, left_domain
from harness.model import pair

MUST_SHOW: Final = COVERAGE + 1.0
"""An effect above this multiple of the joint uncertainty must be found (see `harness.comparison.comparator.COVERAGE`)."""


def heavier_turning(scene: Scene) -> Scene:
    """J + 5 %: the inertia about the centroid."""
    statue = scene.statue
    inertia = statue.inertia_tensor_kg_m2.copy()
    inertia[1, 1] *= 1.05
    return replace(
        scene, statue=replace(statue, inertia_kg_m2=1.05 * statue.inertia_kg_m2, inertia_tensor_kg_m2=inertia)
    )


def corners_swapped(scene: Scene) -> Scene | None:
    """Left and right exchanged; None for a statue with equal corners."""
    statue = scene.statue
    if statue.corner_left_m == statue.corner_right_m:
        return None
    mirror = np.array([-1.0, 1.0])
    pedestal = scene.pedestal
    return replace(
        scene,
        statue=replace(
            statue,
            corner_left_m=statue.corner_right_m,
            corner_right_m=statue.corner_left_m,
            # Reflections turn the sense of a polygon: the order is reversed too.
            section_m=(statue.section_m * mirror)[::-1],
            footprint_m=(statue.footprint_m * np.array([-1.0, 1.0, 1.0]))[::-1],
            solid=None,
        ),
        pedestal=None if pedestal is None else replace(pedestal, offset_m=-pedestal.offset_m),
    )


def rougher_floor(scene: Scene) -> Scene | None:
    """Friction + 10 %, static and kinetic; None without a pedestal, where nothing slides on the floor."""
    if scene.pedestal is None:
        return None
    contact = scene.contact
    return replace(
        scene,
        contact=replace(contact, floor_static=1.1 * contact.floor_static, floor_kinetic=1.1 * contact.floor_kinetic),
    )


def livelier_impact(scene: Scene) -> Scene:
    """Impact ratio + 5 %: of the number prescribed, or of the mean of the two ratios that angular momentum gives."""
    ratio = scene.contact.restitution
    if ratio is None:
        ratio = float(np.mean([momentum_ratio(scene, side) for side in (1, -1)]))
    return replace(scene, contact=replace(scene.contact, restitution=min(1.05 * ratio, 1.0)))


def momentum_ratio(scene: Scene, landing: int) -> float:
    """J_c/J_n of an impact on that side with the pedestal held (docs/model.md, section 3)."""
    s = scene.statue
    new, old = s.corner_m(landing), s.corner_m(-landing)
    crossed = s.inertia_kg_m2 + s.mass_kg * (s.centroid_height_m**2 - old * new)
    return crossed / (s.inertia_kg_m2 + s.mass_kg * (s.centroid_height_m**2 + new**2))


MUTANTS: Final[Mapping[str, Callable[[Scene], Scene | None]]] = {
    "J + 5 %": heavier_turning,
    "corners swapped": corners_swapped,
    "friction + 10 %": rougher_floor,
    "impact ratio + 5 %": livelier_impact,
}


@dataclass(frozen=True)
class Finding:
    """What the comparator said of one mutant: `must` is whether its effect obliges it to say *differ: model*.

    `left_domain` is whether the effect is large before the horizon, but only after one side left its model's domain.
    """

    mutant: str
    effect_rad: float
    uncertainty_rad: float
    horizon_s: float
    must: bool
    left_domain: bool
    verdict: Verdict

    @property
    def held(self) -> bool:
        """Whether a mutant that had to be found was found."""
        return not self.must or self.verdict is Verdict.MODEL

    def as_dict(self) -> dict[str, Any]:
        """Plain values."""
        return asdict(self) | {"held": self.held}


def expose(
    scene: Scene, exact: Callable[[Scene], Run], tested: Callable[[Scene], Run], mutants: Mapping[str, Any] = MUTANTS
) -> list[Finding]:
    """Compare the mutants of a scene, computed by `tested`, with the scene itself computed by `exact`.

    The effect of a mutant is what `exact` says of it: the largest |θ_mutant − θ| before the horizon and before either side leaves
    its model's domain.
    """
    reference = exact(scene)
    findings = []
    for name, mutate in mutants.items():
        other = mutate(scene)
        if other is None:
            continue
        run = tested(other)
        scores = compare(run, reference, scene=scene)
        until = scores.horizon_s if scores.horizon_s is not None else scene.duration_s
        joint = (run.numerical_uncertainty_rad or 0.0) + (reference.numerical_uncertainty_rad or 0.0)
        known = exact(other)
        exits = [left_domain(each)[0] for each in (run, reference)]
        inside = min([until, *(t for t in exits if t is not None)])
        effect = _effect(known, reference, inside)
        must = effect > MUST_SHOW * joint
        later = not must and _effect(known, reference, until) > MUST_SHOW * joint
        findings.append(Finding(name, effect, joint, until, must, later, scores.verdict))
    return findings


def _effect(mutant: Run, reference: Run, until_s: float) -> float:
    if mutant.history is None or reference.history is None:
        return abs(mutant.peak_theta_rad - reference.peak_theta_rad)
    both = pair(mutant.history, reference.history).until(until_s)
    return float(np.max(np.abs(both.difference_rad)))
