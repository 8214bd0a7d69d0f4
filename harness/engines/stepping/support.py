"""Where the statue stands on its support: slip, gap and penetration of its corners, the wall; and what the contacts carry."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.engines.base import LayerFault
from harness.engines.stepping.trajectory import Pair, Trajectory
from harness.model import Array, Contact, Intervention, Pedestal, Scene

# Where the contact is the one that events are located for: a statue that turns about a corner at rest on an upright pedestal.
# Elsewhere steps are those of any loop, and errors fall at first order: of events inside them only a foot that comes down while
# the statue slides is met at its instant.


LEFT_M: Final = 1e-4
"""Slip of the statue on its support, or gap under it, that counts: without either, steps of 4 ms leave some 1e-5 m."""
LEFT_RAD: Final = 2e-4
"""Tilt of the pedestal that counts; events are located up to less than this (`EventSettings.tipped_rad`)."""
SLIDES_M_S: Final = 1e-3
"""Slower than this the statue's slip goes on as a solver's remainder does: less than 1e-5 m/s at rest."""


def plain_spells(
    motion: Trajectory, slip_m: Array, gap_m: Array, at: Corners, pedestal: Pedestal | None
) -> dict[str, object]:
    """`plain_from_s`, the first instant at which the steps were plain (None: never), `plain_for_s`, for how long altogether, and
    `plain_because`, the reasons in the order in which they came.

    `slip_m`, `gap_m`: slip of the statue on its support and gap under it, shape (n,).
    """
    t_s = motion.t_s
    lengths = np.diff(t_s, prepend=t_s[0])
    lifted = gap_m > LEFT_M
    # By reason: since when it counts, and while it does.
    causes = {
        "statue_slides": statue_slides(t_s, slip_m),
        "contact_lost": (lifted, lifted),
    }
    if pedestal is not None and motion.pedestal_xz_m is not None:
        tips = np.abs(motion.tilt_rad) > LEFT_RAD
        place = np.where(at.lean_rad >= 0.0, at.right_x, at.left_x)
        beside = np.abs(place) > 0.5 * pedestal.width_m + LEFT_M
        causes |= {"pedestal_tips": (tips, tips), "beyond_edge": (beside, beside)}
    first = {name: float(t_s[since.argmax()]) for name, (since, _) in causes.items() if since.any()}
    plain = np.any([while_it for _, while_it in causes.values()], axis=0)
    return {
        "plain_from_s": min(first.values(), default=None),
        "plain_for_s": float(lengths[plain].sum()),
        "plain_because": sorted(first, key=lambda name: first[name]),
    }


def moves(t_s: Array, place_m: Array) -> NDArray[np.bool_]:
    """Whether a place moves by more than solver iterations leave in one that stands, shape (n,)."""
    return np.asarray(np.abs(np.diff(place_m, prepend=place_m[0])) > SLIDES_M_S * np.diff(t_s, prepend=t_s[0]))


def statue_slides(t_s: Array, slip_m: Array) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Since when a slip of the statue on its support counts, and while it goes on, shape (n,)."""
    slides = moves(t_s, slip_m)
    slid = np.abs(slip_m) > LEFT_M
    if slid.any():
        # The slip that passes the limit began a little before.
        passed = int(slid.argmax())
        slid[np.flatnonzero(~slides[:passed]).max(initial=-1) + 1 : passed] = True
    return slid, slid & slides


CORNERS_ONLY_RAD: Final = 0.3
"""Below this lean a statue on a flat base is taken to touch with its corners only; above it every point is asked."""
TOUCHES_M: Final = 1e-6
"""A body that its engine stops at a wall stands off by no more: solvers leave a share of what they correct."""
FLAT_M: Final = 1e-9
"""Vertices within this height of the lowest touch at first: more is no rounding of a mesh."""


@dataclass(frozen=True, eq=False)
class Corners:
    """Places of both corners of the base on the support, m, shape (n,): along it and above it, from the middle of the pedestal's
    top, without one from the table's origin; `lean_rad` is the statue's rotation on the support.
    """

    right_x: Array
    right_z: Array
    left_x: Array
    left_z: Array
    lean_rad: Array
    centroid_x: Array
    centroid_z: Array


