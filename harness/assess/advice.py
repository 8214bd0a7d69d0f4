"""What a comparison of options says, in plain words: a recommendation only where its difference is shown."""

from __future__ import annotations

from harness.assess.assessment import percent
from harness.assess.options import FLOOR, TURNED
from harness.records.assess import OptionAnswer, OptionsRecord


def advice(record: OptionsRecord) -> list[str]:
    """The recommendation first, then what would harm, then the paper's claim on this statue's pedestal."""
    helping = sorted(record.helping, key=_rank)
    told = [_recommended(record, helping) if helping else _nothing(record)]
    if record.harming:
        names = _listed([item.name for item in record.harming])
        told.append(f"A fall becomes more probable with: {names}.")
    floor = next((item for item in record.options if item.name == FLOOR), None)
    return told if floor is None else [*told, _claim(record.as_it_is, floor)]


def _rank(item: OptionAnswer) -> tuple[float, bool, float]:
    """The less probable fall first, then less slip; what is turned comes last: its weak side is one that no draw shakes."""
    return item.probability_overturned, item.name == TURNED, item.slip_high_m


def _recommended(record: OptionsRecord, helping: list[OptionAnswer]) -> str:
    best = helping[0]
    equal = [item for item in helping[1:] if item.low <= best.high]
    words = f"What would help most: {best.name}. The statue then falls in {percent(best.probability_overturned)} %, "
    words += f"as it is in {percent(record.as_it_is.probability_overturned)} %"
    if best.slip_high_m > 0.0:
        words += f"; it slides by up to {best.slip_high_m:.2g} m in 95 of 100"
    if equal:
        words += f". As good, as far as can be told: {_listed([item.name for item in equal])}"
    return words + "."


def _nothing(record: OptionsRecord) -> str:
    if record.as_it_is.high < 0.01:
        return "Nothing need be done against a fall: none of these options makes it less probable."
    return "Nothing is recommended: none of these options is shown to make a fall less probable."


def _claim(own: OptionAnswer, floor: OptionAnswer) -> str:
    """Whether a pedestal that slides protects: the paper's claim, answered by this statue on the floor."""
    falls = f"on the floor it falls in {percent(floor.probability_overturned)} %"
    falls += f", on its pedestal in {percent(own.probability_overturned)} %"
    if floor.harms:
        return f"The sliding pedestal protects this statue: {falls}."
    if floor.helps:
        return f"The sliding pedestal does not protect this statue, it endangers it: {falls}."
    return f"That the sliding pedestal protects this statue is not shown: {falls}."


def _listed(names: list[str]) -> str:
    return "; ".join(names)
