"""An independent judge of generated motions: the promises, on any ground.

It reads the skeleton, the rotations, the root, the flags and the labels of a motion and
computes everything else anew; it imports no kinematics of the package.
"""

from __future__ import annotations

import json

import numpy as np
import shapely
from scipy.spatial.transform import Rotation

SIDES = ("left", "right")
HEEL, BALL, TOE = 0, 1, 2
#: Promise: (bar, whether the figure must be at most or at least the bar).
BARS = {
    "slip_mm": (0.5, "most"),
    "penetration_mm": (0.5, "most"),
    "float_mm": (1.0, "most"),
    "bone_error_mm": (1e-6, "most"),
    "stance_knee_deg": (3.0, "least"),
    "knee_backward_mm": (1e-6, "most"),
    "joint_deg_per_60th": (20.0, "most"),
    "quaternion_flips": (0, "most"),
    "quaternion_norm_error": (1e-9, "most"),
    "unsupported_frames": (0, "most"),
    "unflagged_bearing": (0, "most"),
    "flat_without_all_flags": (0, "most"),
    "footstep_error_mm": (1e-3, "most"),
    "footstep_heading_error_rad": (1e-6, "most"),
    "footsteps_unseen": (2, "most"),
    "landings_at_wrong_frames": (0, "most"),
    "label_errors": (0, "most"),
}


def posed(motion):
    """World positions (F, J, 3), world rotations per joint, sole points (F, 2, 3, 3)."""
    skeleton = motion.skeleton
    offsets, tips = (
        np.array(skeleton.offsets),
        np.array(skeleton.soles),
    )  # SciPy takes no read-only ones
    quaternions = np.array(motion.rotations)
    positions = np.empty((len(motion), len(skeleton), 3))
    world = []
    for joint, parent in enumerate(skeleton.parents):
        local = Rotation.from_quat(quaternions[:, joint])
        if parent < 0:
            positions[:, joint] = motion.root_position
            world.append(local)
        else:
            positions[:, joint] = positions[:, parent] + world[parent].apply(offsets[joint])
            world.append(world[parent] * local)
    soles = np.empty((len(motion), 2, 3, 3))
    for side, name in enumerate(SIDES):
        for point, part in enumerate(("Foot", "Foot", "Toes")):
            joint = skeleton.index(name + part)
            soles[:, side, point] = positions[:, joint] + world[joint].apply(tips[side, point])
    return positions, world, soles


def ground_height(ground, x, z):
    """Height of the ground of a motion's label."""
    if ground["kind"] == "flat":
        return np.full(x.shape, ground["height"])
    if ground["kind"] == "slope":
        return z * np.tan(np.radians(ground["deg"]))
    if ground["kind"] == "stairs":
        climbed = np.floor((z - ground["start"]) / ground["tread"] + 1e-9) + 1.0
        return ground["rise"] * np.clip(climbed, 0.0, ground["count"])
    if ground["kind"] == "boxes":
        return ground_height(ground["ground"], x, z) + on_boxes(ground["boxes"], x, z)
    height = np.reshape(ground["height"], ground["shape"])
    u = np.clip((x - ground["origin"][0]) / ground["cell"], 0.0, height.shape[1] - 1 - 1e-9)
    v = np.clip((z - ground["origin"][1]) / ground["cell"], 0.0, height.shape[0] - 1 - 1e-9)
    i, j = v.astype(int), u.astype(int)
    a, b = v - i, u - j
    near = (1.0 - b) * height[i, j] + b * height[i, j + 1]
    return (1.0 - a) * near + a * ((1.0 - b) * height[i + 1, j] + b * height[i + 1, j + 1])


def on_boxes(boxes, x, z):
    """What the highest box over each point adds."""
    at, out = shapely.points(x, z), np.zeros(x.shape)
    for box in boxes:
        outline = shapely.Polygon(box["points"])
        out = np.where(shapely.covers(outline, at), np.maximum(out, box["height"]), out)
    return out


def over(motion, points):
    """(3 or 5, ...) meters over the ground; beside a riser read on both sides too, 1 mm off."""
    ground = json.loads(motion.labels.ground)
    aside = 1e-3 if ground["kind"] in ("stairs", "boxes") else 0.0
    ways = [(0.0, 0.0), (0.0, aside), (0.0, -aside)]
    ways += [(aside, 0.0), (-aside, 0.0)] if ground["kind"] == "boxes" else []
    x, y, z = np.moveaxis(points, -1, 0)
    return np.stack([y - ground_height(ground, x + d, z + e) for d, e in ways])


