"""``gaitsmith list``."""

from __future__ import annotations

from typing import Annotated

import typer

KINDS = ("gaits", "bodies", "grounds", "formats")


def listing(
    kind: Annotated[str, typer.Argument(metavar="|".join(KINDS), help="What to list.")],
) -> None:
    """List what is built in, one a line: name, what it is."""
    from gaitsmith._checks import one_of

    one_of("kind", kind, KINDS)
    for name, about in rows(kind):
        print(f"{name:16s} {about}".rstrip())


def rows(kind: str) -> list[tuple[str, str]]:
    """Names and one-line descriptions of a family."""
    if kind == "bodies":
        from gaitsmith.body.presets import BODIES

        return [(name, preset.about) for name, preset in BODIES.items()]
    if kind == "grounds":
        from gaitsmith.ground import GROUNDS

        return [(name, _first_line(make)) for name, make in GROUNDS.items()]
    if kind == "gaits":
        from gaitsmith.synthesis.gaits import GAITS

        return [(name, _first_line(make)) for name, make in GAITS.items()]
    from gaitsmith.pipeline import WRITERS

    return [(suffix, _FORMATS.get(suffix, "")) for suffix in sorted(WRITERS)]


_FORMATS = {
    ".bvh": "motion for animation tools, centimeters, Mixamo-style names",
    ".csv": "positions of joints and soles, contacts and phases, one row a frame",
    ".gif": "animated picture",
    ".glb": "skinned, animated figure for 3D tools and game engines",
    ".npz": "everything, exact: rotations, positions, soles, contacts, footsteps, recipe",
    ".png": "contact sheet: side, front, top with footprints, joint curves",
}


def _first_line(thing: object) -> str:
    return (thing.__doc__ or "").strip().splitlines()[0].replace("``", "")
