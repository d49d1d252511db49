"""Marks everything here as verification, and gives the tests their counter-test."""

from pathlib import Path

import pytest


def pytest_collection_modifyitems(items):
    here = Path(__file__).parent
    for item in items:
        if here in Path(item.path).parents:
            item.add_marker(pytest.mark.verification)


@pytest.fixture
def must_fail():
    """Function ``must_fail(check, **mutant)``: the check has to miss its *truth* with the mutant's
    arguments.

    A mutant that only moves a frozen number, or that crashes, does not count.
    """

    def run(check, *args, **mutant):
        with pytest.raises(AssertionError, match="truth"):
            check(*args, **mutant)

    return run
