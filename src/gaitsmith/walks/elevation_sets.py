"""Elevation data of a person's legs: the five datasets of [SM01], and more that span more.

The paper's are not published. Level ones here are the legs of ``neutral``, one measured man's
stride on planted feet, at several step lengths; slopes are made from those by rule, since no open
capture of slopes was found. Any other measured or learned legs give such sets too.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import LEFT
from gaitsmith.gait.neutral import neutral_cycle, subject
from gaitsmith.geometry.curves import hann_average, pchip, running_maximum, smoothstep
from gaitsmith.walks.elevation import PELVIS, SAMPLES, ElevationSet, pelvis_height, set_from_cycle
from gaitsmith.walks.files import built_in
from gaitsmith.walks.kinematic import KinematicWalk
from gaitsmith.walks.model import StepRequest
from gaitsmith.walks.round_heel import RoundHeel, turned

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.gait.cycle import Cycle
    from gaitsmith.walks.model import SagittalStep, StraightWalk

#: Step lengths of the level sets over leg length; the normal one is the measured man's own.
SHORT, LONG = 0.55, 1.05
#: Slopes (degrees) of the two constructed sets, and their step lengths over the normal one.
UPHILL, DOWNHILL = (11.0, 0.92), (-11.0, 0.88)
#: Step lengths over leg length of the level sets that span what people walk, beside the person's
#: own; slopes (degrees) of those made by rule, and their steps over leg length.
SPANNED = (0.14, 0.35, 0.55, 1.05, 1.14)
SLOPES, SLOPE_STEPS = (-17.0, -9.0, 9.0, 17.0), (0.3, 0.55, 0.8, 1.05)
#: Farthest that hip and ankle may be apart, over leg length: the knee keeps 6 degrees.
REACH = 0.9985
#: Phases of the stride over which hips come down before and after they must.
_SETTLE = 0.05
_STEP_TIME = 0.57225


@dataclass(frozen=True, eq=False)
class Legs:
    """Whose legs the data are of.

    Attributes
    ----------
    walk
        A straight walk of them on level ground.
    body
        The person's.
    cycle
        Stride that the pelvis' angle is read off.
    length
        The person's own step, meters.
    step_time
        Seconds of it.
    source
        Where they are from.
    """

    walk: StraightWalk
    body: Body
    cycle: Cycle
    length: float
    step_time: float
    source: str


@dataclass(frozen=True, eq=False)
class _Stride:
    """One leg from aside over its stride: its stance N is the origin, its next N is at 2 steps.

    ``pitch`` (K) of the sole against the ground, ``ankle`` and hips' ``middle`` (K, 2), meters;
    ``meta`` (K) of the toes against the ground as they turn about their tip, ``toe_off`` the phase
    of the stride at which they leave.
    """

    length: float
    pitch: Float[np.ndarray, "K"]
    ankle: Float[np.ndarray, "K 2"]
    middle: Float[np.ndarray, "K 2"]
    meta: Float[np.ndarray, "K"]
    toe_off: float


@cache
def neutral_legs() -> Legs:
    """Of the measured man whose walk ``neutral`` is."""
    data = built_in("neutral_step")
    return Legs(
        KinematicWalk([data]),
        subject(),
        neutral_cycle(),
        data.length,
        _STEP_TIME,
        "legs of neutral (Rajagopal 2016, Apache-2.0) on planted feet",
    )


@cache
def built_in_sets() -> tuple[ElevationSet, ...]:
    """Normal, short, long, uphill and downhill, of the measured man's body."""
    legs = neutral_legs()
    normal = _planted(legs, legs.length)
    sets = [_as_set(normal, legs, name="normal")]
    for name, ratio in (("short", SHORT), ("long", LONG)):
        stride = _planted(legs, ratio * legs.body.leg_length)
        how = f"the normal set generalized to {ratio:g} leg lengths as [KB92b] does"
        sets.append(_as_set(stride, legs, name=name, constructed=how))
    for name, (degrees, share) in (("uphill", UPHILL), ("downhill", DOWNHILL)):
        stride, targets = _sloped(normal, legs, np.radians(degrees), share)
        how = (
            f"the normal set with {share:g} of its steps, sheared to {degrees:g} deg, feet laid on "
            "the slope, hips refitted so that thigh and knee stay near to normal"
        )
        fitted = _refitted(stride, legs, targets)
        sets.append(_as_set(fitted, legs, name=name, constructed=how, slope=degrees))
    return tuple(sets)


