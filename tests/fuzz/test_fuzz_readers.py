"""Mutated files: a reader gives a result or says what is broken, quickly, and nothing else."""

from __future__ import annotations

import time

import pytest
from hypothesis import given
from hypothesis import strategies as st
from readers import SEEDS, WORDS, try_to_read


@pytest.mark.parametrize("suffix", SEEDS)
def test_the_good_files_are_good(suffix):
    assert try_to_read(suffix, SEEDS[suffix])


def mutations(seed: bytes) -> st.SearchStrategy[bytes]:
    """``seed`` with some parts cut, doubled, moved, or overwritten by words that mean something."""
    place = st.integers(0, len(seed))
    change = st.tuples(
        place,
        st.integers(0, 60),
        st.one_of(
            st.sampled_from(WORDS),
            st.binary(max_size=6),
            st.floats(width=32).map(lambda x: repr(x).encode()),
            place.map(lambda at: seed[at : at + 40]),
        ),
    )

    def apply(changes: list[tuple[int, int, bytes]]) -> bytes:
        data = seed
        for at, cut, put in changes:
            data = data[:at] + put + data[at + cut :]
        return data

    return st.lists(change, min_size=1, max_size=4).map(apply)


@pytest.mark.parametrize("suffix", SEEDS)
def test_mutated_files_are_read_or_refused(suffix):
    @given(mutations(SEEDS[suffix]))
    def check(data: bytes) -> None:
        start = time.perf_counter()
        try_to_read(suffix, data)
        assert time.perf_counter() - start < 5.0

    check()


@pytest.mark.parametrize("suffix", SEEDS)
def test_every_beginning_of_a_file_is_read_or_refused(suffix):
    seed = SEEDS[suffix]
    for stop in range(0, len(seed), 7):
        try_to_read(suffix, seed[:stop])


@pytest.mark.parametrize("suffix", SEEDS)
@given(st.binary(max_size=200))
def test_noise_is_refused(suffix, data):
    assert not try_to_read(suffix, data) or suffix == ".csv"
