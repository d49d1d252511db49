"""A mesh is judged before it is used: one body whose parts share their nodes, with its skin up over
x = 0.
"""

from dataclasses import replace

import numpy as np
import pytest
import yaml

import fingerpad
from fingerpad.cli import main
from fingerpad.specimen import MeshError, write_pad
from own_meshes import SLAB, compact, read_back, slab_mesh, turned

pytestmark = pytest.mark.unit

EDGE = 1e-3


def joined(lower, upper):
    """Two meshes as one, without common nodes: base of the first, skin of the second."""
    shift = len(lower.points)
    return replace(
        lower,
        points=np.concatenate([lower.points, upper.points]),
        cells=np.concatenate([lower.cells, upper.cells + shift]),
        region=np.repeat([0, 1], [len(lower.cells), len(upper.cells)]).astype(np.int8),
        curves={"skin": upper.curves["skin"] + shift, "base": lower.curves["base"]},
        regions=("lower", "upper"),
    )


def merged(mesh):
    """Nodes at one place made one."""
    keys = np.round(mesh.points / 1e-9).astype(np.int64)
    _, first, number = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    number = number.reshape(-1).astype(np.int32)
    curves = {name: number[facets] for name, facets in mesh.curves.items()}
    return replace(mesh, points=mesh.points[first], cells=number[mesh.cells], curves=curves)


def lifted(mesh, height):
    return replace(mesh, points=mesh.points + [0.0, height])


def shifted(mesh, way):
    return replace(mesh, points=mesh.points + [way, 0.0])


def layers(lower=EDGE, upper=EDGE, apart=0.0):
    """Two layers of 3 and 2 mm, nodes so far apart."""
    return joined(
        slab_mesh(lower, height=3e-3), lifted(slab_mesh(upper, height=2e-3), 3e-3 + apart)
    )


def stripped():
    """Two layers that share every second node of the finer one: hanging nodes."""
    return merged(layers(EDGE, EDGE / 2))


def partly():
    """Two halves side by side: the lower rows are the same in both, the upper ones twice as many to
    the right.
    """
    left = slab_mesh(EDGE, left=-10e-3, right=0.0, high=0.0)
    right = slab_mesh(
        EDGE, left=0.0, right=10e-3, low=0.0, y=1e-3 * np.array([0, 1, 2, 2.5, 3, 3.5, 4, 4.5, 5])
    )
    mesh = joined(left, right)
    base = np.concatenate([left.curves["base"], right.curves["base"] + len(left.points)])
    skin = np.concatenate([left.curves["skin"], right.curves["skin"] + len(left.points)])
    return merged(replace(mesh, curves={"skin": skin, "base": base}))


def by_one_node():
    """A slab and a block on it that share a corner."""
    low = slab_mesh(EDGE)
    block = lifted(slab_mesh(EDGE, low=-1, left=10e-3, right=14e-3, height=2e-3), 5e-3)
    whole = joined(low, block)
    return merged(replace(whole, curves=low.curves))


def slit():
    """Layers that are joined at both ends and part in between by a twentieth of an edge."""
    mesh = layers()
    x, y = mesh.points.T
    upper = np.arange(len(x)) >= len(slab_mesh(EDGE, height=3e-3).points)
    apart = upper & (np.abs(y - 3e-3) < 1e-9) & (np.abs(x) < 4.5e-3)
    return merged(replace(mesh, points=mesh.points + 0.02e-3 * apart[:, None] * [0, 1]))


def crossing():
    """A body bent into itself: two arms on one base that overlap."""
    mesh = slab_mesh(EDGE, height=5e-3)
    middle = mesh.points[mesh.cells].mean(axis=1)
    kept = (np.abs(middle[:, 0]) > 1e-3) | (middle[:, 1] < 1e-3)
    x, y = mesh.points.T
    points = np.column_stack([np.where(y > 1e-3, x - np.sign(x) * 0.6 * (y - 1e-3), x), y])
    skin = mesh.curves["skin"]
    skin = skin[x[skin].mean(axis=1) < -1e-3]
    return cut_out(replace(mesh, points=points, curves=mesh.curves | {"skin": skin}), kept)


