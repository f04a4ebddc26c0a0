"""Walk data from the measured marker paths of one leg."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.body.body import Body, Foot
from gaitsmith.body.sole import roll, rolled_ankle
from gaitsmith.errors import InvalidInputError
from gaitsmith.geometry.curves import smoothstep
from gaitsmith.geometry.signals import butterworth_zero_lag
from gaitsmith.motion.motion import Markers
from gaitsmith.walks.data import Character, TimedSequence, WalkData
from gaitsmith.walks.generalize import ankle_at_heel_strike, generalize, hip_height

if TYPE_CHECKING:
    from pathlib import Path

    from jaxtyping import Bool, Float

#: Markers that extraction reads. The ball is the fifth metatarsal.
MARKERS = ("hip", "knee", "ankle", "heel", "ball", "toe")
#: Straightest knee at heel strike: with marker data the hip-ankle distance can exceed the leg.
STRAIGHTEST_KNEE = float(np.radians(172.0))
#: Part of a step over which the hips ease into the height of a heel strike.
EASE = 0.40
FLAT_PHASES = (0.25, 0.60)


@dataclass(frozen=True)
class Extraction:
    """Walk data and how it was found: frames of the events, measured foot, step time."""

    walk: WalkData
    heel_strikes: tuple[int, int]
    toe_off_frame: int
    step_time: float


def read_winter_table(path: Path) -> Markers:
    """Markers of the sagittal table A.1 of Winter's book as CSV (x, y per marker, meters)."""
    header = path.read_text(encoding="utf-8").splitlines()[0].split(",")
    table = np.loadtxt(path, delimiter=",", skiprows=1)
    time = table[:, header.index("time_s")]
    positions = np.zeros((len(table), len(MARKERS), 3))
    for i, name in enumerate(MARKERS):
        column = "mt5" if name == "ball" else name
        positions[:, i, 2] = table[:, header.index(f"{column}_x")]
        positions[:, i, 1] = table[:, header.index(f"{column}_y")]
    return Markers(MARKERS, positions, (len(time) - 1) / (time[-1] - time[0]))


