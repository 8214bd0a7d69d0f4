"""Bullet behind the layer that locates events: its own step, rows read and written, and what its contacts need next."""

import math
from collections.abc import Callable, Sequence
from typing import Final

import pybullet

from harness.engines.pybullet.world import World
from harness.engines.stepping import settings
from harness.engines.stepping.step_log import ALONE, Account, Impulse, Ledger, Row, StepLog, Vector, crossed
from harness.engines.stepping.step_state import StepState
from harness.engines.stepping.support import SLIDES_M_S

NEAR_M: Final = 1e-4
"""A foot further above its support than this rubs on nothing."""
IN_LINE_RAD: Final = 3e-4
"""So near to one of Bullet's axes friction leans by less than a ten-thousandth of itself."""
EIGHTH_RAD: Final = 0.25 * math.pi


# Bullet's gyroscopic torque made of second order: what a step's own misses is added to it as an external torque.
#
# Euler's equations are I ω̇ + ω × I ω = τ. Bullet takes ω × I ω at the velocity with which a step begins, half a step before
# the step's middle: the rotation then errs by the first order of the step, in flight as about a vertex. Here it is taken at the
# velocity foreseen for the middle of the time over which the velocity is changed. No place and no velocity is written.

KIND: Final = "gyroscopic"
"""Kind of this intervention."""
STILL_RAD_S: Final = 1e-6
"""A body that turns more slowly has no gyroscopic torque worth a call: less than 1e-12 rad/s²."""


class Gyroscope:
    """The torque that the next step lacks: `prepare_step` it from the rows, `act` before each solution of the step."""

    def __init__(self, world: World) -> None:
        self.world = world
        # What turns in the plane alone turns about a principal axis: nothing is missing.
        self.moments: list[float] | None = None if world.setup.in_plane else world.setup.moments.tolist()
        self.torque: Vector | None = None

    def prepare_step(self, row: Row, rate_rad_s2: Vector, span_s: float, length_s: float, ledger: Ledger) -> None:
        """A step of `length_s` that takes velocities on by `span_s` (shorter around events), from a row whose angular velocity
        changes by `rate_rad_s2`.
        """
        self.torque = None
        if self.moments is None or abs(row[10]) + abs(row[11]) + abs(row[12]) < STILL_RAD_S:
            return
        (ix, iy, iz), (x, y, z, w), half = self.moments, row[3:7], 0.5 * span_s
        # Columns of the body's rotation.
        ax, ay, az = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w)
        bx, by, bz = 2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w)
        cx, cy, cz = 2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y)
        f, g, h = row[10:13]
        p, q, r = f * ax + g * ay + h * az, f * bx + g * by + h * bz, f * cx + g * cy + h * cz
        f, g, h = f + half * rate_rad_s2[0], g + half * rate_rad_s2[1], h + half * rate_rad_s2[2]
        u, v, s = f * ax + g * ay + h * az, f * bx + g * by + h * bz, f * cx + g * cy + h * cz
        share = span_s / length_s
        a = (iy - iz) * (share * v * s - q * r)
        b = (iz - ix) * (share * s * u - r * p)
        c = (ix - iy) * (share * u * v - p * q)
        self.torque = a * ax + b * bx + c * cx, a * ay + b * by + c * cy, a * az + b * bz + c * cz
        rate_rad_s = length_s * math.hypot(a / ix, b / iy, c / iz)
        ledger[KIND].write(0.0, 0.0, 0.0, rate_rad_s, length_s * (a * p + b * q + c * r))

    def act(self) -> None:
        """Add the torque foreseen to the step that follows: Bullet forgets it with that."""
        if self.torque is not None:
            self.world.twist(self.torque)


GRIP: Final = 0.5
"""Share of the statue's friction limit from which on its feet are not taken to stand, and"""
GRIP_AGAIN: Final = 0.35
"""below which they are again."""
STEPS_OFF: Final = 2.0
"""A body's reach over the square of its turning in a step, at least: half of that is what a step takes a foot off its support."""
WIDER: Final = 4.0
"""How many times as wide it is made as that, when it is too narrow, and"""
NARROWER: Final = 256.0
"""how many times too wide it may be."""
RESTING_M_S: Final = 1e-3
"""Velocity, m/s and rad/s, below which statue and pedestal rest: one that rocks is slower for a hundredth of a half-cycle."""
AXES_TURNED: Final = "axes_turned"
"""Kind of steps solved again with Bullet's axes along what slid in them, and"""
MOST_TURNS: Final = 3
"""how often one is at most."""


