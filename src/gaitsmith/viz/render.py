"""Solid, smoothly shaded figures on a Pillow image: a z-buffer in NumPy alone."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image

from gaitsmith._checks import one_of
from gaitsmith.conventions import ahead, leftward
from gaitsmith.viz import palette

if TYPE_CHECKING:
    from jaxtyping import Float, Int

    from gaitsmith.skin.mesh import SkinMesh

VIEWS = ("right", "left", "front", "top", "three-quarter", "rear-quarter")


@dataclass(frozen=True, eq=False)
class Camera:
    """Orthographic camera.

    Attributes
    ----------
    axes
        Rows ``(right, up, toward the viewer)`` of the picture in the world, unit.
    target
        ``(3,)`` world point, meters, that is drawn at ``center``.
    center
        Pixel ``(x, y)`` of the target, y down.
    scale
        Pixels a meter.
    """

    axes: Float[np.ndarray, "3 3"]
    target: Float[np.ndarray, "3"]
    center: tuple[float, float]
    scale: float

    def project(self, points: Float[np.ndarray, "*n 3"]) -> Float[np.ndarray, "*n 3"]:
        """``(x, y, depth)``: pixels, and meters toward the viewer."""
        # not a product of matrices: its threads would cost more than they save
        seen = np.einsum("...c,kc->...k", points - self.target, self.axes)
        out = np.empty_like(seen)
        out[..., 0] = self.center[0] + self.scale * seen[..., 0]
        out[..., 1] = self.center[1] - self.scale * seen[..., 1]
        out[..., 2] = seen[..., 2]
        return out


def camera(
    view: str,
    *,
    heading: float,
    target: Float[np.ndarray, "3"],
    center: tuple[float, float],
    scale: float,
    elevation: float | None = None,
) -> Camera:
    """Camera that looks at a walker who faces ``heading`` radians.

    Parameters
    ----------
    view
        One of :data:`VIEWS`: from the walker's right or left, from ahead, from above (the
        walker faces the right edge of the picture), or from the right and
        ahead or behind.
    heading
        Which way the walker faces, radians.
    target, center, scale
        See :class:`Camera`.
    elevation
        How far the camera looks down, radians; 0 by default, 0.2 for the quarter views.
    """
    one_of("view", view, VIEWS)
    forward, left, up = ahead(heading), leftward(heading), np.array([0.0, 1.0, 0.0])
    if view == "top":
        return Camera(np.stack([forward, left, up]), target, center, scale)
    quarter = 0.72
    angle = {"right": 0.0, "left": np.pi, "front": 0.5 * np.pi}.get(view, quarter)
    if view == "rear-quarter":
        angle = -quarter
    right = np.cos(angle) * forward + np.sin(angle) * left
    level = np.sin(angle) * forward - np.cos(angle) * left
    tilt = elevation if elevation is not None else (0.2 if view.endswith("quarter") else 0.0)
    toward = np.cos(tilt) * level + np.sin(tilt) * up
    return Camera(np.stack([right, np.cross(toward, right), toward]), target, center, scale)


# Where the light comes from, in the picture's frame (right, up, toward the viewer).
_KEY = np.array([0.42, 0.70, 0.58]) / np.linalg.norm([0.42, 0.70, 0.58])
_HALF = (_KEY + [0.0, 0.0, 1.0]) / np.linalg.norm(_KEY + [0.0, 0.0, 1.0])


# Shadows lean to the cool side, as under an open sky: red, green, blue.
_COOL = (-0.02, 0.0, 0.035)


def shade(
    normals: Float[np.ndarray, "n 3"], view: Camera
) -> tuple[Float[np.ndarray, "n"], Float[np.ndarray, "n"]]:
    """How much light a surface gives back of its colour, and how much white it adds to it.

    Sky and ground light and a key light; a soft gloss and a slight rim.
    """
    seen = np.einsum("nc,kc->nk", normals, view.axes)
    key = np.clip(0.12 + 0.88 * np.einsum("nk,k->n", seen, _KEY), 0.0, None)
    sky = 0.5 + 0.5 * normals[:, 1]
    facing = np.clip(seen[:, 2], 0.0, 1.0)
    gloss = np.clip(np.einsum("nk,k->n", seen, _HALF), 0.0, 1.0) ** 20
    rim = (1.0 - facing) ** 3 * sky
    return 0.46 + 0.20 * sky + 0.44 * key, 0.09 * gloss + 0.10 * rim


@dataclass(frozen=True, eq=False)
class Fragments:
    """The nearest face at every covered pixel of a window.

    Attributes
    ----------
    box
        Window ``(left, top, width, height)`` in the picture, pixels.
    pixel
        ``(N,)`` covered pixels, row by row in the window.
    face
        ``(N,)`` face seen there.
    weights
        ``(N, 3)`` barycentric weights of its corners.
    depth
        ``(N,)`` meters toward the viewer.
    """

    box: tuple[int, int, int, int]
    pixel: Int[np.ndarray, "n"]
    face: Int[np.ndarray, "n"]
    weights: Float[np.ndarray, "n 3"]
    depth: Float[np.ndarray, "n"]

    def before(self, hidden: Float[np.ndarray, "rows columns"], nearer: float) -> Fragments | None:
        """Those in front of ``hidden``, which is the picture's, or less than ``nearer`` behind."""
        left, top, width, _ = self.box
        rows, columns = np.divmod(self.pixel, width)
        kept = self.depth > hidden[rows + top, columns + left] - nearer
        if not kept.any():
            return None
        return Fragments(
            self.box, self.pixel[kept], self.face[kept], self.weights[kept], self.depth[kept]
        )


