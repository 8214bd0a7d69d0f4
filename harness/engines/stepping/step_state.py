"""One step after another: whole ones, and shorter ones around an event. Places and velocities keep clocks of their own.

A step changes velocities first and places after. It is therefore two numbers: how far the places go, and up to when the
velocities are taken (`kick_s`, the middle of a whole step). For an impact the velocities are brought to its instant, the places
to the contact, and the impact takes no time: the engine solves a step in which nothing pulls, and only its velocities are kept.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, Protocol

import numpy as np

from harness.engines.base import LayerFault
from harness.engines.stepping.support import SLIP_ONSET, pedestal_inertia_kg_m2
from harness.engines.stepping.trajectory import (
    ALONE,
    STANDS_RAD,
    Account,
    Impulse,
    Ledger,
    Pair,
    Row,
    Schedule,
    StepLog,
    Vector,
    advanced,
    base_velocity,
    crossed,
    greatest_pull_m_s2,
    matrices,
)
from harness.model import Array, Scene

# The numbers by which events are located: shares of a step, of a rate or of a length, none with a unit but the angles.
#
# Where no other reason stands beside one it was chosen by trial on the paper's cases, and no result hangs on it: a fifth more or
# less moves none by its stated uncertainty (tests/harness/engines/stepping/test_constants.py).


@dataclass(frozen=True, kw_only=True)
class EventSettings:
    """What decides where a step is parted, in the order in which a run asks for it."""

    # Which step holds an event.
    ahead: float = 1.5
    """Steps between the last look at an event and the step in which it may fall."""
    later: float = 2.0
    """A foot that comes down no sooner than in so many of what is left of a step, at its present speed and as that grows, does
    not come down in it: of 290 impacts of a scan that rocks over 16 vertices one did, and of 2 200 steps without one 2 180 need
    no look."""
    most_jumps: int = 8
    """Events met within one step at most: what touches again and again comes to rest in a whole one."""
    tipped_rad: float = STANDS_RAD
    """A pedestal that leans more than this by the end of a step tips (the solver iterations leave up to 1e-6 rad in one that
    stands, in a whole scene 8e-6 at 1 ms; events located in a tipping of 1e-4 rad still shift it), or more than"""
    tipped: float = 0.2
    """this share of g over half its height, an acceleration of a body that tips freely, times the square of the step: of so much
    the solver iterations of longer steps leave a part."""

    # Which foot comes down.
    least_rate: float = 8e-4
    """The highest rate about the other end of the base at which a foot may close and stand all the same, of √(g/h), h the height
    of the centroid:"""
    held: float = 0.02
    """this share of the statue's own rate, as the solver iterations leave as much where friction changes, but not less than"""
    least_at_rest: float = 1.4e-4
    """this share of √(g/h), which they leave in a statue at rest on a pedestal that tips, or"""
    least_gained: float = 0.016
    """this share of g/h times the step: an impact at a lower rate begins a half-cycle of a fraction of a step."""
    drift: float = 4.0
    """A foot that falls faster than this many times its drift in a step comes down; a slower one stands."""
    near: float = 6.5e-6
    """A foot nearer than this share of h stands: the circle on which it turns takes it so far off its support within a step. In
    slow turning it takes it less far, but"""
    rest: float = 1.3e-7
    """this share of h the solver iterations may leave one that rests."""
    late: float = 0.05
    """A foot that came down longer ago than this, in steps, has met its support: deeper it was missed for a step."""
    least_turning: float = 0.25
    """A foot that closes at less than this share of the base's width times the rate of turning comes down from another cause (a
    contact lost for a step): its speed says nothing of how the statue turns, and is taken as it is."""

    # How an event is met.
    far: float = 0.06
    """An event further ahead than this, in steps, is approached by steps with the velocity of their middle."""
    approach: float = 0.85
    """Share of the time to the event that such a step takes."""
    most_approaches: int = 3
    aside: float = 0.1
    """Share of a step that an approach leaves before the step's end, where what is approached may come later."""
    room: float = 0.03
    """Time, in steps, that the places are left before the contact while the velocities are brought to its instant."""
    short: float = 0.9
    """Share of that time that the engine's step takes: a contact within a step is felt before it is reached."""
    together: float = 0.05
    """Feet that come down within this share of a step meet their support at once, as those of one edge do: an impact's length."""
    shortest: float = 2e-3
    """Share of a step below which none is taken."""
    still: float = 5e-3
    """Share of the least speed of a foot that comes down which a correction may leave in one that stands: a sound run, ended at
    its first event, left 4e-7 m/s of 5e-8 (scene 786044 of `space_scene`)."""
    least_rest: float = 0.04
    """A rest of a step shorter than this goes with the part before it."""

    # Micro-rocking.
    short_steps: float = 8.0
    """A half-cycle expected to be shorter than so many steps is followed in parts of its own."""
    least_steps: float = 0.25
    """One shorter than this is left to whole steps, in which it dies out."""
    parts: float = 5.0
    """Parts of a half-cycle as it is expected from its first one."""
    most_parts: int = 40
    """Parts after which a half-cycle that does not return is left to whole steps."""
    least_first: float = 0.02
    most_first: float = 0.5
    """Shares of a step between which the first part lies: the forces of a half-cycle are known only after it."""
    close_parts: float = 1.2
    """A foot that returns within so many times the coming part is met."""
    tail_parts: float = 0.4
    """A rest of a whole step shorter than so many parts goes with the part before it."""

    # Stick onset and slip onset of the pedestal.
    least_share: float = 0.02
    """Share of kinetic friction's deceleration below which a change of the pedestal's velocity is the solver's remainder."""
    past_rest: float = 0.1
    """A pedestal whose velocity, going on in a straight line, passes rest by more than this share of what kinetic friction takes
    in a step does not come to rest."""
    sticks_below: float = 0.3
    """Share of a step's loss of velocity that may be left of it when the pedestal counts as stuck."""
    unsolved: float = 2e-3
    """Share of its limit that friction at it may lack: the solver's iterations end before the last digits."""
    whole: float = 0.5
    """Share of a step from which on a step tells the force that holds the pedestal."""

    def stretched(self, share: float) -> EventSettings:
        """The same, with all that is done around an event so many times as long: of what the layer errs by that is another."""
        return (
            self
            if share == 1.0
            else replace(
                self,
                approach=1.0 - share * (1.0 - self.approach),
                aside=share * self.aside,
                room=share * self.room,
                together=share * self.together,
                least_rest=share * self.least_rest,
                parts=self.parts / share,
            )
        )


