"""What each misprint or simplification of the paper changes on its own cases: docs/measured/paper_forms.md.

`python -m tests.measures.paper_forms [TABLE...]` computes them again, or those named.
"""

import math
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Final, final

import analytic
from analytic.block import GRAVITY_M_S2
from tests.measures.pages import renew_tables, table

PAGE: Final = "measured/paper_forms.md"
MODULE: Final = "tests.measures.paper_forms"
DURATION_S: Final = 10.0
RATIO: Final = 0.875
FREQUENCIES_HZ: Final = (1.5, 2.0, 3.0, 4.5, 6.0)
AMPLITUDES_G: Final = (0.334, 0.429)
SOIL_FACTOR: Final = {0.334: 1.228, 0.429: 1.104}


@final
@dataclass(frozen=True)
class Reading:
    """One way of reading the paper: the statue's corners, friction, form of the model and motion."""

    corner_left_m: float = 0.3585
    corner_right_m: float = 0.0682
    floor_static: float = 0.20
    phase_rad: float = 0.0
    on_soil: bool = False
    normal: str = "dynamic"
    restitution: float | None = None
    pedestal_at_impact: str = "momentum"


CONSISTENT: Final = Reading()
PAPER: Final = Reading(normal="static", restitution=RATIO, pedestal_at_impact="unchanged")
READINGS: Final[tuple[tuple[str, str, Reading], ...]] = (
    ("consistent", "the model of this project: normal force and impact from the balance of momentum", CONSISTENT),
    ("paper", f"the paper's form: ratio {RATIO} both ways, N = M g, pedestal's velocity unchanged at impact", PAPER),
    ("paper, r 0.85", "the same with the smallest of the paper's ratios", replace(PAPER, restitution=0.85)),
    ("paper, r 0.90", "the same with the largest", replace(PAPER, restitution=0.90)),
    ("N = M g", "only the friction ignores the statue's vertical inertia", replace(CONSISTENT, normal="static")),
    ("ratio", f"only the ratio at impact is prescribed, {RATIO} both ways", replace(CONSISTENT, restitution=RATIO)),
    ("u̇ unchanged", "only the impact ignores the pedestal", replace(CONSISTENT, pedestal_at_impact="unchanged")),
    (
        "slip at μ_k",
        "eq. (14)-(19) use μ_k as the threshold of slip: μ_s = μ_k = 0.15",
        replace(CONSISTENT, floor_static=0.15),
    ),
    (
        "corners exchanged",
        "the system under eq. (11) pairs θ > 0 with R₂: the mirror image under the same motion",
        replace(CONSISTENT, corner_left_m=0.0682, corner_right_m=0.3585),
    ),
    (
        "one b",
        "one b for both corners, the mean of b₁ and b₂",
        replace(CONSISTENT, corner_left_m=0.21335, corner_right_m=0.21335),
    ),
    (
        "α₂ = 0.47",
        "0.47 rad is given for O′ where atan(b₂/h) is 0.434: b₂ = h tan 0.47",
        replace(CONSISTENT, corner_left_m=0.774 * math.tan(0.47)),
    ),
    ("cosine", "the phase is not given: a = A cos 2πft", replace(CONSISTENT, phase_rad=0.5 * math.pi)),
    ("a_g S", "amplitude with the soil factor, 0.410 g and 0.474 g", replace(CONSISTENT, on_soil=True)),
)


def run(reading: Reading, amplitude_g: float, frequency_hz: float, *, pedestal: bool) -> analytic.Solution:
    """One of the paper's cases in one reading (a = A sin 2πft from rest, 10 s)."""
    factor = SOIL_FACTOR[amplitude_g] if reading.on_soil else 1.0
    block = analytic.Block.two_corners(
        mass_kg=707.0,
        centroid_height_m=0.774,
        inertia_kg_m2=152.4,
        corner_left_m=reading.corner_left_m,
        corner_right_m=reading.corner_right_m,
    )
    form = analytic.Form(
        "static" if reading.normal == "static" else "dynamic",
        reading.restitution,
        "unchanged" if reading.pedestal_at_impact == "unchanged" else "momentum",
    )
    return analytic.simulate(
        block,
        analytic.Harmonic(factor * amplitude_g * GRAVITY_M_S2, frequency_hz, reading.phase_rad),
        pedestal=analytic.Pedestal(250.0, 0.60, 0.20) if pedestal else None,
        floor_static=reading.floor_static,
        floor_kinetic=0.15,
        form=form,
        duration_s=DURATION_S,
        gravity_m_s2=GRAVITY_M_S2,
        dt_s=None,
    )


