"""Footsteps along a straight line: from standing or walking, over a distance, to a stop."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith._checks import number, one_of, positive
from gaitsmith.conventions import LEFT, RIGHT, SIDE_SIGN, ahead, leftward
from gaitsmith.errors import InfeasibleError, InvalidInputError
from gaitsmith.plan.footsteps import StepPlan

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.conventions import StepKind
    from gaitsmith.ground import Ground
    from gaitsmith.plan.pace import Pace

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


def plan_straight(
    *,
    distance: float,
    pace: Pace,
    stance: Stance,
    ground: Ground,
    start: str = "stand",
    stop: str = "stand",
    origin: tuple[float, float] = (0.0, 0.0),
    heading: float = 0.0,
) -> StepPlan:
    """Footsteps from ``origin`` straight ahead over ``distance`` meters.

    Parameters
    ----------
    distance
        Meters from the first to the last point of the path.
    pace
        Steady step length and cadence.
    stance
        Step width and toe-out.
    ground
        Gives the height of every footstep.
    start, stop
        ``"stand"``: feet side by side, the middle of both N on the end point. ``"walk"``: frame
        0 is a heel strike at the first point; the end is the last heel strike on the path.
    origin, heading
        Where the path begins, x,z, and which way it goes.
    """
    distance = positive("distance", distance, "meters")
    if distance / pace.step_length > MOST_STEPS:
        raise InvalidInputError(
            f"distance {distance:g} m takes more than {MOST_STEPS} steps of {pace.step_length:.3f} "
            "m; walk it in parts"
        )
    one_of("start", start, ("stand", "walk"))
    one_of("stop", stop, ("stand", "walk"))
    number("heading", heading, "radians")
    lengths = stride_lengths(distance, pace.step_length, start, stop)
    kinds: list[StepKind] = ["walk"] * len(lengths)
    along = np.cumsum([0.0, *lengths])
    if start == "stand":
        kinds[0] = "start"
        along = np.concatenate([[0.0], along])
    else:
        along = np.concatenate([[-pace.step_length], along])
    if stop == "stand":
        kinds.append("stop")
        along = np.concatenate([along, along[-1:]])
    eased = np.array([EASED_DURATION if kind != "walk" else 1.0 for kind in kinds])
    time = np.concatenate([[0.0, 0.0], np.cumsum(eased * pace.step_duration)])
    # the first to land is the right one; so mid-walk it is the rear one
    side = np.arange(len(along)) % 2
    side[2:] = 1 - side[2:]
    side[:2] = [LEFT, RIGHT] if start == "stand" else [RIGHT, LEFT]
    position = footstep_positions(along, side, stance, origin, heading, ground)
    # mid-walk the hips are still behind the first point: the path begins at the rear foot
    first = float(min(along[0], 0.0))
    count = max(2, int(np.ceil((distance - first) / PATH_SPACING)) + 1)
    way = ahead(heading)[[0, 2]]
    return StepPlan(
        side=side,
        position=position,
        heading=heading + SIDE_SIGN[side] * np.array(stance.toe_out)[side],
        direction=np.full(len(along), heading),
        time=time,
        kinds=tuple(kinds),
        path=np.asarray(origin) + np.linspace(first, distance, count)[:, None] * way,
    )


def footstep_positions(
    along: Float[np.ndarray, "N"],
    side: np.ndarray,
    stance: Stance,
    origin: tuple[float, float],
    heading: float,
    ground: Ground,
) -> Float[np.ndarray, "N 3"]:
    """N of footsteps ``along`` a line, half a step width to their side, on the ground."""
    out = np.array([origin[0], 0.0, origin[1]]) + along[:, None] * ahead(heading)
    out = out + (0.5 * stance.width * SIDE_SIGN[side])[:, None] * leftward(heading)
    out[:, 1] = ground.height(out[:, 0], out[:, 2])
    return out
