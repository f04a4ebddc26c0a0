"""The five datasets of [SM01]: level short, normal and long, uphill, downhill.

The paper's are not published. Level ones here are the legs of ``neutral``, one measured man's
stride on planted feet, at three step lengths; the two slopes are made from the normal one by
rule, since no open capture of slopes was found.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

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
    from gaitsmith.walks.model import SagittalStep

#: Step lengths of the level sets over leg length; the normal one is the measured man's own.
SHORT, LONG = 0.55, 1.05
#: Slopes (degrees) of the two constructed sets, and their step lengths over the normal one.
UPHILL, DOWNHILL = (11.0, 0.92), (-11.0, 0.88)
#: Farthest that hip and ankle may be apart, over leg length: the knee keeps 6 degrees.
REACH = 0.9985
#: Phases of the stride over which hips come down before and after they must.
_SETTLE = 0.05
_STEP_TIME = 0.57225


@dataclass(frozen=True, eq=False)
class _Stride:
    """One leg from aside over its stride: its stance N is the origin, its next N is at 2 steps.

    ``pitch`` (K) of the sole against the ground, ``ankle`` and hips' ``middle`` (K, 2), meters.
    """

    length: float
    pitch: Float[np.ndarray, "K"]
    ankle: Float[np.ndarray, "K 2"]
    middle: Float[np.ndarray, "K 2"]


@cache
def built_in_sets() -> tuple[ElevationSet, ...]:
    """Normal, short, long, uphill and downhill, of the measured man's body."""
    body = subject()
    legs = KinematicWalk([built_in("neutral_step")])
    data = built_in("neutral_step")
    normal = _planted(legs, body, data.length)
    level = "legs of neutral (Rajagopal 2016, Apache-2.0) on planted feet"
    sets = [_as_set(normal, body, name="normal", source=level)]
    for name, ratio in (("short", SHORT), ("long", LONG)):
        stride = _planted(legs, body, ratio * body.leg_length)
        how = f"the normal set generalized to {ratio:g} leg lengths as [KB92b] does"
        sets.append(_as_set(stride, body, name=name, source=level, constructed=how))
    for name, (degrees, share) in (("uphill", UPHILL), ("downhill", DOWNHILL)):
        stride, targets = _sloped(normal, body, np.radians(degrees), share)
        how = (
            f"the normal set with {share:g} of its steps, sheared to {degrees:g} deg, feet laid on "
            "the slope, hips refitted so that thigh and knee stay near to normal"
        )
        fitted = _refitted(stride, body, np.radians(degrees), targets)
        sets.append(
            replace(
                _as_set(fitted, body, name=name, source=level, constructed=how, slope=degrees),
            )
        )
    return tuple(sets)


