"""The step editor and the path editor of [KB92a] section 6, on data.

Each edit gives a new plan and says which steps of it differ. Lean and gaze of other footsteps
stay, so that an edit changes nothing but its step and its neighbors. A plan with more or fewer
steps follows its path no longer.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith._checks import number
from gaitsmith.conventions import leftward
from gaitsmith.errors import InvalidInputError
from gaitsmith.plan.paths import checked_points

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Float

    from gaitsmith.plan.footsteps import StepPlan

#: Steps before and after an edited footstep's landing that may differ: the curve between
#: footsteps, the joined speeds and the lowered hips reach so far.
BEFORE, AFTER = 3, 4


@dataclass(frozen=True, eq=False)
class Edit:
    """An edited plan and what of it differs.

    Attributes
    ----------
    plan
        The new plan.
    first, last
        Seconds in the new plan between which poses may differ from the old plan's.
    shift
        Seconds by which everything after ``last`` comes later than it did.
    """

    plan: StepPlan
    first: float
    last: float
    shift: float = 0.0

    def frames(self, fps: float) -> range:
        """Indices of the frames that may differ."""
        return range(max(0, int(np.floor(self.first * fps))), int(np.ceil(self.last * fps)) + 1)


def move_step(plan: StepPlan, index: int, by: tuple[float, float]) -> Edit:
    """Move footstep ``index`` by ``(x, z)`` meters on level ground."""
    i = _index(plan, index)
    shift = np.array([number("by", v, "meters") for v in by])
    position, middle = np.array(plan.position), np.array(plan.middle)
    position[i, [0, 2]] += shift
    middle[i] += shift
    return _edit(plan, replace(plan, position=position, middle=middle), i)


def rotate_step(plan: StepPlan, index: int, by: float) -> Edit:
    """Turn footstep ``index``, and the walk there, by ``by`` radians about its N."""
    i = _index(plan, index)
    angle = number("by", by, "radians")
    heading, direction = np.array(plan.heading), np.array(plan.direction)
    heading[i] += angle
    direction[i] += angle
    middle = np.array(plan.middle)
    spot = plan.position[i, [0, 2]]
    aside = (middle[i] - spot) @ leftward(float(plan.direction[i]))[[0, 2]]
    middle[i] += (
        aside * (leftward(float(direction[i])) - leftward(float(plan.direction[i])))[[0, 2]]
    )
    return _edit(plan, replace(plan, heading=heading, direction=direction, middle=middle), i)


def retime_step(plan: StepPlan, index: int, duration: float) -> Edit:
    """Let the step that lands footstep ``index`` take ``duration`` seconds; later ones follow."""
    i = _index(plan, index)
    if i < 2:
        raise InvalidInputError("the feet that stand at the start have no time; index from 2")
    length = number("duration", duration, "seconds")
    if length <= 0.0:
        raise InvalidInputError(f"duration must be above 0 s, got {length:g}")
    change = length - float(plan.time[i] - plan.time[i - 1])
    time = np.array(plan.time)
    time[i:] += change
    return _edit(plan, replace(plan, time=time), i, change)


def insert_steps(plan: StepPlan, index: int) -> Edit:
    """Two footsteps more before footstep ``index``, one of each side, half way in between.

    Two, because sides alternate. The step that was there is shared by three.
    """
    i = _index(plan, index)
    if i < 2 or i >= len(plan.side):
        raise InvalidInputError("steps can be inserted before footsteps from index 2 on")
    shares = np.array([1.0 / 3.0, 2.0 / 3.0])
    before, there = i - 1, i
    duration = float(np.median(plan.durations))

    def between(values: Float[np.ndarray, "N *c"]) -> Float[np.ndarray, "2 *c"]:
        share = shares.reshape(-1, *[1] * (values.ndim - 1))
        return values[before] + share * (values[there] - values[before])

    middle = between(_of(plan.middle))
    direction = between(plan.direction)
    side = np.array([plan.side[there], plan.side[before]])
    position = np.zeros((2, 3))
    half = []
    for k, like in enumerate((there, before)):
        aside = (plan.position[like, [0, 2]] - _of(plan.middle)[like]) @ (
            leftward(float(plan.direction[like]))[[0, 2]]
        )
        half.append(aside)
        position[k, [0, 2]] = middle[k] + aside * leftward(float(direction[k]))[[0, 2]]
        position[k, 1] = plan.position[like, 1]
    toe = np.array([plan.heading[like] - plan.direction[like] for like in (there, before)])
    columns = {
        "side": side,
        "position": position,
        "heading": direction + toe,
        "direction": direction,
        "middle": middle,
        "lean": between(_of(plan.lean)),
        "gaze": between(_of(plan.gaze)),
    }
    grown = {name: np.insert(_of(getattr(plan, name)), i, v, axis=0) for name, v in columns.items()}
    time = np.concatenate(
        [plan.time[:i], plan.time[i - 1] + duration * np.array([1.0, 2.0]), plan.time[i:]]
    )
    time[i + 2 :] += 2.0 * duration
    kinds = list(plan.kinds)
    kinds[i - 2 : i - 2] = ["walk", "walk"]
    if i == 2:
        kinds[0], kinds[2] = kinds[2], "walk"
    new = replace(plan, time=time, kinds=tuple(kinds), path=None, **grown)  # type: ignore[arg-type]
    return _edit(plan, new, i, 2.0 * duration, more=2)


def delete_steps(plan: StepPlan, index: int, *, close: bool = True) -> Edit:
    """Leave out footsteps ``index`` and ``index + 1``, one of each side.

    ``close`` moves all later ones up, in parallel; else they stay and one step spans the gap.
    """
    i = _index(plan, index)
    if i < 2 or i + 1 >= len(plan.side) - 1:
        raise InvalidInputError("delete from index 2 on, and keep the last footstep")
    if len(plan.side) < 6:
        raise InvalidInputError("a plan needs steps: this one has too few to delete two")
    gone = [i, i + 1]
    names = ("side", "position", "heading", "direction", "middle", "lean", "gaze")
    left = {name: np.delete(_of(getattr(plan, name)), gone, axis=0) for name in names}
    if close:
        up = _of(plan.middle)[i - 1] - _of(plan.middle)[i + 1]
        left["middle"][i:] += up
        left["position"][i:, [0, 2]] += up
    # the step over the gap takes as long as the one that led to the first deleted footstep
    change = float(plan.time[i + 1] - plan.time[i - 1])
    time = np.delete(plan.time, gone)
    time[i:] -= change
    kinds = list(plan.kinds)
    del kinds[i - 2 : i]
    if i == 2:
        kinds[0] = plan.kinds[0]
    new = replace(plan, time=time, kinds=tuple(kinds), path=None, **left)  # type: ignore[arg-type]
    return _edit(plan, new, i, -change)


def move_point(
    points: Sequence[Sequence[float]], index: int, to: tuple[float, float]
) -> Float[np.ndarray, "n 2"]:
    """Control points of a path with point ``index`` elsewhere."""
    out = np.array(checked_points(points))
    out[_point(out, index)] = to
    return checked_points(out)


def insert_point(
    points: Sequence[Sequence[float]], index: int, at: tuple[float, float]
) -> Float[np.ndarray, "n+1 2"]:
    """Control points with one more before ``index``; at the ends, too."""
    out = np.array(checked_points(points))
    if not 0 <= index <= len(out):
        raise InvalidInputError(f"index must be from 0 to {len(out)}, got {index!r}")
    return checked_points(np.insert(out, index, at, axis=0))


def delete_point(points: Sequence[Sequence[float]], index: int) -> Float[np.ndarray, "n-1 2"]:
    """Control points without point ``index``."""
    out = np.array(checked_points(points))
    return checked_points(np.delete(out, _point(out, index), axis=0))


def _point(points: Float[np.ndarray, "n 2"], index: int) -> int:
    if not 0 <= index < len(points):
        raise InvalidInputError(f"point must be from 0 to {len(points) - 1}, got {index!r}")
    return index


def _of(values: Float[np.ndarray, "N *c"] | None) -> Float[np.ndarray, "N *c"]:
    assert values is not None  # a plan completes itself
    return values


def _index(plan: StepPlan, index: int) -> int:
    if isinstance(index, bool) or not 0 <= index < len(plan.side):
        raise InvalidInputError(f"footstep must be from 0 to {len(plan.side) - 1}, got {index!r}")
    return int(index)


def _edit(old: StepPlan, new: StepPlan, index: int, shift: float = 0.0, *, more: int = 0) -> Edit:
    """What differs: from some steps before the landing to some after."""
    del old
    count = len(new.side) - 1
    first = float(new.time[max(index - BEFORE, 0)])
    end = index + more + AFTER
    last = float(new.time[end]) if end <= count else np.inf
    if not np.isfinite(last):
        last = float(new.time[-1]) + 10.0
    return Edit(new, first, last, shift)
