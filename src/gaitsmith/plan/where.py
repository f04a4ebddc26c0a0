"""Where to walk, as people write it: a distance, points, a file of points or of footsteps."""

from __future__ import annotations

import csv
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any

import numpy as np

from gaitsmith._checks import positive
from gaitsmith.errors import FileFormatError, InvalidInputError
from gaitsmith.plan.footsteps import StepPlan
from gaitsmith.plan.given import GivenSteps
from gaitsmith.plan.paths import Path, checked_points

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from jaxtyping import Float

    from gaitsmith.plan.script import Action, Script

    PathLike = str | FilePath | Path | Sequence[Sequence[float]] | Mapping[str, Any]
    StepsLike = str | FilePath | GivenSteps | StepPlan | Sequence[Mapping[str, Any]]
    Row = tuple[int, list[str]]

#: Columns of a file of footsteps; the first four must be there.
COLUMNS = ("side", "x", "z", "heading_deg", "y", "time")
_SIDES = {"l": 0, "left": 0, "0": 0, "r": 1, "right": 1, "1": 1}


def read_where(
    distance: float | None,
    path: PathLike | None,
    steps: StepsLike | None,
    do: str | Sequence[str | Action] | None = None,
) -> tuple[Path | GivenSteps | StepPlan | Script, dict[str, Any]]:
    """Where to walk, and how a recipe says it; exactly one of the four must be given."""
    ways = (("distance", distance), ("path", path), ("steps", steps), ("do", do))
    given = [n for n, v in ways if v is not None]
    if len(given) != 1:
        raise InvalidInputError(
            "say where to walk by one of distance, path, steps and do, got "
            + (" and ".join(given) if given else "none of them")
        )
    if do is not None:
        from gaitsmith.plan.script import Script, read_script  # late: few walks follow one

        script = Script(tuple(read_script(do)))
        return script, {"do": script.text}
    if distance is not None:
        length = positive("distance", distance, "meters")
        return Path.line(length), {"distance": length}
    if path is not None:
        return _read_path(path)
    assert steps is not None
    return _read_steps(steps)


def _read_path(path: PathLike) -> tuple[Path, dict[str, Any]]:
    if isinstance(path, Path):
        nodes = {name: getattr(path, name).tolist() for name in Path.__dataclass_fields__}
        return path, {"path": nodes}
    if isinstance(path, dict):
        try:
            return Path(**{k: np.array(v, dtype=np.float64) for k, v in path.items()}), {
                "path": dict(path)
            }
        except (TypeError, ValueError) as error:
            raise InvalidInputError(f"not the nodes of a path: {error}") from None
    if isinstance(path, FilePath) or (isinstance(path, str) and path.lower().endswith(".csv")):
        points = load_points(path)
    elif isinstance(path, str):
        points = parse_points(path)
    else:
        points = checked_points(path)  # type: ignore[arg-type]
    return Path.through(points), {"path": points.tolist()}


def parse_points(text: str) -> Float[np.ndarray, "n 2"]:
    """Points of ``"x,z x,z ..."``."""
    points = []
    for i, word in enumerate(text.split(), start=1):
        parts = word.split(",")
        try:
            x, z = (float(p) for p in parts)
        except ValueError:
            raise InvalidInputError(
                f"point {i} of the path must be x,z in meters as in '0,0 0,4 2,7', got {word!r}"
            ) from None
        points.append((x, z))
    if not points:
        raise InvalidInputError("a path needs at least two points x,z, got none")
    return checked_points(points)


