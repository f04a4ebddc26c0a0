"""Arms, hands, legs and shoes of the mannequin."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import SIDE_SIGN, SIDES
from gaitsmith.skin import palette
from gaitsmith.skin.parts import ADULT
from gaitsmith.skin.shapes import frame_along, tube
from gaitsmith.skin.shoe import outsole, upper

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.skin.palette import Color
    from gaitsmith.skin.parts import Maker


def add_arm(maker: Maker, side: int) -> None:
    """Shoulder, upper arm, forearm and hand of one side."""
    word, sign = SIDES[side], float(SIDE_SIGN[side])
    tint, dark = palette.SIDE_LIMBS[side], palette.SIDE_JOINTS[side]
    out = np.array([sign, 0.0, 0.0])
    reach = maker.stature
    shoulder = maker.find(f"{word}Shoulder")
    if shoulder is not None:
        to = maker.to_child(shoulder, f"{word}UpperArm", 0.09 * reach * out)
        shape = [
            [0.0, 0.060, 0.050, -0.008, 0.002],
            [0.5, 0.052, 0.040, -0.006, 0.006],
            [0.95, 0.042, 0.034, 0.0, 0.012],
        ]
        maker.limb(f"{word}Shoulder", shoulder, to, shape, palette.WOOD)
    joint = maker.find(f"{word}UpperArm")
    if joint is not None:
        to = maker.to_child(joint, f"{word}LowerArm", 0.186 * reach * out)
        shape = [
            [0.0, 0.045, 0.041, 0.0],
            [0.16, 0.048, 0.045, 0.0],
            [0.4, 0.044, 0.043, 0.004],
            [0.93, 0.035, 0.034, 0.0],
        ]
        maker.limb(f"{word}UpperArm", joint, to, shape, tint, cap=0.62)
    joint = maker.find(f"{word}LowerArm")
    to = 0.146 * reach * out
    if joint is not None:
        to = maker.to_child(joint, f"{word}Hand", to)
        shape = [
            [0.08, 0.035, 0.034, 0.0],
            [0.3, 0.039, 0.036, 0.0],
            [0.7, 0.030, 0.028, 0.0],
            [0.95, 0.026, 0.022, 0.0],
        ]
        maker.knob(f"{word}Elbow", joint, 0.037, dark)
        maker.limb(f"{word}LowerArm", joint, to, shape, tint)
    joint = maker.find(f"{word}Hand")
    if joint is not None:
        _hand(maker, word, joint, to / max(float(np.linalg.norm(to)), 1e-9), palette.WOOD)


def _hand(maker: Maker, word: str, joint: int, out: Float[np.ndarray, "3"], color: Color) -> None:
    """A mitten with a thumb; the palm looks down in the T-pose, fingers curl toward it."""
    frame = frame_along(out)
    palm = float(np.sign(frame[1] @ np.array([0.0, -1.0, 0.0]))) or 1.0
    unit = maker.stature / ADULT
    mitten = (
        np.array(
            [
                [0.000, 0.026, 0.020, 0.0, 0.000],
                [0.035, 0.036, 0.019, 0.0, 0.001],
                [0.085, 0.040, 0.018, 0.0, 0.006],
                [0.130, 0.034, 0.015, 0.0, 0.017],
                [0.165, 0.023, 0.012, -0.002, 0.032],
            ]
        )
        * unit
    )
    mitten[:, 4] *= palm
    mesh = tube(
        mitten,
        frame,
        np.zeros(3),
        caps=(0.016 * unit, 0.014 * unit),
        around=maker.around,
        rings=max(4, round(6 * maker.detail)),
    )
    maker.add(f"{word}Hand", joint, mesh, color)
    thumb = (
        np.array(
            [
                [0.020, 0.013, 0.013, 0.022, 0.004],
                [0.060, 0.012, 0.012, 0.044, 0.014],
                [0.088, 0.009, 0.009, 0.050, 0.022],
            ]
        )
        * unit
    )
    thumb[:, 4] *= palm
    mesh = tube(
        thumb,
        frame,
        np.zeros(3),
        caps=(0.008 * unit, 0.008 * unit),
        around=8,
        rings=max(3, round(3 * maker.detail)),
    )
    maker.add(f"{word}Thumb", joint, mesh, color)


def add_leg(maker: Maker, side: int) -> None:
    """Thigh and shank of one side."""
    word = SIDES[side]
    tint, dark = palette.SIDE_LIMBS[side], palette.SIDE_JOINTS[side]
    down = np.array([0.0, -1.0, 0.0])
    joint = maker.find(f"{word}UpperLeg")
    if joint is not None:
        to = maker.to_child(joint, f"{word}LowerLeg", 0.245 * maker.stature * down)
        apart = abs(float(maker.rest[joint, 0])) / maker.girth
        top = min(0.084, max(apart, 0.06))
        shape = [
            [0.0, 0.086, top, -0.004],
            [0.25, 0.080, 0.95 * top, 0.0],
            [0.6, 0.066, 0.064, 0.004],
            [0.93, 0.052, 0.052, 0.002],
        ]
        maker.limb(f"{word}UpperLeg", joint, to, shape, tint)
    joint = maker.find(f"{word}LowerLeg")
    if joint is not None:
        to = maker.to_child(joint, f"{word}Foot", 0.246 * maker.stature * down)
        shape = [
            [0.07, 0.049, 0.050, -0.002],
            [0.3, 0.055, 0.052, -0.014],
            [0.6, 0.043, 0.042, -0.008],
            [0.9, 0.032, 0.031, 0.0],
            [1.0, 0.034, 0.032, 0.0],
        ]
        maker.knob(f"{word}Knee", joint, 0.053, dark)
        maker.limb(f"{word}LowerLeg", joint, to, shape, tint)


def add_shoe(maker: Maker, side: int) -> None:
    """Shoe of one side, in two pieces where the toes have a joint of their own."""
    word, last = SIDES[side], maker.lasts[side]
    foot, toes = maker.find(f"{word}Foot"), maker.find(f"{word}Toes")
    if last is None or foot is None:
        return
    color = palette.SIDE_SHOES[side]
    split = 1.0 if toes is None else float(last.share(np.array([last.ball]))[0])
    pieces = [(f"{word}Foot", foot, 0.0, split, np.zeros(3))]
    if toes is not None:
        pieces.append((f"{word}Toes", toes, split, 1.0, maker.skeleton.offsets[toes]))
    for name, joint, low, high, shift in pieces:
        for label, mesh, paint in (
            ("Sole", outsole(last, low, high), palette.OUTSOLE),
            ("", upper(last, low, high, around=maker.around + 4), color),
        ):
            maker.add(name + label, joint, (mesh[0] - shift, mesh[1]), paint)
