"""All figures of a motion, by name; what cannot be had is None and a note says why."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import HEEL, SIDES, TOE
from gaitsmith.gait.learn import walking_speed
from gaitsmith.measures.body_motion import (
    arm_figures,
    head_pitch_range,
    hip_figures,
    trunk_lean,
)
from gaitsmith.measures.course import course_figures
from gaitsmith.measures.finding import SLOWEST_WALK, figure_of
from gaitsmith.measures.footing import contact_figures, floor_figures, skating_figures
from gaitsmith.measures.gait import flight, step_figures, stride_figures
from gaitsmith.measures.legs import backward, knee_flexion, segment_gap
from gaitsmith.measures.notes import Figures, explained
from gaitsmith.measures.promises import promises
from gaitsmith.measures.smoothness import continuity_figures, jerk_rms
from gaitsmith.measures.steps import Steps, steps_of
from gaitsmith.motion.skeleton import HUMANOID

if TYPE_CHECKING:
    from gaitsmith.measures.figure import Figure
    from gaitsmith.motion.motion import Motion

#: Seconds without ground in a usual step that are no error of the events.
_FLIGHT = 0.02
_PROMISED = ("path_error_p95_m", "goal_error_m")
_ARMS = tuple(f"{side}{part}" for side in SIDES for part in ("UpperArm", "LowerArm", "Hand"))
_NO_ARMS: Figures = dict.fromkeys(
    ("arm_swing_left_deg", "arm_swing_right_deg", "arm_against_leg", "wrist_ldj")
)


def measured(motion: Motion) -> Figures:
    """Every figure of ``motion``; ``docs/reference/json.md`` has unit and definition of each.

    Raises
    ------
    InfeasibleError
        If the joints are no person's, or it has fewer than two frames.
    """
    notes: list[str] = []
    figure = figure_of(motion, notes)
    steps = steps_of(figure.footsteps, figure.labels)
    found = {
        **_facts(motion, figure),
        **floor_figures(figure, notes),
        **contact_figures(figure, notes),
        **skating_figures(figure, notes),
        **_legs(figure, notes),
        **continuity_figures(motion, notes),
        **_gait(figure, steps, notes),
        **_body(figure, steps, notes),
        **course_figures(figure, steps),
        **_of_labels(figure, notes),
    }
    odd = [k for k, v in found.items() if isinstance(v, float) and not math.isfinite(v)]
    found |= dict.fromkeys(odd)
    explained(dict.fromkeys(odd), "no number came out", notes)
    return {**found, "notes": notes}


def _facts(motion: Motion, figure: Figure) -> Figures:
    names = set(motion.skeleton.names)
    canonical = {name for name, _ in HUMANOID}
    return {
        "frames": len(motion),
        "fps": motion.fps,
        "duration_s": motion.duration,
        "joints": len(motion.skeleton),
        "skeleton": "gaitsmith" if canonical <= names else "recognized",
        "roles_missing": [name for name, _ in HUMANOID if name not in figure.joints],
        "height_m": figure.height,
        "contacts": "file" if figure.exact else "estimated",
        "footsteps": "file" if figure.footsteps.exact else "estimated",
    }


def _legs(figure: Figure, notes: list[str]) -> Figures:
    """Knees while they bear, and the room between the legs."""
    least, wrong = math.inf, 0.0
    bones: list[list[tuple[np.ndarray, np.ndarray]]] = []
    for side, name in enumerate(SIDES):
        hip, knee, ankle = (figure.at(f"{name}{p}") for p in ("UpperLeg", "LowerLeg", "Foot"))
        back = backward(hip, knee, ankle, figure.ahead)
        bent = np.where(back > 0.0, -back, knee_flexion(hip, knee, ankle))
        least = min(least, float(bent[figure.bearing[:, side]].min(initial=np.inf)))
        wrong = max(wrong, float(back.max()))
        foot = figure.soles[:, side]
        bones.append([(knee, ankle), (foot[:, HEEL], foot[:, TOE])])
    gaps = [[float(segment_gap(*a, *b).min()) for b in bones[1]] for a in bones[0]]
    knee = None if math.isinf(least) else float(np.degrees(least))
    explained({"knee_min_deg": knee}, "no foot bears", notes)
    return {
        "knee_min_deg": knee,
        "knee_backward_deg_max": float(np.degrees(wrong)),
        "foot_gap_mm_min": 1e3 * gaps[1][1],
        "leg_gap_mm_min": 1e3 * min(min(row) for row in gaps),
    }


def _gait(figure: Figure, steps: Steps, notes: list[str]) -> Figures:
    """Gait parameters, all None where nobody walks."""
    feet = figure.footsteps
    landed = len(feet) - 2 if feet.exact else int(np.isfinite(feet.time).sum())
    flying = flight(feet)
    if flying > _FLIGHT:
        notes.append(f"no foot is on the ground for {flying:.2f} s of a usual step: running")
    alone, whole = step_figures(feet, steps), stride_figures(figure, steps)
    speed = walking_speed(figure.motion.with_(root_position=figure.hips))
    if not feet.exact and speed < SLOWEST_WALK:
        alone, whole = dict.fromkeys(alone), dict.fromkeys(whole)
        explained(alone | whole, f"nobody walks, the hips get ahead at {speed:.2f} m/s", notes)
    else:
        explained(alone, "too few steps that are alike", notes)
        explained(whole, "no steady stride from landing to landing of a foot", notes)
    return {"steps": max(landed, 0), **alone, **whole}


def _body(figure: Figure, steps: Steps, notes: list[str]) -> Figures:
    """Hips, trunk, arms, head, smoothness."""
    stride = "no steady stride"
    out = explained(hip_figures(figure, steps), stride, notes)
    lean = trunk_lean(figure, steps)
    out |= explained({"trunk_lean_deg": lean}, "no shoulders, neck or head", notes)
    if figure.has(*_ARMS):
        out |= explained(arm_figures(figure, steps), f"{stride}, or arms that do not move", notes)
    else:
        missing = ", ".join(role for role in _ARMS if not figure.has(role))
        out |= explained(_NO_ARMS, f"no joint is recognized as {missing}", notes)
    nod = head_pitch_range(figure, steps)
    why = stride if figure.has("head") else "no joint is recognized as head"
    out |= explained({"head_pitch_range_deg": nod}, why, notes)
    jerk = jerk_rms(figure.hips, figure.motion.fps)
    return out | explained({"pelvis_jerk_rms_mps3": jerk}, "under 0.1 s", notes)


def _of_labels(figure: Figure, notes: list[str]) -> Figures:
    """What a generated motion promises, measured by :func:`promises`; it has the last word."""
    out: Figures = dict.fromkeys(_PROMISED)
    why = "the file names no path"
    if figure.labels is not None and len(figure.labels.footstep_side) > 2:
        assert figure.ground is not None
        out |= promises(figure.motion, figure.ground)
        del out["knee_min_deg"]  # ours has a sign
    else:
        why = "no footsteps of a plan in the file"
    return explained(out, why, notes)
