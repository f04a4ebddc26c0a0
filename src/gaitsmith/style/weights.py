"""What a mix is made with: weights for the root and for every part [KN12] section 4.1."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from gaitsmith._checks import number, one_of, positive
from gaitsmith.errors import InvalidInputError
from gaitsmith.style.parts import BOTH, PARTS

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from jaxtyping import Float

    #: A weight of an example: one for the whole part, or one for each of its components.
    Weight = float | tuple[float, ...]

ENGINES = ("dense", "keys")
BASES = ("cubic", "slerp")
#: How the weights of the legs are found; see :mod:`gaitsmith.style.legs`.
LEGS = ("given", "optimized", "joint", "greedy")
#: Sums of weights within which a mix is like its examples [KN12] Table 3: 0.4 to 2.2.
SENSIBLE = (0.5, 1.6)


@dataclass(frozen=True)
class PartMix:
    """Weights of one part.

    Attributes
    ----------
    weights
        By example; those not named have weight 0. A number, or one for each component.
    offset_scale
        Of the details between key frames: 1 as in the examples, 0 none.
    """

    weights: Mapping[str, Weight]
    offset_scale: float = 1.0


@dataclass(frozen=True)
class Mix:
    """Weights of a mix; any real numbers, the root's must not sum to 0 or less.

    Attributes
    ----------
    root
        By example: pelvis, timing, speed, and every part that has no weights of its own.
    offsets
        By example, for the details between key frames; None: as ``root``. With the engine
        ``"dense"`` a part's own weights count where none are given.
    parts
        By part (:data:`~gaitsmith.style.parts.PARTS`; ``arms`` and ``legs`` are both sides).
        They replace the root's weights for that part.
    speed
        Meters per second; None: the examples' mean by the weights of the root.
    engine
        ``"dense"`` mixes whole strides, ``"keys"`` the paper's eight key frames and offsets.
    base
        How ``"keys"`` joins key frames: ``"cubic"`` (of logs, periodic) or ``"slerp"`` (the
        paper's, whose speed jumps at every key).
    legs
        ``"given"`` weights, or weights that keep the feet where the base has them:
        ``"optimized"`` (all examples, damped least squares), ``"joint"`` (conjugate gradients)
        or ``"greedy"`` (the paper's, component by component).
    symmetric
        Average the result with its mirror image half a stride later.
    """

    root: Mapping[str, float]
    offsets: Mapping[str, float] | None = None
    parts: Mapping[str, PartMix] = field(default_factory=dict)
    speed: float | None = None
    engine: str = "dense"
    base: str = "cubic"
    legs: str = "given"
    symmetric: bool = False

    def __post_init__(self) -> None:
        """Check everything at once; the message lists all that is wrong."""
        wrong = list(self._wrong())
        if wrong:
            raise InvalidInputError("; ".join(wrong))

    def _wrong(self) -> Iterator[str]:
        if not self.root:
            yield "root has no weights: name at least one example"
        yield from _bad_weights("root", self.root)
        total = sum(v for v in self.root.values() if _is_number(v))
        if self.root and not total > 0.0:
            yield f"weights of root must sum to more than 0, they sum to {total:g}"
        yield from _bad_weights("offsets", self.offsets or {})
        for part, mix in self.parts.items():
            if part not in (*PARTS, *BOTH):
                yield f"{part!r} is no part; parts are {', '.join((*PARTS, *BOTH))}"
            yield from _bad_weights(part, mix.weights, vectors=True)
            if not _is_number(mix.offset_scale):
                yield f"offset_scale of {part} must be a finite number, got {mix.offset_scale!r}"
        for both, sides in BOTH.items():
            for side in sides:
                if both in self.parts and side in self.parts:
                    yield f"give {both} or {side}, not both"
        try:
            if self.speed is not None:
                positive("speed", self.speed, "meters per second")
        except InvalidInputError as error:
            yield str(error)
        for name, allowed in (("engine", ENGINES), ("base", BASES), ("legs", LEGS)):
            try:
                one_of(name, getattr(self, name), allowed)
            except InvalidInputError as error:
                yield str(error)

    @property
    def named(self) -> tuple[str, ...]:
        """Examples that have a weight somewhere, in order of first mention."""
        tables = [self.root, self.offsets or {}, *(part.weights for part in self.parts.values())]
        return tuple(dict.fromkeys(name for table in tables for name in table))

    def part(self, part: str) -> PartMix | None:
        """What is given for one part, by its own name or by that of both sides."""
        both = next((b for b, sides in BOTH.items() if part in sides), part)
        return self.parts.get(part, self.parts.get(both))

    def shares(self, names: tuple[str, ...]) -> Float[np.ndarray, "L"]:
        """Weights of the root, made to sum to 1."""
        root = vector(self.root, names)
        return root / root.sum()

    def sums(self) -> dict[str, float]:
        """Sum of the weights of the root and of every part that has its own."""
        return {"root": sum(self.root.values())} | {
            name: float(sum(np.mean(v) for v in part.weights.values()))
            for name, part in self.parts.items()
        }


def vector(table: Mapping[str, float], names: tuple[str, ...]) -> Float[np.ndarray, "L"]:
    """Weights in the order of ``names``."""
    return np.array([float(table.get(name, 0.0)) for name in names])


def _is_number(value: Any) -> bool:
    try:
        number("weight", value, "")
    except InvalidInputError:
        return False
    return not isinstance(value, bool | str)


def _bad_weights(where: str, table: Mapping[str, Any], *, vectors: bool = False) -> Iterator[str]:
    for name, value in table.items():
        many = vectors and isinstance(value, tuple | list)
        if not all(_is_number(v) for v in (value if many else [value])):
            yield f"the weight of {name!r} in {where} must be a finite number, got {value!r}"
