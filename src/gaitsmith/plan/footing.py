"""How well a foot stands at a place: what of it hangs over, what it would run into."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.ground import HeightField, foot_plane

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

    from gaitsmith.body.body import Foot
    from gaitsmith.ground import Ground

#: Ground so much below the sole (m) does not bear it.
HANGS = 0.01
#: Samples of the sole from heel to ball and on to the toe tip, as contacts are judged.
SAMPLES = 9
#: A foot keeps so far (m) from what it would run into, ahead and behind, and to its sides.
CLEAR, HALF_WIDTH = 0.012, 0.03
#: Ground so much above the sole's line (m) is run into: the sole is stiff, on a ridge its middle
#: sinks in; beside it and beyond its ends more.
INTO, INTO_BESIDE = 0.016, 0.018
#: Ground this far (m) around a foot is looked at for risers.
NEAR = 0.06
#: The ball stands at least so far (m) behind an edge that the toes reach over.
BALL_ON = 0.008


@dataclass(frozen=True, eq=False)
class Footing:
    """n places for a foot.

    Attributes
    ----------
    height
        ``(n,)`` of N, meters.
    stands
        ``(n,)`` whether it can stand there at all, but for what hangs over.
    hangs
        ``(n,)`` share of the sole that nothing bears.
    slope
        ``(n,)`` rise per meter of the steepest way up the sole's plane.
    crowded
        ``(n,)`` 0 to 2: how near the foot is to what it would run into, ahead and behind.
    behind
        ``(n,)`` 0 to 1: the same behind alone.
    rough
        ``(n,)`` meters that the ground strays from the sole where that bears.
    sinks
        ``(n,)`` meters that the sole's line is below the ground at most.
    """

    height: Float[np.ndarray, "n"]
    stands: Bool[np.ndarray, "n"]
    hangs: Float[np.ndarray, "n"]
    slope: Float[np.ndarray, "n"]
    crowded: Float[np.ndarray, "n"]
    behind: Float[np.ndarray, "n"]
    rough: Float[np.ndarray, "n"]
    sinks: Float[np.ndarray, "n"]


def never_sinks(ground: Ground, foot: Foot, depth: float) -> bool:
    """Whether ground bends so little everywhere that it surely sinks into no sole by ``depth`` m.

    Then no place need be tried for that.
    """
    if not isinstance(ground, HeightField):
        return False
    return 0.5 * ground.most_bent * (foot.length + ground.cell) ** 2 < depth


def footing(
    ground: Ground, place: Float[np.ndarray, "n 2"], heading: Float[np.ndarray, "n"], foot: Foot
) -> Footing:
    """How feet stand with N at x,z ``place`` on ``ground``."""
    plane = foot_plane(ground, place, heading, heel=foot.heel, ball=foot.ball)
    left = np.cross(plane.normal, plane.forward)

    def gap(along: Float[np.ndarray, "k"], aside: float = 0.0) -> Float[np.ndarray, "n k"]:
        """Sole over ground, of points so far ahead of N and to the left."""
        at = plane.position[:, None] + along[:, None] * plane.forward[:, None]
        at = at + aside * left[:, None]
        return at[..., 1] - ground.height(at[..., 0], at[..., 2])

    tip = foot.ball + foot.toes
    sole = np.concatenate(
        [np.linspace(-foot.heel, foot.ball, SAMPLES), np.linspace(foot.ball, tip, SAMPLES)]
    )
    under = gap(sole)
    even = gap(np.linspace(-foot.heel, tip, 40)) > HANGS
    hangs = np.maximum((under > HANGS).mean(-1), even.mean(-1))
    around = np.linspace(-foot.heel - CLEAR, tip + CLEAR, 40)
    into = (under < -INTO).any(-1) | (gap(around) < -INTO_BESIDE).any(-1)
    for aside in (-HALF_WIDTH, HALF_WIDTH):
        into |= (gap(around, aside) < -INTO_BESIDE).any(-1)
    on_ball = gap(np.array([foot.ball - BALL_ON, foot.ball, foot.ball + BALL_ON])) < HANGS
    both = (under[:, 0] > HANGS) & (under[:, -1] > HANGS)
    stands = ~into & plane.bears[:, 1] & on_ball.all(-1) & ~both
    beyond = np.linspace(0.0, NEAR, 7)

    def crowded(reach: Float[np.ndarray, "k"]) -> Float[np.ndarray, "n"]:
        hit = gap(reach) < -INTO_BESIDE
        first = np.where(hit.any(-1), hit.argmax(-1), len(beyond))
        return (1.0 - first / len(beyond)) ** 2

    steep = np.sqrt(np.maximum(1.0 / plane.normal[:, 1] ** 2 - 1.0, 0.0))
    rough = np.where(under > HANGS, 0.0, np.abs(under)).max(-1)
    sinks = np.maximum(-under, 0.0).max(-1)
    ahead, behind = crowded(tip + beyond), crowded(-foot.heel - beyond)
    return Footing(plane.position[:, 1], stands, hangs, steep, ahead + behind, behind, rough, sinks)
