"""The cases on which solvers are compared: the paper's, and reproducible random ones."""

from dataclasses import replace

import numpy as np

from tests.analytic.reference_case import (
    GRAVITY,
    PAESTUM,
    PAESTUM_PEDESTAL_KG,
    Case,
    Motion,
    full_period,
    harmonic,
    record,
    rest,
)

PAPER_RATIO = 0.875
AMPLITUDES_G = (0.334, 0.429)
FREQUENCIES_HZ = (1.5, 2.0, 3.0, 4.5, 6.0)
FORMS = ("consistent", "paper", "ratio with momentum", "momentum with unchanged pedestal", "static normal")


def in_form(case: Case, form: str) -> Case:
    """The case in one of the named forms."""
    if form == "paper":
        return case.paper_form(PAPER_RATIO)
    changes: dict[str, dict[str, object]] = {
        "consistent": {},
        "ratio with momentum": {"ratio": PAPER_RATIO},
        "momentum with unchanged pedestal": {"pedestal_at_impact": "unchanged"},
        "static normal": {"normal": "static"},
    }
    return replace(case, **changes[form])  # type: ignore[arg-type]


def paper_case(amplitude_g: float, frequency_hz: float, *, pedestal: bool, form: str, mu_static: float = 0.20) -> Case:
    """One of the paper's cases with a kinetic friction of 0.15."""
    case = Case(
        **PAESTUM,
        pedestal_kg=PAESTUM_PEDESTAL_KG if pedestal else None,
        mu_static=mu_static,
        mu_kinetic=0.15,
        accel_x=harmonic(amplitude_g * GRAVITY, frequency_hz),
    )
    return in_form(case, form)


def random_case(seed: int) -> Case:
    """A statue of any size, asymmetry, pedestal, friction and form under harmonic, pulse or record, vertical motion too."""
    rng = np.random.default_rng(seed)
    h = rng.uniform(0.3, 1.2)
    b_left, b_right = h * rng.uniform(0.06, 0.6, 2)
    m2 = rng.uniform(50.0, 900.0)
    inertia = m2 * (h * h + (0.5 * (b_left + b_right)) ** 2) / 3.0 * rng.uniform(0.6, 1.3)
    mu_kinetic = rng.uniform(0.05, 0.5)
    mu_static = mu_kinetic * rng.uniform(1.0, 1.5)
    pedestal_kg = None if rng.random() < 0.25 else m2 * 10.0 ** rng.uniform(-1.5, 1.0)
    motions = [_random_motion(rng, scale) for scale in (1.0, float(rng.choice([0.0, 0.4, 1.2])))]
    return Case(
        m2,
        h,
        b_left,
        b_right,
        inertia,
        pedestal_kg,
        mu_static,
        mu_kinetic,
        normal=str(rng.choice(["dynamic", "static"])),
        ratio=None if rng.random() < 0.6 else rng.uniform(0.6, 0.95),
        pedestal_at_impact=str(rng.choice(["momentum", "unchanged"], p=[0.7, 0.3])),
        accel_x=motions[0],
        accel_z=motions[1],
        theta0=0.0 if rng.random() < 0.6 else rng.uniform(-0.8 * b_left / h, 0.8 * b_right / h),
    )


def _random_motion(rng: np.random.Generator, scale: float) -> Motion:
    amplitude = scale * GRAVITY * rng.uniform(0.1, 0.9)
    kind = rng.integers(3)
    if amplitude == 0.0:
        return rest()
    if kind == 0:
        return harmonic(amplitude, rng.uniform(0.7, 6.0), rng.uniform(0.0, 6.0))
    if kind == 1:
        return full_period(amplitude, rng.uniform(0.2, 1.0))
    times = np.arange(0.0, 1.51, 0.02)
    return record(times.tolist(), (amplitude * 0.6 * rng.standard_normal(times.size)).tolist())