def spanning_sets(legs: Legs, side: int = LEFT) -> tuple[ElevationSet, ...]:
    """Sets of the leg on ``side`` for steps of 0.14 to 1.14 leg lengths, slopes of -17 to 17 deg.

    All but the person's own step are constructed: level ones by the walk itself, slopes by rule as
    those of :func:`built_in_sets`.
    """
    normal = _planted(legs, legs.length, side)
    sets = [_as_set(normal, legs, name="normal")]
    leg = legs.body.leg_length
    for ratio in SPANNED:
        how = f"the normal set generalized to {ratio:g} leg lengths"
        stride = _planted(legs, ratio * leg, side)
        sets.append(_as_set(stride, legs, name=f"{ratio:g}", constructed=how))
    for degrees in SLOPES:
        for ratio in SLOPE_STEPS:
            level = _planted(legs, ratio * leg, side)
            stride, targets = _sloped(level, legs, np.radians(degrees), 1.0)
            how = (
                f"steps of {ratio:g} leg lengths sheared to {degrees:g} deg, feet laid on the "
                "slope, hips refitted"
            )
            name = f"{ratio:g} at {degrees:g} deg"
            fitted = _refitted(stride, legs, targets)
            sets.append(_as_set(fitted, legs, name=name, constructed=how, slope=degrees))
    return tuple(sets)


