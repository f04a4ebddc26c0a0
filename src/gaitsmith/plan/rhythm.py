"""What makes steps unequal: a person's left and right, and natural variation.

Measured variation from step to step has two parts (Collins & Kuo 2013, 14 young adults
overground): speed drifts slowly, by 2.3 % of itself, and step length goes with it; step width
varies at once and independently of speed. It is not white noise on the step length.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith._checks import number, positive
from gaitsmith.errors import InvalidInputError

if TYPE_CHECKING:
    from jaxtyping import Bool, Float, Int

#: Coefficient of variation of the slow drift of speed, and of what is left of the step length.
DRIFT, RESIDUAL = 0.023, 0.015
#: Steps over which the drift forgets itself: stride times are correlated over tens of strides
#: (Hausdorff 1995).
MEMORY = 12.0
#: Powers of speed that step length and step time have (Grieve 1968).
LENGTH_POWER, TIME_POWER = 0.42, -0.58
#: Standard deviation of the step width of young adults, over stature: 24 mm (Almarwani 2016).
WIDTH = 0.0137
#: Standard deviations beyond which no step is drawn; most variation that can be asked for.
LARGEST, MOST = 2.5, 2.0
#: Share by which one side's step may differ from the mean.
UNEVEN = 0.45


@dataclass(frozen=True)
class Rhythm:
    """How steps differ from each other.

    Attributes
    ----------
    lengths, durations
        Of the steps that land the [left, right] foot, over the mean; each pair adds up to 2.
    variation
        0: none; 1: as people vary.
    seed
        Of the variation.
    """

    lengths: tuple[float, float] = (1.0, 1.0)
    durations: tuple[float, float] = (1.0, 1.0)
    variation: float = 0.0
    seed: int = 0

    def __post_init__(self) -> None:
        """Check ranges."""
        for name in ("lengths", "durations"):
            pair = tuple(positive(name, v, "the mean") for v in getattr(self, name))
            if len(pair) != 2 or abs(sum(pair) - 2.0) > 1e-6 or abs(pair[0] - 1.0) > UNEVEN:
                raise InvalidInputError(
                    f"{name} of [left, right] must add up to 2, each within {UNEVEN:g} of 1, got "
                    f"{getattr(self, name)!r}"
                )
            object.__setattr__(self, name, pair)
        if not 0.0 <= number("variation", self.variation, "1") <= MOST:
            raise InvalidInputError(
                f"variation must be from 0 (none) to {MOST:g}, 1 as people, got {self.variation!r}"
            )

    @property
    def even(self) -> bool:
        """Whether all steps are alike."""
        return self.variation == 0.0 and self.lengths == self.durations == (1.0, 1.0)

    def factors(
        self, side: Int[np.ndarray, "S"], free: Bool[np.ndarray, "S"]
    ) -> tuple[Float[np.ndarray, "S"], Float[np.ndarray, "S"]]:
        """Lengths and durations of steps over what they would be, 1 where not ``free``.

        ``side`` is that of the foot that lands.
        """
        length = np.array(self.lengths)[side]
        duration = np.array(self.durations)[side]
        if self.variation:
            drift, own, _ = self._drawn(len(side))
            length = length * (1.0 + LENGTH_POWER * DRIFT * drift + RESIDUAL * own)
            duration = duration * (1.0 + TIME_POWER * DRIFT * drift)
        return np.where(free, length, 1.0), np.where(free, duration, 1.0)

    def aside(self, count: int, stature: float) -> Float[np.ndarray, "N"]:
        """Meters that each of ``count`` footsteps is set farther out (or in) than usual."""
        if not self.variation:
            return np.zeros(count)
        # the width of a step is the sum of what both its feet are off by
        return self._drawn(count)[2] * (WIDTH * stature / np.sqrt(2.0))

    def _drawn(self, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Drift, residual of length and of width, in standard deviations times the variation."""
        normal = np.random.default_rng(self.seed).normal(size=(3, count))
        normal = np.clip(normal, -LARGEST, LARGEST)
        keep = float(np.exp(-1.0 / MEMORY))
        drift = np.empty(count)
        level = 0.0
        for i, shock in enumerate(normal[0]):  # a recurrence over steps, not frames
            level = keep * level + np.sqrt(1.0 - keep**2) * float(shock)
            drift[i] = level
        return tuple(self.variation * v for v in (drift, normal[1], normal[2]))  # type: ignore[return-value]
