"""The walk with planted feet that is nearest to a measured stride in its joint angles.

A captured foot is not still while it bears: it slides some millimeters to centimeters, its heel
is round, its skeleton a guess. A walk that is to be generalized has feet that roll over heel,
ball and toe tip and move nowhere else ([KB92b] Figure 7). So the hips' path and the soles'
pitch are found with which such feet show the measured hip, knee and ankle angles best: a
least-squares problem in a few splines, solved once when a gait is learned.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import BALL, HEEL, SIDES, TOE
from gaitsmith.geometry.curves import smoothstep
from gaitsmith.motion.kinematics import forward_kinematics, sole_positions
from gaitsmith.walks.planting_fit import ONSET, SAMPLES, Fit, Measured

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.gait.cycle import Cycle

#: Least share of the stride in which toes turn up before they leave.
TURNING = 0.08
#: A sole is level below this pitch, and its toes lie below this meta angle, radians.
LEVEL, LYING = float(np.radians(2.0)), float(np.radians(4.0))
#: The toes of a living foot begin to slide before the force is gone, those of a planted one leave
#: then: 40 ms earlier in four of five toe-offs with force plates, half of that here (stride).
SLIDES = 0.02
#: Least double support of planted feet after each heel strike, share of the stride.
DOUBLE = 0.02
#: A foot whose sole is never more level than this in stance walks on its toes.
_ON_TOES = float(np.radians(6.0))
#: Toes: share of the sole's pitch that the meta angle has at toe-off where toes are not known.
_META_SHARE = 0.75


@dataclass(frozen=True, eq=False)
class Planted:
    """A stride with planted feet on N samples of stride phase ``k / N``.

    Attributes
    ----------
    center
        ``(N, 2)`` forward and up of the hips' middle, forward from N of the left foot that
        strikes at phase 0, the walk's travel included.
    ankle
        ``(N, 2, 2)`` of [left, right], the same.
    pitch, meta
        ``(N, 2)`` sole and meta angle; meta is 0 where the toes lie, of no meaning in swing.
    hip
        ``(N, 2, 2)`` forward and up of [left, right] hip joint from the hips' middle.
    place
        ``(2,)`` where [left, right] stand that strike within this stride.
    marks
        ``(2, 5)`` own phases of [left, right]: flat, heel off, meta off, toe-off, and the
        stride phase of the heel strike that they count from.
    stride_length
        Meters.
    """

    center: Float[np.ndarray, "N 2"]
    ankle: Float[np.ndarray, "N 2 2"]
    pitch: Float[np.ndarray, "N 2"]
    meta: Float[np.ndarray, "N 2"]
    hip: Float[np.ndarray, "N 2 2"]
    place: Float[np.ndarray, "2"]
    marks: Float[np.ndarray, "2 5"]
    stride_length: float


def plant(cycle: Cycle, body: Body, *, place: Float[np.ndarray, "2"], width: float) -> Planted:
    """Planted feet for the legs of ``cycle``.

    Parameters
    ----------
    cycle
        A stride of ``body``.
    body
        Whose legs and feet.
    place
        N of [left, right] along the walk, meters in the cycle's frame; see
        :func:`gaitsmith.gait.learn.standing_feet`.
    width
        Between the lines of left and right feet, meters.
    """
    seen = _seen(cycle, place[0])
    place = np.array([0.0, place[1] - place[0]])
    marks = np.stack([_marks(seen, cycle.events, side) for side in (0, 1)])
    pitch = np.stack([_pitch(seen, marks[s], s) for s in (0, 1)], axis=-1)
    meta = np.stack([_meta(seen, marks[s], s) for s in (0, 1)], axis=-1)
    fit = Fit(seen, body, cycle.stride_length, place, marks, width, pitch, meta)
    center, pitch, meta = fit.solved()
    ankle = fit.ankles(pitch, meta)
    hip = seen.hip[..., [2, 1]]
    pitch, meta, ankle = _swung(seen, fit, center[:, None] + hip, pitch, meta, ankle)
    return Planted(center, ankle, pitch, meta, hip, place, marks, cycle.stride_length)


def _seen(cycle: Cycle, zero: float) -> Measured:
    cycle = cycle.legs
    phase = np.arange(SAMPLES) / SAMPLES
    center, turned = cycle.at(phase)
    center = center + (phase * cycle.stride_length - zero)[:, None] * [0.0, 0.0, 1.0]
    positions, world = forward_kinematics(cycle.skeleton, center, turned)
    soles = sole_positions(cycle.skeleton, positions, world)

    def at(part: str) -> Float[np.ndarray, "N 2 3"]:
        return np.stack([positions[:, cycle.skeleton.index(s + part)] for s in SIDES], axis=1)

    def slope(tail: int, head: int) -> Float[np.ndarray, "N 2"]:
        v = soles[:, :, head] - soles[:, :, tail]
        ahead = np.sign(v[..., 2]) * np.hypot(v[..., 0], v[..., 2])
        return np.unwrap(np.arctan2(v[..., 1], ahead), axis=0)

    hip, knee, ankle = at("UpperLeg"), at("LowerLeg"), at("Foot")
    thigh, shin = knee - hip, ankle - knee
    sine = np.linalg.norm(np.cross(thigh, shin), axis=-1)
    return Measured(
        phase=phase,
        center=center,
        hip=hip - center[:, None],
        leg=ankle - hip,
        thigh=np.arctan2(thigh[..., 2], -thigh[..., 1]),
        knee=np.arctan2(sine, (thigh * shin).sum(-1)),
        pitch=slope(HEEL, BALL),
        toes=slope(BALL, TOE),
        own=(phase[:, None] - cycle.events[:, 0]) % 1.0,
    )


def _stance(seen: Measured, side: int, last: float) -> tuple[np.ndarray, np.ndarray]:
    """Order in which a foot's own phase rises, and which of those samples are of its stance."""
    order = np.argsort(seen.own[:, side])
    return order, seen.own[order, side] <= last


