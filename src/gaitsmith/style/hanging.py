"""Arms of one walk on the trunk of another: they hang as they did, wherever that trunk leans."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import SIDES, UP
from gaitsmith.geometry.rotations import between, inverse, multiply, rotate

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jaxtyping import Float

    from gaitsmith.style.examples import Examples


def with_hanging_arms(
    examples: Examples,
    root: Float[np.ndarray, "L"],
    weights: Mapping[str, Float[np.ndarray, "L *c"]],
    rotations: Float[np.ndarray, "K J 4"],
) -> Float[np.ndarray, "K J 4"]:
    """``rotations`` with upper arms that are as far from plumb as in their own walk.

    Arms are known against the chest. Those of somebody who leans back point forward of his
    chest's own down, and would trail behind a chest that leans forward. So where arms have weights
    of their own, they are turned by what the mean lean of the chest that they come from and of the
    one that they come to differ in. What the chest does in a stride they go along with, as ever.

    Parameters
    ----------
    root
        Weights of the root.
    weights
        Of every part; of several components the mean counts.
    rotations
        Local rotations of the mix.
    """
    skeleton, out = examples.skeleton, rotations
    mean = examples.keys.mean(axis=1)
    trunk = _single(weights["torso_head"])
    for side in SIDES:
        own = _single(weights[f"{side}_arm"])
        if np.array_equal(own, trunk):
            continue
        upper = skeleton.index(f"{side}UpperArm")
        shoulder = skeleton.parents[upper]
        # without a shoulder the arm hangs on the chest itself
        chest = (
            skeleton.parents[shoulder] if skeleton.names[shoulder].startswith(side) else shoulder
        )
        chain = [chest]
        while chain[0]:
            chain.insert(0, skeleton.parents[chain[0]])
        up = [
            rotate(inverse(_turned(examples, mean, chain, *pair)), UP)
            for pair in ((own, own), (root, trunk))
        ]
        turn = between(*up)
        if shoulder != chest:
            held = rotations[:, shoulder]
            turn = multiply(inverse(held), multiply(turn, held))
        out = np.array(out)
        out[:, upper] = multiply(turn, rotations[:, upper])
    return out


def _single(weights: Float[np.ndarray, "L *c"]) -> Float[np.ndarray, "L"]:
    return weights if weights.ndim == 1 else weights.mean(axis=1)


def _turned(
    examples: Examples,
    mean: Float[np.ndarray, "L J 3"],
    chain: list[int],
    root: Float[np.ndarray, "L"],
    trunk: Float[np.ndarray, "L"],
) -> Float[np.ndarray, "4"]:
    """Mean rotation in space of the last joint of ``chain``, which begins with the root."""
    logs = np.tensordot(trunk, mean, 1)
    logs[0] = root @ mean[:, 0]
    local = examples.rotations(logs[None])[0]
    out = local[chain[0]]
    for joint in chain[1:]:
        out = multiply(out, local[joint])
    return out
