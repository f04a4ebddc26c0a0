"""GLB files in the hands of others: Khronos' validator and three.js, both by Node.

``npm ci`` in the folder of the project installs them; Python needs nothing for it.
"""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from glb import Glb

import gaitsmith
from gaitsmith.geometry.rotations import exp
from gaitsmith.io.gltf import write_glb
from gaitsmith.motion.kinematics import joint_positions
from gaitsmith.motion.motion import Motion
from gaitsmith.motion.skeleton import HUMANOID, Skeleton

HERE, ROOT = Path(__file__).parent, Path(__file__).resolve().parents[2]
pytestmark = pytest.mark.clients


def node(script: str, *arguments: object, package: str) -> object:
    """What a Node script of this folder prints; skips where Node or the package is absent."""
    if shutil.which("node") is None:
        pytest.skip("there is no node here")
    if not (ROOT / "node_modules" / package).is_dir():
        pytest.skip(f"{package} is not installed: npm ci")
    command = ["node", str(HERE / script), *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    return json.loads(done.stdout)


def tumble(skeleton: Skeleton, **changes: object) -> Motion:
    """A second of wild turning."""
    rng, frames = np.random.default_rng(1), 31
    swing = rng.normal(0.0, 0.5, (len(skeleton), 3)) * np.linspace(0, 2, frames)[:, None, None]
    root = np.linspace([0.0, 0.9, 0.0], [0.5, 1.0, 1.0], frames)
    return Motion(skeleton, root, exp(swing), 30.0, **changes)  # type: ignore[arg-type]


def motions() -> dict[str, Motion]:
    rng = np.random.default_rng(0)
    names = [name for name, _ in HUMANOID]
    parents = tuple(-1 if p is None else names.index(p) for _, p in HUMANOID)
    wild = Skeleton(tuple(names), parents, rng.normal(0.0, 0.1, (len(names), 3)))
    chain = Skeleton(
        tuple(f"joint {k}" for k in range(300)), tuple(range(-1, 299)), np.full((300, 3), 0.01)
    )
    still = Motion(chain, np.zeros((1, 3)), np.tile([0.0, 0.0, 0.0, 1.0], (1, 300, 1)), 30.0)
    moved = np.tile(wild.offsets, (31, 1, 1)) * np.linspace(1.0, 1.2, 31)[:, None, None]
    out = {
        f"walk-{height}": gaitsmith.walk(distance=3.0, body=height, fps=fps)
        for height, fps in ((1.2, 24.0), (1.75, 60.0), (2.1, 120.0))
    }
    out["walking"] = gaitsmith.walk(distance=4.0, start="walk", stop="walk", cadence=100)
    return out | {
        "wild": tumble(wild),
        "stretched": tumble(wild, translations=moved),
        "chain": tumble(chain),
        "still": still,
    }


def scene() -> gaitsmith.Performance:
    """Three who differ in size and gait, one with a name beyond ASCII."""
    walkers = (
        gaitsmith.Walker("ann", body=1.2, distance=2.0),
        gaitsmith.Walker("ben-1", body=2.0, do="walk to 4,2", start=gaitsmith.Start((3, 0))),
        gaitsmith.Walker("zoë", gait="winter", distance=1.0, start=gaitsmith.Start((6, 0))),
    )
    return gaitsmith.perform(gaitsmith.Scene(walkers), fps=30.0)


def test_khronos_validator_finds_nothing(tmp_path):
    paths = []
    for name, motion in motions().items():
        paths.append(tmp_path / f"{name}.glb")
        write_glb(motion, paths[-1], neutral=name == "walking")
    for neutral in (False, True):
        paths.append(tmp_path / f"scene-{neutral}.glb")
        write_glb(scene(), paths[-1], neutral=neutral)
    reports = node("validate.mjs", *paths, package="gltf-validator")
    assert len(reports) == len(paths)
    for path, report in reports.items():
        counts = {key: report[f"num{key}"] for key in ("Errors", "Warnings", "Infos", "Hints")}
        assert set(counts.values()) == {0}, (path, report["messages"])
        assert report["info"]["maxInfluences"] <= 4


@pytest.mark.parametrize("height", [1.2, 1.8])
def test_three_js_plays_what_was_written(height, tmp_path):
    """Joints to 1e-5 m of our kinematics, vertices to 1e-4 m of our skinning of the file."""
    motion = gaitsmith.walk(distance=3.0, body=height, fps=30.0)
    path = gaitsmith.save(motion, tmp_path / "walk.glb")
    frames = [0, 20, len(motion) // 2, len(motion) - 1]
    shown = node("three_pose.mjs", path, *(f / motion.fps for f in frames), package="three")
    expected, glb = joint_positions(motion), Glb(path.read_bytes())
    for frame, pose in zip(frames, shown, strict=True):
        assert set(pose["joints"]) == set(motion.skeleton.names)
        for name, at in pose["joints"].items():
            joint = expected[frame, motion.skeleton.index(name)]
            np.testing.assert_allclose(at, joint, atol=1e-5, err_msg=f"{name} at {frame}")
        for vertices, mine in zip(pose["vertices"], glb.skinned(frame).values(), strict=True):
            pick = mine[[0, len(mine) // 2, -1]]
            np.testing.assert_allclose(vertices, pick, atol=1e-4)


def test_three_js_plays_everybody_of_a_scene(tmp_path):
    """Every joint of everybody by its name, to 1e-5 m."""
    made = scene()
    path = gaitsmith.save(made, tmp_path / "scene.glb")
    frames = [0, 25, len(made.motions[0]) - 1]
    shown = node("three_pose.mjs", path, *(f / made.fps for f in frames), package="three")
    for frame, pose in zip(frames, shown, strict=True):
        for name, motion in made:
            expected = joint_positions(motion)[frame]
            for joint, at in zip(motion.skeleton.names, expected, strict=True):
                np.testing.assert_allclose(pose["joints"][f"{name}_{joint}"], at, atol=1e-5)
