"""The one-call API: a body, a place to go, a way of walking; a motion, a file."""

from __future__ import annotations

import json
import warnings
from dataclasses import asdict, replace
from functools import partial
from importlib import import_module
from typing import TYPE_CHECKING, Any

from gaitsmith import io
from gaitsmith._checks import one_of, positive
from gaitsmith._version import __version__
from gaitsmith.body.files import body_from_dict, body_to_dict
from gaitsmith.conventions import BANKINGS
from gaitsmith.errors import GaitsmithWarning, InvalidInputError
from gaitsmith.ground import Flat, Ground, ground_from_json, read_ground
from gaitsmith.learning import body_of, gait_from, gaits_named
from gaitsmith.motion.holding import held
from gaitsmith.motion.performance import Performance
from gaitsmith.plan.follow import curve_share, follow
from gaitsmith.plan.footsteps import StepPlan
from gaitsmith.plan.given import GivenSteps, plan_given
from gaitsmith.plan.low import with_low
from gaitsmith.plan.on_ground import on_ground
from gaitsmith.plan.pace import Pace, choose_pace
from gaitsmith.plan.paths import Path as WalkPath
from gaitsmith.plan.rhythm import Rhythm
from gaitsmith.plan.script import Script, Tempo
from gaitsmith.plan.start import Start, start_of, start_to_dict
from gaitsmith.plan.surroundings import Surroundings
from gaitsmith.plan.where import read_where
from gaitsmith.synthesis.gaits import with_walker
from gaitsmith.synthesis.generators import generator_for
from gaitsmith.synthesis.habits import own_pace, stance_of, with_habits
from gaitsmith.synthesis.sample import sample_walk
from gaitsmith.synthesis.step import prepare_walk
from gaitsmith.synthesis.unusual import warn_of_short_steps, warn_of_treads, warn_of_unusual
from gaitsmith.synthesis.upper_body import Manner
from gaitsmith.walks.generalize import check_step_length

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence
    from pathlib import Path

    from gaitsmith.body.body import Body
    from gaitsmith.motion.motion import Motion
    from gaitsmith.plan.lengths import Stance
    from gaitsmith.plan.routes import Routes
    from gaitsmith.plan.script import Action
    from gaitsmith.plan.timeline import Timeline
    from gaitsmith.plan.where import PathLike, StepsLike
    from gaitsmith.synthesis.gaits import Habits
    from gaitsmith.synthesis.step import PreparedWalk
    from gaitsmith.walks.learned import LearnedGait

#: Seconds of standing after a stop.
REST = 0.4
#: Most frames a second, and fewest at which contacts mean anything between frames.
FASTEST_FPS, SLOWEST_FPS = 10_000.0, 5.0


def _picture(name: str) -> Callable[[Any, Path], None]:
    def write(motion: Any, path: Path) -> None:
        getattr(import_module("gaitsmith.viz"), name)(motion, path)  # late: Pillow

    return write


#: Everything a motion can be written to, by suffix: io's formats and viz's pictures.
WRITERS: dict[str, io.Writer] = {
    **io.WRITERS,
    ".png": _picture("contact_sheet"),
    ".gif": _picture("gif"),
}
#: What several people can be written to as one file, by suffix.
PERFORMANCE_WRITERS: dict[str, io.PerformanceWriter] = {
    **io.PERFORMANCE_WRITERS,
    ".png": _picture("scene_sheet"),
    ".gif": _picture("scene_gif"),
}