def _planted(walk: KinematicWalk, body: Body, length: float) -> _Stride:
    """A steady level stride of ``walk`` on the round heel."""
    step = walk.step(body, StepRequest(0, length, length, length, _STEP_TIME))
    phase = 2.0 * np.arange(SAMPLES // 2) / SAMPLES

    def read(values: Float[np.ndarray, "T c"]) -> Float[np.ndarray, "K c"]:
        return pchip(step.phase, values, phase)

    pitch = np.concatenate([_stance_pitch(step, read), read(step.pitch[:, 1:])[:, 0]])
    ahead = np.array([length, 0.0])
    middle = np.concatenate([read(step.center), ahead + read(step.center)])
    swing = ahead + read(step.ankle[:, 1])
    return _on_round_heel(body, _Stride(length, pitch, np.tile(swing, (2, 1)), middle), 0.0)


def _stance_pitch(step: SagittalStep, read: object) -> Float[np.ndarray, "K"]:
    """Heel rocker, flat, heel off: never back, so that the foot rolls."""
    pitch = read(step.pitch[:, :1])[:, 0]  # type: ignore[operator]
    return np.minimum.accumulate(pitch)


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


def _hips(stride: _Stride, body: Body, pelvis: Float[np.ndarray, "K"]) -> np.ndarray:
    """Hip joint of the leg: the middle, and what the pelvis' rotation puts it ahead of that."""
    tangent = pelvis_height(body) * np.tan(pelvis)
    turn = 0.5 * (tangent - np.roll(tangent, SAMPLES // 2))
    return stride.middle + np.stack([turn, np.zeros(SAMPLES)], axis=-1)


def _pelvis(body: Body, length: float) -> Float[np.ndarray, "K"]:
    """Pelvis angle of the measured man; its rotation grows with the step."""
    raw = set_from_cycle(neutral_cycle(), "neutral").for_body(body).angles[:, PELVIS]
    tangent = np.tan(raw)
    other = np.roll(tangent, SAMPLES // 2)
    share = length / built_in("neutral_step").length
    return np.arctan(0.5 * (tangent + other) + 0.5 * share * (tangent - other))


def _legs(
    hip: Float[np.ndarray, "K 2"], ankle: Float[np.ndarray, "K 2"], body: Body
) -> tuple[Float[np.ndarray, "K"], Float[np.ndarray, "K"], Float[np.ndarray, "K"]]:
    """Thigh elevation, knee flexion (radians) and hip to ankle over leg length."""
    way = ankle - hip
    far = np.hypot(way[:, 0], way[:, 1])
    span = np.minimum(far, REACH * body.leg_length)
    a, b = body.thigh, body.shin
    at_hip = np.arccos(np.clip((a * a + span**2 - b * b) / (2.0 * a * span), -1.0, 1.0))
    knee = np.pi - np.arccos(np.clip((a * a + b * b - span**2) / (2.0 * a * b), -1.0, 1.0))
    return np.arctan2(way[:, 0], -way[:, 1]) + at_hip, knee, far / body.leg_length


def _lowered(stride: _Stride, body: Body, pelvis: Float[np.ndarray, "K"]) -> _Stride:
    """Hips come down where a leg would be too short, softly."""
    hip = _hips(stride, body, pelvis)
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
    stride: _Stride,
    body: Body,
    *,
    name: str,
    source: str,
    constructed: str = "",
    slope: float = 0.0,
) -> ElevationSet:
    """The four angles of a stride; ``slope`` in degrees."""
    rho = float(np.radians(slope))
    pelvis = _pelvis(body, stride.length)
    stride = _lowered(stride, body, pelvis)
    thigh, knee, _ = _legs(_hips(stride, body, pelvis), stride.ankle, body)
    foot = 0.5 * np.pi + rho + stride.pitch
    walked = stride.length / built_in("neutral_step").length
    return ElevationSet(
        np.stack([foot, thigh - knee, thigh, pelvis], axis=-1),
        0.5 * body.hip_width / pelvis_height(body),
        rho,
        _STEP_TIME / walked if slope == 0.0 else _STEP_TIME,
        body.leg_length,
        name=name,
        source=source,
        constructed=constructed,
    )


def _sloped(
    normal: _Stride, body: Body, rho: float, share: float
) -> tuple[_Stride, tuple[np.ndarray, np.ndarray]]:
    """The normal stride on a slope, and thigh and knee that its hips are to come near to."""
    pelvis = _pelvis(body, normal.length)
    thigh, knee, _ = _legs(_hips(_lowered(normal, body, pelvis), body, pelvis), normal.ankle, body)
    t = np.arange(SAMPLES) / SAMPLES
    rise = np.tan(rho)
    pitch = np.where(normal.pitch > 0.0, normal.pitch * min(1.0, 1.0 - 3.0 * rho), normal.pitch)

    def sheared(points: np.ndarray) -> np.ndarray:
        x = share * points[:, 0]
        return np.stack([x, points[:, 1] + rise * x], axis=-1)

    stride = _Stride(share * normal.length, pitch, sheared(normal.ankle), sheared(normal.middle))
    stride = _on_round_heel(body, stride, rho)
    early = np.exp(-0.5 * ((t - 0.13) / 0.07) ** 2) + np.exp(-0.5 * ((t - 1.13) / 0.07) ** 2)
    strike = np.exp(-0.5 * (t / 0.06) ** 2) + np.exp(-0.5 * ((t - 1.0) / 0.06) ** 2)
    size = abs(rho) / np.radians(10.0)
    if rho > 0.0:  # hip and knee more bent at contact, +12..20 and +10..20 deg at 10 deg
        bend, lift = np.radians(15.0) * size * strike, np.radians(15.0) * size * strike
    else:  # loading: the knee yields by 10..20 deg more
        bend, lift = np.radians(15.0) * size * early, np.radians(5.0) * size * early
    return stride, (thigh + lift, knee + bend)


def _refitted(
    stride: _Stride, body: Body, rho: float, targets: tuple[np.ndarray, np.ndarray]
) -> _Stride:
    """Hips' middle moved so that thigh and knee come near to ``targets``, legs in reach.

    One offset ahead; heights as an offset and three even harmonics: what the trunk runs
    ahead and behind is left as measured, for freely fitted it lags where it should lead.
    """
    turn = 4.0 * np.pi * np.arange(SAMPLES)[:, None] / SAMPLES * np.arange(1, 4)
    height = np.concatenate([np.ones((SAMPLES, 1)), np.cos(turn), np.sin(turn)], axis=1)
    pelvis = _pelvis(body, stride.length)

    def moved(x: np.ndarray) -> _Stride:
        shift = np.stack([np.full(SAMPLES, x[0]), height @ x[1:]], axis=-1)
        return replace(stride, middle=stride.middle + shift)

    def residual(x: np.ndarray) -> np.ndarray:
        thigh, knee, reach = _legs(_hips(moved(x), body, pelvis), stride.ankle, body)
        too_far = 300.0 * np.maximum(reach - REACH + 1e-3, 0.0)
        return np.concatenate([thigh - targets[0], 0.7 * (knee - targets[1]), too_far, 0.5 * x])

    x, damping = np.zeros(1 + height.shape[1]), 1e-3
    value = residual(x)
    for _ in range(60):
        jacobian = np.stack(
            [(residual(x + d) - residual(x - d)) / 2e-6 for d in 1e-6 * np.eye(len(x))], axis=-1
        )
        system = jacobian.T @ jacobian
        step = np.linalg.solve(system + damping * np.diag(np.diag(system)), -jacobian.T @ value)
        tried = residual(x + step)
        if tried @ tried < value @ value:
            x, value, damping = x + step, tried, 0.5 * damping
            if np.abs(step).max() < 1e-7:
                break
        else:
            damping *= 8.0
    return moved(x)
