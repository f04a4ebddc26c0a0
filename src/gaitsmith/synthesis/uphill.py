"""Uphill: the heel behind is up before the other foot lands, and the hips stay back.

As a foot lands uphill the other one stands lower by the rise of the step. Were it flat, its leg
would hold the hips down and the knee in front would have to fold. People are on the ball of the
foot behind by then, and their hips stay back over it as the trunk leans forward.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.contact.foothold import Footholds, footholds
from gaitsmith.contact.reach import REACH, raised_heel
from gaitsmith.conventions import LEFT, UP
from gaitsmith.geometry.curves import smoothstep
from gaitsmith.geometry.rotations import exp, left_of, turned_left
from gaitsmith.ground import Flat

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Bool, Float, Int

    from gaitsmith.body.body import Body
    from gaitsmith.contact import ReferenceStep
    from gaitsmith.conventions import StepKind
    from gaitsmith.plan.footsteps import PlannedStep

#: How far the hips stay back (over the leg) for a slope (rise per meter); standing it is so much
#: of it, which holds the balance against the trunk that leans.
HELD_BACK, STANDING = 0.37, 0.5
#: How far they go ahead downhill, likewise: the knee of the leg behind, which bears, yields to
#: some 48 deg at -10 deg before the other foot lands (U7), not to 60.
AHEAD = 0.4
#: Slope that steeper ones, as stairs are, come near to in this.
STEEPEST_BACK = 0.33
#: Most that the heel behind comes up for it (radians).
MOST = float(np.radians(32.0))
#: Phase of the step from which on: the foot lies flat for a while first, if it ever does.
RISES, LIES, LATEST = 0.4, 0.05, 0.7
#: Part of it that is left as the foot leaves, unless the sole is steeper than that (radians), and
#: the part of the swing in which that fades.
LEFT_OVER, STEEPEST_LEFT, FADES = 0.6, 1.2, 0.6
#: A foot rolls on that turns by so much before it leaves (radians).
ROLLS = float(np.radians(10.0))
#: Slope (rise per meter) from which on it comes up as far as it must; a lower rise (radians) is
#: none: that heel would stay on the ground and not be told from one that bears.
STEEP, LEAST = 0.02, float(np.radians(1.0))


def held_back(
    slope: Float[np.ndarray, "k"], stepped: Bool[np.ndarray, "k"], body: Body
) -> Float[np.ndarray, "k"]:
    """How far the hips of who walks stay back for a slope along the walk, meters.

    Downhill they go ahead, else the knee behind would have to fold; not on steps.
    """
    share = np.where(slope > 0.0, HELD_BACK, np.where(stepped, 0.0, AHEAD))
    return share * body.leg_length * STEEPEST_BACK * np.tanh(slope / STEEPEST_BACK)


def holding(phase: Float[np.ndarray, "T"], kind: StepKind) -> Float[np.ndarray, "T"]:
    """Share of it that is held in a step: less where somebody stands."""
    ends = {"start": (STANDING, 1.0), "walk": (1.0, 1.0), "stop": (1.0, STANDING)}
    first, last = ends.get(kind, (STANDING, STANDING))
    return first + (last - first) * smoothstep(phase)


@dataclass(frozen=True, eq=False)
class Strikes:
    """The instants at which steps meet: one foot has landed, the other will leave.

    Attributes
    ----------
    hip
        ``(k, 2, 3)`` hip joints of [the leg behind, the leg in front], as proposed.
    pitch, meta
        ``(k, 2)`` of [the foot behind, the foot in front].
    """

    hip: Float[np.ndarray, "k 2 3"]
    pitch: Float[np.ndarray, "k 2"]
    meta: Float[np.ndarray, "k 2"]

    @staticmethod
    def of(references: Sequence[ReferenceStep], body: Body) -> Strikes:
        """Beginnings of all steps, and the end of the last."""
        ends = [(r, 0, r.stance) for r in references]
        ends.append((references[-1], -1, 1 - references[-1].stance))
        center = np.array([r.curves.center[i] + r.origin for r, i, _ in ends])
        heading = np.array([r.curves.heading[i] for r, i, _ in ends])
        pelvis = exp(np.array([r.curves.pelvis[i] for r, i, _ in ends]))
        half = 0.5 * body.hip_width * left_of(turned_left(heading, pelvis))
        half = half * np.array([-1.0 if front == LEFT else 1.0 for *_, front in ends])[:, None]
        both = [[1 - front, front] for *_, front in ends]
        pitch, meta = (
            np.array(
                [getattr(r.curves, name)[i, b] for (r, i, _), b in zip(ends, both, strict=True)]
            )
            for name in ("pitch", "meta")
        )
        return Strikes(np.stack([center + half, center - half], axis=1), pitch, meta)

    def lowered(self, stands: Footholds, body: Body) -> Float[np.ndarray, "k"]:
        """How far the hips come down for legs on ``stands`` (k, 2) that are too short, meters."""
        line = self.hip - stands.ankle(body.foot, self.pitch, self.meta)
        square = (REACH * body.leg_length) ** 2 - line[..., 0] ** 2 - line[..., 2] ** 2
        return np.maximum(line[..., 1] - np.sqrt(np.maximum(square, 0.0)), 0.0).max(-1)

    def at(self, which: Bool[np.ndarray, "k"]) -> Strikes:
        """Some of them."""
        return Strikes(self.hip[which], self.pitch[which], self.meta[which])


def heel_rises(
    steps: Sequence[PlannedStep],
    level: Sequence[ReferenceStep],
    lifted: Sequence[ReferenceStep],
    stands: Footholds,
    feet: Int[np.ndarray, "S+1 2"],
    body: Body,
) -> Float[np.ndarray, "S+1"]:
    """How much farther the heel behind is up where steps meet, radians.

    Enough for the leg behind to hold the hips down no more than it does on the level.
    ``level`` and ``lifted`` are the same steps, on a floor and put on the ground; ``feet`` says
    which of ``stands`` the foot behind and the one in front are on.
    """
    kinds = [s.kind for s in steps]
    walks = np.array([k in ("walk", "stop") for k in kinds] + [kinds[-1] in ("start", "walk")])
    place = stands.position[feet]
    gone = place[:, 1] - place[:, 0]
    slope = gone[:, 1] / np.maximum(np.hypot(gone[:, 0], gone[:, 2]), 1e-6)
    uphill = walks & (slope > 0.0)
    out = np.zeros(len(uphill))
    if not uphill.any():
        return out
    slope, on = slope[uphill], stands.at(feet[uphill])
    heading = np.arctan2(on.forward[..., 0], on.forward[..., 2])
    flat = footholds(on.position * [1.0, 0.0, 1.0], heading, Flat())
    before = Strikes.of(level, body).at(uphill)
    after = Strikes.of(lifted, body).at(uphill)
    hip = after.hip - before.lowered(flat, body)[:, None, None] * UP
    more = raised_heel(
        body.foot,
        on.at((slice(None), 0)),
        hip[:, 0],
        after.pitch[:, 0],
        after.meta[:, 0],
        leg_length=body.leg_length,
    )
    more = np.minimum(more, MOST) * smoothstep(slope / STEEP)
    out[uphill] = np.where(more > LEAST, more, 0.0)
    return out


def with_risen_heels(reference: ReferenceStep, behind: float, rises: float) -> ReferenceStep:
    """``reference`` with the heel behind up by ``behind`` at its start and ``rises`` at its end.

    The heel comes up before the other foot is down. From then on it gives back what it is ahead
    as the foot rolls on, so that it never sinks; a part is left as the foot leaves.
    """
    if not (behind or rises):
        return reference
    phase, stance, off = reference.curves.phase, reference.stance, min(reference.toe_off, 1.0)
    pitch, bend = np.array(reference.curves.pitch), np.array(reference.curves.bend)
    flat = phase[np.flatnonzero(pitch[:, stance] <= 0.0)[:1]]
    first = min(max(RISES, *(flat + LIES)), LATEST)
    own = rises * smoothstep((phase - first) / (1.0 - first))
    rolls = pitch[:, 1 - stance]
    leaves = float(rolls[np.searchsorted(phase, off)])
    further = float(rolls[0]) - leaves
    if further > ROLLS:
        left = min(LEFT_OVER * behind, max(STEEPEST_LEFT + leaves, 0.0))
        share = np.clip((rolls - leaves) / further, 0.0, 1.0)
    else:  # a foot that is lifted as it is, in a local step
        left, share = 0.0, 1.0 - smoothstep(phase / off)
    fades = 1.0 - smoothstep((phase - off) / max(FADES * (1.0 - off), 1e-9))
    other = np.where(phase <= off, left + (behind - left) * share, left * fades)
    for side, more in ((stance, own), (1 - stance, other)):
        pitch[:, side] -= more
        bend[:, side] += more
    return reference.with_(curves=reference.curves.with_(pitch=pitch, bend=bend))
