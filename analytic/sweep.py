"""Many parameter sets in parallel, in compiled code: overturning maps, fragilities, sensitivities."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from functools import partial
from typing import Any, Final, NamedTuple, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.block import Block, Form, Friction
from analytic.encode import encode
from analytic.errors import AnalyticInputError
from analytic.excitation import Excitation, Rest
from analytic.kernel import layout as at
from analytic.kernel.batch import run_rows
from analytic.solution import OUTCOMES, Outcome
from analytic.solver import OVERTURN_RAD, parameters

CHUNKS_PER_THREAD: Final = 16
"""Pieces of work for each thread: enough to keep them busy to the end, few enough to cost nothing."""
TWO_PI: Final = 2.0 * math.pi

Progress = Callable[[int, int], None]
"""Called with the runs done and the runs in all."""


@final
@dataclass(frozen=True, eq=False)
class Ensemble:
    """Outcomes of many runs, each array of the sweep's shape; times are NaN where nothing of the kind happened.

    codes index OUTCOMES; steps counts the integration steps of each run.
    """

    codes: NDArray[np.int64]
    end_s: NDArray[np.float64]
    peak_theta_rad: NDArray[np.float64]
    peak_slip_m: NDArray[np.float64]
    overturn_time_s: NDArray[np.float64]
    no_return_time_s: NDArray[np.float64]
    impacts: NDArray[np.int64]
    steps: NDArray[np.int64]

    @property
    def outcomes(self) -> NDArray[np.object_]:
        """Outcome of each run."""
        return np.array(OUTCOMES, dtype=object)[self.codes]

    @property
    def overturned(self) -> NDArray[np.bool_]:
        """Whether each run overturned, to either side."""
        return np.asarray((self.codes == at.OVERTURNED_LEFT) | (self.codes == at.OVERTURNED_RIGHT))

    def count(self, outcome: Outcome) -> int:
        """Number of runs with that outcome."""
        return int(np.count_nonzero(np.array([item is outcome for item in OUTCOMES])[self.codes]))


_PARAMETERS: Final = {
    "mass_kg": at.MASS,
    "centroid_height_m": at.CENTROID,
    "inertia_kg_m2": at.INERTIA,
    "pedestal_mass_kg": at.BASE_MASS,
    "floor_static": at.MU_STATIC,
    "floor_kinetic": at.MU_KINETIC,
    "restitution": at.RATIO,
    "theta0_rad": at.THETA0,
    "theta_rate0_rad_s": at.OMEGA0,
    "duration_s": at.DURATION,
}
_MOTION: Final = ("amplitude_m_s2", "frequency_hz", "phase_rad", "scale", "vertical_scale")
_BASE: Final = ("corner_left_m", "corner_right_m")
SWEEPABLE: Final = (*_PARAMETERS, *_MOTION, *_BASE)
"""Names that a sweep may vary."""


def ensemble(
    block: Block,
    motion_x: Excitation,
    motion_z: Excitation | None = None,
    *,
    sweep: Mapping[str, ArrayLike],
    duration_s: float,
    accuracy_rad: float = 1e-6,
    threads: int | None = None,
    progress: Progress | bool = False,
    **scene: Any,
) -> Ensemble:
    """Run every parameter set of a sweep for its outcome.

    sweep: arrays by name (SWEEPABLE) that broadcast against each other, their common shape being the result's: amplitude_m_s2,
    frequency_hz and phase_rad replace those of a harmonic or sine motion_x, scale and vertical_scale multiply the motions. scene:
    the other keywords of ``simulate``. threads: None for all cores; the result does not depend on it. progress: a callback, or
    True for a bar. Raises AnalyticInputError for unknown names and numbers that cannot be run.
    """
    unknown = sorted(set(sweep) - set(SWEEPABLE))
    if unknown or not sweep:
        raise AnalyticInputError(
            f"sweep: some of {', '.join(SWEEPABLE)} are wanted, {', '.join(unknown) or 'none'} came."
        )
    columns = {name: np.asarray(values, dtype=np.float64) for name, values in sweep.items()}
    shape = np.broadcast_shapes(*(values.shape for values in columns.values()))
    flat = {name: np.broadcast_to(values, shape).ravel() for name, values in columns.items()}
    wrong = [name for name, values in flat.items() if not np.isfinite(values).all()]
    if wrong:
        raise AnalyticInputError(f"sweep: finite numbers are wanted in {', '.join(wrong)}.")
    arrays = _rows(block, motion_x, motion_z if motion_z is not None else Rest(), flat, duration_s, accuracy_rad, scene)
    size = math.prod(shape)
    out = (
        np.zeros(size, np.int64),
        np.zeros(size),
        np.zeros((size, at.N_RESULT)),
        np.zeros((size, at.N_COUNT), np.int64),
    )
    _work(arrays, out, size, threads or os.cpu_count() or 1, progress)
    codes, ends, results, counts = out
    pick = {name: np.ascontiguousarray(results[:, i]).reshape(shape) for name, i in _KEPT.items()}
    return Ensemble(
        codes=codes.reshape(shape),
        end_s=ends.reshape(shape),
        peak_theta_rad=np.abs(pick["peak"]),
        peak_slip_m=pick["slip"],
        overturn_time_s=pick["overturn"],
        no_return_time_s=np.where(np.isfinite(pick["overturn"]), pick["no_return"], np.nan),
        impacts=np.ascontiguousarray(counts[:, at.IMPACTS]).reshape(shape),
        steps=np.ascontiguousarray(counts[:, at.STEPS]).reshape(shape),
    )


_KEPT: Final = {"peak": at.PEAK, "slip": at.PEAK_SLIP, "overturn": at.OVERTURN_TIME, "no_return": at.NO_RETURN}


class Rows(NamedTuple):
    """What the compiled code reads; held keeps alive the arrays that it knows by their address."""

    p: NDArray[np.float64]
    f: NDArray[np.float64]
    address: NDArray[np.int64]
    stride: NDArray[np.int64]
    length: NDArray[np.int64]
    held: tuple[NDArray[np.float64], ...]


def _rows(
    block: Block,
    motion_x: Excitation,
    motion_z: Excitation,
    sweep: Mapping[str, NDArray[np.float64]],
    duration_s: float,
    accuracy_rad: float,
    scene: Mapping[str, Any],
) -> Rows:
    """The kernel's arrays: parameters, motions and base row by row, and the shared records."""
    size = next(iter(sweep.values())).size
    p = np.tile(_parameters(block, duration_s, accuracy_rad, scene), (size, 1))
    fx, tx, sx = encode(motion_x)
    fz, tz, sz = encode(motion_z)
    f = np.tile(np.stack([fx, fz]), (size, 1, 1))
    points = np.asarray(block.profile_m, dtype=np.float64)
    x, z, facets = (np.tile(row, (size, 1)) for row in block.arrays)
    for name, values in sweep.items():
        if name in _PARAMETERS:
            p[:, _PARAMETERS[name]] = values
        elif name in _BASE:
            if points.shape[0] != 2:
                raise AnalyticInputError(f"sweep: {name} belongs to a block of two corners.")
            x[:, 0 if name == "corner_left_m" else 1] = -values if name == "corner_left_m" else values
        else:
            _vary_motion(name, values, f[:, 0], f[:, 1])
    _check(p, x, f[:, 0])
    if set(sweep) & {"mass_kg", "centroid_height_m", "inertia_kg_m2", *_BASE}:
        p[:, at.TIME_SCALE] = _time_scale(p, x, z)
    rows, shared, nothing = (x, z, facets), (tx, tz, sx, sz), np.empty(0)
    held = (*rows, *shared, nothing, nothing)
    stride = np.array([row.strides[0] if k < len(rows) else 0 for k, row in enumerate(held)])
    length = np.array([row.shape[-1] for row in held])
    return Rows(p, f, np.array([row.ctypes.data for row in held]), stride, length, held)