def extract(
    markers: Markers,
    body: Body,
    *,
    cutoff: float | None = 6.0,
    events: tuple[int, int, int] | None = None,
    center: bool = False,
) -> Extraction:
    """Six timed sequences from markers of one leg over one stride.

    Parameters
    ----------
    markers
        Paths of :data:`MARKERS`, walking along +Z; x is not read. At least one heel strike
        to the next of the same foot.
    body
        Whose legs these are: gives the leg length, which markers on the skin do not. Its foot
        is replaced by the one measured here.
    cutoff
        Low-pass, Hz; None where the paths are smooth already.
    events
        Frames of two heel strikes of the leg and of the toe-off between them, where they are
        known; None: found in the paths.
    center
        Whether ``hip`` is the middle of both hips, known exactly, and not a marker on the skin
        of one side: then the legs keep their measured length through the stance.

    Returns
    -------
    The walk data belong to ``body`` with the measured foot, symmetric, all ends consistent.

    Raises
    ------
    InvalidInputError
        If no full stride is found.

    Notes
    -----
    Symmetry between left and right is assumed: the hip path is the mean of both half
    strides. The sole is the heel-ball line of the flat foot: its height and tilt are those of
    the markers on the skin, not of the floor, and both are removed.
    """
    rate = markers.rate
    paths = {name: markers[name][:, [2, 1]] for name in MARKERS}
    if cutoff is not None:
        paths = {
            name: butterworth_zero_lag(path, cutoff=cutoff, rate=rate)
            for name, path in paths.items()
        }
    first, last, off = _events(paths, rate) if events is None else events
    frames_per_step = 0.5 * (last - first)
    phase = (np.arange(len(markers.positions)) - first) / frames_per_step
    flat = (phase >= FLAT_PHASES[0]) & (phase <= FLAT_PHASES[1])
    pitch, meta = _sole_angles(paths, flat)
    foot = _measured_foot(paths, flat)
    floor = paths["ankle"][flat, 1].mean() - foot.ankle_height
    here = float(paths["ankle"][flat, 0].mean())
    length = 0.5 * float(paths["heel"][last, 0] - paths["heel"][first, 0])
    toe_off = float(phase[off] - 1.0)

    level = _crossing(phase, np.abs(pitch), np.radians(2.0), after=0.0, rising=False)
    heel_off = _crossing(phase, -pitch, np.radians(2.0), after=level + 0.1, rising=True)
    meta_off = _crossing(phase, meta, np.radians(8.0), after=heel_off, rising=True)

    foot1 = _landing(phase, pitch, level)
    foot2 = _heel_rise(phase, pitch, level, heel_off, 1.0 + toe_off)
    hip = _mean_hip(phase, paths["hip"] - [here, floor], length)
    measured = _read(phase, paths["ankle"][:, 1] - floor, hip.times)
    if not center:
        hip = _as_far_from_the_ankle(hip, measured, foot, foot1, foot2)
    swing = _between(phase, 1.0 + toe_off, 2.0)
    ankle = _read(phase, paths["ankle"], swing) - [here + length, floor]
    strike_ankle = ankle[-1] - hip.values[-1]
    kappa = float(0.5 * (-hip.values[0, 0] + length - hip.values[-1, 0]) / length)
    if center:
        # The leg at heel strike as measured, on a foot that will not move any more: a living
        # heel still rolls and slides forward by some centimeters until the foot is flat.
        rocker = ankle_at_heel_strike(foot, 0.0, float(pitch[first]))[0]
        kappa = float((strike_ankle[0] - rocker) / length)
    character = Character(
        ratio=length / body.leg_length,
        knee=_interior_knee(body, float(np.hypot(*strike_ankle))),
        strike_pitch=float(pitch[first]),
        off_pitch=float(-pitch[off]),
        off_meta=float(meta[off]),
        kappa=kappa,
    )
    walk = WalkData(
        body=replace(body, foot=foot),
        previous_length=length,
        length=length,
        character=character,
        flat=level,
        heel_off=heel_off,
        meta_off=meta_off,
        toe_off=toe_off,
        hip=hip,
        foot1=foot1,
        foot2=foot2,
        foot3=TimedSequence(swing - 1.0, _read(phase, pitch, swing)),
        meta=_toe_rise(phase, meta, meta_off, 1.0 + toe_off),
        ankle=TimedSequence(swing - 1.0, ankle),
    )
    if center:
        reach = np.linalg.norm(_read(phase, paths["hip"] - paths["ankle"], hip.times), axis=-1)
        walk = _with_measured_legs(walk, reach)
    # the identity generalization makes all ends agree with the mu functions
    walk = generalize(walk, walk.body, length, length)
    return Extraction(walk, (first, last), off, frames_per_step / rate)


def _events(paths: dict[str, Float[np.ndarray, "n 2"]], rate: float) -> tuple[int, int, int]:
    """Frames of two heel strikes and of the toe-off before the second.

    The heel's farthest point ahead of the hips comes some frames before it bears, the toes'
    farthest point behind after they have left: both move to where the point is nearly still.
    """
    hip = paths["hip"][:, 0]
    walking = abs(hip[-1] - hip[0]) * rate / (len(hip) - 1)

    def speed(name: str) -> Float[np.ndarray, "n"]:
        return np.linalg.norm(np.gradient(paths[name], axis=0), axis=-1) * rate

    slow_heel, slow_toe = speed("heel") < 0.5 * walking, speed("toe") < 0.5 * walking
    strikes = []
    for peak in _peaks(paths["heel"][:, 0] - hip):
        later = np.flatnonzero(slow_heel[peak:])
        if later.size:
            strikes.append(int(peak + later[0]))
    offs = []
    for peak in _peaks(hip - paths["toe"][:, 0]):
        before = np.flatnonzero(slow_toe[: peak + 1])
        if before.size:
            offs.append(int(before[-1]))
    for first, last in pairwise(strikes):
        inside = [o for o in offs if first < o < last]
        if inside:
            return first, last, inside[0]
    raise InvalidInputError(
        f"no full stride found: heel strikes at frames {strikes}, toe-offs at {offs}; the markers "
        "must cover one heel strike to the next of the same foot"
    )


def _peaks(v: Float[np.ndarray, "n"]) -> list[int]:
    top = (v[1:-1] >= v[:-2]) & (v[1:-1] > v[2:]) & (v[1:-1] > v.mean())
    return [int(i) + 1 for i in np.flatnonzero(top)]