EVENTS: Final = EventSettings()


# When a vertex of the base comes down: the gap of every foot over its support, and how fast it closes.


Four = tuple[float, float, float, float]

MANY: Final = 40
"""Up to so many feet plain numbers are quicker than arrays: of the 82 of a scan they take three times as long."""


class ContactGaps:
    """Asked with a row: the time, s, until the first foot comes down at its present velocity, and the soonest that any could.

    `feet_m` (k, 3) about the centroid in the statue's principal frame; `half_m` half the pedestal's height, None on the floor.
    `within_m` are the pedestal's half width and depth where a foot beside its top meets nothing; None where the top has no end.
    """

    def __init__(
        self,
        scene: Scene,
        feet_m: Array,
        half_m: float | None,
        step_s: float,
        within_m: tuple[float, float] | None = None,
    ) -> None:
        statue, events = scene.statue, EVENTS
        self.feet_m, self.half_m, self.within_m = np.ascontiguousarray(feet_m), half_m, within_m
        self.feet = [tuple(foot) for foot in feet_m.tolist()]
        self.few = within_m is None and len(self.feet) <= MANY
        self.base_m = statue.corner_left_m + statue.corner_right_m
        height_m, own_rad_s = statue.centroid_height_m, math.sqrt(scene.gravity_m_s2 / statue.centroid_height_m)
        self.near_m, self.rest_m, self.held = events.near * height_m, events.rest * height_m, events.held
        self.slow_rad_s = events.least_rate * own_rad_s
        least = max(events.least_at_rest, events.least_gained * own_rad_s * step_s)
        self.least_m_s = min(events.least_rate, least) * own_rad_s * self.base_m
        pull = greatest_pull_m_s2(scene)
        # A standing foot falls back in each step by what its circle, of the centroid's height, took it up in the one before.
        self.drift_s = events.drift * height_m * step_s
        self.drift_m_s2 = self.drift_s * step_s
        self.late_s = events.late * step_s
        # What weight and table together can do to a foot at its distance from the centroid.
        self.bounds = 2.0 * pull / height_m * np.linalg.norm(feet_m, axis=1)
        self.bound = self.bounds.tolist()

    def __call__(self, row: Row, floor_m: float, floor_m_s: float) -> tuple[float, float, int]:
        """These times and that foot's number; `floor_m`, `floor_m_s` are the height of a moving table and its velocity.

        A time is infinite when no foot comes down, or all stand.
        """
        falling = self.falling_m_s(row)
        if not self.few:
            return self._of_many(row, falling, floor_m, floor_m_s)
        near = self.stands_m(row)
        first_s = soonest_s = math.inf
        foot = -1
        (ha, hb, hc, place), (va, vb, vc, rate) = self._support(row, floor_m, floor_m_s)
        for index, (fx, fy, fz) in enumerate(self.feet):
            gap, closing = fx * ha + fy * hb + fz * hc + place, -(fx * va + fy * vb + fz * vc + rate)
            falls = closing > falling and gap > -self.late_s * closing
            if gap > near or (falls and gap > 0.0):
                bound = self.bound[index]
                # Only a foot that is down by then comes sooner: most have no root to take.
                if gap < soonest_s * (closing + 0.5 * bound * soonest_s):
                    soonest_s = (math.sqrt(closing * closing + 2.0 * bound * gap) - closing) / bound
            if falls:
                time_s = gap / closing if gap > 0.0 else 0.0
                if time_s < first_s:
                    first_s, foot = time_s, index
        return first_s, soonest_s, foot

    def _of_many(self, row: Row, falling: float, floor_m: float, floor_m_s: float) -> tuple[float, float, int]:
        """The same for arrays."""
        gap, closing = self._all_gaps(row, floor_m, floor_m_s)
        falls = (closing > falling) & (gap > -self.late_s * closing)
        ahead = (gap > self.stands_m(row)) | (falls & (gap > 0.0))
        bound, near, rate = self.bounds[ahead], gap[ahead], closing[ahead]
        soonest_s = float(np.min((np.sqrt(rate * rate + 2.0 * bound * near) - rate) / bound, initial=math.inf))
        if not falls.any():
            return math.inf, soonest_s, -1
        contact_s = np.full(gap.size, math.inf)
        contact_s[falls] = np.maximum(gap[falls], 0.0) / closing[falls]
        foot = int(np.argmin(contact_s))
        first_s = float(contact_s[foot])
        return first_s, soonest_s, foot if first_s < math.inf else -1

    def standing(self, row: Row, floor_m: float = 0.0, floor_m_s: float = 0.0) -> list[int]:
        """Numbers of the feet that rest on their support, whether they slide along it or not."""
        near, falling = self.stands_m(row), self.falling_m_s(row)
        heights = enumerate(self.heights(row, floor_m, floor_m_s))
        return [k for k, (gap, closing) in heights if abs(gap) < near and abs(closing) < falling]

    def foot_m(self, feet: Sequence[int], row: Row) -> Vector:
        """Where the middle of some feet is from the centroid, world axes."""
        (middle,) = matrices(np.array([row[3:7]])) @ self.feet_m[feet].mean(axis=0)
        return float(middle[0]), float(middle[1]), float(middle[2])

    def foot_speeds_m_s(
        self, feet: Sequence[int], row: Row, others: Sequence[Row], floor_m: float, floor_m_s: float
    ) -> list[float]:
        """How much faster or slower than in a row some feet leave their support in others, on average."""
        heights = self.heights(row, floor_m, floor_m_s)
        moving = [self.heights(other, floor_m, floor_m_s) for other in others]
        return [sum(abs(each[k][1] - heights[k][1]) for k in feet) / len(feet) for each in moving]

    def drift_m(self, row: Row, floor_m: float = 0.0, *, within_s: float = 0.0) -> float:
        """How high feet near their support are above it, at most, with those that come down within `within_s`; 0 for none."""
        near, falling = self.stands_m(row), self.falling_m_s(row)
        highest = 0.0
        for gap, closing in self.heights(row, floor_m, 0.0):
            if highest < gap < (near if closing < falling else closing * within_s):
                highest = gap
        return highest

    def stands_m(self, row: Row) -> float:
        """A height over its support below which a foot stands."""
        square = row[10] * row[10] + row[11] * row[11]
        return min(self.near_m, self.rest_m + self.drift_m_s2 * square)

    def falling_m_s(self, row: Row) -> float:
        """A velocity that only a foot has that comes down."""
        square = row[10] * row[10] + row[11] * row[11]
        return max(
            self.least_m_s, self.drift_s * square, self.base_m * min(self.slow_rad_s, self.held * math.sqrt(square))
        )

    def heights(self, row: Row, floor_m: float, floor_m_s: float) -> list[tuple[float, float]]:
        """Height of each foot over its support, m, and the velocity at which it comes down, m/s."""
        if self.few:
            (ha, hb, hc, place), (va, vb, vc, rate) = self._support(row, floor_m, floor_m_s)
            return [(x * ha + y * hb + z * hc + place, -(x * va + y * vb + z * vc + rate)) for x, y, z in self.feet]
        gap, closing = self._all_gaps(row, floor_m, floor_m_s)
        return list(zip(gap.tolist(), closing.tolist(), strict=True))

    def height(self, foot: int, row: Row, floor_m: float, floor_m_s: float) -> tuple[float, float]:
        """The same of one foot."""
        if self.within_m is not None:
            return self.heights(row, floor_m, floor_m_s)[foot]
        (ha, hb, hc, place), (va, vb, vc, rate) = self._support(row, floor_m, floor_m_s)
        fx, fy, fz = self.feet[foot]
        return fx * ha + fy * hb + fz * hc + place, -(fx * va + fy * vb + fz * vc + rate)

    def _all_gaps(self, row: Row, floor_m: float, floor_m_s: float) -> tuple[Array, Array]:
        """The same as arrays, shape (k,) each; infinite heights beside the pedestal's top."""
        (ha, hb, hc, place), (va, vb, vc, rate) = self._support(row, floor_m, floor_m_s)
        fx, fy, fz = self.feet_m.T
        gap = fx * ha + fy * hb + fz * hc + place
        if self.within_m is not None:
            gap[past_edge_m(self.feet_m, row, self.within_m) > 0.0] = math.inf
        return gap, -(fx * va + fy * vb + fz * vc + rate)

    def _support(self, row: Row, floor_m: float, floor_m_s: float) -> tuple[Four, Four]:
        """Height over the support, and its rate, as components in the statue's principal frame and a constant."""
        x, y, z, w = row[3:7]
        nx, ny, nz = 0.0, 0.0, 1.0
        p, q, r = row[10:13]
        if self.half_m is None:
            place, rate = row[2] - floor_m, row[9] - floor_m_s
        else:
            a, b, c, d = row[16:20]
            nx, ny, nz = 2.0 * (a * c + b * d), 2.0 * (b * c - a * d), 1.0 - 2.0 * (a * a + b * b)
            place = nx * (row[0] - row[13]) + ny * (row[1] - row[14]) + nz * (row[2] - row[15]) - self.half_m
            rate = nx * (row[7] - row[20]) + ny * (row[8] - row[21]) + nz * (row[9] - row[22])
            p, q = p - row[23], q - row[24]
        # n · (ω × f) = f · (n × ω)
        sx, sy, sz = ny * r - nz * q, nz * p - nx * r, nx * q - ny * p
        # Columns of the statue's rotation: a world vector u has the components (u · column) in the statue's frame.
        ax, ay, az = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w)
        bx, by, bz = 2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w)
        cx, cy, cz = 2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y)
        ha, hb, hc = nx * ax + ny * ay + nz * az, nx * bx + ny * by + nz * bz, nx * cx + ny * cy + nz * cz
        va, vb, vc = sx * ax + sy * ay + sz * az, sx * bx + sy * by + sz * bz, sx * cx + sy * cy + sz * cz
        return (ha, hb, hc, place), (va, vb, vc, rate)


