"""What stands around the people of a scene: obstacles to walk round, bars and posts to dodge."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any

from gaitsmith._checks import number
from gaitsmith.errors import InvalidInputError
from gaitsmith.geometry.outlines import THINNEST, simple_outline, within
from gaitsmith.ground.edges import LEAST_JUMP

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

Point = tuple[float, float]


@dataclass(frozen=True)
class Obstacle:
    """A solid whose outline on the floor is a simple polygon.

    Attributes
    ----------
    points
        x,z of its corners, meters, in either order, three or more.
    name
        What errors call it.
    height
        Of its top over the ground below it, meters; None: no end of it matters. What is as low
        as one step goes is stepped over or on, or walked round, whichever is cheaper.
    """

    points: tuple[Point, ...]
    name: str = "obstacle"
    height: float | None = None


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
        return {
            kind: [
                {key: value for key, value in asdict(one).items() if value is not None}
                for one in getattr(self, kind)
            ]
            for kind in _KINDS
        }


_KINDS: dict[str, type] = {"obstacles": Obstacle, "bars": Bar, "posts": Post}
#: Farthest coordinate and height, meters; most corners of one outline, most of a kind.
FARTHEST, MOST_CORNERS, MOST = 2000.0, 1000, 1000


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
    points = simple_outline(repr(one.name), one.points, most=MOST_CORNERS, farthest=FARTHEST)
    height = one.height
    if height is not None:
        height = number(f"the height of {one.name!r}", height, "meters")
        if not LEAST_JUMP <= height <= FARTHEST:
            raise InvalidInputError(
                f"the height of {one.name!r} must be from {LEAST_JUMP:g} to {FARTHEST:g} m, got "
                f"{height:g}; what is lower is not felt underfoot and may be left out"
            )
    return Obstacle(points, one.name, height)


def _bar(one: Bar) -> Bar:
    ends = []
    for what in ("begin", "end"):
        try:
            x, z = (float(v) for v in getattr(one, what))
        except (TypeError, ValueError):
            raise InvalidInputError(
                f"the {what} of {one.name!r} must be a point x,z, got {getattr(one, what)!r}"
            ) from None
        within(f"the {what} of {one.name!r}", x, z, FARTHEST)
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
    within(f"the place of {one.name!r}", x, z, FARTHEST)
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
