"""The one-call API: a body, a place to go, a way of walking; a motion, a file."""

from __future__ import annotations

import json
import warnings
from dataclasses import asdict
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

from gaitsmith import io
from gaitsmith._checks import number, one_of, positive
from gaitsmith._version import __version__
from gaitsmith.body.files import body_from_dict, body_to_dict
from gaitsmith.errors import GaitsmithWarning, InvalidInputError
from gaitsmith.ground import GROUNDS
from gaitsmith.learning import body_of, gait_from
from gaitsmith.plan.director import Manners, direct
from gaitsmith.plan.follow import curve_share, follow
from gaitsmith.plan.footsteps import StepPlan
from gaitsmith.plan.given import GivenSteps, plan_given
from gaitsmith.plan.lengths import Stance
from gaitsmith.plan.pace import UNUSUAL_FROUDE, Pace, choose_pace, froude
from gaitsmith.plan.paths import Path as WalkPath
from gaitsmith.plan.rhythm import Rhythm
from gaitsmith.plan.script import Script
from gaitsmith.plan.timeline import Timeline
from gaitsmith.plan.where import read_where
from gaitsmith.synthesis.curved import BANKINGS, CurvedGenerator
from gaitsmith.synthesis.mixed import MixedGenerator
from gaitsmith.synthesis.sample import sample_walk
from gaitsmith.synthesis.step import prepare_walk
from gaitsmith.synthesis.stepping import LocalGenerator
from gaitsmith.synthesis.upper_body import Manner
from gaitsmith.walks.generalize import LONG_STEP, check_step_length

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence
    from pathlib import Path

    from gaitsmith.body.body import Body
    from gaitsmith.ground import Ground
    from gaitsmith.motion.motion import Motion
    from gaitsmith.plan.script import Action
    from gaitsmith.plan.where import PathLike, StepsLike
    from gaitsmith.synthesis.gaits import Habits
    from gaitsmith.walks.learned import LearnedGait

#: Step width over stature: 0.10 m for 1.75 m. People walk with 0.06-0.14 m; 0.13 leg lengths
#: is preferred on a treadmill (Donelan, Kram & Kuo 2001).
STEP_WIDTH = 0.057
#: Toe-out of each foot, radians: 5.9 +- 6.9 deg (normal adults, heel-ball line).
TOE_OUT = float(np.radians(6.0))
#: Seconds of standing after a stop.
REST = 0.4
#: Widest step over leg length, largest toe-out, most frames a second.
WIDEST_STEP, LARGEST_TOE_OUT, FASTEST_FPS = 0.5, float(np.radians(30.0)), 10_000.0
#: Narrowest step, over stature and in meters, and largest toe-in: beyond, feet touch in passing.
NARROWEST_STEP, NARROWEST, LARGEST_TOE_IN = 0.05, 0.066, float(np.radians(5.0))
#: Fewest frames a second at which contacts mean anything between frames.
SLOWEST_FPS = 5.0


def _picture(name: str) -> Callable[[Motion, Path], None]:
    def write(motion: Motion, path: Path) -> None:
        getattr(import_module("gaitsmith.viz"), name)(motion, path)  # late: Pillow

    return write


#: Everything a motion can be written to, by suffix: io's formats and viz's pictures.
WRITERS: dict[str, io.Writer] = {
    **io.WRITERS,
    ".png": _picture("contact_sheet"),
    ".gif": _picture("gif"),
}


