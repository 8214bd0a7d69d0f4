"""Random scenes of three generators: how often stated uncertainties hold, and whether finer runs refute any "differ: model".

`python -m harness.bench.random_scenes [COUNT FIRST] [--out FILE]` computes COUNT seeds of each generator on one core, keeps a
line of JSON for each scene (a call that was interrupted goes on where it stopped) and renews the tables of docs/coverage.md.
"""

from __future__ import annotations

import json
import math
import sys
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import numpy as np

from harness import engines
from harness.accuracy.simulation import simulate
from harness.bench.coverage import FINER, random_scene, wide_scene
from harness.bench.tipping import tipping_scene
from harness.campaign.parts import source
from harness.comparison.comparator import compare
from harness.model.options import RunOptions
from harness.model.run import Run
from harness.model.scene import Scene
from harness.records.scores import Verdict
from harness.scene_run.scene_run import run_scene

GENERATORS: Final[Mapping[str, Callable[[int], Scene]]] = {
    "random": random_scene,
    "wide": wide_scene,
    "tipping": tipping_scene,
}
NAMES: Final = ("analytic", "pymunk", "pybullet")
SCENES: Final = 100
FIRST_SEED: Final = 710_000
"""Seeds from here on were used for nothing else."""
FINEST_S: Final = 1e-5
"""Step of a run that stands for the truth, at least."""
PAGE: Final = Path(__file__).parents[2] / "docs" / "coverage.md"
BEGIN, END = "<!-- begin: python -m harness.bench.random_scenes -->", "<!-- end -->"

Row = dict[str, Any]


def row_of(generator: str, seed: int) -> Row:
    """One scene: of each engine what it stated and what it was off by, of each pair the verdict and whether it is refuted."""
    scene = GENERATORS[generator](seed)
    names = [name for name in NAMES if engines.load(name).missing() is None]
    stated = {name: simulate(scene, name) for name in names}
    found: Row = {"generator": generator, "seed": seed}
    found["engines"] = {name: _held(run, _finer(scene, run, _until_s(run))) for name, run in stated.items()}
    result = run_scene(scene, names)
    pairs = found["pairs"] = {}
    for pair, scores in result.scores.items():
        refuted = None
        if scores.verdict is Verdict.MODEL:
            both = [result.runs[name] for name in (scores.a, scores.b)]
            until_s = min(_until_s(run) for run in both)
            truths = [replace(run, history=_finer(scene, run, until_s).history) for run in both]
            known = result.horizons.get("analytic")
            horizons_s = tuple(known.intrinsic_s if known and run.engine == "analytic" else None for run in both)
            again = compare(truths[0], truths[1], scene=scene, horizons_s=(horizons_s[0], horizons_s[1]))
            refuted = again.verdict is not Verdict.MODEL
        pairs[pair] = {"verdict": scores.verdict.value, "sentence": scores.verdict_sentence, "refuted": refuted}
    return found


def _until_s(run: Run) -> float:
    return run.end_s if run.reliable_until_s is None else run.reliable_until_s


def _finer(scene: Scene, run: Run, until_s: float) -> Run:
    """A much finer run of the same engine, up to a time; of one that certifies itself, its finest."""
    engine = engines.load(run.engine)
    if engine.capabilities.certifies:
        return engine.simulate(scene, engine.refinement_levels(scene)[-1], RunOptions())
    dt_s = max(float(run.settings["dt_s"]) / FINER, FINEST_S)
    return engine.simulate(scene, engine.settings_for_dt(scene, dt_s), RunOptions(stop=lambda t_s, _: t_s > until_s))


