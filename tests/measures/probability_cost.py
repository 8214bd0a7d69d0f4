"""What probabilities cost: `python -m tests.measures.probability_cost` renews
docs/measured/probability_cost.md (some 90 s of processor time; needs the data folder). Kernels are loaded and every
worker has begun before its clock does.

Processor time is that of this process and its workers; half of it is what two quiet cores need by the clock.
"""

import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Final

from harness import assess, load_scene
from harness.input.tables import read_model
from harness.model import BaseExcitation, Scene
from harness.questions.assess.options import OptionDraws, compare, in_plane, options_of
from harness.questions.assess.probability import (
    RUN_DRAWS,
    assess_models,
    draws_of,
    model_draws,
    uncertain_inputs,
    varied,
)
from harness.questions.study.rocking_spectrum import RING_DOWN_S, SpectrumFile, compute, motions_of
from reports.messages import probability_text
from tests.harness.questions.assess.measure_own_runs import own_runs, scene_of_runs
from tests.measures.pages import renew, table
from tests.scenes_for_tests import SCENES

MODULE: Final = "tests.measures.probability_cost"
RECORD_S: Final = 60.0
RECORD_SCALE: Final = 1.5
"""Of Coalinga on the shipped pedestal scene: some draws fall, most rock to the end."""
OPTIONS: Final = 7
GRID: Final = 200


def shipped() -> Scene:
    """The shipped statue on its pedestal."""
    return load_scene(SCENES / "paestum_pedestal.toml")


def under_a_record() -> Scene:
    """The same under a minute of a record."""
    motion = load_scene(SCENES / "maria.toml").base_excitation.x
    scene = replace(shipped(), base_excitation=BaseExcitation(x=motion), duration_s=RECORD_S)
    return varied(scene, {"motion.scale": RECORD_SCALE})


def spectrum() -> tuple[SpectrumFile, Path]:
    """The shipped rocking spectrum on a grid of 200 × 200, each motion at its own strength."""
    path = SCENES / "rocking_spectrum.toml"
    given = read_model(SpectrumFile, path)
    sides = {name: getattr(given, name).model_copy(update={"count": GRID}) for name in ("size_m", "slenderness")}
    return given.model_copy(update={**sides, "motion": given.motion[:1], "draws": 1, "strength_cov": 0.0}), path


def used_s(task: Callable[[], str]) -> tuple[str, float, float]:
    """What a task says, its processor time with that of its workers, and the clock's."""
    begin = os.times()
    said = task()
    end = os.times()
    return said, sum(end[:4]) - sum(begin[:4]), end.elapsed - begin.elapsed


def of_run(scene: Scene) -> str:
    """The probability beside a run."""
    answer = assess_models(scene)["analytic"]
    p, low, high, open_ = map(
        probability_text, (answer.probability_overturned, answer.low, answer.high, answer.undecided)
    )
    return f"{answer.draws} draws: {p} % ({low} to {high} %), {open_} % undecided"


def of_options() -> str:
    """Seven options with common random numbers."""
    scene = shipped()
    inputs = uncertain_inputs(scene)
    values = draws_of(scene, inputs, RUN_DRAWS, 0)
    own = OptionDraws(model_draws(scene, values))
    options = options_of(scene)[0][:OPTIONS]
    record = compare(options, {}, own, in_plane(scene, options, inputs, values))
    return f"{len(record.options) - 1} options × {record.draws} draws"


def of_engine(name: str) -> str:
    """An engine's own probability, to ± 0.05, against its thousand own runs."""
    answer = assess(scene_of_runs(), [name], more_options=None).record.answers[name]
    truth = own_runs()[name].count("1") / len(own_runs()[name])
    held = "hold" if answer.low <= truth <= answer.high else "do not hold"
    interval = f"{100.0 * answer.low:.1f} to {100.0 * answer.high:.1f} %"
    return f"{interval} by {answer.engine_runs} runs {held} its own thousand, {100.0 * truth:.1f} %"


def of_spectrum() -> str:
    """One record against every size and slenderness."""
    given, path = spectrum()
    motion = motions_of(given, path)
    shares = compute(given, motion).probability
    return f"{shares.shape[0]} × {shares.shape[1]} blocks, {motion[0].end_s + RING_DOWN_S:.0f} s"


def main() -> None:
    """Measure, print the table and write it into the page."""
    assess_models(shipped(), draws=20)
    tasks: list[tuple[str, str, Callable[[], str]]] = [
        ("beside a run, a sine of 10 s", "0.5 s", lambda: of_run(shipped())),
        ("beside a run, a record of 60 s", "3 s", lambda: of_run(under_a_record())),
        ("options", "10 s", of_options),
        ("`assess`, pymunk", "20 s", lambda: of_engine("pymunk")),
        ("`assess`, pybullet", "90 s", lambda: of_engine("pybullet")),
        ("rocking spectrum of one record", "30 s", of_spectrum),
    ]
    lines = []
    for name, wanted, task in tasks:
        said, processor_s, clock_s = used_s(task)
        lines.append([name, wanted, f"{processor_s:.1f} s", f"{0.5 * processor_s:.2g} s", f"{clock_s:.0f} s", said])
    heads = ["", "asked, two cores", "processor time", "half of it", "by the clock of this day", "what came"]
    renew("measured/probability_cost.md", MODULE, table(heads, lines))


if __name__ == "__main__":
    main()
