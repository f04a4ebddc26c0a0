"""Seconds to walk phase: steps run evenly, a start eases in, a stop eases out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import LOCAL_KINDS

if TYPE_CHECKING:
    from jaxtyping import Float, Int

    from gaitsmith.plan.footsteps import StepPlan
    from gaitsmith.plan.timeline import Timeline


@dataclass(frozen=True, eq=False)
class Clock:
    """When each step runs and how its phase passes.

    All curves of a walk are functions of the phase, so easing the phase eases everything and
    nothing slides.

    Attributes
    ----------
    starts
        ``(S + 1,)`` seconds at which steps begin; the last is the end of the last step.
    rates
        ``(S, 2)`` change of phase per normalized time at the start and end of each step; 1 and
        1 pass evenly.
    rest
        Seconds of standing after the last step.
    """

    starts: Float[np.ndarray, "S+1"]
    rates: Float[np.ndarray, "S 2"]
    rest: float = 0.0

    @staticmethod
    def of(plan: StepPlan | Timeline, *, rest: float = 0.0) -> Clock:
        """The clock of a plan: rates agree where steps of different duration meet."""
        durations = plan.durations
        speed = 1.0 / durations  # phase per second, if it passed evenly
        joint = np.concatenate([speed[:1], np.minimum(speed[:-1], speed[1:]), speed[-1:]])
        for i, kind in enumerate(plan.kinds):
            if kind == "start":
                joint[i] = 0.0
                if i + 1 < len(plan.kinds) and plan.kinds[i + 1] == "walk":
                    joint[i + 1] = speed[i + 1]
            elif kind == "stop":
                joint[i + 1] = 0.0
                if i > 0 and plan.kinds[i - 1] == "walk":
                    joint[i] = speed[i - 1]
        # beyond 3 times the even rate, on either side, a cubic would run backwards
        slowest = np.minimum(np.append(speed, speed[-1]), np.insert(speed, 0, speed[0]))
        joint = np.minimum(joint, 3.0 * slowest)
        rates = np.stack([joint[:-1] * durations, joint[1:] * durations], axis=-1)
        for i, kind in enumerate(plan.kinds):
            if kind in LOCAL_KINDS:  # they ease by themselves; standing joins what is beside it
                before = i > 0 and plan.kinds[i - 1] == "stop"
                after = i + 1 < len(plan.kinds) and plan.kinds[i + 1] == "start"
                rates[i] = (0.0 if before else 1.0, 0.0 if after else 1.0)
        return Clock(np.concatenate([[0.0], np.cumsum(durations)]), rates, rest)

    @property
    def duration(self) -> float:
        """Seconds, rest included."""
        return float(self.starts[-1]) + self.rest

    def position(
        self, times: Float[np.ndarray, "F"]
    ) -> tuple[Int[np.ndarray, "F"], Float[np.ndarray, "F"]]:
        """Index of the step at each time and the share of its duration that has passed.

        In the rest after the last step: its index, 1.
        """
        last = len(self.rates) - 1
        # a frame that rounds to just before a landing is at the landing
        step = np.searchsorted(self.starts, times + 1e-9, side="right") - 1
        step = np.clip(step, 0, last)
        length = np.diff(self.starts)[step]
        return step, np.clip((times - self.starts[step]) / length, 0.0, 1.0)

    def walk_phase(self, times: Float[np.ndarray, "F"]) -> Float[np.ndarray, "F"]:
        """Index of the step plus the eased phase within it."""
        step, u = self.position(times)
        first, last = self.rates[step, 0], self.rates[step, 1]
        v = 1.0 - u
        phase = u * u * (3.0 - 2.0 * u) + u * v * (v * first - u * last)
        even = (first == 1.0) & (last == 1.0)
        out = step + np.where(even, u, phase)
        # in the rest the walk stays at the very end, where both feet stand
        out = np.where(times >= self.starts[-1] - 1e-9, float(len(self.rates)), out)
        return out