def _held(run: Run, truth: Run) -> Row:
    """What a run stated, what it was off by while that is said to hold, and for how much of its length."""
    until_s = _until_s(run)
    rotation = slip = math.inf
    if run.history is not None and truth.history is not None:
        times = run.history.t_s[run.history.t_s <= min(until_s, truth.end_s)]
        rotation = float(np.max(np.abs(run.history.at(times) - truth.history.at(times)), initial=0.0))
        slip = float(np.max(np.abs(run.history.slip_at(times) - truth.history.slip_at(times)), initial=0.0))
    return {
        "outcome": run.outcome.value,
        "dt_s": run.settings.get("dt_s"),
        "runs": run.work.get("runs", 1),
        "steps": run.work.get("steps_of_all_runs", run.steps),
        "stated_rad": run.numerical_uncertainty_rad,
        "stated_m": run.slip_uncertainty_m,
        "error_rad": rotation,
        "error_m": slip,
        "share": until_s / run.end_s if run.end_s > 0.0 else 1.0,
        "layer_left_s": run.validity.get("layer_left_s"),
        "rotation_holds": rotation <= (run.numerical_uncertainty_rad or 0.0),
        "slip_holds": slip <= (run.slip_uncertainty_m or 0.0),
    }


def measured(path: Path, seeds: Sequence[int]) -> list[Row]:
    """The rows of all generators, those of `path` that the code of now computed and those that are not there yet."""
    code = source()
    rows = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()] if path.exists() else []
    rows = [row for row in rows if row["source"] == code]
    done = {(row["generator"], row["seed"]) for row in rows}
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("a", encoding="utf-8") as stream:
        for seed in seeds:
            for generator in GENERATORS:
                if (generator, seed) in done:
                    continue
                rows.append(row_of(generator, seed) | {"source": code})
                stream.write(json.dumps(rows[-1]) + "\n")
                stream.flush()
    return [row for row in rows if row["seed"] in seeds]


def tables(rows: Sequence[Row]) -> str:
    """Both tables in Markdown: statements by generator and engine, verdicts by generator."""
    lines = [
        "| scenes | engine | scenes counted | rotation held | slip held | held for, of the run's length | runs for a scene |",
        "|---|---|---|---|---|---|---|",
    ]
    for generator in GENERATORS:
        for name in NAMES:
            items = [row["engines"][name] for row in rows if row["generator"] == generator and name in row["engines"]]
            if items:
                lines.append(_statement(generator, name, items))
    lines += ["", f"| scenes | pairs | {' | '.join(verdict.value for verdict in Verdict)} | of these models refuted |"]
    lines.append("|---" * (len(Verdict) + 3) + "|")
    for generator in GENERATORS:
        pairs = [pair for row in rows if row["generator"] == generator for pair in row["pairs"].values()]
        counts = Counter(pair["verdict"] for pair in pairs)
        numbers = [len(pairs), *(counts[verdict.value] for verdict in Verdict), sum(bool(p["refuted"]) for p in pairs)]
        lines.append(f"| {generator} | {' | '.join(str(number) for number in numbers)} |")
    return "\n".join(lines)


def _statement(generator: str, name: str, items: Sequence[Row]) -> str:
    held = [sum(item[key] for item in items) for key in ("rotation_holds", "slip_holds")]
    shares = " | ".join(f"{count} ({100.0 * count / len(items):.3g} %)" for count in held)
    share = np.mean([item["share"] for item in items])
    runs = np.mean([item["runs"] for item in items])
    return f"| {generator} | `{name}` | {len(items)} | {shares} | {100.0 * share:.3g} % | {runs:.2g} |"


def renewed(page: str, table: str, count: int, first: int) -> str:
    """The page with what stands between its marks replaced. Raises `ValueError` for a page without them."""
    before, _, rest = page.partition(BEGIN)
    _, found, after = rest.partition(END)
    if not found:
        raise ValueError(f"{PAGE.name} has no marks {BEGIN} and {END}")
    told = f"Seeds {first} to {first + count - 1} of each generator, target 1e-3 rad:"
    return f"{before}{BEGIN}\n{told}\n\n{table}\n{END}{after}"


def main(arguments: Sequence[str]) -> None:
    """Measure, print both tables and write them into the page."""
    given = list(arguments)
    path = Path("out") / "random_scenes.jsonl"
    if "--out" in given:
        at = given.index("--out")
        path = Path(given[at + 1])
        del given[at : at + 2]
    count, first = (int(item) for item in given) if given else (SCENES, FIRST_SEED)
    table = tables(measured(path, range(first, first + count)))
    sys.stdout.write(table + "\n")
    PAGE.write_text(renewed(PAGE.read_text(encoding="utf-8"), table, count, first), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
