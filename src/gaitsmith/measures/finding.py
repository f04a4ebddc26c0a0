"""The person in any motion: soles, floor, contacts and footsteps known or found."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.body.rig import soles_of
from gaitsmith.conventions import BALL, HEEL, SIDES, TOE
from gaitsmith.errors import InfeasibleError, InvalidInputError
from gaitsmith.gait.events import FootPath, stances
from gaitsmith.gait.learn import body_in, over_ground, walking_speed
from gaitsmith.gait.person import person_of
from gaitsmith.ground import Flat, ground_from_json
from gaitsmith.measures.contacts import heights
from gaitsmith.measures.figure import Figure
from gaitsmith.measures.footsteps import (
    Footsteps,
    contacts_of_stances,
    footsteps_of_labels,
    footsteps_of_stances,
    parted,
)
from gaitsmith.motion.kinematics import motion_kinematics, sole_positions
from gaitsmith.motion.roles import humanoid_roles

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

    from gaitsmith.gait.events import Stance
    from gaitsmith.ground import Ground
    from gaitsmith.motion.motion import Labels, Motion

#: m/s: with what a foot's speed is compared where nobody walks, and below which nobody does.
_STANDING, SLOWEST_WALK = 0.3, 0.1


def figure_of(motion: Motion, notes: list[str]) -> Figure:
    """The figure in ``motion``; what had to be guessed goes to ``notes``.

    Raises
    ------
    InfeasibleError
        If the joints are no person's, or it has fewer than two frames.
    """
    joints = humanoid_roles(motion.skeleton.names, motion.skeleton.parents).joints
    if len(motion) < 2:
        raise InfeasibleError(f"{len(motion)} frames; a motion to be measured needs two")
    own = motion.skeleton.soles is not None and {f"{s}Foot" for s in SIDES} <= set(
        motion.skeleton.names
    )
    if own and motion.contacts is not None and motion.labels is not None:
        return _labelled(motion, joints, notes)
    height = None
    if own:
        positions, world = motion_kinematics(motion)
        soles = sole_positions(motion.skeleton, positions, world)
        height = _standing_height(motion, joints)
    else:
        motion, soles, height = _with_soles(motion, joints, notes)
        positions, world = motion_kinematics(motion)
    ankles = np.stack([positions[:, joints[f"{name}Foot"]] for name in SIDES], axis=1)
    found = _stances(motion, joints, positions, ankles, soles)
    down = contacts_of_stances(found, soles, motion.fps)
    footsteps = footsteps_of_stances(found, soles, ankles, down, motion.fps)
    bearing = np.zeros((len(motion), 2), dtype=bool)
    for stance in found:
        first, last = (round(t * motion.fps) for t in (stance.heel_strike, stance.toe_off))
        bearing[first : last + 1, stance.side] = True
    exact = motion.contacts is not None and own
    if exact:
        assert motion.contacts is not None
        down, bearing = motion.contacts, np.any(motion.contacts, axis=-1)
    return Figure(
        motion=motion,
        joints=joints,
        positions=positions,
        world=world,
        soles=soles,
        down=down,
        exact=exact,
        bearing=bearing,
        footsteps=footsteps,
        ground=Flat(_floor(soles, down, footsteps)),
        height=height,
        labels=None,
    )


def _labelled(motion: Motion, joints: dict[str, int], notes: list[str]) -> Figure:
    """A generated motion: everything is known."""
    labels, contacts = motion.labels, motion.contacts
    assert labels is not None
    assert contacts is not None
    positions, world = motion_kinematics(motion)
    ground = _ground_of(labels, notes)
    return Figure(
        motion=motion,
        joints=joints,
        positions=positions,
        world=world,
        soles=sole_positions(motion.skeleton, positions, world),
        down=contacts,
        exact=True,
        bearing=np.any(contacts, axis=-1),
        footsteps=footsteps_of_labels(labels, contacts, motion.fps),
        ground=ground,
        height=_standing_height(motion, joints),
        labels=None if ground is None else labels,
    )


def _ground_of(labels: Labels, notes: list[str]) -> Ground | None:
    """The ground that the labels name, if it is known here."""
    try:
        return ground_from_json(labels.ground)
    except InvalidInputError as error:
        notes.append(f"the ground cannot be measured against: {error}")
        return None


def _standing_height(motion: Motion, joints: dict[str, int]) -> float | None:
    """From the soles to the crown at rest."""
    skeleton = motion.skeleton
    if skeleton.soles is None or skeleton.ends is None or "head" not in joints:
        return None
    rest, head = skeleton.rest_positions(), joints["head"]
    feet = rest[[j for side in skeleton.sole_joints for j in side], 1].reshape(2, 3)
    low = float((feet + skeleton.soles[..., 1]).min())
    return float(rest[head, 1] + skeleton.ends[head, 1]) - low


def _with_soles(
    clip: Motion, joints: dict[str, int], notes: list[str]
) -> tuple[Motion, Float[np.ndarray, "F 2 3 3"], float]:
    """``clip`` over ground, the soles of its person on its own ankles, the person's height."""
    person = person_of(clip)
    body = body_in(person)
    motion = person.motion.with_(
        skeleton=replace(person.motion.skeleton, soles=soles_of(body.foot))
    )
    carried = over_ground(motion, notes)
    clip = clip.with_(
        root_position=clip.root_position + (carried.root_position - motion.root_position)
    )
    here, turned = motion_kinematics(motion)
    soles = sole_positions(motion.skeleton, here, turned)
    positions, _ = motion_kinematics(clip)
    for side, name in enumerate(SIDES):  # a rig's legs may differ, a body's do not
        ankle = positions[:, joints[f"{name}Foot"]]
        soles[:, side] += (ankle - here[:, motion.skeleton.index(f"{name}Foot")])[:, None]
    missing = [f"{name}Toes" for name in SIDES if f"{name}Toes" not in joints]
    if missing:
        notes.append(
            f"no joint is recognized as {', '.join(missing)}: the ball of the foot is measured as "
            "the toe joint"
        )
    return clip, soles, body.height


def _stances(
    motion: Motion,
    joints: dict[str, int],
    positions: Float[np.ndarray, "F J 3"],
    ankles: Float[np.ndarray, "F 2 3"],
    soles: Float[np.ndarray, "F 2 3 3"],
) -> list[Stance]:
    feet = {
        side: FootPath(
            ankles[:, side],
            soles[:, side, HEEL],
            soles[:, side, BALL],
            soles[:, side, TOE] if f"{name}Toes" in joints else None,
        )
        for side, name in enumerate(SIDES)
    }
    hip, knee = (
        np.stack([positions[:, joints[f"{name}{part}"]] for name in SIDES], axis=1)
        for part in ("UpperLeg", "LowerLeg")
    )
    bones = np.linalg.norm([knee - hip, ankles - knee], axis=-1)
    leg = float(bones.sum(0).mean())
    speed = walking_speed(motion.with_(root_position=hip.mean(1)))
    if speed < SLOWEST_WALK:
        speed = _STANDING
    return parted(stances(feet, motion.fps, speed=speed, leg_length=leg), soles, motion.fps)


def _floor(
    soles: Float[np.ndarray, "F 2 3 3"], down: Bool[np.ndarray, "F 2 3"], feet: Footsteps
) -> float:
    """Height of the floor: where the feet stand on the median, else the lowest sole point."""
    if len(feet):
        return float(np.median(feet.height))
    if down.any():
        return float(np.median(heights(soles[..., 1], down, exact=False)))
    return float(soles[..., 1].min())
