"""What a scene does not know: as its file says, else as assumed; seeded draws with the stated moments."""

from dataclasses import replace
from pathlib import Path
from typing import Literal

import numpy as np
import pytest
from scipy.stats import spearmanr

from harness import InputError, load_scene
from harness.model import Contact, Scene, Uncertain
from harness.questions.assess.options import in_plane, options_of
from harness.questions.assess.probability import (
    IMPACT,
    KINETIC,
    STATIC,
    draw,
    groups,
    model_draws,
    row,
    sweepable,
    uncertain_inputs,
    varied,
)
from tests import budgets_assess as budget
from tests.scenes_for_tests import SCENES, paestum

STATED = """
[uncertainty]
"contact.floor" = { kind = "lognormal", cov = 0.15 }
"motion.scale" = { kind = "normal", sd = 0.1 }
"statue.mass_kg" = { kind = "uniform", half_width = 70.0 }
"""


def stated(tmp_path: Path, text: str = STATED) -> Path:
    path = tmp_path / "scene.toml"
    path.write_text((SCENES / "paestum_block.toml").read_text(encoding="utf-8") + text, encoding="utf-8")
    return path


def test_a_file_says_what_is_uncertain(tmp_path: Path) -> None:
    inputs = uncertain_inputs(load_scene(stated(tmp_path)))
    assert [(item.key, item.kind, item.width) for item in inputs] == [
        ("contact.floor", "lognormal", 0.15),
        ("motion.scale", "normal", 0.1),
        ("statue.mass_kg", "uniform", 70.0),
    ]
    assert [item.value for item in inputs] == [0.20, 1.0, 707.0]


WIDE = '{ kind = "lognormal", cov = 0.4 }'


@pytest.mark.parametrize(
    ("line", "wanted"),
    [
        ('"statue.mesh.density_kg_m3" = { kind = "normal", sd = 0.1 }', "density_kg_m3"),
        ('"contact.flor" = { kind = "lognormal", cov = 0.1 }', r" contact\.floor\?"),
        ('"title" = { kind = "normal", sd = 0.1 }', "a number of this scene"),
        ('"initial.theta_rad" = { kind = "lognormal", cov = 0.1 }', "a positive value"),
        ('"motion.scale" = { kind = "lognormal", sd = 0.1 }', "uncertainty.motion.scale.cov: "),
        ('"motion.scale" = { kind = "gamma", cov = 0.1 }', "lognormal"),
        ('"motion.scale" = { kind = "normal", sd = 0.1, rho = 0.5 }', "correlated_with.* rho"),
        ('"motion.scale" = { kind = "normal", sd = 0.1, correlated_with = "motion.scale", rho = 0.5 }', "earlier key"),
        ('"motion.scale" = { kind = "normal", sd = 0.1, correlated_with = "contact.floor", rho = 1.0 }', "less than 1"),
        (f'"contact.floor" = {WIDE}\n"contact.floor_kinetic" = {WIDE}', r"contact\.floor "),
    ],
)
def test_what_is_no_distribution_of_a_number_is_refused(tmp_path: Path, line: str, wanted: str) -> None:
    with pytest.raises(InputError, match=wanted):
        load_scene(stated(tmp_path, f"\n[uncertainty]\n{line}\n"))


def test_without_a_table_friction_strength_and_frequency_are_assumed() -> None:
    assert [item.key for item in uncertain_inputs(paestum(0.3, 2.0))] == [
        "contact.floor",
        "motion.scale",
        "motion.x.frequency_hz",
    ]
    assert [item.key for item in uncertain_inputs(paestum(0.3, 2.0, pedestal=False))] == [
        "motion.scale",
        "motion.x.frequency_hz",
        "contact.statue",
    ]


