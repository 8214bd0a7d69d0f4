"""What is to be known of an answer: a code and the values of its sentence, not the sentence.

Whoever finds something says `caution("near_tie", margin=1e-5)`. `reports.messages` holds one sentence for each code in each
language; it is filled in where a result is written or shown, and no code reads one back.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from html import escape
from importlib import import_module
from typing import TYPE_CHECKING, Any, Final, TypeAlias

from harness.model.errors import translated

if TYPE_CHECKING:
    import matplotlib.axes
    import pandas
    import xarray

Axes: TypeAlias = "matplotlib.axes.Axes"
"""Of a library that a drawing alone loads."""


class Severity(StrEnum):
    """How much a finding bears on the answer, the heaviest first."""

    CHANGES_ANSWER = "changes_answer"
    CAUTION = "caution"
    INFO = "info"


WEIGHT: Final = {severity: place for place, severity in enumerate(Severity)}
"""Place of each severity when findings are sorted."""


@dataclass(frozen=True)
class Finding:
    """One thing to know: `code` names its sentence, `values` fill it, `engine` is the engine or pair (`a_vs_b`) it is of.

    `values` are plain numbers in the unit that ends their key, names, lists and tables of them. An empty `engine`: of the scene.
    `text` is its sentence in a record; empty before.
    """

    code: str
    severity: Severity
    values: Mapping[str, Any] = field(default_factory=dict)
    engine: str = ""
    text: str = ""

    def of(self, engine: str) -> Finding:
        """The same finding of an engine or a pair; one that has its own keeps it."""
        return self if self.engine else replace(self, engine=engine)


Say = Callable[[Finding], str]
"""A finding's sentence in some language."""


def changes_answer(code: str, **values: Any) -> Finding:
    """A finding with which the answer may be another one."""
    return Finding(code, Severity.CHANGES_ANSWER, values)


def caution(code: str, **values: Any) -> Finding:
    """A finding to know before the numbers are used."""
    return Finding(code, Severity.CAUTION, values)


def info(code: str, **values: Any) -> Finding:
    """A finding for the record."""
    return Finding(code, Severity.INFO, values)


def weighed(findings: Iterable[Finding]) -> list[Finding]:
    """The findings by severity, each once, otherwise in their order."""
    once: list[Finding] = []
    for each in findings:
        if each not in once:
            once.append(each)
    return sorted(once, key=lambda each: WEIGHT[each.severity])


def texted(findings: Iterable[Finding], say: Say) -> list[Finding]:
    """The findings with their sentences."""
    return [replace(each, text=say(each)) for each in findings]


@dataclass(frozen=True)
class Answer:
    """The headline of a result: `code` says what kind of answer it is, `findings` are its sentences in order.

    `text` is all of them in a record; empty before.
    """

    code: str
    findings: Sequence[Finding]
    text: str = ""

    def texted(self, say: Say) -> Answer:
        """The answer with its sentences."""
        said = texted(self.findings, say)
        return Answer(self.code, said, " ".join(each.text for each in said if each.text))


# What a notebook asks of a result: a line, a small table, a data frame, a picture. Nothing of it is loaded before.


class Shown(ABC):
    """A result that shows itself; derived classes say what of it is shown (their dataclasses have `repr=False`)."""

    @abstractmethod
    def facts(self) -> Mapping[str, str]:
        """The few things to know of it, by name, the most telling first."""

    @abstractmethod
    def columns(self) -> Mapping[str, object]:
        """Its table: columns of one length by name, the index first."""

    @abstractmethod
    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw it on matplotlib's axes, on new ones where none are given; returns them."""

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {', '.join(f'{name}: {said}' for name, said in self.facts().items())}>"

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><th>{escape(name)}</th><td>{escape(said)}</td></tr>" for name, said in self.facts().items()
        )
        return f"<table><caption>{type(self).__name__}</caption>{rows}</table>"

    def to_dataframe(self) -> pandas.DataFrame:
        """Its table as a data frame. Raises `InputError` without pandas (the extra [frames])."""
        columns = dict(self.columns())
        whole: pandas.DataFrame = library("pandas", "to_dataframe").DataFrame(columns)
        return whole.set_index(next(iter(columns)))

    def to_xarray(self) -> xarray.Dataset:
        """Its table as a dataset along its index. Raises `InputError` without xarray (the extra [frames])."""
        library("xarray", "to_xarray")
        dataset: xarray.Dataset = self.to_dataframe().to_xarray()
        return dataset


def new_axes(ax: Axes | None) -> Axes:
    """The axes given, or new ones."""
    if ax is not None:
        return ax
    import matplotlib.pyplot as plt

    return plt.subplots()[1]


def library(name: str, asked: str, extra: str = "frames") -> Any:
    """A module of an extra. Raises `InputError` where it is not installed."""
    wanted = f"{name}, of the extra [{extra}]: pip install 'rockcheck[{extra}]'"
    with translated(ImportError, f"{asked}()", wanted, "none here"):
        return import_module(name)