def past_edge_m(points_m: Array, row: tuple[float, ...], across_m: tuple[float, float]) -> Array:
    """How far points (k, 3) of the statue lie past the edges of the top, m, (k,); `across_m` are its half width and depth."""
    top, statue = matrices(np.array([row[16:20], row[3:7]]))
    there = (np.array(row[0:3]) - np.array(row[13:16]) + points_m @ statue.T) @ top[:, :2]
    return np.asarray((np.abs(there) - np.array(across_m)).max(axis=1))


class Backend(Protocol):
    """What an engine offers so that events can be located in it: one world with the scene's bodies, its own step.

    A step is read as velocities first, places after: what touches is found at the places at which the step begins, velocities are
    solved there, and the places go on with these. An engine that moves places first is read one move later.
    """

    depth_m: float
    """Depth at which what stands is kept in contact."""

    # The balance of momentum over a step, which tells friction, begins with what the engine was given.
    owed_m_s: tuple[float, float]
    """What was taken from the statue's velocity along x and z before the last step was solved."""
    near: bool | None
    """Whether a vertex may come down within the next steps; None of an engine that does not look, so that few are asked for."""
    runs: bool
    """Whether whole steps in which nothing is asked may be made by `run`."""

    def read(self) -> Row:
        """The bodies' state."""

    def place(self, row: Row) -> None:
        """Put the bodies into a state."""

    def set_length(self, length_s: float) -> None:
        """Length of the steps that follow, s."""

    def prepare_step(self, state: StepState, kick_s: float, length_s: float) -> None:
        """Be told of the next step: it begins at `state`, is so long, s, and takes velocities to `kick_s`."""

    def advance(self, gravity: Vector) -> Row:
        """One step under a gravity, m/s²; the row after it."""

    def run(self, pulls: Sequence[Vector], record: StepLog) -> Row:
        """Whole steps, one for each gravity or up to where a vertex comes `near`; rows are recorded, the last is returned."""

    def impulses(self, places: Row) -> Sequence[Impulse]:
        """What the contacts gave each body in the last step, as the engine reports it; centroids stood as in a row.

        Empty where it does not know.
        """

    def set_floor_friction(self, friction: float) -> None:
        """Coefficient of the pedestal on the floor from now on."""

    def move_table(self, place_m: Vector, velocity_m_s: Vector) -> None:
        """Put floor and wall to where a moving table is at the beginning of a step, with its mean velocity in it."""

    def look(self, pulls: Sequence[Vector], before: Row, after: Row, table_m_s: Vector) -> None:
        """After whole steps under `pulls`: what the bodies' contacts need next."""


