"""The person in a clip: a body of the rig's lengths, and the same motion on our skeleton."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.body.body import Body, Foot
from gaitsmith.body.proportions import FOOT_SHARES, SHORTEST, TALLEST, body_from_height
from gaitsmith.body.rig import skeleton_of
from gaitsmith.conventions import SIDES, UP
from gaitsmith.errors import InfeasibleError, InvalidInputError
from gaitsmith.gait.rig_frames import Rig, bone_frames, still_frames
from gaitsmith.geometry.rotations import IDENTITY, inverse, multiply, rotate, sign_continuous
from gaitsmith.motion.motion import Motion
from gaitsmith.motion.roles import humanoid_roles

if TYPE_CHECKING:
    from jaxtyping import Float

#: Leg length (hip to ankle) over stature of an adult.
_LEG = 0.491
#: Range of ankle heights over leg length in which the clip's own floor is believed.
_ANKLES = (0.055, 0.16)
_USUAL_ANKLE = 0.0795


@dataclass(frozen=True, eq=False)
class Person:
    """Who walks in a clip.

    Attributes
    ----------
    body
        Lengths of the rig, both sides' mean; what a rig does not tell is taken from a body
        with such legs.
    motion
        The clip on ``skeleton_of(body)``: VRM humanoid joints, identity at rest in a T-pose,
        the soles on y = 0 while they stand flat.
    roles
        The humanoid bones that the rig has; others do not move.
    """

    body: Body
    motion: Motion
    roles: tuple[str, ...]


def person_of(clip: Motion, *, name: str = "clip") -> Person:
    """The person in ``clip``, whatever the rig.

    Raises
    ------
    InfeasibleError
        If the rig has no hips and legs, or is no person's size.
    """
    roles = humanoid_roles(clip.skeleton.names, clip.skeleton.parents).joints
    if len(clip) < 2:
        raise InfeasibleError(f"the clip has {len(clip)} frames; a person in motion needs two")
    rig = Rig(clip, roles)
    height = rig.scale / _LEG
    if not SHORTEST <= height <= TALLEST:
        raise InfeasibleError(
            f"legs of {rig.scale:.3f} m (hip to ankle) are no person's; give the file's unit "
            "(--unit, unit=)"
        )
    frames = bone_frames(rig)
    try:
        body, floor = _body_of(rig, frames, height, name)
    except InvalidInputError as error:
        raise InfeasibleError(f"the rig in the clip is no person's: {error}") from None
    return Person(body, _moved(rig, frames, body, floor), tuple(rig.joints))


def _length(rig: Rig, first: str, second: str) -> float:
    return float(np.linalg.norm(rig.at(second) - rig.at(first), axis=-1).mean())


def _both(rig: Rig, first: str, second: str, usual: float) -> float:
    """Mean length of a bone of both sides, or what is usual."""
    there = [s for s in SIDES if f"{s}{first}" in rig.joints and f"{s}{second}" in rig.joints]
    if not there:
        return usual
    return float(np.mean([_length(rig, f"{s}{first}", f"{s}{second}") for s in there]))


def _body_of(
    rig: Rig, frames: dict[str, Float[np.ndarray, "4"]], height: float, name: str
) -> tuple[Body, float]:
    """The body, and the height of the floor under its standing feet in the clip."""
    usual = body_from_height(height)
    thigh = _both(rig, "UpperLeg", "LowerLeg", usual.thigh)
    shin = _both(rig, "LowerLeg", "Foot", usual.shin)
    foot, floor = _foot_of(rig, frames, usual)
    lengths: dict[str, float] = {
        "thigh": thigh,
        "shin": shin,
        "hip_width": _length(rig, "leftUpperLeg", "rightUpperLeg"),
        "upper_arm": _both(rig, "UpperArm", "LowerArm", usual.upper_arm),
        "forearm": _both(rig, "LowerArm", "Hand", usual.forearm),
    }
    lengths |= _trunk_of(rig, usual)
    parts = ("thigh", "shin", "trunk", "neck", "head")
    all_lengths: dict[str, float] = {k: getattr(usual, k) for k in parts} | lengths
    stacked = foot.ankle_height + sum(all_lengths[k] for k in parts)
    return replace(usual, name=name, height=stacked, foot=foot, **lengths), floor


def _trunk_of(rig: Rig, usual: Body) -> dict[str, float]:
    """Trunk, neck, head and shoulders, each only where it is like a person's."""
    middle = 0.5 * (rig.at("leftUpperLeg") + rig.at("rightUpperLeg"))
    out: dict[str, float] = {}
    if {"leftUpperArm", "rightUpperArm"} <= rig.joints.keys():
        out["shoulder_width"] = _length(rig, "leftUpperArm", "rightUpperArm")
        shoulders = 0.5 * (rig.at("leftUpperArm") + rig.at("rightUpperArm"))
        tall = float(np.linalg.norm(shoulders - middle, axis=-1).mean())
        out["trunk"] = tall + usual.shoulder_drop
    if "head" in rig.joints:
        head = float(np.linalg.norm(rig.at("head") - middle, axis=-1).mean())
        trunk = out.setdefault("trunk", head - usual.neck)
        out["neck"] = head - trunk
    good = {
        "trunk": (0.7, 1.4),
        "neck": (0.4, 2.0),
        "shoulder_width": (0.6, 1.6),
    }
    return {
        key: value
        for key, value in out.items()
        if good[key][0] * getattr(usual, key) <= value <= good[key][1] * getattr(usual, key)
    }


