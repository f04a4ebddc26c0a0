"""The capsules of a body hold what pictures show of it."""

from __future__ import annotations

import numpy as np
import pytest

from gaitsmith.body.bulk import bulk_of, half_width
from gaitsmith.body.presets import body_from_height
from gaitsmith.geometry.solids import segments_apart
from gaitsmith.pipeline import walk
from gaitsmith.viz.tracks import tracks_of


@pytest.mark.parametrize("height", [1.2, 1.75, 2.05])
def test_the_skin_lies_within_the_capsules(height):
    body = body_from_height(height)
    motion = walk(distance=2.0, body=body, fps=10.0)
    tracks, bulk = tracks_of(motion), bulk_of(body)
    axes = bulk.axes(motion.skeleton, tracks.positions, tracks.world)
    figure = tracks.figure
    main = figure.joints[np.arange(len(figure.joints)), figure.weights.argmax(axis=1)]
    names = motion.skeleton.names
    # soles have edges, which a round capsule cannot hold
    kept = np.array([not names[j].endswith(("Foot", "Toes")) for j in main])
    for frame in range(0, len(motion), 7):
        skin, _ = figure.pose(tracks.positions[frame], tracks.world[frame])
        skin = skin[kept][::5, None]
        away = segments_apart(skin, skin, axes[frame][None, :, 0], axes[frame][None, :, 1])
        outside = (away - bulk.radius).min(axis=1)
        assert outside.max() < 0.009 * height, "m"
        assert np.quantile(outside, 0.9) < 0.003 * height


def test_a_walker_is_as_wide_as_its_elbows():
    body = body_from_height(1.75)
    motion = walk(distance=4.0, body=body, fps=30.0)
    tracks, bulk = tracks_of(motion), bulk_of(body)
    axes = bulk.axes(motion.skeleton, tracks.positions, tracks.world)
    aside = (np.abs(axes[..., 0]).max(axis=2) + bulk.radius).max()
    assert half_width(body) < aside < half_width(body) + 0.04, "m; the sway adds to it"
