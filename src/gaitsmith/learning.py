"""Clips and gait files to ways of walking: what ``learn`` and ``--gait`` do."""

from __future__ import annotations

import csv
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from gaitsmith import io
from gaitsmith.body.presets import body_from
from gaitsmith.conventions import SIDES
from gaitsmith.errors import (
    FileFormatError,
    InvalidInputError,
    UnknownFormatError,
    UnknownNameError,
)
from gaitsmith.gait.cycle import EVENTS
from gaitsmith.motion.motion import Markers, Motion
from gaitsmith.plan.manners import gait_of
from gaitsmith.synthesis.gaits import GAITS, Gait, learned

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from gaitsmith.body.body import Body
    from gaitsmith.gait.events import Stance
    from gaitsmith.plan.script import Action
    from gaitsmith.synthesis.upper_body import Manner
    from gaitsmith.walks.learned import LearnedGait

#: What can be learned from.
Clip: TypeAlias = "str | Path | Motion | Markers"
#: Suffixes of clips that can be learned from.
CLIPS = (*(s for s in io.READERS if s != ".npz"), ".npz", *io.MARKER_READERS)
#: Joints without which the upper body moves by rule.
_ARMS = frozenset(f"{side}{part}" for side in SIDES for part in ("UpperArm", "LowerArm", "Hand"))


def learn(
    clip: Clip | Sequence[Clip],
    *,
    name: str | None = None,
    symmetric: bool = False,
    events: Sequence[Stance] | None = None,
    unit: str | None = None,
    height: float | None = None,
    source: str | None = None,
    license: str = "",
    lengths: int = 1,
) -> LearnedGait:
    """The gait of the person who walks in ``clip``.

    Parameters
    ----------
    clip
        A file (``.bvh``, ``.amc``, ``.npz``; markers in ``.trc``, ``.csv``), a Motion or Markers.
        Several motions of one person and style at different step lengths, the usual one first,
        make one gait that walks each as it was: the nearest are generalized, and blended between.
    name
        What to call the gait; the file's name if not given.
    symmetric
        Make left and right mirror images of each other.
    events
        Stances to use instead of those found, seconds of the clip.
    unit
        Of a BVH or AMC, see :func:`gaitsmith.io.bvh_motion.read_bvh`.
    height
        Stature of who wears the markers, meters; else the markers tell.
    source, license
        Where the clip comes from and what may be done with it; kept in the gait.
    lengths
        Of how many strides of each clip, at most, to learn: of the usual one, and of others whose
        step lengths differ by 5 % of a leg or more.

    Raises
    ------
    InfeasibleError
        If a clip shows no 1.6 strides of straight, forward walking (markers with events: one
        stride), or if it is running.
    FileFormatError, OSError
        If a file cannot be read.

    Examples
    --------
    >>> motion = walk(distance=6.0, fps=60)  # doctest: +SKIP
    >>> learn(motion, name="again").step_width  # doctest: +SKIP
    """
    from gaitsmith.walks.learned import learned_gait  # late: a walk of a built-in gait needs none

    clips = [clip] if isinstance(clip, str | Path | Motion | Markers) else list(clip)
    if not clips:
        raise InvalidInputError("nothing to learn from: give a clip")
    if lengths < 1:
        raise InvalidInputError(f"lengths must be 1 or more, got {lengths!r}")
    files = [Path(c).name if isinstance(c, str | Path) else "" for c in clips]
    seen = [load_clip(Path(c), unit) if isinstance(c, str | Path) else c for c in clips]
    title = name or Path(files[0]).stem or "learned"
    told: dict[str, Any] = {
        "symmetric": symmetric,
        "events": events,
        "source": ", ".join(f for f in files if f) if source is None else source,
        "license": license,
    }
    if any(isinstance(one, Markers) for one in seen):
        from gaitsmith.gait.marker_legs import learn_from_markers

        if len(seen) > 1 or lengths > 1 or not isinstance(seen[0], Markers):
            raise InvalidInputError("of markers one stride of one clip is learned")
        found = learn_from_markers(seen[0], height=height, **told)
        return learned_gait(found, name=title, clip=files[0], upper_body="rules")
    if events is not None and len(seen) > 1:
        raise InvalidInputError("events are seconds of one clip, but there are several")
    return _of_motions([c for c in seen if isinstance(c, Motion)], title, files[0], lengths, told)


def _of_motions(
    motions: list[Motion], title: str, file: str, lengths: int, told: dict[str, Any]
) -> LearnedGait:
    """The gait of who walks in them, of the first by habit."""
    from gaitsmith.gait.learn import learn_cycles
    from gaitsmith.gait.person import person_of
    from gaitsmith.style.retarget import on_body
    from gaitsmith.walks.learned import grounded, learned_gait, with_others
    from gaitsmith.walks.stride import stride_of

    people = [person_of(motion, name=title) for motion in motions]
    usual, *others = (found for person in people for found in learn_cycles(person, lengths, **told))
    whole = all(set(person.roles) >= _ARMS for person in people)
    gait = learned_gait(usual, name=title, clip=file, upper_body="measured" if whole else "rules")
    if not others:
        return gait
    brought = (grounded(on_body(found.cycle, gait.body)) for found in others)
    return with_others(gait, [stride_of(cycle, gait.body, feet) for cycle, feet in brought])


