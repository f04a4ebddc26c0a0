"""Feet and floor in numbers: where the floor is, what soles do to it, how toes skate."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.measures import skating
from gaitsmith.measures.contacts import heights, slips
from gaitsmith.measures.notes import Figures, explained

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.measures.figure import Figure

#: Meters between the highest and the lowest stance above which a floor is not level.
UNEVEN = 0.10


def floor_figures(figure: Figure, notes: list[str]) -> Figures:
    """Where the floor is, and how level the feet say it is."""
    stood = figure.footsteps.height
    if figure.height is None:
        explained({"height_m": None}, "nothing tells where the crown is", notes)
    origin = np.zeros(1)
    level = None if figure.ground is None else float(figure.ground.height(origin, origin)[0])
    drift = spread = None
    if len(stood) > 1:
        spread = float(np.ptp(stood))
        order = np.arange(len(stood))
        drift = float(np.polyfit(order, stood, 1)[0]) * (len(stood) - 1)
    return explained(
        {"floor_m": level, "floor_drift_m": drift, "floor_range_m": spread},
        "fewer than two stances, or an unknown ground",
        notes,
    )


def contact_figures(figure: Figure, notes: list[str]) -> Figures:
    """Slip, depth and height of the soles."""
    # what rises is no slip where contacts are estimated: height has its own figure
    paths = figure.soles if figure.exact else figure.soles[..., [0, 2]]
    slip = 1e3 * slips(paths, figure.down, figure.bearing)
    out: Figures = {
        "stances": len(slip),
        **explained(
            {
                "slip_mm_max": float(slip.max()) if len(slip) else None,
                "slip_mm_median": float(np.median(slip)) if len(slip) else None,
            },
            "no foot stands still",
            notes,
        ),
    }
    above = figure.above
    stood = figure.footsteps.height
    names = ("penetration_mm_max", "penetration_mm_p95", "float_mm_max", "float_mm_p95")
    why = "the ground is not known"
    if above is not None and not figure.footsteps.exact and len(stood) and np.ptp(stood) > UNEVEN:
        above, why = None, f"feet stand on heights {np.ptp(stood):.2f} m apart: no level floor"
    if above is None:
        return out | explained(dict.fromkeys(names), why, notes)
    deep = 1e3 * np.maximum(-above.min(axis=(1, 2)), 0.0)
    out |= {"penetration_mm_max": float(deep.max()), "penetration_mm_p95": _p95(deep)}
    high = 1e3 * np.maximum(heights(above, figure.down, exact=figure.exact), 0.0)
    float_: Figures = {
        "float_mm_max": float(high.max()) if len(high) else None,
        "float_mm_p95": _p95(high) if len(high) else None,
    }
    return out | explained(float_, "no foot bears", notes)


def skating_figures(figure: Figure, notes: list[str]) -> Figures:
    """The published ratios, from our floor; GMD's also from the lowest toe joint."""
    toes, fps = figure.toes, figure.motion.fps
    feet = figure.footsteps
    floor = figure.ground
    # over what the feet stand on: on stairs and slopes too
    level = float(np.median(feet.height)) if len(feet) else float(figure.soles[..., 1].min())
    if floor is not None:
        toes = np.array(toes)
        toes[..., 1] -= floor.height(toes[..., 0], toes[..., 2])
        level = 0.0
    ratio, speed = skating.kimodo_skate(toes, fps, level)
    away = 1e3 * skating.toe_excursions(toes, fps, level)
    return explained(
        {
            "gmd_skating_ratio": skating.gmd_skating_ratio(toes, fps, level),
            "gmd_skating_ratio_toe_floor": skating.gmd_skating_ratio(
                toes, fps, float(toes[..., 1].min())
            ),
            "kimodo_skate_ratio": ratio,
            "kimodo_skate_mps": speed,
            "camdm_sliding_ratio": skating.camdm_sliding(toes, figure.hips, fps),
            "toe_excursion_mm_median": float(np.median(away)) if len(away) else None,
            "toe_excursion_mm_p95": _p95(away) if len(away) else None,
        },
        "no toe joint is low and slow enough for the definition, or the root stays",
        notes,
    )


def _p95(values: Float[np.ndarray, "n"]) -> float:
    return float(np.percentile(values, 95.0))
