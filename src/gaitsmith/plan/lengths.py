"""How steps share out a distance: the first shorter, the last three fitted to the end."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gaitsmith.errors import InfeasibleError

#: First step over the steady one (0.80 measured, one person from rest).
FIRST_STEP = 0.8
#: Duration of the starting and of the closing step over a steady one. The clock eases through
#: them, from rest to the steady rate and back, so one half longer means never faster.
EASED_DURATION = 1.5
#: How what the last three full steps must give up is shared among them, last one most
#: (measured before a stop: -5, -15 %).
SHARES = (1.0 / 6.0, 2.0 / 6.0, 3.0 / 6.0)
#: Part of a step that those three give up together, at least: nobody stops from full steps.
LEAST_DEFICIT = 0.2
#: Steps that one plan may have.
MOST_STEPS = 100_000
#: Path samples, meters apart.
PATH_SPACING = 0.02


@dataclass(frozen=True)
class Stance:
    """How the feet are set.

    Attributes
    ----------
    width
        Between their N across the walk, meters.
    toe_out
        Radians that both feet, or [left, right], turn out; kept as a pair.
    """

    width: float
    toe_out: float | tuple[float, float]

    def __post_init__(self) -> None:
        """Make a pair of one angle."""
        if not isinstance(self.toe_out, tuple):
            object.__setattr__(self, "toe_out", (self.toe_out, self.toe_out))


def stride_lengths(distance: float, length: float, start: str, stop: str) -> list[float]:
    """Lengths of the steps over ``distance``, the closing step not counted, meters.

    Every step has exactly ``length``, but the first from standing, and, to a stop, the last
    three, which are shorter, the last most. ``stop="walk"`` ends at the last footstep that
    lies on the path.
    """
    first = min(FIRST_STEP * length, distance) if start == "stand" else 0.0
    head = [first] if first else []
    rest = distance - first
    if stop == "walk":
        count = int(np.floor(rest / length + 1e-9))
        if not head and count == 0:
            raise InfeasibleError(
                f"distance {distance:g} m holds no step of {length:.3f} m; with stop='walk' at "
                "least one must fit: go farther, or shorten the step"
            )
        return head + [length] * count
    if rest <= 1e-9:
        return head
    count = max(1, int(np.ceil(rest / length + LEAST_DEFICIT - 1e-9)))
    deficit = count * length - rest
    tail = np.array(SHARES[-min(count, 3) :])
    cut = deficit * tail / tail.sum()
    if (cut > 0.9 * length).any():  # too short to share out: equal steps
        return head + [rest / count] * count
    full = [length] * (count - len(cut))
    lengths = head + full + [length - c for c in cut]
    lengths[-1] += distance - sum(lengths)  # rounding: the goal is met exactly
    return lengths
