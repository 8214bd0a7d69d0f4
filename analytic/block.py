"""What is rocked: the statue, its pedestal, the floor's friction, the form of the model and a wall, as plain numbers."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Final, Literal, Self, final

import numpy as np
from numpy.typing import NDArray

from analytic.constants import GRAVITY_M_S2
from analytic.errors import AnalyticInputError

FLAT_RAD: Final = 1e-12
"""A facet flatter than this lies level: what is left is rounding of the vertices' heights."""


def positive(**values: float) -> None:
    """Raise AnalyticInputError, naming every value that is not a finite positive number."""
    wrong = [f"{name} = {value!r}" for name, value in values.items() if not (math.isfinite(value) and value > 0.0)]
    if wrong:
        raise AnalyticInputError(f"finite positive numbers are wanted, {', '.join(wrong)} came.")


@final
@dataclass(frozen=True)
class Block:
    """A statue in its rocking plane: mass, centroid height h, inertia about the centroid, base.

    profile_m are the base's vertices (x, z) from left to right, m, in the frame whose origin lies on the base plane below
    the centroid: two corners, or the convex lower profile of a worn or chipped base (docs/model.md, section 8).
    Raises AnalyticInputError for what cannot rock.
    """

    mass_kg: float
    centroid_height_m: float
    inertia_kg_m2: float
    profile_m: tuple[tuple[float, float], ...]

    def __post_init__(self) -> None:
        """Check the numbers."""
        positive(mass_kg=self.mass_kg, centroid_height_m=self.centroid_height_m, inertia_kg_m2=self.inertia_kg_m2)
        points = np.asarray(self.profile_m, dtype=np.float64)
        if points.ndim != 2 or points.shape[0] < 2 or points.shape[1] != 2 or not np.isfinite(points).all():
            raise AnalyticInputError(f"profile_m: at least two finite (x, z) are wanted, {self.profile_m!r} came.")
        if (np.diff(points[:, 0]) <= 0.0).any():
            raise AnalyticInputError("profile_m: x increasing from left to right is wanted: sort the vertices.")
        if (np.diff(self.facets_rad()) <= 0.0).any():
            raise AnalyticInputError(
                "profile_m: a convex lower profile is wanted: leave out vertices that cannot touch."
            )
        if not points[0, 0] < 0.0 < points[-1, 0] or (points[:, 1] >= self.centroid_height_m).any():
            raise AnalyticInputError(
                "profile_m: a base under the centroid is wanted, its corners on both sides of x = 0."
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
        profile = ((-float(corner_left_m), 0.0), (float(corner_right_m), 0.0))
        return cls(mass_kg, centroid_height_m, inertia_kg_m2, profile)

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
        points = tuple((float(x), float(z)) for x, z in profile_m)
        return cls(mass_kg, centroid_height_m, inertia_kg_m2, points)

    @cached_property
    def arrays(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """x and z of the vertices (k,), m, and the facets' rotations (k − 1,), rad; shared, not to be written to."""
        points = np.array(self.profile_m, dtype=np.float64)
        angles = np.arctan2(np.diff(points[:, 1]), np.diff(points[:, 0]))
        flat = np.where(np.abs(angles) < FLAT_RAD, 0.0, angles)
        return np.ascontiguousarray(points[:, 0]), np.ascontiguousarray(points[:, 1]), flat

    def facets_rad(self) -> NDArray[np.float64]:
        """Rotation (k − 1,), rad, at which each facet lies on the support."""
        return self.arrays[2].copy()

    def _outer(self, side: int) -> tuple[float, float]:
        x, z = self.profile_m[-1 if side > 0 else 0]
        return abs(x), self.centroid_height_m - z

    @cached_property
    def _radii_m(self) -> tuple[float, float]:
        return math.hypot(*self._outer(1)), math.hypot(*self._outer(-1))

    def radius_m(self, side: int) -> float:
        """R of the outer corner on that side (1 right, −1 left), m."""
        return self._radii_m[0 if side > 0 else 1]

    def alpha_rad(self, side: int) -> float:
        """α of the outer corner on that side (1 right, −1 left), rad."""
        return math.atan2(*self._outer(side))

    def inertia_corner_kg_m2(self, side: int) -> float:
        """J about the outer corner on that side, kg m²."""
        return self.inertia_kg_m2 + self.mass_kg * self.radius_m(side) ** 2

    def p_rad_s(self, side: int, gravity_m_s2: float = GRAVITY_M_S2) -> float:
        """Frequency parameter p = √(m g R/J) about the outer corner on that side, rad/s."""
        radius_m = self.radius_m(side)
        return math.sqrt(self.mass_kg * gravity_m_s2 * radius_m / self.inertia_corner_kg_m2(side))

    def mirrored(self) -> Self:
        """The same statue with left and right exchanged."""
        profile = tuple((-x, z) for x, z in reversed(self.profile_m))
        return type(self)(self.mass_kg, self.centroid_height_m, self.inertia_kg_m2, profile)


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
        if not math.isfinite(self.offset_m):
            raise AnalyticInputError(f"offset_m: a finite number is wanted, {self.offset_m!r} came.")


@final
@dataclass(frozen=True)
class Friction:
    """Coulomb friction of the pedestal on the floor, 0 ≤ kinetic ≤ static."""

    static: float
    kinetic: float

    def __post_init__(self) -> None:
        """Check the numbers."""
        if not (math.isfinite(self.static) and 0.0 <= self.kinetic <= self.static):
            came = f"static = {self.static!r}, kinetic = {self.kinetic!r}"
            raise AnalyticInputError(f"friction: 0 ≤ kinetic ≤ static is wanted, {came} came.")


CHOICES: Final = ("stuck", "static_impact", "moving")
"""By the kernel's codes (`analytic.kernel.codes`)."""


@final
@dataclass(frozen=True)
class Form:
    """The form of the model (docs/model.md, section 4); restitution None is the angular-momentum law.

    choice, where the laws leave one: "stuck"; "static_impact", an impact that breaks the pedestal loose acts with the static
    coefficient (as in an engine that exchanges the two between its steps); "moving", of several joint states that are possible
    one that moves is taken, not the stuck one.
    """

    friction_normal: Literal["dynamic", "static"] = "dynamic"
    restitution: float | None = None
    pedestal_at_impact: Literal["momentum", "unchanged"] = "momentum"
    choice: Literal["stuck", "static_impact", "moving"] = "stuck"

    def __post_init__(self) -> None:
        """Check the choices."""
        known = {
            "friction_normal": ("dynamic", "static"),
            "pedestal_at_impact": ("momentum", "unchanged"),
            "choice": CHOICES,
        }
        for name, words in known.items():
            if getattr(self, name) not in words:
                raise AnalyticInputError(f"{name}: {' or '.join(words)} is wanted, {getattr(self, name)!r} came.")
        if self.restitution is not None and not 0.0 <= self.restitution <= 1.0:
            raise AnalyticInputError(f"restitution: a ratio from 0 to 1 is wanted, {self.restitution!r} came.")

    @classmethod
    def paper(cls, restitution: float) -> Self:
        """The paper's own form: static normal force, prescribed ratio, pedestal's velocity unchanged at impact."""
        return cls("static", restitution, "unchanged")


@final
@dataclass(frozen=True)
class Wall:
    """A wall on one side: the run ends at the rotation, rad, at which the statue's top touches it."""

    side: Literal["left", "right"]
    rotation_rad: float

    def __post_init__(self) -> None:
        """Check the numbers."""
        if self.side not in ("left", "right"):
            raise AnalyticInputError(f"side: left or right is wanted, {self.side!r} came.")
        if not self.rotation_rad >= 0.0:
            raise AnalyticInputError(f"rotation_rad: a number from 0 is wanted, {self.rotation_rad!r} came.")

    @classmethod
    def at_distance(cls, side: Literal["left", "right"], *, distance_m: float, height_m: float) -> Self:
        """A wall at distance_m from the base corner of a statue whose top stands height_m above that corner."""
        positive(distance_m=distance_m, height_m=height_m)
        return cls(side, math.asin(distance_m / height_m) if distance_m < height_m else math.inf)

    @property
    def sign(self) -> int:
        """1 for a wall on the right, −1 on the left."""
        return 1 if self.side == "right" else -1