def runs(flags):
    """[start, stop) of each run of True."""
    return np.flatnonzero(np.diff(np.concatenate([[0], flags.astype(int), [0]]))).reshape(-1, 2)


def seen_footsteps(motion, positions, soles):
    """Per footstep: N and heading in every frame in which heel and ball bear, or None."""
    labels, out = motion.labels, []
    for i, (side, when) in enumerate(zip(labels.footstep_side, labels.footstep_time, strict=True)):
        again = np.flatnonzero(labels.footstep_side[i + 1 :] == side)
        until = labels.footstep_time[i + 1 + again[0]] if again.size else np.inf
        times = np.arange(len(motion)) / motion.fps
        here = (times >= when - 1e-6) & (times < until - 1e-6)
        here &= motion.contacts[:, side, HEEL] & motion.contacts[:, side, BALL]
        if not here.any():
            out.append(None)
            continue
        heel, ball = soles[here, side, HEEL], soles[here, side, BALL]
        ankle = positions[here, motion.skeleton.index(f"{SIDES[side]}Foot")]
        along = (ball - heel) / np.linalg.norm(ball - heel, axis=-1, keepdims=True)
        foot = heel + ((ankle - heel) * along).sum(-1, keepdims=True) * along
        out.append((foot, np.arctan2(along[:, 0], along[:, 2])))
    return out


def judge(motion):
    """Every figure of :data:`BARS`."""
    assert np.isfinite(motion.rotations).all()
    assert np.isfinite(motion.root_position).all()
    positions, world, soles = posed(motion)
    above, down = over(motion, soles), motion.contacts
    return {
        **_feet(soles, above, down, json.loads(motion.labels.ground)["kind"] in ("flat", "slope")),
        **_legs(motion, positions, world, down),
        **_smoothness(motion),
        **_footsteps(motion, positions, soles),
        **_landings(motion),
        "label_errors": _label_errors(motion),
    }


def broken(motion, *, but=()):
    """The promises that fall short, with their figures; those named ``but`` are not asked."""
    figures = judge(motion)
    assert figures.keys() == BARS.keys()
    return {
        name: figures[name]
        for name, (bar, which) in BARS.items()
        if name not in but
        and not (figures[name] <= bar if which == "most" else figures[name] >= bar)
    }


def _feet(soles, read, down, plane):
    above = read.max(0)
    slip = 0.0
    for side in range(2):
        for point in range(3):
            for a, b in runs(down[:, side, point]):
                path = soles[a:b, side, point]
                slip = max(slip, np.linalg.norm(path - path[0], axis=-1).max())
    still = np.linalg.norm(np.diff(soles, axis=0), axis=-1) < 1e-10
    touches = np.abs(above) < 1e-10
    bears = still[1:] & still[:-1] & touches[1:-1]  # since the frame before, until the next
    # toes that reach over an edge bear nothing
    flat = down[..., HEEL] & down[..., BALL] & (plane | (above[..., TOE] < 0.01))
    return {
        "slip_mm": 1e3 * slip,
        "penetration_mm": 1e3 * max(0.0, -above.min()),
        "float_mm": 1e3 * np.abs(read).min(0)[down].max(),
        "unsupported_frames": int((~down.any((1, 2))).sum()),
        "unflagged_bearing": int((bears & ~down[1:-1]).sum()),
        "flat_without_all_flags": int((flat & ~down[..., TOE]).sum()),
    }


def along_soles(motion):
    """(F, 2, 18) least meters of points of each sole's line over the ground, heel to toe tip."""
    soles = posed(motion)[2]
    share = np.linspace(0.0, 1.0, 9)[:, None]
    parts = [
        soles[..., [k], :] + share * (soles[..., [k + 1], :] - soles[..., [k], :]) for k in (0, 1)
    ]
    return over(motion, np.concatenate(parts, axis=2))


def shins_into_ground(motion):
    """Deepest that a shin is in the ground, meters."""
    positions, _, _ = posed(motion)
    deepest = 0.0
    for side in SIDES:
        knee, ankle = (
            positions[:, motion.skeleton.index(side + part)] for part in ("LowerLeg", "Foot")
        )
        for share in np.linspace(0.0, 1.0, 17):
            above = over(motion, knee + share * (ankle - knee)).max(0)
            deepest = max(deepest, -above.min())
    return deepest


