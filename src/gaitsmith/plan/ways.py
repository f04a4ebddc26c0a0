"""Ways and goals of a director: points on the way, and where ``be at`` sets the feet."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import LEFT, RIGHT, SIDE_SIGN, ahead, leftward
from gaitsmith.errors import InfeasibleError
from gaitsmith.plan.paths import Path

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from jaxtyping import Float

    from gaitsmith.plan.footsteps import Footstep, StepPlan
    from gaitsmith.plan.lengths import Stance
    from gaitsmith.plan.script import BeAt, Tempo

    Way = list[Float[np.ndarray, "2"]]

#: Straight legs of a walk bend only so far from their ends, meters.
CORNER = 0.8
#: Ways shorter than this are none, meters.
NO_WAY = 1e-6


def goals_of(
    action: BeAt, facing: float, stance: Stance
) -> dict[int, tuple[Float[np.ndarray, "2"], float]]:
    """x, z and heading of both feet at the end of ``be at``."""
    if action.feet is not None:
        return {s: (np.array(action.feet[s][:2]), action.feet[s][2]) for s in (LEFT, RIGHT)}
    heading = facing if action.heading is None else action.heading
    left = leftward(heading)[[0, 2]]
    half, toe_out = 0.5 * stance.width, np.array(stance.toe_out)
    mean = 0.5 * float(toe_out[0] - toe_out[1])
    return {
        s: (
            np.array(action.point) + half * SIDE_SIGN[s] * left,
            heading + float(SIDE_SIGN[s] * toe_out[s]) - mean,
        )
        for s in (LEFT, RIGHT)
    }


@dataclass(frozen=True, eq=False)
class Route:
    """Points to walk through and the tempo of the way to each but the first."""

    points: Float[np.ndarray, "n 2"]
    tempi: tuple[Tempo | None, ...]

    @staticmethod
    def of(here: Float[np.ndarray, "2"], run: Sequence[tuple[Way, bool, Tempo | None]]) -> Route:
        """All ways one after the other; straight ones (not soft) bend near their ends only."""
        points, tempi = [here], []
        last = len(run) - 1
        for i, (way, soft, tempo) in enumerate(run):
            more = list(way)
            gap = way[0] - points[-1]
            size = float(np.linalg.norm(gap))
            if not soft and last > 0 and size > 2.5 * CORNER:
                unit = gap / size
                before = [points[-1] + CORNER * unit] if i > 0 else []
                more = [*before, *([way[0] - CORNER * unit] if i < last else []), *way]
            for point in more:
                if np.linalg.norm(point - points[-1]) > NO_WAY:
                    points.append(point)
                    tempi.append(tempo)
        if len(points) < 2:
            raise InfeasibleError("there is no way to walk: it begins where it ends")
        return Route(np.array(points), tuple(tempi))

    def starting(self, here: Float[np.ndarray, "2"]) -> Route:
        """The same from ``here``."""
        return replace(self, points=np.concatenate([here[None], self.points[1:]]))

    def cut(self, at: int) -> tuple[Route, Route]:
        """The way to a point, and from there on."""
        return (
            Route(self.points[: at + 1], self.tempi[:at]),
            Route(self.points[at:], self.tempi[at:]),
        )

    def path(self) -> Path:
        """The smooth curve through the points."""
        return Path.through(self.points)

    def legs(self) -> tuple[list[Float[np.ndarray, "2"]], list[Tempo | None]]:
        """Where the way at each tempo ends, and the tempi."""
        ends, tempi = [], []
        for point, tempo in zip(self.points[1:], self.tempi, strict=True):
            if tempi and tempi[-1] == tempo:
                ends[-1] = point
            else:
                ends.append(point)
                tempi.append(tempo)
        return ends, tempi


def path_through(here: Float[np.ndarray, "2"], run: Sequence[tuple[Way, bool]]) -> Path:
    """One path through the points of all ways."""
    return Route.of(here, [(way, soft, None) for way, soft in run]).path()


def leads(feet: Mapping[int, Footstep], path: Path) -> dict[int, float]:
    """How far each foot stands ahead of the beginning of ``path``, meters."""
    way = ahead(float(path.heading[0]))
    return {s: float((f.position - on_floor(path.points[0])) @ way) for s, f in feet.items()}


def from_feet(plan: StepPlan, feet: Mapping[int, Footstep], path: Path, facing: float) -> StepPlan:
    """``plan`` along ``path`` beginning with the feet where they stand, the body ``facing`` on."""
    way, lead = ahead(float(path.heading[0]))[[0, 2]], leads(feet, path)
    whole = 2.0 * np.pi * np.round((facing - plan.direction[0]) / (2.0 * np.pi))
    position, heading = np.array(plan.position), plan.heading + whole
    assert plan.middle is not None
    assert plan.gaze is not None
    middle, gaze = np.array(plan.middle), np.array(plan.gaze)
    for i in (0, 1):
        foot = feet[int(plan.side[i])]
        position[i], heading[i] = foot.position, foot.heading
        middle[i] = path.points[0] + lead[foot.side] * way
    gaze[:2] = 0.0
    return replace(
        plan,
        position=position,
        heading=heading,
        direction=plan.direction + whole,
        middle=middle,
        gaze=gaze,
    )


def on_floor(place: Float[np.ndarray, "2"]) -> Float[np.ndarray, "3"]:
    """x, 0, z of x, z."""
    return np.array([place[0], 0.0, place[1]])


def wrapped(angle: float) -> float:
    """Within -180..180 deg; half a turn is to the left."""
    turned = float(np.arctan2(np.sin(angle), np.cos(angle)))
    return np.pi if turned <= -np.pi + 1e-12 else turned