def _parameters(block: Block, duration_s: float, accuracy_rad: float, scene: Mapping[str, Any]) -> NDArray[np.float64]:
    friction = Friction(scene.get("floor_static", 0.0), scene.get("floor_kinetic", 0.0))
    rest = {name: value for name, value in scene.items() if name not in ("floor_static", "floor_kinetic")}
    settings: dict[str, Any] = {
        "pedestal": None,
        "form": Form(),
        "theta0_rad": 0.0,
        "theta_rate0_rad_s": 0.0,
        "gravity_m_s2": 9.81,
        "wall": None,
        "overturn_rad": OVERTURN_RAD,
        "step_cap_s": math.inf,
        "skip_start": True,
        "skip_rest": True,
        "skip_energy": True,
    }
    strange = sorted(set(rest) - set(settings))
    if strange:
        raise AnalyticInputError(f"ensemble: keywords of simulate are wanted, {', '.join(strange)} came.")
    return parameters(
        block,
        friction=friction,
        statue_friction=math.inf,
        duration_s=duration_s,
        accuracy_rad=accuracy_rad,
        dt_s=None,
        validity=False,
        **(settings | rest),
    )


def _time_scale(p: NDArray[np.float64], x: NDArray[np.float64], z: NDArray[np.float64]) -> NDArray[np.float64]:
    """1/p of each row's faster outer corner, s."""
    mass, weight = p[:, at.MASS], p[:, at.MASS] * p[:, at.GRAVITY]
    scale = np.full(len(p), np.inf)
    for k in (0, -1):
        radius = np.hypot(x[:, k], p[:, at.CENTROID] - z[:, k])
        scale = np.minimum(scale, np.sqrt((p[:, at.INERTIA] + mass * radius**2) / (weight * radius)))
    return scale