class BulletBackend:
    """One of Bullet's worlds (`harness.engines.stepping.step_state.Backend`); `step_s` is the length of its whole steps,
    `grip_limit` the statue's coefficient of friction, None where its feet are never told to keep their places.
    """

    depth_m = 0.0
    owed_m_s = (0.0, 0.0)
    near: bool | None = None

    def __init__(self, world: World, step_s: float, grip_limit: float | None = None) -> None:
        self.world, self.step_s, self.grip_limit = world, step_s, grip_limit
        self.read, self.pull = reader(world), puller(world)
        self.gyroscope, self.ledger = Gyroscope(world), Ledger(Account)
        self.row = self.read()
        self.runs = not self.gyroscope.moments
        self.set_length, self.set_floor_friction = world.set_length, world.set_floor_friction
        self.move_table = world.move_table
        self.least_reach, self.grips = world.reach, False
        if grip_limit is not None and world.feet_over:
            self._anchor(held=True)

    def place(self, row: Row) -> None:
        """Put both bodies into the state of a row, and a table that Bullet has moved on back under them."""
        self.row = row
        self.world.place(self.world.statue, row[:ALONE])
        if self.world.pedestal is not None:
            self.world.place(self.world.pedestal, row[ALONE:])
        if any(self.world.table[1]):
            self.world.move_table(*self.world.table)

    def prepare_step(self, state: StepState, kick_s: float, length_s: float) -> None:
        """What Bullet's gyroscopic torque misses in the next step; after an impact the change of velocities is not known yet."""
        self.ledger = state.record.ledger
        if self.gyroscope.moments is None:
            return
        record, change = state.record, (0.0, 0.0, 0.0)
        if state.smooth and len(record.t_s) > 1:
            before, last_s = record.rate_before, record.kick_s[-1] - record.kick_s[-2]
            if last_s > settings.EVENTS.shortest * self.step_s:
                x, y, z = before
                change = ((state.row[10] - x) / last_s, (state.row[11] - y) / last_s, (state.row[12] - z) / last_s)
        self.gyroscope.prepare_step(state.row, change, kick_s - state.kick_s, length_s, record.ledger)

    def impulses(self, places: Row) -> list[Impulse]:
        """What the contacts gave each body in the last step."""
        world, heading = self.world, self.world.heading
        bodies_of = [world.statue] if world.pedestal is None else [world.statue, world.pedestal]
        sums = {body: ([0.0, 0.0, 0.0], [0.0, 0.0, 0.0]) for body in bodies_of}
        for contact in pybullet.getContactPoints(physicsClientId=world.client):
            place, parts = (
                contact[5],
                ((contact[9], contact[7]), (contact[10], contact[11]), (contact[12], contact[13])),
            )
            given: Vector = tuple(world.length_s * sum(size * axis[k] for size, axis in parts) for k in range(3))
            if heading is not None:
                given, place = heading.back.vector(given), heading.back.vector(place)
            for body, sign in ((contact[1], 1.0), (contact[2], -1.0)):
                if body in sums:
                    at = ALONE * bodies_of.index(body)
                    arm = tuple(place[k] - places[at + k] for k in range(3))
                    for total, part in zip(sums[body], (given, crossed(arm, given)), strict=True):
                        for k in range(3):
                            total[k] += sign * part[k]
        return [((*impulse,), (*moment,)) for impulse, moment in sums.values()]  # type: ignore[misc]

    def advance(self, gravity: Vector) -> Row:
        """Bullet's own step under a gravity, and the row after it; again with its axes along what slides after it."""
        before = self.row
        for turns in range(MOST_TURNS + 1):
            self.pull(*gravity, self.world.client)
            self.gyroscope.act()
            pybullet.stepSimulation(self.world.client)
            row = self.read()
            askew_rad = self._askew_rad(row) if self.world.follows and turns < MOST_TURNS else 0.0
            if abs(askew_rad) <= IN_LINE_RAD:
                break
            self.world.turn(-askew_rad)
            self.ledger[AXES_TURNED].steps_again += 1
            self.place(before)
        self.row = row
        return row

    def _askew_rad(self, row: Row) -> float:
        """Angle from the nearer of Bullet's axes to the line along which the pedestal slides on the floor, or while it does not
        the statue's lowest foot; 0 where nothing slides.

        Bullet's friction is Coulomb's along its own x and y, whatever a contact's effective masses: one of these is to lie
        along it.
        """
        (_, _, up), (u, v, _) = self.world.table
        x, y, least = 0.0, 0.0, SLIDES_M_S
        if len(row) > ALONE:
            half_m = self.world.pedestal_half_m
            x, y, up = row[20] - row[24] * half_m - u, row[21] + row[23] * half_m - v, up + 2.0 * half_m
        if math.hypot(x, y) < least:
            x, y, least = self._lowest_foot(row, up)
            x, y = x - u, y - v
        if math.hypot(x, y) < least:
            return 0.0
        own = math.atan2(y, x) + self.world.turn_rad - self.world.settings.turn_rad
        return (own + EIGHTH_RAD) % (2.0 * EIGHTH_RAD) - EIGHTH_RAD

    def _lowest_foot(self, row: Row, support_m: float) -> tuple[float, float, float]:
        """Velocity of the lowest foot, m/s, and how fast it must be to slide: infinitely where it is above its support."""
        x, y, z, w = row[3:7]
        feet_m = self.world.setup.feet_m
        downs = feet_m @ (2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y))
        lowest = int(downs.argmin())
        if row[2] + float(downs[lowest]) - support_m > NEAR_M:
            return 0.0, 0.0, math.inf
        c = float(downs[lowest])
        e, f, g = feet_m[lowest].tolist()
        a = (1.0 - 2.0 * (y * y + z * z)) * e + 2.0 * ((x * y - z * w) * f + (x * z + y * w) * g)
        b = 2.0 * ((x * y + z * w) * e + (y * z - x * w) * g) + (1.0 - 2.0 * (x * x + z * z)) * f
        p, q, r = row[10:13]
        # A foot that stands moves by its body's turning in half a step: velocities are older than places by that.
        turning = (p * p + q * q + r * r) * math.sqrt(a * a + b * b + c * c) * self.step_s
        return row[7] + q * c - r * b, row[8] + r * a - p * c, SLIDES_M_S + turning

    def run(self, pulls: Sequence[Vector], record: StepLog) -> Row:
        """Several steps of a body that needs no gyroscopic torque: rows are recorded, the last is returned."""
        set_gravity, step, read, client = self.pull, pybullet.stepSimulation, self.read, self.world.client
        row: Row = ()
        keep, pack = record.flat.frombytes, record.pack
        for gravity in pulls:
            set_gravity(*gravity, client)
            step(client)
            row = read()
            keep(pack(*row))
        return row

    def look(self, pulls: Sequence[Vector], before: Row, after: Row, table_m_s: Vector) -> None:
        """After whole steps under `pulls`: reach, grip and iterations that the bodies' contacts need next."""
        world, turning = self.world, after[10] * after[10] + after[11] * after[11]
        if len(after) > ALONE:
            table = (*table_m_s, 0.0, 0.0, 0.0)
            moving = (abs(v - w) for k in (7, 20) for v, w in zip(after[k : k + 6], table, strict=True))
            world.rest(not world.setup.in_plane and max(moving) < RESTING_M_S)
            turning = max(turning, after[23] * after[23] + after[24] * after[24])
        # A step takes a foot ω² h dt²/2 off its support: beyond its reach it is no contact there.
        needed = STEPS_OFF * turning * self.step_s**2
        if needed > world.reach or needed * NARROWER < world.reach > self.least_reach:
            world.set_reach(max(WIDER * needed, self.least_reach))
        if world.feet_over and self.grip_limit is not None:
            self._look_at_grip(self.grip_limit, pulls, before, after)

    def _look_at_grip(self, limit: float, pulls: Sequence[Vector], before: Row, after: Row) -> None:
        """Let the statue's feet keep their places only while its friction is far from its limit."""
        first, last, half_s = pulls[0], pulls[-1], 0.5 * len(pulls) * self.step_s
        x = after[7] - before[7] - half_s * (first[0] + last[0])
        y = after[8] - before[8] - half_s * (first[1] + last[1])
        z = after[9] - before[9] - half_s * (first[2] + last[2])
        share = GRIP if self.grips else GRIP_AGAIN
        if (math.hypot(x, y) < share * limit * z) != self.grips:
            self._anchor(held=not self.grips)

    def _anchor(self, *, held: bool) -> None:
        self.grips = held
        self.world.anchor(held=held)


