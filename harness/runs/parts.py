"""Long measurements in parts: what is finished is kept, so that a killed one goes on and one part can be measured anew."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Final, Generic, TypeVar, cast

from harness.model import run as record
from harness.model.errors import InputError, Mistake
from harness.model.finding import Say
from harness.records.bench import BenchRecord, PartRow, StressRecord
from harness.records.result_folder import check_folder, full_kind, write_whole
from harness.runs.execute import Campaign
from harness.runs.runner import Crash, InlinePool, LocalPool
from harness.runs.store import STORE_NAME, Store
from harness.runs.task import Answer, Task, key_of

Row = dict[str, Any]
Work = Callable[[str], list[Row]]
R = TypeVar("R", BenchRecord, StressRecord)
PACKAGES: Final = ("analytic", "meshes", "harness")


@dataclass(frozen=True)
class Part:
    """One part of a measurement: `work(task)` gives the rows of one of its named tasks.

    `died` gives the rows of a task that took its process with it: such a part is computed in worker processes, on all cores. A
    part without it is timed, hence computed alone and in this process.
    """

    name: str
    tasks: Sequence[str]
    work: Work
    died: Work | None = None


@dataclass
class Measured:
    """What is known of a part: rows by task, processor seconds of its tasks and seconds by the clock, tasks not done."""

    rows: dict[str, list[Row]] = field(default_factory=dict)
    busy_s: float = 0.0
    wall_s: float = 0.0
    left: tuple[str, ...] = ()

    def in_order(self, part: Part) -> list[Row]:
        """All rows in the order of the part's tasks."""
        return [row for task in part.tasks for row in self.rows.get(task, [])]


@dataclass(frozen=True)
class Measurement(Generic[R]):
    """A command that measures: its parts, whole or `quick`, the record that they and its command line make.

    `sources`: folders of code that computes beside the packages, from the folder that holds these.
    """

    name: str
    parts: Callable[[bool], list[Part]]
    assembled: Callable[[Sequence[Part], Mapping[str, Measured], str], R]
    sources: tuple[str, ...] = ()

    def run(
        self,
        folder: Path,
        quick: bool = False,
        only: Sequence[str] | None = None,
        on_progress: Callable[[str], None] = lambda text: None,
        say: Say = lambda finding: "",
    ) -> R:
        """Measure everything (or `only` some parts) and write `result.json` into `folder`; `quick` takes a few of each kind.

        What was interrupted goes on where it was. `on_progress` hears of it. Raises `InputError` for a folder that cannot be
        written, or an unknown part.
        """
        listed, kind = self.parts(quick), full_kind(self.name, "--quick" if quick else "")
        check_folder(folder, (kind,))
        measured = measure(folder, listed, only, stamp(quick, self.sources), on_progress, kind)
        return write_whole(folder, self.assembled(listed, measured, command(self.name, quick, measured)).texted(say))


def source(more: Sequence[str] = ()) -> str:
    """SHA-256 of what computes: rows of one version, but of different code, are no one measurement."""
    root = Path(__file__).resolve().parents[2]
    state = hashlib.sha256()
    for path in sorted(path for name in (*PACKAGES, *more) for path in (root / name).rglob("*.py")):
        state.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes())
    return state.hexdigest()


def stamp(quick: bool, sources: Sequence[str] = ()) -> dict[str, object]:
    """What rows of one measurement share: the versions, source, machine and option of now."""
    return {"versions": record.versions(), "source": source(sources), "machine": record.machine(), "quick": quick}


def measure(
    folder: Path,
    parts: Sequence[Part],
    only: Sequence[str] | None,
    stamp: Mapping[str, object],
    on_progress: Callable[[str], None],
    kind: str = "bench",
) -> dict[str, Measured]:
    """Measure the parts (of them `only` these), keeping every finished task in the store of `folder`; the others as they are.

    A part that was interrupted goes on; one that is finished is measured anew, when asked by name or when all are finished.
    What was measured under another `stamp` (versions, options) is removed. Raises `InputError` for an unknown part.
    """
    chosen = _chosen(parts, only)
    keys = {part.name: {task: _key(part, task, stamp) for task in part.tasks} for part in parts}
    folder.mkdir(parents=True, exist_ok=True)
    with Store(folder / STORE_NAME, kind) as store:
        store.remove(store.keys() - {key for of_part in keys.values() for key in of_part.values()})
        # Read now, so that damage is told before hours of work.
        stored = {key for of_part in keys.values() for key in of_part.values() if store.get(key) is not None}
        left = {name: not stored.issuperset(of_part.values()) for name, of_part in keys.items()}
        whole = not any(left[part.name] for part in (chosen if only else parts))
        for part in chosen:
            if not left[part.name] and (whole or only):
                store.remove(keys[part.name].values())
        _together([part for part in chosen if part.died is not None], keys, store, on_progress)
        for part in chosen:
            if part.died is None:
                _alone(part, keys[part.name], store, on_progress)
        return {part.name: _measured(part, keys[part.name], store) for part in parts}