# Whether each body's momentum, and its turning in the plane, changed by what the engine's own contacts gave it, and by the
# pull. At every impact, which moves nothing, with what was written after it, and over a whole step now and then. The impulses
# are those that the engine reports, and the pull of a step is not the one that whole steps are given: what the layer believes of
# either is not asked. Both engines keep this balance to rounding.


MOST_UNBALANCED: Final = 1e-6
"""Share of all impulses that may be missing in the balance: 1e-10 is, and 1e-3 where a pull or an inertia is off by it."""
ROUNDED_OFF: Final = 1e-6
"""Share of a body's own momentum that counts as impulse: of a body in flight the last digits are missing."""
SLOW_M_S: Final = 1e-3
"""Velocity that is added to a body's own in that: of one at rest, on which nothing acts, rounding is all there is."""
AFTER_STEPS: Final = 128
"""Whole steps from one that is looked at to the next."""
IMPACT, STEP = "impact", "step"


class Balance:
    """The sums of one run: what is missing, and the size of what there is, by what it is of."""

    def __init__(self, scene: Scene, axes: Array | None) -> None:
        """`axes` (3, 3) holds the statue's principal axes as columns (None: a planar engine)."""
        statue, pedestal = scene.statue, scene.pedestal
        # In the frame of a row's quaternion; a planar body has one number, that of its scene.
        self.inertia = (
            np.diag([0.0, statue.inertia_kg_m2, 0.0]) if axes is None else axes.T @ statue.inertia_tensor_kg_m2 @ axes
        )
        self.next, self.arm_m = 0, statue.centroid_height_m
        self.masses = [statue.mass_kg, *([] if pedestal is None else [pedestal.mass_kg])]
        # By what it is of: what is missing, and the size of what there is.
        self.sums: defaultdict[tuple[str, str], Array] = defaultdict(lambda: np.zeros(2))

    def add(self, of: str, before: Row, after: Row, impulses: Sequence[Impulse], pull_m_s: Vector) -> None:
        """Compare two rows with what the contacts gave each body between them; none where the engine cannot say."""
        if not impulses:
            return
        # What acts on the pedestal from both sides may cancel.
        largest = max(math.hypot(*impulse) for impulse, _ in impulses)
        speeds = (math.hypot(*after[ALONE * k + 7 : ALONE * k + 10]) for k in range(len(impulses)))
        moved = sum(mass * (speed + SLOW_M_S) for mass, speed in zip(self.masses, speeds, strict=True))
        for k, (mass, (impulse, _)) in enumerate(zip(self.masses, impulses, strict=True)):
            at, name = ALONE * k + 7, "pedestal" if k else "statue"
            missing = [mass * (after[at + n] - before[at + n] - pull_m_s[n]) - impulse[n] for n in range(3)]
            self.sums[of, f"{name}_momentum"] += math.hypot(*missing), largest + ROUNDED_OFF * moved
            if of == IMPACT:
                here, there = before[at - 7 : at], after[at - 7 : at]
                placed_m = math.dist(here[:3], there[:3]) + self.arm_m * _chord(here[3:], there[3:])
                self.sums[of, f"{name}_place"] += placed_m, ROUNDED_OFF * self.arm_m
        # What turns out of the plane has a gyroscopic torque besides.
        aside = max(abs(row[n]) for row in (before, after) for n in (10, 12))
        if of == IMPACT or aside <= ROUNDED_OFF * abs(before[11]):
            (turn,), moment = matrices(np.array([before[3:7]])), impulses[0][1][1]
            # Of the inertia in the world's axes the row that gives the angular momentum about y.
            was, now = np.array([before[10:13], after[10:13]]) @ turn @ self.inertia @ turn[1]
            turned = abs(now) + self.arm_m * (largest + moved)
            self.sums[of, "statue_turning"] += abs(now - was - moment), abs(moment) + ROUNDED_OFF * turned

    def check(self) -> None:
        """Raise `LayerFault` where something is missing."""
        for (of, what), (missing, size) in self.sums.items():
            if not missing <= MOST_UNBALANCED * size:
                raise LayerFault(f"unbalanced_{what}", **{f"{of}_missing": float(missing), f"{of}_whole": float(size)})


def _chord(here: Row, there: Row) -> float:
    """Distance of two quaternions: one and its opposite are the same rotation."""
    return min(math.dist(here, there), math.dist(here, [-q for q in there]))


# The one place from which an engine's bodies are written to while a run goes on, and the account of what is written.


class RowWriter:
    """Writes rows to statue and pedestal of one world of an engine."""

    def __init__(self, backend: Backend, scene: Scene) -> None:
        self.backend, self.ledger, self.gravity_m_s2 = backend, Ledger(Account), scene.gravity_m_s2
        statue, pedestal = scene.statue, scene.pedestal
        self.inertias = [(statue.mass_kg, statue.inertia_kg_m2)]
        if pedestal is not None:
            self.inertias.append((pedestal.mass_kg, pedestal_inertia_kg_m2(pedestal)))

    def write(self, kind: str, before: Row, after: Row) -> None:
        """Change both bodies from the row that they have, `before`."""
        moved_m = turned_rad = velocity_m_s = rate_rad_s = joules = 0.0
        for k, (mass, inertia) in enumerate(self.inertias):
            old, new = before[ALONE * k : ALONE * (k + 1)], after[ALONE * k : ALONE * (k + 1)]
            if old[:7] != new[:7]:
                moved_m += math.dist(old[0:3], new[0:3])
                turned_rad += 4.0 * math.asin(0.5 * _chord(old[3:7], new[3:7]))
                joules += mass * self.gravity_m_s2 * (new[2] - old[2])
            if old[7:] != new[7:]:
                velocity_m_s += math.dist(old[7:10], new[7:10])
                rate_rad_s += math.dist(old[10:13], new[10:13])
                joules += 0.5 * mass * (sum(v * v for v in new[7:10]) - sum(v * v for v in old[7:10]))
                # Angular velocities are changed in the rocking plane alone, about y.
                joules += 0.5 * inertia * (new[11] ** 2 - old[11] ** 2)
        self.ledger[kind].write(moved_m, turned_rad, velocity_m_s, rate_rad_s, joules)
        self.backend.place(after)


