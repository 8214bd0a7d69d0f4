"""The main job: the paper's study and the example scenes, each with its report, all cores at work from one queue."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import closing
from itertools import chain
from pathlib import Path
from typing import Any, Final

from harness import study_cli
from harness.campaign.executors import Crash, Done, LocalPool, Pool, Work
from harness.cli import summary
from harness.command import guarded
from harness.input.paths import data_folder
from harness.input.scene_file import load_scene
from harness.model.run import Run
from harness.scene_run.scene_run import run_scene, write_result
from harness.studies.jobs import stored_runs
from harness.studies.store import STORE_NAME, Store
from reports.pages.page import write_report

SCENES: Final = Path(__file__).resolve().parent.parent / "scenes"
OUT: Final = Path("out")
STUDY: Final = "paestum_table2"
IN_STUDY: Final = ("paestum_pedestal", "paestum_floor")
"""Scenes that are conditions of the study: what it has computed is not computed again."""
ALWAYS: Final = ("free_rocking",)
WITH_DATA: Final = ("maria",)

Task = tuple[Callable[..., Any], Any]
"""A function that a worker can import, and its argument."""


class Beside:
    """A pool that runs tasks of its own beside a study's, from the same queue: some before, some at the end."""

    def __init__(self, pool: Pool, before: Iterable[Task], after: Callable[[], Iterator[Task]], done: Done) -> None:
        self._pool, self._before, self._after, self._done = pool, before, after, done

    @property
    def workers(self) -> int:
        """How many tasks run at once."""
        return self._pool.workers

    def run(self, work: Work, tasks: Iterable[Any], done: Done) -> None:
        """See `harness.campaign.executors.Pool.run`."""
        mine, self._before = self._before, ()
        own = ((work, task) for task in tasks)

        def told(task: Task, result: Any) -> None:
            (done if task[0] is work else self._done)(task[1], result)

        self._pool.run(call, chain(mine, own, self._after()), told)
        self._after = lambda: iter(())

    def close(self) -> None:
        """Give the workers back."""
        self._pool.close()


def call(task: Task) -> Any:
    """What a worker does."""
    return task[0](task[1])


def example(asked: tuple[str, Mapping[str, Run]]) -> tuple[str, bool, float]:
    """Run one scene (what is known of it aside), write its result and page; its summary, whether a run failed, seconds."""
    begin = time.perf_counter()
    name, known = asked
    result = run_scene(load_scene(SCENES / f"{name}.toml"), stored=known)
    write_result(result, OUT / name)
    write_report(OUT / name)
    return summary(result), result.failed, time.perf_counter() - begin


def of_study() -> Iterator[Task]:
    """The scenes that the study holds, with their runs; asked for when the study's own tasks are all handed out."""
    with Store(OUT / STUDY / STORE_NAME) as store:
        for name in IN_STUDY:
            yield example, (name, stored_runs(store, load_scene(SCENES / f"{name}.toml")))


def main() -> int:
    """Run the study and the scenes into `out/`; returns 1 when a run failed."""
    start = time.perf_counter()
    names = list(ALWAYS)
    if data_folder().is_dir():
        names += WITH_DATA
    else:
        print(f"left out: {', '.join(WITH_DATA)} (real data absent: set ROCKCHECK_DATA)", file=sys.stderr)
    found: dict[str, tuple[str, bool, float]] = {}

    def told(asked: tuple[str, Any], result: tuple[str, bool, float] | BaseException) -> None:
        if isinstance(result, BaseException) and not isinstance(result, Crash):
            raise result
        found[asked[0]] = (f"{asked[0]}: {result}", True, 0.0) if isinstance(result, Crash) else result

    with closing(LocalPool()) as pool:
        beside = Beside(pool, [(example, (name, {})) for name in names], of_study, told)
        record, done = study_cli.run(SCENES / f"{STUDY}.toml", OUT / STUDY, pool=beside)
    pages = [write_report(OUT / STUDY), *(OUT / name / "report.html" for name in found)]
    seconds = time.perf_counter() - start
    busy_s = record["usage"]["busy_s"] + sum(took for _, _, took in found.values())
    busy = f"{beside.workers} workers {100.0 * busy_s / (seconds * beside.workers):.0f} % busy"
    print("\n".join([f"{STUDY}: {done}", record["usage"]["sentence"], *(text for text, _, _ in found.values())]))
    print("\n".join([f"\ndone in {seconds:.0f} s, {busy}. Reports:", *(f"  {page}" for page in pages)]))
    return int(done.failed > 0 or any(failed for _, failed, _ in found.values()))


if __name__ == "__main__":
    sys.exit(guarded(main))
