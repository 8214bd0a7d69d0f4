"""Contact engines held to the exact rigid body on random scenes in three dimensions (`seeded_scenes.space_scene`).

`python -m tests.measures.space_scenes [COUNT FIRST] [--out FILE]` computes COUNT seeds on one core, keeps a line of JSON for each
scene (a call that was interrupted goes on where it stopped) and renews the tables of docs/measured/space_scenes.md.
"""

import math
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from functools import partial
from typing import Final

import numpy as np

from harness import Outcome, Run, RunOptions, Scene, engines, simulate
from harness.questions.validate.tosses import poses
from harness.runs.runner import Crash, Hung, LocalPool, Pool
from tests.measures.coverage import Statement, statement
from tests.measures.pages import renew, table
from tests.measures.seeded_rows import command_line, measured, seeds_of
from tests.measures.seeded_scenes import space_scene

NAMES: Final = ("pybullet",)
EXACT: Final = "spatial"
SCENES: Final = 200
FIRST_SEED: Final = 770_000
MOST_S: Final = 60.0
"""Wall time after which a scene is given up: in some the exact model slides at the edge of sticking for very long."""
STEP_S: Final = 2.5e-4
IMPACTS: Final = 3
"""Attitudes are compared at that step until after so many impacts, up to the fourth."""
SLID: Final = 1e-6
"""A vertex has slid where it took more than this share of m g h."""
MODULE: Final = "tests.measures.space_scenes"


@dataclass(frozen=True)
class SpaceRow:
    """One scene: the exact run's outcome, until when it holds, whether a vertex slid, the engines' statements against it.

    `attitude_rad` by engine is the largest angle between its rotation at `STEP_S` and the exact one over the first impacts, of
    which there were `impacts`.
    """

    seed: int
    outcome: str
    end_s: float = 0.0
    slid: bool = False
    impacts: int = 0
    engines: dict[str, Statement] | None = None
    attitude_rad: dict[str, float] | None = None


def row_of(seed: int) -> SpaceRow:
    """One scene computed by all."""
    scene = space_scene(seed)
    exact = simulate(scene, EXACT)
    if exact.history is None:
        return SpaceRow(seed, exact.outcome.value)
    lost_j = float(exact.validity["energy_lost_by_sliding_j"] or 0.0)
    height_m = scene.statue.centroid_height_m
    slid = lost_j > SLID * scene.statue.mass_kg * scene.gravity_m_s2 * height_m
    stated, apart = {}, {}
    for name in NAMES:
        engine = engines.load(name)
        if engine.missing() is not None:
            continue
        run = simulate(scene, name)
        both_s = min(run.bounded_until_s, exact.bounded_until_s)
        stated[name] = statement(replace(run, reliable_until_s=both_s), exact)
        fixed = engine.simulate(scene, engine.settings_for_dt(scene, STEP_S), RunOptions())
        apart[name] = attitude_rad(scene, fixed, exact)
    return SpaceRow(seed, exact.outcome.value, exact.bounded_until_s, slid, len(exact.impact_times_s), stated, apart)


def attitude_rad(scene: Scene, run: Run, exact: Run) -> float:
    """Largest angle between two runs' rotations while the exact one holds, up to its fourth impact; infinite without them."""
    if run.history is None or exact.history is None:
        return math.inf
    times = exact.history.t_s
    until_s = min(exact.bounded_until_s, run.end_s, *exact.impact_times_s[IMPACTS : IMPACTS + 1])
    turns, seen = (poses(scene.statue, item)[0].reshape(-1, 9) for item in (run.history, exact.history))
    between = np.column_stack([np.interp(times, run.history.t_s, column) for column in turns.T])
    # |A − B| of two rotations an angle φ apart is √8 sin(φ/2).
    chord = np.linalg.norm(between - seen, axis=1)[times <= until_s] / math.sqrt(8.0)
    return float(2.0 * np.arcsin(np.minimum(np.max(chord, initial=0.0), 1.0)))


def limited(pool: Pool, seed: int) -> SpaceRow:
    """One scene computed by a worker; one that takes too long or ends it is a row that says so."""
    rows: list[SpaceRow] = []

    def finished(_: int, answer: object) -> None:
        if isinstance(answer, Crash):
            answer = SpaceRow(seed, (Outcome.TIMED_OUT if isinstance(answer, Hung) else Outcome.CRASHED).value)
        if not isinstance(answer, SpaceRow):
            raise TypeError(f"seed {seed}: {answer!r}")
        rows.append(answer)

    pool.run(row_of, [seed], finished)
    return rows[0]


def tables(rows: Sequence[SpaceRow]) -> str:
    """What was held to the exact model, then how often statements hold and how far attitudes are apart."""
    known = [row for row in rows if row.engines]
    ended = {name: sum(row.outcome == name for row in rows) for name in sorted({row.outcome for row in rows})}
    said = ", ".join(f"{count} `{name}`" for name, count in ended.items())
    lines = []
    for name in NAMES:
        for slid, what in ((False, "every vertex sticks"), (True, "a vertex slides")):
            mine = [row for row in known if row.slid == slid and row.engines and name in row.engines]
            if not mine:
                continue
            stated = [row.engines[name] for row in mine if row.engines]
            held = sum(item.rotation_holds for item in stated)
            three = [row.attitude_rad[name] for row in mine if row.attitude_rad and row.impacts >= IMPACTS]
            share = f"{held} ({100.0 * held / len(mine):.3g} %)"
            lines.append([f"`{name}`", what, str(len(mine)), share, *_spread(three), str(len(three))])
    heads = ["engine", "scenes in which", "scenes", "rotation held", "attitude, median", "9 of 10 below", "largest"]
    return f"The exact runs end as {said}.\n\n{table([*heads, 'of scenes with three impacts'], lines)}"


def _spread(values: Sequence[float]) -> list[str]:
    if not values:
        return ["", "", ""]
    return [f"{value:.1e}" for value in np.quantile(values, [0.5, 0.9, 1.0])]


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure, print the table and write it into the page."""
    given = command_line(MODULE, __doc__, SCENES, FIRST_SEED).parse_args(arguments)
    seeds = seeds_of(given)
    with closing(LocalPool(1, MOST_S, tries=1)) as pool:
        rows = measured(given.out, SpaceRow, [(seed,) for seed in seeds], partial(limited, pool))
    sentence = (
        f"Seeds {seeds[0]} to {seeds[-1]} of `space_scene`, target 1e-3 rad; attitudes at {1e3 * STEP_S:g} ms, rad."
    )
    renew("measured/space_scenes.md", MODULE, f"{sentence} {tables(rows)}")


if __name__ == "__main__":
    # Its rows come from a worker, which knows them by the name of this module.
    from tests.measures import space_scenes

    space_scenes.main()
