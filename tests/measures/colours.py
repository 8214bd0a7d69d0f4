"""Is a page green where a fall is probable? Random scenes near the strength at which they begin to fall, on each page.

`python -m tests.measures.colours [COUNT FIRST] [--out FILE]` makes the pages of a run and of an assessment of COUNT scenes of
each of two generators on one core, keeps a line of JSON for each (a call that was interrupted goes on where it stopped) and
renews its table of docs/measured/colours.md. Pages of studies, of directions and of comparisons hold no probability: never green.
"""

import math
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from harness import RunRequest, Scene, assess
from harness.comparison.statistics import wilson
from harness.questions.assess.assessment import overturns
from harness.questions.assess.probability import LEVEL, draw, model_draws, row, uncertain_inputs, varied
from harness.questions.scene.scene_run import run_scene, write_result
from reports.pages.assess_page import assess_verdict
from reports.pages.conservator import of_run
from reports.source import SAFE, run_source, run_verdict
from tests.measures.calibration import FACTORS
from tests.measures.pages import renew, table
from tests.measures.seeded_rows import command_line, measured, seeds_of
from tests.measures.seeded_scenes import random_scene, wide_scene
from tests.reports.page_parts import answer

SCENES: Final = 40
FIRST_SEED: Final = 780_000
"""Seeds from here on were used for nothing else."""
GENERATORS: Final = {"random": random_scene, "wide": wide_scene}
DRAWS: Final = 4000
"""Draws that no page has seen."""
OTHER_SEED: Final = 99
WEAKER: Final = 0.25
"""Logarithm by which the strength lies below that at which the nominal run begins to fall, at the median: some per cent fall."""
SPREAD: Final = 0.2
OBSERVED: Final = 3
"""Draws of each scene that unmodified pymunk runs."""
PAGES: Final = ("run", "conservator", "assess")
MODULE: Final = "tests.measures.colours"


@dataclass(frozen=True)
class ColourRow:
    """One scene: which of its pages are green, falls of draws that no page has seen, and of an unmodified engine."""

    generator: str
    seed: int
    green: dict[str, bool]
    fell: int
    undecided: int
    observed: list[bool | None]


def shaken(scene: Scene, seed: int) -> Scene:
    """The scene at a strength at which a few of its draws fall."""
    falls = np.flatnonzero(model_draws(scene, {"motion.scale": np.array(FACTORS)}).overturned)
    own = SPREAD * float(np.random.default_rng([seed, 2]).standard_normal()) - WEAKER
    return varied(scene, {"motion.scale": FACTORS[int(falls[0]) if falls.size else -1] * math.exp(own)})


def row_of(generator: str, seed: int) -> ColourRow:
    """The pages of one scene, read as a visitor sees their colour, and what other draws of it do."""
    scene = shaken(GENERATORS[generator](seed), seed)
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place) / "run"
        write_result(run_scene(scene, ["analytic"], assess=True), folder)
        source = run_source(folder)
        tones = {"run": run_verdict(source).tone, "conservator": answer(of_run(source)).tone}
    assessed = assess(scene, ["analytic"], draws=DRAWS, more_options=None)
    tones["assess"] = assess_verdict(assessed.record).tone
    inputs = uncertain_inputs(scene)
    other = draw(inputs, DRAWS, seed + OTHER_SEED)
    model = model_draws(scene, other)
    runs = (RunRequest(varied(scene, row(other, k)), "pymunk:plain") for k in range(OBSERVED))
    observed = [overturns(item).record["overturned"] for item in runs]
    green = {name: tone == "agree" for name, tone in tones.items()}
    fell, undecided = int(model.overturned.sum()), int((~model.decided).sum())
    return ColourRow(generator, seed, green, fell, undecided, [None if x is None else bool(x) for x in observed])


def dangerous(item: ColourRow) -> bool:
    """Whether the draws that no page has seen show a fall to be more probable than what may be green."""
    share = wilson(item.fell, DRAWS, LEVEL)
    return share is not None and share.low > SAFE


def text(rows: Sequence[ColourRow]) -> str:
    """The table in Markdown."""
    lines = []
    for page in PAGES:
        green = [item for item in rows if item.green[page]]
        seen = [fell for item in green for fell in item.observed if fell is not None]
        most = max((item.fell / DRAWS for item in green), default=0.0)
        wrong = sum(dangerous(item) for item in green)
        lines.append(
            [page, str(len(rows)), str(len(green)), f"{100.0 * most:.1f} %", str(wrong), f"{sum(seen)} of {len(seen)}"]
        )
    heads = [
        "page",
        "scenes",
        "green",
        "most falls of a green one",
        "green above 5 %",
        "falls of pymunk:plain under green",
    ]
    doubtful = sum(dangerous(item) for item in rows)
    first = f"{doubtful} of {len(rows)} scenes fall in more than 5 % of {DRAWS} draws that no page has seen:"
    return f"{first}\n\n{table(heads, lines)}"


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure, print the table and write it into the page."""
    given = command_line(MODULE, __doc__, SCENES, FIRST_SEED).parse_args(arguments)
    wanted = [(generator, seed) for seed in seeds_of(given) for generator in GENERATORS]
    renew("measured/colours.md", MODULE, text(measured(given.out, ColourRow, wanted, row_of)))


if __name__ == "__main__":
    main()
