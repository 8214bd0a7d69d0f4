"""What motions cost: `python -m tests.measures.motion_cost` reads, processes and draws a long record, makes matched motions."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Final

import numpy as np

from harness.input.motions import compatible
from harness.input.motions.inspect import inspect_file
from harness.input.motions.process import bandpass, baseline
from harness.input.motions.readers import read_record
from harness.input.motions.recordfile import displacement_m, velocity_m_s
from harness.input.motions.records import aligned
from harness.input.motions.spec import SpectrumSpec
from harness.input.motions.spectra import DesignSpectrum, design_spectrum
from reports.export.figures import printed, write_picture
from reports.export.motion_figure import WIDE, motion_picture

DURATION_S: Final = 60.0
RATE_HZ: Final = 200.0
REPEATS: Final = 3
LIFE_SAFETY: Final = {"ag_g": 0.334, "S": 1.228, "F0": 2.356, "TB_s": 0.198, "TC_s": 0.593, "TD_s": 2.935}
"""The paper's life-safety spectrum (docs/model.md, section 6)."""


def main() -> None:
    """Print one line for each job: the best and the worst of some repeats, seconds of wall time, and what came out."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "record.csv"
        write_record(path)
        inspect_file(path)  # imports and compiles what is needed once
        report("read, baseline, band-pass, draw: 60 s, 200 Hz, 3 components", lambda: look_at(path, Path(folder)))
    target = design_spectrum(SpectrumSpec(kind="spectrum", code="ntc2008", seed=1, **LIFE_SAFETY))  # type: ignore[arg-type]
    for seed in (1, 2, 3):
        report(f"artificial motion, 25 s, seed {seed}", lambda seed=seed: made(target, seed))  # type: ignore[misc]
    first, again = (compatible.artificial(target, seed=7).accel_m_s2 for _ in range(2))
    print(f"the same seed gives the same bits: {bool(np.array_equal(first, again))}")


def report(what: str, job: Callable[[], str]) -> None:
    """Time a job and print its line."""
    seconds = []
    said = ""
    for _ in range(REPEATS):
        start = time.perf_counter()
        said = job()
        seconds.append(time.perf_counter() - start)
    print(f"{what}: {min(seconds):.2f} to {max(seconds):.2f} s{'; ' if said else ''}{said}", flush=True)


def write_record(path: Path) -> None:
    """A record of three components: noise under an envelope, in m/s²."""
    t = np.arange(int(DURATION_S * RATE_HZ)) / RATE_HZ
    noise = np.random.default_rng(1).standard_normal((3, t.size)) * np.exp(-(((t - 15.0) / 8.0) ** 2))
    table = np.column_stack([t, *noise])
    np.savetxt(path, table, delimiter=",", header="t_s,a_0_ms2,a_90_ms2,a_UP_ms2", comments="", fmt="%.6g")


def look_at(path: Path, folder: Path) -> str:
    """What a user's look at a record costs: read, process each component, draw."""
    for series in aligned(read_record(path)).values():
        bandpass(baseline(series, "linear"), 0.1, 25.0)
    write_picture(printed(motion_picture(inspect_file(path)), WIDE), folder / "motion.png", dpi=150)
    return ""


def made(target: DesignSpectrum, seed: int) -> str:
    """An artificial motion; says how far its spectrum is off and where its double integration ends."""
    match = compatible.artificial(target, seed=seed)
    velocity, displacement = velocity_m_s(match), displacement_m(match)
    off = compatible.misfit(match, target)
    return f"{off:.1%} off, ends at {velocity[-1]:.0e} m/s and {displacement[-1]:.0e} m"


if __name__ == "__main__":
    main()
