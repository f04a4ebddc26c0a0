"""A walk by rule: the neutral one with another pace, other legs, another bearing.

Nothing is captured here. The legs are those of the built-in measured step at the step length asked
for, changed in sole angles, lift, width and height and posed again; pelvis, trunk, head and arms
keep the neutral movement, scaled about means that are moved.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.body.leg import two_bone_ik
from gaitsmith.body.rig import skeleton_of
from gaitsmith.body.sole import rolled_ankle
from gaitsmith.conventions import SIDE_SIGN, SIDES
from gaitsmith.errors import UnknownNameError
from gaitsmith.gait.cycle import Cycle
from gaitsmith.gait.neutral import neutral_cycle, subject
from gaitsmith.gait.posture import (
    mean_rotation,
    trunk_names,
    with_easy_shoulders_and_hands,
    with_head_that_follows,
    with_pelvis_tilt,
)
from gaitsmith.geometry.curves import hann_average, pchip, running_maximum, smoothstep
from gaitsmith.geometry.rotations import about, exp, inverse, log, multiply, rotate, sign_continuous
from gaitsmith.plan.pace import preferred_pace
from gaitsmith.style.align import SAMPLES
from gaitsmith.style.rules import RULES, Rule
from gaitsmith.walks import KinematicWalk
from gaitsmith.walks.files import built_in
from gaitsmith.walks.learned import gait_of_cycle
from gaitsmith.walks.model import StepRequest

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.walks.learned import LearnedGait

#: Longest hip to ankle over leg length in a stride: 7 deg of knee flexion.
REACH = 0.998
#: Forward tilt of the neutral pelvis, radians: as the built-in gait has it.
PELVIS_TILT = float(np.radians(5.0))
#: Samples of smoothing, 1.2 % of the stride.
SOFT = 1.5
#: Neutral step width over leg length, and toe-out in degrees.
WIDTH, TOE_OUT = 0.118, 6.0


@cache
def rule_gait(name: str) -> LearnedGait:
    """The built-in style ``name``, or ``"neutral"`` at the preferred pace, of the neutral man.

    Raises
    ------
    UnknownNameError
        If there is none of that name.
    """
    known = {"neutral": Rule()} | RULES
    if name not in known:
        raise UnknownNameError("style", name, known)
    rule = known[name]
    note = "made by rule from the built-in gait neutral"
    if rule.sources:
        note += f", after {rule.sources}"
    return gait_of_cycle(restyled(rule), subject(), name=name, notes=(note,))


def restyled(rule: Rule) -> Cycle:
    """The stride of the neutral man that ``rule`` describes, closed and symmetric."""
    body = subject()
    pace = preferred_pace(body)
    step = rule.step * pace.step_length
    neutral = _neutral()
    legs = _legs(body, round(step, 9))
    phase = np.arange(SAMPLES) / SAMPLES
    off = legs.toe_off
    seen = _retimed(phase, off, off + rule.double)
    center, turned = neutral.at(_to_measured(seen, legs.toe_off, neutral))
    pelvis = _pelvis(neutral, turned[:, 0], rule)
    skeleton = skeleton_of(body)
    rotations = np.array(turned)
    chest = _trunk(neutral, rotations, pelvis, phase, rule)
    _head(neutral, rotations, turned, chest, phase, rule)
    _arms(neutral, rotations, rule)
    rotations[:, 0] = pelvis
    way = _center(legs, seen, center[:, 0], rule, body)
    ankle, pitch, bend = _feet(legs, seen, step, rule, body)
    way[:, 1] -= _too_high(body, way, pelvis, ankle)
    _pose_legs(body, rotations, way, pelvis, ankle, pitch, bend, rule)
    way[:, 2] -= 2.0 * step * phase
    way[:, 2] -= way[:, 2].mean()
    way, rotations = _smooth(way), _smooth_turns(rotations)
    own = np.array([0.0, *legs.marks])
    contacts = np.stack([own, own + 0.5])
    events = _retimed(contacts.ravel(), off + rule.double, off).reshape(2, 4)
    return Cycle(
        skeleton=skeleton,
        center=way,
        rotations=sign_continuous(rotations),
        events=events % 1.0,
        stride_length=2.0 * step,
        duration=120.0 / (rule.cadence * pace.cadence),
        source=f"made by rule from neutral ({neutral.source})",
        license=neutral.license,
    )


def _smooth(values: Float[np.ndarray, "K *c"]) -> Float[np.ndarray, "K *c"]:
    """Periodic Gaussian over SOFT samples: a generated heel strike is harder than a living one."""
    frequency = np.arange(len(values) // 2 + 1) / len(values)
    keep = np.exp(-0.5 * (2.0 * np.pi * SOFT * frequency) ** 2)
    flat = values.reshape(len(values), -1)
    out = np.fft.irfft(np.fft.rfft(flat, axis=0) * keep[:, None], n=len(values), axis=0)
    return out.reshape(values.shape)


def _smooth_turns(rotations: Float[np.ndarray, "K J 4"]) -> Float[np.ndarray, "K J 4"]:
    mean = np.stack([mean_rotation(sign_continuous(q)) for q in rotations.transpose(1, 0, 2)])
    return multiply(mean, exp(_smooth(log(multiply(inverse(mean), rotations)))))


@cache
def _neutral() -> Cycle:
    """The upper body of the built-in gait ``neutral``."""
    cycle = with_head_that_follows(with_pelvis_tilt(neutral_cycle(), PELVIS_TILT))
    return with_easy_shoulders_and_hands(cycle)


@dataclass(frozen=True, eq=False)
class _Legs:
    """A steady walk seen from one foot: its own stride, from heel strike to heel strike.

    Forward is from N of the foot. ``center`` is the hips' middle over the foot's own stride.
    """

    phase: Float[np.ndarray, "T"]
    ankle: Float[np.ndarray, "T 2"]
    pitch: Float[np.ndarray, "T"]
    meta: Float[np.ndarray, "T"]
    bend: Float[np.ndarray, "T"]
    center: Float[np.ndarray, "T 2"]
    toe_off: float  # of the other foot, share of the stride
    marks: tuple[float, float, float]  # own foot flat, heel off, toe-off


@cache
def _legs(body: Body, step: float) -> _Legs:
    """Two steps of the built-in measured walk, joined."""
    walk = KinematicWalk([built_in("neutral_step")])
    seen = walk.step(body, StepRequest(0, step, step, step, 0.5))
    phase = np.concatenate([0.5 * seen.phase, 0.5 + 0.5 * seen.phase[1:]])

    def joined(stance: np.ndarray, swing: np.ndarray) -> np.ndarray:
        return np.concatenate([stance, swing[1:]])

    ahead = np.array([step, 0.0])
    return _Legs(
        phase=phase,
        ankle=joined(seen.ankle[:, 0], seen.ankle[:, 1] + ahead),
        pitch=joined(seen.pitch[:, 0], seen.pitch[:, 1]),
        meta=joined(seen.meta[:, 0], seen.meta[:, 1]),
        bend=joined(seen.bend[:, 0], seen.bend[:, 1]),
        center=joined(seen.center, seen.center + ahead),
        toe_off=0.5 * seen.toe_off,
        marks=(0.5 * seen.flat, 0.5 * seen.heel_off, 0.5 + 0.5 * seen.toe_off),
    )


def _retimed(phase: Float[np.ndarray, "n"], old: float, new: float) -> Float[np.ndarray, "n"]:
    """Phases of a walk whose toe-offs follow heel strikes by ``old``, for one where by ``new``."""
    own, other = (np.array([0.0, off, 0.5, 0.5 + off]) for off in (new, old))
    grid = np.concatenate([own - 1.0, own, own + 1.0, own + 2.0])
    values = np.concatenate([other - 1.0, other, other + 1.0, other + 2.0])
    return pchip(grid, values[:, None], phase)[:, 0]


def _to_measured(
    phase: Float[np.ndarray, "n"], off: float, neutral: Cycle
) -> Float[np.ndarray, "n"]:
    """Phases of the measured stride: its toe-offs are elsewhere."""
    return _retimed(phase, float(neutral.events[1, 3]), off)


def _read(
    legs: _Legs, values: Float[np.ndarray, "T *c"], own: Float[np.ndarray, "n"]
) -> Float[np.ndarray, "n *c"]:
    return pchip(legs.phase, values, own)


def _center(
    legs: _Legs,
    seen: Float[np.ndarray, "K"],
    sideways: Float[np.ndarray, "K"],
    rule: Rule,
    body: Body,
) -> Float[np.ndarray, "K 3"]:
    """Hips' middle, the travel included, meters."""
    path = _read(legs, legs.center, seen)
    up = path[:, 1]
    up = up.mean() + rule.bounce * (up - up.mean()) - rule.crouch * body.leg_length
    side = rule.sway * (sideways - sideways.mean())
    return np.stack([side, up, path[:, 0]], axis=-1)