def cut_out(mesh, kept):
    """The chosen elements of a mesh."""
    return compact(replace(mesh, cells=mesh.cells[kept], region=mesh.region[kept]))


NOT_JOINED = {
    "layers without common nodes": (layers, "lie twice at the same place"),
    "layers of different edges": (lambda: layers(EDGE, EDGE * 0.8), "is in 2 pieces"),
    "layers of different edges that share some nodes": (stripped, "by 21 single nodes"),
    "layers that share nodes only in part": (partly, "lie on each other"),
    "layers a hair apart": (lambda: layers(apart=1e-7), "is in 2 pieces"),
    "layers far apart": (lambda: layers(apart=1e-3), "is in 2 pieces"),
    "layers that overlap": (lambda: layers(apart=-0.4e-3), "is in 2 pieces"),
    "one node in common": (by_one_node, "hangs on the rest by 1 single nodes"),
    "a slit": (slit, "lie on each other"),
    "a body that overlaps itself": (crossing, "lie on each other"),
}


@pytest.mark.parametrize("raised", [False, True])
@pytest.mark.parametrize("name", NOT_JOINED)
def test_parts_that_do_not_share_their_nodes_are_refused(tmp_path, name, raised):
    make, words = NOT_JOINED[name]
    mesh = make()
    said = refused(mesh.raised() if raised else mesh, tmp_path)
    assert words in said and " mm" in said and "layers" in said


def refused(mesh, folder):
    """What is said of a mesh, in one line."""
    with pytest.raises(MeshError) as caught:
        read_back(mesh, folder)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_layers_that_share_their_nodes_are_taken(tmp_path):
    assert read_back(merged(layers()), tmp_path).regions == ("lower", "upper")


def covered():
    """A slab with a slot: the skin is the slot's floor."""
    mesh = slab_mesh(EDGE, height=5e-3)
    x, y = mesh.points[mesh.cells].mean(axis=1).T
    kept = ~((np.abs(x) < 3e-3) & (y > 2e-3) & (y < 4e-3))
    number = np.arange(len(mesh.points)).reshape(21, 6)
    skin = np.column_stack([number[7:13, 2], number[8:14, 2]]).astype(np.int32)
    return cut_out(replace(mesh, curves=mesh.curves | {"skin": skin}), kept)


WRONG_SKIN = {
    "right of x = 0": (lambda: shifted(slab_mesh(EDGE), 12e-3), "shifted by -12 mm"),
    "left of x = 0": (lambda: shifted(slab_mesh(EDGE), -12e-3), "shifted by 12 mm"),
    "turned by 180 degrees": (lambda: turned(slab_mesh(EDGE), 180), "faces down"),
    "turned by 90 degrees": (lambda: turned(slab_mesh(EDGE), 90), "faces left"),
    "turned by -90 degrees": (lambda: turned(slab_mesh(EDGE), -90), "faces right"),
    "turned by 90 degrees, over x = 0": (
        lambda: shifted(turned(slab_mesh(EDGE), 90), 5e-3),
        "faces left",
    ),
    "below another part": (covered, "is covered at x = 0 by curve unnamed"),
}


@pytest.mark.parametrize("name", WRONG_SKIN)
def test_a_skin_that_the_indenter_does_not_meet_is_refused(tmp_path, name):
    make, words = WRONG_SKIN[name]
    said = refused(make(), tmp_path)
    assert words in said and "curve skin, from x = " in said and "allowed: " in said


@pytest.mark.parametrize("degrees", [0, 10, -20])
def test_a_tilted_skin_is_taken(tmp_path, degrees):
    read_back(turned(slab_mesh(EDGE), degrees), tmp_path)


def test_the_command_line_says_it_in_one_line(tmp_path, capsys):
    write_pad(layers(EDGE, EDGE * 0.8), tmp_path / "m.msh")
    document = SLAB(tmp_path / "m.msh")
    soft = {"youngs_modulus": "50 kPa"}
    document["specimen"]["layers"] = {"lower": soft, "upper": soft}
    (tmp_path / "scene.yaml").write_text(yaml.safe_dump(document))
    assert main(["run", str(tmp_path / "scene.yaml"), "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and "specimen.mesh" in said and "in 2 pieces" in said
    with pytest.raises(MeshError):
        fingerpad.simulate(document)