def _sole_angles(
    paths: dict[str, Float[np.ndarray, "n 2"]], flat: Bool[np.ndarray, "n"]
) -> tuple[Float[np.ndarray, "n"], Float[np.ndarray, "n"]]:
    """Sole pitch (toes up positive) and meta angle (toes against the floor), flat = 0."""

    def angle(tail: str, head: str) -> Float[np.ndarray, "n"]:
        d = paths[head] - paths[tail]
        a = np.unwrap(np.arctan2(d[:, 1], d[:, 0]))
        return a - a[flat].mean()

    return angle("heel", "ball"), -angle("ball", "toe")


def _measured_foot(paths: dict[str, Float[np.ndarray, "n 2"]], flat: Bool[np.ndarray, "n"]) -> Foot:
    sole = paths["ball"] - paths["heel"]
    along = sole / np.linalg.norm(sole, axis=-1, keepdims=True)
    ankle = paths["ankle"] - paths["heel"]
    heel = float((ankle * along).sum(-1)[flat].mean())
    height = float((along[:, 0] * ankle[:, 1] - along[:, 1] * ankle[:, 0])[flat].mean())
    length = float(np.linalg.norm(sole, axis=-1)[flat].mean())
    toes = float(np.linalg.norm(paths["toe"] - paths["ball"], axis=-1)[flat].mean())
    return Foot(ankle_height=height, heel=heel, ball=length - heel, toes=toes)


def _crossing(
    phase: Float[np.ndarray, "n"],
    value: Float[np.ndarray, "n"],
    level: float,
    *,
    after: float,
    rising: bool,
) -> float:
    """Phase at which ``value`` crosses ``level`` first after ``after``, between frames."""
    over = value > level if rising else value < level
    index = int(np.flatnonzero(over & (phase > after))[0])
    v0, v1 = value[index - 1], value[index]
    share = 1.0 if v1 == v0 else np.clip((level - v0) / (v1 - v0), 0.0, 1.0)
    return float(phase[index - 1] + share * (phase[index] - phase[index - 1]))


def _between(phase: Float[np.ndarray, "n"], first: float, last: float) -> Float[np.ndarray, "m"]:
    """``first``, the measured phases well inside, ``last``."""
    gap = 0.25 * (phase[1] - phase[0])
    return np.concatenate([[first], phase[(phase > first + gap) & (phase < last - gap)], [last]])


def _read(
    phase: Float[np.ndarray, "n"], value: Float[np.ndarray, "n *c"], at: Float[np.ndarray, "m"]
) -> Float[np.ndarray, "m *c"]:
    columns = value.reshape(len(phase), -1).T
    out = np.stack([np.interp(at, phase, column) for column in columns], axis=-1)
    return out[:, 0] if value.ndim == 1 else out


def _mean_hip(
    phase: Float[np.ndarray, "n"], hip: Float[np.ndarray, "n 2"], length: float
) -> TimedSequence:
    times = _between(phase, 0.0, 1.0)
    both = 0.5 * (_read(phase, hip, times) + _read(phase, hip, times + 1.0) - [length, 0.0])
    gap = both[-1] - both[0] - [length, 0.0]  # what keeps the mean stride from closing
    return TimedSequence(times, both + (0.5 - times)[:, None] * gap)


def _as_far_from_the_ankle(
    hip: TimedSequence,
    measured: Float[np.ndarray, "n"],
    foot: Foot,
    foot1: TimedSequence,
    foot2: TimedSequence,
) -> TimedSequence:
    """Hip path over the rigid foot's ankle as high as it was over the measured one.

    A living heel is round and soft: the measured ankle rises less at heel strike and begins
    to rise before the sole does. Left alone, those millimeters bend the knee too much in
    loading and lock it at mid-stance, where it is nearly straight. Faded out at both ends, which
    heel strikes determine.
    """
    t = hip.times
    pitch = np.where(t < foot2.times[0], foot1.at(t)[:, 0], foot2.at(t)[:, 0])
    modelled = roll(foot, pitch, np.zeros_like(pitch)).ankle[:, 1]
    fade = smoothstep(t / 0.30) * (1.0 - smoothstep((t - 0.72) / 0.20))
    values = np.array(hip.values)
    values[:, 1] += fade * (modelled - measured)
    return hip.with_values(values)


