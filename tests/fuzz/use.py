"""What is done with a file that a user hands in, as far as it goes: read, computed with, and the results written.

Every function takes the file's path, writes into the folder `WRITTEN` beside it and raises `InputError` or `MeshError` where the
file is refused.
"""

import json
import re
import resource
import shlex
import shutil
from contextlib import ExitStack, chdir, redirect_stderr
from dataclasses import replace
from decimal import Decimal
from functools import lru_cache
from io import StringIO
from itertools import islice
from pathlib import Path
from typing import Any, Final, NoReturn
from unittest.mock import patch

from typer.testing import CliRunner

from harness import InputError, Mistake, Scene, load_scene, read_history, simulate
from harness.input.files import decoded
from harness.input.motions import readers
from harness.input.motions.inspect import inspect_file
from harness.input.motions.readers import read_record
from harness.input.tables import read_model
from harness.model import history_file, write_json
from harness.questions.bench.standard_scenes import COLUMN, harmonic, scene_of
from harness.questions.effects3d import EffectsFile, changed_scene
from harness.questions.scene.scene_run import run_scene, write_result
from harness.questions.study.cases import base_of, base_of_scene, expand, load_study
from harness.questions.trust import Plane, Points, engines_of, trust_map
from harness.questions.validate import scenes as test_scenes
from harness.questions.validate.drops import read_drops
from harness.questions.validate.scenes import read_table
from harness.questions.validate.tosses import read_tosses
from harness.records.base import write_whole
from harness.runs.execute import Campaign
from harness.runs.progress import ProgressMessages, progress
from harness.runs.runner import InlinePool
from harness.runs.store import STORE_NAME, Store
from reports.cli import app
from reports.cli.app import WRONG_INPUT
from reports.messages import ENGLISH
from reports.terminal import record_lines
from tests.fuzz.records import at2
from tests.stores_for_tests import put

RUN_S: Final = 0.3
"""Seconds that a scene is run for."""
INSTANT_S: Final = 0.1
WRITTEN: Final = "written"
STEERING: Final = ("\x1b", "\x9b", "\r", "\x00", "\x07", "\u202e", "\ud800")
MOST_GROWN_MIB: Final = 1024.0
"""Sixteen times the largest text that is read, for its lines, words and numbers."""
FEW: Final = 2
"""Cases of a study and tests of a table that are run."""
ASSESSED: Final = ("-e", "analytic", "--draws", "12", "--set", f"duration_s={RUN_S}")
POOLS: Final = ("reports.cli.studies", "harness.questions.validate.validation_run")
"""Modules that start worker processes: here each task is run in this one, where its traceback is seen."""


def scene(path: Path) -> None:
    """Read, run for a moment, and write the result."""
    _run(load_scene(path), path)


def study(path: Path) -> None:
    """Read, run the first cases for a moment, and keep them in a store."""
    given = load_study(path)
    base = base_of(given, path)
    cases = [base.scene(case.setting) for case in islice(expand(given, base), FEW)]
    with Store(path.parent / WRITTEN / "store.sqlite") as store:
        for number, case in enumerate(cases):
            put(store, [(str(number), simulate(_short(case), "analytic"))], histories=True)
        if store.keys() != {str(number) for number in range(len(cases))}:
            raise AssertionError("a run that was put into a store is not there")


def effects(path: Path) -> None:
    """Read, and run the first conditions of the first direction for a moment."""
    given = read_model(EffectsFile, path)
    found = base_of_scene(path.parent / given.scene).scene({})
    for condition in given.conditions[:FEW]:
        simulate(_short(changed_scene(found, condition, given.azimuths_deg(given.every)[-1])), "analytic")


def experiments(path: Path) -> None:
    """Read, and run the first tests for a moment, as they are and perturbed."""
    for trial in read_table(path)[:FEW]:
        for sample in (0, 1):
            simulate(_short(test_scenes.scene_of(trial, test_scenes.TrialVariant(trial.inputs(), sample))), "analytic")


def validate(path: Path) -> None:
    """Hand the table of tests to `rockcheck validate`, with the model alone."""
    _command(path, "validate", path.name, "-e", "analytic")


def ratios(path: Path) -> None:
    """Hand the table of impact ratios to `rockcheck validate`."""
    _command(path, "validate", path.name)


def drops(path: Path) -> None:
    """Read measured drops of the square beside them."""
    read_drops(path, load_scene(path.with_name("thrown.toml")))


def tosses(path: Path) -> None:
    """Read measured tosses of the square beside them: the clock by their flights, each start by the nearest flight."""
    body = load_scene(path.with_name("thrown.toml"))
    read_tosses(path, body.statue, body.gravity_m_s2)


def assess(path: Path) -> None:
    """Hand the scene to `rockcheck assess` for a few draws of a moment by the model."""
    _command(path, "assess", path.name, *ASSESSED)


def options(path: Path) -> None:
    """Hand the options to `rockcheck assess` of a good scene."""
    _command(path, "assess", "uncertain.toml", *ASSESSED, "--options", path.name)


def options_of_assess(path: Path) -> None:
    """The words of the file as options of `rockcheck assess`, after those that make it short."""
    _asked(path, ("assess", "uncertain.toml", *ASSESSED), _last(path))


