"""A person's habits taken to a body: its own pace, and how it sets its feet."""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith._checks import number, positive
from gaitsmith.errors import GaitsmithWarning, InvalidInputError
from gaitsmith.plan.lengths import Stance
from gaitsmith.plan.pace import Pace

if TYPE_CHECKING:
    from gaitsmith.body.body import Body
    from gaitsmith.plan.rhythm import Rhythm
    from gaitsmith.plan.script import Tempo
    from gaitsmith.synthesis.gaits import Habits

#: Step width over stature: 0.10 m for 1.75 m. People walk with 0.06-0.14 m; 0.13 leg lengths
#: is preferred on a treadmill (Donelan, Kram & Kuo 2001).
STEP_WIDTH = 0.057
#: Toe-out of each foot, radians: 5.9 +- 6.9 deg (normal adults, heel-ball line).
TOE_OUT = float(np.radians(6.0))
#: Widest step over leg length, largest toe-out.
WIDEST_STEP, LARGEST_TOE_OUT = 0.5, float(np.radians(30.0))
#: Narrowest step, over stature and in meters, and largest toe-in: beyond, feet touch in passing.
NARROWEST_STEP, NARROWEST, LARGEST_TOE_IN = 0.05, 0.066, float(np.radians(5.0))


def own_pace(body: Body, habits: Habits) -> Pace:
    """The pace of who was measured at the size of ``body``: equal Froude numbers."""
    return Pace(
        step_length=habits.step_length * body.leg_length,
        cadence=habits.cadence * float(np.sqrt(habits.leg_length / body.leg_length)),
    )


def with_habits(rhythm: Rhythm, habits: Habits | None, asked: Tempo) -> Rhythm:
    """``rhythm`` with a person's own left and right, but for what was asked for."""
    if habits is None:
        return rhythm
    return replace(
        rhythm,
        lengths=habits.lengths if asked.step_length is None else (1.0, 1.0),
        durations=habits.durations if asked.cadence is None else (1.0, 1.0),
    )


def stance_of(
    body: Body,
    step_width: float | None,
    toe_out: float | tuple[float, float] | None,
    habits: Habits | None,
) -> Stance:
    """How ``body`` sets its feet: as asked (meters, radians), by habit, else as people do.

    Raises
    ------
    InvalidInputError
        If the feet would touch or straddle. Habits are kept within what keeps them apart, with
        a warning.
    """
    narrow = max(NARROWEST_STEP * body.height, NARROWEST)
    wide = WIDEST_STEP * body.leg_length
    if step_width is not None:
        width = positive("step_width", step_width, "meters")
        if not narrow <= width <= wide:
            raise InvalidInputError(
                f"step_width must be from {narrow:.3f} to {wide:.3f} m for this body, "
                f"got {width!r} m"
            )
    elif habits is None:
        width = max(STEP_WIDTH * body.height, narrow)
    else:
        width = _kept("step width", habits.step_width * body.leg_length, narrow, wide, "m")
    least, most = -LARGEST_TOE_IN, LARGEST_TOE_OUT
    if toe_out is None and habits is not None:
        left, right = (
            np.radians(_kept("toe-out", float(d), np.degrees(least), np.degrees(most), "deg"))
            for d in np.degrees(habits.toe_out)
        )
        return Stance(width, (float(left), float(right)))
    both = TOE_OUT if toe_out is None else toe_out
    pair = both if isinstance(both, tuple | list) else (both, both)
    if len(pair) != 2:
        raise InvalidInputError(f"toe_out must be one angle or [left, right], got {both!r}")
    left, right = (number("toe_out", angle, "radians") for angle in pair)
    for angle in (left, right):
        if not least <= angle <= most:
            raise InvalidInputError(
                f"toe_out must be from {np.degrees(least):g} to {np.degrees(most):g} deg, got "
                f"{np.degrees(angle):.1f} deg"
            )
    return Stance(width, (left, right))


def _kept(what: str, value: float, least: float, most: float, unit: str) -> float:
    """``value`` of a gait within the limits that keep feet apart; says so where it was not."""
    kept = min(max(value, least), most)
    if abs(kept - value) > 0.02 * (most - least):
        warnings.warn(
            f"the gait's own {what} of {value:.3g} {unit} is not walked: {kept:.3g} {unit} keeps "
            "the feet apart",
            GaitsmithWarning,
            stacklevel=4,
        )
    return kept
