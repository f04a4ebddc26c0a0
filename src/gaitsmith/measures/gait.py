"""Steps in numbers: how long, how wide, how often, how high the toes pass."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import BALL, LEFT, RIGHT, SIDE_SIGN, SIDES

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.measures.figure import Figure
    from gaitsmith.measures.footsteps import Footsteps
    from gaitsmith.measures.steps import Steps

#: Share of a swing in which its toes pass the other foot: where the clearance is looked for.
_PASSING = (0.30, 0.75)


def step_figures(feet: Footsteps, steps: Steps) -> dict[str, float | None]:
    """Lengths, widths and pace of the steady steps."""
    good = steps.steady
    length, width, side = steps.length[good], steps.width[good], feet.side[steps.index[good]]
    pace = _pace(feet, steps)
    step = _median(length)
    return {
        "cadence_spm": pace,
        "step_length_m": step,
        "step_length_left_m": _median(length[side == LEFT]),
        "step_length_right_m": _median(length[side == RIGHT]),
        "step_length_mean_m": _mean(length),
        "step_length_sd_m": _deviation(length),
        "step_width_m": _median(width),
        "step_width_sd_m": _deviation(width),
        "speed_mps": None if pace is None or step is None else step * pace / 60.0,
        **_toe_out(feet, steps),
    }


def stride_figures(figure: Figure, steps: Steps) -> dict[str, float | None]:
    """Lengths and shares of the steady strides, and how high the toes pass in their swings."""
    feet, stride = figure.footsteps, steps.stride
    way = feet.position[stride + 2] - feet.position[stride]
    duration = feet.time[stride + 2] - feet.time[stride]
    stance = (feet.off[stride] - feet.time[stride]) / duration
    # the other foot bears on after this one's landing, this one after the other's
    both = feet.off[stride - 1] - feet.time[stride] + feet.off[stride] - feet.time[stride + 1]
    both = np.where(stride > 0, both, np.nan)
    clear = clearances(figure, steps)
    return {
        "stride_length_m": _median(np.hypot(way[:, 0], way[:, 2])),
        "stride_time_s": _median(duration),
        "stance_share": _median(stance),
        "double_support_share": _median(np.maximum(both, 0.0) / duration),
        "toe_clearance_mm_min": None if len(clear) == 0 else 1e3 * float(clear.min()),
        "toe_clearance_mm_median": None if len(clear) == 0 else 1e3 * float(np.median(clear)),
    }


def clearances(figure: Figure, steps: Steps) -> Float[np.ndarray, "n"]:
    """Least height of ball and toes in the middle of each steady swing, meters.

    The heel, which comes down to land, is no part of it. Over the line that joins
    what the foot stood on before and after.
    """
    feet, fps, out = figure.footsteps, figure.motion.fps, list[float]()
    for i in steps.index[steps.steady]:
        before = np.flatnonzero(feet.side[:i] == feet.side[i])
        if len(before) == 0 or not np.isfinite(feet.off[before[-1]] + feet.time[i]):
            continue
        j = before[-1]
        begin, swing = feet.off[j], feet.time[i] - feet.off[j]
        first, last = (round(float(begin + share * swing) * fps) for share in _PASSING)
        frames = np.arange(first, last + 1)
        share = (frames / fps - begin) / max(swing, 1e-9)
        base = feet.height[j] + share * (feet.height[i] - feet.height[j])
        low = figure.soles[frames, feet.side[i], BALL:, 1].min(-1) - base
        out.append(float(low.min()))
    return np.array(out)


def flight(feet: Footsteps) -> float:
    """Time that no foot is on the ground in a usual step, seconds; 0 of a walk."""
    gap = _median((feet.time[1:] - feet.off[:-1])[feet.side[1:] != feet.side[:-1]])
    return 0.0 if gap is None else max(0.0, gap)


def _pace(feet: Footsteps, steps: Steps) -> float | None:
    """Steps a minute, of strides: left and right events may be early or late, each alike."""
    stride = _median(feet.time[steps.stride + 2] - feet.time[steps.stride])
    if stride is not None and stride > 0.0:
        return 120.0 / stride
    step = _median(steps.time[steps.steady])
    return None if step is None or step <= 0.0 else 60.0 / step


def _toe_out(feet: Footsteps, steps: Steps) -> dict[str, float | None]:
    """Degrees that each foot turns out of the direction of the walk."""
    index = steps.index[steps.steady]
    turned = feet.heading[index] - feet.direction()[index]
    out = np.angle(np.exp(1j * turned)) * SIDE_SIGN[feet.side[index]]
    found: dict[str, float | None] = {}
    for side, name in enumerate(SIDES):
        own = _median(out[feet.side[index] == side])
        found[f"toe_out_{name}_deg"] = None if own is None else float(np.degrees(own))
    return found


def _median(values: Float[np.ndarray, "n"]) -> float | None:
    known = values[np.isfinite(values)]
    return float(np.median(known)) if len(known) else None


def _mean(values: Float[np.ndarray, "n"]) -> float | None:
    return float(values.mean()) if len(values) else None


def _deviation(values: Float[np.ndarray, "n"]) -> float | None:
    return float(values.std(ddof=1)) if len(values) > 1 else None