NOTHING: Final = (0.0, 0.0, 0.0)
HOLDS: Final = 2.0
"""Times the static coefficient with which a pedestal holds in a step that asks for the force that this takes."""
LEAST_M_S: Final = 1e-12
"""Below this a velocity does not change."""
RESTS: Final = 1e-2
"""Share of what kinetic friction takes in a step, below which a velocity is what the solver's iterations leave at rest."""
REVERSAL: Final = "friction_reversal"
"""Kind of what is written where the pedestal's velocity passed zero, and static friction may hold."""


class Stepper:
    """One step at a time: gravity or table, friction's two numbers; keeps the sliding state between steps."""

    def __init__(
        self, backend: Backend, scene: Scene, schedule: Schedule, event_share: float = 1.0, axes: Array | None = None
    ) -> None:
        self.backend, self.schedule, self.events = backend, schedule, EVENTS.stretched(event_share)
        self.writer, self.balance = RowWriter(backend, scene), Balance(scene, axes)
        contact, pedestal = scene.contact, scene.pedestal
        self.static, self.kinetic, self.at_impact = contact.floor_static, contact.floor_kinetic, contact.at_impact
        self.kinetic_m_s = self.kinetic * scene.gravity_m_s2 * schedule.step_s
        self.switches = pedestal is not None and self.static != self.kinetic
        self.masses = (scene.statue.mass_kg, 0.0 if pedestal is None else pedestal.mass_kg)
        freely_rad = 0.0 if pedestal is None else 2.0 * scene.gravity_m_s2 / pedestal.height_m * schedule.step_s**2
        self.tipped_rad = max(self.events.tipped_rad, self.events.tipped * freely_rad)
        # Whole steps that ask for nothing between them are made at once.
        self.runs = backend.runs and not (schedule.moving or self.switches)
        self.stuck, self.just_slipped, self.past_rest = True, False, False
        self.half_m = NOTHING if pedestal is None else pedestal.half_m
        # Velocity over the floor of what the pedestal stands on, m/s, before the present step, and the row where this one begins.
        self.slip_before: Pair = (0.0, 0.0)
        self.places: Row | None = None
        self.table_place = self.table_rate = self.table_before = NOTHING

    def step(self, gravity: Vector, t_s: float, kick_s: float, step_s: float, before: Row) -> Row:
        """Advance the world from `before` at `t_s` by `step_s`, velocities to `kick_s`."""
        if self.schedule.moving:
            self.table_before = self.table_rate
            place, self.table_rate = self.schedule.table(t_s, kick_s, step_s)
            self.backend.move_table(place, self.table_rate)
            self.table_place = place
            self.carry_table(step_s)
        self.just_slipped = False
        row = self.backend.advance(gravity)
        if not self.switches:
            return row
        places, self.places = before if self.places is None else self.places, before
        pull = (gravity[0] * step_s, gravity[1] * step_s, gravity[2] * step_s)
        if self.stuck and not self._gives_way(pull, before, row):
            return row
        # A velocity is solved at the places at which its step began.
        self.slip_before = self._slip(places, before, self.table_before)
        if self.stuck:
            row = self._slip_onset(gravity, pull, before, row)
            # What a blow set moving slides throughout: no force before it tells when it broke loose.
            taken_m_s = self.kinetic * math.hypot(*pull)
            self.just_slipped = not self.stuck and math.hypot(*self.slip_before) < self.events.sticks_below * taken_m_s
            return row
        slip = self._slip(before, row, self.table_rate)
        if self._goes_past_rest(slip):
            return row
        stops = self._sticks(slip) or self._rests(slip)
        if stops and self._share_of_limit(self.kinetic, pull, before, row) < 1.0 - self.events.unsolved:
            self._hold(self.static)
        elif self._reversed(slip) and any(pull):
            # The velocity passed zero: the step again with the static limit, which may hold. An impact takes no time and has no
            # pull: what slid before it has the kinetic coefficient throughout, whichever way it slides after.
            self._hold(self.static)
            self._again(before, REVERSAL)
            row = self.backend.advance(gravity)
            if self._gives_way(pull, before, row):
                row = self._slip_onset(gravity, pull, before, row)
        return row

    def _gives_way(self, pull: Vector, before: Row, row: Row) -> bool:
        """Whether friction reached its static limit in a step that was computed with it."""
        return self._share_of_limit(self.static, pull, before, row) >= 1.0 - self.events.unsolved

    def carry_table(self, seconds: float) -> None:
        """Let a moving table be where its velocity takes it: gaps are between places of one instant."""
        (x, y, z), (u, v, w) = self.table_place, self.table_rate
        self.table_place = x + u * seconds, y + v * seconds, z + w * seconds

    def _slip_onset(self, gravity: Vector, pull: Vector, before: Row, row: Row) -> Row:
        """A step that reached the static limit as it stands, or once more with kinetic friction.

        One that brings the pedestal to rest, from a slip or a blow, reaches the limit too: static friction has it then.
        """
        slip = self._slip(before, row, self.table_rate)
        gaining = math.hypot(*slip) > math.hypot(*self.slip_before)
        if not gaining and (self._sticks(slip) or self._reversed(slip)):
            return row
        # So near to the limit an engine's feet, which do not all bear the same, give way one by one: what holds them is asked.
        self._again(before)
        self.backend.set_floor_friction(HOLDS * self.static)
        held = self.backend.advance(gravity)
        if self._share_of_limit(self.static, pull, before, held) <= 1.0:
            self._hold(self.static)
            return held
        self._again(before)
        # In an impact, which takes no time and has no pull, another coefficient may act: sliding begins with it.
        self.backend.set_floor_friction(self.kinetic if any(pull) else self.at_impact)
        row = self.backend.advance(gravity)
        self._hold(self.kinetic)
        return row

    def _again(self, before: Row, kind: str = SLIP_ONSET) -> None:
        """Back to where the step began, which is to be solved again."""
        self.backend.place(before)
        self.writer.ledger[kind].steps_again += 1

    def redo_sliding(self, friction: float, gravity: Vector, before: Row) -> Row:
        """A step in which the pedestal was let loose again, with the coefficient that acts over it: the static one holds it."""
        self._again(before)
        self.backend.set_floor_friction(friction)
        row = self.backend.advance(gravity)
        self._hold(self.static if friction == self.static else self.kinetic)
        return row

    def set_sliding(self, sliding: bool) -> None:
        """The pedestal slides, or is held, from now on, as an impact that is not the engine's left it."""
        if self.switches:
            self._hold(self.kinetic if sliding else self.static)

    def _hold(self, friction: float) -> None:
        self.backend.set_floor_friction(friction)
        self.stuck = friction == self.static

    def _share_of_limit(self, friction: float, pull: Vector, before: Row, row: Row) -> float:
        """The floor's friction in this step, from the balance of momentum, as a share of its limit; infinite without one."""
        x, y, normal = self.friction(pull, before, row)
        owed_x, owed_z = self.backend.owed_m_s
        x, limit = x + self.masses[0] * owed_x, friction * (normal + self.masses[0] * owed_z)
        return math.hypot(x, y) / limit if limit > 0.0 else math.inf

    def friction(self, pull: Vector, before: Row, row: Row) -> Vector:
        """The floor's impulse on the pedestal in a step, N s, from the balance of momentum, less what `pull` gives."""
        (statue, pedestal), (x, y, z) = self.masses, pull
        return (
            statue * (row[7] - before[7] - x) + pedestal * (row[20] - before[20] - x),
            statue * (row[8] - before[8] - y) + pedestal * (row[21] - before[21] - y),
            statue * (row[9] - before[9] - z) + pedestal * (row[22] - before[22] - z),
        )

    def _slip(self, places: Row, row: Row, table: Vector) -> Pair:
        u, v = base_velocity(self.half_m, places, row)
        return u - table[0], v - table[1]

    def _sticks(self, slip: Pair) -> bool:
        """Whether friction took nearly all of the velocity that it could take in this step: solver iterations leave a little."""
        here, there = math.hypot(*slip), math.hypot(*self.slip_before)
        return here <= self.events.sticks_below * max(there - here, 0.0)

    def _rests(self, slip: Pair) -> bool:
        """Whether the pedestal was at rest before this step and is still: the step that ends where it comes to rest takes all of
        its velocity at the limit, and is no sign of holding yet.
        """
        return max(math.hypot(*slip), math.hypot(*self.slip_before)) <= RESTS * self.kinetic_m_s

    def _reversed(self, slip: Pair) -> bool:
        return self.slip_before[0] * slip[0] + self.slip_before[1] * slip[1] < 0.0

    def _goes_past_rest(self, slip: Pair) -> bool:
        """Whether in this step or the one before the velocity went along a line that passes rest, as it does in space.

        Kinetic friction stops nothing that turns aside where more is needed to hold it; a step's own solution does, as within
        its length it takes all of a small velocity.
        """
        (u, v), (x, y) = self.slip_before, slip
        one_before, self.past_rest = self.past_rest, self.passes_rest(self.slip_before, (x - u, y - v))
        return one_before or self.past_rest

    def passes_rest(self, velocity_m_s: Pair, change_m_s: Pair) -> bool:
        """Whether the pedestal's velocity, going on along the line of its change, passes rest and does not come to it."""
        (u, v), (a, b) = velocity_m_s, change_m_s
        past_m_s = abs(u * b - v * a) / max(math.hypot(a, b), LEAST_M_S)
        return past_m_s > self.events.past_rest * self.kinetic_m_s


