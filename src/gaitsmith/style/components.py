"""Submotion components: the key frames of a body part taken apart into independent ones.

[KN12] section 3.3, Eqs. 2-4. What the paper leaves open is settled in
``docs/papers/kn12.md``: the reference of the logs, the un-whitening that equation 4 omits, an
order and signs that do not hang on where the search began.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from gaitsmith._checks import one_of
from gaitsmith.errors import InvalidInputError
from gaitsmith.geometry.threads import on_one_thread
from gaitsmith.style.parts import PARTS

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

    from gaitsmith.style.examples import Examples

#: Eigenvalues below this share of the largest are rounding and dropped.
NOTHING = 1e-10
METHODS = ("ica", "pca")
_TOLERANCE, _ROUNDS = 1e-8, 1000


@dataclass(frozen=True, eq=False)
class Components:
    """The components of one body part: ``C = U (V - mean)``, ``V = mean + A C``.

    Attributes
    ----------
    joints
        Joints of the part; the rows of V are their logs, three a joint.
    mean
        ``(3 J,)`` mean of V over all key frames of all examples, radians (0 to rounding where
        the logs are about the Karcher mean).
    unmix
        ``(Nc, 3 J)`` U, the paper's ``W P``.
    mix
        ``(3 J, Nc)`` A, its pseudoinverse; columns by falling size.
    keys
        ``(L, Nc, N)`` the components C of the N key frames of each of L examples.
    converged
        Whether FastICA met its tolerance. Any rotation of whitened data can be undone exactly,
        so a search that did not end costs nothing but independence.
    """

    joints: tuple[int, ...]
    mean: Float[np.ndarray, "R"]
    unmix: Float[np.ndarray, "Nc R"]
    mix: Float[np.ndarray, "R Nc"]
    keys: Float[np.ndarray, "L Nc N"]
    converged: bool

    def __len__(self) -> int:
        """Number of components."""
        return len(self.unmix)

    def of(self, logs: Float[np.ndarray, "n J 3"]) -> Float[np.ndarray, "n Nc"]:
        """Components of poses, given as logs of all joints ([KN12] Eq. 3)."""
        return (self._rows(logs) - self.mean) @ self.unmix.T

    def rest(self, logs: Float[np.ndarray, "n J 3"]) -> Float[np.ndarray, "n R"]:
        """What of poses no component holds; nothing where none were dropped."""
        return self._rows(logs) - self.mean - self.of(logs) @ self.mix.T

    def logs(self, components: Float[np.ndarray, "n Nc"]) -> Float[np.ndarray, "n J 3"]:
        """Logs of the part's joints from components ([KN12] Eq. 4, un-whitened)."""
        rows = self.mean + components @ self.mix.T
        return rows.reshape(len(components), len(self.joints), 3)

    def permuted(
        self, order: Float[np.ndarray, "Nc"], flipped: Bool[np.ndarray, "Nc"]
    ) -> Components:
        """The same components in another order, some with the other sign."""
        sign = np.where(flipped, -1.0, 1.0)
        return Components(
            self.joints,
            self.mean,
            self.unmix[order] * sign[:, None],
            self.mix[:, order] * sign,
            self.keys[:, order] * sign[:, None],
            self.converged,
        )

    def _rows(self, logs: Float[np.ndarray, "n J 3"]) -> Float[np.ndarray, "n R"]:
        return logs[:, self.joints].reshape(len(logs), -1)