def trust(path: Path) -> None:
    """The trust map of the scene at its weakest and strongest sine of one frequency, for an instant."""
    whole = Plane.of(replace(load_scene(path), duration_s=INSTANT_S), "sine", coarse=True)
    ends = whole.amplitudes_g[0], whole.amplitudes_g[-1]
    plane = replace(whole, amplitudes_g=ends, frequencies_hz=whole.frequencies_hz[-1:])
    names = engines_of(plane.at(plane.points[-1]), ("pymunk",), coarse=True)
    with Store(path.with_name(WRITTEN) / STORE_NAME, "trust") as kept:
        record = trust_map(plane, names, Points(kept, Campaign(kept, InlinePool())), coarse=True, seed=0)
    write_whole(path.with_name(WRITTEN), record.texted(ENGLISH.say))


def motion(path: Path) -> None:
    """Read, and write what `rockcheck motion inspect` tells."""
    found = inspect_file(path).record(ENGLISH.say)
    (path.parent / WRITTEN).mkdir()
    write_json(path.parent / WRITTEN / "motion.json", found)


def history(path: Path) -> None:
    """Read, and write anew: it must read back."""
    found = read_history(path)
    (path.parent / WRITTEN).mkdir()
    found.write_csv(path.parent / WRITTEN / "history_again.csv")


def mesh(path: Path) -> None:
    """Stand the body on the floor, run it for a moment, and write the result with its picture."""
    given = {"file": str(path), "unit": "m", "density_kg_m3": 2700.0}
    _run(scene_of("mesh", {"duration_s": RUN_S, "statue": {"mesh": given}, "motion": harmonic(0.3, 2.0)}), path)


def store(path: Path) -> None:
    """Read what is in it, and put a result into it, which must be there afterwards with what was there before."""
    still = scene_of("still", {"duration_s": 0.01, "statue": COLUMN})
    with Store(path) as found:
        before, _ = found.get("key"), found.history("key")
        put(found, [("another", simulate(still, "analytic"))], histories=True)
        if found.keys().isdisjoint({"another"}) or found.get("key") != before:
            raise AssertionError("a store that took a result lost one")


def title(path: Path) -> None:
    """Read, run, write, and tell: on a terminal nothing but text arrives, on as many lines as there are."""
    scene = load_scene(path)
    with (
        redirect_stderr(StringIO()) as stream,
        progress(scene.title, quiet=False) as told,
        ProgressMessages(quiet=False) as telling,
    ):
        told(1, 2)
        telling.now(scene.title)
    result = run_scene(_short(scene), ("analytic",))
    write_result(result, path.parent / WRITTEN)
    said = stream.getvalue() + "\n".join(record_lines(result.record().texted(ENGLISH.say)))
    if any(mark in said for mark in STEERING):
        raise AssertionError(f"a title steers the terminal: {said[:200]!r}")


def step(path: Path) -> None:
    """Read an AT2: the step must be what Fortran would read in its header."""
    record = readers.read_file(path)
    if record.format != "PEER AT2":
        return
    line = decoded(path.read_bytes(), "", "", latin=True).splitlines()[3]
    named = re.split(r"DT\s*=\s*", line, flags=re.IGNORECASE)
    if len(named) < 2:  # the older layout: number and step without their names
        return
    token = named[1]
    token = re.split(r"[\s,]|SEC", token, flags=re.IGNORECASE)[0].upper().replace("D", "E")
    meant = float(Decimal(re.sub(r"(?<=[0-9.])([+-][0-9]{3})$", r"E\1", token)))
    if record.channels[0].dt_s != meant:
        raise AssertionError(f"a step of {token} is read as {record.channels[0].dt_s}")


def packed(path: Path) -> None:
    """Read a packed record: no more is unpacked than may be read."""
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    try:
        motion(path)
    finally:
        grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024
        if grown > MOST_GROWN_MIB:
            raise AssertionError(f"reading {path.stat().st_size} bytes took {grown:.0f} MiB")


def sister(path: Path) -> None:
    """Read the good record beside it: whatever the sister is, it costs no more than itself."""
    good = path.with_name("RSN1_B_090.at2")
    good.write_bytes(at2())
    try:
        record = read_record(good)
        if record.channels[0].name != "090" or len(record.channels) > 2:
            raise AssertionError("a sister changed the record beside it")
        packed(path)
    finally:
        good.unlink()


def folder(path: Path) -> None:
    """Write a result into a folder whose record this is: no file that another wrote may be lost or changed."""
    there = path.with_name("theirs")
    there.mkdir()
    theirs = {"history_measured.csv": b"t_s,theta_rad\n0,0\n", "scan.glb": b"glTF", "notes.txt": b"mine"}
    mine = {"history_analytic.csv": b"t_s\n", "report.html": b"<html>"}
    try:
        (there / path.name).write_bytes(path.read_bytes())
        for name, content in (theirs if _is_json(path) else theirs | mine).items():
            (there / name).write_bytes(content)
        before = {item.name: item.read_bytes() for item in there.iterdir()}
        try:
            write_into(path.with_name("good.toml"), there)
        except InputError:
            if {item.name: item.read_bytes() for item in there.iterdir()} != before:
                raise AssertionError("a folder that was refused is not as it was") from None
            raise
        if any((there / name).read_bytes() != content for name, content in theirs.items()):
            raise AssertionError("a file that is another's was changed")
    finally:
        shutil.rmtree(there)


