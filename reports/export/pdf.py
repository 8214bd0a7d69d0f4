"""A page printed to PDF by the machine's own Chromium: the stills in place of the live charts, nothing folded away."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Final

from harness.model.errors import InputError, Mistake
from harness.model.files import check_own, writing
from reports.pages.assets import source_text

BROWSERS: Final = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
LIMIT_S: Final = 180.0
"""A page of 15 MB prints in some ten seconds; a browser that takes longer than this hangs."""
_SCRIPT: Final = re.compile(r"<script\b.*?</script>", re.DOTALL)
_PAGE_LINK: Final = re.compile(r' href="(?:report|conservator)\.html"')
"""Links to pages beside this one, which would name a folder of this machine in the PDF."""


def browser() -> str:
    """The path of the browser that prints. Raises `InputError` where there is none."""
    path = next(filter(None, map(shutil.which, BROWSERS)), None)
    if path is None:
        wanted = "Chromium on this machine, which prints the page"
        raise InputError(Mistake("--pdf", "", wanted, "none found", "on Debian: apt-get install chromium"))
    return path


def write_pdf(page: Path) -> Path:
    """Print a page beside itself, as .pdf; returns that file.

    Raises `InputError` without a browser, for a PDF of another's making in the way, and where the browser fails.
    """
    program, target = browser(), page.with_suffix(".pdf")
    check_own(target, option="--pdf")
    text = _PAGE_LINK.sub("", _SCRIPT.sub("", page.read_text(encoding="utf-8")))
    text = text.replace("</body>", f"<script>{source_text('units.js')}</script></body>")
    with tempfile.TemporaryDirectory() as spare, writing(target) as fresh:
        copy, printed = Path(spare, page.name), Path(spare, target.name)
        copy.write_text(
            text.replace('<details class="', '<details open class="').replace("<details>", "<details open>"), "utf-8"
        )
        # Chromium refuses its sandbox to root.
        alone = ["--no-sandbox"] if os.geteuid() == 0 else []
        options = ["--headless", *alone, "--disable-gpu", f"--user-data-dir={spare}/profile", "--no-pdf-header-footer"]
        call = [program, *options, f"--print-to-pdf={printed}", copy.as_uri()]
        try:
            done = subprocess.run(call, capture_output=True, text=True, timeout=LIMIT_S, check=False)
        except subprocess.TimeoutExpired as error:
            raise InputError(Mistake("--pdf", "", f"a PDF within {LIMIT_S:g} s", f"none from {program}")) from error
        if not printed.is_file():
            said = done.stderr.strip().splitlines()[-1:] or ["nothing"]
            raise InputError(Mistake("--pdf", "", "a PDF", f"none: {program} ended with {done.returncode}, {said[0]}"))
        fresh.write_bytes(printed.read_bytes())
    return target
