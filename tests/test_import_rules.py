"""The import rules of pyproject.toml hold, and each is seen to catch a violation."""

import graphlib
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import grimp
import pytest

VIOLATIONS = {
    "imports point one way": ("analytic/block.py", "import harness.model.errors"),
    "pymunk is imported by its own adapter only": ("harness/statics/plan.py", "import pymunk"),
    "pybullet is imported by its own adapter only": ("reports/pages/page.py", "import pybullet"),
    "comparator, records and reports know no engine": ("harness/comparison/comparator.py", "import harness.engines"),
    "engines are leaves: none knows another": ("harness/engines/pymunk/__init__.py", "import harness.engines.analytic"),
    "compiled code depends on nothing but itself": ("analytic/kernel/impact.py", "import analytic.block"),
    "the analytic model stands alone": ("analytic/block.py", "import trimesh"),
    "down the rooms of the harness": ("harness/statics/plan.py", "import harness.comparison.comparator"),
    "down the questions": ("harness/questions/study/study_run.py", "import harness.questions.bench.parts"),
}


def lint(folder: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", "from importlinter.cli import lint_imports_command as c; c()", "--no-cache"]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


@pytest.fixture
def copy(root: Path, tmp_path: Path) -> Path:
    for name in ("analytic", "meshes", "harness", "reports"):
        shutil.copytree(root / name, tmp_path / name, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(root / "pyproject.toml", tmp_path)
    return tmp_path


def test_every_rule_has_a_violation_here(root: Path) -> None:
    rules = tomllib.loads((root / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"]
    assert {rule["name"] for rule in rules} == set(VIOLATIONS)


def test_the_tree_keeps_the_rules(copy: Path) -> None:
    done = lint(copy)
    assert done.returncode == 0, done.stdout


def test_each_rule_catches_its_violation(copy: Path) -> None:
    for name, line in VIOLATIONS.values():
        path = copy / name
        path.write_text(f"{path.read_text()}\n{line}\n")
    done = lint(copy)
    assert done.returncode != 0, done.stdout
    told = done.stdout.partition("Broken contracts")[2]
    for rule, (name, line) in VIOLATIONS.items():
        (_, own) = told.split(f"\n{rule}\n")
        module = name.removesuffix(".py").removesuffix("/__init__").replace("/", ".")
        found = f"{module} -> {line.removeprefix('import ')} "
        assert found in own.partition("\n\n\n")[0], (rule, found, told)


def sorted_modules(imports: dict[str, set[str]]) -> tuple[str, ...]:
    """Modules after all that they import. Raises `graphlib.CycleError` for those that import each other."""
    return tuple(graphlib.TopologicalSorter(imports).static_order())


def test_no_module_imports_one_that_imports_it() -> None:
    """Imports for types alone count too."""
    graph = grimp.build_graph("analytic", "meshes", "harness", "reports", cache_dir=None)
    imports = {module: graph.find_modules_directly_imported_by(module) for module in graph.modules}
    assert len(sorted_modules(imports)) > len(VIOLATIONS)


def test_a_circle_is_seen() -> None:
    with pytest.raises(graphlib.CycleError):
        sorted_modules({"a": {"b"}, "b": {"c"}, "c": {"a"}})