def walk(
    *,
    distance: float | None = None,
    path: PathLike | None = None,
    steps: StepsLike | None = None,
    do: str | Sequence[str | Action] | None = None,
    gaits: Mapping[str, str | Path | LearnedGait | dict[str, Any]] | None = None,
    ground: str | Path | Ground | dict[str, Any] = "flat",
    body: str | float | Path | Body = 1.75,
    gait: str | Path | LearnedGait | dict[str, Any] = "neutral",
    walker: str = "kinematic",
    step_length: float | None = None,
    cadence: float | None = None,
    speed: float | None = None,
    start: str | Start | dict[str, Any] = "stand",
    stop: str = "stand",
    step_width: float | None = None,
    toe_out: float | tuple[float, float] | None = None,
    manner: Manner | None = None,
    banking: str = "body",
    variation: float = 0.0,
    fps: float = 60.0,
    seed: int = 0,
    begin: float = 0.0,
    until: float | None = None,
    surroundings: Surroundings | Mapping[str, Any] | None = None,
) -> Motion:
    """A person who walks a distance, along a path, on given footsteps, on any ground.

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
        (:mod:`gaitsmith.plan.script`), from standing at 0,0 facing 0 or at ``start``; ``stop``
        does not apply.
    gaits
        Gaits that actions name (``"walk to 0,3 gait limp"``), each as ``gait``; built-in ones
        need not be told. Walks in different gaits meet in standing; feet are set as in the
        person's own gait.
    ground
        ``"flat"``, ``"slope:DEG"``, ``"stairs:RISE,TREAD,COUNT"``, a file of a height field or a
        mesh (:func:`gaitsmith.ground.read_ground`), a ground, or its JSON. Distances and
        coordinates are horizontal. Steps get shorter on slopes ([SM01] Eqs. 11-12) unless
        ``step_length`` is given; on stairs the treads rule.
    body
        Height in meters, name of a built-in body, ``.toml`` file of measures, a clip (whose
        rig has the lengths), or a Body.
    gait
        Name of a built-in gait (``gaitsmith list gaits``), a ``.gait.json`` file, a clip to learn
        from, or what :func:`gaitsmith.learn` returned.
    walker
        ``"kinematic"``: the gait's measured step, generalized [KB92b]. ``"elevation"``: elevation
        angles, mixed from sets of the same legs for steps of any length, up and down hill [SM01].
    step_length, cadence, speed
        Meters, steps per minute, meters per second. Any two fix the third, one is completed
        as people do, none is the body's preferred pace; see
        :func:`gaitsmith.plan.pace.choose_pace`.
    start, stop
        ``"stand"`` (feet side by side on the end of the path) or ``"walk"`` (mid-walk, from
        heel strike to heel strike). ``start`` may also be where a script or a distance begins,
        a :class:`~gaitsmith.plan.start.Start`.
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
    begin, until
        Seconds that the person stands before it begins, and to which it stands on at least
        once it has arrived; ``until`` is None: no longer than the stop needs.
    surroundings
        What stands around (:class:`~gaitsmith.plan.surroundings.Surroundings`): obstacles that
        scripts walk round and everything else must keep clear of, or, where they are low, that
        are stepped over or on; bars to duck under, posts to lean past.

    Returns
    -------
    Motion with contacts and labels; its recipe regenerates it, see :func:`regenerate`.

    Raises
    ------
    InvalidInputError
        If an argument is of no use, or the three of pace contradict each other.
    InfeasibleError
        If this body cannot take such steps, or nobody walks that fast, or there is no way
        over the ground: a step too high, a slope too steep, no place for a foot.

    Warns
    -----
    GaitsmithWarning
        Where the walk is possible but unusual: steps over 1.05 leg lengths, Froude number
        over 0.4. Where soles sink into curved ground.

    Examples
    --------
    >>> motion = walk(distance=3.0, body=1.2, fps=30)
    >>> motion.labels.footstep_position[-1, 2].round(6)
    np.float64(3.0)
    """
    who = body_of(body)
    ground = ground_of(ground)
    where, said = read_where(distance, path, steps, do)
    fps = positive("fps", fps, "frames per second")
    if not SLOWEST_FPS <= fps <= FASTEST_FPS:
        raise InvalidInputError(
            f"fps must be from {SLOWEST_FPS:g} to {FASTEST_FPS:g} frames per second, got {fps:g}"
        )
    start = start_of(start)
    if isinstance(start, Start):
        where = _from(start, where, distance)
    else:
        one_of("start", start, ("stand", "walk"))
    one_of("stop", stop, ("stand", "walk"))
    if begin:
        positive("begin", begin, "seconds")
    if (begin and start == "walk") or (until is not None and stop == "walk"):
        raise InvalidInputError("who stands before or after the walk needs start and stop 'stand'")
    if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
        raise InvalidInputError(f"seed must be a whole number, 0 or more, got {seed!r}")
    one_of("banking", banking, BANKINGS)
    manner = manner or Manner()
    style, named = gait_from(gait, manner)
    style = with_walker(style, walker)
    stance = stance_of(who, step_width, toe_out, style.habits)
    if step_length is not None:
        check_step_length(who, positive("step_length", step_length, "meters"))

    def paced(tempo: Tempo, habits: Habits | None = style.habits) -> Pace:
        usual = None if habits is None else own_pace(who, habits)
        pace = choose_pace(who, **tempo.said, usual=usual)
        check_step_length(who, pace.step_length)
        warn_of_unusual(who, pace.step_length, pace.speed)
        return pace

    asked = Tempo(speed, step_length, cadence)
    pace = paced(asked)
    actions = where.actions if isinstance(where, Script) else ()
    others = {
        name: (with_walker(other, walker), told)
        for name, (other, told) in gaits_named(actions, gaits or {}, manner).items()
    }
    around = Surroundings.read(surroundings)
    base, ground = ground, with_low(ground, around, who)
    recipe = {
        "gaitsmith": __version__,
        "walk": {
            **said,
            **({} if base == Flat() else {"ground": base}),
            "body": body_to_dict(who),
            "gait": named,
            **({} if walker == "kinematic" else {"walker": walker}),
            "step_length": step_length,
            "cadence": cadence,
            "speed": speed,
            "start": start_to_dict(start) if isinstance(start, Start) else start,
            "stop": stop,
            "step_width": stance.width,
            "toe_out": stance.toe_out,
            "manner": asdict(manner),
            **({} if distance is not None else {"banking": banking}),
            **({"variation": variation} if variation else {}),
            **({"begin": float(begin)} if begin else {}),
            **({"gaits": {n: told for n, (_, told) in others.items()}} if others else {}),
            "fps": fps,
            "seed": seed,
            **({} if around.empty else {"surroundings": around.as_dict()}),
        },
    }
    keep = cadence is not None
    vary = Rhythm(variation=variation, seed=seed)
    rhythm = with_habits(vary, style.habits, asked)
    outside = banking == "body"

    def planned(routes: Routes | None = None) -> StepPlan | Timeline:
        if isinstance(where, Script):
            from gaitsmith.plan.director import Manners, direct  # late, as in generator_for

            full = step_length is not None
            manners = Manners(who, pace, stance, ground, rhythm, outside, keep, full, paced)
            in_others = {
                name: replace(
                    manners,
                    pace=paced(asked, other.habits),
                    rhythm=with_habits(vary, other.habits, asked),
                    paced=partial(paced, habits=other.habits),
                )
                for name, (other, _) in others.items()
            }
            manners = replace(manners, gaits=in_others, routes=routes)
            begin_at = start if isinstance(start, Start) else None
            return on_ground(direct(where.actions, manners, begin_at), who, ground)
        plan = _plan(
            where,
            who,
            pace,
            stance,
            rhythm,
            ground,
            "stand" if isinstance(start, Start) else start,
            stop,
            keep=keep,
            keep_length=step_length is not None,
            outside=outside,
        )
        return on_ground(plan, who, ground)

    ahead = isinstance(where, WalkPath) and where.straight and not variation
    gaits_of = {name: other for name, (other, _) in others.items()}

    def prepared(plan: StepPlan | Timeline) -> PreparedWalk:
        generator = generator_for(plan, style, ground, banking, ahead=ahead, gaits=gaits_of)
        return prepare_walk(plan, generator, who, ground, rest=REST)

    if around.empty:
        walked = prepared(planned())
    else:
        from gaitsmith.synthesis.among import walk_among  # late: most walks have nothing around

        walked = walk_among(planned, prepared, who, ground, around)
    plan = walked.plan
    if step_length is not None and isinstance(where, WalkPath) and isinstance(plan, StepPlan):
        if ground.stepped:
            warn_of_treads(plan, step_length)
        else:
            warn_of_short_steps(plan, step_length, curve_share(where, pace, keep_cadence=keep))
    motion = sample_walk(walked, who, ground, fps=fps, recipe=recipe, begin=float(begin))
    return motion if until is None else stand_on(motion, until)


