"""The main job: the paper's study and the example scenes, each with its report, all cores at work from one queue."""

import json
import sys
import sysconfig
import time
from collections.abc import Mapping, Sequence
from contextlib import closing
from importlib import import_module
from pathlib import Path
from typing import Final

from harness.input.files import data_folder
from harness.input.scene_file import load_scene
from harness.model import Answer as Answered
from harness.model import Outcome, Run, Say, info, machine, versions
from harness.questions.scene.scene_run import run_scene, write_result
from harness.questions.trust import run_trust
from harness.records.base import write_whole
from harness.records.study import StudyRecord, StudyRow
from harness.records.trust import TrustRecord
from harness.records.validation import MeasuredRecord, MeasuredTable
from harness.runs.runner import Crash, LocalPool, Pool
from harness.runs.store import STORE_NAME, Store, stored_runs
from harness.runs.task import TaskResult
from reports.cli import studies
from reports.cli.app import guarded
from reports.messages import ENGLISH
from reports.pages.page import write_report
from reports.terminal import record_lines

BESIDE_THE_CODE: Final = Path(__file__).resolve().parent.parent / "scenes"
INSTALLED: Final = Path(sysconfig.get_path("data")) / "share" / "rockcheck" / "scenes"
SCENES: Final = BESIDE_THE_CODE if BESIDE_THE_CODE.is_dir() else INSTALLED
OUT: Final = Path("out")
STUDY: Final = "paestum_table2"
IN_STUDY: Final = ("paestum_pedestal", "paestum_floor")
"""Scenes that are conditions of the study: what it has computed is not computed again."""
MAPPED: Final = "paestum_pedestal"
MAP: Final = f"{MAPPED}-trust"
CHECKED: Final = "checked"
ALWAYS: Final = ("free_rocking",)
WITH_DATA: Final = ("maria",)


ROWS: Final = Path(__file__).with_name("checked.json")
"""Renewed by `python -m tests.measures.checked`."""
PARTS: Final = ("verification", "agreement", "validation")
"""Are the equations solved right; do independent codes say the same; does it happen so?"""
COLUMNS: Final = ("compared", "with", "on_how_many", "figure", "does_not_prove", "source")


def example(asked: tuple[str, Mapping[str, Run]]) -> TaskResult:
    """Run one scene (what is known of it aside), write its result and page; its summary, and the seconds that it took."""
    begin = time.perf_counter()
    name, known = asked
    result = run_scene(load_scene(SCENES / f"{name}.toml"), stored=known, assess=True)
    write_result(result, OUT / name, ENGLISH.say)
    write_report(OUT / name)
    text = "\n".join(record_lines(result.record().texted(ENGLISH.say)))
    failed = result.failed_but(tuple(result.runs))
    return TaskResult("example", {"text": text}, time.perf_counter() - begin, failed=failed)


def trust_map(pool: Pool) -> TrustRecord:
    """The coarse trust map of the statue on its pedestal, and without it."""
    return run_trust(SCENES / f"{MAPPED}.toml", OUT / MAP, coarse=True, pool=pool, say=ENGLISH.say)


def write_checked(folder: Path, say: Say = str) -> MeasuredRecord:
    """Write the record of what has been checked into `folder`."""
    rows = json.loads(ROWS.read_text(encoding="utf-8"))
    found = MeasuredRecord(
        title="What has been checked",
        answer=Answered("checked", [info("checked", checks=sum(len(rows[part]) for part in PARTS))]),
        findings=[],
        about="checked",
        source=ROWS.name,
        tables=[MeasuredTable(part, COLUMNS, rows[part]) for part in PARTS],
        versions=versions(),
        machine=machine(),
        seconds=0.0,
    )
    return write_whole(folder, found.texted(say))


def main() -> int:
    """Run the study, the scenes and the map into `out/`; returns 1 when a run failed."""
    start = time.perf_counter()
    names = list(ALWAYS)
    if data_folder().is_dir():
        names += WITH_DATA
    else:
        print(f"left out: {', '.join(WITH_DATA)} (real data absent: set ROCKCHECK_DATA)", file=sys.stderr)
    answers: dict[str, TaskResult] = {}

    def done(asked: tuple[str, object], answer: TaskResult | Crash) -> None:
        """Keep the answer of a scene; that of a process that died says so."""
        lost = TaskResult("example", {"text": f"{asked[0]}: {answer}"}, 0.0, failed=True)
        answers[asked[0]] = lost if isinstance(answer, Crash) else answer

    with closing(LocalPool()) as pool:
        record = studies.run(SCENES / f"{STUDY}.toml", OUT / STUDY, pool=pool, say=ENGLISH.say)
        known: dict[str, Mapping[str, Run]] = {name: {} for name in names}
        with Store(OUT / STUDY / STORE_NAME) as store:
            known |= {name: stored_runs(store, load_scene(SCENES / f"{name}.toml")) for name in IN_STUDY}
        pool.run(example, known.items(), done)
        mapped = trust_map(pool)
    assert isinstance(record, StudyRecord)
    assert record.usage is not None
    pages = [write_report(OUT / STUDY), write_report(OUT / MAP), *(OUT / name / "report.html" for name in answers)]
    write_checked(OUT / CHECKED, ENGLISH.say)
    pages.append(write_report(OUT / CHECKED))
    seconds = time.perf_counter() - start
    busy_s = record.usage.busy_s + sum(answer.seconds for answer in answers.values()) + mapped.summary.cpu_s
    busy = f"{pool.workers} workers {100.0 * busy_s / (seconds * pool.workers):.0f} % busy"
    texts = [str(answer.record["text"]) for answer in answers.values()]
    print("\n".join([*record_lines(record), *texts, *record_lines(mapped)]))
    print("\n".join([f"\ndone in {seconds:.0f} s, {busy}. Reports:", *(f"  {page}" for page in pages)]))
    return int(_failed(record.rows) or mapped.summary.failed > 0 or any(answer.failed for answer in answers.values()))


def _failed(rows: Sequence[StudyRow]) -> bool:
    """Whether a run of the study failed; an engine that is not installed here is said and fails nothing."""
    runs = [row.run for row in rows if row.run is not None]
    for name in sorted({run.engine for run in runs if run.outcome is Outcome.UNAVAILABLE}):
        print(f"left out: {name}, which is not installed here", file=sys.stderr)
    return any(run.outcome.failed and run.outcome is not Outcome.UNAVAILABLE for run in runs)


if __name__ == "__main__":
    # Its examples are made by workers, which know them by the name of this module.
    sys.exit(guarded(import_module("reports.build_examples").main))
