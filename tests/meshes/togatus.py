"""A generated statue: an acephalous togatus on a plinth, with the mass properties of the Paestum statue.

A standing Roman in a toga, life size, facing +x: the right leg slightly bent, the heavy fold across the front, the
left forearm
carrying the gathered cloth, the neck broken off, a box of scrolls by the left foot. The parts are lofted closed
surfaces, joined by
an exact Boolean union. Four proportions that no survey gives (girth, taper, lean, sway) are solved so that volume and
centroid
are those of docs/model.md, section 1; the solution is kept here and checked by a test that solves again.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from meshes.repair import Part
from meshes.solid import Solid, mass_properties, solid_from_mesh
from tests.meshes.loft import loft, smooth_curve, tube
from tests.meshes.shapes import union

Array = NDArray[np.float64]

MASS_KG = 707.0
DENSITY_KG_M3 = 2700.0
CENTROID_HEIGHT_M = 0.774
CORNER_RIGHT_M = 0.0682
CORNER_LEFT_M = 0.3585
BASE_DEPTH_M = 0.72
HEIGHT_M = 1.46
PLINTH_HEIGHT_M = 0.06


@dataclass(frozen=True)
class Proportions:
    """The four solved proportions: girth and taper scale the sections, lean and sway shear the figure along x and y."""

    girth: float
    taper: float
    lean: float
    sway: float


SOLVED = Proportions(
    girth=0.905141895949961,
    taper=0.519787543085903,
    lean=0.032150478786640124,
    sway=-0.022722461309008898,
)

# Stations of the draped body: height over the plinth as a fraction of the figure, centre x, y, half-depth to the
# front and to the
# back, half-width, in metres before girth and taper.
_STATIONS = np.array(
    [
        # s     cx     cy     front  back   width
        [0.000, -0.115, 0.000, 0.118, 0.175, 0.285],
        [0.030, -0.115, 0.000, 0.118, 0.168, 0.274],
        [0.120, -0.090, 0.000, 0.130, 0.155, 0.250],
        [0.250, -0.050, 0.000, 0.185, 0.155, 0.250],
        [0.400, -0.005, -0.005, 0.238, 0.180, 0.275],
        [0.460, 0.002, -0.008, 0.240, 0.190, 0.290],
        [0.520, 0.004, -0.010, 0.228, 0.205, 0.305],
        [0.640, 0.000, -0.005, 0.215, 0.225, 0.325],
        [0.760, -0.010, 0.000, 0.208, 0.238, 0.335],
        [0.840, -0.020, 0.000, 0.200, 0.235, 0.330],
        [0.885, -0.025, 0.000, 0.182, 0.222, 0.305],
        [0.918, -0.025, 0.000, 0.142, 0.178, 0.232],
        [0.942, -0.025, 0.000, 0.105, 0.122, 0.137],
        [0.962, -0.020, 0.000, 0.086, 0.092, 0.092],
        [1.000, -0.015, 0.000, 0.078, 0.080, 0.082],
    ]
)
# Knots of the limbs: x, y, z of the axis, radius across and radius upward, in metres before lean and sway.
_LEFT_ARM = np.array(
    [
        [0.00, 0.235, 1.250, 0.060, 0.070],
        [-0.02, 0.315, 1.140, 0.080, 0.090],
        [-0.01, 0.325, 1.000, 0.085, 0.085],
        [0.08, 0.300, 0.985, 0.075, 0.070],
        [0.19, 0.270, 1.010, 0.052, 0.052],
    ]
)
_CLOTH = np.array(
    [
        [0.09, 0.295, 1.03, 0.050, 0.060],
        [0.10, 0.300, 0.85, 0.052, 0.110],
        [0.07, 0.295, 0.60, 0.055, 0.120],
        [0.02, 0.285, 0.35, 0.050, 0.110],
        [-0.03, 0.255, 0.05, 0.045, 0.095],
    ]
)
_RIGHT_ARM = np.array(
    [
        [0.00, -0.215, 1.25, 0.060, 0.070],
        [-0.02, -0.315, 1.12, 0.078, 0.085],
        [0.02, -0.335, 0.95, 0.070, 0.070],
        [0.11, -0.290, 0.84, 0.052, 0.052],
        [0.20, -0.190, 0.80, 0.044, 0.044],
    ]
)
_RINGS = 86
_AROUND = 96


def build() -> Solid:
    """The statue in the statue frame, about 20 000 triangles, watertight; the plinth's four lower corners are its
    footprint."""
    vertices, faces = surface(SOLVED)
    return solid_from_mesh(vertices, faces, density_kg_m3=DENSITY_KG_M3)


def write(path: str | Path) -> Solid:
    """Write the statue's mesh in metres, z up, in the format of the path's suffix, and return the solid."""
    import trimesh

    solid = build()
    trimesh.Trimesh(solid.vertices_m, solid.faces, process=False).export(Path(path))
    return solid


def solve(start: Proportions) -> Proportions:
    """Proportions whose volume and centroid are the survey's, from a rough start by a quasi-Newton root-finder."""
    from scipy.optimize import root

    def misses(unknowns: Array) -> Array:
        properties = mass_properties(*surface(Proportions(*unknowns)))
        x_right = CORNER_RIGHT_M + properties.centroid_m[0]
        plinth_right = 0.5 * (CORNER_RIGHT_M + CORNER_LEFT_M) + _plinth_centre_m()
        return np.array(
            [
                properties.volume_m3 / (MASS_KG / DENSITY_KG_M3) - 1.0,
                properties.centroid_m[2] / CENTROID_HEIGHT_M - 1.0,
                (x_right - plinth_right) / CORNER_RIGHT_M,
                properties.centroid_m[1] / BASE_DEPTH_M,
            ]
        )

    solution = root(misses, [start.girth, start.taper, start.lean, start.sway], method="hybr", options={"xtol": 1e-10})
    if not solution.success:
        raise ArithmeticError(f"the togatus has no solution from {start}: {solution.message}")
    return Proportions(*(float(value) for value in solution.x))


