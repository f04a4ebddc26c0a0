"""Make the pictures of curved walking: docs/pictures/curve-*.

The paper's figures 14 to 16: steps of a plan, steps on a path, snapshots of a turning step; top
views with footprints, the way of the hips and of the swinging ankles; an animated turn; and,
where the measured data are at hand (GAITSMITH_DATA), a measured turn beside ours.
"""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

import gaitsmith
from gaitsmith.motion.kinematics import joint_positions
from gaitsmith.plan.paths import Path as WalkPath
from gaitsmith.viz import gif

TARGET = Path(__file__).parent.parent / "docs/pictures"
DATA = Path(os.environ.get("GAITSMITH_DATA", "../shared/data"))
TURN = "permissive/accad/Male2_B9_WalkTurnLeft90.bvh"
COLORS = ("#3567a8", "#b5543c")
#: Turn (deg) and length (m) of each given step; the last closes.
GIVEN = (
    (0, 0.5),
    (10, 0.6),
    (25, 0.55),
    (30, 0.5),
    (25, 0.5),
    (-10, 0.6),
    (-35, 0.6),
    (0, 0.6),
    (0, 0),
)


def steps() -> list[dict[str, object]]:
    """Rows of footsteps as somebody might set them by hand."""
    heading, here, side = 0.0, np.zeros(2), 1
    rows = [("L", 0.05, 0.0, 6.0), ("R", -0.05, 0.0, -6.0)]
    for turn, length in GIVEN:
        middle = heading + 0.5 * np.radians(turn)
        here = here + length * np.array([np.sin(middle), np.cos(middle)])
        heading, side = heading + np.radians(turn), 1 - side
        sign = 1 - 2 * side
        x, z = here + 0.055 * sign * np.array([np.cos(heading), -np.sin(heading)])
        rows.append(("LR"[side], float(x), float(z), float(np.degrees(heading)) + 6.0 * sign))
    return [{"side": s, "x": x, "z": z, "heading_deg": h} for s, x, z, h in rows]


def top_view(ax, motion: gaitsmith.Motion, title: str) -> None:
    """Footprints, path, hips, swinging ankles; the walker's left is up the page's left."""
    labels, positions, index = motion.labels, joint_positions(motion), motion.skeleton.index
    assert labels is not None
    assert motion.contacts is not None
    if labels.path is not None:
        ax.plot(*labels.path.T, color="0.6", ls="--", lw=1, label="path")
    body = motion.skeleton.soles
    back, front = (abs(float(body[0, 0, 2])), float(body[0, 1, 2]) + 0.07)
    for side, spot, heading in zip(
        labels.footstep_side, labels.footstep_position, labels.footstep_heading, strict=True
    ):
        way, left = (
            np.array([np.sin(heading), np.cos(heading)]),
            np.array([np.cos(heading), -np.sin(heading)]),
        )
        t = np.linspace(0, 2 * np.pi, 40)
        along = 0.5 * (front - back) + 0.5 * (front + back) * np.cos(t)
        shape = spot[[0, 2]] + along[:, None] * way + 0.045 * np.sin(t)[:, None] * left
        ax.fill(*shape.T, color=COLORS[side], alpha=0.35, lw=0)
    for side, name in enumerate(("left", "right")):
        ankle = positions[:, index(f"{name}Foot")][:, [0, 2]].copy()
        ankle[motion.contacts[:, side].any(-1)] = np.nan
        ax.plot(*ankle.T, color=COLORS[side], lw=0.9)
    ax.plot(*motion.root_position[:, [0, 2]].T, color="k", lw=1.2, label="hips")
    ax.set_aspect("equal")
    ax.invert_xaxis()
    ax.set_title(title, fontsize=9)
    ax.tick_params(labelsize=7)


def top_views(path: Path) -> None:
    """Six walks from above."""
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot as plt

    walks = {
        "circle, 1.2 m": {"path": WalkPath.arc(1.2, 2 * np.pi)},
        "circle, 0.6 m": {"path": WalkPath.arc(0.6, -2 * np.pi)},
        "corner of 90 deg, 0.6 m": {"path": WalkPath.rounded([[0, 0], [0, 2.5], [2.5, 2.5]])},
        "figure eight, 6 m": {"path": WalkPath.figure_eight(6.0)},
        "through 0,0 0,4 2,7": {"path": "0,0 0,4 2,7"},
        "given footsteps": {"steps": steps()},
    }
    figure, axes = plt.subplots(2, 3, figsize=(11, 8))
    for ax, (title, where) in zip(axes.flat, walks.items(), strict=True):
        top_view(ax, gaitsmith.walk(fps=120, gait="neutral", **where), title)  # type: ignore[arg-type]
    axes[0, 0].legend(frameon=False, fontsize=7)
    figure.tight_layout()
    figure.savefig(path, dpi=80, metadata={"Software": None})
    plt.close(figure)


