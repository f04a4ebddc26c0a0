"""The upper body of several Cycles of one style, each where its step length is walked."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.geometry.rotations import exp, log, slerp
from gaitsmith.synthesis.cycle_overlay import CycleOverlay
from gaitsmith.synthesis.overlay import Samples

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.gait.cycle import Cycle
    from gaitsmith.synthesis.overlay import Overlay
    from gaitsmith.walks.model import SagittalStep, StepRequest


class CyclesOverlay:
    """Lays the upper bodies of ``cycles`` over the steps of any walk.

    A step as long as that of a cycle shows that one; between two both are generalized to it, as
    :class:`CycleOverlay` does, and blended; beyond them the nearest serves.

    Parameters
    ----------
    cycles
        Of one person at different step lengths, the usual one first.
    leg_length
        Thigh and shin of who was measured, meters.
    """

    def __init__(self, cycles: Sequence[Cycle], leg_length: float) -> None:
        self.strides = max(cycle.strides for cycle in cycles)
        self.cycle = cycles[0]
        self._usual = CycleOverlay(cycles[0], leg_length)
        ratios = [0.5 * cycle.stride_length / leg_length for cycle in cycles]
        order = np.argsort(ratios, kind="stable")
        self._ratios = np.array(ratios)[order]
        self._each = [
            self._usual if i == 0 else CycleOverlay(cycles[i], leg_length) for i in order.tolist()
        ]

    def __call__(self, body: Body, request: StepRequest, step: SagittalStep) -> Overlay:
        """See :class:`gaitsmith.synthesis.overlay.Overlayer`."""
        return self.many(body, [request], [step])[0]

    def many(
        self, body: Body, requests: Sequence[StepRequest], steps: Sequence[SagittalStep]
    ) -> list[Overlay]:
        """See :class:`gaitsmith.synthesis.overlay.BatchOverlayer`."""
        samples = Samples.of(requests, steps)
        place = self._places(body, requests, samples)
        below = np.floor(place).astype(np.int64)
        above = np.ceil(place).astype(np.int64)
        shown = {
            level: self._each[level].laid(body, requests, samples)
            for level in np.unique([below, above]).tolist()
        }
        if len(shown) == 1:
            sway, pelvis, upper = shown.popitem()[1]
            return samples.split(sway, log(pelvis), upper)
        sway, pelvis, upper = (np.empty_like(v) for v in next(iter(shown.values())))
        for level in np.unique(below).tolist():
            own = below == level
            one, two = shown[level], shown[int(above[own].max())]
            share = place[own] - level
            sway[own] = one[0][own] + share * (two[0][own] - one[0][own])
            pelvis[own] = slerp(one[1][own], two[1][own], share)
            upper[own] = log(slerp(exp(one[2][own]), exp(two[2][own]), share[:, None]))
        return samples.split(sway, log(pelvis), upper)

    def arms_middle(self, body: Body) -> Float[np.ndarray, "U 3"]:
        """See :class:`gaitsmith.synthesis.overlay.ArmedOverlayer`."""
        return self._usual.arms_middle(body)

    def _places(
        self, body: Body, requests: Sequence[StepRequest], samples: Samples
    ) -> Float[np.ndarray, "M"]:
        """Where each sample is among the cycles, from that of the step before to that of its own.

        Starts and stops are as the step at their other end: who stands has no length.
        """
        first, last = samples.lengths(requests)
        first, last = (
            np.where(samples.starts, last, first),
            np.where(samples.stops, first, last),
        )
        levels = np.arange(len(self._each), dtype=np.float64)
        begin, end = (np.interp(v / body.leg_length, self._ratios, levels) for v in (first, last))
        return begin + (end - begin) * samples.eased
