"""Join proposed steps so that the hips keep their speed from one to the next."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.geometry.curves import end_slope_correction, parabola_slopes

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gaitsmith.contact import ReferenceStep


def join_speeds(steps: Sequence[ReferenceStep]) -> list[ReferenceStep]:
    """The same steps, with the path of the hips C1 where they meet.

    Unequal steps meet with 15-20 % different speeds ([KB92b] erratum D17). Both sides take
    the mean; the change is a cubic over the whole step that moves neither end.
    """
    slopes = [parabola_slopes(s.phase, s.center) for s in steps]
    begins, ends = [m[0] for m in slopes], [m[-1] for m in slopes]
    out = []
    for i, step in enumerate(steps):
        start = 0.5 * (ends[i - 1] - begins[i]) if i > 0 else np.zeros(3)
        end = 0.5 * (begins[i + 1] - ends[i]) if i + 1 < len(steps) else np.zeros(3)
        if not (start.any() or end.any()):
            out.append(step)
            continue
        extra = end_slope_correction(step.phase, start, end)
        out.append(step.with_(center=step.center + extra))
    return out
