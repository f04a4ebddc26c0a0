"""How the rest of the body goes along: hips, arms, trunk, head, stride by stride."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import SIDES
from gaitsmith.geometry.rotations import inverse, rotate
from gaitsmith.measures.smoothness import log_dimensionless_jerk

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from jaxtyping import Float

    from gaitsmith.measures.figure import Figure
    from gaitsmith.measures.steps import Steps


def stride_frames(figure: Figure, steps: Steps) -> list[slice]:
    """Frames of each steady stride, both ends included."""
    feet, fps = figure.footsteps, figure.motion.fps
    first, last = (np.rint(feet.time[steps.stride + k] * fps).astype(int) for k in (0, 2))
    end = len(figure.motion)
    return [slice(a, min(b + 1, end)) for a, b in zip(first.tolist(), last.tolist(), strict=True)]


def hip_figures(figure: Figure, steps: Steps) -> dict[str, float | None]:
    """Bob and sway of the hips, rotation and list of the pelvis."""
    strides = stride_frames(figure, steps)
    direction = figure.footsteps.direction()
    turns = np.angle(np.exp(1j * (direction[steps.stride + 2] - direction[steps.stride])))
    sway = [_sway(figure.hips[s][:, [0, 2]], float(t)) for s, t in zip(strides, turns, strict=True)]
    tilt = np.degrees(np.arcsin(np.clip(figure.left[:, 1], -1.0, 1.0)))
    yaw = np.degrees(figure.yaw)
    return {
        "bob_mm": _typical(strides, lambda s: 1e3 * _range(figure.hips[s, 1])),
        "sway_mm": 1e3 * float(np.median(sway)) if sway else None,
        "pelvis_rotation_deg": _typical(strides, lambda s: _range(_straightened(yaw[s]))),
        "pelvis_list_deg": _typical(strides, lambda s: _range(tilt[s])),
    }


def arm_figures(figure: Figure, steps: Steps) -> dict[str, float | None]:
    """Swing of each upper arm, how it goes against the leg, smoothness of the wrists."""
    strides = stride_frames(figure, steps)
    out: dict[str, float | None] = {}
    against, smooth = list[float](), list[float]()
    for side in SIDES:
        arm, leg = (
            np.unwrap(pitch(figure, f"{side}Upper{part}", f"{side}Lower{part}"))
            for part in ("Arm", "Leg")
        )
        swing = _typical(strides, lambda s, arm=arm: float(np.degrees(_range(arm[s]))))
        out[f"arm_swing_{side}_deg"] = swing
        wrist = figure.at(f"{side}Hand") - figure.hips
        for s in strides:
            jerk = log_dimensionless_jerk(wrist[s], figure.motion.fps)
            if jerk is not None:
                smooth.append(jerk)
            if min(_range(arm[s]), _range(leg[s])) > 1e-3:
                against.append(float(np.corrcoef(arm[s], leg[s])[0, 1]))
    return {
        **out,
        "arm_against_leg": float(np.median(against)) if against else None,
        "wrist_ldj": float(np.median(smooth)) if smooth else None,
    }


def trunk_lean(figure: Figure, steps: Steps) -> float | None:
    """Degrees that the trunk leans forward, on the mean of the strides (of all, without any).

    The trunk is the line from the middle of the hip joints to that of the shoulders, to the
    neck or head where there are none.
    """
    if figure.has("leftUpperArm", "rightUpperArm"):
        top = 0.5 * (figure.at("leftUpperArm") + figure.at("rightUpperArm"))
    else:
        role = next((r for r in ("neck", "head") if figure.has(r)), None)
        if role is None:
            return None
        top = figure.at(role)
    up = top - figure.hips
    lean = np.degrees(np.arctan2((up * figure.ahead).sum(-1), up[:, 1]))
    strides = stride_frames(figure, steps)
    return float(np.mean([lean[s].mean() for s in strides]) if strides else lean.mean())


def head_pitch_range(figure: Figure, steps: Steps) -> float | None:
    """Degrees that the head nods within a stride; needs a head and a stride."""
    if not figure.has("head"):
        return None
    turned = figure.world[:, figure.joints["head"]]
    # ahead as the head sees it: rigs put their axes where they like
    axis = rotate(inverse(turned), figure.ahead).mean(0)
    length = float(np.linalg.norm(axis))
    if length < 1e-6:
        return None
    way = rotate(turned, np.broadcast_to(axis / length, (len(turned), 3)))
    nod = np.degrees(np.arcsin(np.clip(way[:, 1], -1.0, 1.0)))
    return _typical(stride_frames(figure, steps), lambda s: _range(nod[s]))


def pitch(figure: Figure, top: str, bottom: str) -> Float[np.ndarray, "F"]:
    """Angle of a bone against straight down in the plane that the hips face, ahead positive."""
    bone = figure.at(bottom) - figure.at(top)
    return np.arctan2((bone * figure.ahead).sum(-1), -bone[:, 1])


def _range(values: Float[np.ndarray, "n"]) -> float:
    return float(values.max() - values.min())


def _typical(strides: Sequence[slice], of: Callable[[slice], float]) -> float | None:
    """Median over the strides."""
    return float(np.median([of(s) for s in strides])) if strides else None


def _straightened(values: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n"]:
    """Without the line from the first to the last value."""
    return values - np.linspace(values[0], values[-1], len(values))


def _sway(way: Float[np.ndarray, "n 2"], turn: float) -> float:
    """Range of a path beside the arc of ``turn`` radians from its first to its last point."""
    chord = way[-1] - way[0]
    length = float(np.hypot(*chord))
    if length < 1e-9:
        return float(np.linalg.norm(way - way.mean(0), axis=-1).max())
    along, left = chord / length, np.array([chord[1], -chord[0]]) / length
    u = (way - way[0]) @ along / length
    return _range((way - way[0]) @ left + 0.5 * turn * length * u * (1.0 - u))
