"""Are probabilities true? Random scenes, inputs drawn as stated, observed by an unmodified engine: the reliability diagram.

`python -m tests.measures.calibration [COUNT FIRST] [--engine NAME] [--out FILE]` computes COUNT scenes on one core, keeps a line
of JSON for each (a call that was interrupted goes on where it stopped) and renews that
engine's table of docs/measured/calibration.md.

A random scene falls surely or surely not; so each is shaken at the strength at which the model's nominal run begins to fall,
times a factor of its own. Neither knows anything of the engine that observes.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from harness import RunRequest, Scene
from harness.comparison.statistics import FELL, brier, reliability
from harness.questions.assess.assessment import overturns
from harness.questions.assess.probability import draw, model_draws, row, uncertain_inputs, varied
from harness.records.validation import ReliabilityBin
from tests.measures.pages import renew, table
from tests.measures.seeded_rows import command_line, measured, seeds_of
from tests.measures.seeded_scenes import random_scene

SCENES: Final = 420
FIRST_SEED: Final = 770_000
"""Seeds from here on were used for nothing else."""
DRAWS: Final = 4000
"""Draws of the model behind each probability: ± 1.3 % at a half."""
FACTORS: Final = tuple(float(value) for value in np.geomspace(0.25, 8.0, 101))
"""Strengths among which the one is sought at which the nominal run begins to fall: 3.5 % apart."""
SPREAD: Final = 0.2
"""Logarithmic spread of the factor on that strength: twice the assumed uncertainty of a strength, so that all bins are filled."""
LEFT: Final = 0.05
"""Share of the draws that the model may leave undecided (its statue slides, say) for its probability to be one."""
OBSERVER: Final = "pymunk:plain"
MODULE: Final = "tests.measures.calibration"


@dataclass(frozen=True)
class CalibrationRow:
    """One scene: the model's probability, and whether the engine's statue fell."""

    seed: int
    engine: str
    probability: float
    undecided: float
    fell: bool | None


def shaken(seed: int) -> Scene:
    """A random scene at a strength near which its fall is doubtful; one that nothing overturns keeps the strongest."""
    scene = random_scene(seed)
    falls = np.flatnonzero(model_draws(scene, {"motion.scale": np.array(FACTORS)}).overturned)
    strength = FACTORS[int(falls[0])] if falls.size else FACTORS[-1]
    own = math.exp(SPREAD * float(np.random.default_rng([seed, 1]).standard_normal()))
    return varied(scene, {"motion.scale": strength * own})


def row_of(seed: int, engine: str) -> CalibrationRow:
    """One scene: what the model says of its draws, what the engine does in one more."""
    scene = shaken(seed)
    inputs = uncertain_inputs(scene)
    told = model_draws(scene, draw(inputs, DRAWS, seed))
    undecided = 1.0 - float(told.decided.mean())
    # A draw of its own: another seed than those behind the probability.
    true = varied(scene, row(draw(inputs, 1, seed + FIRST_SEED), 0))
    overturned = overturns(RunRequest(true, engine)).record["overturned"]
    fell = None if overturned is None else bool(overturned)
    return CalibrationRow(seed, engine, told.probability, undecided, fell)


def judged(rows: Sequence[CalibrationRow]) -> list[CalibrationRow]:
    """The scenes of which the model has a probability and the engine an outcome."""
    return [item for item in rows if item.fell is not None and item.undecided <= LEFT]


def diagram(rows: Sequence[CalibrationRow]) -> list[ReliabilityBin]:
    """The reliability diagram of the scenes that model and engine decided."""
    known = judged(rows)
    return reliability([item.probability for item in known], [bool(item.fell) for item in known])


def text(rows: Sequence[CalibrationRow]) -> str:
    """The table in Markdown, and a sentence on every bin together."""
    known = judged(rows)
    bins = diagram(rows)
    heads = ["P said", "scenes", "mean P", f"share that {FELL}", "band of true ones, 95 %", "within"]
    lines = [
        [
            f"{item.low:.1f} to {item.high:.1f}",
            str(item.cases),
            f"{item.mean:.3f}",
            f"{item.fell.value:.3f}",
            f"{item.band_low:.3f} to {item.band_high:.3f}",
            "yes" if item.holds else "no",
        ]
        for item in bins
    ]
    seeds = [item.seed for item in rows]
    score = brier([item.probability for item in known], [bool(item.fell) for item in known])
    left = sum(item.undecided > LEFT for item in rows)
    told = (
        f"{len(known)} of {len(rows)}; of {left} the model leaves more than {100.0 * LEFT:g} % of the draws undecided"
    )
    first = f"Seeds {min(seeds)} to {max(seeds)}, observed by `{rows[0].engine}`; judged are {told}:"
    last = f"{sum(item.holds for item in bins)} of {len(bins)} bins lie within their band. Brier's score {score:.3f}."
    return f"{first}\n\n{table(heads, lines)}\n\n{last}"


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure, print the table and write it into the page."""
    words = command_line(MODULE, __doc__, SCENES, FIRST_SEED)
    words.add_argument("--engine", default=OBSERVER, help="whose outcomes are taken for observed")
    given = words.parse_args(arguments)
    wanted = [(seed, given.engine) for seed in seeds_of(given)]
    mark = MODULE if given.engine == OBSERVER else f"{MODULE} --engine {given.engine}"
    renew("measured/calibration.md", mark, text(measured(given.out, CalibrationRow, wanted, row_of)))


if __name__ == "__main__":
    main()