def _planted(legs: Legs, length: float, side: int = LEFT) -> _Stride:
    """A steady level stride of the leg on ``side``, on the round heel."""
    asked = [StepRequest(s, length, length, length, legs.step_time) for s in (side, 1 - side)]
    own, other = (legs.walk.step(legs.body, request) for request in asked)
    phase = 2.0 * np.arange(SAMPLES // 2) / SAMPLES

    def read(step: SagittalStep, values: Float[np.ndarray, "T c"]) -> Float[np.ndarray, "K c"]:
        return pchip(step.phase, values, phase)

    # heel rocker, flat, heel off: never back, so that the foot rolls
    stance = np.minimum.accumulate(read(own, own.pitch[:, :1])[:, 0])
    pitch = np.concatenate([stance, read(other, other.pitch[:, 1:])[:, 0]])
    meta = np.concatenate([read(own, own.meta[:, :1])[:, 0], _rolling_off(other, phase)])
    ahead = np.array([length, 0.0])
    middle = np.concatenate([read(own, own.center), ahead + read(other, other.center)])
    swing = ahead + read(other, other.ankle[:, 1])
    stride = _Stride(length, pitch, np.tile(swing, (2, 1)), middle, meta, 0.5 + 0.5 * other.toe_off)
    return _on_round_heel(legs.body, stride, 0.0)


def _rolling_off(step: SagittalStep, phase: Float[np.ndarray, "k"]) -> Float[np.ndarray, "k"]:
    """Meta of the foot behind, fading after toe-off.

    Of a foot that swings there is none; but who reads it between samples must not meet the drop.
    """
    bears = step.phase <= step.toe_off
    last = float(step.meta[bears, 1][-1])
    out = pchip(step.phase[bears], step.meta[bears, 1:], np.minimum(phase, step.toe_off))[:, 0]
    gone = smoothstep((phase - step.toe_off) / (1.0 - step.toe_off))
    return np.where(phase <= step.toe_off, out, last * (1.0 - gone))


def _on_round_heel(body: Body, stride: _Stride, slope: float) -> _Stride:
    """The stance ankle rolls over the round heel; the swing ankle leaves it and arrives there."""
    half = SAMPLES // 2
    sole = RoundHeel.of(body.foot)
    ankle = stride.ankle.copy()
    ankle[:half] = turned(sole.stand(stride.pitch[:half]), np.full(half, slope))
    # the pose that ends the stance, half a stride after heel strike, starts the swing
    leaves = turned(sole.stand(stride.pitch[half]), np.array(slope))
    lands = turned(sole.stand(stride.pitch[0]), np.array(slope))
    lands = lands + 2.0 * stride.length * np.array([1.0, np.tan(slope)])
    u = np.arange(half) / half
    # where the swing would be a sample after its last
    end = ankle[-1] + (ankle[-1] - ankle[-2])
    fades, rises = 1.0 - smoothstep(u / 0.3), smoothstep((u - 0.6) / 0.4)
    ankle[half:] += fades[:, None] * (leaves - ankle[half]) + rises[:, None] * (lands - end)
    return replace(stride, ankle=ankle)


def _hips(
    middle: Float[np.ndarray, "*n K 2"], body: Body, pelvis: Float[np.ndarray, "K"]
) -> Float[np.ndarray, "*n K 2"]:
    """Hip joint of the leg: the middle, and what the pelvis' rotation puts it ahead of that."""
    tangent = pelvis_height(body) * np.tan(pelvis)
    turn = 0.5 * (tangent - np.roll(tangent, SAMPLES // 2))
    return middle + np.stack([turn, np.zeros(SAMPLES)], axis=-1)


def _pelvis(legs: Legs, length: float) -> Float[np.ndarray, "K"]:
    """Pelvis angle of the measured person; its rotation grows with the step."""
    raw = set_from_cycle(legs.cycle, "own").for_body(legs.body).angles[:, PELVIS]
    tangent = np.tan(raw)
    other = np.roll(tangent, SAMPLES // 2)
    share = length / legs.length
    return np.arctan(0.5 * (tangent + other) + 0.5 * share * (tangent - other))


def _legs(
    hip: Float[np.ndarray, "*n K 2"], ankle: Float[np.ndarray, "K 2"], body: Body
) -> tuple[Float[np.ndarray, "*n K"], Float[np.ndarray, "*n K"], Float[np.ndarray, "*n K"]]:
    """Thigh elevation, knee flexion (radians) and hip to ankle over leg length."""
    way = ankle - hip
    far = np.hypot(way[..., 0], way[..., 1])
    span = np.minimum(far, REACH * body.leg_length)
    a, b = body.thigh, body.shin
    at_hip = np.arccos(np.clip((a * a + span**2 - b * b) / (2.0 * a * span), -1.0, 1.0))
    knee = np.pi - np.arccos(np.clip((a * a + b * b - span**2) / (2.0 * a * b), -1.0, 1.0))
    return np.arctan2(way[..., 0], -way[..., 1]) + at_hip, knee, far / body.leg_length


def _lowered(stride: _Stride, body: Body, pelvis: Float[np.ndarray, "K"]) -> _Stride:
    """Hips come down where a leg would be too short, softly."""
    hip = _hips(stride.middle, body, pelvis)
    way = stride.ankle - hip
    leg = REACH * body.leg_length
    room = np.sqrt(np.maximum(leg**2 - way[:, 0] ** 2, 0.0))
    need = np.maximum(-way[:, 1] - room, 0.0)
    need = np.maximum(need, np.roll(need, SAMPLES // 2))
    width = round(_SETTLE * SAMPLES)
    wide = running_maximum(np.tile(need, 3), width)
    soft = hann_average(wide, width)[SAMPLES : 2 * SAMPLES]
    return replace(stride, middle=stride.middle - np.stack([np.zeros(SAMPLES), soft], axis=-1))


def _as_set(
    stride: _Stride, legs: Legs, *, name: str, constructed: str = "", slope: float = 0.0
) -> ElevationSet:
    """The four angles of a stride; ``slope`` in degrees."""
    rho, body = float(np.radians(slope)), legs.body
    pelvis = _pelvis(legs, stride.length)
    lowered = _lowered(stride, body, pelvis)
    thigh, knee, _ = _legs(_hips(lowered.middle, body, pelvis), stride.ankle, body)
    foot = 0.5 * np.pi + rho + stride.pitch
    walked = stride.length / legs.length
    return ElevationSet(
        np.stack([foot, thigh - knee, thigh, pelvis], axis=-1),
        0.5 * body.hip_width / pelvis_height(body),
        rho,
        legs.step_time / walked if slope == 0.0 else legs.step_time,
        body.leg_length,
        name=name,
        source=legs.source,
        constructed=constructed,
        meta=stride.meta,
        toe_off=stride.toe_off,
        above=(stride.middle - lowered.middle)[:, 1] / body.leg_length,
    )


def _sloped(
    level: _Stride, legs: Legs, rho: float, share: float
) -> tuple[_Stride, tuple[np.ndarray, np.ndarray]]:
    """The level stride on a slope, and thigh and knee that its hips are to come near to."""
    body = legs.body
    pelvis = _pelvis(legs, level.length)
    hip = _hips(_lowered(level, body, pelvis).middle, body, pelvis)
    thigh, knee, _ = _legs(hip, level.ankle, body)
    t = np.arange(SAMPLES) / SAMPLES
    rise = np.tan(rho)
    pitch = np.where(level.pitch > 0.0, level.pitch * min(1.0, 1.0 - 3.0 * rho), level.pitch)

    def sheared(points: np.ndarray) -> np.ndarray:
        x = share * points[:, 0]
        return np.stack([x, points[:, 1] + rise * x], axis=-1)

    stride = replace(
        level,
        length=share * level.length,
        pitch=pitch,
        ankle=sheared(level.ankle),
        middle=sheared(level.middle),
    )
    stride = _on_round_heel(body, stride, rho)
    early = np.exp(-0.5 * ((t - 0.13) / 0.07) ** 2) + np.exp(-0.5 * ((t - 1.13) / 0.07) ** 2)
    strike = np.exp(-0.5 * (t / 0.06) ** 2) + np.exp(-0.5 * ((t - 1.0) / 0.06) ** 2)
    size = abs(rho) / np.radians(10.0)
    if rho > 0.0:  # hip and knee more bent at contact, +12..20 and +10..20 deg at 10 deg
        bend, lift = np.radians(15.0) * size * strike, np.radians(15.0) * size * strike
    else:  # loading: the knee yields by 10..20 deg more
        bend, lift = np.radians(15.0) * size * early, np.radians(5.0) * size * early
    return stride, (thigh + lift, knee + bend)


def _refitted(stride: _Stride, legs: Legs, targets: tuple[np.ndarray, np.ndarray]) -> _Stride:
    """Hips' middle moved so that thigh and knee come near to ``targets``, legs in reach.

    One offset ahead; heights as an offset and three even harmonics: what the trunk runs
    ahead and behind is left as measured, for freely fitted it lags where it should lead.
    """
    body = legs.body
    turn = 4.0 * np.pi * np.arange(SAMPLES)[:, None] / SAMPLES * np.arange(1, 4)
    height = np.concatenate([np.ones((SAMPLES, 1)), np.cos(turn), np.sin(turn)], axis=1)
    pelvis = _pelvis(legs, stride.length)

    def moved(x: np.ndarray) -> np.ndarray:
        ahead = np.repeat(x[..., :1], SAMPLES, axis=-1)
        return stride.middle + np.stack([ahead, x[..., 1:] @ height.T], axis=-1)

    def residual(x: np.ndarray) -> np.ndarray:
        thigh, knee, reach = _legs(_hips(moved(x), body, pelvis), stride.ankle, body)
        too_far = 300.0 * np.maximum(reach - REACH + 1e-3, 0.0)
        parts = [thigh - targets[0], 0.7 * (knee - targets[1]), too_far, 0.5 * x]
        return np.concatenate(parts, axis=-1)

    x, damping = np.zeros(1 + height.shape[1]), 1e-3
    value, tiny = residual(x), 1e-6 * np.eye(len(x))
    for _ in range(60):
        jacobian = ((residual(x + tiny) - residual(x - tiny)) / 2e-6).T
        system = jacobian.T @ jacobian
        step = np.linalg.solve(system + damping * np.diag(np.diag(system)), -jacobian.T @ value)
        tried = residual(x + step)
        if tried @ tried < value @ value:
            x, value, damping = x + step, tried, 0.5 * damping
            if np.abs(step).max() < 1e-7:
                break
        else:
            damping *= 8.0
    return replace(stride, middle=moved(x))
