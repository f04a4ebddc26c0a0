"""What stands around the people of a scene: obstacles to walk round, bars and posts to dodge."""

from __future__ import annotations

from dataclasses import dataclass

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
