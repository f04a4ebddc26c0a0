"""Join proposed steps so that the hips keep their speed from one to the next."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gaitsmith.contact import ReferenceStep


def join_speeds(steps: Sequence[ReferenceStep]) -> list[ReferenceStep]:
    """The same steps, with the path of the hips C1 where they meet.

    Unequal steps meet with 15-20 % different speeds ([KB92b] erratum D17). Both sides take
    the mean; the change is a cubic over the whole step that moves neither end.
    """
    speeds = [s.curves.end_speeds for s in steps]
    out = []
    for i, step in enumerate(steps):
        begins, ends = speeds[i]
        start = 0.5 * (speeds[i - 1][1] - begins) if i > 0 else np.zeros(3)
        end = 0.5 * (speeds[i + 1][0] - ends) if i + 1 < len(steps) else np.zeros(3)
        out.append(step.with_(speed_change=(start, end)))
    return out