def _feet(
    legs: _Legs, seen: Float[np.ndarray, "K"], step: float, rule: Rule, body: Body
) -> tuple[Float[np.ndarray, "K 2 3"], Float[np.ndarray, "K 2"], Float[np.ndarray, "K 2"]]:
    """Ankles (the travel included), soles' pitch and bend of the toes of [left, right]."""
    flat, _heel_off, toe_off = legs.marks
    ankles, pitches, bends = [], [], []
    half = 0.5 * (WIDTH + rule.width) * body.leg_length
    for side, sign in enumerate(SIDE_SIGN):
        whole = np.floor(seen - 0.5 * side)
        own = seen - 0.5 * side - whole
        down = own <= toe_off
        u = (own - toe_off) / (1.0 - toe_off)
        leave, land = 1.0 - smoothstep(u / 0.6), smoothstep((u - 0.4) / 0.6)
        at_off = float(_read(legs, legs.pitch, np.array([toe_off]))[0])
        pitch, meta = _read(legs, legs.pitch, own), _read(legs, legs.meta, own)
        ankle, bend = _read(legs, legs.ankle, own), _read(legs, legs.bend, own)
        strike = np.radians(rule.strike)
        landing = strike * (1.0 - smoothstep(own / flat))
        rising = np.where(pitch < 0.0, (rule.off - 1.0) * pitch, 0.0)
        new = pitch + np.where(down, np.where(own < flat, landing, rising), strike * land)
        new += np.where(down, 0.0, (rule.off - 1.0) * at_off * leave)
        stands = rolled_ankle(body.foot, new, rule.off * meta)
        old = rolled_ankle(body.foot, pitch, meta)
        # the swing leaves from and comes to where the changed foot is
        gone = _moved(legs, body, toe_off, rule.off, 0.0)
        come = _moved(legs, body, 0.0, 1.0, strike)
        swing = ankle + leave[:, None] * gone + land[:, None] * come
        bump = np.where(down, 0.0, np.sin(np.pi * np.clip(u, 0.0, 1.0)) ** 2)
        swing[:, 1] += bump * rule.lift * body.leg_length
        place = np.where(down[:, None], ankle + stands - old, swing)
        out = sign * (half + bump * rule.circumduction * body.leg_length)
        ahead = place[:, 0] + step * side + 2.0 * step * whole
        ankles.append(np.stack([out, place[:, 1], ahead], axis=-1))
        pitches.append(new)
        bends.append(np.where(down & (new < 0.0), -new - rule.off * meta, rule.off * bend))
    return np.stack(ankles, 1), np.stack(pitches, 1), np.stack(bends, 1)