def overhang(motion):
    """Largest share of a flat bearing sole with nothing under it."""
    _, _, soles = posed(motion)
    hangs = (along_soles(motion).min(0) > 0.01).mean(-1)
    flat = motion.contacts[..., BALL] & (np.abs(soles[..., HEEL, 1] - soles[..., BALL, 1]) < 2e-3)
    return float(hangs[flat].max(initial=0.0))


def _legs(motion, positions, world, down):
    skeleton, least, backward, bones = motion.skeleton, np.inf, 0.0, 0.0
    for side, name in enumerate(SIDES):
        hip, knee, ankle = (
            positions[:, skeleton.index(name + part)] for part in ("UpperLeg", "LowerLeg", "Foot")
        )
        thigh, shin = knee - hip, ankle - knee
        for bone, part in ((thigh, "LowerLeg"), (shin, "Foot")):
            rest = np.linalg.norm(skeleton.offsets[skeleton.index(name + part)])
            bones = max(bones, np.abs(np.linalg.norm(bone, axis=-1) - rest).max())
        sine = np.linalg.norm(np.cross(thigh, shin), axis=-1)
        flexion = np.degrees(np.arctan2(sine, (thigh * shin).sum(-1)))
        least = min(least, flexion[down[:, side].any(-1)].min(initial=np.inf))
        # the knee lies before the line from hip to ankle, as the pelvis sees it
        line = ankle - hip
        share = ((knee - hip) * line).sum(-1, keepdims=True) / (line**2).sum(-1, keepdims=True)
        bulge = (knee - hip - share * line) * world[0].apply([0.0, 0.0, 1.0])
        backward = max(backward, -bulge.sum(-1).min())
    return {
        "bone_error_mm": 1e3 * bones,
        "stance_knee_deg": least,
        "knee_backward_mm": 1e3 * backward,
    }


def _smoothness(motion):
    q, fps = motion.rotations, motion.fps
    apart = max(1, round(fps / 60.0))
    between = q[apart:] - q[:-apart]
    other = q[apart:] + q[:-apart]
    chord = np.minimum(np.linalg.norm(between, axis=-1), np.linalg.norm(other, axis=-1))
    turn = 4.0 * np.arcsin(np.clip(0.5 * chord, 0.0, 1.0))
    return {
        "joint_deg_per_60th": float(np.degrees(turn).max(initial=0.0)) * fps / (60.0 * apart),
        "quaternion_flips": int(((q[1:] * q[:-1]).sum(-1) < 0.0).sum()),
        "quaternion_norm_error": float(np.abs(np.linalg.norm(q, axis=-1) - 1.0).max()),
    }


def _footsteps(motion, positions, soles):
    error, turned, unseen = 0.0, 0.0, 0
    seen = seen_footsteps(motion, positions, soles)
    for i, found in enumerate(seen):
        if found is None:
            unseen += 1
            continue
        foot, heading = found
        off = np.linalg.norm(foot - motion.labels.footstep_position[i], axis=-1)
        apart = np.angle(np.exp(1j * (heading - motion.labels.footstep_heading[i])))
        error, turned = max(error, off.max()), max(turned, np.abs(apart).max())
    return {
        "footstep_error_mm": 1e3 * error,
        "footstep_heading_error_rad": turned,
        "footsteps_unseen": unseen,
    }


def _landings(motion):
    """Footsteps whose contact does not begin in the first frame at or after their time."""
    labels, wrong = motion.labels, 0
    for side, when in zip(labels.footstep_side[2:], labels.footstep_time[2:], strict=True):
        first = int(np.ceil(when * motion.fps - 1e-6))
        if first < len(motion) and not motion.contacts[first, side].any():
            wrong += 1
        if motion.contacts[first - 1, side].any():
            wrong += 1
    return {"landings_at_wrong_frames": wrong}


def _label_errors(motion):
    """Frames whose step or phase is not what the footsteps' times say."""
    labels = motion.labels
    times, landed = np.arange(len(motion)) / motion.fps, labels.footstep_time
    step = np.clip(np.searchsorted(landed, times + 1e-9, side="right"), 2, len(landed) - 1)
    since = (times - landed[step - 1]) / (landed[step] - landed[step - 1])
    wrong = (labels.step != step) | (np.abs(labels.phase - np.clip(since, 0.0, 1.0)) > 1e-6)
    return int(wrong.sum())
