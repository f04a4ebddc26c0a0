"""Linear algebra on one thread: small products wait for threads longer than they take."""

from __future__ import annotations

import sys
from functools import cache, wraps
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable

_In = ParamSpec("_In")
_Out = TypeVar("_Out")


def on_one_thread(function: Callable[_In, _Out]) -> Callable[_In, _Out]:
    """``function`` with the linear algebra below it on one thread, whatever the machine has."""

    @wraps(function)
    def alone(*args: _In.args, **kwargs: _In.kwargs) -> _Out:
        with _libraries("scipy.linalg" in sys.modules, "sklearn" in sys.modules).limit(limits=1):
            return function(*args, **kwargs)

    return alone


@cache
def _libraries(*loaded: bool) -> Any:
    """Those that are loaded once these are: finding them takes a millisecond."""
    from threadpoolctl import ThreadpoolController  # comes with scikit-learn; late, as that

    return ThreadpoolController()