def walk(
    *,
    distance: float | None = None,
    path: PathLike | None = None,
    steps: StepsLike | None = None,
    do: str | Sequence[str | Action] | None = None,
    body: str | float | Path | Body = 1.75,
    gait: str | Path | LearnedGait | dict[str, Any] = "neutral",
    step_length: float | None = None,
    cadence: float | None = None,
    speed: float | None = None,
    start: str = "stand",
    stop: str = "stand",
    step_width: float | None = None,
    toe_out: float | tuple[float, float] | None = None,
    manner: Manner | None = None,
    banking: str = "body",
    variation: float = 0.0,
    fps: float = 60.0,
    seed: int = 0,
) -> Motion:
    """A person who walks a distance, along a path or on given footsteps, on level ground.

    Parameters
    ----------
    distance
        Meters straight ahead, along +Z from the origin. One of ``distance``, ``path`` and
        ``steps`` says where to walk.
    path
        A smooth curve through points ``(x, z)``: a sequence of them, text ``"0,0 0,4 2,7"``, a
        CSV file, or a :class:`~gaitsmith.plan.paths.Path`.
    steps
        Footsteps to land on exactly: a CSV file ``side,x,z,heading_deg[,y][,time]``, a sequence
        of mappings with these keys, or a :class:`~gaitsmith.plan.footsteps.StepPlan`. The
        person starts standing on the first two and ends standing on the last two; ``start``,
        ``stop``, ``step_width`` and ``toe_out`` do not apply.
    do
        A script of actions, ``"walk to 0,3; turn left 90; step back 0.3"``, or a list of them
        (:mod:`gaitsmith.plan.script`), from standing at 0,0 facing 0; ``start`` and ``stop`` do
        not apply.
    body
        Height in meters, name of a built-in body, ``.toml`` file of measures, a clip (whose
        rig has the lengths), or a Body.
    gait
        Name of a built-in gait (``gaitsmith list gaits``), a ``.gait.json`` file, a clip to learn
        from, or what :func:`gaitsmith.learn` returned.
    step_length, cadence, speed
        Meters, steps per minute, meters per second. Any two fix the third, one is completed
        as people do, none is the body's preferred pace; see
        :func:`gaitsmith.plan.pace.choose_pace`.
    start, stop
        ``"stand"`` (feet side by side on the end of the path) or ``"walk"`` (mid-walk, from
        heel strike to heel strike).
    step_width
        Meters between left and right footsteps, measured across; None: the gait's own, else
        0.057 of the height. From 0.05 of the height (at least 0.066 m) to half the leg.
    toe_out
        Radians that the feet, or [left, right], turn out, -5 to 30 deg; None: the gait's own,
        else 6 deg.
    manner
        Sizes of the rules above the legs of a gait that has no upper body of its own
        (``winter``); ``Manner(pelvis=False)`` switches a layer off.
    banking
        How the body leans into curves: ``"body"`` (from the feet, the trunk upright, as people
        do), ``"trunk"`` (the trunk alone, as [KB92a]) or ``"none"``.
    fps
        Frames per second; frame ``i`` is at ``i / fps`` seconds.
    variation
        Natural variation from step to step along a path: 0 none, 1 as people vary; speed drifts
        slowly, step widths vary at once. See :mod:`gaitsmith.plan.rhythm`.
    seed
        Of the variation.

    Returns
    -------
    Motion with contacts and labels; its recipe regenerates it, see :func:`regenerate`.

    Raises
    ------
    InvalidInputError
        If an argument is of no use, or the three of pace contradict each other.
    InfeasibleError
        If this body cannot take such steps, or nobody walks that fast.

    Warns
    -----
    GaitsmithWarning
        Where the walk is possible but unusual: steps over 1.05 leg lengths, Froude number
        over 0.4.

    Examples
    --------
    >>> motion = walk(distance=3.0, body=1.2, fps=30)
    >>> motion.labels.footstep_position[-1, 2].round(6)
    np.float64(3.0)
    """
    who = body_of(body)
    where, said = read_where(distance, path, steps, do)
    fps = positive("fps", fps, "frames per second")
    if not SLOWEST_FPS <= fps <= FASTEST_FPS:
        raise InvalidInputError(
            f"fps must be from {SLOWEST_FPS:g} to {FASTEST_FPS:g} frames per second, got {fps:g}"
        )
    one_of("start", start, ("stand", "walk"))
    one_of("stop", stop, ("stand", "walk"))
    if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
        raise InvalidInputError(f"seed must be a whole number, 0 or more, got {seed!r}")
    one_of("banking", banking, BANKINGS)
    manner = manner or Manner()
    style, named = gait_from(gait, manner)
    stance = _stance(who, step_width, toe_out, style.habits)
    if step_length is not None:
        check_step_length(who, positive("step_length", step_length, "meters"))
    pace = choose_pace(
        who,
        step_length=step_length,
        cadence=cadence,
        speed=speed,
        usual=None if style.habits is None else _own_pace(who, style.habits),
    )
    check_step_length(who, pace.step_length)
    _warn_of_unusual(who, pace.step_length, pace.speed)
    recipe = {
        "gaitsmith": __version__,
        "walk": {
            **said,
            "body": body_to_dict(who),
            "gait": named,
            "step_length": step_length,
            "cadence": cadence,
            "speed": speed,
            "start": start,
            "stop": stop,
            "step_width": stance.width,
            "toe_out": stance.toe_out,
            "manner": asdict(manner),
            **({} if distance is not None else {"banking": banking}),
            **({"variation": variation} if variation else {}),
            "fps": fps,
            "seed": seed,
        },
    }
    ground = GROUNDS["flat"]()
    keep = cadence is not None
    own = style.habits
    rhythm = Rhythm(
        lengths=own.lengths if own and step_length is None else (1.0, 1.0),
        durations=own.durations if own and cadence is None else (1.0, 1.0),
        variation=variation,
        seed=seed,
    )
    outside = banking == "body"
    plan = _plan(where, who, pace, stance, rhythm, ground, start, stop, keep=keep, outside=outside)
    if step_length is not None and isinstance(where, WalkPath) and isinstance(plan, StepPlan):
        _warn_of_short_steps(plan, step_length, curve_share(where, pace, keep_cadence=keep))
    generator = CurvedGenerator(style.walk, ground, style.overlay, banking=banking)
    if isinstance(plan, Timeline):
        generator = MixedGenerator(generator, LocalGenerator(style.walk, ground, style.overlay))
    prepared = prepare_walk(plan, generator, who, ground, rest=REST)
    return sample_walk(prepared, who, ground, fps=fps, recipe=recipe)


