"""How a foot stands on ground that is not level: its plane, its toes, what of it is borne."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.contact.foothold import Footholds, footholds
from gaitsmith.conventions import BALL, HEEL, TOE, UP
from gaitsmith.geometry.rotations import about, from_basis, inverse, log, multiply
from gaitsmith.ground import Flat, foot_plane

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.body.body import Foot
    from gaitsmith.ground import Ground

#: Ground that is so much (m) below the tip of the toes of a flat foot is beyond an edge.
DROP = 0.02
#: Toes whose line would be so deep (m) in the ground bend round an edge.
CUT = 0.004
#: Rounds in which the bend of the toes is found; on a plane the first is exact.
ROUNDS = 24
#: A bend of the toes by less (radians) is none.
ROUNDING = 1e-9


def standing(
    position: Float[np.ndarray, "*n 3"],
    heading: Float[np.ndarray, "*n"],
    ground: Ground,
    foot: Foot,
) -> Footholds:
    """Footholds of ``foot`` with N above the x,z of ``position``: heel and ball touch.

    The sole lies as :func:`gaitsmith.ground.foot_plane` has it; the toes are bent so that their
    tip touches. Where an edge runs under the foot, what lies beyond and lower is not borne. The
    height of ``position`` is replaced, but on level ground.
    """
    if isinstance(ground, Flat):
        return footholds(position, heading, ground)
    plane = foot_plane(ground, position[..., [0, 2]], heading, heel=foot.heel, ball=foot.ball)
    place, forward, normal = plane.position, plane.forward, plane.normal
    turned = from_basis(np.cross(normal, forward), normal, forward)
    tilt = log(multiply(turned, inverse(about("y", heading))))
    tilt = np.where(np.abs(normal - UP).max(-1, keepdims=True) > 1e-15, tilt, 0.0)
    toes = _toes(ground, place, forward, normal, foot)
    if not ground.stepped:
        return Footholds(place, forward, normal, tilt, toes)
    bears = np.ones((*heading.shape, 3), dtype=np.bool_)
    bears[..., HEEL], bears[..., BALL] = plane.bears[..., 0], plane.bears[..., 1]
    tip = place + (foot.ball + foot.toes) * forward
    bears[..., TOE] = tip[..., 1] - ground.height(tip[..., 0], tip[..., 2]) < DROP
    # toes that would have to bend round an edge reach over it
    bears[..., TOE] &= _cut(ground, place, forward, normal, toes, foot) < CUT
    if bears.all():
        return Footholds(place, forward, normal, tilt, toes)
    return Footholds(place, forward, normal, tilt, np.where(bears[..., TOE], toes, 0.0), bears)


def _cut(
    ground: Ground,
    place: Float[np.ndarray, "*n 3"],
    forward: Float[np.ndarray, "*n 3"],
    normal: Float[np.ndarray, "*n 3"],
    raised: Float[np.ndarray, "*n"],
    foot: Foot,
) -> Float[np.ndarray, "*n"]:
    """Meters that the sole of toes that are raised so is below the ground, between its ends."""
    ball = place + foot.ball * forward
    c, s, high = np.cos(raised), np.sin(raised), foot.toe_joint_height
    along = (foot.toes * c + high * s)[..., None] * forward
    along = along + (foot.toes * s + high * (1.0 - c))[..., None] * normal
    deepest = np.zeros(place.shape[:-1])
    for share in np.linspace(0.0, 1.0, 9)[1:-1]:
        at = ball + share * along
        deepest = np.maximum(deepest, ground.height(at[..., 0], at[..., 2]) - at[..., 1])
    return deepest


def _toes(
    ground: Ground,
    place: Float[np.ndarray, "*n 3"],
    forward: Float[np.ndarray, "*n 3"],
    normal: Float[np.ndarray, "*n 3"],
    foot: Foot,
) -> Float[np.ndarray, "*n"]:
    """Radians by which the toes must be raised so that their tip touches."""
    joint = place + foot.ball * forward + foot.toe_joint_height * normal
    raised = np.zeros(place.shape[:-1])
    for _ in range(ROUNDS):
        c, s = np.cos(raised), np.sin(raised)
        ahead_, up = foot.toes * c + foot.toe_joint_height * s, foot.toes * s
        up = up - foot.toe_joint_height * c
        tip = joint + ahead_[..., None] * forward + up[..., None] * normal
        miss = ground.height(tip[..., 0], tip[..., 2]) - tip[..., 1]
        raised = np.clip(raised + miss * normal[..., 1] / foot.toes, -1.0, 1.0)
    return np.where(np.abs(raised) < ROUNDING, 0.0, raised)