def _with_measured_legs(walk: WalkData, reach: Float[np.ndarray, "n"]) -> WalkData:
    """Hip path and heel rise with which the stance leg stays as long as measured.

    ``reach`` is the measured distance from hip to ankle at the times of ``walk.hip``. Heel
    strikes determine how high the hips end: lower than measured, where the measured foot slid
    on and a planted one does not. The path eases down to that height, and the heel rises so
    much later that the knee need not bend instead.
    """
    t, c, length, foot = walk.hip.times, walk.character, walk.length, walk.body.foot
    pitch = np.where(t < walk.flat, walk.foot1.at(t)[:, 0], walk.foot2.at(t)[:, 0])
    forward, up = np.array(walk.hip.values).T
    # one smooth dip about each heel strike, the same from both sides: no corner where steps meet
    near = (1.0 - smoothstep(t / EASE)) + (1.0 - smoothstep((1.0 - t) / EASE))
    forward += (-c.kappa * length - forward[0]) * near
    up -= (0.5 * (up[0] + up[-1]) - hip_height(c, walk.body, length)) * near
    hip = np.stack([forward, up], axis=-1)
    later = _later_heel(foot, hip, reach, pitch) * (t > walk.heel_off)
    times, rise = walk.foot2.times, walk.foot2.values[:, 0]
    fade = 1.0 - smoothstep((times - 1.0) / (0.8 * walk.toe_off))
    rise = np.minimum(rise + np.interp(times, t, later) * fade, 0.0)
    return walk.with_(
        hip=walk.hip.with_values(hip),
        foot2=walk.foot2.with_values(np.minimum.accumulate(rise)),
    )


def _later_heel(
    foot: Foot,
    hip: Float[np.ndarray, "n 2"],
    reach: Float[np.ndarray, "n"],
    pitch: Float[np.ndarray, "n"],
) -> Float[np.ndarray, "n"]:
    """How much less a raised heel must be raised for the ankle to be ``reach`` from the hip."""
    low, high = np.minimum(pitch, 0.0), np.zeros_like(pitch)
    for _ in range(40):
        middle = 0.5 * (low + high)
        near = np.linalg.norm(hip - rolled_ankle(foot, middle, 0.0), axis=-1) < reach
        low, high = np.where(near, middle, low), np.where(near, high, middle)
    return 0.5 * (low + high) - np.minimum(pitch, 0.0)


def _interior_knee(body: Body, distance: float) -> float:
    cosine = (body.thigh**2 + body.shin**2 - distance**2) / (2.0 * body.thigh * body.shin)
    return min(float(np.arccos(np.clip(cosine, -1.0, 1.0))), float(STRAIGHTEST_KNEE))


def _landing(
    phase: Float[np.ndarray, "n"], pitch: Float[np.ndarray, "n"], flat: float
) -> TimedSequence:
    """F1: from the strike's pitch down to exactly 0."""
    times = _between(phase, 0.0, flat)
    value = _read(phase, pitch, times)
    value = value - value[-1] * times / flat
    return TimedSequence(times, np.minimum.accumulate(np.maximum(value, 0.0)))


def _heel_rise(
    phase: Float[np.ndarray, "n"],
    pitch: Float[np.ndarray, "n"],
    flat: float,
    heel_off: float,
    toe_off: float,
) -> TimedSequence:
    """F2: 0 until the heel leaves, then falling; the onset eased over a tenth of a step.

    The measured pitch creeps to the threshold before; to begin there abruptly gives the knee
    a sharp valley at mid-stance.
    """
    times = np.concatenate([[flat], _between(phase, heel_off, toe_off)])
    value = _read(phase, pitch, times) * smoothstep((times - heel_off) / 0.1)
    value[times <= heel_off] = 0.0
    return TimedSequence(times, np.minimum.accumulate(np.minimum(value, 0.0)))


def _toe_rise(
    phase: Float[np.ndarray, "n"], meta: Float[np.ndarray, "n"], meta_off: float, toe_off: float
) -> TimedSequence:
    """M: from 0 at MOM, rising to toe-off."""
    times = _between(phase, meta_off, toe_off)
    value = _read(phase, meta, times)
    value = value - value[0] * (toe_off - times) / (toe_off - meta_off)
    return TimedSequence(times, np.maximum.accumulate(np.maximum(value, 0.0)))
