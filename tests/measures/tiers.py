"""Which files of tests are fast: `python -m tests.measures.tiers [PATH...]` runs them and renews `tests/fast.txt`.

A file is fast that takes at most `MOST_S` of the processor and in which no engine runs more than `SINGLE_STEPS` steps. With paths
only what is below these is measured, the others stay as they are.
"""

import os
import sys
from collections import defaultdict
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Final

import pytest

from harness import engines

ROOT: Final = Path(__file__).resolve().parents[2]
LISTED: Final = ROOT / "tests" / "fast.txt"
MOST_S: Final = 3.5
"""Seconds of the processor of a whole file: the fast tier is to stay under a minute in all."""
SINGLE_STEPS: Final = 10


class Measured:
    """A plugin of pytest that adds up, by file, processor time and the longest run of an engine."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = defaultdict(float)
        self.steps: dict[str, int] = defaultdict(int)
        self._file = ""

    def pytest_configure(self) -> None:
        """Have every engine tell how many steps its runs take."""
        for name in engines.REGISTRY:
            kind = type(engines.load(name))
            kind.simulate = self._counted(kind.simulate)  # type: ignore[method-assign]

    def _counted(self, simulate: Callable[..., Any]) -> Callable[..., Any]:
        def counted(*given: Any, **named: Any) -> Any:
            run = simulate(*given, **named)
            self.steps[self._file] = max(self.steps[self._file], run.steps)
            return run

        return counted

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        """Time one test, its fixtures and the processes that it began included."""
        self._file = item.path.relative_to(ROOT).as_posix()
        begin = sum(os.times()[:4])
        done = yield
        self.seconds[self._file] += sum(os.times()[:4]) - begin
        return done

    def fast(self) -> set[str]:
        """The files that are."""
        return {
            file
            for file, seconds in self.seconds.items()
            if seconds <= MOST_S and self.steps[file] <= SINGLE_STEPS and not file.startswith("tests/measures/")
        }


def main(paths: list[str]) -> int:
    """Measure and write the list; what pytest ends with."""
    found = Measured()
    ended = int(pytest.main(["-q", "-p", "no:cacheprovider", *(paths or ["tests"])], plugins=[found]))
    before = set(LISTED.read_text(encoding="utf-8").split())
    kept = {file for file in before - found.seconds.keys() if (ROOT / file).is_file()}
    LISTED.write_text("\n".join(sorted(kept | found.fast())) + "\n", encoding="utf-8")
    return ended


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