def _plan(
    where: WalkPath | GivenSteps | StepPlan | Script,
    body: Body,
    pace: Pace,
    stance: Stance,
    rhythm: Rhythm,
    ground: Ground,
    start: str,
    stop: str,
    *,
    keep: bool,
    outside: bool,
) -> StepPlan | Timeline:
    """Footsteps along a path, those that were given, or those of a script."""
    if isinstance(where, Script):
        manners = Manners(body, pace, stance, ground, rhythm, outside, keep)
        return direct(where.actions, manners)
    if isinstance(where, WalkPath):
        return follow(
            where,
            pace=pace,
            stance=stance,
            ground=ground,
            body=body if outside else None,
            start=start,
            stop=stop,
            keep_cadence=keep,
            rhythm=rhythm,
            stature=body.height,
        )
    if isinstance(where, GivenSteps):
        return plan_given(where, body=body, pace=pace, ground=ground)
    return where


def _own_pace(body: Body, habits: Habits) -> Pace:
    """The pace of who was measured at the size of ``body``: equal Froude numbers."""
    return Pace(
        step_length=habits.step_length * body.leg_length,
        cadence=habits.cadence * float(np.sqrt(habits.leg_length / body.leg_length)),
    )


def _stance(
    body: Body,
    step_width: float | None,
    toe_out: float | tuple[float, float] | None,
    habits: Habits | None,
) -> Stance:
    narrow = max(NARROWEST_STEP * body.height, NARROWEST)
    wide = WIDEST_STEP * body.leg_length
    if step_width is not None:
        width = positive("step_width", step_width, "meters")
        if not narrow <= width <= wide:
            raise InvalidInputError(
                f"step_width must be from {narrow:.3f} to {wide:.3f} m for this body, "
                f"got {width!r} m"
            )
    elif habits is None:
        width = max(STEP_WIDTH * body.height, narrow)
    else:
        width = _kept("step width", habits.step_width * body.leg_length, narrow, wide, "m")
    least, most = -LARGEST_TOE_IN, LARGEST_TOE_OUT
    if toe_out is None and habits is not None:
        left, right = (
            np.radians(_kept("toe-out", float(d), np.degrees(least), np.degrees(most), "deg"))
            for d in np.degrees(habits.toe_out)
        )
        return Stance(width, (float(left), float(right)))
    both = TOE_OUT if toe_out is None else toe_out
    pair = both if isinstance(both, tuple | list) else (both, both)
    if len(pair) != 2:
        raise InvalidInputError(f"toe_out must be one angle or [left, right], got {both!r}")
    left, right = (number("toe_out", angle, "radians") for angle in pair)
    for angle in (left, right):
        if not least <= angle <= most:
            raise InvalidInputError(
                f"toe_out must be from {np.degrees(least):g} to {np.degrees(most):g} deg, got "
                f"{np.degrees(angle):.1f} deg"
            )
    return Stance(width, (left, right))


