"""The push of a motion, and what a scene in which nothing moves can be told: how far its motion is from moving it, and from
which size on it does.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Final, Literal, get_args

import numpy as np

from analytic.excitation import Excitation, ZeroExcitation
from harness.input.motions.spec import LARGEST_G, LARGEST_SCALE
from harness.model import Array, Finding, Outcome, Pedestal, Run, Scene, Statue, caution, changes_answer, written
from meshes.footprint import footprint, margin_m, outward_sides

# What the floor's motion asks of a statue at rest: its strongest push, and how near that comes to moving the statue.

SAMPLES: Final = 40_001
"""Instants at which a motion is looked at first of which it is not known where it is straight."""
CLOSER: Final = 401
"""Instants between the neighbours of the strongest of them: its crest is found within 1e-8 of its size."""
CREST: Final = 1e-3
"""A formula's crest lies between the instants looked at: a value this near to its own peak is that peak."""
FACTOR_ROUNDING: Final = 1e-7
"""A factor is told to four digits; it is found to a thousandth of the last."""
Cause = Literal["statue_tips", "pedestal_slides", "statue_slides", "pedestal_tips"]
"""What can begin to move, and how; of like limits the first: a pedestal that slides hands on no more than its own friction."""


@dataclass(frozen=True)
class Push:
    """The strongest level push of a motion as a share of the weight, and by cause its largest share of what begins that motion.

    A share is one where the statue just begins to move so, infinite where it holds nothing. A floor that drops lightens the
    statue at that instant, one that rises makes it heavier (docs/model.md, section 2: g + a_z).
    """

    peak: float
    shares: Mapping[Cause, float]

    @property
    def first(self) -> tuple[Cause, float]:
        """The cause that gives way first under this motion, and its share."""
        return max(self.shares.items(), key=lambda each: each[1])


def push_of(scene: Scene, x_factor: float = 1.0) -> Push:
    """The push of a scene's motion within its duration, that along x made larger by a factor."""
    parts = scene.base_excitation.parts
    t_s = instants_s(parts, scene.duration_s)
    causes: tuple[Cause, ...] = get_args(Cause)
    shares = {each: 0.0 for each in causes if scene.pedestal is not None or not each.startswith("pedestal")}
    peak = 0.0
    for _ in range(2):
        # What pushes each kilogram: against the floor's horizontal acceleration.
        level = -np.column_stack([x_factor * parts[0].accel_m_s2(t_s), parts[1].accel_m_s2(t_s)])
        weight = scene.gravity_m_s2 + parts[2].accel_m_s2(t_s)
        sizes = {name: _shares(over, weight) for name, over in _needed(scene, level).items()}
        peak = max(peak, float(np.hypot(*level.T).max()) / scene.gravity_m_s2)
        shares = {name: max(share, float(sizes[name].max())) for name, share in shares.items()}
        crests = {int(np.argmax(size)) for size in (np.hypot(*level.T), *sizes.values())}
        t_s = np.concatenate([np.linspace(t_s[max(k - 1, 0)], t_s[min(k + 1, len(t_s) - 1)], CLOSER) for k in crests])
    return Push(peak, shares)


def instants_s(parts: tuple[Excitation, ...], duration_s: float) -> Array:
    """Instants (n,) between which formulas and records are nearly straight, both sides of every jump."""
    times = [np.array([0.0, duration_s])]
    for item in parts:
        straight_s = item.straight_s(duration_s)
        times.append(np.linspace(0.0, duration_s, SAMPLES) if straight_s is None else straight_s)
    joined, _ = np.unique(
        np.concatenate(times), return_index=True
    )  # without, NumPy loads its masked arrays: 15 ms of a start
    return joined[(joined >= 0.0) & (joined <= duration_s)]


def peak_within_m_s2(item: Excitation, duration_s: float) -> float:
    """The largest acceleration that a motion reaches within the duration."""
    largest = float(np.abs(item.accel_m_s2(instants_s((item,), duration_s))).max())
    return item.peak_m_s2 if largest > (1.0 - CREST) * item.peak_m_s2 else largest


