"""Loops shared out to threads: every place once, the same result with any number of them, errors raised."""

import numpy as np
import pytest

from churchpipe.conic import threads
from churchpipe.model.arrays import FloatArray


def test_the_number_of_threads_is_that_of_blas(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OMP_NUM_THREADS", "3")
    assert threads.threads() == 3
    monkeypatch.setenv("OMP_NUM_THREADS", "2,1")
    assert threads.threads() == 2
    monkeypatch.setenv("OMP_NUM_THREADS", "0")
    assert threads.threads() == 1


@pytest.mark.parametrize("count", ["1", "2", "5"])
@pytest.mark.parametrize("places", [7, 20_003])
def test_every_place_is_done_once(monkeypatch: pytest.MonkeyPatch, count: str, places: int) -> None:
    monkeypatch.setenv("OMP_NUM_THREADS", count)
    done = np.zeros(places)

    def loop(share: int, shares: int, out: FloatArray) -> None:
        begin, end = threads.bounds_of(places, share, shares)
        out[begin:end] += 1.0

    threads.in_shares(loop, places, done)
    assert (done == 1.0).all()


def test_an_error_in_another_thread_is_raised(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OMP_NUM_THREADS", "2")

    def loop(share: int, _shares: int) -> None:
        if share == 0:
            raise ArithmeticError("in the other thread")

    with pytest.raises(ArithmeticError, match="in the other thread"):
        threads.in_shares(loop, 20_000)
