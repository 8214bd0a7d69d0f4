"""pybullet on a sliding pedestal in three dimensions, held to a body of springs: no model of the project computes that exactly.

`python -m tests.measures.pedestal_space [COUNT FIRST] [--out FILE]` computes COUNT seeds on one core, keeps a line of JSON for
each scene and renews the table of docs/measured/pedestal_space.md.

The truth shares no code with an engine: two rigid bodies by the laws of momentum, stiff springs with dampers where vertices
touch, friction by a spring that slides (Cundall and Strack, Géotechnique 29, 1979), steps far shorter than its periods. It is
right as its springs grow stiff: of two stiffnesses, one four times the other, what the rotation is off by halves. Where a body
strikes, springs have another impact than rigid bodies (a compliant one), so that it ends before the first impact.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from harness.accuracy.refinement import simulate
from harness.model import BaseExcitation, Contact, Pedestal, Scene
from meshes.footprint import reach_m
from tests.measures.pages import renew, table
from tests.measures.seeded_rows import command_line, measured, seeds_of
from tests.measures.seeded_scenes import space_scene

Array = NDArray[np.float64]

SCENES: Final = 40
FIRST_SEED: Final = 780_000
DURATION_S: Final = 1.2
LONGEST_S: Final = 0.6
BEFORE_IMPACT_S: Final = 5e-3
SINKS: Final = 1e-6
"""What the softer springs give under a body's weight, over its height; the stiffer ones a quarter of it."""
DAMPING: Final = 1.0
"""Of a spring's own oscillation, over the critical."""
STEP_SHARE: Final = 0.1
"""A step over the shortest period of a spring, over 2π."""
SAMPLE_S: Final = 1e-3
STICKS: Final = 2.0
"""Friction between statue and pedestal."""
ROCKS_RAD: Final = 1e-4
"""A statue that leans by less is not counted as rocking."""
MODULE: Final = "tests.measures.pedestal_space"


@dataclass(frozen=True)
class PedestalRow:
    """One scene until the first impact (0: too soon): what pybullet stated and is off by, and how far the springs are known."""

    seed: int
    until_s: float = 0.0
    peak_rad: float = 0.0
    error_rad: float = 0.0
    stated_rad: float = 0.0
    springs_rad: float = 0.0
    slip_m: float = 0.0
    error_m: float = 0.0
    stated_m: float = 0.0
    springs_m: float = 0.0
    across_m: float = 0.0
    across_error_m: float = 0.0
    yaw_rad: float = 0.0
    pedestal_yaw_rad: float = 0.0

    @property
    def held(self) -> tuple[bool, bool]:
        """Whether rotation and slip are within what was stated, up to what the springs leave open."""
        return self.error_rad <= self.stated_rad + self.springs_rad, self.error_m <= self.stated_m + self.springs_m


def pedestal_scene(seed: int) -> Scene:
    """The body of `space_scene` on a pedestal of 0.15 to 2 times its mass, shaken along x and y by 1.5 times as much.

    One coefficient, of 1.05 to 1.8 times the pull that lifts the body from its base's nearest edge: it both slides and rocks.
    """
    rng = np.random.default_rng([seed, 29])
    scene = space_scene(seed, DURATION_S)
    statue, base = scene.statue, scene.base_excitation
    reaches_m = np.max(np.abs(statue.footprint_m[:, :2]), axis=0)
    width_m, depth_m = 2.0 * reaches_m * rng.uniform(1.2, 1.8, 2)
    height_m = statue.centroid_height_m
    pedestal = Pedestal(
        statue.mass_kg * float(rng.uniform(0.15, 2.0)),
        float(width_m),
        float(depth_m),
        height_m * float(rng.uniform(0.1, 0.4)),
    )
    lifts = float(np.min(reach_m(statue.footprint_m, np.arange(0.0, 360.0, 1.0)))) / height_m
    friction = lifts * float(rng.uniform(1.05, 1.8))
    across = base.x.scaled(float(rng.uniform(0.2, 0.8))) if base.y.peak_m_s2 == 0.0 else base.y.scaled(1.5)
    moved = BaseExcitation(base.x.scaled(1.5), across)
    return replace(scene, pedestal=pedestal, contact=Contact(friction, friction, STICKS), base_excitation=moved)


@njit
def _turn(q: Array) -> Array:
    w, x, y, z = q
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])  # fmt: skip


