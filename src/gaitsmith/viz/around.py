"""What stands around a walk, in its pictures: outlines on the floor, bars and posts."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np
from PIL import ImageDraw

from gaitsmith.errors import InvalidInputError
from gaitsmith.plan.surroundings import Surroundings, read_surroundings
from gaitsmith.viz import palette

if TYPE_CHECKING:
    from collections.abc import Callable

    from jaxtyping import Float
    from PIL import Image

    from gaitsmith.ground import Ground
    from gaitsmith.motion.motion import Motion
    from gaitsmith.plan.surroundings import Post
    from gaitsmith.viz.canvas import Area, Canvas
    from gaitsmith.viz.render import Camera

#: Posts without end and bars are drawn so far up and no farther, over the stature.
TALL = 1.3
#: Bars and posts this near to a figure are drawn with it, over the stature: in a row of figures,
#: and where one figure is alone.
BESIDE, AROUND = 0.45, 1.3


def surroundings_of(motion: Motion) -> Surroundings:
    """What the recipe of ``motion`` says stands around; nothing if it says nothing."""
    if motion.labels is None:
        return Surroundings()
    try:
        recipe = json.loads(motion.labels.recipe)
        return read_surroundings(recipe["walk"].get("surroundings"))
    except (ValueError, KeyError, TypeError, AttributeError, InvalidInputError):
        return Surroundings()


def outlines(around: Surroundings) -> list[Float[np.ndarray, "n 3"]]:
    """World outlines on the floor of obstacles and posts, meters."""
    found = [_on_floor(np.array(o.points)) for o in around.obstacles]
    return found + [_circle(post) for post in around.posts]


def _circle(post: Post) -> Float[np.ndarray, "24 3"]:
    turn = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    circle = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    return _on_floor(np.array(post.at) + post.radius * circle)


def rods(around: Surroundings, top: float) -> list[tuple[Float[np.ndarray, "2 3"], float]]:
    """Axes (meters) and radii of bars and of posts as far as ``top``."""
    found = []
    for bar in around.bars:
        ends = _on_floor(np.array([bar.begin, bar.end]))
        ends[:, 1] = bar.height + bar.radius
        found.append((ends, bar.radius))
    for post in around.posts:
        if post.bottom < top:
            ends = _on_floor(np.array([post.at, post.at]))
            ends[:, 1] = post.bottom, min(post.top, top)
            found.append((ends, post.radius))
    return found


def draw_on_map(
    canvas: Canvas,
    around: Surroundings,
    to: Callable[[Float[np.ndarray, "n 3"]], list[tuple[float, float]]],
    scale: float,
    area: Area,
) -> None:
    """Everything seen from above, as much of it as lies in ``area``."""
    if around.empty:
        return
    from shapely import LineString, Polygon, box  # late: most walks have nothing around

    window = box(area.left, area.top, area.right, area.bottom)
    for outline in outlines(around):
        seen = Polygon(to(outline)).intersection(window)
        for piece in getattr(seen, "geoms", [seen]):
            if piece.geom_type == "Polygon" and not piece.is_empty:
                ring = [(float(x), float(y)) for x, y in piece.exterior.coords[:-1]]
                canvas.polygon(ring, palette.SOLID, palette.SOLID_EDGE)
    for bar in around.bars:
        ends = to(_on_floor(np.array([bar.begin, bar.end])))
        seen = LineString(ends).intersection(window)
        if seen.geom_type == "LineString" and not seen.is_empty:
            width = max(2.0 * bar.radius * scale, 2.0)
            canvas.line([(float(x), float(y)) for x, y in seen.coords], palette.SOLID_EDGE, width)


def draw_posts(image: Image.Image, around: Surroundings, view: Camera, ground: Ground) -> None:
    """The outlines of posts on the ground."""
    pen = ImageDraw.Draw(image)
    for post in around.posts:
        outline = _circle(post)
        outline[:, 1] = ground.height(outline[:, 0], outline[:, 2])
        points = view.project(outline)[:, :2].ravel().tolist()
        pen.polygon(points, fill=palette.SOLID, outline=palette.SOLID_EDGE)


def draw_rods(
    image: Image.Image,
    around: Surroundings,
    view: Camera,
    root: Float[np.ndarray, "3"],
    stature: float,
    *,
    front: bool,
    near: float = AROUND,
) -> None:
    """Bars and posts behind a figure at ``root``, or those in ``front`` of it.

    Only those within ``near`` statures of it.
    """
    pen = ImageDraw.Draw(image)
    for ends, radius in rods(around, TALL * stature):
        seen = _part_near(ends, root, near * stature)
        if seen is None:
            continue
        piece, beside = seen
        if (float(beside @ view.axes[2]) > 0.0) is not front:
            continue
        (x0, y0), (x1, y1) = view.project(piece)[:, :2].tolist()
        size = max(radius * view.scale, 1.0)
        for x, y in ((x0, y0), (x1, y1)):
            pen.ellipse((x - size, y - size, x + size, y + size), fill=palette.SOLID_EDGE)
        pen.line((x0, y0, x1, y1), fill=palette.SOLID_EDGE, width=max(2, round(2.0 * size)))


def _part_near(
    ends: Float[np.ndarray, "2 3"], root: Float[np.ndarray, "3"], reach: float
) -> tuple[Float[np.ndarray, "2 3"], Float[np.ndarray, "3"]] | None:
    """The part of a segment within ``reach`` seen from above, and the way to the nearest of it."""
    line = ends[1] - ends[0]
    flat, to = line * [1.0, 0.0, 1.0], (root - ends[0]) * [1.0, 0.0, 1.0]
    size = float(flat @ flat)
    along = float(to @ flat) / size if size > 1e-12 else 0.0
    away = float(np.linalg.norm(to - along * flat))
    if away >= reach:
        return None
    half = np.sqrt((reach**2 - away**2) / size) if size > 1e-12 else 1.0
    first, last = max(along - half, 0.0), min(along + half, 1.0)
    if first > last:
        return None
    nearest = ends[0] + min(max(along, 0.0), 1.0) * line - root
    return ends[0] + np.array([[first], [last]]) * line, nearest


def _on_floor(points: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "n 3"]:
    return np.stack([points[:, 0], np.zeros(len(points)), points[:, 1]], axis=1)
