"""Long measurements in parts: what is finished is kept, so that a killed one goes on and one part can be measured anew.

And what a piece of work costs.
"""

import hashlib
import os
import resource
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final, Generic, TypeVar

from harness.model import Say, machine, require, to_plain, versions
from harness.records import base
from harness.records.base import check_folder, full_kind, write_whole
from harness.records.bench import BenchRecord, PartRow, StressRecord
from harness.runs.execute import Campaign
from harness.runs.runner import Crash, InlinePool, LocalPool, Pool
from harness.runs.store import STORE_NAME, Store
from harness.runs.task import Task, TaskResult, key_of

Work = Callable[[str], Sequence[object]]
R = TypeVar("R", BenchRecord, StressRecord)
PACKAGES: Final = ("analytic", "meshes", "harness")


@dataclass(frozen=True)
class Part:
    """One part of a measurement: `work(task)` gives the rows of one of its named tasks, each of the class `row`.

    `died` gives the rows of a task that took its process with it: such a part is computed in worker processes, on all cores. A
    part without it is timed, hence computed alone and in this process.
    """

    name: str
    tasks: Sequence[str]
    work: Work
    died: Work | None = None
    row: type = dict


@dataclass(frozen=True)
class Measurement(Generic[R]):
    """A command that measures: its parts, whole or `quick`, and its record, made of the rows of each part and of its `head`."""

    name: str
    parts: Callable[[bool], list[Part]]
    assembled: Callable[[Mapping[str, list[Any]], Mapping[str, Any]], R]

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
        rows, spent = measure(folder, listed, only, stamp(quick), on_progress, kind)
        return write_whole(folder, self.assembled(rows, head(command(self.name, quick, spent), spent)).texted(say))


def head(command: str, spent: Sequence[PartRow]) -> dict[str, Any]:
    """What the record of every measurement says: how to repeat it, what it took, and where."""
    seconds = sum(row.wall_s for row in spent)
    place = {"versions": versions(), "machine": machine()}
    return {"command": command, "parts": spent, "seconds": seconds, **place}


def source() -> str:
    """SHA-256 of what computes: rows of one version, but of different code, are no one measurement."""
    root = Path(__file__).resolve().parents[3]
    state = hashlib.sha256()
    for path in sorted(path for name in PACKAGES for path in (root / name).rglob("*.py")):
        state.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes())
    return state.hexdigest()


def stamp(quick: bool) -> dict[str, object]:
    """What rows of one measurement share: the versions, source, machine and option of now."""
    return {"versions": versions(), "source": source(), "machine": machine(), "quick": quick}


def measure(
    folder: Path,
    parts: Sequence[Part],
    only: Sequence[str] | None,
    stamp: Mapping[str, object],
    on_progress: Callable[[str], None],
    kind: str = "bench",
) -> tuple[dict[str, list[Any]], list[PartRow]]:
    """Measure the parts (of them `only` these), keeping every finished task in the store of `folder`; the others as they are.

    Gives the rows of each part in the order of its tasks, and what it took.

    A part that was interrupted goes on; one that is finished is measured anew, when asked by name or when all are finished.
    What was measured under another `stamp` (versions, options) is removed. Raises `InputError` for an unknown part.
    """
    chosen = _chosen(parts, only)
    keys = {part.name: {task: key_of(*to_plain([part.name, task, stamp])) for task in part.tasks} for part in parts}
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
        # The longest should come first of what is computed side by side.
        with closing(LocalPool()) as pool:
            _compute([part for part in chosen if part.died is not None], keys, store, pool, on_progress)
        _compute([part for part in chosen if part.died is None], keys, store, InlinePool(), on_progress)
        measured = [_measured(part, keys[part.name], store) for part in parts]
    return {spent.part: rows for rows, spent in measured}, [spent for _, spent in measured]


def command(name: str, quick: bool, spent: Sequence[PartRow]) -> str:
    """What measures again all that was measured: `rockcheck NAME` with the options that it takes."""
    done = [row.part for row in spent if row.tasks or not row.left]
    some = f" --parts {','.join(done)}" if 0 < len(done) < len(spent) else ""
    return f"rockcheck {name}{' --quick' if quick else ''}{some}"