LEVEL_M: Final = 1e-9
"""Feet within this height of each other are level: what is left is rounding."""


def resting_polygon_m(statue: Statue, level_m: float = LEVEL_M) -> Array | None:
    """The polygon (k, 2), counter-clockwise, of the lowest vertices, which the statue rests on; None where it tilts off it."""
    from meshes import MeshError

    polygon = statue.feet_m
    if statue.solid is not None or np.ptp(polygon[:, 2]) > level_m:
        try:
            polygon = footprint(polygon, level_m)
        except MeshError:  # fewer than three vertices, or all on a line
            return None
    return polygon[:, :2] if margin_m(polygon) > 0.0 else None


def rests_on_m(statue: Statue) -> Array:
    """The polygon (k, 2 or 3) off which a push lifts the statue: of its lowest vertices and of those that a rotation which does
    not count brings down, else of all that touch.
    """
    polygon = resting_polygon_m(statue, SETTLES_RAD * float(np.ptp(statue.footprint_m[:, :2], axis=0).max()))
    return statue.footprint_m if polygon is None else polygon


def _needed(scene: Scene, level_m_s2: Array) -> dict[Cause, Array]:
    """By cause the weight on each kilogram (n,) below which the statue moves so under these pushes."""
    statue, contact = scene.statue, scene.contact
    normals, reach = outward_sides(rests_on_m(statue))
    size = np.hypot(*level_m_s2.T)
    with np.errstate(divide="ignore", invalid="ignore"):
        needed: dict[Cause, Array] = {
            "statue_tips": (level_m_s2 @ (normals / reach[:, None]).T).max(axis=1) * statue.centroid_height_m,
            "statue_slides": size / contact.statue,
        }
        if scene.pedestal is not None:
            sides = tipping_of_pedestal(statue.mass_kg, statue.centroid_height_m, statue.base_centre_m, scene.pedestal)
            over = [direction * level_m_s2[:, axis] / np.float64(share) for (axis, direction), share in sides.items()]
            needed["pedestal_tips"] = np.max(over, axis=0)
            needed["pedestal_slides"] = np.where(size > 0.0, size / np.float64(contact.floor_static), 0.0)
    return needed


def tipping_of_pedestal(
    mass_kg: float, centroid_height_m: float, base_centre_m: float, pedestal: Pedestal
) -> dict[tuple[int, int], float]:
    """The pushes, as shares of the weight, from which pedestal and statue tip as one body, by (axis, direction): ±x, ±y.

    About an edge of the pedestal: push (m₁ H/2 + m₂ (H + h)) = g (m₁ d₁ + m₂ d₂), d being the distances of both centroids from
    the edge. A centroid beyond its edge leaves nothing.
    """
    stone_kg, height_m = pedestal.mass_kg, pedestal.height_m
    lever = 0.5 * stone_kg * height_m + mass_kg * (height_m + centroid_height_m)
    middle_m = base_centre_m + pedestal.offset_m, 0.0
    return {
        (axis, direction): max((stone_kg * half + mass_kg * (half + direction * centre)) / lever, 0.0)
        for axis, (half, centre) in enumerate(zip(pedestal.half_m[:2], middle_m, strict=True))
        for direction in (1, -1)
    }


def _shares(needed_m_s2: Array, weight_m_s2: Array) -> Array:
    """What is needed as a share of the weight there is; a floor that falls freely leaves none."""
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = np.where(weight_m_s2 > 0.0, needed_m_s2 / weight_m_s2, np.where(needed_m_s2 > 0.0, np.inf, 0.0))
    return np.asarray(np.maximum(shares, 0.0))


