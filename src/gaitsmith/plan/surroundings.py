"""What stands around the people of a scene: obstacles to walk round, bars and posts to dodge."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from gaitsmith._checks import number
from gaitsmith.errors import InvalidInputError
from gaitsmith.geometry.solids import segments_apart

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from jaxtyping import Float

Point = tuple[float, float]


@dataclass(frozen=True)
class Obstacle:
    """A solid whose outline on the floor is a simple polygon; nobody walks through it.

    Attributes
    ----------
    points
        x,z of its corners, meters, in either order, three or more.
    name
        What errors call it.
    """

    points: tuple[Point, ...]
    name: str = "obstacle"


@dataclass(frozen=True)
class Bar:
    """A level round bar overhead, which people duck under.

    Attributes
    ----------
    begin, end
        x,z of its ends, meters.
    height
        Of its underside, meters.
    radius
        Meters.
    name
        What errors call it.
    """

    begin: Point
    end: Point
    height: float
    radius: float = 0.02
    name: str = "bar"


@dataclass(frozen=True)
class Post:
    """An upright round post beside the way, which people lean past.

    Attributes
    ----------
    at
        x,z of its axis, meters.
    radius
        Meters.
    bottom, top
        From which height to which it is there, meters: one that hangs leaves the feet free.
    name
        What errors call it.
    """

    at: Point
    radius: float = 0.05
    bottom: float = 0.0
    top: float = 3.0
    name: str = "post"


@dataclass(frozen=True)
class Surroundings:
    """All that stands around; empty: free ground."""

    obstacles: tuple[Obstacle, ...] = ()
    bars: tuple[Bar, ...] = ()
    posts: tuple[Post, ...] = ()

    @property
    def empty(self) -> bool:
        """Whether nothing stands around."""
        return not (self.obstacles or self.bars or self.posts)

    @staticmethod
    def read(given: Surroundings | Mapping[str, Any] | None) -> Surroundings:
        """See :func:`read_surroundings`."""
        return Surroundings() if given is None else read_surroundings(given)

    def as_dict(self) -> dict[str, Any]:
        """For recipes: what :func:`read_surroundings` takes."""
        return {kind: [asdict(one) for one in getattr(self, kind)] for kind in _KINDS}


_KINDS: dict[str, type] = {"obstacles": Obstacle, "bars": Bar, "posts": Post}
#: Farthest coordinate and height, meters; most corners of one outline, most of a kind.
FARTHEST, MOST_CORNERS, MOST = 2000.0, 1000, 1000
#: Outlines smaller than this (square meters) and things thinner (meters) are none.
SMALLEST, THINNEST = 1e-6, 1e-4


def read_surroundings(given: Surroundings | Mapping[str, Any] | None) -> Surroundings:
    """Surroundings from themselves or from :meth:`Surroundings.as_dict`, checked.

    Raises
    ------
    InvalidInputError
        Naming the thing, the rule it breaks and the value.
    """
    if given is None:
        return Surroundings()
    if not isinstance(given, Surroundings):
        given = _of_mapping(given)
    obstacles, bars, posts = (
        _named(given, "obstacles", _obstacle),
        _named(given, "bars", _bar),
        _named(given, "posts", _post),
    )
    return Surroundings(obstacles, bars, posts)


def _of_mapping(given: Mapping[str, Any]) -> Surroundings:
    try:
        unknown = sorted(set(given) - set(_KINDS))
        if unknown:
            raise InvalidInputError(
                f"surroundings are obstacles, bars and posts, not {unknown[0]!r}"
            )
        parts = {
            kind: tuple(
                one if isinstance(one, made) else made(**one) for one in given.get(kind, ())
            )
            for kind, made in _KINDS.items()
        }
    except TypeError as error:
        raise InvalidInputError(f"not the surroundings of a walk: {error}") from None
    return Surroundings(**parts)


def _named(given: Surroundings, kind: str, check: Callable[[Any], Any]) -> tuple[Any, ...]:
    """All of a kind, checked; those that share a name get a number."""
    found = getattr(given, kind)
    if len(found) > MOST:
        raise InvalidInputError(f"there may be {MOST} {kind}, got {len(found)}")
    out, seen = [], set[str]()
    for i, one in enumerate(found, start=1):
        if not isinstance(one, _KINDS[kind]):
            raise InvalidInputError(f"{kind} must be {_KINDS[kind].__name__}s, got {one!r}")
        name = one.name
        if not isinstance(name, str) or not name:
            raise InvalidInputError(f"the name of {kind} {i} must be text, got {name!r}")
        if name in seen:
            name = f"{name} {i}"
        seen.add(name)
        out.append(check(replace(one, name=name)))
    return tuple(out)


def _obstacle(one: Obstacle) -> Obstacle:
    try:
        points = tuple((float(x), float(z)) for x, z in one.points)
    except (TypeError, ValueError):
        raise InvalidInputError(
            f"the corners of {one.name!r} must be points x,z, got {one.points!r}"
        ) from None
    for i, (x, z) in enumerate(points, start=1):
        _within(f"corner {i} of {one.name!r}", x, z)
    if len(points) > 1 and points[0] == points[-1]:
        points = points[:-1]
    if not 3 <= len(points) <= MOST_CORNERS:
        raise InvalidInputError(
            f"the outline of {one.name!r} needs 3 to {MOST_CORNERS} corners, got {len(points)}"
        )
    corners = np.array(points)
    following = np.roll(corners, -1, axis=0)
    area = 0.5 * float((corners[:, 0] * following[:, 1] - corners[:, 1] * following[:, 0]).sum())
    same = np.flatnonzero(np.abs(corners - following).max(axis=1) < THINNEST)
    if same.size:
        x, z = points[int(same[0])]
        raise InvalidInputError(
            f"the outline of {one.name!r} has the corner ({x:g}, {z:g}) twice; remove one"
        )
    crossing = _crossing(corners)
    if crossing is not None:
        raise InvalidInputError(
            f"the outline of {one.name!r} crosses itself: its sides after corners {crossing[0]} "
            f"and {crossing[1]} meet; give the corners in order around it"
        )
    if abs(area) < SMALLEST:
        raise InvalidInputError(f"the outline of {one.name!r} encloses nothing; it is a line")
    return Obstacle(points, one.name)


def _crossing(corners: Float[np.ndarray, "n 2"]) -> tuple[int, int] | None:
    """Two sides of a polygon that meet without being neighbors, counted from 1."""
    begin, end = corners, np.roll(corners, -1, axis=0)
    count = len(corners)
    for i in range(count - 1):
        others = np.arange(i + 1, count)
        others = others[(others > i + 1) & ~((i == 0) & (others == count - 1))]
        if others.size:
            near = segments_apart(begin[i], end[i], begin[others], end[others])
            if near.min() < 1e-9:
                return i + 1, int(others[near.argmin()]) + 1
    return None


def _bar(one: Bar) -> Bar:
    ends = []
    for what in ("begin", "end"):
        try:
            x, z = (float(v) for v in getattr(one, what))
        except (TypeError, ValueError):
            raise InvalidInputError(
                f"the {what} of {one.name!r} must be a point x,z, got {getattr(one, what)!r}"
            ) from None
        _within(f"the {what} of {one.name!r}", x, z)
        ends.append((x, z))
    height = number(f"the height of {one.name!r}", one.height, "meters")
    if not 0.0 < height <= FARTHEST:
        raise InvalidInputError(
            f"the height of {one.name!r} must be above 0 and at most {FARTHEST:g} m, got {height:g}"
        )
    return Bar(ends[0], ends[1], height, _radius(one), one.name)


def _post(one: Post) -> Post:
    try:
        x, z = (float(v) for v in one.at)
    except (TypeError, ValueError):
        raise InvalidInputError(
            f"the place of {one.name!r} must be a point x,z, got {one.at!r}"
        ) from None
    _within(f"the place of {one.name!r}", x, z)
    bottom = number(f"the bottom of {one.name!r}", one.bottom, "meters")
    top = number(f"the top of {one.name!r}", one.top, "meters")
    if not 0.0 <= bottom < top <= FARTHEST:
        raise InvalidInputError(
            f"{one.name!r} must reach from a bottom of 0 m or more up to a higher top, got "
            f"{bottom:g} to {top:g} m"
        )
    return Post((x, z), _radius(one), bottom, top, one.name)


def _radius(one: Bar | Post) -> float:
    radius = number(f"the radius of {one.name!r}", one.radius, "meters")
    if not THINNEST <= radius <= 10.0:
        raise InvalidInputError(
            f"the radius of {one.name!r} must be from {THINNEST:g} to 10 m, got {radius:g}"
        )
    return radius


def _within(what: str, x: float, z: float) -> None:
    if not (math.isfinite(x) and math.isfinite(z) and max(abs(x), abs(z)) <= FARTHEST):
        raise InvalidInputError(f"{what} must be within {FARTHEST:g} m of 0,0, got {x:g},{z:g}")
