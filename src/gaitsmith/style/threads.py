"""Linear algebra on one thread: small products wait for threads longer than they take."""

from __future__ import annotations

from functools import wraps
from typing import TYPE_CHECKING, ParamSpec, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable

_In = ParamSpec("_In")
_Out = TypeVar("_Out")


def on_one_thread(function: Callable[_In, _Out]) -> Callable[_In, _Out]:
    """``function`` with the linear algebra below it on one thread, whatever the machine has."""

    @wraps(function)
    def alone(*args: _In.args, **kwargs: _In.kwargs) -> _Out:
        from threadpoolctl import threadpool_limits  # comes with scikit-learn; late, as that

        with threadpool_limits(1):
            return function(*args, **kwargs)

    return alone