def least_x_factor(scene: Scene, most: float) -> float | None:
    """The factor of the motion along x, up to `most`, from which the statue begins to move; None where none does.

    The pushes that are borne form a convex set that holds the push of the other components alone, so one factor parts rest
    from motion.
    """

    if isinstance(scene.base_excitation.y, ZeroExcitation):
        # Every push, and with it every share, is the factor's multiple.
        share = push_of(scene).first[1]
        return 1.0 / share if share * most >= 1.0 else None

    def moves(factor: float) -> bool:
        return push_of(scene, factor).first[1] >= 1.0

    low, high = 0.0, 1.0
    while not moves(high):
        low, high = high, 2.0 * high
        if low > most:
            return None
    while high - low > FACTOR_ROUNDING * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if moves(middle) else (middle, high)
    return high if high <= most else None


SETTLES_RAD: Final = 1e-4
"""A smaller rotation is the give of a contact engine, or an uneven base settling."""
STILL_M: Final = 1e-5
DIGIT_ROUNDING: Final = 1e-3
"""Of a fourth digit: what the factor itself is found to, so that 1.0000001 is told as 1 and not as 1.001."""
SIZE_KEYS: Final = {"pulse": "amplitude_g", "harmonic": "amplitude_g", "record": "scale"}
"""The key by which a scene file says how large a motion is."""
LARGEST: Final = {"amplitude_g": LARGEST_G, "scale": LARGEST_SCALE}
"""What a scene file takes for these keys at most."""


def standstill(scene: Scene, runs: Iterable[Run]) -> Finding | None:
    """What is to know when no model's statue or pedestal moves although the floor pushes it; None otherwise."""
    answered = [run for run in runs if not run.outcome.failed]
    if not answered or any(_moves(run) for run in answered):
        return None
    push = push_of(scene)
    if push.peak == 0.0:
        return None
    cause, share = push.first
    if share >= 1.0:
        times = share if math.isfinite(share) else None
        return caution(
            "no_model_moves", limit_rad=SETTLES_RAD, limit_m=STILL_M, push_g=push.peak, times=times, cause=cause
        )
    return changes_answer("nothing_moves", push_g=push.peak, share=share, cause=cause, least=_least(scene))


def _moves(run: Run) -> bool:
    if run.outcome is not Outcome.STANDS or abs(run.peak_theta_rad) > SETTLES_RAD or abs(run.peak_slip_m) > STILL_M:
        return True
    # Across the rocking plane, about the vertical, and over its support a statue moves in columns of its own.
    extra = {} if run.history is None else run.history.extra
    limits = {
        "roll_rad": SETTLES_RAD,
        "yaw_rad": SETTLES_RAD,
        "statue_slip_m": STILL_M,
        "statue_y_m": STILL_M,
        "pedestal_y_m": STILL_M,
    }
    return any(np.ptp(extra[name]) > limit for name, limit in limits.items() if name in extra)


def _least(scene: Scene) -> str:
    """The least value of the key of the motion along x that moves the statue, rounded up to four digits; empty without one."""
    key, before = _size(scene)
    if key is None or before == 0.0:
        return ""
    factor = least_x_factor(scene, LARGEST[key] / abs(before))
    if factor is None:
        return ""
    digit = 10.0 ** (math.floor(math.log10(abs(factor * before))) - 3)
    return (
        f"motion.x.{key}={math.copysign(digit * math.ceil(abs(factor * before) / digit - DIGIT_ROUNDING), before):.4g}"
    )


def motion_sized(scene: Scene, factor: float) -> str:
    """The key and value of a scene file that make its motion along x larger by a factor; empty where no single key does."""
    key, before = _size(scene)
    return "" if key is None else f"motion.x.{key}={before * factor:.4g}"


def _size(scene: Scene) -> tuple[str | None, float]:
    """The key that says how large the motion along x is, and its value; None where no single key does."""
    motion = written(scene, "motion", "x")
    if not isinstance(motion, Mapping):
        return None, 0.0
    key = SIZE_KEYS.get(str(motion.get("kind")))
    if key is None or (key == "scale" and ("pga_g" in motion or "pgv_m_s" in motion)):
        return None, 0.0
    before = motion.get(key, 1.0)
    return (key, float(before)) if isinstance(before, int | float) else (None, 0.0)
