"""Every known fault on every scene: `python -m tests.measures.mutants [SCENE.toml...] [--random N]` prints a row for each.

The command fails when a fault whose effect before the horizon exceeds three times the uncertainty is called anything but
*differ: model*. Random scenes are those of `random_scene`.
"""

import argparse
import json
import sys
from collections import Counter
from pathlib import Path
from typing import Final

from harness import Run, Scene, load_scene, simulate
from tests.measures.coverage import random_scene
from tests.measures.faults import expose

DURATION_S: Final = 5.0


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
    scenes += [random_scene(seed, DURATION_S) for seed in range(asked.random)]

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
