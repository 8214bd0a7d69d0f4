"""Every known fault on every scene: `python -m tests.measures.mutants [SCENE.toml...] [--random N]` prints a row for each.

The command fails when a fault whose effect before the horizon exceeds three times the uncertainty is called anything but
*differ: model*. Random scenes are statues of random corners, height and inertia, with and without a pedestal.
"""

import argparse
import json
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import numpy as np

from analytic.block import GRAVITY_M_S2
from analytic.excitation import Harmonic
from harness import Run, load_scene, simulate
from harness.model.scene import BaseExcitation, Contact, Form, Pedestal, Scene, Statue
from tests.measures.faults import expose

DURATION_S: Final = 5.0


def random_scenes(count: int, seed: int = 0) -> Iterator[Scene]:
    """Seeded scenes: slenderness 0.05–0.45 rad on either side, harmonic motion above the weaker side's uplift."""
    stream = np.random.default_rng(seed)
    for number in range(count):
        height = float(stream.uniform(0.3, 1.5))
        left, right = (height * float(np.tan(alpha)) for alpha in stream.uniform(0.05, 0.45, 2))
        mass = float(stream.uniform(50.0, 2000.0))
        inertia = mass * float(stream.uniform(0.2, 0.45)) * (height**2 + (0.5 * (left + right)) ** 2)
        statue = _statue(mass, height, left, right, inertia)
        wide = 1.6 * (left + right)
        pedestal = Pedestal(float(stream.uniform(0.2, 1.0)) * mass, wide, 1.0, 0.2) if number % 2 else None
        kinetic = float(stream.uniform(0.1, 0.5))
        contact = Contact(min(1.2 * kinetic, 0.6), kinetic, 2.0, None)
        needed = GRAVITY_M_S2 * min(left, right) / height
        motion = Harmonic(needed * float(stream.uniform(1.1, 2.5)), float(stream.uniform(1.0, 5.0)))
        yield Scene(
            f"random {number}", DURATION_S, GRAVITY_M_S2, Form(), statue, pedestal, contact, BaseExcitation(x=motion)
        )


def _statue(mass_kg: float, height_m: float, left_m: float, right_m: float, inertia_kg_m2: float) -> Statue:
    top, half = 2.0 * height_m, 0.4
    section = np.array([[-left_m, 0.0], [right_m, 0.0], [right_m, top], [-left_m, top]])
    corners = [[-left_m, -half, 0.0], [right_m, -half, 0.0], [right_m, half, 0.0], [-left_m, half, 0.0]]
    tensor = np.diag([inertia_kg_m2] * 3)
    return Statue(mass_kg, height_m, left_m, right_m, inertia_kg_m2, top, 0.8, section, np.array(corners), tensor)


def shipped(folder: Path) -> list[Path]:
    """The scene files of a folder that describe one scene (studies name others) that the planar model computes."""
    texts = {path: path.read_text(encoding="utf-8") for path in sorted(folder.glob("*.toml"))}
    return [path for path, text in texts.items() if "\n[statue]" in text and "\nposition_m" not in text]


def main(arguments: list[str] | None = None) -> int:
    """Print a row for each fault and scene and the sums; 1 where one was missed."""
    parser = argparse.ArgumentParser()
    parser.add_argument("scenes", nargs="*", type=Path)
    parser.add_argument("--random", type=int, default=100)
    parser.add_argument("--engine", default="analytic", help="the engine that computes the faulty scenes")
    asked = parser.parse_args(arguments)
    scenes = [load_scene(path) for path in asked.scenes or shipped(Path("scenes"))]
    scenes += random_scenes(asked.random)

    def exact(scene: Scene) -> Run:
        return simulate(scene, "analytic")

    def tested(scene: Scene) -> Run:
        return simulate(scene, asked.engine)

    counts: Counter[str] = Counter()
    for scene in scenes:
        for finding in expose(scene, exact, tested):
            counts["faults"] += 1
            counts["must be found"] += finding.must
            counts["missed"] += not finding.held
            counts["only after the domain was left"] += finding.left_domain
            print(json.dumps({"scene": scene.title} | finding.as_dict()))
    print(json.dumps({"scenes": len(scenes), **counts}))
    return 1 if counts["missed"] else 0


if __name__ == "__main__":
    sys.exit(main())
