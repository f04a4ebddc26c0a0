"""Figures that cannot be had, and why."""

from __future__ import annotations

from typing import Any

#: Figures by name; numbers, words, lists of words, or None.
Figures = dict[str, Any]


def explained(figures: Figures, why: str, notes: list[str]) -> Figures:
    """``figures``, with a note that says why some of them are None."""
    missing = [name for name, value in figures.items() if value is None]
    if missing:
        notes.append(f"{why}: no {', '.join(missing)}")
    return figures