def corners(scene: Scene, trajectory: Trajectory) -> Corners:
    """Where both corners of the base are at each sample, for a planar pose; on a pedestal that tips along its top."""
    statue = scene.statue
    right, left, z = statue.corner_right_m, -statue.corner_left_m, -statue.centroid_height_m
    place_x, place_z = trajectory.statue_xz_m[:, 0], trajectory.statue_xz_m[:, 1]
    lean_rad = trajectory.theta_rad
    if scene.pedestal is not None and trajectory.pedestal_xz_m is not None:
        tilt_cos, tilt_sin = np.cos(trajectory.tilt_rad), np.sin(trajectory.tilt_rad)
        x, up = place_x - trajectory.pedestal_xz_m[:, 0], place_z - trajectory.pedestal_xz_m[:, 1]
        place_x, place_z = x * tilt_cos - up * tilt_sin, x * tilt_sin + up * tilt_cos - scene.pedestal.centroid_height_m
        lean_rad = lean_rad - trajectory.tilt_rad
    cos, sin = np.cos(lean_rad), np.sin(lean_rad)
    # θ turns clockwise: x' = x cos θ + z sin θ, z' = z cos θ − x sin θ.
    z_sin, z_cos = z * sin, z * cos
    return Corners(
        place_x + (right * cos + z_sin),
        place_z + (z_cos - right * sin),
        place_x + (left * cos + z_sin),
        place_z + (z_cos - left * sin),
        lean_rad,
        place_x,
        place_z,
    )


def statue_slip_m(scene: Scene, at: Corners) -> Array:
    """Displacement of the standing corner along the support since t = 0, shape (n,): the model assumes none."""
    base = scene.statue.corner_left_m + scene.statue.corner_right_m
    # Upright the corners are a base apart; the standing one tells where the base is.
    place = np.where(at.lean_rad >= 0.0, at.right_x, at.left_x + base)
    return np.asarray(place - place[0])


def gap_m(scene: Scene, at: Corners, within_m: float = math.inf) -> Array:
    """Height of the lowest point above the support, shape (n,), of those within so much of its middle; negative: penetration.

    Near upright on a flat base the lowest point is a corner; leaning further, or on an uneven base, any point of the silhouette.
    """

    def over(along_m: Array, height_m: Array) -> Array:
        return np.where(np.abs(along_m) <= within_m, height_m, np.inf)

    lowest = np.minimum(over(at.right_x, at.right_z), over(at.left_x, at.left_z))
    far = np.abs(at.lean_rad) > CORNERS_ONLY_RAD if flat_base(scene) else np.ones(lowest.size, dtype=bool)
    if far.any():
        cos, sin = np.cos(at.lean_rad[far]), np.sin(at.lean_rad[far])
        least = np.full(cos.size, np.inf)
        for x, z in scene.statue.section_m - np.array([0.0, scene.statue.centroid_height_m]):
            along, height = at.centroid_x[far] + x * cos + z * sin, at.centroid_z[far] + (z * cos - x * sin)
            least = np.minimum(least, over(along, height))
        lowest[far] = least
    return lowest


def flat_base(scene: Scene) -> bool:
    """Whether the silhouette has both corners at z = 0 and nothing below."""
    statue = scene.statue
    corners = np.array([[-statue.corner_left_m, 0.0], [statue.corner_right_m, 0.0]])
    apart = np.abs(statue.section_m[:, None, :] - corners[None, :, :]).sum(axis=2)
    return bool(np.all(apart.min(axis=0) <= FLAT_M) and np.min(statue.section_m[:, 1]) >= -FLAT_M)


def wall_touch(scene: Scene, trajectory: Trajectory) -> tuple[int, float] | None:
    """The sample at which the statue's silhouette or the pedestal's side has reached the wall, and when it did; None if neither
    does or there is no wall.

    The time is that at which what is left at the sample before would close at the speed with which it came: an engine's own wall
    stops a body inside the step in which it arrives.
    """
    if scene.wall is None:
        return None
    statue, sign = scene.statue, scene.wall.sign
    cos, sin = np.cos(trajectory.theta_rad), np.sin(trajectory.theta_rad)
    furthest = np.full(trajectory.t_s.size, -np.inf)
    for x, z in statue.section_m:
        along = x * cos + (z - statue.centroid_height_m) * sin
        furthest = np.maximum(furthest, sign * (trajectory.statue_xz_m[:, 0] + along))
    if scene.pedestal is not None and trajectory.pedestal_xz_m is not None:
        half, _, half_height = scene.pedestal.half_m
        tilt = trajectory.tilt_rad
        side = half * np.cos(tilt) + half_height * np.abs(np.sin(tilt))
        furthest = np.maximum(furthest, sign * trajectory.pedestal_xz_m[:, 0] + side)
    gap = statue.corner_m(sign) + scene.wall.distance_m - furthest
    touching = np.flatnonzero(gap <= TOUCHES_M)
    if not touching.size:
        return None
    t_s, k = trajectory.t_s, int(touching[0])
    if k < 2:
        return k, float(t_s[k])
    speed = (gap[k - 2] - gap[k - 1]) / (t_s[k - 1] - t_s[k - 2])
    return k, float(min(t_s[k - 1] + gap[k - 1] / speed, t_s[k]) if speed > 0.0 else t_s[k])


