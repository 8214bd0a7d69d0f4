"""Hull against convex parts in pybullet: what they are, cost and change; `python -m tests.measures.pybullet_shapes`.

It prints tables of the generated statues, and the scans of the data folder where it is present.
"""

import math
import sys
import time
from collections.abc import Sequence
from dataclasses import replace
from typing import Final, Literal

import numpy as np
import pybullet

from analytic.block import GRAVITY_M_S2
from harness.engines import load
from harness.engines.pybullet.full import full_shape
from harness.engines.pybullet.pose import prepare
from harness.engines.pybullet.settings import BulletSettings
from harness.engines.pybullet.world import World
from harness.input import paths
from harness.input.mesh_statue import statue_of
from harness.model.run import Run, RunOptions
from harness.model.scene import BaseExcitation, Contact, Form, Initial, Pedestal, Scene
from harness.statics.plan import shape_needed
from meshes import Solid
from tests.measures.exact_shapes import contact_row, shape_row, statues

STEP_S: Final = 1e-3
UNDER_THE_CAP_M: Final = 0.45
BESIDE_M: Final = 0.15
"""How far the pedestal's edge lies beside the base; under the toadstool's cap further, so that the cap can meet it."""
PEDESTAL_KG: Final = 2000.0
PEDESTAL_M: Final = 0.6
THROWN: Final = 1.05
"""Rate over the one that just takes the statue to its balance."""
APART_RAD: Final = 1e-3
STEPS: Final = 1000
BEST_OF: Final = 3
SHAPES_HEAD: Final = (
    "| statue | hull: vertices | parts: number, vertices | made, found again | hull adds: whole, near the edge"
    " | parts add, leave out | stand out near the edge: hull, parts |\n|---|---|---|---|---|---|---|"
)
CONTACT_HEAD: Final = (
    "| statue | meets a wall 0.05 m beside it at: mesh, hull, parts, rad | edge beside the corner"
    " | meets it at: mesh, hull, parts, rad |\n|---|---|---|---|"
)
RUNS_HEAD: Final = (
    "| statue | full shape from | the two part at | with the hull | with parts | a step: feet, hull, parts |\n"
    "|---|---|---|---|---|---|"
)


def beside_m(name: str) -> float:
    """Distance of the pedestal's edge from the base."""
    return UNDER_THE_CAP_M if name.startswith("toadstool") else BESIDE_M


def thrown(solid: Solid, edge_m: float) -> Scene:
    """The statue on a pedestal whose edge lies `edge_m` beside its base, thrown to the right a little past its balance."""
    statue = statue_of(solid)
    slender = statue.slenderness_rad(1)
    arm = math.hypot(statue.corner_right_m, statue.centroid_height_m)
    pivot = statue.inertia_kg_m2 + statue.mass_kg * arm**2
    climb = statue.mass_kg * GRAVITY_M_S2 * arm * (1.0 - math.cos(0.5 * slender))
    width = statue.corner_left_m + statue.corner_right_m + 2.0 * edge_m
    return Scene(
        title="thrown over the pedestal's edge",
        duration_s=4.0,
        gravity_m_s2=GRAVITY_M_S2,
        form=Form(),
        statue=statue,
        pedestal=Pedestal(PEDESTAL_KG, width, statue.depth_m + 2.0 * edge_m, PEDESTAL_M),
        contact=Contact(1.0, 1.0, 1.0),
        base_excitation=BaseExcitation(),
        initial=Initial(0.5 * slender, THROWN * math.sqrt(2.0 * climb / pivot)),
    )


def run_row(name: str, solid: Solid) -> str:
    """A fall over the edge with hull and with parts: what comes of it, when the two part, what a step costs."""
    scene = thrown(solid, beside_m(name))
    hulled, parted = (_run(scene, kind) for kind in ("hull", "parts"))
    costs = ", ".join(f"{step_us(scene, kind):.0f}" for kind in ("feet", "hull", "parts"))
    ends = [f"{run.outcome.value.replace('_', ' ')}, {run.end_s:.2f} s" for run in (hulled, parted)]
    begin = parted.validity["full_shape_from_s"]
    sentence = "never" if begin is None else f"{begin:.3f} s"
    return f"| {name} | {sentence} | {_parting(hulled, parted)} | {ends[0]} | {ends[1]} | {costs} µs |"


def _run(scene: Scene, kind: Literal["hull", "parts"]) -> Run:
    engine = load("pybullet")
    return engine.simulate(scene, replace(_settings(scene), full_shape=kind), RunOptions())


def _settings(scene: Scene) -> BulletSettings:
    settings = load("pybullet").settings_for_dt(scene, STEP_S)
    if not isinstance(settings, BulletSettings):
        raise TypeError(f"pybullet gave settings of another engine: {type(settings).__name__}")
    return settings


def _parting(one: Run, other: Run) -> str:
    """When and at which rotation two runs first differ by `APART_RAD`."""
    if one.history is None or other.history is None:
        raise RuntimeError("pybullet gave no history")
    count = min(len(one.history.t_s), len(other.history.t_s))
    apart = np.abs(one.history.theta_rad[:count] - other.history.theta_rad[:count]) > APART_RAD
    first = int(np.argmax(apart))
    return f"{one.history.t_s[first]:.3f} s, {one.history.theta_rad[first]:.2f} rad" if apart.any() else "never"


def step_us(scene: Scene, kind: Literal["feet", "hull", "parts"]) -> float:
    """Processor time of a bare step at rest on the pedestal, µs, best of several: on feet alone, or with hull or parts too."""
    still = replace(scene, initial=Initial())
    setup = prepare(still)
    bodies = None if kind == "feet" else full_shape(still, kind).turned(still.statue, setup.axes)
    best = math.inf
    with World(_settings(still), setup) as world:
        world.build(still, bodies)
        pybullet.setGravity(0.0, 0.0, -GRAVITY_M_S2, world.client)
        for _ in range(BEST_OF):
            begin = time.process_time()
            for _ in range(STEPS):
                pybullet.stepSimulation(world.client)
            best = min(best, time.process_time() - begin)
    return 1e6 * best / STEPS


def main(names: Sequence[str]) -> None:
    """Print the tables, of the named statues or all."""
    solids = [(name, solid) for name, solid in statues(paths.data_folder() / "meshes") if not names or name in names]
    sys.stdout.write(f"{SHAPES_HEAD}\n")
    for name, solid in solids:
        below_m = shape_needed(thrown(solid, beside_m(name))).below_m
        sys.stdout.write(f"{shape_row(name, solid, below_m)}\n")
    sys.stdout.write(f"\n{CONTACT_HEAD}\n")
    for name, solid in solids:
        sys.stdout.write(f"{contact_row(name, solid, beside_m(name))}\n")
    sys.stdout.write(f"\n{RUNS_HEAD}\n")
    for name, solid in solids:
        sys.stdout.write(f"{run_row(name, solid)}\n")


if __name__ == "__main__":
    main(sys.argv[1:])
