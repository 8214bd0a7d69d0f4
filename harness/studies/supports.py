"""What the statue stands on over all cases of a study: what its pictures and words may say of pedestal and friction."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from harness.input.tables import ContactTable
from harness.model.scene import Scene
from harness.records.study import StudyRow, SupportRecord
from harness.studies.file import StudyFile, Variant


def supports(study: StudyFile, scene: Scene, rows: Sequence[StudyRow]) -> SupportRecord:
    """Whether cases have a pedestal, least and greatest static frictions, and the keys of the statue that vary.

    `scene` is the study's own; a variant's keys go before those that follow a varied one, and these before the varied.
    """
    # A pedestal that the scene lacks may be built of keys of its own.
    there = scene.pedestal is not None or any(key.startswith("pedestal.") for key in _keys(study))
    stones: set[bool] = set()
    floor: set[float] = set()
    statue: set[float] = set()
    for variant in study.variant:
        own = [row for row in rows if row.varied["variant"] == variant.name]
        given = _values(study, variant, own, "pedestal") or {"keep"}
        here = {value != "none" and there for value in given}
        stones |= here
        if True in here:
            floor |= _frictions(study, variant, own, "floor_static", scene.contact.floor_static)
        statue |= _frictions(study, variant, own, "statue", scene.contact.statue)
    return SupportRecord(
        pedestal=sorted(stones),
        floor_static=(min(floor), max(floor)) if floor else None,
        statue=(min(statue), max(statue)),
        statue_keys=sorted(key for key in _keys(study) if key.startswith("statue.")),
    )


def _keys(study: StudyFile) -> set[str]:
    """Every key that differs between cases."""
    follow = {key for item in study.vary for key in item.also}
    varied = {item.key for item in study.vary} | {item.key for item in study.scatter}
    return varied | follow | {key for variant in study.variant for key in variant.set}


def _values(study: StudyFile, variant: Variant, rows: Sequence[StudyRow], key: str) -> set[Any]:
    """The values that the cases of a variant set a key to; none where nothing sets it."""
    if key in variant.set:
        return {variant.set[key]}
    for item in study.vary:
        if key in item.also:
            return {item.also[key] * float(row.varied[item.key]) for row in rows}
    return {row.varied[key] for row in rows if key in row.varied}


def _frictions(study: StudyFile, variant: Variant, rows: Sequence[StudyRow], name: str, own: float) -> set[float]:
    """The values of one friction; left as the scene has it, or taken away, which leaves the default of a scene file."""
    words = {"keep": own, "none": float(ContactTable.model_fields[name].default)}
    return {float(words.get(value, value)) for value in _values(study, variant, rows, f"contact.{name}") or {"keep"}}
