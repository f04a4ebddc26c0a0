"""The ground in pictures: shaded cells of slopes and steps, and the solids that lie on it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image, ImageDraw

from gaitsmith.ground import Boxes, Flat, HeightField, Stairs
from gaitsmith.viz import palette

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from jaxtyping import Bool, Float

    from gaitsmith.ground import Ground
    from gaitsmith.plan.surroundings import Obstacle
    from gaitsmith.viz.render import Camera

#: Cells of the ground, meters: of planes and stairs, of fields; sides of solids are cut as fine.
PLANE, FIELD = 0.5, 0.1
#: Meters by which a thing must be nearer to hide another.
NEARER = 0.02


@dataclass(frozen=True, eq=False)
class Solid:
    """A prism on the ground, or with no height an outline on it.

    ``rim`` has x,z of its corners and, in between, of points of its sides; ``foot`` the height of
    the ground there.
    """

    corners: Float[np.ndarray, "m 2"]
    rim: Float[np.ndarray, "n 2"]
    foot: Float[np.ndarray, "n"]
    height: float | None

    @property
    def outline(self) -> Float[np.ndarray, "n 3"]:
        """World points of the rim on the ground, meters."""
        return np.stack([self.rim[:, 0], self.foot, self.rim[:, 1]], axis=1)

    @property
    def top(self) -> Float[np.ndarray, "n 3"]:
        """World points of the rim of the top, meters."""
        return self.outline + [0.0, self.height or 0.0, 0.0]

    @property
    def faces(self) -> list[Float[np.ndarray, "k 3"]]:
        """World polygons of its top and its sides, meters."""
        low, high = self.outline, self.top
        after = np.roll(np.arange(len(low)), -1)
        sides = np.stack([low, low[after], high[after], high], axis=1)
        return [*sides, high]


@dataclass(frozen=True, eq=False)
class Land:
    """A ground without what lies on it, and the solids that do."""

    base: Ground
    solids: tuple[Solid, ...]

    @staticmethod
    def of(surface: Ground, obstacles: Sequence[Obstacle] = ()) -> Land:
        """What is walked on, with ``obstacles`` on it; what is both counts once."""
        base, shapes = surface, [(o.points, o.height) for o in obstacles]
        if isinstance(surface, Boxes):
            base = surface.base
            shapes = [(b.points, b.height) for b in surface.boxes] + shapes
        return Land(base, tuple(_solid(base, *shape) for shape in dict.fromkeys(shapes)))

    @property
    def is_level(self) -> bool:
        """Whether the ground below the solids is one level plane."""
        return isinstance(self.base, Flat)

    def lines(
        self, low: Float[np.ndarray, "2"], high: Float[np.ndarray, "2"]
    ) -> tuple[Float[np.ndarray, "columns"], Float[np.ndarray, "rows"]]:
        """X and z of lines that cut the ground into plane cells (meters), risers included."""
        cell = FIELD if isinstance(self.base, HeightField) else PLANE
        x, z = (
            cell * np.arange(np.ceil(a / cell), np.floor(b / cell) + 1)
            for a, b in zip(low, high, strict=True)
        )
        if isinstance(self.base, Stairs):
            riser = self.base.risers
            riser = riser[(riser > low[1]) & (riser < high[1])]
            z = np.unique(np.concatenate([z, riser - 1e-6, riser + 1e-6]))
        return x, z

    def cells(
        self, x: Float[np.ndarray, "columns"], z: Float[np.ndarray, "rows"]
    ) -> Float[np.ndarray, "n 4 3"]:
        """World corners of the ground's cells between lines, meters."""
        points = np.empty((len(z), len(x), 3))
        points[..., 0], points[..., 2] = x[None], z[:, None]
        points[..., 1] = self.base.height(points[..., 0], points[..., 2])
        cells = np.stack(
            [points[:-1, :-1], points[:-1, 1:], points[1:, 1:], points[1:, :-1]], axis=2
        )
        return cells.reshape(-1, 4, 3)

    def grid(
        self, low: Float[np.ndarray, "2"], high: Float[np.ndarray, "2"]
    ) -> list[Float[np.ndarray, "n 3"]]:
        """World points of lines along x and z on the ground, :data:`PLANE` apart, meters."""
        found = []
        for axis in (0, 1):
            run = np.append(np.arange(low[1 - axis], high[1 - axis], FIELD), high[1 - axis])
            first, last = np.ceil(low[axis] / PLANE), np.floor(high[axis] / PLANE)
            for at in PLANE * np.arange(first, last + 1):
                x, z = (np.full(len(run), at), run) if axis == 0 else (run, np.full(len(run), at))
                found.append(np.stack([x, self.base.height(x, z), z], axis=1))
        return found


def _solid(base: Ground, points: Sequence[tuple[float, float]], height: float | None) -> Solid:
    corners = np.array(points)
    following = np.roll(corners, -1, axis=0)
    area = float((corners[:, 0] * following[:, 1] - corners[:, 1] * following[:, 0]).sum())
    if area < 0.0:
        corners = corners[::-1].copy()
        following = np.roll(corners, -1, axis=0)
    cell = np.inf if isinstance(base, Flat) else FIELD
    rim = []
    for begin, end in zip(corners, following, strict=True):
        count = max(1, int(np.ceil(np.linalg.norm(end - begin) / cell)))
        rim.append(begin + np.arange(count)[:, None] / count * (end - begin))
    sides = np.concatenate(rim)
    return Solid(corners, sides, base.height(sides[:, 0], sides[:, 1]), height)


