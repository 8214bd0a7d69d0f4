"""The checks can fail: small wrong changes of the model, each seen by comparing the kernel with an independent reference.

A comparison does not know which side is wrong. So what the kernel is given (its parameters, base and motion) is changed on
its way into the compiled code, and what stands in its equations (couplings, forces, the impact map) in the reference, whose
equations are plain Python; either way the two must part by more than is claimed.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any, Final

import numpy as np
import pytest

from analytic import Record, solver
from analytic.kernel.records import Params
from tests import budgets_reference as budget
from tests.analytic import reference_kernel, reference_lagrange
from tests.analytic.reference_case import Case, Path, full_period, paper_case, record, rest
from tests.analytic.reference_lagrange_model import Lagrange

END_S, GRID_S = 0.9, 0.02
PEDESTAL: Final = paper_case(0.429, 3.0, pedestal=True, form="consistent")
LIFTED: Final = replace(PEDESTAL, accel_z=full_period(3.0, 0.7))
PRESCRIBED: Final = replace(PEDESTAL, ratio=0.875)
TIMES: Final = np.arange(91) * 0.01
ACCELS: Final = 4.2 * np.sin(19.0 * TIMES)
SHAKEN: Final = replace(PEDESTAL, accel_x=record(TIMES.tolist(), ACCELS.tolist()))


def parted(a: Path, b: Path) -> bool:
    """Whether the comparison of tests/analytic/test_reference.py refuses the two."""
    shared = min(len(a.samples), len(b.samples))
    gap = np.max(np.abs(a.samples[:shared] - b.samples[:shared]), axis=0)
    return bool(abs(len(a.samples) - len(b.samples)) > 1 or gap[1] > budget.KERNEL_RAD or gap[3] > budget.KERNEL_M)


def kernel(case: Case) -> Path:
    return reference_kernel.solve(case, END_S, GRID_S)


def reference(case: Case) -> Path:
    return reference_lagrange.solve(case, END_S, GRID_S)


def seen(case: Case) -> Path | None:
    """The path of a reference that is wrong; None where it has no solution at all."""
    try:
        return reference(case)
    except (AssertionError, np.linalg.LinAlgError):
        return None


@pytest.fixture(scope="module")
def truth() -> dict[str, Path]:
    """The reference's path of each case."""
    return {name: reference(case) for name, case in CASES.items()}


CASES: Final = {"pedestal": PEDESTAL, "lifted": LIFTED, "prescribed": PRESCRIBED, "shaken": SHAKEN}


@pytest.mark.parametrize("name", CASES)
def test_without_a_mutant_the_two_agree(name: str, truth: dict[str, Path]) -> None:
    assert truth[name].times("impact")
    assert not parted(kernel(CASES[name]), truth[name])


PARAMETERS: Final[dict[str, tuple[str, str, Callable[[Any], Any]]]] = {
    "ratio off by 1 %": ("prescribed", "restitution", lambda r: 1.01 * r),
    "ratio not used": ("prescribed", "restitution", lambda r: -1.0),
    "inertia off by one in a million": ("pedestal", "inertia_kg_m2", lambda j: j * (1.0 + 1e-6)),
    "pedestal's mass left out": ("pedestal", "pedestal_mass_kg", lambda m: 1e-6),
    "gravity off by one in a million": ("pedestal", "gravity_m_s2", lambda g: g * (1.0 + 1e-6)),
    "slip at the kinetic limit": ("pedestal", "floor_static", lambda mu: 0.15),
    "sliding at the static limit": ("pedestal", "floor_kinetic", lambda mu: 0.20),
    "friction of a static normal force": ("pedestal", "dynamic_normal", lambda flag: False),
    "pedestal's velocity unchanged at impact": ("pedestal", "momentum_at_impact", lambda flag: False),
    "pedestal held to the floor": ("pedestal", "has_pedestal", lambda flag: False),
    "tolerance of 1e-4": ("pedestal", "tolerance_rad", lambda tol: 1e-4),
}