def _chosen(parts: Sequence[Part], only: Sequence[str] | None) -> list[Part]:
    names = [part.name for part in parts]
    unknown = [name for name in only or () if name not in names]
    require(not unknown, "--parts", f"some of {', '.join(names)}", ", ".join(map(repr, unknown)))
    return [part for part in parts if only is None or part.name in only]


def _measured(part: Part, keys: Mapping[str, str], store: Store) -> tuple[list[Any], PartRow]:
    found = {
        task: (stored["rows"], timing)
        for task, key in keys.items()
        if (stored := store.get(key)) is not None and (timing := store.timing(key)) is not None
    }
    kind = list[part.row]  # type: ignore[name-defined]
    rows = [row for stored, _ in found.values() for row in base.part(kind, stored, store.path)]
    busy_s, wall_s = (sum((timing[k] for _, timing in found.values()), 0.0) for k in (0, 1))
    return rows, PartRow(part.name, wall_s, len(found), [task for task in keys if task not in found], busy_s)


def _rows(asked: tuple[Part, str]) -> TaskResult:
    """What a worker does: the rows of one task of a part."""
    part, task = asked
    begin = processor_s()
    rows = to_plain(part.work(task))
    return TaskResult(part.name, {"rows": rows}, processor_s() - begin)


def processor_s() -> float:
    """Processor time so far of this process and of those that it began and that ended."""
    return sum(os.times()[:4])


def _died(asked: tuple[Part, str], crash: Crash) -> TaskResult:
    part, task = asked
    return TaskResult(part.name, {"rows": to_plain((part.died or part.work)(task))}, 0.0)


def _compute(
    parts: Sequence[Part],
    keys: Mapping[str, Mapping[str, str]],
    store: Store,
    pool: Pool,
    on_progress: Callable[[str], None],
) -> None:
    """The tasks of these parts that the store lacks, in the order given."""
    stored = store.keys()
    left = [
        Task(key, _rows, (replace(part, tasks=()), task), part.name, _died)
        for part in parts
        for task, key in keys[part.name].items()
        if key not in stored
    ]

    def announced() -> Iterator[Task]:
        for number, task in enumerate(left, 1):
            part, name = task.argument
            on_progress(f"{number} of {len(left)}: {part.name}, {name}")
            yield task

    Campaign(store, pool).run(announced(), len(left))


# What a piece of work costs: best of several, after a warm-up, by the clock and by the processor.

T = TypeVar("T")
REPEATS: Final = 5
BUDGET_S: Final = 1.0
"""Processor time after which no further repetition is begun: a slow run needs fewer to be timed to a percent."""


@dataclass(frozen=True)
class Cost:
    """Least seconds of several runs: by the clock, and of this process's processor time (other processes do not enter it)."""

    wall_s: float
    cpu_s: float
    repeats: int


def cost(work: Callable[[], object], repeats: int = REPEATS, budget_s: float = BUDGET_S) -> Cost:
    """Time some work that has been done once already (compiled, loaded, cached)."""
    return costs([work], repeats, budget_s)[0]


def timed(work: Callable[[], T]) -> tuple[T, Cost]:
    """What one piece of work gives, and its cost this once."""
    wall, cpu = time.perf_counter(), time.process_time()
    result = work()
    return result, Cost(time.perf_counter() - wall, time.process_time() - cpu, 1)


def costs(
    works: Sequence[Callable[[], object]],
    repeats: int = REPEATS,
    budget_s: float = BUDGET_S,
    first: Sequence[Cost] | None = None,
) -> list[Cost]:
    """The same of several pieces that take turns: what one meets of the machine's moods, the others meet too.

    `first` is what each took before: one that took the budget is not done again.
    """
    spent = [[each] for each in first] if first is not None else [list[Cost]() for _ in works]
    for _ in range(repeats):
        for work, mine in zip(works, spent, strict=True):
            if sum(each.cpu_s for each in mine) < budget_s:
                mine.append(timed(work)[1])
    return [Cost(min(each.wall_s for each in mine), min(each.cpu_s for each in mine), len(mine)) for mine in spent]


def peak_memory_mb(whose: int = resource.RUSAGE_SELF) -> float:
    """Largest resident memory of this process so far, or of any ended child of it (`resource.RUSAGE_CHILDREN`), MB."""
    return resource.getrusage(whose).ru_maxrss / 1024.0