def _foot_of(
    rig: Rig, frames: dict[str, Float[np.ndarray, "4"]], usual: Body
) -> tuple[Foot, float]:
    """The foot triangle from feet that stand still, and the floor they stand on.

    The toes tell the floor, the sole's frame how high the ankle is above them when it is level:
    some people never set their heels down.
    """
    leg = rig.scale
    ankles, reaches, tips = list[float](), list[float](), list[float]()
    for side in SIDES:
        still = still_frames(rig, side)
        ankle = rig.at(f"{side}Foot")[still]
        low = float(np.median(ankle[:, 1]))
        if f"{side}Toes" in rig.joints:
            toes = rig.at(f"{side}Toes")
            sole = multiply(rig.turn(f"{side}Foot"), frames[f"{side}Foot"])
            reach = rotate(inverse(sole), toes - rig.at(f"{side}Foot")).mean(0)
            reaches.append(float(np.hypot(reach[0], reach[2])))
            low = float(np.median(toes[still, 1]) - reach[1])
            ends = rig.motion.skeleton.ends
            if ends is not None:
                tips.append(float(np.linalg.norm(ends[rig.joints[f"{side}Toes"]])))
        ankles.append(low)
    height = float(np.mean(ankles))
    floor = 0.0
    if not _ANKLES[0] * leg <= height <= _ANKLES[1] * leg:
        floor, height = height - _USUAL_ANKLE * leg, _USUAL_ANKLE * leg
    heel, ball, tips_share = FOOT_SHARES
    front = float(np.mean(reaches)) if reaches else usual.foot.ball
    front = min(max(front, 0.6 * usual.foot.ball), 1.5 * usual.foot.ball)
    tip = float(np.mean(tips)) if tips else 0.0
    if not 0.3 * front <= tip <= front:
        tip = front * tips_share / ball
    return Foot(height, heel / (ball + tips_share) * (front + tip), front, tip), floor


def _moved(rig: Rig, frames: dict[str, Float[np.ndarray, "4"]], body: Body, floor: float) -> Motion:
    """The clip's pose on the body's skeleton, joint by joint from the hips outward."""
    skeleton = skeleton_of(body)
    count = len(rig.motion)
    rotations = np.tile(IDENTITY, (count, len(skeleton), 1))
    world: dict[str, Float[np.ndarray, "F 4"]] = {}
    for joint, name in enumerate(skeleton.names):
        parent = skeleton.parents[joint]
        above = None if parent < 0 else world[skeleton.names[parent]]
        if name in frames:
            here = multiply(rig.turn(name), frames[name])
            rotations[:, joint] = here if above is None else multiply(inverse(above), here)
            world[name] = here
        else:
            assert above is not None  # hips are always there
            world[name] = above
    middle = 0.5 * (rig.at("leftUpperLeg") + rig.at("rightUpperLeg"))
    return Motion(
        skeleton=skeleton,
        root_position=middle - floor * UP,
        rotations=sign_continuous(rotations / np.linalg.norm(rotations, axis=-1, keepdims=True)),
        fps=rig.motion.fps,
    )