# When static friction gives way inside a step: the coefficient that acts over that step in the mean.


def coefficient(stepper: Stepper, record: StepLog, step_s: float) -> float:
    """Coefficient of a whole step after the last sample, in which the pedestal breaks loose: up to the instant the force that
    holds it, from there on kinetic friction's, both over the normal force.

    The instant is where that force, taken on as a straight line from the two steps before, passes the static limit: at most a
    step ago, as a step is held whose mean is below the limit, and what it was held by too long is taken back. Where these were
    not whole steps, or the floor's acceleration jumped in them, it is taken to be the middle. The static coefficient says that it
    comes after this step.
    """
    static, kinetic, kicks = stepper.static, stepper.kinetic, record.kick_s
    short = len(kicks) < 3 or min(kicks[-1] - kicks[-2], kicks[-2] - kicks[-3]) < stepper.events.whole * step_s
    if short or stepper.schedule.jump_after_s(kicks[-3]) <= kicks[-1]:
        return 0.5 * (static + kinetic)
    before, last = (_held(stepper, record, index) for index in (-2, -1))
    # Both forces are means over their steps: they belong to the middles, half of the two steps apart.
    slope = (last - before) / (0.5 * (kicks[-1] - kicks[-3]))
    now = last + 0.5 * slope * (kicks[-1] - kicks[-2])
    if now + slope * step_s < static:
        return static
    hold_s = max((static - now) / slope, -step_s) if slope > 0.0 else 0.0
    return max((hold_s * (now + 0.5 * slope * hold_s) + (step_s - hold_s) * kinetic) / step_s, 0.0)


def _held(stepper: Stepper, record: StepLog, index: int) -> float:
    """Friction over normal force that would have held the pedestal in the step that ended at a sample.

    Near the limit it gives way a little, as its feet do not all bear the same: what its velocity gained is counted as held.
    """
    before, row = record.row(index - 1), record.row(index)
    pull = stepper.schedule.between(record.kick_s[index - 1], record.kick_s[index], 1.0)
    x, y, normal = stepper.friction(pull, before, row)
    if not stepper.schedule.moving:
        mass = sum(stepper.masses)
        x, y = x - mass * (row[20] - before[20]), y - mass * (row[21] - before[21])
    return math.hypot(x, y) / normal if normal > 0.0 else 0.0


# When a foot comes down that gathers speed: velocities are older than places, and a short half-cycle's change much in that
# time.


