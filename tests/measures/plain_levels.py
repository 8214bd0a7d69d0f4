"""Plain and event-located engines side by side: error against processor time, over the paper's cases.

`python -m tests.measures.plain_levels` renews docs/measured/plain_levels.md: for each engine, step and kind of
scene the largest error of the rotation against the analytic model in the first second, and the processor time of a second.
"""

import time
from collections.abc import Iterator
from typing import Final

from harness import Run, RunOptions, Scene, engines
from harness.comparison.scores import errors
from harness.engines.base import Engine
from harness.records.run import PLAIN
from tests.measures.contact_engines import PAPER, analytic_run, paper_scene
from tests.measures.pages import renew, table

KINDS: Final = {"no pedestal": (False, 0.15), "pedestal": (True, 0.15), "two coefficients": (True, 0.20)}
"""Kinds of scene: with a pedestal, its static friction beside a kinetic one of 0.15."""
STEPS_S: Final = (1e-3, 2.5e-4)
NAMES: Final = ("pymunk", "pybullet")
MODULE: Final = "tests.measures.plain_levels"


def rows() -> Iterator[list[str]]:
    """Cells of the table: engine, step, and for each kind the largest error with the processor time."""
    cases = {
        kind: [paper_scene(a, f, pedestal=pedestal, static=static) for a, f in PAPER]
        for kind, (pedestal, static) in KINDS.items()
    }
    exact = {kind: [analytic_run(scene) for scene in scenes] for kind, scenes in cases.items()}
    for name in (each + kind for each in NAMES for kind in ("", PLAIN)):
        engine = engines.load(name)
        if engine.missing() is not None:
            continue
        # What first runs load, and the first that falls, is none of a second's time.
        for scenes in cases.values():
            _runs(engine, scenes, STEPS_S[0])
        for dt_s in STEPS_S:
            cells = [_cell(engine, cases[kind], exact[kind], dt_s) for kind in KINDS]
            yield [f"`{name}`", f"{1e3 * dt_s:g} ms", *cells]


def _runs(engine: Engine, scenes: list[Scene], dt_s: float) -> list[Run]:
    return [engine.simulate(scene, engine.settings_for_dt(scene, dt_s), RunOptions()) for scene in scenes]


def _cell(engine: Engine, scenes: list[Scene], exact: list[Run], dt_s: float) -> str:
    if not engine.capabilities.pedestal and scenes[0].pedestal is not None:
        return "no pedestal"
    begin = time.process_time()
    runs = _runs(engine, scenes, dt_s)
    spent_s = (time.process_time() - begin) / sum(run.end_s for run in runs)
    worst = max(errors(model, run)[0] for model, run in zip(exact, runs, strict=True))
    return f"{worst:.1e} rad, {spent_s:.2g} s"


def main() -> None:
    """Measure, print the table and write it into the page."""
    heads = ["engine", "step", *(f"{kind}: largest error, time of a second" for kind in KINDS)]
    renew("measured/plain_levels.md", MODULE, table(heads, rows()))


if __name__ == "__main__":
    main()