# Forces and energy of a trajectory, from the balance of momentum of each body in each step.
#
# An engine that adds impulses to velocities obeys Δv = g Δt + impulse/m exactly, so these are the engine's own contact impulses,
# read without asking it.

WINDOW: Final = 8
"""Steps over which impulses are summed before a ratio is formed: a solver's noise from step to step is not a force."""
LEAST_SHARE: Final = 0.02
"""A normal impulse below this share of the weight's is no contact to form a ratio with."""


@dataclass(frozen=True, eq=False)
class Impulses:
    """Cumulative impulses, N s, shape (n,), on the statue at its base and on the whole at the floor."""

    statue_x: Array
    statue_z: Array
    floor_x: Array
    floor_z: Array


def impulses(scene: Scene, trajectory: Trajectory) -> Impulses:
    """Cumulative contact impulses of a trajectory; without a pedestal both are the same."""
    t_s, rate = trajectory.t_s, trajectory.statue_rate_m_s
    gravity = trajectory.gravity_xz_m_s2 * (t_s[1:] - t_s[:-1])[:, None]
    statue = scene.statue.mass_kg * (rate[1:] - rate[:-1] - gravity)
    held = _summed(statue)
    rate_below = trajectory.pedestal_rate_m_s
    if scene.pedestal is None or rate_below is None:
        return Impulses(*held, *held)
    return Impulses(*held, *_summed(statue + scene.pedestal.mass_kg * (rate_below[1:] - rate_below[:-1] - gravity)))


def _summed(parts: Array) -> tuple[Array, Array]:
    total = np.zeros((2, parts.shape[0] + 1))
    np.cumsum(parts.T, axis=1, out=total[:, 1:])
    return total[0], total[1]


def mean_forces(t_s: Array, impulses_n_s: Sequence[Array], grid_s: Array) -> Array:
    """Mean force, N, for each row of impulses over the interval before each time of the grid (the first repeats the second)."""
    force: Array = np.zeros((len(impulses_n_s), grid_s.size))
    if grid_s.size > 1:
        for row, impulse in zip(force, impulses_n_s, strict=True):
            row[:] = np.interp(grid_s, t_s, impulse)
        force[:, 1:] -= force[:, :-1].copy()
        force[:, 1:] /= grid_s[1:] - grid_s[:-1]
        force[:, 0] = force[:, 1]
    return force


def force_limits(scene: Scene, trajectory: Trajectory, impulses: Impulses) -> dict[str, float]:
    """Greatest friction ratio needed at the statue's base, least normal forces there and at the floor."""
    width = min(WINDOW, trajectory.t_s.size - 1)
    if width < 1:
        return {}
    span = trajectory.t_s[width:] - trajectory.t_s[:-width]
    normal = (impulses.statue_z[width:] - impulses.statue_z[:-width]) / span
    shear = (impulses.statue_x[width:] - impulses.statue_x[:-width]) / span
    floor = (impulses.floor_z[width:] - impulses.floor_z[:-width]) / span
    if scene.pedestal is not None:
        # Along and across its top, where that is tilted.
        tilt = 0.5 * (trajectory.tilt_rad[width:] + trajectory.tilt_rad[:-width])
        cos, sin = np.cos(tilt), np.sin(tilt)
        shear, normal = shear * cos - normal * sin, shear * sin + normal * cos
    held = normal > LEAST_SHARE * scene.statue.mass_kg * scene.gravity_m_s2
    needed = float((np.abs(shear[held]) / normal[held]).max()) if held.any() else 0.0
    return {
        "statue_friction_needed": needed,
        "statue_normal_least_n": float(normal.min()),
        "floor_normal_least_n": float(floor.min()),
    }


def pedestal_inertia_kg_m2(pedestal: Pedestal) -> float:
    """Moment of inertia about its centroid, for a rotation in the rocking plane."""
    w, _, h = pedestal.half_m
    return pedestal.mass_kg * (w * w + h * h) / 3.0


