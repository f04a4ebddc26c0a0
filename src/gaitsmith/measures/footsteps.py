"""Where and when feet stood: footsteps, the steps and strides between them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import BALL, HEEL
from gaitsmith.measures.contacts import runs

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Bool, Float, Int

    from gaitsmith.gait.events import Stance
    from gaitsmith.motion.motion import Labels

#: Stride of the other foot, meters, below which it tells no direction.
_DIRECTED = 0.15
#: Cosine of the angle between foot and walk below which it goes sideways.
_ASIDE = 0.7
#: Meters over the lowest that a point gets in a stance up to which it is on the ground.
_DOWN = 0.003
#: Meters over it at which the whole foot is in the air, and meters that it then goes in a step.
_RAISED, _STEPPED = 0.006, 0.05


@dataclass(frozen=True, eq=False)
class Footsteps:
    """All footsteps of a motion in order of landing.

    Attributes
    ----------
    side, position, heading
        0 left, 1 right; N, meters; radians.
    time, off
        Seconds of landing and of toe-off; NaN where the motion does not show it.
    height
        Of the sole, meters: what the foot stood on.
    exact
        Whether they come from labels.
    """

    side: Int[np.ndarray, "N"]
    position: Float[np.ndarray, "N 3"]
    heading: Float[np.ndarray, "N"]
    time: Float[np.ndarray, "N"]
    off: Float[np.ndarray, "N"]
    height: Float[np.ndarray, "N"]
    exact: bool

    def __len__(self) -> int:
        """Number of footsteps, those in which the motion begins included."""
        return len(self.side)

    def direction(self) -> Float[np.ndarray, "N"]:
        """Heading of the walk at each footstep, radians, feet's own toe-out left out.

        That of the other foot's stride past this footstep; of the nearest one that has it
        at the ends; of the foot itself where nobody gets ahead or it goes sideways.
        """
        out = np.full(len(self), np.nan)
        for i in range(1, len(self) - 1):
            before, after = self.position[i - 1], self.position[i + 1]
            way = (after - before)[[0, 2]]
            other = self.side[i - 1] == self.side[i + 1] != self.side[i]
            if not other or np.hypot(*way) < _DIRECTED:
                continue
            heading = float(np.arctan2(way[0], way[1]))
            if np.cos(heading - self.heading[i]) < 0.0:  # backward
                heading += np.pi
            if np.cos(heading - self.heading[i]) > _ASIDE:
                out[i] = heading
        known = np.flatnonzero(np.isfinite(out))
        for i in np.flatnonzero(~np.isfinite(out)):
            near = known[np.abs(known - i) <= 2]
            out[i] = out[near[np.abs(near - i).argmin()]] if len(near) else self.heading[i]
        return out


def footsteps_of_labels(
    labels: Labels, contacts: Bool[np.ndarray, "F 2 3"], fps: float
) -> Footsteps:
    """The footsteps that a generator wrote down; toe-offs to the frame from its contacts."""
    side, landing = labels.footstep_side, labels.footstep_time
    time = np.array(landing)
    time[:2] = np.nan
    off = np.full(len(side), np.nan)
    frames = np.arange(len(contacts)) / fps
    for i in range(len(side)):
        again = np.flatnonzero(side[i + 1 :] == side[i])
        if len(again) == 0:
            continue
        until = landing[i + 1 + again[0]]
        mine = (frames >= landing[i] - 1e-9) & (frames < until - 1e-9)
        bears = np.flatnonzero(mine & contacts[:, side[i]].any(-1))
        if len(bears):  # between this frame and the next
            off[i] = (bears[-1] + 0.5) / fps
    return Footsteps(
        side=side,
        position=labels.footstep_position,
        heading=labels.footstep_heading,
        time=time,
        off=off,
        height=labels.footstep_position[:, 1],
        exact=True,
    )


def parted(
    found: Sequence[Stance], soles: Float[np.ndarray, "F 2 3 3"], fps: float
) -> list[Stance]:
    """``found``, parted where a foot that was slow enough for a stance was in the air.

    So are small steps, such as the one that closes to standing.
    """
    out: list[Stance] = []
    for stance in found:
        flat = flat_frames(stance, len(soles), fps)
        low = soles[flat, stance.side, :, 1].min(-1)
        low, ball = low - low.min(), soles[flat, stance.side, BALL]
        rest = stance
        for a, b in runs(low > _DOWN):
            if low[a:b].max() < _RAISED or a == 0 or b == len(low):
                continue
            way = ball[b] - ball[a - 1]
            if np.hypot(way[0], way[2]) < _STEPPED:
                continue
            up, down = (flat.start + a) / fps, (flat.start + b) / fps
            early, late = rest.cut in ("start", "both"), rest.cut in ("end", "both")
            out.append(replace(rest, heel_off=up, toe_off=up, cut="start" if early else ""))
            rest = replace(rest, heel_strike=down, foot_flat=down, cut="end" if late else "")
        out.append(rest)
    return sorted(out, key=lambda s: s.heel_strike)


def contacts_of_stances(
    found: Sequence[Stance], soles: Float[np.ndarray, "F 2 3 3"], fps: float
) -> Bool[np.ndarray, "F 2 3"]:
    """Heel and ball while the foot stands flat: from when each is down to when it rises.

    The toe tip is left out: where it is, is the least sure.
    """
    down = np.zeros(soles.shape[:3], dtype=bool)
    for stance in found:
        flat = flat_frames(stance, len(soles), fps)
        for point in (HEEL, BALL):
            height = soles[flat, stance.side, point, 1]
            low = np.flatnonzero(height <= height.min() + _DOWN)
            down[flat.start + low[0] : flat.start + low[-1] + 1, stance.side, point] = True
    return down


def footsteps_of_stances(
    found: Sequence[Stance],
    soles: Float[np.ndarray, "F 2 3 3"],
    ankles: Float[np.ndarray, "F 2 3"],
    down: Bool[np.ndarray, "F 2 3"],
    fps: float,
) -> Footsteps:
    """The footsteps of stances that were found: N of the foot while it stands flat."""
    count = len(found)
    position, heading, height = np.empty((count, 3)), np.empty(count), np.empty(count)
    for i, stance in enumerate(found):
        flat = np.arange(len(soles))[flat_frames(stance, len(soles), fps)]
        both = flat[down[flat, stance.side, HEEL] & down[flat, stance.side, BALL]]
        frames = both if len(both) else flat
        heel, ball = soles[frames, stance.side, HEEL], soles[frames, stance.side, BALL]
        along = (ball - heel) / np.linalg.norm(ball - heel, axis=-1, keepdims=True)
        from_heel = ((ankles[frames, stance.side] - heel) * along).sum(-1, keepdims=True)
        position[i] = (heel + from_heel * along).mean(0)
        heading[i] = np.arctan2(along[:, 0].mean(), along[:, 2].mean())
        height[i] = np.minimum(heel[:, 1], ball[:, 1]).mean()
    unseen = [s.cut in ("start", "both") for s in found]
    staying = [s.cut in ("end", "both") for s in found]
    return Footsteps(
        side=np.array([s.side for s in found], dtype=np.int64),
        position=position,
        heading=heading,
        time=np.where(unseen, np.nan, [s.heel_strike for s in found]),
        off=np.where(staying, np.nan, [s.toe_off for s in found]),
        height=height,
        exact=False,
    )


def flat_frames(stance: Stance, count: int, fps: float) -> slice:
    """Frames of a motion in which the foot of ``stance`` stands flat; at least one."""
    first = min(int(np.ceil(stance.foot_flat * fps - 1e-6)), count - 1)
    last = max(int(np.floor(stance.heel_off * fps + 1e-6)), first)
    return slice(first, min(last, count - 1) + 1)
