"""Points at the same place and nearest points, against a tree."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from fingerpad.specimen import near

pytestmark = pytest.mark.unit


def grid(columns, rows):
    """Points of a grid, many of them in line."""
    return np.stack(
        np.meshgrid(np.linspace(-1, 1, columns), np.linspace(0, 1, rows)), axis=-1
    ).reshape(-1, 2)


def test_twins_are_the_pairs_of_a_tree():
    base = np.random.default_rng(0).uniform(size=(300, 2))
    points = np.concatenate([base, base[:20] + 4e-4, base[5:9]])
    found = near.twins(points, 1e-3)
    np.testing.assert_array_equal(
        found[np.lexsort(found.T[::-1])], sorted(cKDTree(points).query_pairs(1e-3))
    )
    assert near.twins(grid(9, 5), 1e-6).shape == (0, 2) and near.twins(
        np.zeros((1, 2)), 1.0
    ).shape == (0, 2)


def test_a_mirror_image_is_found_node_for_node_and_what_is_not_there_is_not():
    points = np.random.default_rng(1).permutation(grid(41, 17))
    image = near.same_place(points * (-1, 1), points, 1e-9)
    np.testing.assert_allclose(points[image], points * (-1, 1), atol=1e-9)
    moved = points.copy()
    moved[7] += 1e-3
    assert np.sum(near.same_place(moved, points, 1e-9) < 0) == 1


@pytest.mark.parametrize("most", [near._MOST, 0])
def test_nearest_are_those_of_a_tree(most, monkeypatch):
    monkeypatch.setattr(near, "_MOST", most)
    rng = np.random.default_rng(2)
    points, others = rng.uniform(size=(40, 2)), rng.uniform(size=(500, 2))
    truth = cKDTree(others).query(points, k=24)
    np.testing.assert_array_equal(near.nearest(points, others, 24), truth[1])
    assert near.nearest(points, others[:3], 24).shape == (40, 3)
