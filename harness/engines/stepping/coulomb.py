"""Whether the floor's friction kept Coulomb's law: from the balance of momentum of both bodies, hence as it acted.

What the loop believes of friction is not asked. Sliding, friction is μ_k N; else it is at most μ_s N; the step in which the
pedestal breaks loose acts with what lies between. A limit that is wrong in the loop, or a release in which the static coefficient
goes on acting, shows here however small its effect on the motion.
"""

import math
from collections.abc import Mapping
from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.engines.base import LayerFault
from harness.engines.stepping.columns import Trajectory
from harness.engines.stepping.support import Impulses
from harness.model import Array, Contact, Intervention, Scene

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

Pair = tuple[float, float]

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
    step_s = float(np.median(np.diff(motion.t_s)))
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
