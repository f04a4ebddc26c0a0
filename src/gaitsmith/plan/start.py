"""Where a person stands before the first action."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from gaitsmith._checks import number
from gaitsmith.conventions import LEFT, RIGHT, SIDE_SIGN, SIDES, leftward
from gaitsmith.errors import InfeasibleError, InvalidInputError
from gaitsmith.geometry.planar import feet_apart

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.plan.lengths import Stance

#: x, z (meters) and heading (radians) of the N of one foot.
Foothold = tuple[float, float, float]

#: Where feet, place and facing are all given they must agree so far: meters, radians.
AGREE, AGREE_ANGLE = 1e-3, float(np.radians(0.1))
#: Farthest from 0,0, meters.
FARTHEST = 1000.0
#: Axes of feet nearer than this touch, meters; feet farther apart than this part of the leg are
#: a straddle; no foot points farther from where the body faces.
TOUCHING, WIDEST, TWISTED = 0.045, 0.6, float(np.radians(60.0))


@dataclass(frozen=True)
class Start:
    """Standing somewhere, before anything is done.

    Attributes
    ----------
    at
        x,z of the middle between both N, meters; 0,0 if nothing is said.
    facing
        Heading of the body, radians; 0 if nothing is said.
    feet
        (x, z, heading) of the [left, right] foot, toe-out included; None: side by side, as far
        apart and turned out as the gait has them. With feet, ``at`` and ``facing`` follow: their
        middle, and the mean of their headings.
    """

    at: tuple[float, float] | None = None
    facing: float | None = None
    feet: tuple[Foothold, Foothold] | None = None

    def __post_init__(self) -> None:
        """Check, and complete what follows."""
        at = None if self.at is None else _numbers("start at", self.at, 2)
        facing = None if self.facing is None else number("start facing", self.facing, "radians")
        if self.feet is None:
            at, facing = at or (0.0, 0.0), facing or 0.0
        else:
            if len(self.feet) != 2:
                raise InvalidInputError(f"start feet must be [left, right], got {self.feet!r}")
            left, right = (
                _numbers(f"start {side} foot", foot, 3)
                for side, foot in zip(SIDES, self.feet, strict=True)
            )
            turn = float(np.arctan2(np.sin(right[2] - left[2]), np.cos(right[2] - left[2])))
            right = (right[0], right[1], left[2] + turn)
            object.__setattr__(self, "feet", (left, right))
            middle = (0.5 * (left[0] + right[0]), 0.5 * (left[1] + right[1]))
            mean = 0.5 * (left[2] + right[2])
            at, facing = at or middle, mean if facing is None else facing
            if np.hypot(at[0] - middle[0], at[1] - middle[1]) > AGREE:
                raise InvalidInputError(
                    f"start at {at[0]:g},{at[1]:g} is not the middle of the feet, "
                    f"{middle[0]:g},{middle[1]:g}; leave out one of at and feet"
                )
            miss = float(np.arctan2(np.sin(facing - mean), np.cos(facing - mean)))
            if abs(miss) > AGREE_ANGLE:
                raise InvalidInputError(
                    f"start facing {np.degrees(facing):g} deg is not the mean of the feet's "
                    f"headings, {np.degrees(mean):g} deg; leave out one of facing and feet"
                )
        if max(abs(at[0]), abs(at[1])) > FARTHEST:
            raise InvalidInputError(
                f"start at must be within {FARTHEST:g} m of 0,0, got {at[0]:g},{at[1]:g}"
            )
        object.__setattr__(self, "at", at)
        object.__setattr__(self, "facing", facing)

    @property
    def place(self) -> tuple[float, float]:
        """x,z of the middle between both N."""
        assert self.at is not None
        return self.at

    @property
    def heading(self) -> float:
        """Of the body, radians."""
        assert self.facing is not None
        return self.facing

    def footholds(self, body: Body, stance: Stance) -> list[tuple[Float[np.ndarray, "2"], float]]:
        """x,z of N and heading of the [left, right] foot.

        Raises
        ------
        InfeasibleError
            If given feet touch, cross, straddle too far or point away from the body.
        """
        if self.feet is None:
            left = leftward(self.heading)[[0, 2]]
            half, out = 0.5 * stance.width, np.array(stance.toe_out)
            return [
                (
                    np.array(self.place) + half * SIDE_SIGN[s] * left,
                    float(self.heading + SIDE_SIGN[s] * out[s]),
                )
                for s in (LEFT, RIGHT)
            ]
        held = [(np.array(f[:2]), f[2]) for f in self.feet]
        gap = held[LEFT][0] - held[RIGHT][0]
        aside = float(gap @ leftward(self.heading)[[0, 2]])
        apart, widest = float(np.linalg.norm(gap)), WIDEST * body.leg_length
        if aside <= 0.0 or _axes_apart(held, body) < TOUCHING:
            raise InfeasibleError(
                f"start: the left foot is {aside:.3f} m to the left of the right one; feet must "
                f"stand on their own sides, their axes {TOUCHING:g} m apart: set them farther apart"
            )
        if apart > widest:
            raise InfeasibleError(
                f"start: the feet are {apart:.3f} m apart, more than the {widest:.3f} m that this "
                "body stands in; set them closer"
            )
        half = 0.5 * abs(held[RIGHT][1] - held[LEFT][1])
        if half > TWISTED:
            raise InfeasibleError(
                f"start: the feet point {np.degrees(2.0 * half):.0f} deg apart, more than "
                f"{np.degrees(2.0 * TWISTED):.0f} deg; turn them closer"
            )
        return held


def _axes_apart(held: list[tuple[Float[np.ndarray, "2"], float]], body: Body) -> float:
    """Least distance of the axes of both feet, heel to toe tip, meters."""
    left, right = (place[None] for place, _ in held)
    return float(
        feet_apart(
            left,
            np.array([held[LEFT][1]]),
            right,
            np.array([held[RIGHT][1]]),
            back=body.foot.heel,
            front=body.foot.ball + body.foot.toes,
        )[0]
    )


def _numbers(name: str, values: object, count: int) -> Any:
    given = tuple(values) if isinstance(values, tuple | list | np.ndarray) else ()
    if len(given) != count:
        raise InvalidInputError(f"{name} must be {count} numbers, got {values!r}")
    return tuple(number(name, v, "meters") for v in given)


def start_to_dict(start: Start) -> dict[str, Any]:
    """``start`` as JSON can hold it."""
    feet = None if start.feet is None else [list(f) for f in start.feet]
    return {"at": list(start.place), "facing": start.heading, "feet": feet}


def start_of(given: str | Start | Mapping[str, Any]) -> str | Start:
    """What an argument ``start`` means: a word stays one, a mapping becomes a :class:`Start`."""
    if isinstance(given, str | Start):
        return given
    if not isinstance(given, dict) or not set(given) <= {"at", "facing", "feet"}:
        raise InvalidInputError(
            f"start must be 'stand', 'walk' or have at, facing and feet, got {given!r}"
        )
    feet = given.get("feet")
    return Start(
        at=given.get("at"),
        facing=given.get("facing"),
        feet=None if feet is None else tuple(feet),
    )
