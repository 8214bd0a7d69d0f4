"""What a study of a million runs costs on a Dask cluster of processes here: time, memory of each process, bytes.

`python -m tests.measures.scale STUDY FOLDER [--kill-at RUNS] [--workers N]`: a scheduler and workers in their own processes, the
study as a command of its own; with `--kill-at` it is killed once, when so many runs are stored, and given again with --resume.
"""

import argparse
import os
import signal
import sqlite3
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Final

from harness.runs.store import STORE_NAME

EVERY_S: Final = 1.0
"""Time between two looks at the processes."""
MB: Final = 1e6


def resident_mb(pid: int) -> float:
    """Resident memory of a process, MB; 0 when it is gone."""
    try:
        pages = int(Path(f"/proc/{pid}/statm").read_text(encoding="ascii").split()[1])
    except OSError:
        return 0.0
    return pages * os.sysconf("SC_PAGE_SIZE") / MB


def cpu_s(pid: int) -> float:
    """Processor time of a process, s; 0 when it is gone."""
    try:
        times = Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rpartition(")")[2].split()[11:13]
    except OSError:
        return 0.0
    return sum(map(int, times)) / float(os.sysconf("SC_CLK_TCK"))


@contextmanager
def cluster(workers: int) -> Iterator[tuple[str, dict[str, int]]]:
    """A scheduler and workers of one thread; their address, and their processes by name."""
    from distributed import LocalCluster

    with LocalCluster(
        n_workers=workers, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs=40
    ) as local:
        names = {f"worker {k}": int(one.pid) for k, one in enumerate(local.workers.values())}
        yield local.scheduler_address, {"scheduler (with the cluster's own process)": os.getpid(), **names}


def stored(folder: Path) -> tuple[int, int]:
    """Runs in the blocks of a result folder's store, and its bytes."""
    path = folder / STORE_NAME
    try:
        with closing(sqlite3.connect(f"file:{path}?mode=ro", uri=True)) as db:
            runs = int(db.execute("SELECT TOTAL(samples) FROM history").fetchone()[0])
    except sqlite3.Error:
        runs = 0
    return runs, sum(file.stat().st_size for file in folder.glob(f"{STORE_NAME}*"))


def watched(command: list[str], folder: Path, processes: dict[str, int], kill_at: int | None) -> Iterator[str]:
    """Run the command, and say what it has stored and what memory each process has; killed (-9) at so many runs."""
    start = time.perf_counter()
    study = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    everyone = {"study": study.pid, **processes}
    peak = dict.fromkeys(everyone, 0.0)
    begun = {name: cpu_s(pid) for name, pid in everyone.items()}
    spent, next_said = dict(begun), 0
    while study.poll() is None:
        time.sleep(EVERY_S)
        for name, pid in everyone.items():
            peak[name] = max(peak[name], resident_mb(pid))
            spent[name] = max(spent[name], cpu_s(pid))
        runs, size = stored(folder)
        if runs >= next_said:
            memory = ", ".join(f"{name} {resident_mb(pid):.0f}" for name, pid in everyone.items())
            yield f"{time.perf_counter() - start:6.1f} s: {runs} runs, {size / MB:.0f} MB; resident MB: {memory}"
            next_said = runs + 100_000
        if kill_at is not None and runs >= kill_at:
            study.send_signal(signal.SIGKILL)
            study.wait()
            yield f"killed at {runs} runs"
            return
    runs, size = stored(folder)
    each = f"{size / max(runs, 1):.0f} bytes a run"
    yield f"{time.perf_counter() - start:6.1f} s: {runs} runs, {size / MB:.1f} MB, {each}; code {study.returncode}"
    yield "peak resident MB: " + ", ".join(f"{name} {value:.0f}" for name, value in peak.items())
    yield "processor s: " + ", ".join(f"{name} {spent[name] - begun[name]:.1f}" for name in spent)


def main() -> None:
    """Measure, and print as it goes."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("study", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--kill-at", type=int)
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    asked = parser.parse_args()
    command = [str(Path(sys.executable).with_name("rockcheck")), "study", str(asked.study), "--out", str(asked.folder)]
    with cluster(asked.workers) as (address, processes):
        command += ["--quiet", "--dask", address]
        if asked.kill_at is not None:
            for line in watched(command, asked.folder, processes, asked.kill_at):
                print(line, flush=True)
            command.append("--resume")
        for line in watched(command, asked.folder, processes, None):
            print(line, flush=True)


if __name__ == "__main__":
    main()
