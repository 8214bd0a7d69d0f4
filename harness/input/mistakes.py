"""Turn validation errors into mistakes that name file, key, line, what was wanted and what came."""

import re
from collections.abc import Callable, Iterator, Mapping
from typing import Any, Final, get_args, get_origin

from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic_core import ErrorDetails

from harness.model import Mistake, nearest

_WANTED: Mapping[str, str] = {
    "missing": "this key",
    "float_type": "a number",
    "int_type": "a whole number",
    "string_type": "a text in quotes",
    "string_unicode": "a text in UTF-8",
    "bool_type": "true or false",
    "model_type": "a table",
    "model_attributes_type": "a table",
    "dataclass_type": "a table",
    "mapping_type": "a table",
    "dict_type": "a table",
    "list_type": "a list",
    "tuple_type": "a list",
    "named_tuple_type": "a list",
    "finite_number": "a finite number",
    "union_tag_not_found": "a key `kind`",
    "union_tag_invalid": "one of {expected_tags}",
    "literal_error": "one of {expected}",
    "enum": "one of {expected}",
    "value_error": "{error}",
    "greater_than": "a number more than {gt:g}",
    "greater_than_equal": "a number at least {ge:g}",
    "less_than": "a number less than {lt:g}",
    "less_than_equal": "a number at most {le:g}",
    "string_too_short": "a text that is not empty",
    "too_short": "at least {min_length} of them",
    "too_long": "at most {max_length} of them",
    "string_pattern_mismatch": "a text like {pattern}",
}
"""What was wanted, by pydantic's name of the error, whose context fills it in."""


MOST_MISTAKES: Final = 20
TYPE_NAME: Final = re.compile(
    r"float|int|str|bool|(list|tuple)(\[.*\])?|function-.*|lax-or-strict.*|constrained-.*|literal\[.*|[A-Z]\w*(\[.*\])?|\[key\]"
)
"""What pydantic puts into a location beside keys: the branch of a union, or that the key itself is wrong."""
UNKNOWN: Final = "extra_forbidden"
"""Pydantic's word for a key that its table does not have."""
KINDS: Final = {
    "statue": ("a scene", "rockcheck run"),
    "variant": ("a study", "rockcheck study"),
    "option": ("options", "rockcheck assess SCENE --options"),
}
"""By a key that no other file has: what a file is, and the command that takes it."""


