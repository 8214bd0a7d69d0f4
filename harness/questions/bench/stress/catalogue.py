"""The hard scenes, each with the outcome that it must have."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from harness.input.motions.recordfile import STANDARD_GRAVITY_M_S2
from harness.questions.bench.standard_scenes import COLUMN, EQUAL, PAESTUM, PEDESTAL, harmonic
from harness.questions.bench.stress import checks
from harness.questions.bench.stress.checks import BASIC, Check

ALL: Final = ("analytic", "pymunk", "pybullet")
CONTACT: Final = ("pymunk", "pybullet")
ALPHA_RAD: Final = math.atan(0.2)
"""Slenderness of the column."""


@dataclass(frozen=True)
class Hard:
    """One hard scene: content as in a scene file, the outcome that it must have by every engine named, what is checked.

    `dt_s` is the contact engines' step; `skips` off makes them integrate what they could leave out; `exact` compares every run
    with the analytic solution. Where a check fails, `converged_s` seconds with far more iterations a step (`converged`) tell
    whether it is a known failure of a solver that ends its steps early.
    """

    name: str
    content: Mapping[str, object]
    wanted: str
    engines: Sequence[str] = ALL
    checks: Sequence[Check] = BASIC
    dt_s: float = 1e-3
    skips: bool = True
    note: str = ""
    exact: bool = True
    converged_s: float | None = None


def body(width_m: float, height_m: float) -> dict[str, float]:
    """A homogeneous block of marble."""
    mass = 2700.0 * width_m * height_m * 0.5 * height_m
    return {
        "mass_kg": mass, "centroid_height_m": 0.5 * height_m, "corner_left_m": 0.5 * width_m,
        "corner_right_m": 0.5 * width_m, "inertia_kg_m2": mass * (width_m**2 + height_m**2) / 12.0,
        "height_m": height_m, "depth_m": 0.5 * height_m,
    }  # fmt: skip


def leaning(statue: Mapping[str, float], share: float, duration_s: float, **more: Any) -> dict[str, object]:
    """Released from a share of its slenderness."""
    alpha = math.atan(statue["corner_right_m"] / statue["centroid_height_m"])
    return {"duration_s": duration_s, "statue": statue, "initial": {"theta_rad": share * alpha}, **more}


def catalogue() -> tuple[Hard, ...]:
    """All hard scenes that a file can describe."""
    return (*_rest(), *_ties(), *_sizes(), *_bodies(), *_motions())


def _rest() -> list[Hard]:
    still = {"duration_s": 600.0, "output": {"dt_s": 0.1}}
    on_pedestal = {"duration_s": 60.0, "statue": PAESTUM, "pedestal": PEDESTAL, "output": {"dt_s": 0.05}}
    far = {
        "duration_s": 48.0, "table": "moving", "statue": COLUMN, "output": {"dt_s": 0.01},
        "motion": {"x": {"kind": "pulse", "shape": "rectangular", "amplitude_g": 0.1, "duration_s": 100.0}},
    }  # fmt: skip
    creeping = (*BASIC, checks.creep)
    return [
        Hard(
            "600 s at rest", {**still, "statue": COLUMN}, "stands", checks=creeping, dt_s=2e-3, skips=False, exact=False
        ),
        Hard("60 s at rest on a pedestal", on_pedestal, "stands", checks=creeping, skips=False, exact=False),
        Hard(
            "1.1 km from the origin", far, "stands", CONTACT, creeping, skips=False,
            note="a table that moves away at 0.1 g for 48 s, below every limit of rest",
        ),
    ]  # fmt: skip


def _ties() -> list[Hard]:
    limit = 0.2
    tangent = {"duration_s": 2.0, "statue": COLUMN, "motion": harmonic(limit * (1.0 + 1e-6), 2.0)}
    below = {"duration_s": 2.0, "statue": COLUMN, "motion": harmonic(limit * (1.0 - 1e-3), 2.0)}
    ending = (*BASIC, checks.ends_at_rest)
    return [
        Hard("released 1e-6 rad below balance", leaning(COLUMN, 1.0 - 1e-6 / ALPHA_RAD, 12.0), "stands"),
        Hard("released 1e-3 rad below balance", leaning(COLUMN, 1.0 - 1e-3 / ALPHA_RAD, 8.0), "stands"),
        Hard("released 1e-3 rad beyond balance", leaning(COLUMN, 1.0 + 1e-3 / ALPHA_RAD, 8.0), "overturned_right"),
        Hard("uplift touched by one part in a million", tangent, "stands"),
        Hard("uplift missed by one part in a thousand", below, "stands", checks=(*BASIC, checks.upright)),
        Hard("impacts without number (Zeno)", leaning(COLUMN, 0.5, 20.0), "stands", checks=ending, skips=False),
    ]


def _sizes() -> list[Hard]:
    halfway = {f"{slender:g}": leaning(body(1.0 / slender, 1.0), 0.5, 3.0) for slender in (1.0, 10.0, 50.0)}
    # Times go with the root of the height.
    scaled = {
        height: leaning(body(0.2 * height, height), 0.5, 3.0 * math.sqrt(height), output={"dt_s": 1e-3 * math.sqrt(height)})
        for height in (0.01, 100.0)
    }  # fmt: skip
    return [
        *(Hard(f"height to width {slender}", content, "stands", dt_s=5e-4) for slender, content in halfway.items()),
        *(Hard(f"{m:g} m high", content, "stands", dt_s=2.5e-4 * math.sqrt(m)) for m, content in scaled.items()),
    ]


def _bodies() -> list[Hard]:
    pushed = {"duration_s": 1.0, "statue": PAESTUM, "motion": harmonic(0.429, 3.0)}
    light, heavy = ({**PEDESTAL, "mass_kg": PAESTUM["mass_kg"] * ratio} for ratio in (1e-3, 1e3))
    equal = {**pushed, "contact": EQUAL}
    return [
        Hard(
            "pedestal 0.001 times the statue's mass", {**equal, "pedestal": light}, "stands", dt_s=2.5e-4, converged_s=1.0
        ),
        Hard("pedestal 1000 times the statue's mass", {**equal, "pedestal": heavy}, "stands"),
        *(
            Hard(
                f"floor friction {friction:g}",
                {**pushed, "pedestal": PEDESTAL, "contact": {"floor_static": friction, "floor_kinetic": friction}},
                "stands",
            )
            for friction in (0.0, 5.0)
        ),
    ]  # fmt: skip


SHAKEN: Final = {"statue": COLUMN, "contact": {"statue": 10.0}, "motion": harmonic(5.0, 100.0)}
"""5 g at 100 Hz on a statue that cannot slide off, which it would at once with less friction."""


def _motions() -> list[Hard]:
    # The g of a motion's amplitude: with it as weight, −1 g leaves none.
    drop = {
        "duration_s": 2.0, "gravity_m_s2": STANDARD_GRAVITY_M_S2, "statue": COLUMN,
        "motion": {
            "z": {"kind": "pulse", "shape": "rectangular", "amplitude_g": -1.0, "duration_s": 0.1, "start_s": 0.2}
        },
    }  # fmt: skip
    upright = (*BASIC, checks.upright)
    return [
        Hard("5 g at 100 Hz", {"duration_s": 0.5, **SHAKEN}, "stands", dt_s=1e-4),
        Hard("floor falls at 1 g: the two-block model", drop, "lift_off", ("analytic",), exact=False),
        Hard("floor falls at 1 g: the engines", drop, "stands", CONTACT, upright, exact=False),
    ]