def _moved(
    legs: _Legs, body: Body, own: float, off: float, strike: float
) -> Float[np.ndarray, "1 2"]:
    """How far a change of sole angles moves the ankle of a foot that bears."""
    at = np.array([own])
    pitch, meta = _read(legs, legs.pitch, at), _read(legs, legs.meta, at)
    new = off * pitch if strike == 0.0 else pitch + strike
    return rolled_ankle(body.foot, new, off * meta) - rolled_ankle(body.foot, pitch, meta)


def _too_high(
    body: Body,
    way: Float[np.ndarray, "K 3"],
    pelvis: Float[np.ndarray, "K 4"],
    ankle: Float[np.ndarray, "K 2 3"],
) -> Float[np.ndarray, "K"]:
    """How far the hips must come down so that both legs reach, smooth, meters."""
    reach = REACH * body.leg_length
    over = np.zeros(len(way))
    for side, sign in enumerate(SIDE_SIGN):
        hip = way + rotate(pelvis, np.array([sign * 0.5 * body.hip_width, 0.0, 0.0]))
        line = ankle[:, side] - hip
        level = (line[:, [0, 2]] ** 2).sum(-1)
        over = np.maximum(over, -line[:, 1] - np.sqrt(np.maximum(reach**2 - level, 0.0)))
    if not over.any():
        return over
    tiled = np.tile(over, 3)
    half = SAMPLES // 14
    smooth = hann_average(running_maximum(tiled, half), half)
    return smooth[len(over) : 2 * len(over)]


def _pose_legs(
    body: Body,
    rotations: Float[np.ndarray, "K J 4"],
    way: Float[np.ndarray, "K 3"],
    pelvis: Float[np.ndarray, "K 4"],
    ankle: Float[np.ndarray, "K 2 3"],
    pitch: Float[np.ndarray, "K 2"],
    bend: Float[np.ndarray, "K 2"],
    rule: Rule,
) -> None:
    skeleton = skeleton_of(body)
    for side, (name, sign) in enumerate(zip(SIDES, SIDE_SIGN, strict=True)):
        hip = way + rotate(pelvis, np.array([sign * 0.5 * body.hip_width, 0.0, 0.0]))
        out = sign * np.radians(TOE_OUT + rule.toe_out)
        heading = multiply(about("y", out), about("x", -pitch[:, side]))
        knees = about("y", 0.5 * out + sign * np.radians(rule.knees_out))
        forward = np.broadcast_to(rotate(knees, np.array([0.0, 0.0, 1.0])), hip.shape)
        leg = two_bone_ik(hip, ankle[:, side], forward, thigh=body.thigh, shin=body.shin)
        world = [pelvis, leg.thigh, leg.shin, heading]
        for i, bone in enumerate(("UpperLeg", "LowerLeg", "Foot")):
            joint = skeleton.index(f"{name}{bone}")
            rotations[:, joint] = multiply(inverse(world[i]), world[i + 1])
        rotations[:, skeleton.index(f"{name}Toes")] = about("x", -bend[:, side])


