"""How much room a posed body leaves to what stands around, measured anew.

Joints are placed by the judge's own kinematics; capsules are cut into points, and the distance
of points from rods and outlines is worked out here (rods) and by Shapely (outlines).
"""

from __future__ import annotations

import numpy as np
import shapely
from judge import posed

from gaitsmith.body.bulk import bulk_of

SAMPLES = 13


def capsule_points(motion, body):
    """Points on the axes of all capsules, (F, K, SAMPLES, 3), and the radii (K,)."""
    positions, world, _ = posed(motion)
    bulk, out = bulk_of(body), []
    share = np.linspace(0.0, 1.0, SAMPLES)[:, None]
    for name, (a, b) in zip(bulk.joints, bulk.ends, strict=True):
        joint = motion.skeleton.index(name)
        points = a + share * (b - a)
        out.append(np.stack([positions[:, joint] + world[joint].apply(p) for p in points], axis=1))
    return np.stack(out, axis=1), bulk.radius


def room_to_rod(motion, body, begin, end, radius):
    """Smallest distance over time (F,) of the body from a round rod, meters."""
    points, sizes = capsule_points(motion, body)
    begin, line = np.asarray(begin, dtype=float), np.subtract(end, begin)
    along = np.clip(((points - begin) @ line) / (line @ line), 0.0, 1.0)
    away = np.linalg.norm(points - begin - along[..., None] * line, axis=-1).min(axis=-1)
    return (away - sizes).min(axis=-1) - radius


def room_to_outline(motion, body, corners):
    """Smallest distance of the body from an outline on the floor, meters; 0 inside: less."""
    points, sizes = capsule_points(motion, body)
    flat = points[:, :, [0, -1]][..., [0, 2]]
    lines = shapely.linestrings(flat)
    away = shapely.distance(lines, shapely.Polygon(corners))
    return float((away - sizes).min())
