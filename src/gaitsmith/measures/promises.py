"""What every generated motion promises, measured back from the motion itself."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.errors import InvalidInputError
from gaitsmith.measures.contacts import gone
from gaitsmith.measures.legs import knee_flexion
from gaitsmith.motion.kinematics import motion_kinematics, sole_positions

if TYPE_CHECKING:
    from jaxtyping import Bool, Float, Int

    from gaitsmith.ground import Ground
    from gaitsmith.motion.motion import Labels, Motion


#: Footsteps that differ more in height, meters, are on uneven ground.
UNEVEN = 1e-6


def promises(motion: Motion, ground: Ground) -> dict[str, float | None]:
    """The promises that a generated motion can show by itself.

    Returns
    -------
    ``slip_mm_max`` (of a sole point over a whole contact), ``penetration_mm_max``,
    ``float_mm_max`` (height while in contact), ``knee_min_deg`` (flexion while the foot bears),
    ``path_error_p95_m`` (signed distance of the mid-hip to the path, averaged over a stride),
    ``goal_error_m`` (middle of the last two footsteps to the end of the path), and the gait's
    own ``distance_m``, ``step_length_m``, ``cadence_spm``, ``speed_mps`` (both of the steady
    steps; None where there are none) and ``mean_speed_mps`` (of the whole motion).

    Raises
    ------
    InvalidInputError
        If the motion has no labels, contacts or soles.
    """
    if motion.labels is None or motion.contacts is None:
        raise InvalidInputError("this motion has no labels and contacts; only generated ones have")
    positions, world = motion_kinematics(motion)
    soles = sole_positions(motion.skeleton, positions, world)
    above = soles[..., 1] - ground.height(soles[..., 0], soles[..., 2])
    down = motion.contacts
    return {
        "slip_mm_max": 1e3 * float(gone(soles, down).max(initial=0.0)),
        "penetration_mm_max": 1e3 * max(0.0, float(-above.min())),
        "float_mm_max": 1e3 * max(0.0, float(above[down].max(initial=0.0))),
        "knee_min_deg": _knee(motion, positions, down),
        **_gait(motion, motion.labels, positions),
    }


def _knee(
    motion: Motion, positions: Float[np.ndarray, "F J 3"], down: Bool[np.ndarray, "F 2 3"]
) -> float:
    """Smallest knee flexion of a leg whose foot bears, degrees."""
    least = np.inf
    for i, side in enumerate(("left", "right")):
        hip, knee, ankle = (
            positions[:, motion.skeleton.index(side + part)]
            for part in ("UpperLeg", "LowerLeg", "Foot")
        )
        flexion = knee_flexion(hip, knee, ankle)[down[:, i].any(-1)]
        least = min(least, float(flexion.min(initial=np.inf)))
    return float(np.degrees(least))


def _gait(
    motion: Motion, labels: Labels, positions: Float[np.ndarray, "F J 3"]
) -> dict[str, float | None]:
    index = motion.skeleton.index
    hips = 0.5 * (positions[:, index("leftUpperLeg")] + positions[:, index("rightUpperLeg")])
    path, way = labels.path, hips[:, [0, 2]]
    distance = float(np.linalg.norm(way[-1] - way[0]))
    out: dict[str, float | None] = {"distance_m": distance}
    if path is not None:
        out["path_error_p95_m"] = _path_error(way, path, labels, motion.fps)
        last = labels.footstep_position[-2:, [0, 2]].mean(0)
        out["goal_error_m"] = float(np.linalg.norm(last - path[-1]))
    out["mean_speed_mps"] = distance / max(motion.duration, 1e-9)
    steady = steady_steps(labels)
    if not len(steady):  # nobody takes a step
        return out | {"step_length_m": None, "cadence_spm": None, "speed_mps": None}
    gaps = step_lengths(labels)[steady]
    times = np.diff(labels.footstep_time[1:])[steady]
    length, duration = _quantile(gaps, 0.5), _quantile(times, 0.5)
    out |= {
        "step_length_m": length,
        "cadence_spm": 60.0 / duration,
        "speed_mps": length / duration,
    }
    return out


def step_lengths(labels: Labels) -> Float[np.ndarray, "steps"]:
    """Distance of each footstep beyond the foot it swings past, along the direction of the walk.

    The direction at a step is that of the mean heading of its two feet, so that toe-out and
    step width do not count.
    """
    position, heading = labels.footstep_position, labels.footstep_heading
    stance, stands = [], {int(labels.footstep_side[i]): i for i in (0, 1)}
    for i in range(2, len(position)):
        side = int(labels.footstep_side[i])
        stance.append(stands.get(1 - side, i - 1))
        stands[side] = i
    mean = 0.5 * (heading[stance] + heading[2:])
    gap = position[2:] - position[stance]
    return gap[:, 0] * np.sin(mean) + gap[:, 2] * np.cos(mean)


def steady_steps(labels: Labels) -> Int[np.ndarray, "k"]:
    """Indices of the steps that neither start, stop nor fit the end; all if there are none.

    Up and down, where the ground sets the steps: all but the first and the last.
    """
    lengths, times = step_lengths(labels), np.diff(labels.footstep_time[1:])
    if not len(lengths):
        return np.zeros(0, dtype=np.int64)
    if np.ptp(labels.footstep_position[:, 1]) > UNEVEN and len(lengths) > 2:
        return np.arange(1, len(lengths) - 1)
    longest = lengths.max()
    full = (lengths > longest * (1.0 - 1e-6)) & (times < times.min() * (1.0 + 1e-6))
    return np.flatnonzero(full) if full.any() else np.flatnonzero(lengths >= 0.5 * longest)


def _path_error(
    way: Float[np.ndarray, "F 2"], path: Float[np.ndarray, "P 2"], labels: Labels, fps: float
) -> float:
    """95th percentile of the stride's mean signed distance to the path, meters."""
    sx, sz = np.diff(path, axis=0).T
    square = sx * sx + sz * sz
    signed = np.empty(len(way))
    # blocks of frames, in the processor's cache: all at once would not fit the memory
    block = max(1, 100_000 // len(sx))
    for start in range(0, len(way), block):
        # x and z apart: rows of two are slow to work on
        ox, oz = (way[start : start + block, i, None] - path[:-1, i] for i in (0, 1))
        t = np.clip((ox * sx + oz * sz) / square, 0.0, 1.0)
        ox -= t * sx
        oz -= t * sz
        near = (ox * ox + oz * oz).argmin(-1)
        row = np.arange(len(near))
        ox, oz = ox[row, near], oz[row, near]
        side = np.sign(sx[near] * oz - sz[near] * ox)
        signed[start : start + block] = side * np.sqrt(ox * ox + oz * oz)
    stride = round(2.0 * _quantile(np.diff(labels.footstep_time[1:]), 0.5) * fps)
    if 1 < stride < len(way):
        signed = np.convolve(signed, np.ones(stride) / stride, mode="valid")
    return _quantile(np.abs(signed), 0.95)


def _quantile(values: Float[np.ndarray, "n"], share: float) -> float:
    """As ``numpy.quantile``, which imports ``numpy.ma``: that takes longer than the rest here."""
    ranks = np.arange(len(values))
    return float(np.interp(share * (len(values) - 1), ranks, np.sort(values)))