def ground_of(given: str | Path | Ground | dict[str, Any]) -> Ground:
    """What an argument ``ground`` means: words, a file, JSON, or a ground as it is."""
    if isinstance(given, dict):
        return ground_from_json(given)
    return given if isinstance(given, Ground) else read_ground(given)


def stand_on(motion: Motion, until: float) -> Motion:
    """A generated ``motion`` that stands on to the second ``until``, and its recipe says so.

    The same as :func:`walk` makes with this ``until``.
    """
    if motion.labels is None:
        raise InvalidInputError("only a generated motion knows how to stand on")
    until = positive("until", until, "seconds")
    recipe = json.loads(motion.labels.recipe)
    recipe["walk"]["until"] = until
    labels = replace(motion.labels, recipe=json.dumps(recipe, sort_keys=True))
    return held(motion.with_(labels=labels), until)


def _from(
    start: Start, where: WalkPath | GivenSteps | StepPlan | Script, distance: float | None
) -> WalkPath | Script:
    """Where to walk from ``start``."""
    if isinstance(where, Script):
        return where
    if distance is None or start.feet is not None:
        raise InvalidInputError(
            "a path and footsteps begin where they say; a start is of do and distance"
            if distance is None
            else "a distance begins with the feet side by side; a start with feet is of do"
        )
    assert isinstance(where, WalkPath)
    return WalkPath.line(where.length, origin=start.place, heading=start.heading)