def _marks(seen: Measured, both: Float[np.ndarray, "2 4"], side: int) -> Float[np.ndarray, "5"]:
    """Own phases at which the sole is level, rises, stands on its tip and leaves."""
    events = both[side]
    landing = float((both[1 - side, 0] - events[0]) % 1.0)
    toe_off = max(float((events[3] - events[0]) % 1.0) - SLIDES, landing + DOUBLE)
    order, stands = _stance(seen, side, toe_off)
    own, pitch = seen.own[order, side][stands], seen.pitch[order, side][stands]
    inside = (own > 0.1 * toe_off) & (own < 0.85 * toe_off)
    if pitch[inside].max() < -_ON_TOES:  # on the toes all the time: flat means flattest
        flat = float(own[inside][pitch[inside].argmax()])
        heel_off = flat + 0.5 / SAMPLES
    else:
        level = np.flatnonzero(np.abs(pitch) < LEVEL)
        flat = float(own[level[0]]) if len(level) else 0.5 * toe_off
        flat = min(max(flat, 0.02), 0.5 * toe_off)
        high = np.flatnonzero(pitch > -LEVEL)
        heel_off = float(own[high[-1]]) if len(high) else 0.6 * toe_off
        latest = min(0.85 * toe_off, toe_off - TURNING - 0.02)
        heel_off = min(max(heel_off, flat + 0.02), latest)
    lying = np.flatnonzero(-seen.toes[order, side][stands] < LYING)
    meta_off = float(own[lying[-1]]) if len(lying) else heel_off
    if not _has_toes(seen, side):
        meta_off = heel_off + 0.45 * (toe_off - heel_off)
    meta_off = min(max(meta_off, heel_off + 0.02), toe_off - TURNING)
    return np.array([flat, heel_off, meta_off, toe_off, events[0]])


def _has_toes(seen: Measured, side: int) -> bool:
    return float(np.ptp(seen.toes[:, side] - seen.pitch[:, side])) > np.radians(5.0)