def _plinth_centre_m() -> float:
    """x of the plinth's centre with the wanted centroid at x = 0."""
    return 0.5 * (CORNER_RIGHT_M - CORNER_LEFT_M)


def surface(proportions: Proportions) -> Part:
    """Vertices (n, 3) in metres, z up from the base plane, and outward triangles (m, 3) of the joined statue."""
    return union([_plinth(), _body(proportions), *_limbs(proportions), _scroll_box()])


def _plinth() -> Part:
    """The plinth: sharp below, a worn chamfer above."""
    half_x, half_y = 0.5 * (CORNER_RIGHT_M + CORNER_LEFT_M), 0.5 * BASE_DEPTH_M
    profile = [(0.0, 0.0), (0.0, 0.8), (0.006, 0.93), (0.016, 1.0)]
    corners = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    rings = np.empty((len(profile), 4, 3))
    for k, (inset, level) in enumerate(profile):
        rings[k, :, 0] = _plinth_centre_m() + corners[:, 0] * (half_x - inset)
        rings[k, :, 1] = corners[:, 1] * (half_y - inset)
        rings[k, :, 2] = level * PLINTH_HEIGHT_M
    return loft(rings)


def _shear(points: Array, proportions: Proportions) -> Array:
    """Lean and sway: every point moved along x and y in proportion to its height over the plinth."""
    level = (points[..., 2] - PLINTH_HEIGHT_M)[..., None]
    return np.asarray(points + level * np.array([proportions.lean, proportions.sway, 0.0]))


def _body(proportions: Proportions) -> Part:
    """Draped body from hem to neck: stations splined along the height, sections as superellipses, folds as
    displacement."""
    from scipy.interpolate import PchipInterpolator

    figure = HEIGHT_M - PLINTH_HEIGHT_M
    s = np.unique(np.r_[np.linspace(0.0, 0.88, _RINGS - 18), np.linspace(0.88, 0.98, 16), np.linspace(0.98, 1.0, 4)])
    cx, cy, front, back, width = PchipInterpolator(_STATIONS[:, 0], _STATIONS[:, 1:])(s).T[:, :, None]
    turn = 2.0 * np.pi * np.arange(_AROUND) / _AROUND
    cos, sin = np.cos(turn), np.sin(turn)
    depth = np.where(cos > 0.0, front, back)
    power = 0.86  # between an ellipse (1) and a box (0): draped backs are flat
    fading = _calm(s[:, None])
    depth_scale = 1.0 + fading * (proportions.girth * (1.0 + proportions.taper * (s[:, None] - 0.45)) - 1.0)
    width_scale = 1.0 + fading * (proportions.girth * (1.0 + 0.4 * proportions.taper * (s[:, None] - 0.45)) - 1.0)
    x = depth * np.sign(cos) * np.abs(cos) ** power
    y = width * np.sign(sin) * np.abs(sin) ** power
    swell = _drapery(s[:, None], turn[None, :], x, y)
    norm = np.hypot(x, y)
    x, y = cx + depth_scale * x * (1.0 + swell / norm), cy + width_scale * y * (1.0 + swell / norm)
    z = np.broadcast_to(PLINTH_HEIGHT_M - 0.01 + (figure + 0.01) * s[:, None], x.shape)
    broken = 0.012 * np.sin(turn + 0.6) * (s[:, None] > 0.985) - 0.012 * (s[:, None] > 0.985)
    return loft(_shear(np.dstack([x, y, z + broken]), proportions))