class UserTable(BaseModel):
    """Base of every table that a user writes: strict types, no unknown keys, finite numbers, frozen; built when first read."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True, allow_inf_nan=False, defer_build=True)


class Contradiction(ValueError):
    """A key that cannot be so beside others of its table, or with the file that they name; `key` is relative to the table."""

    def __init__(self, key: str, wanted: str, got: str) -> None:
        super().__init__(f"{key}: wanted {wanted}, got {got}")
        self.key, self.wanted, self.got = key, wanted, got


def agree(*rules: tuple[object, str, str, str]) -> None:
    """Raise `Contradiction` for the first rule that is broken: whether it holds, the key, what was wanted, what came."""
    for holds, *told in rules:
        if not holds:
            raise Contradiction(*told)


def mistakes_of(
    error: ValidationError,
    model: type[BaseModel],
    where: str,
    text: str = "",
    overridden: Mapping[tuple[str, ...], str] | None = None,
) -> list[Mistake]:
    """All mistakes in a validation error, one for each place, in the order of the file's model.

    `overridden` are the keys that were replaced, by what named them: a mistake there is not the file's.
    """
    # A list is also told to be too short where pydantic does not count entries that are mistakes themselves.
    details = [
        each
        for each in error.errors(include_url=False)
        if each["type"] != "too_short" or len(each["input"]) < each["ctx"]["min_length"]
    ]
    top = {detail["loc"][0]: detail["type"] for detail in details if len(detail["loc"]) == 1}
    other = next((KINDS[key] for key, kind in top.items() if kind == UNKNOWN and key in KINDS), None)
    if other is not None and "missing" in top.values():
        return [Mistake(where, "", "another kind of file", other[0], f"`{other[1]} {where}` takes it")]
    grouped: dict[tuple[str, ...], list[ErrorDetails]] = {}
    for detail in details:
        path, _ = _resolve(model, detail["loc"], detail["type"] == UNKNOWN)
        grouped.setdefault(path, []).append(detail)

    def place(path: tuple[str, ...]) -> str:
        for key, name in (overridden or {}).items():
            if path[: len(key)] == key:
                return name
        line = _line_of(text, path)
        return f"{where}:{line}" if line else where

    shown = [_mistake(path, details, model, place) for path, details in [*grouped.items()][:MOST_MISTAKES]]
    return [*shown, *unsaid(where, len(grouped) - MOST_MISTAKES)]


def unsaid(where: str, more: int) -> list[Mistake]:
    """How many mistakes there are besides those that are told."""
    return [Mistake(where, "", "no mistake", f"{more} more like these")] if more > 0 else []


def _mistake(
    path: tuple[str, ...], details: list[ErrorDetails], model: type[BaseModel], place: Callable[[tuple[str, ...]], str]
) -> Mistake:
    detail = details[0]
    cause = detail.get("ctx", {}).get("error")
    if isinstance(cause, Contradiction):
        path = (*path, *cause.key.split("."))
        return Mistake(place(path), ".".join(path), cause.wanted, cause.got)
    _, owner = _resolve(model, detail["loc"], detail["type"] == UNKNOWN)
    advice = ""
    if detail["type"] == UNKNOWN:
        known = sorted(owner.model_fields) if owner is not None else []
        wanted = f"a known key ({', '.join(known)})" if known else "no such key"
        advice = nearest(path[-1], known)
        got = "an unknown key"
    else:
        wanted = " or ".join(dict.fromkeys(wanted_of(item) for item in details))
        got = got_of(detail)
    return Mistake(place(path), ".".join(path), wanted, got, advice)


def wanted_of(detail: ErrorDetails) -> str:
    """What was wanted in the place of one error."""
    wanted = _WANTED.get(detail["type"])
    return detail["msg"] if wanted is None else wanted.format_map(detail.get("ctx", {}))


def got_of(detail: ErrorDetails) -> str:
    """What came there."""
    if detail["type"] in ("missing", "union_tag_not_found"):
        return "nothing"
    if detail["type"] == "union_tag_invalid":
        return f"kind = {detail['ctx']['tag']!r}"
    return _shown(detail["input"])


def _shown(value: Any) -> str:
    if isinstance(value, Mapping):
        return "a table with " + ", ".join(map(str, value)) if value else "an empty table"
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def _resolve(
    model: type[BaseModel], location: tuple[int | str, ...], unknown: bool
) -> tuple[tuple[str, ...], type[BaseModel] | None]:
    """The dotted key of an error's location and the table that owns its last part.

    Pydantic puts tags of unions and names of types into the location; only what is a key of a table, or an index of a
    list, belongs to the user's file. The last part of an `unknown` key's location is that key, whatever it looks like.
    """
    owner: type[BaseModel] | None = model
    candidates: list[type[BaseModel]] = [model]
    path: list[str] = []
    named = False  # whether the next part is a name that the user gave in a table of tables
    for number, part in enumerate(location):
        tagged = [m for m in candidates if _tag_of(m) == part]
        table = next((each for each in candidates if part in each.model_fields), None)
        if table is not None and not (tagged and len(candidates) > 1):  # the tag of one may be a key of another
            owner = table
            path.append(str(part))
            kind = table.model_fields[str(part)].annotation
            candidates, named = list(_tables_in(kind)) or candidates, get_origin(kind) is dict
            continue
        if named:
            path += str(part).split(".")
            named = False
            continue
        if unknown and number == len(location) - 1:
            owner = candidates[0] if len(candidates) == 1 else None
            path.append(str(part))
        elif tagged:
            candidates = tagged
        elif isinstance(part, int):
            path.append(str(part))
    return tuple(path), owner


def _tables_in(annotation: Any) -> Iterator[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for item in get_args(annotation):
        yield from _tables_in(item)


def _tag_of(model: type[BaseModel]) -> str | None:
    field = model.model_fields.get("kind")
    values = get_args(field.annotation) if field is not None else ()
    return str(values[0]) if values else None


def _line_of(text: str, path: tuple[str, ...]) -> int | None:
    """The line of a dotted key in TOML text, 1-based: the key in its table, or the table's header."""
    if not text or not path:
        return None
    table: tuple[str, ...] = ()
    best: int | None = None
    for number, line in enumerate(text.splitlines(), 1):
        header = re.match(r"\s*\[+\s*([^\]]+?)\s*\]+", line)
        if header:
            table = tuple(part.strip().strip('"') for part in header[1].split("."))
            if table == path[: len(table)]:
                best = number
            continue
        key = re.match(r"\s*([A-Za-z0-9_.\-\"]+)\s*=", line)
        if key:
            full = (*table, *(part.strip('"') for part in key[1].split(".")))
            if full == path[: len(full)]:
                return number
    return best