def rasterize(corners: Float[np.ndarray, "faces 3 3"], size: tuple[int, int]) -> Fragments | None:
    """Nearest front face at every pixel of a picture of ``size``; None if nothing is seen.

    Parameters
    ----------
    corners
        ``(x, y, depth)`` of the three corners of every face, of :meth:`Camera.project`.
    size
        Width and height of the picture, pixels.

    Every face lists the pixels of its bounding box, those inside the face stay, and the
    nearest wins: a z-buffer with no loop over faces or pixels.
    """
    x, y = corners[..., 0], corners[..., 1]
    ax, ay, bx, by = x[:, 1] - x[:, 0], y[:, 1] - y[:, 0], x[:, 2] - x[:, 0], y[:, 2] - y[:, 0]
    area = ax * by - ay * bx
    # pixel k is sampled at its middle, k + 0.5
    left = np.maximum(np.ceil(x.min(1) - 0.5), 0).astype(np.int64)
    top = np.maximum(np.ceil(y.min(1) - 0.5), 0).astype(np.int64)
    wide = np.minimum(np.floor(x.max(1) - 0.5), size[0] - 1).astype(np.int64) - left + 1
    high = np.minimum(np.floor(y.max(1) - 0.5), size[1] - 1).astype(np.int64) - top + 1
    # y points down in the picture, so faces toward the viewer turn the negative way
    seen = np.flatnonzero((area < -1e-9) & (wide > 0) & (high > 0))
    if not len(seen):
        return None
    x0, y0 = int(left[seen].min()), int(top[seen].min())
    width = int((left + wide)[seen].max()) - x0
    height = int((top + high)[seen].max()) - y0
    wide, count = wide[seen], wide[seen] * high[seen]
    which = np.repeat(np.arange(len(seen)), count)
    within = np.arange(len(which)) - np.repeat(np.cumsum(count) - count, count)
    down, across = np.divmod(within, wide[which])
    face = seen[which]
    # barycentric weights are affine in the pixel: value at the box's first pixel, and slopes
    first_x, first_y = left[seen] + 0.5 - x[seen, 0], top[seen] + 0.5 - y[seen, 0]
    inverse = 1.0 / area[seen]
    table = np.stack(
        [
            (by[seen] * first_x - bx[seen] * first_y) * inverse,
            by[seen] * inverse,
            -bx[seen] * inverse,
            (ax[seen] * first_y - ay[seen] * first_x) * inverse,
            -ay[seen] * inverse,
            ax[seen] * inverse,
        ]
    )
    second = table[0][which] + table[1][which] * across + table[2][which] * down
    third = table[3][which] + table[4][which] * across + table[5][which] * down
    inside = np.flatnonzero((second >= -1e-9) & (third >= -1e-9) & (second + third <= 1.0 + 1e-9))
    if not len(inside):
        return None
    which, face, second, third = which[inside], face[inside], second[inside], third[inside]
    pixel = (top[seen] - y0)[which] + down[inside]
    pixel = pixel * width + (left[seen] - x0)[which] + across[inside]
    z = corners[..., 2]
    depth = z[face, 0] * (1.0 - second - third) + z[face, 1] * second + z[face, 2] * third
    nearest = np.full(width * height, -np.inf)
    np.maximum.at(nearest, pixel, depth)
    owner = np.full(width * height, -1)
    wins = np.flatnonzero(depth == nearest[pixel])
    owner[pixel[wins]] = wins
    covered = np.flatnonzero(owner >= 0)
    pick = owner[covered]
    second, third = second[pick], third[pick]
    weights = np.stack([1.0 - second - third, second, third], axis=1)
    return Fragments((x0, y0, width, height), covered, face[pick], weights, depth[pick])


