"""What is rocked: the statue, its pedestal, the floor's friction, the form of the model and a wall, as plain numbers."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Final, Literal, Self, final

import numpy as np
from numpy.typing import NDArray

# Numbers that every model of one scene must share; defined here once, for those outside this package too.

GRAVITY_M_S2: Final = 9.81
"""Where a scene names no other: standard gravity to three digits."""
OVERTURN_RAD: Final = 1.5
"""|θ| at which a statue counts as overturned: well beyond every balance point, and below the π/2 of a block that lies flat, which
a contact engine misses by the depth to which its contacts sink in."""


# The one exception that a user's wrong numbers raise.


@final
class AnalyticInputError(ValueError):
    """Raised for numbers that no run can use; the sentence says what was wanted, what came and what to do."""


def require(holds: object, sentence: str, *came: object) -> None:
    """Raise AnalyticInputError unless something holds; the sentence has braces for what came, and is made only then."""
    if not holds:
        raise AnalyticInputError(sentence.format(*came))


# Rotation matrices of quaternions.

Floats = NDArray[np.float64]


def rotation_matrices(quaternion_wxyz: Floats) -> Floats:
    """Rotation matrices (n, 3, 3) of unit quaternions (n, 4)."""
    w, x, y, z = quaternion_wxyz.T
    rows = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
        [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
        [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), -1, 0)


FLAT_RAD: Final = 1e-12
"""A facet flatter than this lies level: what is left is rounding of the vertices' heights."""


def positive(**values: float) -> None:
    """Raise AnalyticInputError, naming every value that is not a finite positive number."""
    # Words are made where one is wrong: a short run's checks are a tenth of it.
    wrong = [f"{name} = {value!r}" for name, value in values.items() if not 0.0 < value < math.inf]
    if wrong:
        raise AnalyticInputError(f"finite positive numbers are wanted, {', '.join(wrong)} came.")


