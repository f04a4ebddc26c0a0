"""What a file's numbers mean: its unit of length, its frame rate, which way is up.

Formats of motion name no unit, so the person in the file is measured: a leg from hip to
ankle is 0.41 to 1.3 m long. Centimeters are the custom and are taken wherever they make such
a leg; else the unit whose leg is nearest to an adult's.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith._checks import one_of
from gaitsmith.conventions import SIDES
from gaitsmith.motion.kinematics import forward_kinematics

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.motion.skeleton import Skeleton

#: Meters of each unit. ``cmu``: files of the CMU mocap data base and those made from them count
#: in 1/0.45 inch (``:units length 0.45`` in its .asf files), 5.64 cm.
UNITS: dict[str, float] = {
    "cm": 0.01,
    "m": 1.0,
    "mm": 0.001,
    "inch": 0.0254,
    "cmu": 0.0254 / 0.45,
}
#: Hip to ankle along the bones, meters: of a child of 0.85 m, of a giant, of an adult of
#: 1.75 m (thigh and shank are 0.245 and 0.246 of stature; Winter, Biomechanics and Motor
#: Control of Human Movement, Figure 4.1). A number of centimeters below the first is more
#: likely the inches of an adult: 41 inches are the legs of a man of 2.1 m.
SHORTEST_LEG, LONGEST_LEG, ADULT_LEG = 0.41, 1.3, 0.86
#: The same of the largest extent of a figure without known legs.
_SMALLEST, _LARGEST, _ADULT = 0.9, 2.6, 1.75
#: Rates of clips, frames per second; others are taken as the file has them.
_RATES = (24, 25, 30, 48, 50, 60, 72, 75, 90, 100, 120, 144, 150, 180, 200, 240, 250, 300)
_RATES_OF_FILM = (24000 / 1001, 30000 / 1001, 60000 / 1001, 120000 / 1001)


def unit_factor(unit: str) -> float:
    """Meters of the unit called ``unit``; InvalidInputError if there is none."""
    return UNITS[one_of("unit", unit, tuple(UNITS))]


def guess_unit(
    lengths: Float[np.ndarray, "joints"],
    skeleton: Skeleton,
    roles: dict[str, int],
) -> tuple[str, str]:
    """Unit in which a figure is a person, and why in words.

    Parameters
    ----------
    lengths
        ``(J,)`` distance of each joint from its parent, in the file's unit.
    skeleton
        The joints, offsets in the file's unit.
    roles
        Joint of each VRM bone, as far as known.

    Returns
    -------
    Name of the unit, and what a warning may say of it: empty if it is the usual centimeter.
    """
    leg = _leg_length(lengths, skeleton.parents, roles)
    if leg is not None:
        size, what = leg, "legs"
        low, high, adult = SHORTEST_LEG, LONGEST_LEG, ADULT_LEG
    else:
        rest = skeleton.rest_positions()
        size, what = float((rest.max(axis=0) - rest.min(axis=0)).max()), "figure"
        low, high, adult = _SMALLEST, _LARGEST, _ADULT
    fitting = [name for name, factor in UNITS.items() if low <= factor * size <= high]
    if "cm" in fitting or (leg is None and not fitting):
        return "cm", ""
    if not fitting:
        return "cm", (f"{what} of {size:.4g} units are a person's in no unit; taken as centimeters")
    best = min(fitting, key=lambda name: abs(math.log(UNITS[name] * size / adult)))
    return best, (
        f"taken as {_spoken(best)}: {what} of {size:.4g} units are then "
        f"{UNITS[best] * size:.2f} m, as centimeters {0.01 * size:.2f} m"
    )


def _spoken(unit: str) -> str:
    full = {"m": "meters", "mm": "millimeters", "inch": "inches"}
    return full.get(unit, "the CMU data base's unit of 1/0.45 inch")


def _leg_length(
    lengths: Float[np.ndarray, "joints"], parents: tuple[int, ...], roles: dict[str, int]
) -> float | None:
    """Mean length of the legs along the bones from hip to ankle."""
    legs: list[float] = []
    for side in SIDES:
        top, joint = roles.get(f"{side}UpperLeg"), roles.get(f"{side}Foot")
        if top is None or joint is None:
            return None
        total = 0.0
        while joint != top and joint >= 0:
            total, joint = total + float(lengths[joint]), parents[joint]
        legs.append(total)
    mean = sum(legs) / len(legs)
    return mean if mean > 0.0 else None


def frame_rate(frame_time: float) -> float:
    """Frames per second of a time between frames that was printed with some digits.

    ``0.0333333`` and ``0.033333`` both mean 30 frames a second, not 30.00003: where a common
    rate rounds to the digits printed, it is that rate.

    >>> frame_rate(0.0333333), frame_rate(0.00833333), frame_rate(0.04), frame_rate(0.0123)
    (30.0, 120.0, 25.0, 81.30081300813008)
    """
    text = np.format_float_positional(frame_time, unique=True)
    last = 10.0 ** -len(text.partition(".")[2])
    exact = 1.0 / frame_time
    for rate in (*_RATES, *_RATES_OF_FILM):
        if abs(rate - exact) < 1e-3 * rate and abs(1.0 / rate - frame_time) < 1.001 * last:
            return float(rate)
    return exact


def stands_along_z(
    skeleton: Skeleton,
    root_position: Float[np.ndarray, "frames 3"],
    rotations: Float[np.ndarray, "frames joints 4"],
    translations: Float[np.ndarray, "frames joints 3"] | None,
    roles: dict[str, int],
) -> bool:
    """Whether a person clearly stands on the plane z = 0 instead of y = 0.

    Clearly: in nearly all frames the hips are straight above the feet along z, by most of a
    leg, and the feet stay within a hand of z = 0. Somebody who lies down does none of this
    for long.
    """
    needed = [
        roles.get(name) for name in ("leftUpperLeg", "rightUpperLeg", "leftFoot", "rightFoot")
    ]
    if len(root_position) == 0 or any(joint is None for joint in needed):
        return False
    some = np.unique(np.linspace(0, len(root_position) - 1, 60).astype(int))
    moved = None if translations is None else translations[some]
    where, _ = forward_kinematics(skeleton, root_position[some], rotations[some], moved)
    left_hip, right_hip, left_foot, right_foot = (where[:, joint or 0] for joint in needed)
    hips, feet = 0.5 * (left_hip + right_hip), 0.5 * (left_foot + right_foot)
    leg = hips - feet
    length = np.linalg.norm(leg, axis=-1)
    upright = leg[:, 2] > 0.9 * length
    lowest = np.minimum(left_foot[:, 2], right_foot[:, 2])
    tall = np.median(length)
    return bool(
        np.mean(upright) > 0.9 and tall > 0.3 and (np.abs(lowest) < 0.25 * tall).mean() > 0.9
    )