def test_the_frequency_of_a_motion_without_strength_changes_nothing() -> None:
    """A harmonic motion of amplitude 0 is none to the compiled sweep, which knows no frequency of it."""
    scene = paestum(0.3, 2.0, pedestal=False)
    still = replace(scene, base_excitation=scene.base_excitation.scaled(0.0))
    found = model_draws(still, draw(uncertain_inputs(still), 3, 0))
    assert found.decided.tolist() == [True] * 3
    assert not found.peak_share.any()


def test_draws_have_the_stated_median_and_spread() -> None:
    kinds = {"lognormal": 0.15, "normal": 0.02, "uniform": 0.05}
    inputs = [Uncertain(kind, kind, 0.2, width) for kind, width in kinds.items()]  # type: ignore[arg-type]
    values = draw(inputs, budget.DRAWS, seed=1)
    for name in kinds:
        assert np.median(values[name]) == pytest.approx(0.2, rel=budget.MEDIAN_REL)
    assert np.std(values["lognormal"]) / np.mean(values["lognormal"]) == pytest.approx(0.15, rel=budget.SPREAD_REL)
    assert np.std(values["normal"]) == pytest.approx(0.02, rel=budget.SPREAD_REL)
    assert np.abs(values["uniform"] - 0.2).max() <= 0.05


def test_more_draws_begin_with_the_same() -> None:
    inputs = uncertain_inputs(paestum(0.3, 2.0))
    few, many = draw(inputs, 10, seed=3), draw(inputs, 1000, seed=3)
    for key, values in few.items():
        np.testing.assert_array_equal(values, many[key][:10])
    assert not np.array_equal(few["motion.scale"], draw(inputs, 10, seed=4)["motion.scale"])


def test_a_positive_number_is_never_drawn_at_or_below_zero() -> None:
    values = draw([Uncertain("contact.floor", "normal", 0.2, 0.2)], budget.DRAWS, seed=0)["contact.floor"]
    assert values.min() > 0.0


@pytest.mark.parametrize("kind", ["lognormal", "normal", "uniform"])
def test_no_impact_is_drawn_that_gives_energy(kind: Literal["lognormal", "normal", "uniform"]) -> None:
    """Alone and by its score: a ratio near 1 has a spread on one side."""
    ratio = Uncertain("contact.restitution", kind, 0.99, 0.037)
    first = Uncertain("motion.scale", "normal", 1.0, 0.1)
    linked = replace(ratio, correlated_with="motion.scale", rho=0.5)
    for inputs in ([ratio], [first, linked]):
        values = draw(inputs, 2000, seed=0)["contact.restitution"]
        assert values.max() <= 1.0
        assert values.min() < 0.96


def test_a_varied_scene_has_the_drawn_values(tmp_path: Path) -> None:
    scene = load_scene(stated(tmp_path))
    other = varied(scene, {"contact.floor": 0.3, "motion.scale": 2.0, "statue.mass_kg": 700.0})
    assert other.contact.floor_static == pytest.approx(0.3)
    assert other.contact.floor_kinetic == pytest.approx(0.3 * scene.contact.floor_kinetic / scene.contact.floor_static)
    assert other.base_excitation.x.peak_m_s2 == pytest.approx(2.0 * scene.base_excitation.x.peak_m_s2)
    assert other.statue.mass_kg == 700.0


def test_one_factor_scales_every_axis(tmp_path: Path) -> None:
    scene, twice = (load_scene(stated(tmp_path, ""), [f"motion.scale={factor}"]) for factor in (1.0, 2.0))
    assert twice.base_excitation.x.peak_m_s2 == 2.0 * scene.base_excitation.x.peak_m_s2
    back = varied(twice, {"motion.scale": 1.0})
    assert back.base_excitation.x.peak_m_s2 == pytest.approx(scene.base_excitation.x.peak_m_s2, rel=budget.ROUNDING)