def _pitch(seen: Measured, marks: Float[np.ndarray, "5"], side: int) -> Float[np.ndarray, "N"]:
    """Measured pitch as a planted sole can show it: down to level, level, rising."""
    flat, heel_off, _, toe_off, _ = marks
    out = np.array(seen.pitch[:, side])
    order, stands = _stance(seen, side, toe_off)
    own, value = seen.own[order, side], out[order]
    if np.interp(flat, own, value) < -_ON_TOES:
        value = np.where(stands, np.minimum(value, -0.02), value)
    else:
        at_flat = np.interp(flat, own, value)
        landing = own < flat
        first = value[landing] - at_flat * own[landing] / flat
        if first.size and first[0] < -LEVEL:  # the toes land first
            value[landing] = np.maximum.accumulate(np.minimum(first, 0.0))
        else:
            value[landing] = np.minimum.accumulate(np.maximum(first, 0.0))
        value[(own >= flat) & (own <= heel_off)] = 0.0
        rising = (own > heel_off) & stands
        rise = np.minimum(value[rising], 0.0) * smoothstep((own[rising] - heel_off) / ONSET)
        value[rising] = np.minimum.accumulate(rise)
    out[order] = value
    return out


def _meta(seen: Measured, marks: Float[np.ndarray, "5"], side: int) -> Float[np.ndarray, "N"]:
    """Toes against the floor from meta off to toe-off, 0 elsewhere."""
    _, _, meta_off, toe_off, _ = marks
    order, stands = _stance(seen, side, toe_off)
    own = seen.own[order, side]
    turning = (own > meta_off) & stands
    u = (own[turning] - meta_off) / (toe_off - meta_off)
    if _has_toes(seen, side):
        value = np.maximum(-seen.toes[order, side][turning], 0.0)
        value = np.maximum(value - LYING * (1.0 - u), 0.0)
    else:
        at_off = np.interp(toe_off, own, seen.pitch[order, side])
        value = _META_SHARE * max(-float(at_off), 0.2) * u**1.5
    out = np.zeros(SAMPLES)
    out[order[turning]] = np.maximum.accumulate(value) if value.size else value
    return out


def _swung(
    seen: Measured,
    fit: Fit,
    hip: Float[np.ndarray, "N 2 2"],
    pitch: Float[np.ndarray, "N 2"],
    meta: Float[np.ndarray, "N 2"],
    ankle: Float[np.ndarray, "N 2 2"],
) -> tuple[Float[np.ndarray, "N 2"], Float[np.ndarray, "N 2"], Float[np.ndarray, "N 2 2"]]:
    """Swinging feet as measured from the hips, led over to where they leave and land."""
    pitch, meta, ankle = (np.array(v) for v in (pitch, meta, ankle))
    free = hip + seen.leg[..., [2, 1]]
    for side in (0, 1):
        own, down = seen.own[:, side], fit.down[:, side]
        order = np.argsort(own)
        stance = order[down[order]]
        last, first = stance[-1], stance[0]
        u = (own - own[last]) / (1.0 - own[last])
        leave, land = 1.0 - smoothstep(u / 0.6), smoothstep((u - 0.4) / 0.6)
        swing = ~down
        gone = ankle[last, side] - free[last, side]
        come = ankle[first, side] - free[first, side]
        led = free[:, side] + leave[:, None] * gone + land[:, None] * come
        ankle[swing, side] = led[swing]
        turn = (
            seen.pitch[:, side]
            + leave * (pitch[last, side] - seen.pitch[last, side])
            + land * (pitch[first, side] - seen.pitch[first, side])
        )
        pitch[swing, side] = turn[swing]
        # the meta angle goes on as it was when the toes left, so that it can be read up to there
        rate = meta[last, side] - meta[stance[-2], side]
        later = order[~down[order]]
        meta[later, side] = meta[last, side] + rate * np.minimum(np.arange(1, len(later) + 1), 2)
    return pitch, meta, ankle
