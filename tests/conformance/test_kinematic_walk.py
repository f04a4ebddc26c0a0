"""The measured walk of [KB92b] keeps the contract of seam 1."""

from __future__ import annotations

import pytest
from people import the_walk
from straight_walk import StraightWalkContract

from gaitsmith.walks import WALKS


class TestKinematicWalk(StraightWalkContract):
    @pytest.fixture
    def walk(self):
        return the_walk()


@pytest.mark.parametrize("name", WALKS)
class TestEveryBuiltInWalk(StraightWalkContract):
    @pytest.fixture
    def walk(self, name):
        return WALKS[name]()
