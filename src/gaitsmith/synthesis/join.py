"""Join proposed steps: places where they part, and the speed of the hips from one to the next."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.contact.step_curves import end_speeds
from gaitsmith.conventions import LOCAL_KINDS
from gaitsmith.geometry.curves import smoothstep

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gaitsmith.contact import ReferenceStep
    from gaitsmith.conventions import StepKind

#: Curves that are handed over where a walk and local steps meet.
HANDED = ("center", "heading", "pelvis", "upper")


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


def join_all(steps: Sequence[ReferenceStep], kinds: Sequence[StepKind]) -> list[ReferenceStep]:
    """Walks and local steps: speeds joined within each, places handed over between them.

    Between them somebody stands. What differs there (a gait's own standing height, a pelvis that
    faces a little aside of the path) fades over the step that follows.
    """
    local = [kind in LOCAL_KINDS for kind in kinds]
    first = [
        i for i in range(len(kinds)) if i == 0 or local[i] or local[i - 1] or kinds[i] == "start"
    ]
    out: list[ReferenceStep] = []
    for begin, end in zip(first, [*first[1:], len(steps)], strict=True):
        part = list(steps[begin:end])
        if out:
            part[0] = _handed(out[-1], part[0])
        out += part if local[begin] else join_speeds(part)
    return out


def _handed(before: ReferenceStep, after: ReferenceStep) -> ReferenceStep:
    """``after`` beginning where ``before`` ends."""
    changes, fade = {}, 1.0 - smoothstep(after.curves.phase)
    for name in HANDED:
        ends, begins = getattr(before.curves, name)[-1], getattr(after.curves, name)[0]
        miss = ends - begins
        if name == "center":
            miss = miss + before.origin - after.origin
        if np.abs(miss).max() > 0.0:
            values = getattr(after.curves, name)
            changes[name] = values + fade.reshape(-1, *[1] * (values.ndim - 1)) * miss
    return after.with_(curves=after.curves.with_(**changes)) if changes else after