def _pelvis(
    neutral: Cycle, turned: Float[np.ndarray, "K 4"], rule: Rule
) -> Float[np.ndarray, "K 4"]:
    mean = mean_rotation(neutral.rotations[:, 0])
    away = log(multiply(inverse(mean), turned)) * np.array([1.0, rule.turn, rule.drop])
    return multiply(multiply(about("x", np.radians(rule.tilt)), mean), exp(away))


def _trunk(
    neutral: Cycle,
    rotations: Float[np.ndarray, "K J 4"],
    pelvis: Float[np.ndarray, "K 4"],
    phase: Float[np.ndarray, "K"],
    rule: Rule,
) -> Float[np.ndarray, "K 4"]:
    """Poses the spine; the chest in space."""
    names, index = trunk_names(neutral), neutral.skeleton.index
    chest, whole = rotations[:, 0], neutral.rotations[:, 0]
    for name in names:
        chest = multiply(chest, rotations[:, index(name)])
        whole = multiply(whole, neutral.rotations[:, index(name)])
    mean = mean_rotation(whole)
    away = log(multiply(inverse(mean), chest)) * np.array([1.0, rule.twist, 1.0])
    sway = about("z", -np.radians(rule.roll) * np.sin(2.0 * np.pi * phase))
    bent = about("x", np.radians(rule.lean + rule.slump))
    wanted = multiply(sway, multiply(bent, multiply(mean, exp(away))))
    # the upper back takes the slump, all joints alike the rest
    slump = about("x", np.radians(rule.slump))
    rest = multiply(inverse(pelvis), wanted)
    rest = multiply(rest, about("x", -np.radians(rule.slump)))
    share = exp(log(rest) / len(names))
    for name in names:
        rotations[:, index(name)] = share
    rotations[:, index(names[-1])] = multiply(share, slump)
    return wanted


def _head(
    neutral: Cycle,
    rotations: Float[np.ndarray, "K J 4"],
    before: Float[np.ndarray, "K J 4"],
    chest: Float[np.ndarray, "K 4"],
    phase: Float[np.ndarray, "K"],
    rule: Rule,
) -> None:
    """Poses neck and head, which move in space as the neutral ones, upon any trunk."""
    mean = mean_rotation(_head_in_space(neutral, neutral.rotations))
    away = rule.nod * log(multiply(inverse(mean), _head_in_space(neutral, before)))
    tip = about("z", -np.radians(rule.tip) * np.sin(2.0 * np.pi * phase))
    wanted = multiply(tip, multiply(about("x", np.radians(rule.head)), multiply(mean, exp(away))))
    share = exp(0.5 * log(multiply(inverse(chest), wanted)))
    for name in ("neck", "head"):
        rotations[:, neutral.skeleton.index(name)] = share


def _head_in_space(
    neutral: Cycle, rotations: Float[np.ndarray, "K J 4"]
) -> Float[np.ndarray, "K 4"]:
    out = rotations[:, 0]
    for name in (*trunk_names(neutral), "neck", "head"):
        out = multiply(out, rotations[:, neutral.skeleton.index(name)])
    return out


def _arms(neutral: Cycle, rotations: Float[np.ndarray, "K J 4"], rule: Rule) -> None:
    index = neutral.skeleton.index
    for name, sign in zip(SIDES, SIDE_SIGN, strict=True):
        for bone, size in (("UpperArm", rule.swing), ("LowerArm", rule.elbow_swing)):
            joint = index(f"{name}{bone}")
            mean = mean_rotation(neutral.rotations[:, joint])
            away = log(multiply(inverse(mean), rotations[:, joint]))
            rotations[:, joint] = multiply(mean, exp(size * away))
        shoulder, upper, lower = (index(f"{name}{b}") for b in ("Shoulder", "UpperArm", "LowerArm"))
        raised = about("z", sign * np.radians(rule.shrug))
        drawn = about("y", -sign * np.radians(rule.hunch))
        moved = multiply(drawn, raised)
        rotations[:, shoulder] = multiply(moved, rotations[:, shoulder])
        # arms hang as they did from the moved shoulder, and plumb when the trunk leans
        hang = multiply(inverse(moved), about("z", sign * np.radians(rule.arms_out)))
        forward = rule.arms_forward + rule.lean + rule.slump
        hang = multiply(hang, about("x", -np.radians(forward)))
        rolled = about("x", np.radians(rule.roll_in))
        rotations[:, upper] = multiply(multiply(hang, rotations[:, upper]), rolled)
        bent = about("y", -sign * np.radians(rule.elbow))
        rotations[:, lower] = multiply(bent, rotations[:, lower])
