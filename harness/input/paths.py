"""Where the files that a scene names are: beside the scene, absolute, or in the data folder."""

import os
from collections.abc import Iterator, Mapping
from pathlib import Path

from pydantic import JsonValue

from harness.model import require

DATA_VARIABLE = "ROCKCHECK_DATA"
_PREFIX = "${" + DATA_VARIABLE + "}"


def data_folder() -> Path:
    """The folder of real scans and records: the variable ROCKCHECK_DATA, else `../shared/data` beside the project."""
    named = os.environ.get(DATA_VARIABLE)
    return Path(named) if named else Path(__file__).resolve().parents[3] / "shared" / "data"


def is_file(path: Path) -> bool:
    """Whether there is such a file; a name too long or with a NUL in it, which the system refuses to look up, is none."""
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def resolve(file: str, *, base_dir: Path, where: str, key: str) -> Path:
    """The existing file that `file` names: absolute, relative to `base_dir`, or starting with "${ROCKCHECK_DATA}/".

    Raises InputError (with `where` and `key`) where there is no such file.
    """
    require(
        not file.startswith("$") or file.startswith(_PREFIX + "/"),
        where,
        f'a path, of variables only "{_PREFIX}/…"',
        repr(file),
        "write it out",
        key=key,
    )
    path = _named(file, base_dir)
    require(
        is_file(path),
        where,
        "an existing file",
        str(path),
        f"set {DATA_VARIABLE} to the folder of scans and records"
        if file.startswith(_PREFIX)
        else ("" if Path(file).is_absolute() else "a relative path starts at the scene's folder"),
        key=key,
    )
    return path.resolve()


def read_files(content: Mapping[str, JsonValue], source: Path | None) -> list[Path]:
    """The existing files that a scene's content (as read from `source`) names, whatever their keys, and the scene's own."""
    files, folder = ([], Path()) if source is None else ([source], source.parent)
    for text in _texts(content):
        files += [path] if is_file(path := _named(text, folder)) else []
    return files


def _named(file: str, base_dir: Path) -> Path:
    """The path that a scene's text names."""
    if file.startswith(_PREFIX):
        return data_folder() / file[len(_PREFIX) + 1 :]
    # Unlike that of a Path, it leaves a title that begins with a tilde as it is.
    return base_dir / os.path.expanduser(file)


def _texts(value: object) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, (Mapping, list)):
        for item in value.values() if isinstance(value, Mapping) else value:
            yield from _texts(item)
