"""Walks and local steps in one motion: each by its own generator."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gaitsmith.conventions import LOCAL_KINDS
from gaitsmith.synthesis.step import PreparedStep, StepGenerator, WalkerState

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gaitsmith.body.body import Body
    from gaitsmith.plan.footsteps import PlannedStep
    from gaitsmith.synthesis.curved import CurvedGenerator


class MixedGenerator:
    """Walks by one generator, local steps by another, in any order."""

    def __init__(self, walking: CurvedGenerator, local: StepGenerator) -> None:
        self._walking, self._local = walking, local

    def prepare(self, body: Body, state: WalkerState, step: PlannedStep) -> PreparedStep:
        """See :meth:`gaitsmith.synthesis.step.StepGenerator.prepare`."""
        if step.kind in LOCAL_KINDS:
            return self._local.prepare(body, state, step)
        return self._walking.prepare(body, state, step)

    def prepare_all(
        self, body: Body, state: WalkerState, steps: Sequence[PlannedStep]
    ) -> list[PreparedStep]:
        """Each walk as a whole, from standing to standing; each local step from the last."""
        out: list[PreparedStep] = []
        i = 0
        while i < len(steps):
            if steps[i].kind in LOCAL_KINDS:
                done = [self._local.prepare(body, state, steps[i])]
            else:
                j = i + 1
                while j < len(steps) and steps[j].kind not in (*LOCAL_KINDS, "start"):
                    j += 1
                done = self._walking.prepare_all(body, WalkerState(), steps[i:j])
            out += done
            i += len(done)
            state = done[-1].end if steps[i - 1].kind in LOCAL_KINDS else WalkerState()
        return out
