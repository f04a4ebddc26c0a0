"""Where it went: distance, way, turning."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.measures.figure import Figure
    from gaitsmith.measures.steps import Steps


def course_figures(figure: Figure, steps: Steps) -> dict[str, float | None]:
    """Distance, way and turning of the hips; sway and pelvis rotation averaged away.

    What the first and the last half stride turn does not count, in clips of over two strides.
    """
    fps, feet = figure.motion.fps, figure.footsteps
    strides = feet.time[steps.stride + 2] - feet.time[steps.stride]
    half = max(1, round(0.5 * (float(np.median(strides)) if len(strides) else 1.0) * fps))
    way = figure.hips[:, [0, 2]]
    calm = averaged(way, half)
    heading = averaged(figure.yaw[:, None], half)[:, 0]
    if len(heading) > 4 * half:  # whole windows only: at the ends the pelvis would show
        heading = heading[half : len(heading) - half]
    turns = np.degrees(np.diff(heading))
    distance = float(np.linalg.norm(way[-1] - way[0]))
    return {
        "distance_m": distance,
        "mean_speed_mps": distance / figure.motion.duration,
        "way_m": float(np.linalg.norm(np.diff(calm, axis=0), axis=-1).sum()),
        "turned_deg": float(turns.sum()),
        "turning_deg": float(np.abs(turns).sum()),
    }


def averaged(values: Float[np.ndarray, "F c"], half: int) -> Float[np.ndarray, "F c"]:
    """Mean of each value and its ``half`` neighbors on both sides, fewer toward the ends."""
    count = len(values)
    total = np.concatenate([np.zeros((1, values.shape[1])), np.cumsum(values, axis=0)])
    at = np.arange(count)
    room = np.minimum(half, np.minimum(at, count - 1 - at))
    return (total[at + room + 1] - total[at - room]) / (2 * room + 1)[:, None]