def load_clip(path: Path, unit: str | None = None) -> Motion | Markers:
    """What is in a clip's file, a motion or markers."""
    suffix = path.suffix.lower()
    if suffix == ".bvh":
        from gaitsmith.io.bvh_motion import read_bvh

        return read_bvh(path, unit)
    if suffix == ".amc":
        from gaitsmith.io.amc import read_amc

        return read_amc(path, unit=unit)
    if unit is not None:
        raise InvalidInputError("unit is of BVH and AMC files")
    if suffix in io.MARKER_READERS:
        return io.load_markers(path)
    if suffix in io.READERS:
        return io.load(path)
    raise UnknownFormatError(path.suffix, CLIPS, verb="learn from")


def gait_from(
    spec: str | Path | LearnedGait | dict[str, Any], manner: Manner | None = None
) -> tuple[Gait, str | dict[str, Any]]:
    """The way of walking that ``--gait`` means, and how a recipe names it.

    ``spec`` is the name of a built-in gait, a ``.gait.json`` file, a clip to learn from, a
    learned gait, or what a recipe has in its place.
    """
    if isinstance(spec, str) and spec in GAITS:
        return GAITS[spec](manner), spec
    from gaitsmith.walks.learned import SUFFIX, gait_from_dict, gait_to_dict, read_gait

    if isinstance(spec, dict):
        try:
            spec = gait_from_dict(spec)
        except (KeyError, TypeError, ValueError, AttributeError) as error:
            raise InvalidInputError(f"not a gait: {error}") from None
    if isinstance(spec, str | Path):
        text = str(spec)
        path = Path(text)
        if text.lower().endswith((SUFFIX, ".json")):
            spec = read_gait(path)
        elif path.suffix and path.suffix.lower() in CLIPS:
            spec = learn(path)
        elif path.suffix:
            raise UnknownFormatError(path.suffix, (SUFFIX, *CLIPS), verb="take a gait from")
        else:
            raise UnknownNameError("gait", text, GAITS)
    return learned(spec, manner), gait_to_dict(spec)


def gaits_named(
    actions: Iterable[Action],
    gaits: Mapping[str, str | Path | LearnedGait | dict[str, Any]],
    manner: Manner | None = None,
) -> dict[str, tuple[Gait, str | dict[str, Any]]]:
    """The gaits that ``actions`` name, as :func:`gait_from` gives them.

    ``gaits`` says what the names mean; a name that is not in it is what ``--gait`` takes.
    """
    found: dict[str, tuple[Gait, str | dict[str, Any]]] = {}
    for i, action in enumerate(actions, start=1):
        name = gait_of(getattr(action, "tempo", None))
        if name is None or name in found:
            continue
        try:
            found[name] = gait_from(gaits.get(name, name), manner)
        except InvalidInputError as error:
            raise InvalidInputError(f"action {i}: {error}") from None
    return found


def body_of(spec: str | float | Path | Body) -> Body:
    """The body that ``--body`` means: as :func:`gaitsmith.body.presets.body_from`, or a clip's."""
    if isinstance(spec, str | Path) and Path(spec).suffix.lower() in io.READERS:
        from gaitsmith.gait.learn import body_in
        from gaitsmith.gait.person import person_of

        path = Path(spec)
        clip = load_clip(path)
        assert isinstance(clip, Motion)
        return body_in(person_of(clip, name=path.stem))
    return body_from(spec)


def read_events(path: str | Path) -> list[Stance]:
    """Stances in a CSV: ``side,heel_strike,foot_flat,heel_off,toe_off``, seconds of the clip."""
    from gaitsmith.gait.events import Stance

    path = Path(path)
    try:
        rows = list(csv.reader(path.read_text(encoding="utf-8-sig").splitlines()))
    except UnicodeDecodeError as error:
        raise FileFormatError(path, f"not text: {error}") from None
    except csv.Error as error:
        raise FileFormatError(path, f"not a CSV: {error}") from None
    head = [cell.strip().lower() for cell in rows[0]] if rows else []
    if head != ["side", *EVENTS]:
        raise FileFormatError(path, f"the first line must be side,{','.join(EVENTS)}", line=1)
    out: list[Stance] = []
    for line, row in enumerate(rows[1:], start=2):
        if not row:
            continue
        side = row[0].strip().lower()
        side = {"l": "left", "r": "right"}.get(side, side)
        try:
            times = [float(cell) for cell in row[1:]]
        except ValueError as error:
            raise FileFormatError(path, str(error), line=line) from None
        good = len(times) == len(EVENTS) and all(a <= b for a, b in pairwise(times))
        if side not in SIDES or not good or not all(-1e6 < t < 1e6 for t in times):
            raise FileFormatError(
                path,
                "a stance is a side (left, right) and four times in order: heel strike, foot "
                f"flat, heel off, toe-off; got {','.join(row)}",
                line=line,
            )
        out.append(Stance(SIDES.index(side), times[0], times[1], times[2], times[3]))
    if not out:
        raise FileFormatError(path, "no stances")
    return out
