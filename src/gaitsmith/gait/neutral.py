"""The built-in whole-body stride `neutral`: a measured one, mended where it is not neutral.

The stride is that of the Rajagopal 2016 walk (one man, 1.26 m/s), stored as Fourier
coefficients of the model's coordinates in ``data/neutral.json``. What its measurement lacks
(head, hands, toes) and what makes it unlike a neutral walk (arms held as if they carried a
tray) is added here by rule; ``docs/gaits/neutral.md`` has the reasons and sources.
"""

from __future__ import annotations

import json
from dataclasses import replace
from importlib.resources import files
from typing import TYPE_CHECKING, Any

import numpy as np

from gaitsmith.body.body import Body, Foot
from gaitsmith.body.proportions import body_from_height
from gaitsmith.body.rig import skeleton_of
from gaitsmith.gait.cycle import Cycle
from gaitsmith.gait.opensim import humanoid_rotations
from gaitsmith.geometry.rotations import IDENTITY, about, inverse, multiply, rotate, slerp

if TYPE_CHECKING:
    from jaxtyping import Float

SAMPLES = 128
#: Hip joints' middle in the model's pelvis frame (x forward, y up, z right), meters.
_HIP_MIDDLE = (-0.070, -0.0786, 0.0)
#: Toe extension every 1/16 of the foot's own stride, degrees: heel, ball and toe markers.
_TOES = (10.0, 9.0, 7.0, 1.0, 1.0, -1.0, -1.0, 0.0, 2.0, 16.0, 21.0, 1.0, -3.0, 1.0, 4.0, 7.0)
#: Distance of the point ahead that the gaze stays on, meters.
_GAZE = 1.0


def subject() -> Body:
    """The man who was measured, as far as the data tell; the rest by his stature."""
    return replace(
        body_from_height(1.80, name="Rajagopal 2016"),
        thigh=0.391,
        shin=0.454,
        hip_width=0.185,
        foot=Foot(ankle_height=0.080, heel=0.065, ball=0.128, toes=0.080),
        mass=84.9,
    )


def neutral_cycle(*, symmetric: bool = True, relaxed: bool = True) -> Cycle:
    """The stride as a Cycle of the measured man.

    Parameters
    ----------
    symmetric
        Left and right made mirror images of each other; False keeps the man's own asymmetry.
    relaxed
        Arms and knees mended; False leaves them as measured.
    """
    data = json.loads(files("gaitsmith.data").joinpath("neutral.json").read_text("utf-8"))
    phase = np.arange(SAMPLES) / SAMPLES
    angles = _columns(data["symmetric" if symmetric else "raw"], phase)
    if relaxed:
        angles = _relaxed(angles)
    body = subject()
    skeleton = skeleton_of(body)
    turned = humanoid_rotations(angles)
    center = np.stack([-angles["pelvis_tz"], angles["pelvis_ty"], angles["pelvis_tx"]], axis=-1)
    x, y, z = _HIP_MIDDLE
    center = center + rotate(turned["hips"], np.array([-z, y, x]))
    turned |= _head(turned, center[:, 1])
    events = np.array([data["events"]["left"], data["events"]["right"]])
    turned |= {
        f"{name}Toes": _toes((phase - events[side, 0]) % 1.0, events[side])
        for side, name in enumerate(("left", "right"))
    }
    rotations = np.tile(IDENTITY, (SAMPLES, len(skeleton), 1))
    for name, q in turned.items():
        rotations[:, skeleton.index(name)] = q
    return Cycle(
        skeleton=skeleton,
        center=center,
        rotations=rotations,
        events=events,
        stride_length=data["stride_length"],
        duration=data["duration"],
        source=data["source"],
        license=data["license"],
    )


def _columns(
    coefficients: dict[str, Any], phase: Float[np.ndarray, "n"]
) -> dict[str, Float[np.ndarray, "n"]]:
    turns = 2.0 * np.pi * phase[:, None] * np.arange(9)
    cosine, sine = np.cos(turns), np.sin(turns)
    return {
        name: cosine @ np.array(c) + sine @ np.array(s) for name, (c, s) in coefficients.items()
    }


def _relaxed(
    angles: dict[str, Float[np.ndarray, "n"]],
) -> dict[str, Float[np.ndarray, "n"]]:
    """More arm swing, straighter elbows, less roll of the arm; knees never locked."""
    out, deg = dict(angles), np.pi / 180.0
    for side in "lr":
        flex, roll = angles[f"arm_flex_{side}"], angles[f"arm_rot_{side}"]
        out[f"arm_flex_{side}"] = flex.mean() + 1.4 * (flex - flex.mean()) - 10.0 * deg
        out[f"arm_rot_{side}"] = roll.mean() + 0.5 * (roll - roll.mean())
        out[f"elbow_flex_{side}"] = angles[f"elbow_flex_{side}"] - 15.0 * deg
        knee = 0.95 * angles[f"knee_angle_{side}"] / deg
        out[f"knee_angle_{side}"] = (3.0 + np.logaddexp(0.0, knee - 3.0)) * deg
    return out


def _head(
    turned: dict[str, Float[np.ndarray, "n 4"]], height: Float[np.ndarray, "n"]
) -> dict[str, Float[np.ndarray, "n 4"]]:
    """Neck and head that keep the face ahead, nodding against the rise of the body."""
    chest = turned["hips"]
    for name in ("spine", "chest", "upperChest"):
        chest = multiply(chest, turned[name])
    face = about("x", np.arctan2(height - height.mean(), _GAZE))
    neck = slerp(np.broadcast_to(IDENTITY, face.shape), multiply(inverse(chest), face), 0.5)
    return {"neck": neck, "head": multiply(inverse(multiply(chest, neck)), face)}


def _toes(own: Float[np.ndarray, "n"], events: Float[np.ndarray, "4"]) -> Float[np.ndarray, "n 4"]:
    """Extension of the toes at phases of the foot's own stride; none while it is flat."""
    count = len(_TOES)
    order = np.arange(count // 2 + 1)  # a Fourier series, by hand: numpy.fft takes long to import
    keys = np.exp(-2j * np.pi * np.outer(order, np.arange(count)) / count) @ _TOES / count
    weight = np.where((order == 0) | (order == len(keys) - 1), 1.0, 2.0)
    bend = (weight * keys * np.exp(2j * np.pi * order * own[:, None])).real.sum(-1)
    flat, heel_off = (events[1:3] - events[0]) % 1.0
    bend = np.where((own >= flat) & (own <= heel_off), np.maximum(bend, 0.0), bend)
    return about("x", -np.radians(bend))