def _is_json(path: Path) -> bool:
    try:
        json.loads(path.read_bytes())
    except ValueError:
        return False
    return True


def write_into(scene_file: Path, folder: Path) -> None:
    """Run a scene for a moment and write the result into a folder."""
    write_result(_of_a_moment(scene_file.read_bytes(), scene_file), folder)


@lru_cache(maxsize=1)
def _of_a_moment(content: bytes, scene_file: Path) -> Any:
    """The result of a scene, run once for all folders."""
    return run_scene(replace(load_scene(scene_file), duration_s=0.01), ("analytic",))


def new(path: Path) -> None:
    """The words of the file as options of `rockcheck new`, for a good scan and record; the scene that it writes is run."""
    out = path.parent / WRITTEN / "new.toml"
    out.parent.mkdir()
    _asked(path, ("new", "stone.ply"), ("--json", "--out", str(out)))
    _run(load_scene(out), path.with_name(WRITTEN) / path.name)


def run(path: Path) -> None:
    """The words of the file as options of `rockcheck run`, for a good scene, cut short."""
    _asked(path, ("run", "good.toml"), ("--set", f"duration_s={RUN_S}", "--no-assess", *_last(path)))


def _last(path: Path) -> tuple[str, ...]:
    """The last options of a command: its record as text, its result beside the file."""
    return ("--json", "--out", str(path.parent / WRITTEN))


def described(path: Path) -> None:
    """The words of the file as options of `rockcheck motion inspect`, for a text that no reader knows."""
    _asked(path, ("motion", "inspect", "any.txt"), _last(path))


def _asked(path: Path, first: tuple[str, ...], last: tuple[str, ...]) -> None:
    """Run a command in the file's folder with its words as options between these; what it refuses is an `InputError`."""
    try:
        words = shlex.split(path.read_bytes().decode("utf-8", "surrogateescape"))
    except ValueError as error:
        raise InputError(Mistake("shell", "", "whole quotes", str(error))) from error
    if any("\0" in word for word in words):
        raise InputError(Mistake("shell", "", "words", "a NUL"))
    _invoked(path.parent, *first, *words, *last)


def _command(path: Path, *words: str) -> None:
    """Run a command in the file's folder, its result beside the file; what it refuses is an `InputError`."""
    _invoked(path.parent, *words, *_last(path))


def _invoked(there: Path, *words: str) -> None:
    with ExitStack() as stack:
        for name in POOLS:
            stack.enter_context(patch(f"{name}.LocalPool", lambda *given: InlinePool()))
        stack.enter_context(chdir(there))
        done = CliRunner().invoke(app, words)
    if isinstance(done.exception, InputError):
        raise done.exception
    if done.exit_code == WRONG_INPUT:
        raise InputError(Mistake(" ".join(words[:2]), "", "options", done.output[-300:]))
    if done.exception is not None and not isinstance(done.exception, SystemExit):
        raise done.exception


def result(path: Path) -> None:
    """Write the pages of a whole result folder whose record this is."""
    there = path.with_name(WRITTEN)
    there.mkdir()
    write_into(path.with_name("good.toml"), there)
    (there / "result.json").write_bytes(path.read_bytes())
    try:
        done = CliRunner().invoke(app, ["report", str(there), "--quiet"])
    except BaseException:
        shutil.rmtree(there)
        raise
    if done.exception is not None:
        shutil.rmtree(there)
        if isinstance(done.exception, SystemExit):
            raise InputError(Mistake("report", "", "a record", done.output[-300:]))
        raise done.exception


def unfinished(folder: Path, accepted: bool) -> str | None:
    """What was left half-written in a folder: files of a refused input, or of an accepted one that do not read back whole."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    if not accepted:
        return f"written though refused: {', '.join(path.name for path in files)}" if files else None
    names = {path.name for path in files}
    for path in files:
        try:
            if path.suffix == ".json":
                found = json.loads(path.read_text(encoding="utf-8"), parse_constant=_refuse)
                wanted = {history_file(name) for name in found.get("histories", ())}
                if not wanted <= names:
                    return f"{path.name} names {', '.join(sorted(wanted - names))}, which is not there"
            elif path.suffix == ".csv":
                read_history(path)
            elif path.name.startswith(".") or path.stat().st_size == 0:
                return f"{path.name} is left, or empty"
        except (InputError, ValueError) as error:
            return f"{path.name} does not read back: {error}"
    return None


def _refuse(constant: str) -> NoReturn:
    raise ValueError(f"{constant} is no JSON")


def _short(given: Scene) -> Scene:
    return replace(given, duration_s=min(given.duration_s, RUN_S))


def _run(given: Scene, path: Path) -> Any:
    write_result(run_scene(_short(given), ("analytic",)), path.parent / WRITTEN)
