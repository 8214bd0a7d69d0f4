"""The verdict is no excuse: known faults are called *differ: model* wherever their effect can be seen."""

from dataclasses import replace

import numpy as np
import pytest

from harness import Run, Scene, Verdict, simulate
from harness.comparison import comparator as verdict
from harness.comparison.comparator import compare
from tests.measures.coverage import random_scene
from tests.measures.faults import MUTANTS, expose, momentum_ratio
from tests.scenes_for_tests import PAESTUM, paestum, rectangle, scene

SCENES = {
    f"{amplitude} g, {frequency} Hz, {'pedestal' if pedestal else 'floor'}": paestum(
        amplitude, frequency, pedestal=pedestal, mu=(0.20, 0.15), duration_s=3.0
    )
    for amplitude in (0.334, 0.429)
    for frequency in (1.5, 3.0, 6.0)
    for pedestal in (True, False)
} | {"free rocking": scene(PAESTUM, theta_rad=-0.2, duration_s=3.0)}


def exact(each: Scene) -> Run:
    return simulate(each, "analytic")


@pytest.mark.parametrize("name", SCENES)
def test_every_visible_mutant_is_called_a_model_difference(name: str) -> None:
    findings = expose(SCENES[name], exact, exact)
    assert [finding for finding in findings if not finding.held] == []
    # The analytic model knows its numbers to 1e-6, so what moves the statue at all must be visible.
    assert sum(finding.must for finding in findings) >= 2


@pytest.mark.parametrize("name", ["free rocking", "0.429 g, 3.0 Hz, pedestal"])
def test_a_contact_engine_s_mutants_are_found_beside_the_model(name: str) -> None:
    short = replace(SCENES[name], duration_s=1.5)
    findings = expose(short, exact, lambda each: simulate(each, "pymunk"))
    assert [finding for finding in findings if not finding.held] == []
    assert any(finding.must for finding in findings)


def test_faults_of_random_scenes_are_found() -> None:
    """Forty of the scenes of `python -m tests.measures.mutants`, which does a hundred and the shipped ones."""
    findings = [finding for seed in range(40) for finding in expose(random_scene(seed), exact, exact)]
    assert [finding for finding in findings if not finding.held] == []
    assert sum(finding.must for finding in findings) > len(findings) / 2


def test_the_scene_itself_is_never_called_a_model_difference() -> None:
    for each in SCENES.values():
        assert compare(exact(each), exact(each), scene=each).verdict is Verdict.AGREE


def test_a_judge_that_excuses_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    """With the limit at a thousand million times the uncertainty the check above would find what is missed."""
    monkeypatch.setattr(verdict, "COVERAGE", 1e9)
    findings = expose(SCENES["0.429 g, 3.0 Hz, pedestal"], exact, exact)
    assert any(not finding.held for finding in findings)


def test_each_mutant_changes_its_own_part_alone() -> None:
    original = SCENES["0.429 g, 3.0 Hz, pedestal"]
    changed = {name: mutate(original) for name, mutate in MUTANTS.items()}
    heavier, swapped = changed["J + 5 %"], changed["corners swapped"]
    rougher, livelier = changed["friction + 10 %"], changed["impact ratio + 5 %"]
    assert heavier.statue.inertia_kg_m2 == pytest.approx(1.05 * original.statue.inertia_kg_m2)
    assert heavier.statue.inertia_tensor_kg_m2[1, 1] == pytest.approx(1.05 * original.statue.inertia_kg_m2)
    assert swapped.statue.corner_left_m == original.statue.corner_right_m
    assert np.min(swapped.statue.section_m[:, 0]) == -swapped.statue.corner_left_m
    assert np.min(swapped.statue.footprint_m[:, 0]) == -swapped.statue.corner_left_m
    assert rougher.contact.floor_static == pytest.approx(1.1 * original.contact.floor_static)
    assert livelier.contact.restitution == pytest.approx(
        1.05 * 0.5 * (momentum_ratio(original, 1) + momentum_ratio(original, -1))
    )
    assert (heavier.contact, swapped.contact, livelier.statue) == (original.contact, original.contact, original.statue)


def test_mutants_that_mean_nothing_are_left_out() -> None:
    square = scene(rectangle(0.2, 1.0), theta_rad=0.05)
    assert MUTANTS["corners swapped"](square) is None
    assert MUTANTS["friction + 10 %"](square) is None


def test_the_momentum_ratio_of_a_rectangle_is_housner_s() -> None:
    """1 − 1.5 sin²α."""
    square = scene(rectangle(0.2, 1.0))
    alpha = square.statue.slenderness_rad(1)
    assert momentum_ratio(square, 1) == pytest.approx(1.0 - 1.5 * np.sin(alpha) ** 2)


def test_a_prescribed_ratio_is_raised_itself() -> None:
    given = SCENES["free rocking"]
    given = replace(given, contact=replace(given.contact, restitution=0.9))
    livelier = MUTANTS["impact ratio + 5 %"](given)
    assert livelier.contact.restitution == pytest.approx(0.945)
