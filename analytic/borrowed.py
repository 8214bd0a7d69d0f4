"""Arrays that the compiled code only borrows: it does not count references to them, which cost half of a run's time."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from numba.core import cgutils
from numba.extending import intrinsic

A = TypeVar("A")
null: Any = cgutils.get_null_value


def _borrow(typing_context: Any, array: Any) -> Any:
    """The same array without its owner; valid as long as the caller keeps the array."""

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        view = context.make_array(signature.args[0])(context, builder, arguments[0])
        view.meminfo = null(view.meminfo.type)
        return view._getvalue()

    return array(array), code


_compiled: Any = intrinsic(_borrow)
borrow: Callable[[A], A] = _compiled
