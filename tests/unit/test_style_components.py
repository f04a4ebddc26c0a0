"""Components: exact both ways, the same for everyone, and honest when the search does not end."""

from __future__ import annotations

import numpy as np
import pytest
from styles import library

from gaitsmith.errors import InvalidInputError
from gaitsmith.style.components import decompose
from gaitsmith.style.parts import PARTS


@pytest.fixture(scope="module")
def found():
    return decompose(library())


@pytest.mark.parametrize("part", PARTS)
def test_they_give_back_what_they_were_made_of(found, part):
    """A4 without offsets: key logs from components alone."""
    examples, one = library(), found[part]
    for j in range(10):
        logs = one.logs(one.keys[j].T)
        assert np.abs(logs - examples.keys[j][:, one.joints]).max() < 1e-9
        np.testing.assert_allclose(one.of(examples.keys[j]), one.keys[j].T, atol=1e-9)
    assert np.abs(one.unmix @ one.mix - np.eye(len(one))).max() < 1e-9
    assert len(one) <= 3 * len(one.joints)


@pytest.mark.parametrize("part", PARTS)
def test_they_are_white(found, part):
    values = np.concatenate(list(found[part].keys), axis=1)
    np.testing.assert_allclose(values.mean(1), 0.0, atol=1e-9)
    np.testing.assert_allclose(values @ values.T / values.shape[1], np.eye(len(values)), atol=1e-9)


@pytest.mark.parametrize("part", PARTS)
def test_order_and_signs_are_canonical(found, part):
    one = found[part]
    size = np.linalg.norm(one.mix, axis=0)
    assert (np.diff(size) <= 1e-12).all()
    values = np.concatenate(list(one.keys), axis=1)
    assert ((values**3).mean(1) >= -1e-9).all()


def test_they_are_less_gaussian_than_principal_components(found):
    """What ICA is for: the log-cosh contrast is farther from a Gaussian's."""
    plain = decompose(library(), method="pca")

    def contrast(one):
        values = np.concatenate(list(one.keys), axis=1)
        return np.abs(np.log(np.cosh(values)).mean(1) - 0.3746).sum()

    assert all(contrast(found[p]) > 1.2 * contrast(plain[p]) for p in PARTS)


def test_a_search_that_does_not_end_says_so_and_is_still_exact():
    rough = decompose(library(), rounds=1)
    assert not any(one.converged for one in rough.values())
    keys = library().keys[3]
    for one in rough.values():
        assert np.abs(one.logs(one.of(keys)) - keys[:, one.joints]).max() < 1e-9


def test_no_start_no_chance(found):
    again = decompose(library())
    for part in PARTS:
        assert again[part].mix.tobytes() == found[part].mix.tobytes()
    other = decompose(library(), seed=3)
    assert any(not np.array_equal(other[p].mix, found[p].mix) for p in PARTS)


def test_less_variance_means_fewer_components_and_a_rest():
    some = decompose(library(), variance=0.9)
    keys = library().keys[0]
    for part, one in some.items():
        assert len(one) < len(decompose(library(), method="pca")[part])
        rest = one.rest(keys).reshape(len(keys), -1, 3)
        whole = one.logs(one.of(keys)) + rest
        np.testing.assert_allclose(whole, keys[:, one.joints], atol=1e-12)


@pytest.mark.parametrize(
    ("asked", "match"),
    [({"variance": 1.5}, "variance"), ({"method": "nmf"}, "method must be one of ica, pca")],
)
def test_what_makes_no_sense_is_refused(asked, match):
    with pytest.raises(InvalidInputError, match=match):
        decompose(library(3), **asked)


def test_one_example_has_no_components():
    with pytest.raises(InvalidInputError, match="at least two"):
        decompose(library(1))