def _vary_motion(name: str, values: NDArray[np.float64], fxs: NDArray[np.float64], fzs: NDArray[np.float64]) -> None:
    if name in ("scale", "vertical_scale"):
        rows = fxs if name == "scale" else fzs
        rows[:, at.AMPLITUDE] *= values
        rows[:, at.SCALE] *= values
        return
    kind = int(fxs[0, at.KIND])
    if kind not in (at.HARMONIC, at.SINE, at.COSINE, at.RECTANGULAR):
        raise AnalyticInputError(f"sweep: {name} needs a harmonic or pulse motion_x; use scale for records.")
    if name == "amplitude_m_s2":
        fxs[:, at.AMPLITUDE] = values
    elif name == "phase_rad":
        fxs[:, at.PHASE] = values
    elif kind == at.RECTANGULAR:
        raise AnalyticInputError("sweep: a rectangular pulse has no frequency_hz.")
    else:
        fxs[:, at.OMEGA] = TWO_PI * values
        if kind != at.HARMONIC:
            fxs[:, at.END] = fxs[:, at.START] + 1.0 / values


def _check(p: NDArray[np.float64], x: NDArray[np.float64], fxs: NDArray[np.float64]) -> None:
    positive = [at.MASS, at.CENTROID, at.INERTIA, at.DURATION]
    if (p[:, positive] <= 0.0).any() or (x[:, 0] >= 0.0).any() or (x[:, -1] <= 0.0).any():
        raise AnalyticInputError("sweep: positive masses, lengths, inertias and durations are wanted.")
    if (p[:, at.MU_KINETIC] > p[:, at.MU_STATIC]).any() or (p[:, at.MU_KINETIC] < 0.0).any():
        raise AnalyticInputError("sweep: 0 ≤ floor_kinetic ≤ floor_static is wanted.")
    if (p[:, at.HAS_BASE] > 0.0).any() and (p[:, at.BASE_MASS] <= 0.0).any():
        raise AnalyticInputError("sweep: positive pedestal masses are wanted.")
    if (np.abs(p[:, at.THETA0]) >= p[:, at.OVERTURN]).any() or (p[:, at.RATIO] > 1.0).any():
        raise AnalyticInputError("sweep: |theta0_rad| below the overturning limit and ratios up to 1 are wanted.")
    moving = fxs[:, at.KIND] != at.NONE
    if (fxs[moving, at.OMEGA] < 0.0).any():
        raise AnalyticInputError("sweep: positive frequencies are wanted.")


def _work(arrays: Any, out: Any, size: int, threads: int, progress: Progress | bool) -> None:
    """Share the rows among threads; each row's result depends on nothing but the row."""
    step = max(1, -(-size // (threads * CHUNKS_PER_THREAD)))
    pieces = [(start, min(start + step, size)) for start in range(0, size, step)]
    if progress is True:
        _with_bar(arrays, out, pieces, threads, size)
        return
    told = progress if callable(progress) else _silent
    _run_pieces(arrays, out, pieces, threads, lambda done: told(done, size))


def _one_piece(rows: Rows, out: tuple[Any, ...], start: int, stop: int) -> None:
    run_rows(np.zeros(1, at.RUN), rows.p, rows.f, rows.address, rows.stride, rows.length, start, stop, *out)


def _silent(done: int, total: int) -> None:
    return


def _with_bar(arrays: Any, out: Any, pieces: list[tuple[int, int]], threads: int, size: int) -> None:
    from rich.progress import Progress as Bar

    with Bar() as bar:
        line = bar.add_task("runs", total=size)
        _run_pieces(arrays, out, pieces, threads, lambda done: bar.update(line, completed=done))


def _run_pieces(
    arrays: Any, out: Any, pieces: list[tuple[int, int]], threads: int, told: Callable[[int], None]
) -> None:
    with ThreadPoolExecutor(threads) as pool:
        waiting = {pool.submit(partial(_one_piece, arrays, out, start, stop)): stop - start for start, stop in pieces}
        done = 0
        for future in as_completed(waiting):
            future.result()
            done += waiting[future]
            told(done)
