"""What a notebook asks of a result: a line, a small table, a data frame, a picture. Nothing of it is loaded before."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from html import escape
from importlib import import_module
from typing import TYPE_CHECKING, Any

from harness.model.errors import InputError, Mistake

if TYPE_CHECKING:
    import pandas
    import xarray
    from matplotlib.axes import Axes


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
        index = next(iter(columns))
        frame: pandas.DataFrame = library("pandas", "to_dataframe").DataFrame(columns).set_index(index)
        return frame

    def to_xarray(self) -> xarray.Dataset:
        """Its table as a dataset along its index. Raises `InputError` without xarray (the extra [frames])."""
        columns = dict(self.columns())
        index = next(iter(columns))
        along = columns.pop(index)
        data = {name: (index, values) for name, values in columns.items()}
        dataset: xarray.Dataset = library("xarray", "to_xarray").Dataset(data, coords={index: along})
        return dataset


def new_axes(ax: Axes | None) -> Axes:
    """The axes given, or new ones."""
    if ax is not None:
        return ax
    import matplotlib.pyplot as plt

    return plt.subplots()[1]


def library(name: str, asked: str, extra: str = "frames") -> Any:
    """A module of an extra. Raises `InputError` where it is not installed."""
    try:
        return import_module(name)
    except ImportError as error:
        raise InputError(
            Mistake(f"{asked}()", "", f"{name}, of the extra [{extra}]: pip install 'rockcheck[{extra}]'", "none here")
        ) from error
