"""Long measurements in parts: what is finished is kept, so that a killed one goes on and one part can be measured anew."""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

from harness.campaign.executors import LocalPool
from harness.model import run as record
from harness.model.errors import InputError, Mistake
from harness.records.result_folder import check_folder, listing

Row = dict[str, Any]
Work = Callable[[str], list[Row]]
FOLDER: Final = "parts"
PACKAGES: Final = ("analytic", "meshes", "harness", "tests/fuzz")


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
    """What is known of a part: rows by task, seconds of its tasks summed and by the clock, tasks not done."""

    rows: dict[str, list[Row]] = field(default_factory=dict)
    busy_s: float = 0.0
    wall_s: float = 0.0
    left: tuple[str, ...] = ()

    def in_order(self, part: Part) -> list[Row]:
        """All rows in the order of the part's tasks."""
        return [row for task in part.tasks for row in self.rows.get(task, [])]


def source() -> str:
    """SHA-256 of what computes: rows of one version, but of different code, are no one measurement."""
    root = Path(__file__).resolve().parents[2]
    state = hashlib.sha256()
    for path in sorted(path for name in PACKAGES for path in (root / name).rglob("*.py")):
        state.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes())
    return state.hexdigest()


def session(
    folder: Path, parts: Sequence[Part], quick: bool, only: Sequence[str] | None, told: Callable[[str], None]
) -> dict[str, Measured]:
    """Measure as `measure` does, into a folder that can be written, under the versions, source, machine and option of now."""
    check_folder(folder, ("bench", "stress"))
    stamp = {"versions": record.versions(), "source": source(), "machine": record.machine(), "quick": quick}
    return measure(folder, parts, only, stamp, told)


def written(folder: Path, found: Mapping[str, Any]) -> dict[str, Any]:
    """The record of all parts as plain values, written into `folder` as `result.json`."""
    about = {"versions": record.versions(), "machine": record.machine(), "files": listing(())}
    plain: dict[str, Any] = record.to_plain({**found, **about})
    record.write_json(folder / "result.json", plain)
    return plain


def measure(
    folder: Path,
    parts: Sequence[Part],
    only: Sequence[str] | None,
    stamp: Mapping[str, Any],
    told: Callable[[str], None],
) -> dict[str, Measured]:
    """Measure the parts (of them `only` these), keeping every finished task in `folder`/parts; the others as they are kept.

    A part that was interrupted goes on; one that is finished is measured anew, when asked by name or when all are finished.
    What was kept under another `stamp` (versions, options) is not used. Raises `InputError` for an unknown part.
    """
    kept = folder / FOLDER
    chosen = _chosen(parts, only)
    found = {part.name: _read(kept, part, stamp) for part in parts}
    whole = not any(found[part.name].left for part in (chosen if only else parts))
    for part in chosen:
        if not found[part.name].left and (whole or only):
            _path(kept, part).unlink(missing_ok=True)
    kept.mkdir(parents=True, exist_ok=True)
    begin = {part.name: _read(kept, part, stamp) for part in parts}
    _together([part for part in chosen if part.died is not None], begin, kept, stamp, told)
    for part in chosen:
        if part.died is None:
            _alone(part, begin[part.name].left, kept, stamp, told)
    return {part.name: _read(kept, part, stamp) for part in parts}


def seconds(found: Mapping[str, Measured]) -> list[Row]:
    """What each part took: by the clock, and summed over its tasks."""
    return [
        {"part": name, "wall_s": item.wall_s, "busy_s": item.busy_s, "tasks": len(item.rows), "left": list(item.left)}
        for name, item in found.items()
    ]


def command(name: str, quick: bool, found: Mapping[str, Measured]) -> str:
    """What measures again all that was measured: `rockcheck NAME` with the options that it takes."""
    done = [part for part, item in found.items() if item.rows or not item.left]
    some = f" --parts {','.join(done)}" if 0 < len(done) < len(found) else ""
    return f"rockcheck {name}{' --quick' if quick else ''}{some}"