def test_correlated_inputs_keep_their_distributions(tmp_path: Path) -> None:
    """Spreads are those of independent draws, whatever the kind; the rank correlation is that of the copula."""
    lines = [
        '"statue.mass_kg" = { kind = "lognormal", cov = 0.1 }',
        '"contact.floor" = { kind = "normal", sd = 0.02, correlated_with = "statue.mass_kg", rho = 0.8 }',
        '"initial.theta_rad" = { kind = "uniform", half_width = 0.01, correlated_with = "contact.floor", rho = -0.5 }',
        '"motion.scale" = { kind = "lognormal", cov = 0.1 }',
    ]
    given = load_scene(stated(tmp_path, "\n".join(["", "[uncertainty]", *lines, ""]))).uncertainty
    assert groups(given) == [["statue.mass_kg", "contact.floor", "initial.theta_rad"], ["motion.scale"]]
    tied, free = (
        draw(given, budget.DRAWS, 0),
        draw([replace(item, correlated_with=None) for item in given], budget.DRAWS, 1),
    )
    for item in given:
        assert np.std(tied[item.key]) == pytest.approx(np.std(free[item.key]), rel=2.0 * budget.SPREAD_REL)
    # Spearman's coefficient of two normal scores that correlate by r is 6/π asin(r/2).
    for one, other, rho in (
        ("statue.mass_kg", "contact.floor", 0.8),
        ("contact.floor", "initial.theta_rad", -0.5),
        ("statue.mass_kg", "initial.theta_rad", -0.4),
        ("statue.mass_kg", "motion.scale", 0.0),
    ):
        wanted = 6.0 / np.pi * np.arcsin(0.5 * rho)
        assert spearmanr(tied[one], tied[other]).statistic == pytest.approx(wanted, abs=budget.RANK)
    assert {key: values[:5].tolist() for key, values in draw(given, 5, 0).items()} == {
        key: values[:5].tolist() for key, values in tied.items()
    }


def test_the_floor_s_two_coefficients_drawn_apart_keep_their_order(tmp_path: Path) -> None:
    """In a sweep, in a scene made for one draw, and under other materials: friction in motion is at most that at rest."""
    scene = load_scene(
        stated(tmp_path, f'\n[uncertainty]\n"{KINETIC}" = {WIDE}\n"{STATIC}" = {WIDE}\n'), ["duration_s=2.0"]
    )
    inputs = uncertain_inputs(scene)
    values = draw(inputs, 24, seed=3)
    assert 0 < (values[KINETIC] > values[STATIC]).sum() < 24
    each = [varied(scene, row(values, k)) for k in range(24)]
    for k, one in enumerate(each):
        assert one.contact.floor_static == values[STATIC][k]
        assert one.contact.floor_kinetic == min(values[KINETIC][k], values[STATIC][k])
    assert sweepable(scene, values)
    alone = [float(model_draws(one, {}).peak_slip_m[0]) for one in each]
    assert model_draws(scene, values).peak_slip_m == pytest.approx(alone, rel=budget.ROUNDING)
    smooth = next(item for item in options_of(scene)[0] if "ptfe" in item.name)
    slips = in_plane(scene, [smooth], inputs, values)(smooth).model.peak_slip_m
    assert np.median(slips) > 1.5 * np.median(alone)


def test_one_factor_on_equal_coefficients_rounds_none_above_the_other() -> None:
    contact = Contact(0.12, 0.12, 0.6)
    values = np.random.default_rng(1).uniform(0.05, 0.3, 200).tolist()
    drawn = [contact.with_floor(value, contact.floor_kinetic * (value / contact.floor_static)) for value in values]
    assert any(contact.floor_kinetic * (value / contact.floor_static) > value for value in values)
    assert all(each.floor_kinetic <= each.floor_static for each in drawn)


def between(scene: Scene, value: float) -> float:
    contact = scene.contact
    return (value - contact.floor_kinetic) / (contact.floor_static - contact.floor_kinetic)