def readings(*, pedestal: bool) -> list[tuple[str, str, Reading]]:
    """The readings that can matter: without a pedestal those that concern only its friction or momentum cannot."""
    kept: dict[Reading, tuple[str, str, Reading]] = {}
    for name, meaning, reading in READINGS:
        bare = replace(reading, normal="dynamic", pedestal_at_impact="momentum", floor_static=CONSISTENT.floor_static)
        kept.setdefault(reading if pedestal else bare, (name, meaning, reading))
    return list(kept.values())


def cases(*, pedestal: bool) -> list[tuple[float, float, bool]]:
    """The paper's amplitudes and frequencies."""
    return [(a, f, pedestal) for a in AMPLITUDES_G for f in FREQUENCIES_HZ]


def summary(solutions: dict[str, list[analytic.Solution]], *, pedestal: bool) -> str:
    """Per reading: how many outcomes and how much of the peaks change against `consistent`."""
    base = solutions["consistent"]
    rows = []
    for name, meaning, _ in readings(pedestal=pedestal)[1:]:
        pairs = list(zip(solutions[name], base, strict=True))
        changed = sum(a.outcome != b.outcome for a, b in pairs)
        both = [(a, b) for a, b in pairs if str(a.outcome) == str(b.outcome) == "stands"]
        turn, slip = (_largest(both, measure) for measure in (lambda s: s.peak_theta_rad, lambda s: s.peak_slip_m))
        row = [f"{changed} of {len(pairs)}", f"{turn:.3f} rad"]
        more = [f"{1000.0 * slip:.1f} mm", _gained(solutions[name])]
        rows.append([name, meaning, *row, *more] if pedestal else [name, *row])
    head = ["outcomes changed", "peak θ, largest change"]
    if not pedestal:
        return table(["reading", *head], rows)
    return table(
        ["reading", "what is read otherwise", *head, "peak slip, largest change", "energy gained at impacts"], rows
    )


def _largest(
    pairs: list[tuple[analytic.Solution, analytic.Solution]], measure: Callable[[analytic.Solution], float]
) -> float:
    return max((abs(abs(measure(a)) - abs(measure(b))) for a, b in pairs), default=0.0)


def _gained(solutions: list[analytic.Solution]) -> str:
    return f"{sum(s.energy_gained_j for s in solutions):.2f} J"


def printed_signs() -> str:
    """The system under eq. (11) as printed, solved at single instants, against the same with its signs corrected.

    x as in the paper (the mirror of this project's), N = M g; power is that of the friction on the sliding pedestal.
    """
    rows = []
    for side, sliding in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
        corner = 0.0682 if side > 0 else 0.3585
        printed = _instant(side, coupling=side, friction=side, corner_m=corner)
        right = _instant(side, coupling=-1, friction=sliding, corner_m=corner)
        speed = 0.1 * sliding
        power = [-957.0 * 0.15 * GRAVITY_M_S2 * sign * speed for sign in (side, sliding)]
        rows.append(
            [f"{0.05 * side:+.2f}", f"{speed:+.1f}"]
            + [f"{p:+.2f} / {c:+.2f}" for p, c in zip((*printed, power[0]), (*right, power[1]), strict=True)]
        )
    return table(
        ["θ (rad)", "u̇ (m/s)", "θ̈ printed / corrected", "A printed / corrected", "power of friction (W)"], rows
    )


def _instant(side: int, *, coupling: int, friction: int, corner_m: float) -> tuple[float, float]:
    """(θ̈, A) of J θ̈ − m R cos φ A = −s m R g sin φ and M A + c m R cos φ θ̈ = s m R sin φ θ̇² − f M μ_k g, θ̇ = 0.2 s."""
    m, total, h, mu, theta, rate = 707.0, 957.0, 0.774, 0.15, 0.05, 0.2
    radius, phi = math.hypot(corner_m, h), math.atan2(corner_m, h) - theta
    lever, lift = m * radius * math.cos(phi), m * radius * math.sin(phi)
    inertia = 152.4 + m * radius**2
    first, second = -side * lift * GRAVITY_M_S2, side * lift * rate**2 - friction * total * mu * GRAVITY_M_S2
    determinant = inertia * total + coupling * lever**2
    return (first * total + lever * second) / determinant, (inertia * second - coupling * lever * first) / determinant


def forms(*, pedestal: bool) -> str:
    """What each reading changes, with or without the pedestal."""
    named = readings(pedestal=pedestal)
    grid = cases(pedestal=pedestal)
    solutions = {name: [run(r, a, f, pedestal=pedestal) for a, f, _ in grid] for name, _, r in named}
    return summary(solutions, pedestal=pedestal)


TABLES: Final[Mapping[str, Callable[[], str]]] = {
    "pedestal": partial(forms, pedestal=True),
    "floor": partial(forms, pedestal=False),
    "signs": printed_signs,
}

if __name__ == "__main__":
    renew_tables(PAGE, MODULE, TABLES, sys.argv[1:])
