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
from gaitsmith.body.presets import body_from
from gaitsmith.errors import GaitsmithWarning, InvalidInputError, UnknownNameError
from gaitsmith.ground import GROUNDS
from gaitsmith.plan.follow import curve_share, follow
from gaitsmith.plan.given import GivenSteps, plan_given
from gaitsmith.plan.lengths import Stance
from gaitsmith.plan.pace import UNUSUAL_FROUDE, choose_pace, froude
from gaitsmith.plan.paths import Path as WalkPath
from gaitsmith.plan.where import read_where
from gaitsmith.synthesis.curved import BANKINGS, CurvedGenerator
from gaitsmith.synthesis.gaits import GAITS
from gaitsmith.synthesis.sample import sample_walk
from gaitsmith.synthesis.step import prepare_walk
from gaitsmith.synthesis.upper_body import Manner
from gaitsmith.walks.generalize import LONG_STEP, check_step_length

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from pathlib import Path

    from gaitsmith.body.body import Body
    from gaitsmith.ground import Ground
    from gaitsmith.motion.motion import Motion
    from gaitsmith.plan.footsteps import StepPlan
    from gaitsmith.plan.pace import Pace
    from gaitsmith.plan.where import PathLike, StepsLike

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
    body: str | float | Path | Body = 1.75,
    gait: str = "winter",
    step_length: float | None = None,
    cadence: float | None = None,
    speed: float | None = None,
    start: str = "stand",
    stop: str = "stand",
    step_width: float | None = None,
    toe_out: float = TOE_OUT,
    manner: Manner | None = None,
    banking: str = "body",
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
    body
        Height in meters, name of a built-in body, ``.toml`` file of measures, or a Body.
    gait
        Name of a built-in walk (``gaitsmith list gaits``).
    step_length, cadence, speed
        Meters, steps per minute, meters per second. Any two fix the third, one is completed
        as people do, none is the body's preferred pace; see
        :func:`gaitsmith.plan.pace.choose_pace`.
    start, stop
        ``"stand"`` (feet side by side on the end of the path) or ``"walk"`` (mid-walk, from
        heel strike to heel strike).
    step_width
        Meters between left and right footsteps, measured across; None: 0.057 of the height.
        From 0.05 of the height (at least 0.066 m) to half the leg.
    toe_out
        Radians that each foot turns out, -5 to 30 deg.
    manner
        Sizes of the rules above the legs of a gait that has no upper body of its own
        (``winter``); ``Manner(pelvis=False)`` switches a layer off.
    banking
        How the body leans into curves: ``"body"`` (from the feet, the trunk upright, as people
        do), ``"trunk"`` (the trunk alone, as [KB92a]) or ``"none"``.
    fps
        Frames per second; frame ``i`` is at ``i / fps`` seconds.
    seed
        Part of the recipe. This walk has no randomness: it changes nothing yet.

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
    who = body_from(body)
    where, said = read_where(distance, path, steps)
    fps = positive("fps", fps, "frames per second")
    if not SLOWEST_FPS <= fps <= FASTEST_FPS:
        raise InvalidInputError(
            f"fps must be from {SLOWEST_FPS:g} to {FASTEST_FPS:g} frames per second, got {fps:g}"
        )
    if gait not in GAITS:
        raise UnknownNameError("gait", gait, GAITS)
    one_of("start", start, ("stand", "walk"))
    one_of("stop", stop, ("stand", "walk"))
    if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
        raise InvalidInputError(f"seed must be a whole number, 0 or more, got {seed!r}")
    one_of("banking", banking, BANKINGS)
    manner = manner or Manner()
    stance = _stance(who, step_width, toe_out)
    if step_length is not None:
        check_step_length(who, positive("step_length", step_length, "meters"))
    pace = choose_pace(who, step_length=step_length, cadence=cadence, speed=speed)
    check_step_length(who, pace.step_length)
    _warn_of_unusual(who, pace.step_length, pace.speed)
    recipe = {
        "gaitsmith": __version__,
        "walk": {
            **said,
            "body": body_to_dict(who),
            "gait": gait,
            "step_length": step_length,
            "cadence": cadence,
            "speed": speed,
            "start": start,
            "stop": stop,
            "step_width": stance.width,
            "toe_out": stance.toe_out,
            "manner": asdict(manner),
            **({} if distance is not None else {"banking": banking}),
            "fps": fps,
            "seed": seed,
        },
    }
    ground = GROUNDS["flat"]()
    keep = cadence is not None
    plan = _plan(
        where, who, pace, stance, ground, start, stop, keep=keep, outside=banking == "body"
    )
    if step_length is not None and isinstance(where, WalkPath):
        _warn_of_short_steps(plan, step_length, curve_share(where, pace, keep_cadence=keep))
    style = GAITS[gait](manner)
    generator = CurvedGenerator(style.walk, ground, style.overlay, banking=banking)
    prepared = prepare_walk(plan, generator, who, ground, rest=REST)
    return sample_walk(prepared, who, ground, fps=fps, recipe=recipe)


def _plan(
    where: WalkPath | GivenSteps | StepPlan,
    body: Body,
    pace: Pace,
    stance: Stance,
    ground: Ground,
    start: str,
    stop: str,
    *,
    keep: bool,
    outside: bool,
) -> StepPlan:
    """Footsteps along a path, or those that were given."""
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
        )
    if isinstance(where, GivenSteps):
        return plan_given(where, body=body, pace=pace, ground=ground)
    return where


def _stance(body: Body, step_width: float | None, toe_out: float) -> Stance:
    narrow = max(NARROWEST_STEP * body.height, NARROWEST)
    wide = WIDEST_STEP * body.leg_length
    usual = max(STEP_WIDTH * body.height, narrow)
    width = positive("step_width", usual if step_width is None else step_width, "meters")
    if not narrow <= width <= wide:
        raise InvalidInputError(
            f"step_width must be from {narrow:.3f} to {wide:.3f} m for this body, got {width!r} m"
        )
    toe_out = number("toe_out", toe_out, "radians")
    if not -LARGEST_TOE_IN <= toe_out <= LARGEST_TOE_OUT:
        raise InvalidInputError(
            f"toe_out must be from {-np.degrees(LARGEST_TOE_IN):g} to "
            f"{np.degrees(LARGEST_TOE_OUT):g} deg, got {np.degrees(toe_out):.1f} deg"
        )
    return Stance(width, toe_out)


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
