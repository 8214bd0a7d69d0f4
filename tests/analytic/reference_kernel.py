"""The compiled model on a reference case, as a path: the only place where the two vocabularies meet."""

import numpy as np

from analytic import Excitation, Harmonic, Pulse, Record, Rest
from analytic.block import Block, Form, Pedestal, Wall
from analytic.solver import Certified, certify, simulate
from tests.analytic.reference_case import PEDESTAL_SIZE_M, Case, Motion, Path

OUTCOMES = {"stands": "ran", "undecided": "ran"}


def excitation(motion: Motion) -> Excitation:
    """The same motion as the library's own class."""
    name, numbers = motion.recipe
    if name == "rest":
        return Rest()
    if name == "harmonic":
        return Harmonic(*numbers)  # type: ignore[arg-type]
    if name == "record":
        return Record(*(np.array(n) for n in numbers))
    if name in ("one_sine", "one_cosine", "rectangular"):
        return Pulse(name, *numbers)  # type: ignore[arg-type]
    raise ValueError(f"no excitation for the recipe {name!r}")


def certified(case: Case, end: float, grid: float) -> Certified:
    """The compiled model's own certificate of a case."""
    return certify(*_given(case), duration_s=end, dt_s=grid, accuracy_rad=1e-6, **_keywords(case))  # type: ignore[arg-type]


def _given(case: Case) -> tuple[Block, Excitation, Excitation]:
    corners = ((-case.b_left, 0.0), (case.b_right, 0.0))
    block = Block(case.m2, case.h, case.inertia, case.profile if case.profile is not None else corners)
    return block, excitation(case.accel_x), excitation(case.accel_z)


def _wall(case: Case, side: int, distance_m: float, top_m: float) -> Wall:
    silhouette = tuple((x, z) for x in (-case.b_left, case.b_right) for z in (0.0, top_m))
    return Wall("right" if side > 0 else "left", distance_m, silhouette)


def _keywords(case: Case) -> dict[str, object]:
    return {
        "pedestal": None if case.pedestal_kg is None else Pedestal(case.pedestal_kg, *PEDESTAL_SIZE_M),
        "floor_static": case.mu_static,
        "floor_kinetic": case.mu_kinetic,
        "floor_impact": "kinetic" if case.mu_impact is None else case.mu_impact,
        "form": Form(case.normal, case.ratio, case.pedestal_at_impact),  # type: ignore[arg-type]
        "theta0_rad": case.theta0,
        "theta_rate0_rad_s": case.rate0,
        "gravity_m_s2": case.gravity,
        "overturn_rad": case.overturn,
        "wall": None if case.wall is None else _wall(case, *case.wall),
    }


def solve(case: Case, end: float, grid: float, **options: object) -> Path:
    """Path of the compiled model, every `grid` seconds and at its end."""
    result = simulate(*_given(case), duration_s=end, dt_s=grid, **_keywords(case), **options)  # type: ignore[arg-type]
    names = {("slip", 1): "slip_forward", ("slip", -1): "slip_backward"}
    events = tuple((e.time_s, names.get((str(e.kind), e.slide), str(e.kind))) for e in result.events)
    if result.no_return_time_s is not None:
        events = (*events, (result.no_return_time_s, "balance"))
    columns = (result.t_s, result.theta_rad, result.theta_rate_rad_s, result.slip_m, result.slip_rate_m_s)
    outcome = str(result.outcome)
    ties = sum(e.feasible_states > 1 for e in result.events)
    return Path(np.column_stack(columns), events, OUTCOMES.get(outcome, outcome), ties)
