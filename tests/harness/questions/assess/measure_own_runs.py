"""A thousand own runs of each contact engine on the shipped pedestal scene:
`python -m tests.harness.questions.assess.measure_own_runs`.

They are the truth that few runs are held to (`test_own_runs.py`), kept in `own_runs.json` beside this file: some 60 s of
processor time for pymunk and 360 s for pybullet. A call that was ended goes on where it stopped.
"""

import json
from pathlib import Path
from typing import Final

from harness import RunRequest, Scene, load_scene
from harness.questions.assess.assessment import overturns
from harness.questions.assess.probability import draw, row, uncertain_inputs, varied

SCENE: Final = Path(__file__).parents[4] / "scenes" / "paestum_pedestal.toml"
KEPT: Final = Path(__file__).parent / "own_runs.json"
ENGINES: Final = ("pymunk", "pybullet")
RUNS: Final = 1000
SEED: Final = 21
"""Another than that of any assessment made here: the truth and the estimate share no draw."""
PIECE: Final = 20
"""Runs between two looks at the file."""


def scene_of_runs() -> Scene:
    """The shipped scene with its coefficient at an impact chosen: what is drawn of it is the friction and the motion alone."""
    return load_scene(SCENE, {"contact.floor_impact": "kinetic"})


def own_runs() -> dict[str, str]:
    """By engine a character for each draw: 1 where the statue fell, 0 where it stood, x where the run failed."""
    fell: dict[str, str] = json.loads(KEPT.read_text(encoding="utf-8"))["fell"] if KEPT.exists() else {}
    return fell


def main() -> None:
    """Run what is missing, and print the share that fell."""
    scene = scene_of_runs()
    values = draw(uncertain_inputs(scene), RUNS, SEED)
    fell = {name: own_runs().get(name, "") for name in ENGINES}
    for name in ENGINES:
        while len(fell[name]) < RUNS:
            for k in range(len(fell[name]), min(len(fell[name]) + PIECE, RUNS)):
                answer = overturns(RunRequest(varied(scene, row(values, k)), name)).record["overturned"]
                fell[name] += "x" if answer is None else str(int(answer))
            KEPT.write_text(
                json.dumps({"scene": SCENE.name, "seed": SEED, "fell": fell}, indent=1) + "\n", encoding="utf-8"
            )
        print(name, fell[name].count("1") / RUNS, fell[name].count("x"))


if __name__ == "__main__":
    main()
