"""What the documents show of the program, made again by one command: `python -m tests.measures.documents` (two minutes).

It renews the README's first run as the terminal prints it, its pictures of the page (by an installed Chromium) and of the coarse
trust map, and the outputs of docs/example.ipynb. The tutorial's lines are held to the program by tests/reports/test_tutorial.py.
"""

import ast
import json
import os
import sys
from io import BytesIO
from pathlib import Path
from typing import Any, Final

from harness.questions.trust import run_trust
from reports.charts.figure import svg
from reports.pages.study_page import trust_map
from tests.measures.page_cost import READY_LIMIT_MS, chromium
from tests.measures.pages import DOCS, renewed

MODULE: Final = "tests.measures.documents"
ROOT: Final = DOCS.parent
SCENE: Final = "scenes/paestum_pedestal.toml"
LINES: Final = 12
"""Of what is printed: title, answer, engines and pairs."""
SHEET: Final = {"width": 885, "height": 1920}
MAP_PX: Final = 520
"""Width of a trust map: two stand side by side."""
COLOURS: Final = 128
"""Of the picture: a third of its bytes, no difference to the eye."""


def first_run(out: Path) -> str:
    """The README's run with its first lines, as a block of the page; its result is in the folder."""
    from typer.testing import CliRunner

    from reports.cli import app

    done = CliRunner().invoke(app, ["run", str(ROOT / SCENE), "--out", str(out)])
    if done.exit_code:
        raise RuntimeError(done.output)
    return "\n".join(["```console", f"$ .venv/bin/rockcheck run {SCENE}", *done.stdout.splitlines()[:LINES], "```"])


def picture(page: Path, to: Path) -> None:
    """The top of a page, drawn by Chromium. Raises `NoBrowser`."""
    from PIL import Image

    with chromium() as browser:
        tab = browser.new_page(viewport=SHEET)  # type: ignore[arg-type]
        tab.goto(page.as_uri())
        tab.wait_for_function("window.rockcheck && window.rockcheck.readyMs > 0", timeout=READY_LIMIT_MS)
        Image.open(BytesIO(tab.screenshot())).quantize(COLOURS).save(to, optimize=True)


def maps(out: Path) -> list[Path]:
    """The coarse trust map of that scene with and without its pedestal, as pictures."""
    record = run_trust(ROOT / SCENE, out, coarse=True, quiet=True)
    paths = []
    for each in record.maps:
        paths.append(DOCS / "images" / f"trust_{each.stands_on}.svg")
        paths[-1].write_text(svg(trust_map(each, record.maps[-1]), MAP_PX, background="white"), encoding="utf-8")
    return paths


def executed(notebook: dict[str, Any], names: dict[str, object]) -> dict[str, Any]:
    """A notebook with its cells run one after another in a module's names, each with the text of what it shows."""
    cells = []
    for number, cell in enumerate(notebook["cells"]):
        if cell["cell_type"] == "code":
            tree = ast.parse("".join(cell["source"]))
            last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
            exec(compile(tree, f"cell {number}", "exec"), names)
            outputs = []
            if isinstance(last, ast.Expr):
                value = eval(compile(ast.Expression(last.value), f"cell {number}", "eval"), names)
                if " object at 0x" not in repr(value):
                    data = {"text/plain": repr(value).splitlines(keepends=True)}
                    outputs.append(
                        {"output_type": "execute_result", "data": data, "execution_count": None, "metadata": {}}
                    )
            cell = {**cell, "outputs": outputs}
        cells.append(cell)
    return {**notebook, "cells": cells}


def main() -> None:
    """Renew what README and notebook show."""
    import matplotlib as mpl

    mpl.use("Agg")
    os.chdir(ROOT)
    out = ROOT / "out" / "documents"
    readme, example = ROOT / "README.md", DOCS / "example.ipynb"
    readme.write_text(renewed(readme.read_text(encoding="utf-8"), MODULE, first_run(out)), encoding="utf-8")
    picture(out / "report.html", DOCS / "images" / "report.png")
    drawn = maps(ROOT / "out" / "documents-trust")
    cells = executed(json.loads(example.read_text(encoding="utf-8")), {})
    example.write_text(json.dumps(cells, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    names = ", ".join(str(path.relative_to(ROOT)) for path in drawn)
    sys.stdout.write(f"renewed: README.md, docs/images/report.png, {names}, docs/example.ipynb\n")


if __name__ == "__main__":
    main()