@on_one_thread
def decompose(
    examples: Examples,
    *,
    method: str = "ica",
    variance: float | None = None,
    seed: int | None = None,
    rounds: int = _ROUNDS,
) -> dict[str, Components]:
    """Components of every part of ``examples`` (at least two).

    Parameters
    ----------
    method
        ``"ica"`` (the paper's) or ``"pca"``.
    variance
        Share of the variance to keep, below 1; None keeps all but rounding.
    seed
        Start of the search, an arbitrary rotation; None starts from the principal components,
        the same for everyone.
    rounds
        Most iterations of FastICA.

    Raises
    ------
    InvalidInputError
        If there is only one example, or ``variance`` is not in (0, 1).
    """
    one_of("method", method, METHODS)
    if len(examples.names) < 2:
        raise InvalidInputError(
            "components are what examples differ in: give at least two, or mix without them"
        )
    if variance is not None and not 0.0 < variance < 1.0:
        raise InvalidInputError(f"variance must be above 0 and below 1, got {variance!r}")
    return {part: _part(examples, part, method, variance, seed, rounds) for part in PARTS}


def _part(
    examples: Examples,
    part: str,
    method: str,
    variance: float | None,
    seed: int | None,
    rounds: int,
) -> Components:
    joints = examples.parts[part]
    logs = examples.keys[:, :, joints]
    count, keys = logs.shape[:2]
    values = logs.reshape(count * keys, -1).T  # (rows, example-major columns): the paper's V
    mean = values.mean(axis=1)
    away = values - mean[:, None]
    power, vectors = np.linalg.eigh(away @ away.T / away.shape[1])
    power, vectors = power[::-1], vectors[:, ::-1]
    kept = _kept(power, variance)
    whiten = vectors[:, :kept].T / np.sqrt(power[:kept, None])
    white = whiten @ away
    turn, converged = np.eye(kept), True
    if method == "ica" and kept > 1:
        turn, converged = _rotation(white, seed, rounds)
    unmix = turn @ whiten
    mix = (vectors[:, :kept] * np.sqrt(power[:kept])) @ turn.T
    out = Components(
        joints=joints,
        mean=mean,
        unmix=unmix,
        mix=mix,
        keys=(unmix @ away).reshape(kept, count, keys).transpose(1, 0, 2),
        converged=converged,
    )
    return out.permuted(*_canonical(out, unmix @ away))


def _kept(power: Float[np.ndarray, "R"], variance: float | None) -> int:
    kept = int((power > NOTHING * power[0]).sum())
    if variance is not None:
        share = np.cumsum(power) / power.sum()
        kept = min(kept, int(np.searchsorted(share, variance)) + 1)
    return max(kept, 1)


def _rotation(
    white: Float[np.ndarray, "Nc n"], seed: int | None, rounds: int
) -> tuple[Float[np.ndarray, "Nc Nc"], bool]:
    """The rotation that makes whitened data least Gaussian (FastICA), and whether it was found."""
    from sklearn.decomposition import fastica  # late: walking needs no scikit-learn
    from sklearn.exceptions import ConvergenceWarning

    search: Any = fastica  # its annotations know neither whiten=False nor what comes back
    count = len(white)
    start = np.eye(count)
    if seed is not None:
        start, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(count, count)))
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        _, turn, _ = search(
            white.T,
            n_components=None,
            algorithm="parallel",
            whiten=False,
            fun="logcosh",
            max_iter=rounds,
            tol=_TOLERANCE,
            w_init=start,
        )
    converged = not any(issubclass(w.category, ConvergenceWarning) for w in said)
    # a rotation to the last bit, whatever the search came to
    left, _, right = np.linalg.svd(turn)
    return left @ right, converged


def _canonical(
    found: Components, values: Float[np.ndarray, "Nc n"]
) -> tuple[Float[np.ndarray, "Nc"], Bool[np.ndarray, "Nc"]]:
    """Order by falling column of A; signs by a skewness above 0, else by A's largest entry."""
    size = np.linalg.norm(found.mix, axis=0)
    order = np.argsort(-size, kind="stable")
    skew = (values**3).mean(axis=1)
    largest = np.take_along_axis(found.mix, np.abs(found.mix).argmax(axis=0)[None], axis=0)[0]
    flipped = np.where(np.abs(skew) > 1e-9, skew < 0.0, largest < 0.0)
    return order, flipped[order]