def load_points(path: str | FilePath) -> Float[np.ndarray, "n 2"]:
    """Points of a CSV file: x,z in meters, one point a line, a heading line if you like."""
    rows = _rows(path)
    if rows and not _is_number(rows[0][1][0]):
        names = [c.strip().lower() for c in rows[0][1]]
        if names[:2] != ["x", "z"]:
            raise FileFormatError(
                path, f"columns must be x,z, got {','.join(names)}", line=rows[0][0]
            )
        rows = rows[1:]
    points = []
    for line, cells in rows:
        if len(cells) != 2:
            raise FileFormatError(path, f"a point is x,z, got {len(cells)} values", line=line)
        points.append([_cell(path, line, name, c) for name, c in zip("xz", cells, strict=True)])
        if len(points) > 1 and np.hypot(*np.subtract(points[-1], points[-2])) < 1e-6:
            raise FileFormatError(path, "the same point as the line before; remove it", line=line)
    if len(points) < 2:
        raise FileFormatError(path, f"a path needs at least two points, got {len(points)}")
    try:
        return checked_points(points)
    except InvalidInputError as error:
        raise FileFormatError(path, str(error)) from None


def _read_steps(
    steps: StepsLike,
) -> tuple[GivenSteps | StepPlan, dict[str, Any]]:
    if isinstance(steps, StepPlan):
        return steps, {"steps": plan_to_dict(steps)}
    if isinstance(steps, dict):
        return plan_from_dict(steps), {"steps": dict(steps)}
    if isinstance(steps, GivenSteps):
        given = steps
    elif isinstance(steps, str | FilePath):
        given = load_footsteps(steps)
    else:
        given = _of_mappings(steps)  # type: ignore[arg-type]
    return given, {"steps": plan_rows(given)}


def plan_rows(given: GivenSteps) -> list[dict[str, Any]]:
    """Rows of a file of footsteps, headings in radians under ``heading``."""
    out = []
    for i in range(len(given.side)):
        row: dict[str, Any] = {
            "side": "LR"[given.side[i]],
            "x": float(given.place[i, 0]),
            "z": float(given.place[i, 1]),
            "heading": float(given.heading[i]),
        }
        if given.height is not None:
            row["y"] = float(given.height[i])
        if given.time is not None:
            row["time"] = float(given.time[i])
        out.append(row)
    return out


def _of_mappings(rows: Sequence[Mapping[str, Any]]) -> GivenSteps:
    side, place, heading = [], [], []
    extra: dict[str, list[float]] = {"y": [], "time": []}
    for i, row in enumerate(rows, start=1):
        known = {*COLUMNS, "heading"}
        if not isinstance(row, dict) or not {"side", "x", "z"} <= set(row) <= known:
            raise InvalidInputError(
                f"footstep {i} must have side, x, z and heading_deg (or heading, radians), and "
                f"may have y and time, got {row!r}"
            )
        where = str(row["side"]).strip().lower()
        if where not in _SIDES or ("heading" in row) == ("heading_deg" in row):
            raise InvalidInputError(
                f"footstep {i}: side must be L or R, with one of heading_deg and heading, got "
                f"{row!r}"
            )
        side.append(_SIDES[where])
        place.append([row["x"], row["z"]])
        heading.append(row["heading"] if "heading" in row else np.radians(row["heading_deg"]))
        for name, values in extra.items():
            if name in row:
                values.append(row[name])
    columns = {}
    for name, key in (("y", "height"), ("time", "time")):
        if extra[name] and len(extra[name]) != len(side):
            raise InvalidInputError(f"{name} must be given for all footsteps or for none")
        columns[key] = np.array(extra[name], dtype=np.float64) if extra[name] else None
    count = len(side)
    return GivenSteps(
        np.array(side),
        np.array(place, dtype=np.float64).reshape(count, 2),
        np.array(heading, dtype=np.float64),
        **columns,
    )