def _kept(what: str, value: float, least: float, most: float, unit: str) -> float:
    """``value`` of a gait within the limits that keep feet apart; says so where it was not."""
    kept = min(max(value, least), most)
    if abs(kept - value) > 0.02 * (most - least):
        warnings.warn(
            f"the gait's own {what} of {value:.3g} {unit} is not walked: {kept:.3g} {unit} keeps "
            "the feet apart",
            GaitsmithWarning,
            stacklevel=4,
        )
    return kept


def _warn_of_unusual(body: Body, step_length: float, speed: float) -> None:
    ratio, number_ = step_length / body.leg_length, froude(body, speed)
    if ratio > LONG_STEP:
        warnings.warn(
            f"steps of {step_length:.3f} m are {ratio:.2f} leg lengths: longer than people take",
            GaitsmithWarning,
            stacklevel=3,
        )
    if number_ > UNUSUAL_FROUDE:
        warnings.warn(
            f"{speed:.2f} m/s is Froude number {number_:.2f} for this body: nearly a run",
            GaitsmithWarning,
            stacklevel=3,
        )


def _warn_of_short_steps(plan: StepPlan, step_length: float, share: float) -> None:
    longest = float(plan.step_lengths[1:].max())
    if longest < step_length - 1e-6:
        warnings.warn(
            f"the way is too short for a full step of {step_length:.3f} m; the longest is "
            f"{longest:.3f} m",
            GaitsmithWarning,
            stacklevel=3,
        )
    if share < 1.0 - 1e-6:
        warnings.warn(
            f"curves shorten steps of {step_length:.3f} m to as little as "
            f"{share * step_length:.3f} m",
            GaitsmithWarning,
            stacklevel=3,
        )


def regenerate(recipe: Motion | str | dict[str, Any]) -> Motion:
    """The motion that a recipe describes, to the byte.

    ``recipe`` is a generated motion, or what its ``labels.recipe`` holds.
    """
    if not isinstance(recipe, str | dict):
        if recipe.labels is None:
            raise InvalidInputError("this motion has no recipe; only generated ones have")
        recipe = recipe.labels.recipe
    try:
        data = json.loads(recipe) if isinstance(recipe, str) else recipe
    except json.JSONDecodeError as error:
        raise InvalidInputError(f"a recipe must be JSON: {error}") from None
    if not (isinstance(data, dict) and isinstance(data.get("walk"), dict)):
        raise InvalidInputError("a recipe must be an object with a 'walk' object")
    made_by = data.get("gaitsmith")
    if made_by != __version__:
        warnings.warn(
            f"the recipe is of gaitsmith {made_by}, this is {__version__}: the motion may differ",
            GaitsmithWarning,
            stacklevel=2,
        )
    arguments = dict(data["walk"])
    try:
        arguments["body"] = body_from_dict(arguments["body"])
        arguments["manner"] = Manner(**arguments["manner"])
        if isinstance(arguments["toe_out"], list):
            arguments["toe_out"] = tuple(arguments["toe_out"])
        return walk(**arguments)
    except (KeyError, TypeError) as error:
        raise InvalidInputError(f"not a recipe of a walk: {error}") from None


def save(motion: Motion, path: str | Path) -> Path:
    """Write ``motion`` in the format of the suffix of ``path``; whole or not at all.

    Formats: ``gaitsmith list formats``. Raises as :func:`gaitsmith.io.save` does.
    """
    return io.save(motion, path, WRITERS)


def save_all(motion: Motion, paths: Iterable[str | Path]) -> list[Path]:
    """Write ``motion`` to every path, or to none if one of them cannot be written."""
    return io.save_all(motion, paths, WRITERS)
