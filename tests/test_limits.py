"""How large a file and a function of the product may be: what one reader can hold at once."""

from __future__ import annotations

import ast
import io
import re
import statistics
import subprocess
import sys
import tokenize
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests import budgets

PACKAGES = ("analytic", "meshes", "harness", "reports")
ALONE = {"tests/measures/trivial.py"}
"""Small modules that must stand alone: the least compiled module, whose first call is timed in a process of its own."""

REASONED = ("harness/engines/", "analytic/kernel/", "analytic/spatial/kernel/")
"""Rooms whose every module has comments that say why."""
DIRECTIVE = re.compile(r"#\s*(noqa|type:|fmt:|pragma)")


def sources(root: Path) -> dict[str, str]:
    """Every module of the product by its path."""
    paths = [path for package in PACKAGES for path in (root / package).rglob("*.py")]
    return {path.relative_to(root).as_posix(): path.read_text(encoding="utf-8") for path in paths}


@pytest.fixture(scope="module")
def product() -> dict[str, str]:
    return sources(Path(__file__).resolve().parents[1])


def long_files(modules: dict[str, str]) -> dict[str, int]:
    return {name: count for name, text in modules.items() if (count := text.count("\n")) > budgets.FILE_LINES}


def functions(text: str) -> Iterator[tuple[str, int]]:
    """Every function's name and lines."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            yield node.name, (node.end_lineno or node.lineno) - node.lineno + 1


def long_functions(modules: dict[str, str]) -> dict[str, int]:
    counted = {f"{name}:{function}": count for name, text in modules.items() for function, count in functions(text)}
    return {name: count for name, count in counted.items() if count > budgets.FUNCTION_LINES}


def importers(modules: dict[str, str], name: str) -> set[str]:
    """Modules of the product that import another."""
    full = name.removesuffix(".py").replace("/", ".")
    package, _, module = full.rpartition(".")

    def imports(node: ast.AST) -> bool:
        if isinstance(node, ast.Import):
            return full in {item.name for item in node.names}
        if not isinstance(node, ast.ImportFrom):
            return False
        return node.module == full or (node.module == package and module in {item.name for item in node.names})

    return {other for other, text in modules.items() if any(map(imports, ast.walk(ast.parse(text))))}


def small_files(modules: dict[str, str]) -> set[str]:
    """Modules of few lines that one other imports, or none."""
    small = {
        name
        for name, text in modules.items()
        if text.count("\n") < budgets.LEAST_FILE_LINES and not name.endswith("__init__.py")
    }
    return {name for name in small if len(importers(modules, name)) < 2}


def without_reasons(modules: dict[str, str], rooms: tuple[str, ...] = REASONED) -> set[str]:
    """Modules of these rooms that hold code and no comment: of an equation, an assumption or a measurement."""

    def is_reason(token: tokenize.TokenInfo) -> bool:
        return token.type == tokenize.COMMENT and not DIRECTIVE.match(token.string)

    return {
        name
        for name, text in modules.items()
        if name.startswith(rooms)
        and not all(isinstance(node, ast.Expr | ast.ImportFrom) for node in ast.parse(text).body)
        if not any(map(is_reason, tokenize.generate_tokens(io.StringIO(text).readline)))
    }


def test_every_module_of_engines_and_kernels_gives_a_reason(product: dict[str, str]) -> None:
    assert without_reasons(product) == set()


def test_no_file_is_too_long(product: dict[str, str]) -> None:
    assert long_files(product) == {}
    assert statistics.median(text.count("\n") for text in product.values()) < budgets.MEDIAN_FILE_LINES


def test_no_function_is_too_long(product: dict[str, str]) -> None:
    assert long_functions(product) == {}


def test_no_small_file_serves_one_other(product: dict[str, str]) -> None:
    assert small_files(product) == set()


def test_few_functions_are_complex(root: Path, product: dict[str, str]) -> None:
    command = [sys.executable, "-m", "ruff", "check", "--isolated", "--select", "C901", "--output-format", "concise"]
    setting = f"lint.mccabe.max-complexity={budgets.COMPLEXITY}"
    done = subprocess.run([*command, "--config", setting, *PACKAGES], cwd=root, capture_output=True, text=True)
    assert done.returncode in (0, 1), done.stderr
    count = sum(1 for text in product.values() for _ in functions(text))
    assert done.stdout.count(" C901 ") <= budgets.COMPLEX_SHARE * count, done.stdout


def test_what_is_over_a_limit_is_seen() -> None:
    body = "def f():\n" + "    pass\n" * budgets.FILE_LINES
    modules = {"room/__init__.py": "", "room/a.py": body, "room/b.py": "from room import c\n", "room/c.py": "x = 1\n"}
    assert set(long_files(modules)) == {"room/a.py"}
    assert set(long_functions(modules)) == {"room/a.py:f"}
    assert small_files(modules) == {"room/b.py", "room/c.py"}
    assert small_files(modules | {"room/d.py": "import room.c\n" * 30}) == {"room/b.py"}


def test_a_module_without_a_reason_is_seen() -> None:
    modules = {
        "room/a.py": '"""A."""\nx = 1  # noqa: A\n',
        "room/b.py": '"""B."""\nx = 1  # eq. 3\n',
        "room/c.py": '"""C."""\n',
    }
    assert without_reasons(modules, ("room/",)) == {"room/a.py"}
