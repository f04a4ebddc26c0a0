"""What a row of footsteps says about the walk over it: its middle line, lean and gaze.

Measured people: the line from the feet to the center of mass leans to the inside by
arctan(v^2 / (R g)), the trunk stays upright; the head turns into a curve about a meter ahead.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.body.rig import skeleton_of
from gaitsmith.conventions import GRAVITY, SIDE_SIGN, SIDES, leftward
from gaitsmith.geometry.splines import PlaneCurves

if TYPE_CHECKING:
    from collections.abc import Callable

    from jaxtyping import Float, Int

    from gaitsmith.body.body import Body

#: The head turns towards where the path goes this far ahead, meters: it starts 1.1 m before a
#: corner (Sreenivasa 2008); near points count more, which leads by about 0.3 s on the whole.
LOOK_AHEAD = 1.1
#: Height of the center of mass in walking over that in standing, legs bent and feet apart.
WALKING = 0.96
#: Tangent of the largest lean.
LARGEST_LEAN = 0.35
#: Largest curvature that footsteps are read to have, per meter.
SHARPEST = 6.0
#: Turns below this are rounding, radians.
NO_TURN = 1e-12


def lean_tangent(
    speed: Float[np.ndarray, "n"], curvature: Float[np.ndarray, "n"]
) -> Float[np.ndarray, "n"]:
    """Tangent of the lean that balances a curve, left positive: [KB92a] Eq. 4, ``v^2 k / g``."""
    return np.clip(speed**2 * curvature / GRAVITY, -LARGEST_LEAN, LARGEST_LEAN)


@lru_cache(maxsize=64)
def lean_lever(body: Body) -> float:
    """Meters that the hips must be beside the feet for a lean whose tangent is 1.

    Standing legs incline from the feet to the hips, what is above stays upright; the center of
    mass of the whole is then at its height times the tangent.
    """
    from gaitsmith.body.masses import center_of_mass, segments_of  # late: of curves only

    skeleton = skeleton_of(body)
    rest = np.zeros((len(skeleton), 3))
    for joint, parent in enumerate(skeleton.parents):
        rest[joint] = skeleton.offsets[joint] + (rest[parent] if parent >= 0 else 0.0)
    sole = rest[skeleton.index("leftFoot"), 1] - body.foot.ankle_height
    rest[:, 1] -= sole
    for side in SIDES:  # arms hang
        for joint, length in (("LowerArm", body.upper_arm), ("Hand", body.forearm)):
            above = "UpperArm" if joint == "LowerArm" else "LowerArm"
            top = rest[skeleton.index(side + above)]
            rest[skeleton.index(side + joint)] = top - np.array([0.0, length, 0.0])
    segments = segments_of(body)
    height = float(center_of_mass(skeleton, rest, segments)[1])
    hips = body.hip_height
    moved = np.zeros_like(rest)
    moved[:, 0] = np.minimum(rest[:, 1] / hips, 1.0)
    share = float(center_of_mass(skeleton, moved, segments)[0])
    return WALKING * height / share


def course_middle(
    side: Int[np.ndarray, "N"],
    position: Float[np.ndarray, "N 3"],
    direction: Float[np.ndarray, "N"],
) -> Float[np.ndarray, "N 2"]:
    """E of [KB92a]: each footstep moved to the line that runs between left and right ones.

    By half the step width there, the mean of the steps to and from it; a pair's width is
    measured across its mean direction, which is exact on lines and circles.
    """
    turn = np.diff(direction)
    across = leftward(0.5 * (direction[1:] + direction[:-1]))
    gap = ((position[1:] - position[:-1]) * across).sum(-1)
    width = gap * SIDE_SIGN[side[1:]] / np.maximum(np.cos(0.5 * turn), 0.5)
    half = np.concatenate([width[:1], 0.5 * (width[1:] + width[:-1]), width[-1:]]) / 2.0
    middle = position - (half * SIDE_SIGN[side])[:, None] * leftward(direction)
    return middle[:, [0, 2]]


def course_curvature(
    middle: Float[np.ndarray, "N 2"], direction: Float[np.ndarray, "N"]
) -> Float[np.ndarray, "N"]:
    """Change of direction per meter at each footstep, over the steps to and from it."""
    turn = np.diff(direction)
    turn = np.where(np.abs(turn) < NO_TURN, 0.0, turn)
    chord = np.sqrt((np.diff(middle, axis=0) ** 2).sum(-1))
    turn = np.concatenate([[0.0], turn, [0.0]])
    chord = np.concatenate([[0.0], chord, [0.0]])
    reach = chord[1:] + chord[:-1]
    held = reach < 1e-6
    bend = np.where(held, 0.0, (turn[1:] + turn[:-1]) / np.where(held, 1.0, reach))
    return np.clip(bend, -SHARPEST, SHARPEST)


def course_pieces(
    start: Float[np.ndarray, "S 2"],
    end: Float[np.ndarray, "S 2"],
    direction: tuple[Float[np.ndarray, "S"], Float[np.ndarray, "S"]],
    curvature: tuple[Float[np.ndarray, "S"], Float[np.ndarray, "S"]],
) -> PlaneCurves:
    """Curves between the points beside successive footsteps.

    [KB92a] section 3 takes a spline with the footsteps' directions as end tangents; here their
    curvatures are met, too, so that the whole is C2 and nothing jolts where steps meet.
    Tangents are as long as the chord: a straight step is passed evenly.
    """
    chord = end - start
    size = np.sqrt((chord * chord).sum(-1))
    tangents, seconds = [], []
    for turned, bend in zip(direction, curvature, strict=True):
        tangents.append(size[:, None] * np.stack([np.sin(turned), np.cos(turned)], axis=-1))
        left = np.stack([np.cos(turned), -np.sin(turned)], axis=-1)
        seconds.append((size**2 * bend)[:, None] * left)
    return PlaneCurves.quintic(start, end, tangents[0], tangents[1], (seconds[0], seconds[1]))


def course_lengths(
    middle: Float[np.ndarray, "N 2"],
    direction: Float[np.ndarray, "N"],
    curvature: Float[np.ndarray, "N"],
) -> Float[np.ndarray, "N-1"]:
    """Arc lengths between successive footsteps, meters: those of the underlying 2D steps."""
    return course_pieces(
        middle[:-1],
        middle[1:],
        (direction[:-1], direction[1:]),
        (curvature[:-1], curvature[1:]),
    ).length()


def course_change(
    values: Float[np.ndarray, "N"], middle: Float[np.ndarray, "N 2"]
) -> Float[np.ndarray, "N"]:
    """Change per meter at each footstep, 0 at the first and the last."""
    chord = np.sqrt((np.diff(middle, axis=0) ** 2).sum(-1))
    reach = chord[1:] + chord[:-1]
    out = np.zeros_like(values)
    held = (chord[1:] < 1e-6) | (chord[:-1] < 1e-6)
    out[1:-1] = np.where(held, 0.0, (values[2:] - values[:-2]) / np.where(held, 1.0, reach))
    return out


def course_lean(
    direction: Float[np.ndarray, "N"],
    lengths: Float[np.ndarray, "N-1"],
    time: Float[np.ndarray, "N"],
    curvature: Float[np.ndarray, "N"] | None = None,
) -> Float[np.ndarray, "N"]:
    """Tangent of the lean at each footstep, 0 at rest.

    ``curvature`` is that of the path there; None: of the footsteps' directions, smoothed.
    """
    gap = np.diff(time)
    rate = np.where(gap > 0.0, lengths / np.where(gap > 0.0, gap, 1.0), 0.0)
    walks = (gap > 0.0) & (lengths > 1e-9)
    speed = np.zeros(len(direction))
    speed[1:-1] = np.where(walks[1:] & walks[:-1], 0.5 * (rate[1:] + rate[:-1]), 0.0)
    if curvature is None:
        turn = np.diff(direction)
        turn = np.where(np.abs(turn) < NO_TURN, 0.0, turn)
        bend = np.zeros(len(direction))
        reach = np.maximum(lengths[1:] + lengths[:-1], 1e-9)
        bend[1:-1] = (turn[1:] + turn[:-1]) / reach
        curvature = bend.copy()
        curvature[1:-1] = 0.25 * (bend[2:] + bend[:-2]) + 0.5 * bend[1:-1]
    return lean_tangent(speed, curvature)


def course_gaze(
    heading_at: Callable[[Float[np.ndarray, "n"]], Float[np.ndarray, "n"]],
    along: Float[np.ndarray, "N"],
) -> Float[np.ndarray, "N"]:
    """How far the head turns beyond the walk at arc lengths ``along``, left positive."""
    ahead_by = (np.arange(12) + 0.5) / 12.0 * LOOK_AHEAD
    weight = LOOK_AHEAD - ahead_by
    weight /= weight.sum()
    there = heading_at((along[:, None] + ahead_by).ravel()).reshape(len(along), -1)
    out = (there - heading_at(along)[:, None]) @ weight
    return np.where(np.abs(out) < NO_TURN, 0.0, out)
