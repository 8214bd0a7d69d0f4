"""Any statue, any motion: a run always ends, in numbers, within its physics, and mirrors itself."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from analytic import Block, Form, Harmonic, Pedestal, Solution, simulate
from analytic.block import GRAVITY_M_S2 as GRAVITY
from tests.analytic import paestum
from tests.budgets_analytic import ENERGY_RISE_REL, STRESS_STEPS_PER_S


def tens(low: float, high: float) -> st.SearchStrategy[float]:
    """Numbers evenly spread over decades."""
    return st.floats(math.log10(low), math.log10(high)).map(lambda power: 10.0**power)


@st.composite
def scenes(draw: st.DrawFn) -> dict[str, Any]:
    """Slenderness 1–50, size 1 cm–100 m, mass ratio 1e-3–1e3, friction 0–5, 0–5 g, 0.05–100 Hz, vertical to −2 g."""
    height = draw(tens(0.01, 100.0))
    width = height / draw(tens(1.0, 50.0))
    left = draw(st.floats(0.2, 0.8)) * width
    mass = draw(tens(0.1, 1e4))
    inertia = mass * (width**2 + height**2) / 12.0 * draw(st.floats(0.5, 1.5))
    static = draw(st.floats(0.0, 5.0))
    restitution = draw(st.one_of(st.none(), st.floats(0.0, 1.0)))
    normal, at_impact = draw(st.sampled_from(["dynamic", "static"])), draw(st.sampled_from(["momentum", "unchanged"]))
    pedestal = None
    if draw(st.booleans()):
        pedestal = Pedestal(mass * draw(tens(1e-3, 1e3)), 2.0 * width, 0.2 * height, draw(st.floats(-0.2, 0.2)) * width)
    slim = min(left, width - left) / height
    return {
        "block": Block.two_corners(
            mass_kg=mass,
            centroid_height_m=0.5 * height,
            inertia_kg_m2=inertia,
            corner_left_m=left,
            corner_right_m=width - left,
        ),
        "motion_x": Harmonic(draw(st.floats(-5.0, 5.0)) * GRAVITY, draw(tens(0.05, 100.0)), draw(st.floats(0.0, 6.0))),
        "motion_z": Harmonic(draw(st.floats(0.0, 2.0)) * GRAVITY, draw(tens(0.05, 100.0)), draw(st.floats(0.0, 6.0))),
        "pedestal": pedestal,
        "floor_static": static,
        "floor_kinetic": static * draw(st.floats(0.0, 1.0)),
        "form": Form(normal, restitution, at_impact),  # type: ignore[arg-type]
        "theta0_rad": draw(st.floats(-1.0, 1.0)) * slim,
        "theta_rate0_rad_s": draw(st.floats(-1.0, 1.0)) * slim * math.sqrt(GRAVITY / height),
        "duration_s": draw(st.floats(0.5, 3.0)),
        "dt_s": 0.01,
        "accuracy_rad": 1e-9,
    }


def mirrored(scene: dict[str, Any]) -> dict[str, Any]:
    """The scene seen in a mirror."""
    pedestal = scene["pedestal"]
    if pedestal is not None:
        pedestal = Pedestal(pedestal.mass_kg, pedestal.width_m, pedestal.height_m, -pedestal.offset_m)
    return scene | {
        "block": paestum.mirror_image(scene["block"]),
        "motion_x": scene["motion_x"].scaled(-1.0),
        "pedestal": pedestal,
        "theta0_rad": -scene["theta0_rad"],
        "theta_rate0_rad_s": -scene["theta_rate0_rad_s"],
    }


def is_finite(run: Solution) -> bool:
    columns = (run.t_s, run.theta_rad, run.theta_rate_rad_s, run.slip_m, run.slip_rate_m_s)
    return all(np.isfinite(column).all() for column in columns)


@settings(max_examples=150, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(scenes())
def test_every_run_ends_in_numbers_and_mirrors_itself(scene: dict[str, Any]) -> None:
    run = simulate(**scene)
    assert is_finite(run)
    assert not run.counts.given_up, run.events[-3:]
    assert np.abs(run.theta_rad).max() <= 1.5 + 1e-12
    bound = (
        STRESS_STEPS_PER_S
        * (1.0 + run.end_s)
        * (10.0 + scene["motion_x"].frequency_hz + scene["motion_z"].frequency_hz)
    )
    assert run.counts.steps + run.counts.events < bound + 40 * run.counts.impacts, run.counts
    consistent = scene["form"] == Form()
    if consistent:
        scale = scene["block"].mass_kg * GRAVITY * scene["block"].centroid_height_m
        assert run.energy_gained_j <= ENERGY_RISE_REL * (scale + run.energy_lost_j)
    other = simulate(**mirrored(scene))
    assert np.array_equal(run.theta_rad, -other.theta_rad)
    assert np.array_equal(run.slip_m, -other.slip_m)
    sides = {"overturned_left": "overturned_right", "overturned_right": "overturned_left"}
    assert other.outcome.value == sides.get(run.outcome.value, run.outcome.value)


@settings(max_examples=60, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(scenes())
def test_free_motion_never_gains_energy(scene: dict[str, Any]) -> None:
    free = scene | {"form": Form(), "dt_s": 0.002}
    free["motion_x"], free["motion_z"] = Harmonic(0.0, 1.0), Harmonic(0.0, 1.0)
    run = simulate(**free)
    block, pedestal = scene["block"], scene["pedestal"]
    m, h = block.mass_kg, block.centroid_height_m
    total = m + (pedestal.mass_kg if pedestal is not None else 0.0)
    corners = np.array([vertex[0] for vertex in block.profile_m])
    left = run.theta_rad < 0.0
    x = np.where(left, corners[0], corners[1])
    z = x * np.sin(run.theta_rad) + h * np.cos(run.theta_rad)
    w, v = run.theta_rate_rad_s, run.slip_rate_m_s
    energy = (
        0.5 * total * v**2
        + m * z * w * v
        + 0.5 * (block.inertia_kg_m2 + m * (x**2 + h**2)) * w**2
        + m * GRAVITY * (z - h)
    )
    scale = m * GRAVITY * h + float(np.abs(energy).max())
    moving = run.theta_rad != 0.0
    pairs = moving[1:] & moving[:-1]
    assert np.diff(energy)[pairs].max(initial=0.0) <= 1e3 * ENERGY_RISE_REL * scale


@pytest.mark.parametrize("ratio", [0.0, 0.5])
def test_a_prescribed_ratio_comes_to_rest_on_its_pedestal(ratio: float) -> None:
    """Each stick onset lifted the landed statue by rounding, and its landing pushed the pedestal again, without end."""
    run = simulate(
        Block.rectangle(width_m=0.1, height_m=1.0),
        Harmonic(0.0, 1.0),
        pedestal=Pedestal(1.0, 0.2, 0.2),
        floor_static=1.0,
        floor_kinetic=1.0,
        form=Form(restitution=ratio),
        theta_rate0_rad_s=0.15660459763365828,
        duration_s=1.0,
        accuracy_rad=1e-9,
    )
    assert not run.counts.given_up
    assert run.outcome.value == "stands"
    assert run.events[-1].pattern == "rest"
    assert run.end_s == 1.0
