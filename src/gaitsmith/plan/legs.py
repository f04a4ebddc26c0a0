"""Legs of one walk that are taken at paces of their own: how the pace changes on the way."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Float

    from gaitsmith.plan.pace import Pace
    from gaitsmith.plan.paths import Path

#: The pace changes over this many steps before and after where two legs meet.
CHANGE = 1.0
#: A node of a path nearer than this to a point is that point, meters.
SAME = 1e-6


@dataclass(frozen=True, eq=False)
class Legs:
    """Step lengths and durations along a path, over those of the pace it is laid out with.

    Attributes
    ----------
    along
        ``(K,)`` arc lengths, meters; between them the rest is linear.
    lengths, durations
        ``(K,)`` step length and step duration over the pace's own; lengths are at most 1.
    """

    along: Float[np.ndarray, "K"]
    lengths: Float[np.ndarray, "K"]
    durations: Float[np.ndarray, "K"]

    def length_at(self, along: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n"]:
        """Step length over the pace's own at arc lengths."""
        return np.interp(along, self.along, self.lengths)

    def duration_at(self, along: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n"]:
        """Step duration over the pace's own at arc lengths."""
        return np.interp(along, self.along, self.durations)


def legs_of(
    path: Path, ends: Sequence[Float[np.ndarray, "2"]], paces: Sequence[Pace]
) -> tuple[Pace, Legs]:
    """Legs that end at the points ``ends`` of ``path``, each at its pace.

    Returns the pace of the longest steps, by which the others are counted, and the legs. People
    change their pace over about two steps; so does this, or over half the shorter leg.
    """
    base = max(paces, key=lambda pace: pace.step_length)
    joints = _arc_lengths(path, ends[:-1])
    bounds = np.concatenate([[0.0], joints, [path.length]])
    sizes = np.diff(bounds)
    along, which = [0.0], [0]
    for i, joint in enumerate(joints):
        reach = CHANGE * max(paces[i].step_length, paces[i + 1].step_length)
        reach = min(reach, 0.5 * sizes[i], 0.5 * sizes[i + 1])
        along += [joint - reach, joint + reach]
        which += [i, i + 1]
    legs = Legs(
        along=np.array(along),
        lengths=np.array([paces[i].step_length / base.step_length for i in which]),
        durations=np.array([paces[i].step_duration / base.step_duration for i in which]),
    )
    return base, legs


def _arc_lengths(path: Path, points: Sequence[Float[np.ndarray, "2"]]) -> Float[np.ndarray, "n"]:
    """Where a path passes the points it was made through, one after the other."""
    out, last = [], 0.0
    for point in points:
        if path.straight:
            last = float(np.linalg.norm(point - path.points[0]))
        else:
            near = np.linalg.norm(path.points - point, axis=1)
            near = np.where(path.along >= last, near, np.inf)
            first = int(np.argmax(near <= near.min() + SAME))
            last = float(path.along[first])
        out.append(last)
    return np.array(out)