def draw_figure(
    image: Image.Image,
    figure: SkinMesh,
    positions: Float[np.ndarray, "joints 3"],
    world: Float[np.ndarray, "joints 4"],
    view: Camera,
    hidden: Float[np.ndarray, "rows columns"] | None = None,
) -> None:
    """Draw ``figure`` in one pose into an RGB ``image``.

    Parameters
    ----------
    image
        What to draw on; supersample and reduce it for smooth edges.
    figure
        The skinned figure of the skeleton.
    positions, world
        World positions (meters) and rotations of the joints of one frame.
    view
        The camera.
    hidden
        Meters toward the viewer of what hides the figure, at every pixel; None: nothing does.
    """
    vertices, normals = figure.pose(positions, world)
    seen = rasterize(view.project(vertices)[figure.faces], image.size)
    if seen is not None and hidden is not None:
        seen = seen.before(hidden, 0.012 * figure.stature)
    if seen is None:
        return
    # light is worked out at vertices: there are fewer of them than pixels, and triangles are small
    corners = figure.faces[seen.face]
    light, white = (
        np.einsum("nk,nk->n", seen.weights, value[corners]) for value in shade(normals, view)
    )
    edge = _edges(seen, 0.028 * figure.stature, max(1, round(view.scale * 0.0022)))
    # what is farther away is paler: it tells the far leg from the near one
    root = float((positions[0] - view.target) @ view.axes[2])
    far = 0.14 * np.clip(0.5 - (seen.depth - root) / (0.25 * figure.stature), 0.0, 1.0)
    left, top, width, height = seen.box
    pixels = np.zeros((height * width, 4), np.uint8)
    for channel, (cool, paper) in enumerate(zip(_COOL, palette.PAPER, strict=True)):
        color = figure.face_colors[:, channel][seen.face]
        lit = np.clip(color * (light + (1.0 - light) * cool) + white, 0.0, 1.0) * edge
        pixels[seen.pixel, channel] = np.rint(255.0 * lit + (paper - 255.0 * lit) * far)
    pixels[seen.pixel, 3] = 255
    layer = Image.fromarray(pixels.reshape(height, width, 4))
    image.paste(layer, (left, top), layer)


def _edges(seen: Fragments, jump: float, reach: int) -> Float[np.ndarray, "n"]:
    """Factor that darkens pixels just behind the outline of something ``jump`` m nearer."""
    _, _, width, height = seen.box
    depth = np.full((height + 2 * reach, width + 2 * reach), -np.inf)
    middle = depth[reach : reach + height, reach : reach + width]
    rows, columns = np.divmod(seen.pixel, width)
    middle[rows, columns] = seen.depth
    ahead_of = np.zeros(len(seen.pixel))
    for dy, dx in ((0, 1), (0, -1), (1, 0), (-1, 0)):
        beside = depth[rows + reach * (1 + dy), columns + reach * (1 + dx)]
        ahead_of = np.maximum(ahead_of, beside - seen.depth)
    return 1.0 - 0.30 * np.clip(ahead_of / jump - 0.4, 0.0, 1.0)
