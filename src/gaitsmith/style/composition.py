"""A mix from its examples to its cycle: components and leg weights only where they are asked."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING

from gaitsmith.style.components import decompose
from gaitsmith.style.legs import leg_weights
from gaitsmith.style.mix import Mixed, mixed

if TYPE_CHECKING:
    from collections.abc import Mapping

    from gaitsmith.style.components import Components
    from gaitsmith.style.examples import Examples
    from gaitsmith.style.weights import Mix


#: Components of the examples that were mixed last.
_decomposed = lru_cache(8)(decompose)


def composition(
    examples: Examples, mix: Mix, components: Mapping[str, Components] | None = None
) -> Mixed:
    """The walk that ``mix`` makes of ``examples``, its legs found as it says.

    ``components`` are taken as given, or found where the mix needs them: for weights by
    component, for the engine ``"keys"``, for legs that are not ``"given"``.
    """
    vectors = any(
        isinstance(value, tuple | list)
        for part in mix.parts.values()
        for value in part.weights.values()
    )
    needed = mix.engine == "keys" or mix.legs != "given" or vectors
    if components is None and needed and len(examples.names) > 1:
        components = _decomposed(examples)
    if mix.legs == "given" or components is None:
        return mixed(examples, mix, components)
    at = "stance" if mix.legs == "optimized" else "keys"
    found = leg_weights(examples, mix, components, method=mix.legs, at=at)
    out = mixed(examples, mix, components, legs=found.weights)
    note = (
        f"leg weights found ({mix.legs}): standing feet are {1e3 * max(found.after):.0f} mm from "
        f"the base's, {1e3 * max(found.before):.0f} mm with the weights given"
    )
    return replace(out, notes=(*out.notes, note))
