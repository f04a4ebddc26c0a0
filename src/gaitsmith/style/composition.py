"""A mix from its examples to its cycle: components and leg weights only where they are asked."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.style.components import decompose
from gaitsmith.style.examples import examples_of
from gaitsmith.style.legs import leg_weights
from gaitsmith.style.mix import Mixed, mixed
from gaitsmith.style.weights import Mix

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from gaitsmith.body.body import Body
    from gaitsmith.gait.cycle import Cycle
    from gaitsmith.style.components import Components
    from gaitsmith.style.examples import Examples


#: Components of the examples that were mixed last.
_decomposed = lru_cache(8)(decompose)


def composition(
    examples: Examples, mix: Mix, components: Mapping[str, Components] | None = None
) -> Mixed:
    """The walk that ``mix`` makes of ``examples``, its legs found as it says.

    ``components`` are taken as given, or found where the mix needs them: for weights by
    component, for the engine ``"keys"``, for legs that are not ``"given"``.
    """
    if components is None:
        components = components_for(examples, mix)
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


def components_for(examples: Examples, mix: Mix) -> Mapping[str, Components] | None:
    """Components of ``examples`` if ``mix`` needs them and there is more than one."""
    vectors = any(
        isinstance(value, tuple | list)
        for part in mix.parts.values()
        for value in part.weights.values()
    )
    needed = mix.engine == "keys" or mix.legs != "given" or vectors
    return _decomposed(examples) if needed and len(examples.names) > 1 else None


def at_other_lengths(
    examples: Examples, mix: Mix, cycles: Mapping[str, Sequence[Cycle]]
) -> list[Mixed]:
    """The walks that ``mix`` makes of the examples' other strides.

    Parameters
    ----------
    examples, mix
        The usual strides, and how they are mixed.
    cycles
        All cycles of each example, the usual one first, on any body.

    Returns
    -------
    One mix for each other stride of the example that has most of them among those that the root
    is made of. Every example shows the stride that is as much shorter or longer than its usual
    one; between two of its cycles, one that is mixed of them. The examples' reference and
    components stay, so that weights mean the same at every length.
    """
    shares = mix.shares(examples.names)
    share_of = dict(zip(examples.names, shares.tolist(), strict=True))
    lead = max(examples.names, key=lambda n: (share_of[n] > 0.0, len(cycles[n]), share_of[n]))
    first, *rest = cycles[lead]
    components = components_for(examples, mix)
    out = []
    for factor in (other.stride_length / first.stride_length for other in rest):
        shown = {name: _stride_at(cycles[name], factor, examples.body) for name in examples.names}
        here = examples_of(shown, examples.body, reference=examples.reference)
        asked = mix
        if mix.speed is not None:  # of the usual stride: the others keep their pace beside it
            usual, other = (shares @ [c.speed for c in e.cycles] for e in (examples, here))
            asked = replace(mix, speed=float(mix.speed * other / usual))
        out.append(composition(here, asked, components))
    return out


def _stride_at(cycles: Sequence[Cycle], factor: float, body: Body) -> Cycle:
    """The stride of a walk that is ``factor`` times as long as its usual one, as far as it goes."""
    order = sorted(cycles, key=lambda c: c.stride_length)
    lengths = [c.stride_length for c in order]
    place = float(np.interp(factor * cycles[0].stride_length, lengths, np.arange(len(order))))
    below = int(place)
    share = place - below
    if share < 1e-9:
        return order[below]
    both = examples_of({"shorter": order[below], "longer": order[below + 1]}, body)
    return mixed(both, Mix({"shorter": 1.0 - share, "longer": share})).cycle