def stick(ax, motion: gaitsmith.Motion, frame: int, shift: float, view: float) -> None:
    """One pose as sticks, seen from heading ``view``."""
    points, skeleton = joint_positions(motion)[frame], motion.skeleton
    right = np.array([np.cos(view), 0.0, -np.sin(view)])
    x, y = (points - points[0]) @ -right + shift, points[:, 1]
    for joint, parent in enumerate(skeleton.parents):
        name = skeleton.names[joint]
        color = COLORS[0] if name.startswith("left") else COLORS[1]
        color = color if name.startswith(("left", "right")) else "0.3"
        if parent >= 0:
            ax.plot(x[[parent, joint]], y[[parent, joint]], color=color, lw=1.8)
    head = skeleton.index("head")
    ax.plot(x[head], y[head] + 0.1, "o", color="0.3", ms=8)


def turning_step(path: Path) -> None:
    """[KB92a] figure 16: snapshots of a turning step, from behind and from above."""
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot as plt

    motion = gaitsmith.walk(
        path=WalkPath.rounded([[0, 0], [0, 2.5], [2.5, 2.5]]), fps=120, gait="neutral"
    )
    labels = motion.labels
    assert labels is not None
    turn = np.diff(labels.footstep_heading[2:])
    step = int(np.abs(turn).argmax()) + 2
    first, last = labels.footstep_time[step - 1] * 120, labels.footstep_time[step + 1] * 120
    frames = np.linspace(first, last, 9).astype(int)
    figure, axes = plt.subplots(2, 1, figsize=(11, 6))
    for ax, view, name in zip(
        axes, (0.0, np.pi / 2), ("from behind", "from the inside"), strict=True
    ):
        for i, frame in enumerate(frames):
            stick(ax, motion, int(frame), 0.9 * i, view)
        ax.set_aspect("equal")
        ax.axhline(0.0, color="0.7", lw=0.8)
        ax.set_axis_off()
        ax.set_title(f"a turning step, {name}", fontsize=9, loc="left")
    figure.tight_layout()
    figure.savefig(path, dpi=80, metadata={"Software": None})
    plt.close(figure)


def yaw(across: np.ndarray) -> np.ndarray:
    """Heading of what has ``across`` to its left, unwrapped degrees."""
    return np.degrees(np.unwrap(np.arctan2(-across[:, 2], across[:, 0])))


def series(motion: gaitsmith.Motion, names: dict[str, str]) -> dict[str, np.ndarray]:
    """Yaw of pelvis, thorax, head (degrees from the start), trunk roll, way and speed."""
    from gaitsmith.geometry.rotations import rotate
    from gaitsmith.motion.kinematics import motion_kinematics

    positions, world = motion_kinematics(motion)
    index = motion.skeleton.index

    def of(role: str) -> np.ndarray:
        return positions[:, index(names[role])]

    hips = of("leftUpperLeg") - of("rightUpperLeg")
    thorax = of("leftUpperArm") - of("rightUpperArm")
    q = world[:, index(names["head"])]
    first = rotate(q[:1] * [-1, -1, -1, 1], np.array([[0.0, 0.0, 1.0]]))
    forward = rotate(q, np.broadcast_to(first, (len(q), 3)))
    head = np.degrees(np.unwrap(np.arctan2(forward[:, 0], forward[:, 2])))
    middle = 0.5 * (of("leftUpperLeg") + of("rightUpperLeg"))
    left = hips / np.linalg.norm(hips[:, [0, 2]], axis=1)[:, None]
    up = 0.5 * (of("leftUpperArm") + of("rightUpperArm")) - middle
    step = max(1, round(motion.fps / 30))
    way = middle[::step, [0, 2]]
    wide = round(0.5 * motion.fps / step)
    speed = np.linalg.norm(way[wide:] - way[:-wide], axis=1) * motion.fps / step / wide
    return {
        "time": np.arange(len(q)) / motion.fps,
        "pelvis": yaw(hips),
        "thorax": yaw(thorax),
        "head": head,
        "roll": np.degrees(np.arctan2((up * left)[:, [0, 2]].sum(1), up[:, 1])),
        "way": middle[:, [0, 2]],
        "ankles": np.stack([of("leftFoot"), of("rightFoot")], axis=1),
        "speed": speed,
        "speed_time": (np.arange(len(speed)) + 0.5 * wide) * step / motion.fps,
    }


