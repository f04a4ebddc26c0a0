"""The elevation walk keeps the contract of a straight walk."""

import pytest
from straight_walk import StraightWalkContract

from gaitsmith.walks.elevation_sets import neutral_legs, spanning_sets
from gaitsmith.walks.elevation_walk import ElevationWalk

WALK = ElevationWalk(spanning_sets(neutral_legs()))


class TestElevationWalk(StraightWalkContract):
    @pytest.fixture
    def walk(self):
        return WALK