@final
@dataclass(frozen=True)
class Block:
    """A statue in its rocking plane: mass, centroid height h, inertia about the centroid, base.

    profile_m are the base's vertices (x, z) from left to right, m, in the frame whose origin lies on the base plane below
    the centroid: two corners, or the convex lower profile of a worn or chipped base (docs/model.md, section 8).
    base_ends_rad are the leans to the left and to the right beyond which something else than the base comes down: there a run
    leaves the model's domain. Raises AnalyticInputError for what cannot rock.
    """

    mass_kg: float
    centroid_height_m: float
    inertia_kg_m2: float
    profile_m: tuple[tuple[float, float], ...]
    base_ends_rad: tuple[float, float] = (math.inf, math.inf)

    def __post_init__(self) -> None:
        """Check the numbers."""
        positive(mass_kg=self.mass_kg, centroid_height_m=self.centroid_height_m, inertia_kg_m2=self.inertia_kg_m2)
        points = np.asarray(self.profile_m, dtype=np.float64)
        require(
            points.ndim == 2 and points.shape[0] > 1 and points.shape[1] == 2 and np.isfinite(points).all(),
            "profile_m: at least two finite (x, z) are wanted, {!r} came.",
            self.profile_m,
        )
        require(
            (np.diff(points[:, 0]) > 0.0).all(),
            "profile_m: x increasing from left to right is wanted: sort the vertices.",
        )
        require(
            (np.diff(self.arrays[2]) > 0.0).all(),
            "profile_m: a convex lower profile is wanted: leave out vertices that cannot touch.",
        )
        require(
            points[0, 0] < 0.0 < points[-1, 0] and (points[:, 1] < self.centroid_height_m).all(),
            "profile_m: a base under the centroid is wanted, its corners on both sides of x = 0.",
        )
        require(
            min(self.base_ends_rad) > 0.0, "base_ends_rad: positive leans are wanted, {!r} came.", self.base_ends_rad
        )

    @classmethod
    def two_corners(
        cls,
        *,
        mass_kg: float,
        centroid_height_m: float,
        inertia_kg_m2: float,
        corner_left_m: float,
        corner_right_m: float,
    ) -> Self:
        """A statue with a flat base: distances of its two corners from below the centroid, both positive."""
        positive(corner_left_m=corner_left_m, corner_right_m=corner_right_m)
        return cls(
            mass_kg, centroid_height_m, inertia_kg_m2, ((-float(corner_left_m), 0.0), (float(corner_right_m), 0.0))
        )

    @classmethod
    def rectangle(cls, *, width_m: float, height_m: float, mass_kg: float = 1.0) -> Self:
        """A homogeneous rectangle; J_G = m (w² + h²)/12."""
        positive(width_m=width_m, height_m=height_m, mass_kg=mass_kg)
        half = 0.5 * width_m
        inertia = mass_kg * (width_m**2 + height_m**2) / 12.0
        return cls(mass_kg, 0.5 * height_m, inertia, ((-half, 0.0), (half, 0.0)))

    @classmethod
    def from_profile(
        cls, *, mass_kg: float, centroid_height_m: float, inertia_kg_m2: float, profile_m: Iterable[Iterable[float]]
    ) -> Self:
        """A statue with a base of any profile; profile_m (k, 2) as in the class."""
        return cls(mass_kg, centroid_height_m, inertia_kg_m2, tuple((float(x), float(z)) for x, z in profile_m))

    @cached_property
    def arrays(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """x and z of the vertices (k,), m, and the facets' rotations (k − 1,), rad; shared, not to be written to."""
        points = np.array(self.profile_m, dtype=np.float64)
        angles = np.arctan2(np.diff(points[:, 1]), np.diff(points[:, 0]))
        flat = np.where(np.abs(angles) < FLAT_RAD, 0.0, angles)
        return np.ascontiguousarray(points[:, 0]), np.ascontiguousarray(points[:, 1]), flat

    @cached_property
    def stands_m(self) -> NDArray[np.float64]:
        """Where on a level support each vertex stands as the block rolls from one to the next, m (k,); not to be written to."""
        x, z, facets = self.arrays
        # At rotation 0 a vertex, or both of a level facet, stand at their own x; from there on each chord is laid down.
        k = int(np.searchsorted(facets, 0.0))
        along = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(z)))])
        return np.ascontiguousarray(x[k] + (along - along[k]))

    @cached_property
    def addresses(self) -> tuple[int, int, int, int]:
        """Where `arrays` and `stands_m` stand in memory, as long as the block lives: asked of numpy, each costs a microsecond."""
        x, z, facets, stands = (each.ctypes.data for each in (*self.arrays, self.stands_m))
        return x, z, facets, stands

    def __getstate__(self) -> dict[str, object]:
        """The fields alone: a copy, or another process, has arrays and addresses of its own."""
        return {each.name: getattr(self, each.name) for each in fields(self)}

    @cached_property
    def _about_corners(self) -> tuple[tuple[float, float, float], ...]:
        """R, J and α of the outer corners on the left and on the right, m, kg m² and rad."""
        arms = [(abs(x), self.centroid_height_m - z) for x, z in (self.profile_m[0], self.profile_m[-1])]
        return tuple(
            (r := math.hypot(*arm), self.inertia_kg_m2 + self.mass_kg * r**2, math.atan2(*arm)) for arm in arms
        )

    def radius_m(self, side: int) -> float:
        """R of the outer corner on that side (1 right, −1 left), m."""
        return self._about_corners[side > 0][0]

    def alpha_rad(self, side: int) -> float:
        """α of the outer corner on that side (1 right, −1 left), rad."""
        return self._about_corners[side > 0][2]

    def p_rad_s(self, side: int, gravity_m_s2: float = GRAVITY_M_S2) -> float:
        """Frequency parameter p = √(m g R/J) about the outer corner on that side, rad/s."""
        radius_m, inertia_kg_m2, _ = self._about_corners[side > 0]
        return math.sqrt(self.mass_kg * gravity_m_s2 * radius_m / inertia_kg_m2)


@final
@dataclass(frozen=True)
class Pedestal:
    """A pedestal that slides: width_m in the rocking plane, offset_m of its centre from the centre of the statue's base."""

    mass_kg: float
    width_m: float
    height_m: float
    offset_m: float = 0.0

    def __post_init__(self) -> None:
        """Check the numbers."""
        positive(mass_kg=self.mass_kg, width_m=self.width_m, height_m=self.height_m)
        require(math.isfinite(self.offset_m), "offset_m: a finite number is wanted, {!r} came.", self.offset_m)


