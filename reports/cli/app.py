"""The application `rockcheck`, and how a function becomes one of its commands."""

import inspect
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from typing import Annotated, Any

import typer

app = typer.Typer(
    name="rockcheck",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _version(asked: bool) -> None:
    if asked:
        from importlib.metadata import version

        typer.echo(f"rockcheck {version('rockcheck')}")
        raise typer.Exit


@app.callback()
def top(
    version: Annotated[
        bool, typer.Option("--version", help="Print the version and exit.", callback=_version, is_eager=True)
    ] = False,
) -> None:
    """How far can an analytic rocking model be trusted? One scene, several models, one report."""


def command(app: typer.Typer, name: str | None = None, *examples: str) -> Callable[[Callable[..., None]], None]:
    """Add a function as a command: its parameters that are groups of options are spread into these, its examples shown."""

    def add(function: Callable[..., None]) -> None:
        words = f"Example{'s' if len(examples) > 1 else ''}:  " + "  ·  ".join(f"`{line}`" for line in examples)
        app.command(name, epilog=words)(spread(function))

    return add


def spread(function: Callable[..., None]) -> Callable[..., None]:
    """A function of options alone, for one whose parameters may be dataclasses of options."""
    parameters: list[inspect.Parameter] = []
    groups = {}
    for name, given in inspect.signature(function, eval_str=True).parameters.items():
        if isinstance(given.annotation, type) and is_dataclass(given.annotation):
            groups[name] = given.annotation
            own = list(inspect.signature(given.annotation, eval_str=True).parameters.values())
        else:
            own = [given]
        parameters += [item.replace(kind=inspect.Parameter.KEYWORD_ONLY) for item in own]

    def called(**values: Any) -> None:
        parts = {
            name: group(**{item.name: values.pop(item.name) for item in fields(group)})
            for name, group in groups.items()
        }
        function(**values, **parts)

    described: Any = called
    described.__name__, described.__doc__ = function.__name__, function.__doc__
    described.__signature__ = inspect.Signature(parameters)
    described.__annotations__ = {item.name: item.annotation for item in parameters}
    return called