def _plan(
    where: WalkPath | GivenSteps | StepPlan,
    body: Body,
    pace: Pace,
    stance: Stance,
    rhythm: Rhythm,
    ground: Ground,
    start: str,
    stop: str,
    *,
    keep: bool,
    keep_length: bool,
    outside: bool,
) -> StepPlan:
    """Footsteps along a path, or those that were given."""
    if isinstance(where, WalkPath):
        return follow(
            where,
            pace=pace,
            stance=stance,
            ground=ground,
            body=body,
            outside=outside,
            start=start,
            stop=stop,
            keep_cadence=keep,
            keep_length=keep_length,
            rhythm=rhythm,
            stature=body.height,
        )
    if isinstance(where, GivenSteps):
        return plan_given(where, body=body, pace=pace, ground=ground)
    return where


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


def save(motion: Motion | Performance, path: str | Path) -> Path:
    """Write ``motion`` in the format of the suffix of ``path``; whole or not at all.

    Formats: ``gaitsmith list formats``. Several people go to one file, or to one each where
    the name of the file has ``{walker}``; the first one's is returned. Raises as
    :func:`gaitsmith.io.save` does.
    """
    return save_all(motion, [path])[0]


def save_all(motion: Motion | Performance, paths: Iterable[str | Path]) -> list[Path]:
    """Write ``motion`` to every path, or to none if one of them cannot be written."""
    if isinstance(motion, Performance):
        return io.save_performance(motion, paths, WRITERS, PERFORMANCE_WRITERS)
    return io.save_all(motion, paths, WRITERS)
