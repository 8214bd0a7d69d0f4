"""The room a statue needs: how far outline, top and pedestal go on a floor plan in one run, and over the draws that stand."""

import os
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Final

import numpy as np

from analytic import simulate
from harness.model import SOLID_COLUMNS, Array, Outcome, Scene, Statue, rotations, support_m
from harness.model import two_block as twoblock
from harness.questions.assess.probability import SLOW_DRAWS, Ints, ModelDraws, row, sweepable, varied
from harness.records.assess import ClearanceByModel
from meshes.footprint import convex_hull

PLANAR_DEG: Final = (0.0, 180.0)
"""Right and left: all that a planar model knows."""
AROUND_DEG: Final = tuple(22.5 * k for k in range(16))
"""Directions seen from above, anticlockwise from the statue's right: a convex room drawn by them is 2 % too wide at the most."""
PARTS: Final = ("outline", "top", "pedestal")
"""What is followed; the rows of every reach."""
LOOKS: Final = 4000
"""Most samples of a history that are looked at: 0.01 s apart in one of 40 s, where a rotation of 3 Hz loses 0.4 % of its peak."""
CLEARANCE_DRAWS: Final = 1000
"""Draws run with their histories: the 95 % quantile then rests on 50 of them, the 99 % one on 10."""
STEP_S: Final = 0.01
"""Between two looks at the history: a rotation of 3 Hz is then caught within (6π · 0.01)²/8 = 0.4 % of its peak."""
SPACE_RUNS: Final = 100
"""Standing draws that are run with their histories: some 0.1 s each for a record of 40 s; 99 of 100 then stay within the second
largest."""
SPACE_STEP_S: Final = 0.02
"""Between two looks: a rotation of 1 Hz, fast for a statue, is caught within (2π · 0.02)²/8 = 0.2 % of its peak.
Each look costs a step."""
SPACE_TOLERANCE: Final = 1e-7
"""Local error: that of the runs for their outcome."""
SHARES: Final = (0.50, 0.95, 0.99)
"""Of the draws that stand, this share stays within a clearance; told where at least one draw lies beyond."""
LEAST_DRAWS: Final = 20
"""Fewer standing draws have no 95 % quantile: none is told then."""


def clearance_by_model(scene: Scene, values: Mapping[str, Array], draws: ModelDraws) -> ClearanceByModel:
    """The clearance right and left by the analytic model: of the first draws those in which it knows that the statue stands."""
    size = CLEARANCE_DRAWS if sweepable(scene, values) else SLOW_DRAWS
    decided, fell, reached = draws.decided[:size], draws.overturned[:size], []
    for number in np.flatnonzero(decided & ~fell).tolist():
        drawn = varied(scene, row(values, number))
        shaken = drawn.base_excitation
        keywords = {**twoblock.keywords(drawn), "dt_s": STEP_S}
        solution = simulate(twoblock.block_of(drawn), shaken.x, shaken.z, **keywords)  # type: ignore[arg-type]
        # Past its horizon a run ends by rounding: one that falls when it is repeated is none of a statue that stands.
        if solution.outcome.value == Outcome.STANDS:
            reached.append(reach_m(drawn, solution.theta_rad, solution.slip_m, {}))
    return clearance(reached, np.ones(len(reached)), decided.size, int((~decided).sum()))


def clearance_by_engine(
    strata: Ints, fell: Mapping[int, bool | Outcome | None], reached_m: Mapping[int, Array]
) -> ClearanceByModel:
    """The clearance by the runs of an engine, by number of the draw: each stands for its share of the stratum (n,) that it was
    drawn from."""
    decided = strata[[number for number, each in fell.items() if isinstance(each, bool)]]
    each = np.bincount(strata, minlength=3) / np.maximum(np.bincount(decided, minlength=3), 1)
    undecided = len(fell) - decided.size
    return clearance(list(reached_m.values()), each[strata[list(reached_m)]], len(fell), undecided)


def clearance_in_space(scene: Scene, values: Mapping[str, Array], draws: ModelDraws) -> ClearanceByModel:
    """The clearance all round by the exact body, on the first draws in which it stands."""
    standing = np.flatnonzero(draws.decided & ~draws.overturned).tolist()
    chosen = standing[:SPACE_RUNS]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        repeated = pool.map(lambda number: _reach_in_space_m(varied(scene, row(values, number))), chosen)
        reached = [each for each in repeated if each is not None]
    decided = draws.decided if len(chosen) == len(standing) else draws.decided[: chosen[-1] + 1]
    return clearance(reached, np.ones(len(reached)), decided.size, int((~decided).sum()))


