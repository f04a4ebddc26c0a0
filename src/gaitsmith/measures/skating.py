"""Foot skating as others define it, so that numbers can be compared with theirs.

All look at the toe joints. Heights count from a floor that the caller chooses, because the
scores hang on it more than on the motion: data sets in the HumanML3D format put height 0 at the
lowest toe joint, others at the sole.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.geometry.curves import hermite, parabola_slopes
from gaitsmith.measures.contacts import runs

if TYPE_CHECKING:
    from jaxtyping import Float

#: Frames per second at which guided motion diffusion and Kimodo count.
GMD_FPS, KIMODO_FPS = 20.0, 30.0
_LOW = 0.05
_WINDOW = 5


def resampled(
    paths: Float[np.ndarray, "F *c"], fps: float, rate: float
) -> Float[np.ndarray, "n *c"]:
    """``paths`` at ``rate`` frames a second from the first frame on, by the cubic."""
    count = int(np.floor((len(paths) - 1) / fps * rate + 1e-6)) + 1
    at = np.arange(count) * (fps / rate)
    frames = np.arange(len(paths), dtype=np.float64)
    flat = paths.reshape(len(paths), -1)
    return hermite(frames, flat, parabola_slopes(frames, flat), at).reshape(-1, *paths.shape[1:])


def gmd_skating_ratio(
    toes: Float[np.ndarray, "F 2 3"], fps: float, floor: float = 0.0
) -> float | None:
    """Share of frames in which a foot skates, as guided motion diffusion and OmniControl count.

    At 20 frames a second: toe joint below 5 cm in this frame and the next, horizontal speed
    above 0.5 m/s in this frame and on the average of five. None of fewer than two frames.
    """
    toes = resampled(toes, fps, GMD_FPS)
    if len(toes) < 2:
        return None
    speed = np.linalg.norm(np.diff(toes[..., [0, 2]], axis=0), axis=-1) * GMD_FPS
    low = toes[..., 1] - floor < _LOW
    touching = low[:-1] & low[1:]
    mean = np.lib.stride_tricks.sliding_window_view(
        np.pad(speed, ((_WINDOW // 2, _WINDOW // 2), (0, 0))), _WINDOW, axis=0
    ).mean(-1)
    skates = touching & (speed > 0.5) & (mean > 0.5)
    return float(skates.any(-1).mean())


def kimodo_skate(
    toes: Float[np.ndarray, "F 2 3"], fps: float, floor: float = 0.0
) -> tuple[float | None, float | None]:
    """Kimodo's skate ratio, and its skate from height (m/s), at 30 frames a second.

    The ratio is the share, among frames in which a toe joint is below 5 cm in this frame and the
    next, of those with a speed above 0.2 m/s. Skate from height is the mean speed in frames
    in which it is below 5 cm. None where no toe joint is that low.
    """
    toes = resampled(toes, fps, KIMODO_FPS)
    if len(toes) < 2:
        return None, None
    speed = np.linalg.norm(np.diff(toes, axis=0), axis=-1) * KIMODO_FPS
    low = toes[..., 1] - floor < _LOW
    touching = low[:-1] & low[1:]
    ratio = float((speed[touching] > 0.2).mean()) if touching.any() else None
    return ratio, float(speed[low[:-1]].mean()) if low[:-1].any() else None


def camdm_sliding(
    toes: Float[np.ndarray, "F 2 3"], root: Float[np.ndarray, "F 3"], fps: float
) -> float | None:
    """CAMDM's foot sliding at 30 frames a second: a ratio of two speeds.

    Mean horizontal way of a toe joint from frame to frame while it is within 1 cm of the
    lowest that a toe joint gets, over the mean way of the root. None if the root stays.
    """
    toes, root = (resampled(path, fps, KIMODO_FPS) for path in (toes, root))
    if len(toes) < 2:
        return None
    moved = np.linalg.norm(np.diff(toes[..., [0, 2]], axis=0), axis=-1)
    low = (toes[..., 1] - toes[..., 1].min() < 0.01)[1:]
    got = float(np.linalg.norm(np.diff(root[:, [0, 2]], axis=0), axis=-1).mean())
    if got < 1e-4 or not low.any():
        return None
    return float(moved[low].mean()) / got


def toe_excursions(
    toes: Float[np.ndarray, "F 2 3"], fps: float, floor: float = 0.0
) -> Float[np.ndarray, "n"]:
    """How far the toe joint strays in each stance, meters, at 30 frames a second.

    Twice the largest distance from the mean place over at least four frames below 10 cm and
    0.15 m/s. Fast slips are no stance by this definition, so it is a lower bound.
    """
    toes = resampled(toes, fps, KIMODO_FPS)
    if len(toes) < 2:
        return np.zeros(0)
    speed = np.linalg.norm(np.gradient(toes, axis=0), axis=-1) * KIMODO_FPS
    stands = (speed < 0.15) & (toes[..., 1] - floor < 0.10)
    out = list[float]()
    for side in range(2):
        for a, b in runs(stands[:, side]):
            if b - a >= 4:
                path = toes[a:b, side]
                out.append(2.0 * float(np.linalg.norm(path - path.mean(0), axis=-1).max()))
    return np.array(out)
