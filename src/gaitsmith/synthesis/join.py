"""Join proposed steps so that the hips keep their speed from one to the next."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.contact.reference import end_speeds

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gaitsmith.contact import ReferenceStep


def join_speeds(steps: Sequence[ReferenceStep]) -> list[ReferenceStep]:
    """The same steps, with the path of the hips C1 where they meet.

    Unequal steps meet with 15-20 % different speeds ([KB92b] erratum D17). Both sides take
    the mean; the change is a cubic over the whole step that moves neither end.
    """
    begins, ends = end_speeds([s.curves for s in steps])
    start, end = np.zeros_like(begins), np.zeros_like(ends)
    start[1:] = 0.5 * (ends[:-1] - begins[1:])
    end[:-1] = 0.5 * (begins[1:] - ends[:-1])
    return [step.joined(a, b) for step, a, b in zip(steps, start, end, strict=True)]