def smooth(values: np.ndarray, fps: float, seconds: float = 1.0) -> np.ndarray:
    """Running mean over about a stride."""
    count = max(1, round(fps * seconds))
    padded = np.pad(values, (count // 2, count - 1 - count // 2), mode="edge")
    return np.convolve(padded, np.ones(count) / count, mode="valid")


def measured_turn(path: Path) -> dict[str, float]:
    """A man who turns left by 90 deg, and ours along the way of his hips at his speed."""
    import warnings

    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot as plt

    from gaitsmith.motion.roles import humanoid_roles

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        man = gaitsmith.load(DATA / TURN)
        roles = humanoid_roles(man.skeleton.names, man.skeleton.parents)
        names = {role: man.skeleton.names[joint] for role, joint in roles.joints.items()}
        his = series(man, names)
        way = np.stack([smooth(v, man.fps, 0.8) for v in his["way"].T], axis=-1)
        way = way[10:-10]
        points = way[:: max(1, round(man.fps / 5))]
        motion = gaitsmith.walk(
            path=points,
            body=1.83,
            gait="neutral",
            start="walk",
            stop="walk",
            fps=120,
            speed=float(np.percentile(his["speed"], 90)),
        )
        ours = series(motion, {role: role for role in names})
    figure, axes = plt.subplots(1, 3, figsize=(12, 4))
    facts: dict[str, float] = {}
    for who, data, fps, color in (("man", his, man.fps, "k"), ("ours", ours, 120.0, "#2a7")):
        axes[0].plot(*data["way"].T, color=color, lw=1.2, label=who)
        for side in (0, 1):
            ankle = data["ankles"][:, side]
            still = np.linalg.norm(np.gradient(ankle, axis=0), axis=1) * fps < 0.15
            axes[0].plot(*ankle[still][:, [0, 2]].T, ".", color=color, ms=3, alpha=0.4)
        turned = {k: smooth(data[k] - data["pelvis"][0], fps, 0.4) for k in ("pelvis", "head")}
        turned["thorax"] = smooth(data["thorax"] - data["pelvis"][0], fps, 0.4)
        half = 0.5 * (turned["pelvis"][-1] + turned["pelvis"][0])
        at = {k: float(data["time"][np.flatnonzero(v >= half)[0]]) for k, v in turned.items()}
        middle = at["pelvis"]
        for name, style in (("head", ":"), ("thorax", "--"), ("pelvis", "-")):
            axes[1].plot(
                data["time"] - middle,
                turned[name],
                style,
                color=color,
                lw=1.2,
                label=f"{name}, {who}",
            )
        axes[2].plot(data["speed_time"] - middle, data["speed"], color=color, lw=1.2, label=who)
        facts[f"head lead {who} (s)"] = middle - at["head"]
        facts[f"thorax lead {who} (s)"] = middle - at["thorax"]
        facts[f"slowest over fastest {who}"] = float(
            data["speed"].min() / np.percentile(data["speed"], 95)
        )
        roll = smooth(data["roll"], fps, 1.1)
        near = np.abs(data["time"] - middle) < 0.6
        facts[f"trunk roll inside {who} (deg)"] = float(roll[near].mean() - roll[:10].mean())
        ten, ninety = (
            turned["pelvis"][0] + s * (turned["pelvis"][-1] - turned["pelvis"][0])
            for s in (0.1, 0.9)
        )
        facts[f"pelvis 10-90 % {who} (s)"] = float(
            data["time"][np.flatnonzero(turned["pelvis"] >= ninety)[0]]
            - data["time"][np.flatnonzero(turned["pelvis"] >= ten)[0]]
        )
    axes[0].set_aspect("equal")
    axes[0].invert_xaxis()
    axes[0].set_title("hips and standing ankles from above (m)", fontsize=9)
    axes[1].set_title("yaw (deg) around half the turn (s)", fontsize=9)
    axes[2].set_title("speed over 0.5 s (m/s)", fontsize=9)
    for ax in axes:
        ax.legend(frameon=False, fontsize=7)
        ax.tick_params(labelsize=7)
    figure.tight_layout()
    figure.savefig(path, dpi=80, metadata={"Software": None})
    plt.close(figure)
    return facts


def main() -> None:
    """Make them all."""
    TARGET.mkdir(parents=True, exist_ok=True)
    top_views(TARGET / "curve-above.png")
    turning_step(TARGET / "curve-turning-step.png")
    corner = WalkPath.rounded([[0, 0], [0, 2.2], [2.2, 2.2]])
    gif(gaitsmith.walk(path=corner, gait="neutral"), TARGET / "curve-turn.gif", width=360, fps=12.5)
    if (DATA / TURN).exists():
        for name, value in measured_turn(TARGET / "curve-measured.png").items():
            print(f"{name}: {value:.2f}")
    else:
        print(f"no {DATA / TURN}: the measured turn is left out")


if __name__ == "__main__":
    main()
