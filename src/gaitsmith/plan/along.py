"""Walk along one path from where the person stands, to standing at its end."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from gaitsmith.conventions import LEFT, RIGHT
from gaitsmith.plan.draft import BEFORE_WALK
from gaitsmith.plan.follow import follow
from gaitsmith.plan.legs import legs_of
from gaitsmith.plan.manners import gait_of
from gaitsmith.plan.ways import from_feet, leads

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from jaxtyping import Float

    from gaitsmith.plan.draft import Draft
    from gaitsmith.plan.paths import Path
    from gaitsmith.plan.script import Tempo


def walk_path(
    draft: Draft,
    path: Path,
    ends: Sequence[Float[np.ndarray, "2"]] = (),
    tempi: Sequence[Tempo | None] = (None,),
) -> None:
    """Walk ``path``, which begins where the person stands, to standing at its end.

    The foot that stands behind steps first. ``ends`` are the points of the path up to which each
    of ``tempi`` is kept; they name one gait.
    """
    gait = gait_of(tempi[0])
    manners = draft.manners.in_gait(gait)
    lead = leads(draft.feet, path)
    first = RIGHT if lead[RIGHT] <= lead[LEFT] + 0.01 else LEFT
    last = draft.planned[-1] if draft.planned else None
    walked = last is not None and last.kind == "stop" and last.target.side != first
    if last is not None and last.kind != "stand" and not walked:
        draft.stand(BEFORE_WALK)
    paces, legs = [manners.pace_at(tempo) for tempo in tempi], None
    pace = paces[0]
    if any(other != pace for other in paces):
        pace, legs = legs_of(path, ends, paces)
    plan = follow(
        path,
        pace=pace,
        stance=manners.stance,
        ground=manners.ground,
        body=manners.body,
        outside=manners.outside,
        keep_cadence=all(manners.keeps(tempo) for tempo in tempi),
        keep_length=all(manners.keeps_length(tempo) for tempo in tempi),
        rhythm=manners.rhythm,
        stature=manners.body.height,
        first=first,
        legs=legs,
    )
    plan = from_feet(plan, draft.feet, path, draft.facing)
    for step in plan.steps():
        draft.add(replace(step, gait=gait))
    assert plan.path is not None
    draft.paths.append(plan.path)
    draft.facing = draft.gaze = float(plan.direction[-1])
    for foot in plan.footsteps()[-2:]:
        draft.feet[foot.side] = foot
