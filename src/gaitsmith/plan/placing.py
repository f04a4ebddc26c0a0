"""Where a foot may land while the other stays: the limits of one local step, for many at once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import SIDE_SIGN
from gaitsmith.geometry.planar import feet_apart
from gaitsmith.plan.stepping import FARTHEST, NU, TOUCHING

if TYPE_CHECKING:
    from jaxtyping import Bool, Float, Int

    from gaitsmith.body.body import Body

#: Farthest that a foot is turned out against the one that stays (28-81 deg measured, on the
#: spot), and in, radians.
OUTWARD, INWARD = float(np.radians(70.0)), float(np.radians(30.0))
#: Farthest that a foot itself turns in one step, radians; sum of the squares of what is used of the
#: step's length and of its turn.
SWUNG, FAR_AND_TURNED = float(np.radians(80.0)), 1.3
#: How much nearer than side by side feet may come, over the step width.
NARROWER = 0.35
#: Distance of the feet's axes over stature that steps on the way keep.
APART = 0.052 / 1.75


@dataclass(frozen=True, eq=False)
class Feet:
    """Many footsteps: x,z of N, direction and heading."""

    place: Float[np.ndarray, "n 2"]
    direction: Float[np.ndarray, "n"]
    heading: Float[np.ndarray, "n"]

    def rows(self, rows: Int[np.ndarray, "m"]) -> Feet:
        """Some of them."""
        return Feet(self.place[rows], self.direction[rows], self.heading[rows])


@dataclass(frozen=True, eq=False)
class Limits:
    """Of one local step: meters forward, back and aside beyond side by side; turn out, radians.

    Each is a number or one for every row.
    """

    forward: Float[np.ndarray, "*n"]
    back: Float[np.ndarray, "*n"]
    aside: Float[np.ndarray, "*n"]
    outward: Float[np.ndarray, "*n"]
    width: float
    apart: float

    @staticmethod
    def of(body: Body, width: float, share: Float[np.ndarray, "*n"] | float = 1.0) -> Limits:
        """Of a body that stands ``width`` wide; a ``share`` of what it can."""
        share = np.asarray(share)
        leg = share * body.leg_length
        return Limits(
            forward=FARTHEST["forward"] * leg,
            back=FARTHEST["back"] * leg,
            aside=FARTHEST["left"] * leg,
            outward=share * OUTWARD,
            width=width,
            apart=max(min(APART * body.height, 0.9 * width), TOUCHING),
        )


def may_land(
    stance: Feet,
    origin: Float[np.ndarray, "n"],
    target: Feet,
    side: Int[np.ndarray, "n"],
    limits: Limits,
    body: Body,
) -> Bool[np.ndarray, "n"]:
    """Whether a foot of ``side`` that points to ``origin`` may land on ``target``.

    Within the step's length and turn, in a region of [KB93] Figure 2, on its own side of the
    other foot and clear of it.
    """
    sign = SIDE_SIGN[side]
    sin, cos = np.sin(stance.direction), np.cos(stance.direction)
    x, z = (target.place - stance.place).T
    along, aside = x * sin + z * cos, sign * (x * cos - z * sin)
    beyond = aside - limits.width
    far = (along / np.where(along >= 0.0, limits.forward, limits.back)) ** 2
    far += (np.maximum(beyond, 0.0) / limits.aside) ** 2
    out = sign * (target.direction - stance.direction)
    ok = (far <= 1.0 + 1e-9) & (out <= limits.outward + 1e-9) & (out >= -INWARD - 1e-9)
    # who steps far turns less
    ok &= far + (out / limits.outward) ** 2 <= FAR_AND_TURNED
    ok &= np.abs(target.direction - origin) <= SWUNG + 1e-9
    # each on its own side, as either foot sees it; a long step may line the feet up
    least = (1.0 - NARROWER) * limits.width - 0.3 * np.abs(along)
    seen = sign * (x * np.cos(target.direction) - z * np.sin(target.direction))
    ok &= (aside >= np.maximum(least, 0.0)) & (seen >= 0.0)
    heel = body.foot.heel
    tx, tz = (
        x - heel * (np.sin(target.direction) - sin),
        z - heel * (np.cos(target.direction) - cos),
    )
    angle = np.arctan2(sign * (tx * cos - tz * sin), tx * sin + tz * cos)
    ok &= (angle >= -0.5 * NU) | (angle < -(np.pi - 0.5 * NU))
    rows = np.flatnonzero(ok)
    if len(rows):
        ok[rows] = (
            feet_apart(
                target.place[rows],
                target.heading[rows],
                stance.place[rows],
                stance.heading[rows],
                back=body.foot.heel,
                front=body.foot.ball + body.foot.toes,
            )
            >= limits.apart
        )
    return ok
