"""Where a foot lands on a ground: the step as long as the ground asks for, [SM01] section 6.2."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.ground import Flat, foot_plane
from gaitsmith.ground.nearness import edges_near
from gaitsmith.plan.footholds import (
    CROWDED,
    FULL_RISE,
    GRID,
    HANGING,
    HIGHEST,
    LONGER,
    LONGEST,
    MOST_HANGING,
    MOST_SUNK,
    ON_RIDGES,
    RISE,
    SHORT_TREADS,
    SHORTEST,
    SLOWER_DOWN,
    SLOWER_UP,
    STEEPEST,
)
from gaitsmith.plan.footing import footing
from gaitsmith.plan.slopes import speed_share, step_length_share

if TYPE_CHECKING:
    from collections.abc import Callable

    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.conventions import StepKind
    from gaitsmith.ground import Ground


#: Rounds of the search and the change of length (m) at which it ends; half of each change is
#: taken: at an edge the whole would go back and forth.
ROUNDS, ENOUGH, DAMPED = 6, 1e-4, 0.5
#: Steps on the spot before what is in the way, over the step that was wished.
NEARLY_NONE = 0.1
#: Grid of places on stepped ground, over the longest step: lengths are tried in parts of it.
COARSE = 0.02


@dataclass(frozen=True, eq=False)
class Landing:
    """A foot where it stands or will stand, and the step that sets it there.

    Attributes
    ----------
    kind
        Of that step; ``"stand"`` for feet that nobody set.
    side, position, heading
        0 left, 1 right; ``(3,)`` N; of the foot, radians.
    line, direction, way
        ``(2,)`` x,z of the walk's line beside it; direction of that line here; direction of the
        chord that led here, radians.
    middle, lean, gaze
        As in :class:`~gaitsmith.plan.footsteps.Footstep`; the gaze is beyond ``direction``.
    length, duration, period
        Of the step, meters and seconds; seconds it would take in mid-walk.
    along
        Arc length of the path beside it, meters.
    closes
        The other foot is to be set beside it.
    """

    kind: StepKind
    side: int
    position: Float[np.ndarray, "3"]
    heading: float
    line: Float[np.ndarray, "2"]
    direction: float
    way: float
    middle: Float[np.ndarray, "2"]
    lean: float = 0.0
    gaze: float = 0.0
    length: float = 0.0
    duration: float = 0.0
    period: float = 0.0
    along: float = 0.0
    turn: float = 0.0
    closes: bool = False

    @property
    def stands(self) -> bool:
        """Whether both feet stand once it has landed."""
        return self.kind in ("stand", "stop")


class LandingSearch:
    """Finds how long a step is that lands on ``ground``, and how high."""

    def __init__(self, body: Body, ground: Ground) -> None:
        self._body, self._ground = body, ground

    def placed(self, place: Float[np.ndarray, "2"], heading: float) -> Float[np.ndarray, "3"]:
        """N of a foot that stands over x,z ``place``."""
        if isinstance(self._ground, Flat):
            height = float(self._ground.height(place[:1], place[1:])[0])
        else:
            foot = self._body.foot
            plane = foot_plane(
                self._ground, place[None], np.array([heading]), heel=foot.heel, ball=foot.ball
            )
            height = float(plane.position[0, 1])
        return np.array([place[0], height, place[1]])

    def stands(self, place: Float[np.ndarray, "2"], heading: float, before: float) -> bool:
        """Whether a foot can stand there, a step from height ``before``."""
        if isinstance(self._ground, Flat):
            return True
        return bool(self._fits(place[None], np.array([heading]), before)[1][0])

    def find(
        self,
        landing: Callable[[float], Landing],
        length: float,
        before: float,
        *,
        keep_length: bool = False,
    ) -> tuple[Landing, float] | None:
        """The footstep of the step that the ground allows, and how much longer it takes.

        Parameters
        ----------
        landing
            The footstep of a step of some length, at any height.
        length
            Of the step on level ground, meters.
        before
            Height of the foot that bears.
        keep_length
            Slopes do not shorten it.

        Returns
        -------
        None where nothing is to stand on.
        """
        if isinstance(self._ground, Flat):
            foot = landing(length)
            return self._on_ground(foot), 1.0
        if not self._jumps(landing(length).position[[0, 2]]):
            found = self._on_slope(landing, length, before, keep_length=keep_length)
            if found is not None:
                return found
        return self._among(landing, length, before)

    def _jumps(self, place: Float[np.ndarray, "2"]) -> bool:
        """Whether the ground jumps anywhere near a step to ``place``."""
        if not self._ground.stepped:
            return False
        x, z = place.tolist()
        return len(edges_near(self._ground, x, z, self._body.leg_length)) > 0

    def _on_ground(self, foot: Landing) -> Landing:
        position = self.placed(foot.position[[0, 2]], foot.heading)
        return replace(foot, position=position)

    def _on_slope(
        self, landing: Callable[[float], Landing], level: float, before: float, *, keep_length: bool
    ) -> tuple[Landing, float] | None:
        """[SM01] section 6.2: height where the foot would land, length for that height, again."""
        length = level
        foot, share, slope = None, 1.0, 0.0
        for _ in range(ROUNDS):
            foot = self._on_ground(landing(length))
            slope = (float(foot.position[1]) - before) / max(length, 0.05)
            if keep_length:
                break
            share = float(step_length_share(np.array(slope)))
            change = DAMPED * (level * share - length)
            if abs(change) < ENOUGH:
                break
            length += change
        assert foot is not None
        if not self.stands(foot.position[[0, 2]], foot.heading, before):
            return None
        slower = share / float(speed_share(np.array(slope)))
        return foot, slower

    def _among(
        self, landing: Callable[[float], Landing], level: float, before: float
    ) -> tuple[Landing, float] | None:
        """The best of many lengths: near the level one, the sole borne, no needless rise."""
        leg = self._body.leg_length
        part = max(GRID, COARSE * leg)
        lengths = np.arange(min(SHORTEST * leg, NEARLY_NONE * level), LONGEST * leg, part)
        lengths = np.append(lengths[np.abs(lengths - level) > 0.25 * part], level)
        # the line is nearly straight over one step: places from two of them
        ends = [landing(float(lengths[i])) for i in (0, -2)]
        share = (lengths - lengths[0]) / (lengths[-2] - lengths[0])
        place, heading = (
            ends[0].position[[0, 2]]
            + share[:, None] * (ends[1].position - ends[0].position)[[0, 2]],
            ends[0].heading + share * (ends[1].heading - ends[0].heading),
        )
        cost, good = self._fits(place, heading, before)
        off = lengths / max(level, 1e-6) - 1.0
        cost = cost + off**2 * np.where(off > 0.0, LONGER, 1.0)
        for i in np.argsort(np.where(good, cost, np.inf), kind="stable")[:6]:
            if not good[i]:
                break
            foot = self._on_ground(landing(float(lengths[i])))
            if not self.stands(foot.position[[0, 2]], foot.heading, before):
                continue
            rise = (float(foot.position[1]) - before) / (FULL_RISE * leg)
            slower = SLOWER_UP * min(max(rise, 0.0), 1.0) + SLOWER_DOWN * min(max(-rise, 0.0), 1.0)
            return foot, 1.0 + slower
        return None

    def _fits(
        self, place: Float[np.ndarray, "n 2"], heading: Float[np.ndarray, "n"], before: float
    ) -> tuple[Float[np.ndarray, "n"], np.ndarray]:
        """What standing there costs, and whether it is possible at all."""
        leg = self._body.leg_length
        found = footing(self._ground, place, heading, self._body.foot)
        rise = (found.height - before) / leg
        good = found.stands & (found.slope < np.tan(STEEPEST)) & (np.abs(rise) < HIGHEST)
        good &= found.hangs <= SHORT_TREADS
        good &= found.sinks < ON_RIDGES
        cost = RISE * rise**2 if self._ground.stepped else np.zeros(len(place))
        cost = cost + HANGING * found.hangs + CROWDED * found.crowded
        cost = cost + np.where(found.hangs > MOST_HANGING, 1e3, 0.0)
        cost = cost + np.where(found.sinks > MOST_SUNK, 1e2, 0.0)
        return cost, good