def _ridge(phase: Array) -> Array:
    """Fold profile, about -1 to 1, crests leaning over their valleys, as carved drapery has."""
    return np.cos(phase + 0.35 * np.sin(phase)) - 0.22 * np.cos(2.0 * phase)


def _bump(u: Array, centre: float, half_width: float) -> Array:
    """Smooth bump of height 1 about `centre`."""
    return np.exp(-(((u - centre) / half_width) ** 2))


def _calm(s: Array) -> Array:
    """One over the draped body, falling to zero over the bare neck."""
    return np.asarray(1.0 / (1.0 + np.exp((s - 0.915) / 0.010)))


def _drapery(s: Array, turn: Array, x: Array, y: Array) -> Array:
    """Radial displacement in metres of the cloth over the body, for heights s (k, 1), angles (1, n), section points
    (k, n)."""
    facing = 1.0 / (1.0 + np.exp(-(np.cos(turn) - 0.1) / 0.12))
    behind = 1.0 / (1.0 + np.exp((np.cos(turn) + 0.1) / 0.12))
    lower = 1.0 / (1.0 + np.exp((s - 0.40) / 0.045))
    hanging = lower * (
        0.013 * _ridge(13.0 * turn + 2.2 * np.sin(2.0 * turn) + 1.3 * s) + 0.004 * np.sin(29.0 * turn + 2.0 * s)
    )
    # The sinus: a roll of cloth from the left shoulder in a wide curve below the right hip and back to the left
    # forearm.
    u = np.minimum(y + 0.06, 0.14)  # no steeper than the mesh can show
    across = s - (0.37 + 1.9 * u**2 + 0.55 * u + 1.08 * (y + 0.06 - u))
    sinus = facing * (0.034 * _bump(across, 0.0, 0.032) + 0.016 * _bump(across, 0.072, 0.028))
    # Bowl-shaped folds above it, a diagonal band (balteus) from the right armpit to the left shoulder, sweeping folds
    # behind.
    above = 1.0 / (1.0 + np.exp(-(across - 0.10) / 0.02))
    bowls = 0.011 * facing * above * _ridge(2.0 * np.pi * across / 0.088)
    balteus = facing * 0.030 * _bump(s - 0.735 - 0.35 * y, 0.0, 0.030)
    sweep = 0.012 * behind * (1.0 - 0.85 * lower) * _ridge(2.0 * np.pi * (s - 0.75 * y - 0.9 * y**2) / 0.125)
    knee = facing * (
        0.035 * _bump(y, -0.12, 0.075) * _bump(s, 0.27, 0.13) - 0.022 * _bump(y, -0.01, 0.035) * _bump(s, 0.2, 0.2)
    )
    return _calm(s) * (hanging + sinus + bowls + balteus + sweep + knee)


def _limbs(proportions: Proportions) -> list[Part]:
    """Left arm in its sleeve with the cloth over the forearm, right arm lowered, two feet."""

    def sleeve(t: Array, turn: Array) -> Array:
        return 0.07 * _ridge(22.0 * t + 2.0 * np.sin(turn))

    def hung(t: Array, turn: Array) -> Array:
        return 0.16 * _ridge(7.0 * turn + 2.0 * t)

    draped = [
        tube(smooth_curve(_LEFT_ARM, 26), around=28, folds=sleeve),
        tube(smooth_curve(_CLOTH, 34), around=28, folds=hung, upright=(1.0, 0.0, 0.0)),
        tube(smooth_curve(_RIGHT_ARM, 26), around=28, folds=sleeve),
    ]
    leaning = [(_shear(vertices, proportions), faces) for vertices, faces in draped]
    return [*leaning, _foot(-0.125, -0.012), _foot(0.10, -0.035)]


def _foot(y: float, reach: float) -> Part:
    """A shod foot whose toes come out below the hem; `reach` of the toes in x."""
    knots = [
        (-0.17, y, 0.080, 0.040, 0.045),
        (-0.08, y, 0.095, 0.045, 0.050),
        (reach + 0.030, y * 1.12, 0.085, 0.047, 0.026),
        (reach + 0.075, y * 1.16, 0.078, 0.020, 0.012),
    ]
    return tube(smooth_curve(np.array(knots), 12), around=20)


def _scroll_box() -> Part:
    """The capsa, a round box of scrolls, on the plinth behind the left foot."""
    level = np.array([0.05, 0.07, 0.08, 0.23, 0.24, 0.26, 0.267])
    radius = np.array([0.067, 0.069, 0.064, 0.064, 0.071, 0.071, 0.062])
    turn = 2.0 * np.pi * np.arange(32) / 32
    rings = np.empty((len(level), 32, 3))
    rings[..., 0] = -0.265 + radius[:, None] * np.cos(turn)
    rings[..., 1] = 0.27 + radius[:, None] * np.sin(turn)
    rings[..., 2] = level[:, None]
    return loft(rings)
