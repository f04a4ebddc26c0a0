"""Walks and local steps in one motion: each by its own generator."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gaitsmith.conventions import LOCAL_KINDS
from gaitsmith.synthesis.step import PreparedStep, StepGenerator, WalkerState

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from gaitsmith.body.body import Body
    from gaitsmith.plan.footsteps import PlannedStep
    from gaitsmith.synthesis.curved import CurvedGenerator


class MixedGenerator:
    """Walks by one generator, local steps by another, in any order.

    ``gaits`` are generators of walks in other gaits, by the names that steps have.
    """

    def __init__(
        self,
        walking: CurvedGenerator,
        local: StepGenerator,
        gaits: Mapping[str, CurvedGenerator] | None = None,
    ) -> None:
        self._walking, self._local = walking, local
        self._gaits = gaits or {}

    def _of(self, step: PlannedStep) -> CurvedGenerator:
        return self._walking if step.gait is None else self._gaits[step.gait]

    def prepare(self, body: Body, state: WalkerState, step: PlannedStep) -> PreparedStep:
        """See :meth:`gaitsmith.synthesis.step.StepGenerator.prepare`."""
        if step.kind in LOCAL_KINDS:
            return self._local.prepare(body, state, step)
        return self._of(step).prepare(body, state, step)

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
                done = self._of(steps[i]).prepare_all(body, WalkerState(), steps[i:j])
            out += done
            i += len(done)
            state = done[-1].end if steps[i - 1].kind in LOCAL_KINDS else WalkerState()
        return out
