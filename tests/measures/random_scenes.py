"""Random scenes of three generators: how often stated uncertainties hold, and whether finer runs refute any "differ: model".

`python -m tests.measures.random_scenes [COUNT FIRST] [--out FILE]` computes COUNT seeds of each generator on one core, keeps a
line of JSON for each scene (a call that was interrupted goes on where it stopped) and renews
docs/measured/random_scenes.md.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from harness import Run, Verdict, compare, engines, run_scene, simulate
from tests.measures.coverage import Statement, statement, truth_of
from tests.measures.pages import renew, table
from tests.measures.seeded_rows import command_line, measured, seeds_of
from tests.measures.seeded_scenes import GENERATORS

NAMES: Final = ("analytic", "pymunk", "pybullet")
SCENES: Final = 100
FIRST_SEED: Final = 710_000
"""Seeds from here on were used for nothing else."""
FINEST_S: Final = 1e-5
"""Step of a run that stands for the truth, at least."""
MODULE: Final = "tests.measures.random_scenes"


@dataclass(frozen=True)
class Judged:
    """A pair's verdict; whether finer runs refute a difference of models (None for another verdict)."""

    verdict: str
    sentence: str
    refuted: bool | None


@dataclass(frozen=True)
class SceneRow:
    """One scene of a generator."""

    generator: str
    seed: int
    engines: dict[str, Statement]
    pairs: dict[str, Judged]


def row_of(generator: str, seed: int) -> SceneRow:
    """One scene: of each engine what it stated and what it was off by, of each pair the verdict and whether it is refuted."""
    scene = GENERATORS[generator](seed)
    names = [name for name in NAMES if engines.load(name).missing() is None]

    def truth(run: Run, until_s: float) -> Run:
        return truth_of(engines.load(run.engine), scene, run, until_s, FINEST_S)

    stated = {name: simulate(scene, name) for name in names}
    statements = {name: statement(run, truth(run, run.bounded_until_s)) for name, run in stated.items()}
    result = run_scene(scene, names)
    known = result.horizons.get("analytic")
    pairs = {}
    for pair, scores in result.scores.items():
        refuted = None
        if scores.verdict is Verdict.MODEL:
            both = [result.runs[name] for name in (scores.a, scores.b)]
            until_s = min(run.bounded_until_s for run in both)
            one, other = (replace(run, history=truth(run, until_s).history) for run in both)
            horizons_s = [known.intrinsic_s if known and run.engine == "analytic" else None for run in both]
            again = compare(one, other, scene=scene, horizons_s=(horizons_s[0], horizons_s[1]))
            refuted = again.verdict is not Verdict.MODEL
        pairs[pair] = Judged(scores.verdict.value, scores.findings[0].code, refuted)
    return SceneRow(generator, seed, statements, pairs)


def tables(rows: Sequence[SceneRow]) -> str:
    """Both tables in Markdown: statements by generator and engine, verdicts by generator."""
    heads = ["scenes", "engine", "scenes counted", "rotation held", "slip held"]
    heads += ["held for, of the run's length", "runs for a scene"]
    by_engine = []
    for generator in GENERATORS:
        for name in NAMES:
            items = [row.engines[name] for row in rows if row.generator == generator and name in row.engines]
            if items:
                by_engine.append([generator, f"`{name}`", *counted(items)])
    by_pair = []
    for generator in GENERATORS:
        pairs = [pair for row in rows if row.generator == generator for pair in row.pairs.values()]
        counts = Counter(pair.verdict for pair in pairs)
        numbers = [len(pairs), *(counts[verdict.value] for verdict in Verdict), sum(bool(p.refuted) for p in pairs)]
        by_pair.append([generator, *map(str, numbers)])
    verdicts = ["scenes", "pairs", *(verdict.value for verdict in Verdict), "of these models refuted"]
    return f"{table(heads, by_engine)}\n\n{table(verdicts, by_pair)}"


def counted(items: Sequence[Statement]) -> list[str]:
    """Cells of a table: how many statements there are, and how many held, for how long, in how many runs."""
    held = [sum(item.rotation_holds for item in items), sum(item.slip_holds for item in items)]
    share = np.mean([item.share for item in items])
    shares = [f"{count} ({100.0 * count / len(items):.3g} %)" for count in held]
    return [str(len(items)), *shares, f"{100.0 * share:.3g} %", f"{np.mean([item.runs for item in items]):.2g}"]


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure, print both tables and write them into the page."""
    given = command_line(MODULE, __doc__, SCENES, FIRST_SEED).parse_args(arguments)
    seeds = seeds_of(given)
    rows = measured(given.out, SceneRow, [(each, seed) for seed in seeds for each in GENERATORS], row_of)
    sentence = f"Seeds {seeds[0]} to {seeds[-1]} of each generator, target 1e-3 rad:"
    renew("measured/random_scenes.md", MODULE, f"{sentence}\n\n{tables(rows)}")


if __name__ == "__main__":
    main()
