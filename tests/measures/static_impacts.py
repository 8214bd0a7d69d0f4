"""Unmodified engines against the model, by the coefficient that acts as an impact breaks the pedestal loose.

`python -m tests.measures.static_impacts` renews docs/measured/static_impacts.md: on the paper's pedestal at 0.334 and 0.429 g, 2
and 3 Hz, the largest difference of rotation from the model with the kinetic and with the static coefficient at impacts.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Final, Literal

from harness import Run, RunOptions, Scene
from harness.comparison.scores import errors
from harness.engines import load
from tests.measures.pages import renew, table
from tests.scenes_for_tests import paestum

MODULE: Final = "tests.measures.static_impacts"
CASES: Final = ((0.334, 2.0), (0.334, 3.0), (0.429, 2.0), (0.429, 3.0))
STEPS_S: Final = {"pymunk:plain": 1e-5, "pybullet:plain": 5e-5}
UNTIL_S: Final = 1.5
Acts = Literal["kinetic", "static"]


def apart_rad(
    name: str, amplitude_g: float, frequency_hz: float, step_s: float, until_s: float = UNTIL_S
) -> Mapping[Acts, float]:
    """Largest differences of a plain engine's rotation, rad, from the model by each coefficient, in one case."""
    scene = paestum(amplitude_g, frequency_hz, mu=(0.20, 0.15), duration_s=until_s)
    engine, acts = load(name), ("kinetic", "static")
    plain = engine.simulate(scene, engine.settings_for_dt(scene, step_s), RunOptions())
    return {each: errors(plain, _model(scene, each), until_s)[0] for each in acts}


def _model(scene: Scene, acts: Acts) -> Run:
    engine, on = load("analytic"), replace(scene, contact=replace(scene.contact, floor_impact=acts))
    return engine.simulate(on, engine.refinement_levels(on)[-1], RunOptions())


def main() -> None:
    """Measure and renew the page."""
    rows = []
    for amplitude_g, frequency_hz in CASES:
        measured = [apart_rad(name, amplitude_g, frequency_hz, step_s) for name, step_s in STEPS_S.items()]
        apart = [f"{each[acts]:.1e} rad" for each in measured for acts in ("kinetic", "static")]
        rows.append([f"{amplitude_g} g, {frequency_hz:g} Hz", *apart])
    engines = [f"`{name}` at {1e3 * step_s:g} ms" for name, step_s in STEPS_S.items()]
    head = ["case", *(f"{engine}, {acts}" for engine in engines for acts in ("kinetic", "static"))]
    renew("measured/static_impacts.md", MODULE, table(head, rows))


if __name__ == "__main__":
    main()
