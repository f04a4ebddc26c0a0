"""The measured walk of [KB92b] keeps the contract of seam 1."""

from __future__ import annotations

import pytest
from people import the_walk
from straight_walk import StraightWalkContract

from gaitsmith.walks import WALKS, KinematicWalk
from gaitsmith.walks.generalize import scale_step_length


@pytest.mark.parametrize("name", WALKS)
class TestEveryBuiltInWalk(StraightWalkContract):
    @pytest.fixture
    def walk(self, name):
        return WALKS[name]()


class TestAWalkOfTwoMeasuredSteps(StraightWalkContract):
    """[KB92b] section 6: the nearest measured steps serve, blended between."""

    @pytest.fixture
    def walk(self):
        [(measured, _)] = the_walk().prototypes
        shorter = scale_step_length(measured, 0.6)
        character = shorter.character
        own = character.__class__(
            **{
                **vars(character),
                "ratio": shorter.length / shorter.body.leg_length,
                "strike_pitch": 0.8 * character.strike_pitch,
                "kappa": character.kappa + 0.02,
            }
        )
        return KinematicWalk([measured, shorter.with_(character=own)])
