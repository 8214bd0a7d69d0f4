"""What pages cost: `python -m tests.measures.page_cost DIR...` writes pages of result folders anew and opens them.

For each folder: the time of writing (first and again: the first loads the libraries), the bytes, and the time from opening the
file to a page that answers (`rockcheck.readyMs`, which the page itself keeps), best and worst of some openings in a browser
context of its own.
"""

from __future__ import annotations

import argparse
import shutil
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Final

from reports.cli.app import FAILED, OK, guarded
from reports.pages.page import chart_library, write_report

if TYPE_CHECKING:
    from playwright.sync_api import Browser

QUIET_FLAGS: Final = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)
REPEATS: Final = 3
DESK: Final = {"width": 1280, "height": 900}
READY_LIMIT_MS: Final = 60_000


class NoBrowser(Exception):
    """There is nothing here to open a page with; the message says what is missing and how to get it."""


@contextmanager
def chromium() -> Iterator[Browser]:
    """The machine's own Chromium without a window, ended afterwards. Raises `NoBrowser`."""
    path = shutil.which("chromium") or shutil.which("chromium-browser")
    if path is None:
        raise NoBrowser("no Chromium on this machine (on Debian: apt-get install chromium)")
    if find_spec("playwright") is None:
        raise NoBrowser("playwright is not installed (extra `dev`)")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as play:
        browser = play.chromium.launch(executable_path=path, args=list(QUIET_FLAGS))
        yield browser
        browser.close()


def ready_ms(browser: Browser, page: Path, repeats: int = REPEATS) -> list[float]:
    """Times, ms, from opening a page's file to its being drawn and answering, in rising order."""
    found = []
    for _ in range(repeats):
        context = browser.new_context(viewport={"width": DESK["width"], "height": DESK["height"]})
        opened = context.new_page()
        opened.goto(page.resolve().as_uri())
        opened.wait_for_selector("html[data-ready=yes]", timeout=READY_LIMIT_MS)
        found.append(float(opened.evaluate("rockcheck.readyMs")))
        context.close()
    return sorted(found)


def writing_s(folder: Path) -> tuple[Path, float]:
    """Write a folder's pages; the first page and the wall time, s."""
    begin = time.perf_counter()
    page = write_report(folder)
    return page, time.perf_counter() - begin


def measured(browser: Browser, page: Path) -> str:
    """Bytes of a page and how fast it is ready, in words."""
    times = ready_ms(browser, page)
    return f"{page.stat().st_size / 1e6:.1f} MB, ready in {times[0] / 1e3:.2f} to {times[-1] / 1e3:.2f} s"


def run(folders: Sequence[Path]) -> int:
    """Print one line for each folder; 1 when there is no browser."""
    print(f"chart library: {len(chart_library()) / 1e6:.2f} MB of each page", flush=True)
    try:
        with chromium() as browser:
            for folder in folders:
                page, first_s = writing_s(folder)
                _, again_s = writing_s(folder)
                print(
                    f"{folder}: written in {first_s:.1f} s (again {again_s:.1f} s); {measured(browser, page)}",
                    flush=True,
                )
    except NoBrowser as missing:
        print(f"not measured: {missing}", file=sys.stderr)
        return FAILED
    return OK


def main() -> int:
    """Measure the folders named on the command line."""
    words = argparse.ArgumentParser(prog="python -m tests.measures.page_cost", description=__doc__)
    words.add_argument("folder", metavar="DIR", nargs="+", type=Path, help="a folder with a result.json")
    return run(words.parse_args().folder)


if __name__ == "__main__":
    sys.exit(guarded(main))
