"""What each level of refinement errs by: `expected_error_rad` states the largest of its errors and a finer level's, and more
on the floor (docs/measured/pybullet_levels.md).

`python -m tests.measures.pybullet_levels` prints the errors on every scene and renews the page's table: the surveyed statue's
four cases on the floor and on its pedestal, with one coefficient of friction, with two, and with a ratio imposed, and the bench's
standard set. Errors are of the rotation over the whole run, against the analytic model or, where it is not exact, `spatial` on
the floor and a third of the finest level's step on a pedestal.
"""

import sys
from collections.abc import Iterator
from typing import Final

from harness.comparison.scores import errors
from harness.engines import load
from harness.model import SKIPS, Run, RunOptions, Scene
from harness.questions.bench.standard_scenes import resolved, standard_set
from tests.measures.contact_engines import KINDS, PAPER, paper_scene
from tests.measures.pages import renew, table

HALF: Final = RunOptions()
WHOLE: Final = RunOptions(skips=frozenset(SKIPS) - {"mirror"})
REFERENCE_STEP_DIVISOR: Final = 3.0
"""How many times finer than the finest level's the step of a scan's reference is."""


def scenes() -> Iterator[tuple[str, Scene, bool]]:
    """Each scene's name, the scene, and whether the analytic model is exact for it."""
    for amplitude_g, frequency_hz in PAPER:
        for kind, pedestal, static, ratio in KINDS:
            scene = paper_scene(amplitude_g, frequency_hz, pedestal=pedestal, static=static, ratio=ratio)
            yield f"{scene.title}, {kind}", scene, True
    for item, scene in resolved(standard_set())[0]:
        yield item.name, scene, item.reference == "analytic"


def reference(scene: Scene, exact: bool) -> Run:
    """The finest run of the model that is exact, or one of pybullet's own with a finer step than any level's."""
    engine = load("analytic" if exact else "spatial" if scene.pedestal is None else "pybullet")
    settings = engine.refinement_levels(scene)[-1]
    if engine.name == "pybullet":
        settings = engine.settings_for_dt(scene, settings.dt_s / REFERENCE_STEP_DIVISOR)
    return engine.simulate(scene, settings, HALF)


def errors_rad(scene: Scene, truth: Run) -> list[float]:
    """The larger error of half and whole of a scene on every level, rad."""
    engine = load("pybullet")
    return [
        max(errors(engine.simulate(scene, level, options), truth)[0] for options in (HALF, WHOLE))
        for level in engine.refinement_levels(scene)
    ]


def kind(scene: Scene) -> str:
    """Which of the table's rows a scene belongs to."""
    body = "planar" if scene.planar else "a scan"
    return f"{body}, on {'the floor' if scene.pedestal is None else 'a pedestal'}"


def main() -> None:
    """Print each scene's errors as they are measured and what each kind of scene states; renew the table of the largest."""
    largest: dict[str, list[float]] = {}
    stated: dict[str, list[float]] = {}
    for name, scene, exact in scenes():
        errors, of = errors_rad(scene, reference(scene, exact)), kind(scene)
        largest[of] = [max(pair) for pair in zip(errors, largest.get(of, errors), strict=True)]
        stated[of] = [level.expected_error_rad for level in load("pybullet").refinement_levels(scene)]
        sys.stdout.write(" ".join(f"{value:8.1e}" for value in errors) + f"  {name}\n")
        sys.stdout.flush()
    for of, values in stated.items():
        sys.stdout.write(" ".join(f"{value:8.1e}" for value in values) + f"  {of}: stated\n")
    steps = [f"{1e3 * level.dt_s:g} ms" for level in load("pybullet").refinement_levels(paper_scene(*PAPER[0]))]
    rows = [[of, *(f"{value:.1e}" for value in values)] for of, values in largest.items()]
    renew("measured/pybullet_levels.md", "tests.measures.pybullet_levels", table(["", *steps[:-1], "residual 0"], rows))


if __name__ == "__main__":
    main()
