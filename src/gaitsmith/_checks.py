"""Argument checks whose messages name the argument, the rule and the value."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeGuard

import numpy as np

from gaitsmith.errors import InvalidInputError

if TYPE_CHECKING:
    from jaxtyping import Shaped
    from numpy.typing import ArrayLike, DTypeLike


def frozen_array(
    name: str, value: ArrayLike, shape: tuple[int | None, ...], dtype: DTypeLike = np.float64
) -> Shaped[np.ndarray, "..."]:
    """Copy ``value`` to a read-only array of ``shape`` (None: any size); finite or refused.

    An array that is read-only already and owns its memory is taken as it is.
    """
    try:
        array = value if _is_frozen(value, dtype) else np.array(value, dtype=dtype, order="C")
    except (TypeError, ValueError) as error:
        raise InvalidInputError(f"{name} must be an array of numbers: {error}") from None
    if array.ndim != len(shape) or any(
        n not in (None, m) for n, m in zip(shape, array.shape, strict=True)
    ):
        want = tuple("any" if n is None else n for n in shape)
        raise InvalidInputError(f"{name} must have shape {want}, got {array.shape}")
    if array.dtype.kind == "f" and not np.isfinite(array).all():
        first = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
        raise InvalidInputError(f"{name} must be finite, but {name}{list(first)} is {array[first]}")
    array.flags.writeable = False
    return array


def _is_frozen(value: ArrayLike, dtype: DTypeLike) -> TypeGuard[np.ndarray]:
    return (
        isinstance(value, np.ndarray)
        and not value.flags.writeable
        and value.base is None
        and value.flags.c_contiguous
        and value.dtype == dtype
    )


def number(name: str, value: float, unit: str) -> float:
    """Return ``value`` if it is a finite number."""
    try:
        result = float(value)
    except (TypeError, ValueError):
        result = float("nan")
    if not np.isfinite(result):
        raise InvalidInputError(f"{name} must be a finite number of {unit}, got {value!r}")
    return result


def positive(name: str, value: float, unit: str) -> float:
    """Return ``value`` if it is a finite number above zero."""
    try:
        result = float(value)
    except (TypeError, ValueError):
        result = float("nan")
    if not (np.isfinite(result) and result > 0):
        raise InvalidInputError(f"{name} must be a positive number of {unit}, got {value!r}")
    return result


def one_of(name: str, value: str, allowed: tuple[str, ...]) -> str:
    """Return ``value`` if it is one of ``allowed``."""
    if value not in allowed:
        raise InvalidInputError(f"{name} must be one of {', '.join(allowed)}, got {value!r}")
    return value