@njit
def _push(gap: float, velocity: Array, axes: Array, slid: Array, law: Array, step_s: float) -> Array:
    """Force of a vertex's springs, N; `slid` (2,) is how far the tangential ones are drawn along the first two of `axes`."""
    stiff, damped, friction = law
    if gap >= 0.0:
        slid[:] = 0.0
        return np.zeros(3)
    rate = axes.T @ velocity
    normal = max(-stiff * gap - damped * rate[2], 0.0)
    slid += rate[:2] * step_s
    along = -stiff * slid - damped * rate[:2]
    size = math.hypot(along[0], along[1])
    if size > friction * normal:
        along *= friction * normal / size
        slid[:] = -(along + damped * rate[:2]) / stiff
    return along[0] * axes[:, 0] + along[1] * axes[:, 1] + normal * axes[:, 2]


@njit
def _springs(
    masses: Array, inertias: Array, feet: Array, corners: Array, places: Array, half_m: float, pulls: Array, laws: Array,
    step_s: float, every: int,
) -> Array:  # fmt: skip
    """Samples (n, 5): rotation of the statue about y, places x and y of the pedestal, the two bodies' yaw."""
    at, velocity, spin = places.copy(), np.zeros((2, 3)), np.zeros((2, 3))
    turns = np.zeros((2, 4))
    turns[:, 0] = 1.0
    slid, slid_below = np.zeros((len(feet), 2)), np.zeros((len(corners), 2))
    inverse = np.empty((2, 3, 3))
    for body in range(2):
        inverse[body] = np.linalg.inv(inertias[body])
    out, upright = np.zeros((len(pulls) // every, 5)), np.eye(3)
    for k in range(len(pulls)):
        axes, own = _turn(turns[0]), _turn(turns[1])
        rates = np.stack((axes @ (inverse[0] @ (axes.T @ spin[0])), own @ (inverse[1] @ (own.T @ spin[1]))))
        if k % every == 0:
            yaws = math.atan2(axes[1, 0], axes[0, 0]), math.atan2(own[1, 0], own[0, 0])
            out[k // every] = np.array([math.atan2(axes[0, 2], axes[2, 2]), at[1, 0], at[1, 1], yaws[0], yaws[1]])
        force, moment = np.stack((masses[0] * pulls[k], masses[1] * pulls[k])), np.zeros((2, 3))
        for j in range(len(feet)):
            arm = axes @ feet[j]
            below = at[0] + arm - at[1]
            apart = velocity[0] + np.cross(rates[0], arm) - velocity[1] - np.cross(rates[1], below)
            push = _push((own.T @ below)[2] - half_m, apart, own, slid[j], laws[0], step_s)
            force[0] += push
            force[1] -= push
            moment[0] += np.cross(arm, push)
            moment[1] -= np.cross(below, push)
        for j in range(len(corners)):
            arm = own @ corners[j]
            moves = velocity[1] + np.cross(rates[1], arm)
            push = _push(at[1, 2] + arm[2], moves, upright, slid_below[j], laws[1], step_s)
            force[1] += push
            moment[1] += np.cross(arm, push)
        spin += step_s * moment
        for body in range(2):
            velocity[body] += step_s * force[body] / masses[body]
            at[body] += step_s * velocity[body]
            now = axes if body == 0 else own
            x, y, z = now @ (inverse[body] @ (now.T @ spin[body]))
            w, a, b, c = turns[body]
            rate = np.array(
                [-x * a - y * b - z * c, x * w + y * c - z * b, y * w + z * a - x * c, z * w + x * b - y * a]
            )
            turn = turns[body] + 0.5 * step_s * rate
            turns[body] = turn / math.sqrt(np.dot(turn, turn))
    return out


def springs(scene: Scene, until_s: float, sinks: float = SINKS) -> Array:
    """The samples (n, 5) of `_springs` every `SAMPLE_S`; `sinks`: what springs give under the statue, over its height."""
    statue, pedestal = scene.statue, scene.pedestal
    if pedestal is None:
        raise ValueError("a pedestal is wanted")
    height_m, gravity = statue.centroid_height_m, scene.gravity_m_s2
    stiff = statue.mass_kg * gravity / (sinks * height_m)
    vertices = len(statue.footprint_m)
    damped = 2.0 * DAMPING * math.sqrt(stiff * statue.mass_kg / (2.0 * vertices))
    lightest = min(statue.mass_kg, pedestal.mass_kg) / (vertices + 4.0)
    every = math.ceil(SAMPLE_S / (STEP_SHARE * math.sqrt(lightest / stiff)))
    step_s = SAMPLE_S / every
    times = step_s * np.arange(round(until_s / SAMPLE_S) * every)
    base = scene.base_excitation
    pulls = -np.stack([base.x.accel_m_s2(times), base.y.accel_m_s2(times), np.full(times.size, gravity)], axis=1)
    half = np.array([pedestal.width_m, pedestal.depth_m, pedestal.height_m]) / 2.0
    own = pedestal.mass_kg / 3.0 * np.diag(np.sum(half**2) - half**2)
    signs = np.array([[a, b, -1.0] for a in (1.0, -1.0) for b in (1.0, -1.0)])
    places = np.array([[0.0, 0.0, 2.0 * half[2] + height_m], [statue.base_centre_m + pedestal.offset_m, 0.0, half[2]]])
    laws = np.array([[stiff, damped, scene.contact.statue], [stiff, damped, scene.contact.floor_kinetic]])
    found: Array = _springs(
        np.array([statue.mass_kg, pedestal.mass_kg]), np.stack([statue.inertia_tensor_kg_m2, own]),
        statue.footprint_m - [0.0, 0.0, height_m], signs * half, places, half[2], pulls, laws, step_s, every,
    )  # fmt: skip
    return found - [0.0, places[1, 0], 0.0, 0.0, 0.0]


def row_of(seed: int) -> PedestalRow:
    """One scene by pybullet to its target and by springs of two stiffnesses, of which the limit is taken."""
    scene = pedestal_scene(seed)
    run = simulate(scene, "pybullet")
    history = run.history
    if history is None or run.numerical_uncertainty_rad is None or run.slip_uncertainty_m is None:
        return PedestalRow(seed)
    until_s = min(LONGEST_S, run.bounded_until_s, *(time_s - BEFORE_IMPACT_S for time_s in run.impact_times_s[:1]))
    if until_s < 10.0 * SAMPLE_S:
        return PedestalRow(seed)
    soft, stiff = (springs(scene, until_s, share * SINKS) for share in (1.0, 0.25))
    truth, open_ = 2.0 * stiff - soft, np.max(np.abs(stiff - soft), axis=0)
    n = len(truth)
    theta, slip, across = history.theta_rad[:n], history.slip_m[:n], history.extra["pedestal_y_m"][:n]
    told = np.max(np.abs(np.stack([theta, slip, across], axis=1) - truth[:, :3]), axis=0)
    peaks = np.max(np.abs(truth), axis=0)
    return PedestalRow(
        seed, until_s, peaks[0], told[0], run.numerical_uncertainty_rad, open_[0], peaks[1], told[1], run.slip_uncertainty_m,
        open_[1], peaks[2], told[2], float(truth[-1, 4]), float(history.extra["pedestal_yaw_rad"][n - 1]),
    )  # fmt: skip


def tables(rows: Sequence[PedestalRow]) -> str:
    """How often what pybullet states holds, and how far it is off, of statues that rock and of those that only slide."""
    lines = []
    for rocks, what in ((True, "rocks"), (False, "only slides")):
        mine = [row for row in rows if row.until_s > 0.0 and (row.peak_rad > ROCKS_RAD) is rocks]
        turned, slid = (sum(row.held[k] for row in mine) for k in range(2))
        medians = np.median([(row.error_rad, row.error_m, row.across_error_m) for row in mine], axis=0)
        held = [f"{count} ({100.0 * count / len(mine):.3g} %)" for count in (turned, slid)]
        lines.append([what, str(len(mine)), *held, *(f"{median:.1e}" for median in medians)])
    heads = ["the statue", "scenes", "rotation held", "slip held", "median error, rad", "of slip, m", "across, m"]
    yaws = [row for row in rows if abs(row.yaw_rad) > ROCKS_RAD]
    ratios = np.quantile([row.pedestal_yaw_rad / row.yaw_rad for row in yaws], [0.1, 0.5, 0.9])
    said = ", ".join(f"{ratio:.2f}" for ratio in ratios)
    told = f"Of {len(yaws)} pedestals that yaw by over {ROCKS_RAD:g} rad pybullet's is {said} times the springs' (10, 50, 90 %)."
    return f"{table(heads, lines)}\n\n{told}"


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure, print the table and write it into the page."""
    given = command_line(MODULE, __doc__, SCENES, FIRST_SEED).parse_args(arguments)
    seeds = seeds_of(given)
    rows = measured(given.out, PedestalRow, [(seed,) for seed in seeds], row_of)
    renew("measured/pedestal_space.md", MODULE, f"Seeds {seeds[0]} to {seeds[-1]}, target 1e-3 rad.\n\n{tables(rows)}")


if __name__ == "__main__":
    main()