class ContactTimeEstimate:
    """Called, tells the time, s, until a foot is down if its speed goes on changing as in the last step; infinite if never.

    Where velocities are not older than places, the foot comes with its present one.
    """

    def __init__(self, state: StepState, gaps: ContactGaps, foot: int) -> None:
        """Begin with what the last two samples show, unless an impact or a stick onset lies between them."""
        self.state, self.gaps, self.foot = state, gaps, foot
        self.gained_m_s2, self.kick_s = 0.0, state.kick_s
        _, self.closing_m_s = self._height(state.row)
        kicks = state.record.kick_s
        if len(kicks) > 1 and kicks[-2] < kicks[-1] and state.smooth:
            self._gain(self._height(state.record.row(-2))[1], kicks[-2])

    def __call__(self) -> float:
        state = self.state
        gap, closing = self._look()
        if state.kick_s >= state.t_s:
            return gap / closing if closing > self.gaps.falling_m_s(state.row) else math.inf
        gained = self._gathers(closing)
        now = closing + gained * (state.t_s - state.kick_s)
        if gained <= 0.0:
            return gap / now if now > self.gaps.least_m_s else math.inf
        # The first t with gap = now t + gained t²/2.
        return (math.sqrt(now * now + 2.0 * gained * max(gap, 0.0)) - now) / gained

    def speeds(self) -> tuple[float, float]:
        """Time, s, until it would be down at its present speed, and that speed when it is down over the present one (≥ 1)."""
        gap, closing = self._look()
        contact_s = self()
        if contact_s == math.inf or closing <= self.gaps.least_m_s:
            return contact_s, 1.0
        then = closing + self._gathers(closing) * (self.state.t_s + contact_s - self.state.kick_s)
        return gap / closing, max(then / closing, 1.0)

    def _look(self) -> tuple[float, float]:
        gap, closing = self._height(self.state.row)
        if self.state.kick_s > self.kick_s:
            before, self.closing_m_s = self.closing_m_s, closing
            before_s, self.kick_s = self.kick_s, self.state.kick_s
            self._gain(before, before_s)
        return gap, closing

    def _gain(self, before_m_s: float, before_s: float) -> None:
        most = self.gaps.bound[self.foot]
        self.gained_m_s2 = min(max((self.closing_m_s - before_m_s) / (self.kick_s - before_s), -most), most)

    def _gathers(self, closing_m_s: float) -> float:
        row = self.state.row
        turning = self.gaps.base_m * math.hypot(row[10], row[11])
        return self.gained_m_s2 if abs(closing_m_s) >= self.state.events.least_turning * turning else 0.0

    def _height(self, row: Row) -> tuple[float, float]:
        stepper = self.state.stepper
        return self.gaps.height(self.foot, row, stepper.table_place[2], stepper.table_rate[2])


@dataclass(slots=True)
class HalfCycle:
    """A half-cycle since the impact at `start_s` that left a foot rising: the length of its parts, s, and whether it is known
    yet.
    """

    contact_time: ContactTimeEstimate
    start_s: float
    part_s: float
    known: bool = False
    parts: int = 0


LOOK_STEPS: Final = 16
"""Steps after which the bodies' contacts are looked at again."""


