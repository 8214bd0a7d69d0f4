"""An invented record of an effects study, with its replay and the scan's mesh, for the pages' own tests."""

from dataclasses import replace
from pathlib import Path
from typing import Literal

import harness
from harness.model import Outcome, machine, versions, write_json
from harness.questions.effects3d import answer_of, effects, findings_of, static_rose, turned
from harness.questions.scene.scene_run import run_scene, write_result
from harness.records.base import as_file
from harness.records.effects3d import (
    BASELINE,
    Amplitude,
    AskedRecord,
    Band,
    Departure,
    EffectsRecord,
    EffectsSummary,
    ReplayRecord,
    SearchRecord,
)
from harness.records.scene import SceneRecord
from reports.messages import ENGLISH

SCENE = Path(__file__).parents[2] / "scenes" / "3d_effects_base.toml"
AZIMUTHS = (0.0, 60.0, 180.0, 270.0)
SOLID_G = {0.0: 0.25, 60.0: 0.50, 180.0: 0.22, 270.0: None}
PLANAR_G = {0.0: 0.25, 60.0: 1.0, 180.0: 0.22, 270.0: None}


def effects_record() -> EffectsRecord:
    """Four directions, two engines, one effect."""
    scene = harness.load_scene(SCENE)

    def row(condition: str, engine: str, azimuth: float, peak: float | None) -> Amplitude:
        outcome: Outcome | Literal[""] = "" if peak is None else Outcome.OVERTURNED_RIGHT
        return Amplitude(condition, azimuth, engine, peak, 0.1, outcome, 9)

    rows = [row(BASELINE, "pybullet", a, SOLID_G[a]) for a in AZIMUTHS]
    rows += [row(BASELINE, "analytic", a, PLANAR_G[a]) for a in AZIMUTHS]
    name = "centroid 3 % higher"
    rows += [row(name, "pybullet", a, 0.97 * peak) for a, peak in SOLID_G.items() if peak is not None]
    sides = [row(BASELINE, "analytic", a, PLANAR_G[a]) for a in (0.0, 180.0, 270.0)]
    departure = Departure(60.0, "pybullet", 0.475, Outcome.STANDS, 0.04, 0.03, 0.01, 0.02, -0.005, 0.012, 0.25)
    asked = AskedRecord(
        kind="effects3d",
        title="an invented rose",
        scene="base.toml",
        directions=4,
        every=1,
        engines=["pybullet", "analytic"],
        conditions=[name],
        samples=5,
        share=0.95,
        seed=0,
        search=SearchRecord(1.2, 0.002, 1e-3),
    )
    made = EffectsRecord(
        title="an invented rose",
        file="rose.toml",
        scene=SceneRecord.of(scene),
        study=asked,
        rows=rows,
        sides=sides,
        static=static_rose(scene, AZIMUTHS, sides),
        bands=[Band(0.0, 0.24, 0.25, None, 0.1, 5)],
        departures=[departure],
        effects=effects(rows, [name]),
        left_out={"base planed flat": "the base is flat"},
        unit_g=0.3,
        replay=None,
        summary=EffectsSummary(4, 8, 0, 72, 0, 1.0),
        versions=versions(),
        machine=machine(),
        seconds=1.0,
    )
    return answered(made)


def answered(record: EffectsRecord) -> EffectsRecord:
    """The record with the answer and the findings of its own rows."""
    return replace(record, answer=answer_of(record), findings=findings_of(record)).texted(ENGLISH.say)


def write_effects(folder: Path) -> Path:
    """The record with a replay of the model alone, towards 60°."""
    replay = ReplayRecord(60.0, "analytic", 0.3, {"analytic": Outcome.STANDS}, "replay", "rockcheck run scene.toml")
    shaken = turned(harness.load_scene(SCENE, {"duration_s": 0.5}), replay.azimuth_deg)
    folder.mkdir(parents=True)
    write_result(run_scene(shaken, ["analytic"]), folder / replay.folder)
    write_json(folder / "result.json", as_file(replace(effects_record(), replay=replay)))
    return folder