@pytest.mark.parametrize("mutant", PARAMETERS)
def test_a_wrong_number_in_the_kernel_is_seen(
    mutant: str, truth: dict[str, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    case, field, wrong = PARAMETERS[mutant]
    right = solver.encode

    def encode(*given: Any) -> Params:
        params = right(*given)
        return replace(params, **{field: wrong(getattr(params, field))})

    monkeypatch.setattr(solver, "encode", encode)
    assert parted(kernel(CASES[case]), truth[case])


def test_swapped_corners_and_a_vertical_motion_left_out_are_seen(truth: dict[str, Path]) -> None:
    swapped = replace(PEDESTAL, b_left=PEDESTAL.b_right, b_right=PEDESTAL.b_left)
    assert parted(kernel(swapped), truth["pedestal"])
    assert parted(kernel(replace(LIFTED, accel_z=rest())), truth["lifted"])


MOTIONS: Final[dict[str, Callable[[], Record]]] = {
    "a record read one sample late": lambda: Record(TIMES[:-1], ACCELS[1:]),
    "a record that ends at its sixtieth sample": lambda: Record(TIMES[:60], ACCELS[:60]),
    "a record held between samples": lambda: Record(
        np.repeat(TIMES, 2)[1:] - np.tile([0.0, 1e-9], TIMES.size)[:-1], np.repeat(ACCELS, 2)[:-1]
    ),
}


@pytest.mark.parametrize("mutant", MOTIONS)
def test_a_break_at_the_wrong_sample_is_seen(
    mutant: str, truth: dict[str, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    right = reference_kernel.excitation

    def excitation(motion: Any) -> Any:
        made = right(motion)
        return MOTIONS[mutant]() if isinstance(made, Record) else made

    monkeypatch.setattr(reference_kernel, "excitation", excitation)
    assert parted(kernel(SHAKEN), truth["shaken"])


EQUATIONS: Final = {
    "sign of the coupling of rotation and translation": (4, 1, -1.0),
    "moment of the pivot's horizontal force dropped": (4, 1, 0.0),
    "statue's push on the pedestal dropped": (0, 0, 0.0),
    "statue's load on the floor's friction dropped": (1, 0, 0.0),
    "pedestal's mass off by 0.1 %": (0, 1, 1.001),
    "statue's weight off by 0.1 %": (4, 2, 1.001),
    "both weights off by 0.1 %": (1, 2, 1.001),
}
"""Of the equations of (slip, the floor's normal, -, -, rotation) the coefficient of (θ̈, ü, 1), and its factor."""


@pytest.mark.parametrize("mutant", EQUATIONS)
def test_a_wrong_term_of_the_equations_is_seen(mutant: str, monkeypatch: pytest.MonkeyPatch) -> None:
    equation, term, factor = EQUATIONS[mutant]
    right = Lagrange.rows

    def rows(self: Lagrange, *state: Any) -> list[list[float]]:
        found = right(self, *state)
        found[equation][term] *= factor
        return found

    monkeypatch.setattr(Lagrange, "rows", rows)
    found = seen(PEDESTAL)
    assert found is None or parted(kernel(PEDESTAL), found)


IMPACTS: Final[dict[str, Callable[[float, float, float], tuple[float, float]]]] = {
    "statue's rate off by 1 %": lambda rate, v, before: (1.01 * rate, v),
    "pedestal's velocity kept": lambda rate, v, before: (rate, before),
    "pedestal stopped": lambda rate, v, before: (rate, 0.0),
    "pedestal pushed the other way": lambda rate, v, before: (rate, -v),
    "statue's rate off by one in ten thousand": lambda rate, v, before: (0.9999 * rate, v),
}


@pytest.mark.parametrize("mutant", IMPACTS)
def test_a_wrong_impact_on_the_pedestal_is_seen(mutant: str, monkeypatch: pytest.MonkeyPatch) -> None:
    right = Lagrange.impact

    def impact(self: Lagrange, side: int, y: np.ndarray, stuck: bool) -> tuple[float, float]:
        rate, v = right(self, side, y, stuck)
        return IMPACTS[mutant](rate, v, float(y[3]))

    monkeypatch.setattr(Lagrange, "impact", impact)
    found = seen(PEDESTAL)
    assert found is None or parted(kernel(PEDESTAL), found)