class StepState:
    """The run in progress: `t_s` of places, `kick_s` of velocities, `number` of the last whole step reached, the present row.

    `even` says that both clocks stand as after a whole step, so that another one may follow; `velocity_jumped` that the last
    sample is an impact's, `velocity_jumps` how many there were since the last whole step; `pulled_s` when the floor's
    acceleration last jumped. `half_cycle` is the short half-cycle in progress, if any.
    """

    def __init__(self, stepper: Stepper, record: StepLog, *, even: bool) -> None:
        """Go on from the last sample of `record`, at a whole step or less than half of one from it."""
        self.stepper, self.schedule, self.events = stepper, stepper.schedule, stepper.events
        self.record, self.row, self.t_s, self.kick_s = record, record.row(-1), record.t_s[-1], record.kick_s[-1]
        stepper.writer.ledger = record.ledger
        self.step_s = self.length_s = stepper.schedule.step_s
        self.number, self.even = round(self.t_s / self.step_s), even
        self.velocity_jumped, self.velocity_jumps, self.look_from = False, 0, self.number
        self.pulled_s = -math.inf
        self.half_cycle: HalfCycle | None = None

    @property
    def next_s(self) -> float:
        """The next whole step's time."""
        return (self.number + 1) * self.step_s

    @property
    def smooth(self) -> bool:
        """Whether what velocities changed by up to the last sample tells by what they go on to change."""
        return not self.velocity_jumped and self.kick_s != self.pulled_s

    @property
    def on_grid(self) -> bool:
        """Whether the places stand at a whole step."""
        return self.t_s == self.number * self.step_s

    def to(self, t_s: float, kick_s: float) -> Row:
        """One step of places to `t_s` and of velocities to `kick_s`."""
        self.kick(t_s - self.t_s, kick_s)
        self.t_s, self.velocity_jumped = t_s, False
        self.record.keep(t_s, kick_s, self.row)
        return self.row

    def kick(self, length_s: float, kick_s: float) -> None:
        """Velocities to `kick_s` by a step of the places over `length_s` that is no sample: their clock goes on by `length_s`."""
        self._set(length_s)
        gravity = self.schedule.between(self.kick_s, kick_s, length_s)
        self.stepper.backend.prepare_step(self, kick_s, length_s)
        self.row = self.stepper.step(gravity, self.t_s, kick_s, length_s, self.row)
        self.t_s, self.kick_s, self.even = self.t_s + length_s, kick_s, False

    def drift(self, seconds: float) -> None:
        """Places go on, or back, with the present velocities, by no step of the engine's."""
        self._write("part_of_step", advanced(self.row, seconds))
        self.stepper.carry_table(seconds)
        self.t_s += seconds

    def turn(self, seconds: float, foot_m: Vector) -> None:
        """Turn the statue's velocity about a standing foot, `foot_m` from its centroid, as a body that stands there goes on
        turning: (ω × r)' = ω × (ω × r), r from the foot to the centroid, whether the foot slides or not.
        """
        row, spin = self.row, self.row[10:13]
        a, b, c = crossed(spin, crossed(spin, foot_m))
        self.stepper.writer.ledger["turn_on"].explain(math.hypot(*spin), math.hypot(*foot_m), self.step_s)
        turned = (row[7] - seconds * a, row[8] - seconds * b, row[9] - seconds * c)
        self._write("turn_on", (*row[:7], *turned, *row[10:]))

    def impact(self) -> None:
        """An impact here and now: everything that touches meets at once, and nothing else moves."""
        length = self.events.together * self.step_s
        self._set(length)
        self.stepper.backend.prepare_step(self, self.kick_s, length)
        after = self.stepper.step(NOTHING, self.t_s, self.kick_s, length, self.row)
        before, stepper = self.row, self.stepper
        impulses = stepper.backend.impulses(before)
        # Only the velocities are kept.
        row = (*before[:7], *after[7:13], *before[13:20], *after[20:26])
        stepper.writer.write(IMPACT, after, row)
        for written in (row, stepper.backend.read()):
            stepper.balance.add(IMPACT, before, written, impulses, NOTHING)
        self.jump_velocity(row)

    def jump_velocity(self, row: Row) -> None:
        """A sample with other velocities at this instant."""
        shortest = self.events.shortest * self.step_s
        self.row, self.even, self.velocity_jumped = row, False, True
        self.velocity_jumps += 1
        self.t_s = self.kick_s = max(self.t_s, self.record.t_s[-1] + shortest)
        if self.next_s - self.t_s < shortest:
            self.drift(self.next_s - self.t_s)
            self.t_s = self.next_s
            self.number += 1
        self.record.keep(self.t_s, self.kick_s, self.row)

    def to_next(self, kick_s: float | None = None) -> None:
        """To the next whole step, velocities to the middle of the way or to `kick_s`."""
        end = self.next_s
        on_grid = kick_s is None and self.on_grid
        self.to(end, max(0.5 * (self.t_s + end), self.kick_s) if kick_s is None else kick_s)
        self.number += 1
        self.even, self.velocity_jumps = on_grid, 0

    def whole_steps(self, pulls: list[Vector]) -> None:
        """Whole steps, one for each gravity or up to where a vertex comes near.

        One in which static friction gives way acts with the coefficient of its mean.
        """
        self._set(self.step_s)
        self.velocity_jumped, self.velocity_jumps = False, 0
        stepper, record, step_s, before = self.stepper, self.record, self.step_s, self.row
        if stepper.runs:
            stepper.backend.prepare_step(self, (self.number + 0.5) * step_s, step_s)
            self.row = stepper.backend.run(pulls, record)
            record.whole_steps(self.number + 1, len(record.flat) // record.width - len(record.t_s), step_s)
        else:
            for number, gravity in enumerate(pulls, self.number + 1):
                stepper.backend.prepare_step(self, (number - 0.5) * step_s, step_s)
                row = stepper.step(gravity, (number - 1) * step_s, (number - 0.5) * step_s, step_s, self.row)
                if stepper.just_slipped:
                    row = stepper.redo_sliding(coefficient(stepper, record, step_s), gravity, self.row)
                self.row, self.t_s, self.kick_s = row, number * step_s, (number - 0.5) * step_s
                record.keep(self.t_s, self.kick_s, row)
                if stepper.backend.near:
                    break
        made = round(record.t_s[-1] / step_s) - self.number
        self.number += made
        if made > 1 and self.number >= stepper.balance.next:
            # Before anything is looked at: that may make contacts anew.
            self._weigh()
        if self.number >= self.look_from:
            self.look_from = self.number + LOOK_STEPS
            stepper.backend.look(pulls[:made], before, self.row, stepper.table_rate)
        self.t_s, self.kick_s = record.t_s[-1], record.kick_s[-1]

    def _weigh(self) -> None:
        """Hold the last of several whole steps against the balance of momentum."""
        balance, backend, record = self.stepper.balance, self.stepper.backend, self.record
        balance.next = self.number + AFTER_STEPS
        before, (owed_x, owed_z) = record.row(-2), backend.owed_m_s
        begun = (*before[:7], before[7] - owed_x, before[8], before[9] - owed_z, *before[10:])
        pull_m_s = self.schedule.between(record.kick_s[-2], record.kick_s[-1], 1.0)
        balance.add(STEP, begun, self.row, backend.impulses(before), pull_m_s)

    def rest(self, count: int) -> None:
        """So many whole steps in which nothing can move: samples as they are, without velocities, and no step of the engine's."""
        row, record = self.row, self.record
        self.row = (*row[:7], *NOTHING, *NOTHING, *row[13:20], *(0.0 for _ in row[20:]))
        record.flat.frombytes(count * record.pack(*self.row))
        record.whole_steps(self.number + 1, count, self.step_s)
        record.at_rest += count
        record.rest_s += count * self.step_s
        self.number += count
        self.t_s, self.kick_s = record.t_s[-1], record.kick_s[-1]
        self.velocity_jumped, self.velocity_jumps, self.half_cycle = False, 0, None
        self.settle()

    def settle(self) -> None:
        """Contacts as the present row needs them: the impulses that the solver begins from are none, or of another time."""
        at = min(self.number - self.schedule.first, len(self.schedule.coarse) - 1)
        stepper = self.stepper
        stepper.backend.look(self.schedule.coarse[at : at + 1], self.row, self.row, stepper.table_rate)

    def bring(self, instant_s: float) -> None:
        """Velocities to an instant within the next step at which forces jump: the middle of a step of the places, where these
        leave room for it.
        """
        shortest = self.events.least_rest * self.step_s
        end = self.t_s + max(2.0 * (instant_s - self.t_s), shortest)
        if end <= self.next_s - shortest:
            self.to(end, instant_s)
            return
        begin = min(2.0 * instant_s - self.next_s, self.next_s - shortest)
        if begin >= self.t_s + shortest:
            self.to(begin, max(0.5 * (self.t_s + begin), self.kick_s))
        self.to_next(instant_s)

    def meet_jump(self, instant_s: float) -> None:
        """Velocities to an instant at which the floor's acceleration jumps: what it then pulls at is no step's mean."""
        self.bring(instant_s)
        self.pulled_s, self.half_cycle = self.kick_s, None

    def lower(self, gap_m: float) -> None:
        """Take back what the standing foot has drifted off its support, as a step too short would not close the gap."""
        if gap_m == 0.0:
            return
        place = self.row[2] - gap_m
        self._write("hold", (*self.row[:2], place, *self.row[3:]))

    def _write(self, kind: str, row: Row) -> None:
        self.stepper.writer.write(kind, self.row, row)
        self.row = row

    def _set(self, length_s: float) -> None:
        if length_s != self.length_s:
            self.stepper.backend.set_length(length_s)
            self.length_s = length_s
