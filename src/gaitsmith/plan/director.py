"""Actions become steps: walks, local steps and turns, one after the other."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gaitsmith.errors import InfeasibleError
from gaitsmith.plan.arrive import be_at
from gaitsmith.plan.draft import Draft
from gaitsmith.plan.local import step, turn
from gaitsmith.plan.manners import Manners
from gaitsmith.plan.script import (
    Action,
    Face,
    Follow,
    Lean,
    LookAt,
    Stand,
    Step,
    Turn,
    WalkTo,
)
from gaitsmith.plan.start import Start
from gaitsmith.plan.walking import walk_on
from gaitsmith.plan.ways import wrapped

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gaitsmith.plan.timeline import Timeline

#: Seconds that a lean and a last look take.
LEAN_SECONDS, LOOK_SECONDS = 0.9, 0.8


def direct(actions: Sequence[Action], manners: Manners, start: Start | None = None) -> Timeline:
    """Steps of ``actions`` from ``start``; None: from standing at 0,0 facing 0.

    Raises
    ------
    InfeasibleError
        Naming the action that cannot be done, and why.
    """
    draft = Draft.standing(manners, start or Start())
    i = 0
    while i < len(actions):
        group = [actions[i]]
        while isinstance(group[0], WalkTo | Follow) and i + len(group) < len(actions):
            following = actions[i + len(group)]
            if not isinstance(following, WalkTo | Follow):
                break
            group.append(following)
        after = actions[i + len(group)] if i + len(group) < len(actions) else None
        try:
            _do(draft, group, after)
        except InfeasibleError as error:
            named = f"action {i + 1} ({type(group[0]).__name__})"
            raise InfeasibleError(f"{named}: {error}") from None
        i += len(group)
    return draft.timeline()


def _do(draft: Draft, group: Sequence[Action], after: Action | None) -> None:
    """Plan one action, or walks that go on without a stop."""
    action = group[0]
    if isinstance(action, WalkTo | Follow):
        walk_on(draft, group)  # type: ignore[arg-type]
    elif isinstance(action, Step):
        step(draft, action)
    elif isinstance(action, Turn | Face):
        angle = action.angle if isinstance(action, Turn) else wrapped(action.heading - draft.facing)
        turn(draft, angle, walks_on=isinstance(after, WalkTo | Follow))
    elif isinstance(action, Stand):
        draft.stand(action.seconds)
    elif isinstance(action, LookAt):
        draft.looks.append((draft.clock, action.point))
        if after is None:
            draft.stand(LOOK_SECONDS)
    elif isinstance(action, Lean):
        sign = {"forward": (1, 0), "back": (-1, 0), "left": (0, 1), "right": (0, -1)}
        pitch, roll = (s * action.angle for s in sign[action.way])
        draft.leans.append((draft.clock, draft.clock + LEAN_SECONDS, pitch, roll))
        draft.stand(LEAN_SECONDS)
    else:
        be_at(draft, action)


__all__ = ["Manners", "direct"]