def draw_land(
    image: Image.Image,
    land: Land,
    view: Camera,
    low: Float[np.ndarray, "2"],
    high: Float[np.ndarray, "2"],
    *,
    wide: int,
) -> None:
    """Uneven ground between corners x,z: shaded cells, and lines ``wide`` pixels on them."""
    fields = isinstance(land.base, HeightField)
    _draw_cells(image, land.cells(*land.lines(low, high)), view, edges=not fields)
    pen = ImageDraw.Draw(image)
    for line in land.grid(low, high) if fields else ():
        pen.line(view.project(line)[:, :2].ravel().tolist(), fill=palette.GRID_DARK, width=wide)


def _draw_cells(
    image: Image.Image, cells: Float[np.ndarray, "n 4 3"], view: Camera, *, edges: bool
) -> None:
    """Cells of the ground, shaded by their slope, the far ones first."""
    normal = np.cross(cells[:, 2] - cells[:, 0], cells[:, 1] - cells[:, 3])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    share = 0.75 * np.clip(1.0 - np.abs(normal[:, 1]) ** 4, 0.0, 1.0)
    flat = view.project(cells)
    pen = ImageDraw.Draw(image)
    edge = palette.GRID_DARK if edges else None
    for k in np.argsort(flat[..., 2].mean(axis=1), kind="stable").tolist():
        fill = palette.mix(palette.FLOOR, palette.GRID_DARK, float(share[k]))
        pen.polygon(flat[k, :, :2].ravel().tolist(), fill=fill, outline=edge)


def draw_solids(image: Image.Image, land: Land, view: Camera, *, wide: int) -> None:
    """Everything that lies on the ground, the far ones first; edges ``wide`` pixels."""
    pen = ImageDraw.Draw(image)

    def line(points: Float[np.ndarray, "n 2"]) -> None:
        pen.line(points.ravel().tolist(), fill=palette.SOLID_EDGE, width=wide, joint="curve")

    for solid in sorted(land.solids, key=lambda s: float(view.project(s.outline)[:, 2].max())):
        low, high = (view.project(rim)[:, :2] for rim in (solid.outline, solid.top))
        closed = np.concatenate([high, high[:1]])
        if solid.height is not None:
            after = np.roll(np.arange(len(low)), -1)
            way = solid.rim[after] - solid.rim
            outward = np.stack([way[:, 1], np.zeros(len(way)), -way[:, 0]], axis=1)
            seen = np.einsum("nk,k->n", outward, view.axes[2]) > 0.0
            for k in np.flatnonzero(seen).tolist():
                quad = np.concatenate([low[[k, after[k]]], high[[after[k], k]]])
                pen.polygon(quad.ravel().tolist(), fill=palette.SOLID_SIDE)
                line(quad[:2])
            for corner in solid.corners:
                k = int(np.abs(solid.rim - corner).sum(axis=1).argmin())
                if seen[k] or seen[k - 1]:
                    line(np.stack([low[k], high[k]]))
        pen.polygon(high.ravel().tolist(), fill=palette.SOLID)
        line(closed)


class Hiding:
    """How near the nearest of some plane polygons is at every pixel."""

    def __init__(
        self, faces: Iterable[Float[np.ndarray, "k 3"]], view: Camera, size: tuple[int, int]
    ) -> None:
        self.view = view
        self.depth = np.full((size[1], size[0]), -np.inf)
        for face in faces:
            self._add(view.project(face))

    def _add(self, face: Float[np.ndarray, "k 3"]) -> None:
        """One polygon: its depth is a plane over the pixels."""
        rows, columns = self.depth.shape
        x0, y0 = np.maximum(np.floor(face[:, :2].min(axis=0)), 0).astype(int).tolist()
        x1, y1 = (np.floor(face[:, :2].max(axis=0)).astype(int) + 1).tolist()
        x1, y1 = min(x1, columns), min(y1, rows)
        if x1 <= x0 or y1 <= y0:
            return
        mask = Image.new("1", (x1 - x0, y1 - y0))
        shape = face[:, :2] - [x0, y0]
        ImageDraw.Draw(mask).polygon(shape.ravel().tolist(), fill=1)
        plane = np.linalg.lstsq(np.insert(shape, 2, 1.0, axis=1), face[:, 2], rcond=None)[0]
        x, y = np.arange(x1 - x0) + 0.5, np.arange(y1 - y0) + 0.5
        depth = np.where(np.asarray(mask), x * plane[0] + y[:, None] * plane[1] + plane[2], -np.inf)
        part = self.depth[y0:y1, x0:x1]
        np.maximum(part, np.minimum(depth, face[:, 2].max()), out=part)

    def hides(self, points: Float[np.ndarray, "*n 3"]) -> Bool[np.ndarray, "*n"]:
        """Whether world points are behind something."""
        x, y, depth = np.moveaxis(self.view.project(points), -1, 0)
        rows, columns = self.depth.shape
        inside = (x >= 0) & (x < columns) & (y >= 0) & (y < rows)
        row, column = (np.where(inside, v, 0).astype(np.intp) for v in (y, x))
        return inside & (self.depth[row, column] > depth + NEARER)


def hiding(
    land: Land, view: Camera, size: tuple[int, int], cells: Iterable[Float[np.ndarray, "4 3"]] = ()
) -> Hiding | None:
    """What the solids of ``land``, and ``cells`` of its ground, hide; None: nothing."""
    faces = [f for solid in land.solids if solid.height is not None for f in solid.faces]
    faces.extend(cells)
    return Hiding(faces, view, size) if faces else None
