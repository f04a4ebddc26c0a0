"""A person who is steered while walking: :class:`LiveWalker`, told by :class:`Controls`."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from gaitsmith._checks import number, one_of, positive
from gaitsmith._version import __version__
from gaitsmith.body.files import body_to_dict
from gaitsmith.body.rig import skeleton_of
from gaitsmith.conventions import BANKINGS
from gaitsmith.errors import InvalidInputError
from gaitsmith.learning import body_of, gait_from
from gaitsmith.motion.motion import Labels, Motion
from gaitsmith.pipeline import FASTEST_FPS, SLOWEST_FPS, ground_of
from gaitsmith.plan.aiming import Wish
from gaitsmith.plan.lengths import PATH_SPACING
from gaitsmith.plan.metagait import MetaGait
from gaitsmith.plan.pace import choose_pace
from gaitsmith.plan.start import Start, start_of, start_to_dict
from gaitsmith.plan.timeline import landing_at
from gaitsmith.plan.where import read_where
from gaitsmith.synthesis.gaits import with_walker
from gaitsmith.synthesis.generators import walking_generator
from gaitsmith.synthesis.habits import own_pace, stance_of
from gaitsmith.synthesis.sample import local_rotations
from gaitsmith.synthesis.steering import INSTANT, Steering
from gaitsmith.synthesis.upper_body import Manner
from gaitsmith.walks.generalize import check_step_length

if TYPE_CHECKING:
    from pathlib import Path as FilePath

    from jaxtyping import Bool, Float

    from gaitsmith.body.body import Body
    from gaitsmith.ground import Ground
    from gaitsmith.motion.skeleton import Skeleton
    from gaitsmith.plan.paths import Path
    from gaitsmith.plan.where import PathLike
    from gaitsmith.walks.learned import LearnedGait

#: Longest that one call advances, seconds.
LONGEST_ADVANCE = 3600.0
#: Slower than this (m/s) is standing.
STANDS = 0.05


@dataclass(frozen=True)
class Controls:
    """What a steered person is to do from now on; all of it, each time it is told.

    Attributes
    ----------
    heading
        Where to, radians, 0 along +Z, left positive; None: along the path, or straight on.
    speed, step_length, cadence
        Meters per second, meters, steps per minute, as :func:`gaitsmith.walk` takes them; none:
        the pace that the person prefers. A speed of 0 stops.
    stop
        Come to stand, feet side by side.
    """

    heading: float | None = None
    speed: float | None = None
    step_length: float | None = None
    cadence: float | None = None
    stop: bool = False

    def __post_init__(self) -> None:
        """Check what can be checked without a body."""
        if self.heading is not None:
            object.__setattr__(self, "heading", number("heading", self.heading, "radians"))
        if self.speed is not None and number("speed", self.speed, "meters per second") < 0.0:
            raise InvalidInputError(f"speed must be 0 or more, got {self.speed!r}; nobody backs up")


@dataclass(frozen=True, eq=False)
class LivePose:
    """A pose that was just shown.

    Attributes
    ----------
    time
        Seconds.
    root_position
        ``(3,)`` of the hips' middle, meters.
    rotations
        ``(J, 4)`` unit quaternions, joint to parent, joints as in the walker's ``skeleton``.
    contacts
        ``(2, 3)`` [left, right] x [heel, ball, toe tip] bears.
    """

    time: float
    root_position: Float[np.ndarray, "3"]
    rotations: Float[np.ndarray, "joints 4"]
    contacts: Bool[np.ndarray, "2 3"]


class LiveWalker:
    """A person who walks, turns, speeds up, stops and starts again while being steered.

    Nothing that was shown changes afterwards, and what is asked for between two calls does not
    depend on how many calls there are: the same controls at the same times give the same poses.

    Parameters
    ----------
    body, gait, walker, ground, step_width, toe_out, manner, banking
        As :func:`gaitsmith.walk` takes them.
    path
        What is followed while no heading is asked for, and where it stops.
    start
        Where the person stands at first; None: on the first point of the path, else at 0,0,
        facing 0.
    fps
        Frames per second of :meth:`motion`.

    Notes
    -----
    The goal of a swinging foot may change until the foot is two thirds of a step on its way; what
    is asked for later is done by the next step. A turn takes at most 35 deg a step, so who turns
    round makes small steps nearly on the spot. Standing, the person turns when it starts.

    Examples
    --------
    >>> walker = LiveWalker(body=1.75, fps=30)
    >>> pose = walker.advance(2.0, Controls(speed=1.2))
    >>> pose = walker.advance(2.0, Controls(speed=1.2, heading=1.0))
    >>> pose = walker.advance(2.5, Controls(stop=True))
    >>> walker.standing, len(walker.motion())
    (True, 196)
    """

    def __init__(
        self,
        *,
        body: str | float | FilePath | Body = 1.75,
        gait: str | FilePath | LearnedGait | dict[str, Any] = "neutral",
        walker: str = "kinematic",
        ground: str | FilePath | Ground | dict[str, Any] = "flat",
        path: PathLike | None = None,
        start: Start | dict[str, Any] | None = None,
        step_width: float | None = None,
        toe_out: float | tuple[float, float] | None = None,
        manner: Manner | None = None,
        banking: str = "body",
        fps: float = 60.0,
        paper: bool = False,
    ) -> None:
        who, where = body_of(body), None
        self._body, self._ground = who, ground_of(ground)
        said: dict[str, Any] = {}
        if path is not None:
            where, said = read_where(None, path, None, None)
        self._path: Path | None = where  # type: ignore[assignment]
        self._fps = positive("fps", fps, "frames per second")
        if not SLOWEST_FPS <= self._fps <= FASTEST_FPS:
            raise InvalidInputError(
                f"fps must be from {SLOWEST_FPS:g} to {FASTEST_FPS:g} frames per second, got "
                f"{fps:g}"
            )
        one_of("banking", banking, BANKINGS)
        manner = manner or Manner()
        style, named = gait_from(gait, manner)
        style = with_walker(style, walker)
        stance = stance_of(who, step_width, toe_out, style.habits)
        self._usual = None if style.habits is None else own_pace(who, style.habits)
        begin = self._start(start)
        self._skeleton = skeleton_of(who)
        self._controls, self._time = Controls(), 0.0
        controller = MetaGait(
            who, stance, self._ground, path=self._path, outside=banking == "body", paper=paper
        )
        self._steering = Steering(
            who,
            self._ground,
            walking_generator(style, self._ground, banking),
            controller,
            controller.standing(begin),
            self._wish(self._controls),
            [0.0, 0.0],
        )
        self._recipe = {
            "gaitsmith": __version__,
            "live": {
                **said,
                "ground": self._ground.as_json(),
                "body": body_to_dict(who),
                "gait": named,
                "walker": walker,
                "start": start_to_dict(begin),
                "step_width": stance.width,
                "toe_out": stance.toe_out,
                "manner": asdict(manner),
                "banking": banking,
                "fps": self._fps,
                "paper": paper,
            },
        }
        self._schedule: list[list[Any]] = []
        self._frames: list[LivePose] = []
        self._show(0.0, inclusive=True)

    # ---------------------------------------------------------------------- what is seen

    @property
    def skeleton(self) -> Skeleton:
        """The joints that poses are of."""
        return self._skeleton

    @property
    def time(self) -> float:
        """Seconds since the beginning."""
        return self._time

    @property
    def controls(self) -> Controls:
        """What is being done."""
        return self._controls

    @property
    def standing(self) -> bool:
        """Whether the person stands, feet side by side."""
        return self._steering.target is None

    @property
    def heading(self) -> float:
        """Of the walk at the last footstep, radians."""
        return self._steering.feet[-1].direction

    # -------------------------------------------------------------------------- walking

    def advance(self, dt: float, controls: Controls | None = None) -> LivePose:
        """Walk on for ``dt`` seconds and show the pose then.

        Parameters
        ----------
        dt
            Seconds, 0 or more.
        controls
            What is done from the present on; None: what was done so far.

        Raises
        ------
        InvalidInputError
            If ``dt`` or the controls are of no use.
        InfeasibleError
            If nobody walks like that: too fast, steps too long.
        """
        dt = number("dt", dt, "seconds")
        if not 0.0 <= dt <= LONGEST_ADVANCE:
            raise InvalidInputError(f"dt must be from 0 to {LONGEST_ADVANCE:g} seconds, got {dt:g}")
        if controls is not None and controls != self._controls:
            wish = self._wish(controls)
            self._controls = controls
            self._schedule.append([self._time, asdict(controls)])
        else:
            wish = self._steering.wish
        self._steering.wished(wish, self._time)
        until = self._time + dt
        while True:
            event = self._steering.next_event
            landing = self._steering.run is not None and event == self._steering.run.end
            if event > until + (INSTANT if landing else -INSTANT):
                break
            self._show(event, inclusive=False)
            self._steering.happen()
        self._show(until, inclusive=True)
        self._time = until
        if self._frames and abs(self._frames[-1].time - until) <= INSTANT:
            return self._frames[-1]
        return self._posed(np.array([until]))[0]

    def motion(self) -> Motion:
        """Everything shown so far, frame ``i`` at ``i / fps`` seconds."""
        walked, frames = self._steering, self._frames
        feet, landing = list(walked.feet), list(walked.landed)
        if walked.target is not None and walked.run is not None:
            feet.append(walked.target)
            landing.append(walked.run.end)
        times = np.array([f.time for f in frames])
        step, phase = landing_at(np.array(landing), times)
        shown = None
        if self._path is not None:
            count = max(2, int(np.ceil(self._path.length / PATH_SPACING)) + 1)
            shown = self._path.at(np.linspace(0.0, self._path.length, count))
        recipe = {**self._recipe, "controls": self._schedule}
        return Motion(
            skeleton=self._skeleton,
            root_position=np.array([f.root_position for f in frames]),
            rotations=np.array([f.rotations for f in frames]),
            contacts=np.array([f.contacts for f in frames]),
            fps=self._fps,
            labels=Labels(
                phase=phase,
                step=step,
                footstep_side=np.array([f.side for f in feet]),
                footstep_position=np.array([f.position for f in feet]),
                footstep_heading=np.array([f.heading for f in feet]),
                footstep_time=np.array(landing),
                ground=json.dumps(self._ground.as_json(), sort_keys=True),
                recipe=json.dumps(recipe, sort_keys=True),
                path=shown,
            ),
        )

    # -------------------------------------------------------------------------- helpers

    def _start(self, given: Start | dict[str, Any] | None) -> Start:
        if given is not None:
            start = start_of(given)
            if not isinstance(start, Start):
                raise InvalidInputError(f"start must have at, facing or feet, got {given!r}")
            return start
        if self._path is None:
            return Start()
        here = self._path.at(np.zeros(1))[0]
        facing = float(self._path.heading_at(np.zeros(1))[0])
        return Start(at=(float(here[0]), float(here[1])), facing=facing)

    def _wish(self, controls: Controls) -> Wish:
        stop = controls.stop or (controls.speed is not None and controls.speed < STANDS)
        said = {
            name: value
            for name in ("speed", "step_length", "cadence")
            if (value := getattr(controls, name)) is not None
        }
        if stop:
            said.pop("speed", None)
        pace = choose_pace(self._body, **said, usual=self._usual)
        check_step_length(self._body, pace.step_length)
        return Wish(
            length=pace.step_length,
            duration=pace.step_duration,
            heading=controls.heading,
            stop=stop,
            keep_duration=controls.cadence is not None,
            keep_length=controls.step_length is not None,
        )

    def _show(self, until: float, *, inclusive: bool) -> None:
        """Make the frames up to ``until``; one in which a foot lands belongs to what follows."""
        first = len(self._frames)
        margin = INSTANT if inclusive else -INSTANT
        last = int(np.floor((until + margin) * self._fps))
        # rounding in the product must not lose or add a frame
        while (last + 1) / self._fps <= until + margin:
            last += 1
        while last / self._fps > until + margin:
            last -= 1
        if last >= first:
            self._frames += self._posed(np.arange(first, last + 1) / self._fps)

    def _posed(self, times: Float[np.ndarray, "F"]) -> list[LivePose]:
        poses = self._steering.poses(times)
        local = local_rotations(poses, self._body, self._skeleton).transpose(2, 0, 1)
        before = self._frames[-1].rotations if self._frames else None
        out = []
        for i, time in enumerate(times.tolist()):
            turned = np.array(local[i])
            if before is not None:  # of q and -q the one nearer to the frame before
                turned[(turned * before).sum(-1) < 0.0] *= -1.0
            before = turned
            center, down = np.array(poses.center[i]), np.array(poses.contacts[i])
            for array in (center, turned, down):
                array.flags.writeable = False
            out.append(LivePose(time, center, turned, down))
        return out