@final
@dataclass(frozen=True)
class Friction:
    """Coulomb friction of the pedestal on the floor, 0 ≤ kinetic ≤ static.

    impact is the coefficient that acts as an impact breaks a stuck pedestal loose: one of the two, or a number between them.
    """

    static: float
    kinetic: float
    impact: float | Literal["kinetic", "static"] = "kinetic"

    def __post_init__(self) -> None:
        """Check the numbers."""
        kinetic, static, impact = self.kinetic, self.static, self.impact
        require(
            math.isfinite(static) and 0.0 <= kinetic <= static,
            "friction: 0 ≤ kinetic ≤ static is wanted, static = {!r}, kinetic = {!r} came.",
            static,
            kinetic,
        )
        require(
            impact in ("kinetic", "static") or (isinstance(impact, int | float) and kinetic <= impact <= static),
            'friction at impact: "kinetic", "static" or a number from {!r} to {!r} is wanted, {!r} came.',
            kinetic,
            static,
            impact,
        )

    @property
    def at_impact(self) -> float:
        """The coefficient as an impact breaks a stuck pedestal loose."""
        if isinstance(self.impact, str):
            return self.static if self.impact == "static" else self.kinetic
        return self.impact


CHOICES: Final = ("stuck", "moving")
"""By the kernel's codes (`analytic.kernel.records`)."""


@final
@dataclass(frozen=True)
class Form:
    """The form of the model (docs/model.md, section 4); restitution None is the angular-momentum law.

    choice, where several joint states are possible: the "stuck" one, or one that is "moving".
    """

    friction_normal: Literal["dynamic", "static"] = "dynamic"
    restitution: float | None = None
    pedestal_at_impact: Literal["momentum", "unchanged"] = "momentum"
    choice: Literal["stuck", "moving"] = "stuck"

    def __post_init__(self) -> None:
        """Check the choices."""
        known = {
            "friction_normal": ("dynamic", "static"),
            "pedestal_at_impact": ("momentum", "unchanged"),
            "choice": CHOICES,
        }
        for name, words in known.items():
            came = getattr(self, name)
            require(came in words, "{}: {} is wanted, {!r} came.", name, " or ".join(words), came)
        require(
            self.restitution is None or 0.0 <= self.restitution <= 1.0,
            "restitution: a ratio from 0 to 1 is wanted, {!r} came.",
            self.restitution,
        )

    @classmethod
    def paper(cls, restitution: float) -> Self:
        """The paper's own form: static normal force, prescribed ratio, pedestal's velocity unchanged at impact."""
        return cls("static", restitution, "unchanged")


@final
@dataclass(frozen=True)
class Wall:
    """A wall that stands on the floor at distance_m from the statue's base at rest: the run ends as statue or pedestal touch it.

    silhouette_m are the points (x, z) of the statue that can touch it, in the frame of its base: the corners of its outline.
    """

    side: Literal["left", "right"]
    distance_m: float
    silhouette_m: tuple[tuple[float, float], ...]

    def __post_init__(self) -> None:
        """Check the numbers."""
        require(self.side in ("left", "right"), "side: left or right is wanted, {!r} came.", self.side)
        positive(distance_m=self.distance_m)
        points = np.asarray(self.silhouette_m, dtype=np.float64)
        require(
            points.ndim == 2 and points.shape[0] > 0 and points.shape[1] == 2 and np.isfinite(points).all(),
            "silhouette_m: finite (x, z) are wanted, {!r} came.",
            self.silhouette_m,
        )

    @property
    def sign(self) -> int:
        """1 for a wall on the right, −1 on the left."""
        return 1 if self.side == "right" else -1

    def place_m(self, block: Block) -> float:
        """Where it stands, from below the centroid of the statue at rest, positive on its side."""
        return self.sign * block.profile_m[-1 if self.sign > 0 else 0][0] + self.distance_m

    @cached_property
    def arrays(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """x and z of the silhouette (k,), m; shared, not to be written to."""
        points = np.array(self.silhouette_m, dtype=np.float64)
        return np.ascontiguousarray(points[:, 0]), np.ascontiguousarray(points[:, 1])

    def gap_m(self, block: Block, theta_rad: float) -> float:
        """Distance from the statue, turned so on its base before anything slid, to the wall; negative beyond it."""
        x, z, facets = block.arrays
        k = int(np.searchsorted(facets, theta_rad))
        dx, dz = self.arrays[0] - x[k], self.arrays[1] - z[k]
        reach = self.sign * (block.stands_m[k] + dx * math.cos(theta_rad) + dz * math.sin(theta_rad))
        return float(self.place_m(block) - reach.max())

    def pedestal_gap_m(self, block: Block, pedestal: Pedestal) -> float:
        """Distance from the pedestal, before it slid, to the wall."""
        centre = 0.5 * (block.profile_m[0][0] + block.profile_m[-1][0]) + pedestal.offset_m
        return self.place_m(block) - self.sign * centre - 0.5 * pedestal.width_m