def test_what_acts_at_an_impact_is_drawn_between_the_two_coefficients_unless_the_scene_chooses(tmp_path: Path) -> None:
    path = SCENES / "paestum_block.toml"
    usual = load_scene(path)
    *others, last = uncertain_inputs(usual)
    assert (last.key, last.kind, last.value - last.width, last.value + last.width) == (IMPACT, "uniform", 0.0, 1.0)
    for changes in ({IMPACT: "kinetic"}, {STATIC: 0.15}, {"model.pedestal_at_impact": "unchanged"}, {"pedestal": None}):
        assert IMPACT not in [item.key for item in uncertain_inputs(load_scene(path, changes))]
    values = draw([*others, last], 16, seed=5)
    for k in range(16):
        drawn = varied(usual, row(values, k))
        assert between(drawn, drawn.contact.at_impact) == pytest.approx(values[IMPACT][k], abs=budget.ROUNDING)
    own = load_scene(stated(tmp_path, f'\n[uncertainty]\n"{IMPACT}" = {{ kind = "uniform", half_width = 0.01 }}\n'))
    (only,) = uncertain_inputs(own)
    assert (only.value, only.width) == (0.0, pytest.approx(0.2))
    # Half of its draws are below the kinetic coefficient: they are that.
    acts = [varied(own, {IMPACT: value}).contact.at_impact for value in (-0.1, 0.0, 0.1, 1.2)]
    assert acts == pytest.approx([0.15, 0.15, 0.155, 0.20])


@pytest.mark.parametrize("acts", ["kinetic", "static", 0.17, None])
def test_what_acts_at_an_impact_keeps_its_place_as_the_floor_is_drawn(acts: float | str | None) -> None:
    chosen = {} if acts is None else {IMPACT: acts}
    scene = load_scene(SCENES / "paestum_block.toml", {"duration_s": 2.0, **chosen})
    values = draw(uncertain_inputs(scene), 12, seed=2)
    each = [varied(scene, row(values, k)) for k in range(12)]
    if acts is not None:
        assert {round(between(one, one.contact.at_impact), 9) for one in each} == {
            round(between(scene, scene.contact.at_impact), 9)
        }
    alone = [float(model_draws(one, {}).peak_slip_m[0]) for one in each]
    assert model_draws(scene, values).peak_slip_m == pytest.approx(alone, rel=budget.ROUNDING)
    others = [item.change(scene).contact for item in options_of(scene)[0] if "friction" in item.name]
    assert any(other.floor_kinetic < other.floor_static != scene.contact.floor_static for other in others)
    for other in others:
        place = between(scene, scene.contact.at_impact)
        told = other.floor_kinetic + place * (other.floor_static - other.floor_kinetic)
        assert other.at_impact == pytest.approx(told)


@pytest.mark.parametrize("line", ['{ kind = "lognormal", cov = 0.1 }', '{ kind = "assumed" }'])
def test_nothing_between_one_coefficient_and_itself_is_drawn(tmp_path: Path, line: str) -> None:
    path = stated(tmp_path, f'\n[uncertainty]\n"{IMPACT}" = {line}\n')
    with pytest.raises(InputError, match=IMPACT):
        load_scene(path, {STATIC: 0.15})


def test_draws_of_a_start_behind_the_wall_are_refused(tmp_path: Path) -> None:
    path = stated(tmp_path, '\n[uncertainty]\n"initial.theta_rad" = { kind = "uniform", half_width = 0.2 }\n')
    walled = {"wall": {"side": "right", "distance_m": 0.2}, "duration_s": 1.0}
    scene = load_scene(path, walled)
    with pytest.raises(InputError, match=r'uncertainty\."initial\.theta_rad"'):
        model_draws(scene, draw(uncertain_inputs(scene), 200, seed=1))
    far = load_scene(path, walled | {"wall.distance_m": 0.4})
    assert model_draws(far, draw(uncertain_inputs(far), 200, seed=1)).decided.any()
