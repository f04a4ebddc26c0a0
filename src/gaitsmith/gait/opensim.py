"""Joint angles of the Rajagopal 2016 model as rotations of a humanoid.

OpenSim's axes are x forward, y up, z right; ours X left, Y up, Z forward. All Euler sequences
are body-fixed in the order written. Angles are radians.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import SIDE_SIGN
from gaitsmith.geometry.rotations import (
    about,
    exp,
    from_matrix,
    inverse,
    log,
    multiply,
    rotate,
)

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jaxtyping import Float

    Columns = Mapping[str, Float[np.ndarray, "n"]]

#: OpenSim's axes to ours, ``ours = C @ opensim``.
_C = from_matrix(np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]))
#: The model's trunk leans forward at rest because its lumbar joint sits behind the hips.
UPRIGHT = float(np.radians(5.5))
#: Below this elbow flexion the plane of the arm is lost.
_STRAIGHT_ELBOW = float(np.radians(2.0))


def _turn(*steps: tuple[str, Float[np.ndarray, "n"] | float]) -> Float[np.ndarray, "n 4"]:
    """Body-fixed turns about OpenSim axes, first one leftmost."""
    out = about(*steps[0])
    for axis, angle in steps[1:]:
        out = multiply(out, about(axis, angle))
    return out


def _about_axis(
    axis: Float[np.ndarray, "3"], angle: Float[np.ndarray, "n"]
) -> Float[np.ndarray, "n 4"]:
    return exp(np.asarray(angle)[..., None] * axis)


def _ours(q: Float[np.ndarray, "n 4"]) -> Float[np.ndarray, "n 4"]:
    return multiply(multiply(_C, q), inverse(_C))


def humanoid_rotations(angles: Columns) -> dict[str, Float[np.ndarray, "n 4"]]:
    """Local rotations by VRM joint name from the model's coordinates.

    Reads pelvis_tilt, list, rotation; hip_flexion, adduction, rotation, knee_angle,
    ankle_angle, arm_flex, arm_add, arm_rot, elbow_flex of both sides (``_l``, ``_r``);
    lumbar_extension, bending, rotation. Trunk rotation is shared by spine, chest, upperChest;
    neck, head, hands and toes are not in the data.

    Notes
    -----
    Arms: at rest ours stretch along +-X, the model's hang; so each bone is turned to the
    direction of the model's bone, the elbow's hinge about local Y, which leaves no twist in
    the forearm.
    """
    pelvis = _turn(
        ("z", angles["pelvis_tilt"]), ("x", angles["pelvis_list"]), ("y", angles["pelvis_rotation"])
    )
    torso = multiply(
        pelvis,
        _turn(
            ("z", angles["lumbar_extension"]),
            ("x", angles["lumbar_bending"]),
            ("y", angles["lumbar_rotation"]),
        ),
    )
    hips = _ours(pelvis)
    torso = multiply(torso, about("z", UPRIGHT))
    upright = _ours(torso)
    third = exp(log(multiply(inverse(hips), upright)) / 3.0)
    out = {"hips": hips, "spine": third, "chest": third, "upperChest": third}
    for name, letter, sign in (("left", "l", -1.0), ("right", "r", 1.0)):
        out |= _leg(angles, pelvis, hips, name, letter, sign)
        out |= _arm(angles, torso, upright, name, letter, sign)
    return out


def _leg(
    angles: Columns,
    pelvis: Float[np.ndarray, "n 4"],
    hips: Float[np.ndarray, "n 4"],
    name: str,
    letter: str,
    m: float,
) -> dict[str, Float[np.ndarray, "n 4"]]:
    femur = multiply(
        pelvis,
        _turn(
            ("z", angles[f"hip_flexion_{letter}"]),
            ("x", m * angles[f"hip_adduction_{letter}"]),
            ("y", m * angles[f"hip_rotation_{letter}"]),
        ),
    )
    k = angles[f"knee_angle_{letter}"]
    screw_z = 0.0108320945 * k**4 - 0.0252183255 * k**3 - 0.0328478104 * k**2 + 0.079100012 * k
    screw_y = 0.0251657627 * k**3 - 0.1694800514 * k**2 + 0.3694993487 * k
    frame = _turn(("x", -1.64157 * m), ("y", 1.44618 * m), ("z", 1.5708))
    bend = _turn(("x", m * k), ("z", screw_z), ("y", m * screw_y))
    tibia = multiply(femur, multiply(multiply(frame, bend), inverse(frame)))
    axis = rotate(
        _turn(("x", 0.175895 * m), ("y", -0.105208 * m), ("z", 0.0186622)),
        np.array([0.0, 0.0, 1.0]),
    )
    foot = multiply(tibia, _about_axis(axis, angles[f"ankle_angle_{letter}"]))
    thigh, shin, sole = _ours(femur), _ours(tibia), _ours(foot)
    return {
        f"{name}UpperLeg": multiply(inverse(hips), thigh),
        f"{name}LowerLeg": multiply(inverse(thigh), shin),
        f"{name}Foot": multiply(inverse(shin), sole),
    }


def _arm(
    angles: Columns,
    torso: Float[np.ndarray, "n 4"],
    upright: Float[np.ndarray, "n 4"],
    name: str,
    letter: str,
    m: float,
) -> dict[str, Float[np.ndarray, "n 4"]]:
    humerus = multiply(
        torso,
        _turn(
            ("z", angles[f"arm_flex_{letter}"]),
            ("x", m * angles[f"arm_add_{letter}"]),
            ("y", m * angles[f"arm_rot_{letter}"]),
        ),
    )
    axis = rotate(
        _turn(("x", -0.0228627 * m), ("y", 0.228018 * m), ("z", 0.0051689)),
        np.array([0.0, 0.0, 1.0]),
    )
    elbow = np.maximum(angles[f"elbow_flex_{letter}"], _STRAIGHT_ELBOW)
    down = np.array([0.0, -1.0, 0.0])
    upper = rotate(_ours(humerus), down)
    fore = rotate(_ours(multiply(humerus, _about_axis(axis, elbow))), down)
    side = float(SIDE_SIGN[0 if name == "left" else 1])
    upper_world = _frame(side, upper, fore)
    fore_world = _frame(side, fore, -upper)
    return {
        f"{name}UpperArm": multiply(inverse(upright), upper_world),
        f"{name}LowerArm": multiply(inverse(upper_world), fore_world),
    }


def _frame(
    side: float, primary: Float[np.ndarray, "n 3"], secondary: Float[np.ndarray, "n 3"]
) -> Float[np.ndarray, "n 4"]:
    """Rotation that takes (side, 0, 0) to ``primary`` and +Z towards ``secondary``."""
    x = side * primary
    z = secondary - (secondary * primary).sum(-1, keepdims=True) * primary
    z /= np.linalg.norm(z, axis=-1, keepdims=True)
    return from_matrix(np.stack([x, np.cross(z, x), z], axis=-1))
