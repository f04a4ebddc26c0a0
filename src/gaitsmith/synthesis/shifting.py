"""Hips moved and the pelvis tilted before the feet are put on the ground, so that legs follow."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import UP, ahead, leftward
from gaitsmith.geometry.rotations import about, exp, log, multiply

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from jaxtyping import Float

    from gaitsmith.contact import ReferenceStep
    from gaitsmith.synthesis.clock import Clock

    #: Of times (s): shift of the hips to the left, up and ahead, ``(n, 3)`` meters, and forward
    #: tilt of the pelvis about its own axis, ``(n,)`` radians.
    Shift = Callable[
        [Float[np.ndarray, "n"]], tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, "n"]]
    ]

#: Instants a second on which phases are turned into times.
FINE = 480.0


def shifted(steps: Sequence[ReferenceStep], clock: Clock, shift: Shift) -> list[ReferenceStep]:
    """The same steps with hips and pelvis moved by ``shift``.

    The pelvis tilts about the line of the hips, which moves neither hip joint.
    """
    end = float(clock.starts[-1])
    times = np.linspace(0.0, end, int(np.ceil(end * FINE)) + 1)
    phases = np.maximum.accumulate(clock.walk_phase(times))
    out = []
    for i, step in enumerate(steps):
        curves = step.curves
        offset, tilt = shift(np.interp(i + curves.phase, phases, times))
        if not (offset.any() or tilt.any()):
            out.append(step)
            continue
        way = (leftward(curves.heading), np.broadcast_to(UP, offset.shape), ahead(curves.heading))
        moved = sum(offset[:, k : k + 1] * way[k] for k in range(3))
        pelvis = log(multiply(exp(curves.pelvis), about("x", tilt)))
        out.append(step.with_(curves=curves.with_(center=curves.center + moved, pelvis=pelvis)))
    return out