def sentences(rows: Sequence[Row]) -> list[str]:
    """The seconds of each part in words, and what is not measured yet."""
    spent = ", ".join(f"{row['part']} {row['wall_s']:.0f} s" for row in rows if row["tasks"])
    left = [f"{row['part']} ({len(row['left'])} to do)" for row in rows if row["left"]]
    return [f"Time by part: {spent}."] + ([f"Not measured yet: {', '.join(left)}."] if left else [])


def _chosen(parts: Sequence[Part], only: Sequence[str] | None) -> list[Part]:
    names = [part.name for part in parts]
    unknown = [name for name in only or () if name not in names]
    if unknown:
        raise InputError(Mistake("--parts", "", f"some of {', '.join(names)}", ", ".join(map(repr, unknown))))
    return [part for part in parts if only is None or part.name in only]


def _path(kept: Path, part: Part) -> Path:
    return kept / f"{part.name}.jsonl"


def _lines(path: Path) -> Iterator[dict[str, Any]]:
    """The whole lines of a file: one may have been torn when a run was killed."""
    if not path.exists():
        return
    for line in path.read_text(encoding="utf-8").splitlines():
        try:
            yield dict(json.loads(line))
        except (TypeError, ValueError):
            continue


def _read(kept: Path, part: Part, stamp: Mapping[str, Any]) -> Measured:
    found = Measured()
    plain = record.to_plain(stamp)
    for line in _lines(_path(kept, part)):
        if line.get("stamp") == plain and line.get("task") in part.tasks:
            found.rows[line["task"]] = line["rows"]
            found.busy_s += line["busy_s"]
            found.wall_s += line["wall_s"]
    found.left = tuple(task for task in part.tasks if task not in found.rows)
    if not found.rows:
        _path(kept, part).unlink(missing_ok=True)
    return found


class _Keeper:
    """Appends finished tasks to their part's file; the clock runs from one to the next."""

    def __init__(self, kept: Path, stamp: Mapping[str, Any]) -> None:
        self._kept, self._stamp = kept, stamp
        self._last = time.perf_counter()

    def keep(self, part: Part, task: str, rows: list[Row], busy_s: float) -> None:
        now = time.perf_counter()
        line = {"task": task, "stamp": self._stamp, "busy_s": busy_s, "wall_s": now - self._last, "rows": rows}
        self._last = now
        text = json.dumps(record.to_plain(line), ensure_ascii=False, allow_nan=False)
        path = _path(self._kept, part)
        torn = path.exists() and not path.read_bytes().endswith(b"\n")
        with path.open("a", encoding="utf-8") as stream:
            stream.write(("\n" if torn else "") + text + "\n")


def _alone(part: Part, tasks: Sequence[str], kept: Path, stamp: Mapping[str, Any], told: Callable[[str], None]) -> None:
    keeper = _Keeper(kept, stamp)
    for number, task in enumerate(tasks, 1):
        told(f"{part.name} {number} of {len(tasks)}: {task}")
        begin = time.perf_counter()
        rows = part.work(task)
        keeper.keep(part, task, rows, time.perf_counter() - begin)


@dataclass(frozen=True)
class _Job:
    """One task for a worker; the part by number, since its work alone must travel."""

    part: int
    task: str
    work: Work


def _compute(job: _Job) -> tuple[float, list[Row]]:
    begin = time.perf_counter()
    rows = job.work(job.task)
    return time.perf_counter() - begin, rows


def _together(
    parts: Sequence[Part],
    begin: Mapping[str, Measured],
    kept: Path,
    stamp: Mapping[str, Any],
    told: Callable[[str], None],
) -> None:
    """The tasks of all these parts on all cores, in the order given: the longest should come first."""
    jobs = [_Job(k, task, part.work) for k, part in enumerate(parts) for task in begin[part.name].left]
    if not jobs:
        return
    keeper = _Keeper(kept, stamp)
    finished = 0

    def done(job: _Job, result: Any) -> None:
        nonlocal finished
        part = parts[job.part]
        if isinstance(result, BaseException):
            rows = (part.died or part.work)(job.task)
            busy_s = 0.0
        else:
            busy_s, rows = result
        finished += 1
        told(f"{finished} of {len(jobs)} done: {part.name}, {job.task}")
        keeper.keep(part, job.task, rows, busy_s)

    LocalPool().run(_compute, jobs, done)