def energy_j(scene: Scene, trajectory: Trajectory) -> Array:
    """Mechanical energy in the table's frame, J, shape (n,): kinetic and potential in gravity, zero as at rest upright."""
    statue, gravity = scene.statue, scene.gravity_m_s2
    rise = trajectory.statue_xz_m[:, 1] - trajectory.statue_xz_m[0, 1]
    total = 0.5 * statue.mass_kg * np.sum(trajectory.statue_rate_m_s**2, axis=1)
    total += 0.5 * statue.inertia_kg_m2 * trajectory.theta_rate_rad_s**2 + statue.mass_kg * gravity * rise
    if scene.pedestal is not None and trajectory.pedestal_xz_m is not None and trajectory.pedestal_rate_m_s is not None:
        lifted = trajectory.pedestal_xz_m[:, 1] - trajectory.pedestal_xz_m[0, 1]
        total += scene.pedestal.mass_kg * (0.5 * np.sum(trajectory.pedestal_rate_m_s**2, axis=1) + gravity * lifted)
        if trajectory.pedestal_spin_rad_s is not None:
            total += 0.5 * pedestal_inertia_kg_m2(scene.pedestal) * trajectory.pedestal_spin_rad_s**2
    return np.asarray(total)


def energy_lost_j(scene: Scene, trajectory: Trajectory, energy: Array) -> Array:
    """What the table's motion put in so far less the energy (`energy_j`), J, shape (n,): contacts may only make it grow."""
    given = np.zeros(trajectory.t_s.size)
    extra = trajectory.gravity_xz_m_s2 + np.array([0.0, scene.gravity_m_s2])
    step = trajectory.t_s[1:] - trajectory.t_s[:-1]
    bodies = [(scene.statue.mass_kg, trajectory.statue_rate_m_s)]
    if scene.pedestal is not None and trajectory.pedestal_rate_m_s is not None:
        bodies.append((scene.pedestal.mass_kg, trajectory.pedestal_rate_m_s))
    for mass, rate in bodies:
        # The work of a force that is constant in a step is exact with the mean of the velocities at its ends.
        power = mass * np.sum(extra * 0.5 * (rate[1:] + rate[:-1]), axis=1)
        given[1:] += np.cumsum(power * step)
    return np.asarray(given - energy)


def lost_in_impacts_j(t_s: Array, lost_j: Array, impact_times_s: Sequence[float]) -> float:
    """What is lost, J, in the steps around the impacts: one before each to two after, as a solver's contact settles in two."""
    after = np.searchsorted(t_s, np.array(impact_times_s))
    last = t_s.size - 1
    return float(np.sum(lost_j[np.minimum(after + 2, last)] - lost_j[np.clip(after - 1, 0, last)]))


# Two coefficients of friction in an engine that knows one.
#
# The rule, for each step: if the pedestal is stuck when the step begins, the step is computed with the static coefficient; if
# the floor's friction impulse then stands at its limit, the static limit was passed inside the step, and the step is computed
# again from its beginning with the kinetic coefficient (docs/model.md, sections 2 and 3: sticking holds while |F| ≤ μ_s N, else
# F = −μ_k N, in motion and in an impact alike). A step that begins sliding is computed with the kinetic coefficient; when the
# velocity comes to rest or changes sign in it, the next one begins stuck. Without the repetition the first sliding step, or an
# impact that breaks the pedestal loose, acts with μ_s: at an impact that is an error of (μ_s − μ_k) P_n that no step size
# cures. Judging by the velocity instead of the impulse is late by a time that falls only with the root of the step: the
# velocity has first to grow above what the solver leaves in a pedestal that is stuck.

STUCK_SHARE: Final = 0.02
"""A velocity below this share of what kinetic friction takes away in one step is rest: solvers leave a little."""


def stuck_below_m_s(scene: Scene, dt_s: float) -> float:
    """Velocity of the pedestal on the floor that counts as rest, in steps of `dt_s`."""
    # In one step kinetic friction takes μ_k g Δt from a velocity: what a solver leaves is in proportion to it.
    return STUCK_SHARE * scene.contact.floor_kinetic * scene.gravity_m_s2 * dt_s


