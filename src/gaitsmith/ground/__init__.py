"""What is walked on. A ground is one class in one file and one line in ``GROUNDS``."""

from __future__ import annotations

from gaitsmith.ground.boxes import Box, Boxes
from gaitsmith.ground.edges import Crossings, Edges
from gaitsmith.ground.flat import Flat
from gaitsmith.ground.foot_plane import FootPlane, foot_plane
from gaitsmith.ground.heightfield import HeightField
from gaitsmith.ground.mesh import field_from_mesh
from gaitsmith.ground.model import Ground
from gaitsmith.ground.nearness import edge_distance, edges_near
from gaitsmith.ground.reading import GROUNDS, ground_from_json, read_ground
from gaitsmith.ground.slope import Slope
from gaitsmith.ground.stairs import Stairs

__all__ = [
    "GROUNDS",
    "Box",
    "Boxes",
    "Crossings",
    "Edges",
    "Flat",
    "FootPlane",
    "Ground",
    "HeightField",
    "Slope",
    "Stairs",
    "edge_distance",
    "edges_near",
    "field_from_mesh",
    "foot_plane",
    "ground_from_json",
    "read_ground",
]
