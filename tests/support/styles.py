"""Synthetic walks to mix: `neutral` with other postures, swings, times and steps, by a seed."""

from __future__ import annotations

from functools import cache

import numpy as np

from gaitsmith.conventions import BALL
from gaitsmith.gait.cycle import EVENTS
from gaitsmith.gait.neutral import neutral_cycle, subject
from gaitsmith.geometry.rotations import exp, inverse, log, multiply
from gaitsmith.motion.kinematics import forward_kinematics, sole_positions
from gaitsmith.style.align import SAMPLES, mapped, timing_of
from gaitsmith.style.examples import examples_of
from gaitsmith.style.parts import parts_of
from gaitsmith.style.restyle import restyled
from gaitsmith.style.rules import RULES

SKELETON = neutral_cycle().skeleton


@cache
def synthetic(seed):
    """A walk of the neutral man that only ``seed`` tells: other times, another upper body.

    Its feet stand as still as his.
    """
    cycle = neutral_cycle()
    if seed == 0:
        return cycle
    rng = np.random.default_rng(seed)
    own = timing_of(cycle)
    slots = own.slots + np.array([0.0, *(0.012 * np.clip(rng.normal(size=7), -1.5, 1.5))])
    phase = np.arange(SAMPLES) / SAMPLES
    early = mapped(slots, own.slots, phase)
    center, turned = cycle.at(early)
    # the same feet on the same places, at other times
    center[:, 2] += (early - phase) * cycle.stride_length
    upper = [j for p in ("torso_head", "left_arm", "right_arm") for j in parts_of(SKELETON)[p]]
    turned[:, upper] = multiply(turned[:, upper], exp(_waves(rng, phase, len(upper), 0.15)))
    contacts = mapped(own.slots, slots, own.contacts.ravel()).reshape(2, 4)
    return cycle.with_(
        center=center,
        rotations=turned,
        events=contacts % 1.0,
        duration=cycle.duration * float(np.exp(0.1 * rng.normal())),
    )


def _waves(rng, phase, joints, size):
    """Rotation vectors that differ from 0 in their mean and twice a stride."""
    out = np.tile(rng.normal(size=(joints, 3)), (len(phase), 1, 1))
    for order in (1, 2):
        a, b = rng.normal(size=(2, joints, 3)) * (0.4 / order)
        angle = 2.0 * np.pi * order * phase[:, None, None]
        out = out + a * np.cos(angle) + b * np.sin(angle)
    return size * out


@cache
def library(count=10, *, first=0):
    """``count`` synthetic walks ready to be mixed."""
    return examples_of({f"s{k}": synthetic(first + k) for k in range(count)}, subject())


def measured(folder, body_of="normal"):
    """Ten measured styles, which are no part of the project, by name; None where absent."""
    from gaitsmith.learning import learn

    files = sorted((folder / "noncommercial" / "bandai").glob("dataset-1_walk_*_001.bvh"))
    if len(files) < 10:
        return None
    gaits = {file.name.split("_")[-2]: learn(file) for file in files}
    return examples_of({n: g.cycle for n, g in gaits.items()}, gaits[body_of].body)


def apart(one, other):
    """Angles between rotations, radians."""
    return np.linalg.norm(log(multiply(inverse(one), other)), axis=-1)


def kink(cycle):
    """Largest change of a joint's angular velocity from sample to sample, degrees a second."""
    q = cycle.rotations
    speed = log(multiply(inverse(q), np.roll(q, -1, axis=0))) * (len(q) / cycle.duration)
    return np.degrees(np.linalg.norm(np.roll(speed, -1, axis=0) - speed, axis=-1).max())


def slide(cycle, *, until="toe_off", early=0.0):
    """Way of the ball while it should stand, from foot flat on, meters: mean of both feet.

    ``early`` is the share of the stride before the event at which to stop.
    """
    phase = np.arange(256) / 128
    center, turned = cycle.at(phase)
    center = center + phase[:, None] * [0.0, 0.0, cycle.stride_length]
    positions, world = forward_kinematics(cycle.skeleton, center, turned)
    balls = sole_positions(cycle.skeleton, positions, world)[:, :, BALL]
    out = []
    for side, own in enumerate(cycle.events):
        strike, flat, off = own[0], own[1], own[EVENTS.index(until)]
        first = strike + (flat - strike) % 1.0
        at = np.linspace(first, strike + (off - strike) % 1.0 - early, 60)
        x, z = (np.interp(at, phase, balls[:, side, k]) for k in (0, 2))
        out.append(np.hypot(np.diff(x), np.diff(z)).sum())
    return float(np.mean(out))


@cache
def rule_library():
    """Ten of the built-in styles by rule, ready to be mixed."""
    names = sorted(RULES)[:10]
    return examples_of({name: restyled(RULES[name]) for name in names}, subject())