def puller(world: World) -> Callable[[float, float, float, int], None]:
    """What sets a gravity, given along the scene's axes."""
    set_gravity: Callable[[float, float, float, int], None] = pybullet.setGravity

    def turned(x: float, y: float, z: float, client: int) -> None:
        set_gravity(*((x, y, z) if world.heading is None else world.heading.vector((x, y, z))), client)

    return set_gravity if world.heading is None and not world.follows else turned


def reader(world: World) -> Callable[[], Row]:
    """What reads the state of both bodies as one row."""
    pose, speed, client = pybullet.getBasePositionAndOrientation, pybullet.getBaseVelocity, world.client
    statue, pedestal = world.statue, world.pedestal

    def both() -> Row:
        place, turn = pose(statue, client)
        velocity, rate = speed(statue, client)
        below, level = pose(pedestal, client)
        slip, tip = speed(pedestal, client)
        return (*place, *turn, *velocity, *rate, *below, *level, *slip, *tip)

    def alone() -> Row:
        place, turn = pose(statue, client)
        velocity, rate = speed(statue, client)
        return (*place, *turn, *velocity, *rate)

    read = alone if pedestal is None else both
    if world.heading is None and not world.follows:
        return read
    return lambda: read() if world.heading is None else world.heading.back.row(read())