def load_footsteps(path: str | FilePath) -> GivenSteps:
    """Footsteps of a CSV file with the columns ``side,x,z,heading_deg[,y][,time]``."""
    rows = _rows(path)
    if not rows:
        raise FileFormatError(path, "no footsteps in it")
    names = list(COLUMNS[:4])
    line, cells = rows[0]
    if cells[0].strip().lower() not in _SIDES:
        names, rows = [c.strip().lower() for c in cells], rows[1:]
        missing = [n for n in COLUMNS[:4] if n not in names]
        unknown = [n for n in names if n not in COLUMNS]
        if missing or unknown or len(set(names)) != len(names):
            raise FileFormatError(
                path,
                "columns must be side,x,z,heading_deg and may be y and time, got "
                + ",".join(names),
                line=line,
            )
    elif len(cells) != 4:
        raise FileFormatError(path, "more than four columns need a line of column names", line=line)
    found: dict[str, list[float]] = {n: [] for n in names}
    for line, cells in rows:
        if len(cells) != len(names):
            raise FileFormatError(
                path, f"{len(names)} values needed ({','.join(names)}), got {len(cells)}", line=line
            )
        for name, cell in zip(names, cells, strict=True):
            if name == "side":
                which = _SIDES.get(cell.strip().lower())
                if which is None:
                    raise FileFormatError(path, f"side must be L or R, got {cell!r}", line=line)
                found[name].append(which)
            else:
                found[name].append(_cell(path, line, name, cell))
        _check_row(path, line, found)
    try:
        return GivenSteps(
            side=np.array(found["side"], dtype=np.int64),
            place=np.stack([found["x"], found["z"]], axis=-1),
            heading=np.radians(np.array(found["heading_deg"])),
            height=np.array(found["y"]) if "y" in found else None,
            time=np.array(found["time"]) if "time" in found else None,
        )
    except InvalidInputError as error:
        raise FileFormatError(path, str(error)) from None


def _check_row(path: str | FilePath, line: int, found: dict[str, list[float]]) -> None:
    """Alternation and times, where a line can be named."""
    side, time = found["side"], found.get("time")
    if len(side) > 1 and side[-1] == side[-2] and len(side) != 3:  # either foot may step first
        which = "LR"[int(side[-1])]
        raise FileFormatError(
            path, f"sides must alternate, this is {which} after {which}", line=line
        )
    if time is not None:
        wrong = time[-1] != 0.0 if len(time) <= 2 else time[-1] <= time[-2]
        if wrong:
            raise FileFormatError(
                path, "time must be 0 for both initial feet and then rise", line=line
            )


def _rows(path: str | FilePath) -> list[Row]:
    """Lines of a CSV file that say something, with their numbers."""
    try:
        text = FilePath(path).read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise FileFormatError(path, "not a text file") from None
    out: list[Row] = []
    try:
        reader = csv.reader(text.splitlines())
        for cells in reader:
            if cells and any(c.strip() for c in cells) and not cells[0].lstrip().startswith("#"):
                out.append((reader.line_num, cells))
    except csv.Error as error:
        raise FileFormatError(path, f"not a CSV file: {error}") from None
    return out


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _cell(path: str | FilePath, line: int, name: str, cell: str) -> float:
    value = float(cell) if _is_number(cell) else float("nan")
    if not np.isfinite(value):
        raise FileFormatError(
            path, f"{name} must be a finite number, got {cell.strip()!r}", line=line
        )
    return value


def plan_to_dict(plan: StepPlan) -> dict[str, Any]:
    """A plan as JSON can hold it."""
    out: dict[str, Any] = {"kinds": list(plan.kinds)}
    for name in StepPlan.__dataclass_fields__:
        value = getattr(plan, name)
        if name != "kinds":
            out[name] = None if value is None else value.tolist()
    return out


def plan_from_dict(data: Mapping[str, Any]) -> StepPlan:
    """The plan of :func:`plan_to_dict`."""
    fields = set(StepPlan.__dataclass_fields__)
    if not set(data) <= fields or "kinds" not in data:
        raise InvalidInputError(f"not a plan: it must have {', '.join(sorted(fields))}")
    arrays = {k: None if v is None else np.array(v) for k, v in data.items() if k != "kinds"}
    return StepPlan(kinds=tuple(data["kinds"]), **arrays)  # type: ignore[arg-type]
