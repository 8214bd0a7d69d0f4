"""A statue wider than its pedestal, which tips: both turn as one, then the statue on the edge of the top; by the equations."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import harness
from harness.engines import load
from harness.model import RunOptions
from tests import budgets_engines as budget

Array = NDArray[np.float64]
END_S = 0.46
STATUE = {
    "mass_kg": 606.6, "centroid_height_m": 0.4544, "corner_left_m": 0.1718, "corner_right_m": 0.1702,
    "inertia_kg_m2": 40.21, "height_m": 0.9088, "depth_m": 0.3,
}  # fmt: skip
PEDESTAL = {"mass_kg": 340.2, "width_m": 0.35, "depth_m": 0.2736, "height_m": 0.2852}
NARROW_M = 0.31
PULSE = {"kind": "pulse", "shape": "one_sine", "amplitude_g": 0.576, "duration_s": 0.5727, "start_s": 0.0268}


def tipping() -> harness.Scene:
    """The scene: high friction, so that nothing slides. No file has such a pedestal; a statue may come to it."""
    contact = {"floor_static": 1.76, "floor_kinetic": 1.62, "statue": 2.0}
    tables = {
        "title": "overhanging",
        "duration_s": END_S,
        "statue": STATUE,
        "pedestal": PEDESTAL,
        "contact": contact,
        "motion": {"x": PULSE},
    }
    scene = harness.scene(tables)
    assert scene.pedestal is not None
    return replace(scene, pedestal=replace(scene.pedestal, width_m=NARROW_M))


def crossed(a: Array, b: Array) -> float:
    return float(a[0] * b[1] - a[1] * b[0])


def across(a: Array) -> Array:
    return np.array([-a[1], a[0]])


def turned(angle_rad: float, a: Array) -> Array:
    cos, sin = math.cos(angle_rad), math.sin(angle_rad)
    return np.array([cos * a[0] - sin * a[1], sin * a[0] + cos * a[1]])


def solution(scene: harness.Scene) -> tuple[float, object]:
    """When the statue lifts, s, and (pedestal's, statue's tilt, rates) to the left from then on, rad, as functions of time.

    Both turn about the pedestal's lower left corner as one body until the statue's force on the top would act beyond its left
    edge; the statue then turns on that edge: a double pendulum upside down.
    """
    statue, pedestal = scene.statue, scene.pedestal
    top = np.array([0.0, pedestal.height_m])
    on_top = np.array([0.5 * pedestal.width_m - scene.statue.base_centre_m, statue.centroid_height_m])
    middle = np.array([0.5 * pedestal.width_m, 0.5 * pedestal.height_m])
    own = pedestal.mass_kg * (pedestal.width_m**2 + pedestal.height_m**2) / 12.0
    masses = ((statue.mass_kg, top + on_top), (pedestal.mass_kg, middle))
    inertia = statue.inertia_kg_m2 + own + sum(mass * float(arm @ arm) for mass, arm in masses)

    def pull(t_s: float) -> Array:
        return np.array([-float(scene.base_excitation.x.accel_m_s2(t_s)), -scene.gravity_m_s2])

    def moment(t_s: float, tilt: float) -> float:
        return sum(mass * crossed(turned(tilt, arm), pull(t_s)) for mass, arm in masses)

    starts_s = brentq(lambda t_s: moment(t_s, 0.0), PULSE["start_s"], PULSE["start_s"] + 0.25 * PULSE["duration_s"])
    tight = {"rtol": 1e-11, "atol": 1e-13, "dense_output": True}
    together = solve_ivp(lambda t, y: [y[1], moment(t, y[0]) / inertia], (starts_s, END_S), [0.0, 0.0], **tight).sol

    def force_at(t_s: float) -> float:
        """Where on the top the statue's force acts, m from the left edge."""
        tilt, rate = together(t_s)
        arm, gain = turned(tilt, top + on_top), moment(t_s, tilt) / inertia
        force = statue.mass_kg * (gain * across(arm) - rate**2 * arm - pull(t_s))
        from_centroid = turned(tilt, top) - arm
        along = turned(tilt, np.array([1.0, 0.0]))
        return (statue.inertia_kg_m2 * gain - crossed(from_centroid, force)) / crossed(along, force)

    lifts_s = brentq(force_at, starts_s + 0.05, END_S)

    def linked(t_s: float, state: Array) -> list[float]:
        tilt, lean, tilt_rate, lean_rate = state
        edge, arm, box = turned(tilt, top), turned(lean, on_top), turned(tilt, middle)
        a, b, mass = across(edge), across(arm), statue.mass_kg
        matrix = [
            [own + pedestal.mass_kg * box @ box + mass * a @ a, mass * a @ b],
            [mass * a @ b, statue.inertia_kg_m2 + mass * b @ b],
        ]
        left = mass * (pull(t_s) + tilt_rate**2 * edge + lean_rate**2 * arm)
        gains = np.linalg.solve(matrix, [pedestal.mass_kg * across(box) @ pull(t_s) + a @ left, b @ left])
        return [tilt_rate, lean_rate, *gains.tolist()]

    tilt, rate = together(lifts_s)
    return lifts_s, solve_ivp(linked, (lifts_s, END_S), [tilt, tilt, rate, rate], **tight).sol


@pytest.mark.parametrize("name", ["pymunk", "pybullet"])
def test_a_statue_that_overhangs_turns_on_the_edge_of_its_pedestal(name: str) -> None:
    scene = tipping()
    lifts_s, exact = solution(scene)
    engine = load(name)
    run = engine.simulate(scene, engine.settings_for_dt(scene, 2.5e-4), RunOptions())
    t_s = run.history.t_s[run.history.t_s > lifts_s]
    tilt, lean, *_ = exact(t_s)  # type: ignore[operator]
    assert np.max(lean - tilt) > budget.EDGE_SEEN_RAD, "long enough that a millimetre would show"
    late = slice(-t_s.size, None)
    assert np.max(np.abs(run.history.theta_rad[late] + lean)) < budget.ON_THE_EDGE_RAD[name]
    assert np.max(np.abs(run.history.extra["pedestal_tilt_rad"][late] + tilt)) < 2.0 * budget.ON_THE_EDGE_RAD[name]
