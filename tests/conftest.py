"""Which files of tests are started first."""

LONGEST = (
    "test_hard_case_catalogue.py",
    "test_reruns.py",
    "test_docs.py",
    "test_figure_regression.py",
    "test_hard_strokes.py",
    "test_friction.py",
    "test_targets.py",
    "test_chapter3.py",
)
"""Each process is given whole files; what is started last must not be long."""


def pytest_configure(config):
    """What the package itself warns of is an error."""
    config.addinivalue_line("filterwarnings", r"error:::fingerpad(\..*)?$")


def pytest_collection_modifyitems(items):
    rank = {name: place for place, name in enumerate(LONGEST)}
    items.sort(key=lambda item: rank.get(item.path.name, len(rank)))