def seconds(measured: Mapping[str, Measured]) -> list[PartRow]:
    """What each part took: by the clock, and of the processor."""
    return [PartRow(name, item.wall_s, len(item.rows), item.left, item.busy_s) for name, item in measured.items()]


def command(name: str, quick: bool, measured: Mapping[str, Measured]) -> str:
    """What measures again all that was measured: `rockcheck NAME` with the options that it takes."""
    done = [part for part, item in measured.items() if item.rows or not item.left]
    some = f" --parts {','.join(done)}" if 0 < len(done) < len(measured) else ""
    return f"rockcheck {name}{' --quick' if quick else ''}{some}"


def _chosen(parts: Sequence[Part], only: Sequence[str] | None) -> list[Part]:
    names = [part.name for part in parts]
    unknown = [name for name in only or () if name not in names]
    if unknown:
        raise InputError(Mistake("--parts", "", f"some of {', '.join(names)}", ", ".join(map(repr, unknown))))
    return [part for part in parts if only is None or part.name in only]


def _key(part: Part, task: str, stamp: Mapping[str, object]) -> str:
    return key_of(*record.to_plain([part.name, task, stamp]))


def _measured(part: Part, keys: Mapping[str, str], store: Store) -> Measured:
    measured = Measured()
    for task, key in keys.items():
        stored, timing = store.get(key), store.timing(key)
        if stored is not None and timing is not None:
            measured.rows[task] = cast("list[Row]", stored["rows"])
            measured.busy_s += timing[0]
            measured.wall_s += timing[1]
    measured.left = tuple(task for task in part.tasks if task not in measured.rows)
    return measured


def _rows(asked: tuple[Part, str]) -> Answer:
    """What a worker does: the rows of one task of a part."""
    part, task = asked
    begin = _processor_s()
    rows = record.to_plain(part.work(task))
    return Answer(part.name, {"rows": rows}, _processor_s() - begin)


def _processor_s() -> float:
    """Processor time so far of this process and of those that it began and that ended."""
    return sum(os.times()[:4])


def _died(asked: tuple[Part, str], crash: Crash) -> Answer:
    part, task = asked
    return Answer(part.name, {"rows": record.to_plain((part.died or part.work)(task))}, 0.0)


def _tasks(part: Part, keys: Mapping[str, str]) -> list[Task]:
    return [Task(key, _rows, (replace(part, tasks=()), task), part.name, _died) for task, key in keys.items()]


def _alone(part: Part, keys: Mapping[str, str], store: Store, on_progress: Callable[[str], None]) -> None:
    stored = store.keys()
    left = {task: key for task, key in keys.items() if key not in stored}

    def announced() -> Iterator[Task]:
        for number, task in enumerate(_tasks(part, left), 1):
            on_progress(f"{part.name} {number} of {len(left)}: {task.argument[1]}")
            yield task

    Campaign(store, InlinePool()).run(announced(), len(left))


def _together(
    parts: Sequence[Part],
    keys: Mapping[str, Mapping[str, str]],
    store: Store,
    on_progress: Callable[[str], None],
) -> None:
    """The tasks of all these parts on all cores, in the order given: the longest should come first."""

    def on_count(done: int, total: int) -> None:
        if campaign.latest is not None and done:
            part, task = campaign.latest.argument
            on_progress(f"{done} of {total} done: {part.name}, {task}")

    tasks = [task for part in parts for task in _tasks(part, keys[part.name])]
    with closing(LocalPool()) as pool:
        campaign = Campaign(store, pool, on_count)
        campaign.run(tasks, len(tasks))