def _reach_in_space_m(scene: Scene) -> Array | None:
    """What the exact body reaches; None of a run that does not stand when it is repeated."""
    from analytic import spatial
    from harness.engines.spatial import problem_of, trajectory_of

    solution = spatial.solve(problem_of(scene), tolerance=SPACE_TOLERANCE, dt_out_s=SPACE_STEP_S, events=False)
    if solution.outcome.value != Outcome.STANDS:
        return None
    history = trajectory_of(scene, solution)
    return reach_m(scene, history.theta_rad, history.slip_m, history.extra)


def clearance(reached: Sequence[Array], weights: Array, draws: int, undecided: int = 0) -> ClearanceByModel:
    """Quantiles of reaches (parts, directions), one for each draw that stands; `weights` (n,) are what each counts for."""
    count = len(reached)
    if count < LEAST_DRAWS:
        return ClearanceByModel(draws, count, undecided=undecided)
    every = np.array(reached)
    shares = [share for share in SHARES if (1.0 - share) * count > 1.0 - 1e-9]
    # Each direction has an order of its own: the smallest reach that this share of the weight does not exceed.
    tables = np.quantile(every, shares, axis=0, weights=weights, method="inverted_cdf")
    columns = {f"{part}_m": [table[k].tolist() for table in tables] for k, part in enumerate(PARTS)}
    known_deg = AROUND_DEG if every.shape[2] > len(PLANAR_DEG) else PLANAR_DEG
    return ClearanceByModel(draws, count, known_deg, shares, **columns, undecided=undecided)


def reach_m(scene: Scene, theta_rad: Array, slip_m: Array, extra: Mapping[str, Array]) -> Array:
    """How far (parts, directions) outline, top and pedestal go beyond where they are at rest, m, over a history of shape (n,).

    A history with a pose in space has 16 directions, one of a plane two.
    """
    chosen = slice(None, None, max(theta_rad.size // LOOKS, 1))
    moved_m = support_m(scene.pedestal, slip_m, extra)[chosen]
    if all(name in extra for name in SOLID_COLUMNS):
        columns = {name: extra[name][chosen] for name in SOLID_COLUMNS}
        across = extra.get("pedestal_y_m", np.zeros_like(slip_m))[chosen]
        return _in_space(scene.statue, columns, np.column_stack([moved_m, across]))
    return _in_plane(scene.statue, theta_rad[chosen], moved_m)


def rest_outline_m(statue: Statue) -> Array:
    """The statue's outline (k, 2) at rest, seen from above."""
    return np.asarray(convex_hull(_corners(statue)[:, :2]))


def _in_plane(statue: Statue, theta_rad: Array, slip_m: Array) -> Array:
    """Rotated about the outer corner, and slid; a base of several vertices rolls first, which is some millimetres."""
    x, z = statue.section_m[:, 0], statue.section_m[:, 1]
    top = _top(statue.section_m)
    pivot = np.where(theta_rad >= 0.0, statue.corner_right_m, -statue.corner_left_m)[:, None]
    sine, cosine = np.sin(theta_rad)[:, None], np.cos(theta_rad)[:, None]
    places = pivot + (x - pivot) * cosine + z * sine + slip_m[:, None]
    peak = (pivot + (top[0] - pivot) * cosine + top[1] * sine)[:, 0] + slip_m
    ways = [(places.max(), x.max(), places.min(), x.min()), (peak.max(), top[0], peak.min(), top[0])]
    beyond = [(high - right, left - low) for high, right, low, left in ways]
    # At rest rounding may say less than nothing.
    return np.maximum([*beyond, (slip_m.max(), -slip_m.min())], 0.0)


def _in_space(statue: Statue, columns: Mapping[str, Array], slip_m: Array) -> Array:
    turn = rotations(columns)
    pivot = np.array([statue.corner_right_m, 0.0, 0.0])
    place = np.column_stack([columns[name] for name in SOLID_COLUMNS[3:]])
    corners = _corners(statue)
    top = _top(corners)
    angles = np.radians(AROUND_DEG)
    reached = []
    for towards in np.column_stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)]):
        seen, moved = turn.transpose(0, 2, 1) @ towards, place @ towards
        outline = ((corners - pivot) @ seen.T).max(axis=0) + moved
        peak = seen @ (top - pivot) + moved
        ways = outline - (corners @ towards).max(), peak - top @ towards, slip_m @ towards[:2]
        reached.append([max(float(way.max()), 0.0) for way in ways])
    return np.array(reached).T


def _corners(statue: Statue) -> Array:
    """Corners (k, 3) of the body's convex hull in the statue's frame: no other point ever reaches farther."""
    points: Array = statue.outer_points_m + np.array([0.0, 0.0, statue.centroid_height_m])
    if statue.solid is None:
        return points
    from scipy.spatial import ConvexHull

    return np.asarray(points[ConvexHull(points).vertices])


def _top(points: Array) -> Array:
    """The middle of the highest points."""
    highest = points[:, -1] >= points[:, -1].max() - 1e-9
    return np.asarray(points[highest].mean(axis=0))
