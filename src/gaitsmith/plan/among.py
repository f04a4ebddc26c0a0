"""Walk round what stands there, in walks of a script and on the way to ``be at``."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.plan.along import walk_path
from gaitsmith.plan.local import turn
from gaitsmith.plan.routes import path_among
from gaitsmith.plan.ways import Route, wrapped

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.plan.draft import Draft
    from gaitsmith.plan.script import Tempo

    #: Ways one after the other: points, whether they make one curve, and how fast.
    Run = list[tuple[list[Float[np.ndarray, "2"]], bool, Tempo | None]]

#: A walk that leads farther aside than this from where the person faces begins with a turn.
TURN_FIRST = float(np.radians(35.0))


def walk_among(draft: Draft, run: Run) -> None:
    """Walk ``run`` past everything in the surroundings of the person.

    Raises
    ------
    InfeasibleError
        If there is no way; it says why, and how near one can get.
    """
    routes, ways = draft.manners.routes, [(way, soft) for way, soft, _ in run]
    path = path_among(routes, draft.middle, ways)
    if path is None:  # no one way past what stands around: from point to point
        for leg in run:
            walk_among(draft, [leg])
        return
    aside = wrapped(float(path.heading[0]) - draft.facing)
    if abs(aside) > TURN_FIRST:
        turn(draft, aside, walks_on=True)
        path = path_among(routes, draft.middle, ways) or path
    walk_path(draft, path, *Route.of(draft.middle, run).legs())
