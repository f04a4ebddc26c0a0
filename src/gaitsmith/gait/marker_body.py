"""The body that wears the markers: legs and feet as measured, the rest of average people."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.body.body import Body, Foot
from gaitsmith.body.proportions import FOOT_SHARES, SHORTEST, TALLEST, body_from_height
from gaitsmith.conventions import LEFT, RIGHT, SIDE_SIGN, SIDES
from gaitsmith.errors import InfeasibleError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Bool, Float

    from gaitsmith.gait.events import Stance
    from gaitsmith.gait.marker_joints import MarkerLeg, MarkerWalker

#: Leg length (hip to ankle) over stature of an adult.
_LEG = 0.491
#: Toe-out where the markers do not tell it: men's mean of 5.9 deg.
_TOE_OUT = float(np.radians(6.0))
#: Radians that a foot may turn out.
_AHEAD = float(np.radians(60.0))
#: Part of the time from foot flat to heel off in which a foot is surely flat.
_FLAT = (0.05, 0.6)
#: Range of ankle heights, and the usual one, over leg length.
_ANKLES, _USUAL_ANKLE = (0.055, 0.16), 0.0795
#: Shares of the usual heel that the landing may tell.
_HEELS = (0.4, 1.3)
#: Range of thigh over shin that is believed.
_KNEES = (0.85, 1.18)
#: Range of hip widths over stature that are believed.
_HIP_WIDTHS = (0.06, 0.16)
#: Step width over stature where the markers are of one plane.
_STEP_WIDTH = 0.057


@dataclass(frozen=True, eq=False)
class FlatFoot:
    """How the markers of a foot lie while it stands flat.

    Attributes
    ----------
    flat
        ``(F,)`` frames in which it does.
    heading, told
        Of the foot, radians, and whether the markers tell it.
    plane
        Heading of the plane in which slopes are seen: the foot's, 0 in a sagittal table.
    beside
        ``(3,)`` what brings the ankle above the line of the foot, sideways, meters.
    round_heel
        How far ahead of the heel's marker the heel bears while the foot lands, meters.
    triangle
        Ankle above the line of heel and ball markers; from its foot back to the heel, forward
        to the ball; ball to toe tip, 0 without a marker there; meters.
    zero
        Slopes of the lines heel-ball and ball-toe, radians.
    """

    flat: Bool[np.ndarray, "F"]
    heading: float
    told: bool
    plane: float
    beside: Float[np.ndarray, "3"]
    round_heel: float
    triangle: tuple[float, float, float, float]
    zero: tuple[float, float]

    def pitch(self, leg: MarkerLeg) -> tuple[Float[np.ndarray, "F"], Float[np.ndarray, "F"]]:
        """Pitch of the sole and of the toes, up positive, 0 while flat.

        Without a marker on the toes they stay in line with the sole.
        """
        sole = _slope(leg.heel, leg.ball, self.plane) - self.zero[0]
        sole = _near_zero(sole, self.flat)
        if leg.tip is None:
            return sole, sole
        toes = _slope(leg.ball, leg.tip, self.plane) - self.zero[1]
        return sole, _near_zero(toes, self.flat)


def flat_foot(leg: MarkerLeg, side: int, found: Sequence[Stance], walker: MarkerWalker) -> FlatFoot:
    """How the foot of ``leg`` stands flat, the mean over its stances."""
    flat = _flat_frames(len(leg.hip), side, found, walker.rate)
    heading = float(SIDE_SIGN[side]) * _TOE_OUT
    if leg.aim is not None:
        way = (leg.aim - leg.heel)[flat].mean(0)
        heading = float(np.arctan2(way[0], way[2]))
    if abs(heading) > _AHEAD or float((leg.ball - leg.heel)[flat, 2].mean()) < 0.0:
        raise InfeasibleError("it walks backward or sideways; only walking ahead is learned")
    beside = np.zeros(3)
    if walker.flat:
        usual = body_from_height(_height_of(leg.length))
        beside[0] = 0.5 * SIDE_SIGN[side] * (_STEP_WIDTH * usual.height - usual.hip_width)
    else:
        ankle = (leg.ankle - leg.heel)[flat].mean(0)
        beside[0] = ankle[2] * np.tan(heading) - ankle[0]
    plane = 0.0 if walker.flat else heading
    sole, ankle = (_in_plane(leg.heel, p, plane)[flat] for p in (leg.ball, leg.ankle))
    length = np.linalg.norm(sole, axis=-1)
    heel = float(((ankle * sole).sum(-1) / length).mean())
    high = float(((sole[:, 0] * ankle[:, 1] - sole[:, 1] * ankle[:, 0]) / length).mean())
    toes, toe_zero = 0.0, 0.0
    if leg.tip is not None:
        toes = float(_in_plane(leg.ball, leg.tip, plane)[flat, 0].mean())
        toe_zero = float(_slope(leg.ball, leg.tip, plane)[flat].mean())
    return FlatFoot(
        flat=flat,
        heading=heading,
        told=leg.aim is not None,
        plane=plane,
        beside=beside,
        round_heel=_round_heel(leg, side, found, walker.rate, flat, plane),
        triangle=(high, heel, float(length.mean()) - heel, toes),
        zero=(float(_slope(leg.heel, leg.ball, plane)[flat].mean()), toe_zero),
    )


def body_of_legs(
    walker: MarkerWalker,
    feet: dict[int, FlatFoot],
    height: float | None,
    notes: list[str],
) -> Body:
    """The body of ``walker``: thigh and shin are the mean of both sides while the foot is flat.

    Markers on the skin slide along the bone, most in swing.
    """
    thighs, shins = list[float](), list[float]()
    for side, leg in walker.legs.items():
        flat = feet[side].flat
        for bone, out in ((leg.knee - leg.hip, thighs), (leg.ankle - leg.knee, shins)):
            out.append(float(np.linalg.norm(bone[flat], axis=-1).mean()))
    thigh, shin = float(np.mean(thighs)), float(np.mean(shins))
    usual = body_from_height(_height_of(thigh + shin) if height is None else height)
    if not 0.7 <= (thigh + shin) / usual.leg_length <= 1.3:
        raise InfeasibleError(
            f"legs of {thigh + shin:.3f} m (hip to ankle) do not go with a height of "
            f"{usual.height:.2f} m"
        )
    if not _KNEES[0] <= thigh / shin <= _KNEES[1]:
        notes.append(
            f"thigh {thigh:.3f} m and shin {shin:.3f} m: the knee's marker is far from its axis "
            "along the leg; their sum is kept, split as usual"
        )
        thigh, shin = ((thigh + shin) * b / usual.leg_length for b in (usual.thigh, usual.shin))
    foot = _foot(feet, usual, thigh + shin, notes)
    lengths = {"thigh": thigh, "shin": shin, "hip_width": _hip_width(walker, usual, notes)}
    above = foot.ankle_height + thigh + shin
    if height is None:
        stature = above + usual.trunk + usual.neck + usual.head
    else:  # the trunk makes up for what the legs are longer or shorter than usual
        stature, lengths["trunk"] = height, height - above - usual.neck - usual.head
    if any(not f.told for f in feet.values()):
        notes.append(f"toe-out is not told by the markers: {np.degrees(_TOE_OUT):.0f} deg assumed")
    return replace(usual, name="markers", height=stature, foot=foot, **lengths)


def _height_of(leg_length: float) -> float:
    height = leg_length / _LEG
    if not SHORTEST <= height <= TALLEST:
        raise InfeasibleError(
            f"legs of {leg_length:.3f} m (hip to ankle) are no person's; check the unit of the file"
        )
    return height


def _hip_width(walker: MarkerWalker, usual: Body, notes: list[str]) -> float:
    if len(walker.legs) < 2 or walker.flat:
        return usual.hip_width
    apart = walker.legs[LEFT].hip - walker.legs[RIGHT].hip
    width = float(np.linalg.norm(apart, axis=-1).mean())
    if _HIP_WIDTHS[0] * usual.height <= width <= _HIP_WIDTHS[1] * usual.height:
        return width
    notes.append(f"hip joints {width:.3f} m apart are not believed: {usual.hip_width:.3f} m taken")
    return usual.hip_width


def _foot(feet: dict[int, FlatFoot], usual: Body, leg: float, notes: list[str]) -> Foot:
    """The foot triangle, both feet's mean, where it is a foot's."""
    high, heel, ball, toes = np.mean([f.triangle for f in feet.values()], axis=0).tolist()
    shares = FOOT_SHARES
    if not _ANKLES[0] * leg <= high <= _ANKLES[1] * leg:
        notes.append(
            f"ankle markers {1000 * high:.0f} mm above the line from heel to ball: ankle height of "
            f"{1000 * _USUAL_ANKLE * leg:.0f} mm taken"
        )
        high = _USUAL_ANKLE * leg
    for what, value, normal in (("heel", heel, usual.foot.heel), ("ball", ball, usual.foot.ball)):
        if not 0.4 * normal <= value <= 1.8 * normal:
            raise InfeasibleError(
                f"the {what} marker is {value:.3f} m from the ankle along a flat foot, about "
                f"{normal:.3f} m were expected: are the markers of the foot exchanged?"
            )
    bears = heel - float(np.mean([f.round_heel for f in feet.values()]))
    heel = min(max(bears, _HEELS[0] * usual.foot.heel), _HEELS[1] * usual.foot.heel)
    if not 0.3 * ball <= toes <= ball:
        toes = ball * shares[2] / shares[1]
    return Foot(ankle_height=high, heel=heel, ball=ball, toes=toes)


def _flat_frames(
    count: int, side: int, found: Sequence[Stance], rate: float
) -> Bool[np.ndarray, "F"]:
    """Frames in which a foot surely stands flat; whole stances if there are any."""
    own = [s for s in found if s.side == side]
    own = [s for s in own if not s.cut] or own
    time = np.arange(count) / rate
    out = np.zeros(count, dtype=bool)
    for s in own:
        a, b = (s.foot_flat + share * (s.heel_off - s.foot_flat) for share in _FLAT)
        out |= (time >= a) & (time <= b)
    if out.sum() < 2:
        raise InfeasibleError(
            f"the {SIDES[side]} foot never stands flat in the markers: from foot flat to heel off"
        )
    return out


def _in_plane(
    tail: Float[np.ndarray, "F 3"], head: Float[np.ndarray, "F 3"], heading: float
) -> Float[np.ndarray, "F 2"]:
    """Forward along ``heading`` and up, from ``tail`` to ``head``."""
    d = head - tail
    return np.stack([d[:, 0] * np.sin(heading) + d[:, 2] * np.cos(heading), d[:, 1]], axis=-1)


def _slope(
    tail: Float[np.ndarray, "F 3"], head: Float[np.ndarray, "F 3"], heading: float
) -> Float[np.ndarray, "F"]:
    d = _in_plane(tail, head, heading)
    return np.unwrap(np.arctan2(d[:, 1], d[:, 0]))


def _round_heel(
    leg: MarkerLeg,
    side: int,
    found: Sequence[Stance],
    rate: float,
    flat: Bool[np.ndarray, "F"],
    plane: float,
) -> float:
    """How far ahead of its marker a heel bears: the marker rises as the foot turns about it."""
    slope = _slope(leg.heel, leg.ball, plane)
    slope = np.sin(slope - slope[flat].mean())
    rise = leg.heel[:, 1] - leg.heel[flat, 1].mean()
    time = np.arange(len(slope)) / rate
    lands = np.zeros(len(slope), dtype=bool)
    for s in found:
        if s.side == side and s.cut not in ("start", "both"):
            lands |= (time >= s.heel_strike) & (time <= s.foot_flat)
    weight = float((slope[lands] ** 2).sum())
    return 0.0 if weight < 0.05 else float((slope * rise)[lands].sum()) / weight


def _near_zero(
    angle: Float[np.ndarray, "F"], flat: Bool[np.ndarray, "F"]
) -> Float[np.ndarray, "F"]:
    """The same angle less whole turns, so that it is about 0 while the foot is flat."""
    return angle - 2.0 * np.pi * np.round(angle[flat].mean() / (2.0 * np.pi))