def followed(contact: Contact, rest_m_s: float, before_m_s: Pair, now_m_s: Pair) -> float:
    """The plainest rule for two numbers in an engine that knows one: kinetic once the pedestal slid the same way at the ends of
    two steps in a row, `before_m_s` and `now_m_s`, faster than what counts as rest, else static.

    It is asked after a step and holds for the next. No step is repeated, so the two steps in which the pedestal breaks loose act
    with the static coefficient: at an impact an error of (μ_s − μ_k) P_n that no step size cures (see above).
    """
    (u, v), (x, y) = before_m_s, now_m_s
    # One step's speed is not enough, where more than kinetic friction is needed to hold the pedestal: one that turned back was at
    # rest inside the step, and one that is let go because an engine lost the statue's contact for a step would be held again. By
    # that speed alone both slide on, at a chance that no step size cures (0.02 rad in a scene of the paper, pymunk at 0.25 ms).
    slides = u * x + v * y > 0.0 and min(math.hypot(u, v), math.hypot(x, y)) > rest_m_s
    return contact.floor_kinetic if slides else contact.floor_static


# Whether the floor's friction kept Coulomb's law: from the balance of momentum of both bodies, hence as it acted.
#
# What the loop believes of friction is not asked. Sliding, friction is μ_k N; else it is at most μ_s N; the step in which the
# pedestal breaks loose acts with what lies between. A limit that is wrong in the loop, or a release in which the static
# coefficient goes on acting, shows here however small its effect on the motion.


SLIDES: Final = 10.0
"""A velocity above so many times the one that counts as rest is sliding: what a solver leaves is below a tenth of it."""
MOST_OVER: Final = 0.04
"""Share by which friction may exceed its limit, over all steps of a state: 0.024 at most in 650 runs at 4 to 0.25 ms."""
COARSE_S: Final = 4e-3
"""Longer steps are allowed more in proportion, as what corrections at events leave grows with them."""
LEAST_STEPS: Final = 8
"""Fewer sliding steps are no sliding to judge: corrections at an impact among them would count for too much."""
MOST_READ_G: Final = 2.0
"""Peak of the table's acceleration, g, up to which a step's friction is read: at 5 g, 10 Hz and 4 ms 0.07 of it is not."""
HARD: Final = 2.0
"""A normal force above so many weights is an impact's, and"""
BESIDE: Final = 2
"""so many steps beside it do not tell forces: velocities of the middles of steps are taken over to their ends."""
SMOOTH: Final = 1e-2
"""A coefficient below this is held to as much, of none at all no share can be taken, and one below"""
SMOOTH_PER_S: Final = 25.0
"""so much times the step: what one of 4 ms leaves unread comes to 3e-3 of the normal force in a statue that falls fast over a
pedestal that slides."""
AT_LIMIT: Final = 1e-3
"""A release acted with the static coefficient when its friction is so near to it, as a share of μ_s − μ_k."""
AS_STATIC: Final = 3
"""So many releases with the static coefficient, and none without, are no chance: where in its step it comes is anywhere."""
SLIP_ONSET: Final = "friction_release"
"""Kind of what is written where static friction gives way: steps that are solved again."""


def friction_is_known(scene: Scene, motion: Trajectory) -> bool:
    """Whether the balance of momentum in the plane tells the floor's friction: on a pedestal that moves in the plane alone.

    Where a ratio is prescribed at impacts, velocities are written there by the harness; a wall pushes along the floor too; and of
    what a stronger table gives in a step, the part that is not read at its instant is as large as friction.
    """
    readable = scene.base_excitation.x.peak_m_s2 <= MOST_READ_G * scene.gravity_m_s2
    flat = scene.planar or "yaw_rad" not in motion.extra
    alone = scene.contact.restitution is None and scene.wall is None
    return scene.pedestal is not None and alone and flat and readable


