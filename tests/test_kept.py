"""What is made of a history once."""

import gc
import weakref

import numpy as np
import pytest
import xarray as xr

from fingerpad.measures.kept import kept

pytestmark = pytest.mark.unit


def test_a_thing_is_made_once_a_history_and_way_and_goes_with_it():
    calls = []

    @kept
    def every(history, step=2):
        calls.append(step)
        return history.isel(time=slice(None, None, step))

    one, other = (xr.Dataset({"force": ("time", np.arange(8.0) + k)}) for k in range(2))
    assert every(one) is every(one) and every(one, 3) is every(one, 3) and calls == [2, 3]
    assert every(other).force[0] == 1 and calls == [2, 3, 2]
    gone = weakref.ref(every(one))
    del one
    gc.collect()
    assert gone() is None and every(other) is every(other)


def test_what_is_the_history_itself_is_not_kept_by_it():
    """Else neither would ever go."""

    @kept
    def same(history):
        return history

    history = xr.Dataset({"force": ("time", np.arange(3.0))})
    assert same(history) is history
    gone = weakref.ref(history)
    del history
    gc.collect()
    assert gone() is None