def check_friction(
    scene: Scene,
    motion: Trajectory,
    impulses: Impulses,
    plain_from_s: float,
    still_m_s: float,
    interventions: Mapping[str, Intervention] | None,
) -> None:
    """Raise `LayerFault` where the floor's friction was not Coulomb's until its contact is another one, if ever, or a release was
    not solved again (without an account: not asked); `still_m_s` counts as rest.
    """
    contact = scene.contact
    static, kinetic = contact.floor_static, contact.floor_kinetic
    normal = np.diff(impulses.floor_z)
    mass_kg = scene.statue.mass_kg + (0.0 if scene.pedestal is None else scene.pedestal.mass_kg)
    acting = np.diff(impulses.floor_x) - mass_kg * _rounded_off_m_s(motion)
    friction = np.maximum(np.abs(acting) - _unread_n_s(scene, motion), 0.0)
    before, after = np.abs(motion.slip_rate_m_s[:-1]), np.abs(motion.slip_rate_m_s[1:])
    weight = mass_kg * scene.gravity_m_s2
    hard = _beside(normal > HARD * weight * np.diff(motion.t_s))
    counted = (motion.t_s[1:] < plain_from_s) & (normal > 0.0)
    one_way = motion.slip_rate_m_s[:-1] * motion.slip_rate_m_s[1:] > 0.0
    sliding = counted & ~hard & ~_beside(~one_way) & (np.minimum(before, after) > SLIDES * still_m_s)
    # As it comes to rest a step's force is read from velocities of which one is of its sliding.
    settled = np.maximum(before, np.concatenate([[0.0], before[:-1]])) <= still_m_s
    held = counted & ~hard & settled & (after <= still_m_s)
    told = motion.t_s[motion.t_s <= plain_from_s]
    step_s = float(np.median(np.diff(told if told.size > 1 else motion.t_s)))
    most, smooth = MOST_OVER * max(1.0, step_s / COARSE_S), max(SMOOTH, SMOOTH_PER_S * step_s)
    for name, coefficient, which in (("sliding", kinetic, sliding), ("held", static, held)):
        over = _over(friction, coefficient, normal, which, smooth)
        if over > most:
            raise LayerFault(f"friction_{name}", over_its_limit=over)
    if interventions is None or static == kinetic:
        return
    loose = counted & (before <= still_m_s) & (after > still_m_s)
    # Less than μ_k N: what moved the pedestal by more than counts as rest was a solver's remainder, or a part of the step.
    released = loose & (friction > (kinetic - 0.5 * (static - kinetic)) * normal)
    least = static - AT_LIMIT * (static - kinetic)
    releases, as_static = int(released.sum()), int((released & (friction >= least * normal)).sum())
    if contact.at_impact > kinetic:
        # What an impact breaks loose acts as the scene says.
        as_static = 0
    again = interventions[SLIP_ONSET].steps_again if SLIP_ONSET in interventions else 0
    # What never slid has not broken loose: a solver's remainder of some 1e-6 m looks like it (seen on 1 of 77 random scenes).
    if (sliding.any() and again < releases) or as_static == releases >= AS_STATIC:
        raise LayerFault("release_not_kinetic", releases=releases, as_static=as_static, steps_solved_again=again)


def _rounded_off_m_s(motion: Trajectory) -> Array:
    """What a step's change of velocity is read too large by, m/s, as the table's acceleration a curves: a″ dt³/8.

    Velocities at whole steps are the means of those half a step before and after, so that the change between two of them holds
    the mean of a over two steps and not over one. Of a light friction under a strong, quick motion this is a tenth.
    """
    pull = motion.gravity_xz_m_s2[:, 0]
    curved = np.zeros_like(pull)
    curved[1:-1] = pull[2:] - 2.0 * pull[1:-1] + pull[:-2]
    return np.asarray(0.125 * curved * np.diff(motion.t_s))


def _unread_n_s(scene: Scene, motion: Trajectory) -> Array:
    """Impulse that a step's friction may lack as it is read, N s: a velocity that is solved at the step's beginning lacks half a
    step of ω² R, and what friction does to it is told by how that changes.
    """
    statue, step_s = scene.statue, np.diff(motion.t_s)
    arm_m = max(math.hypot(statue.corner_m(side), statue.centroid_height_m) for side in (-1, 1))
    spin = np.abs(motion.theta_rate_rad_s[:-1])
    gained = np.abs(np.diff(motion.theta_rate_rad_s))
    return np.asarray(statue.mass_kg * arm_m * step_s * spin * (gained + 0.5 * spin * spin * step_s))


def _beside(steps: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """These steps (n,) and `BESIDE` on either side of each."""
    return np.asarray(np.convolve(steps, np.ones(2 * BESIDE + 1))[BESIDE:-BESIDE] > 0.0)


def _over(friction: Array, coefficient: float, normal: Array, which: NDArray[np.bool_], smooth: float) -> float:
    """Share by which friction exceeds its limit over the steps in question, 0 for too few of them; a coefficient below `smooth`
    is held to that.
    """
    if which.sum() < LEAST_STEPS:
        return 0.0
    excess = np.maximum(friction[which] - coefficient * normal[which], 0.0).sum()
    return float(excess / (max(coefficient, smooth) * normal[which].sum()))
