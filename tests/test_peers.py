"""The same press by public packages and by this one."""

import pytest

from cysyk1999.studies.peers.run import PEERS, enough, own, peer, scenes

pytestmark = [pytest.mark.verification, pytest.mark.slow]


EDGES = {"plate": "600 um", "sphere 200 1/m": "300 um"}
"""Of the skin, with which their forces do not hang on what is a node in contact."""


@pytest.mark.parametrize("press", EDGES)
@pytest.mark.parametrize("name", PEERS)
def test_peers_find_the_same_force(name, press, tmp_path):
    """On the same mesh, each with contact of its own, to the softness of the peer's."""
    pytest.importorskip(name, reason="an optional dependency: pip install -e .[peers]")
    same, _ = scenes(press, tmp_path, EDGES[press])
    found = peer(name, tmp_path, enough(name, tmp_path))
    assert found["force"] == pytest.approx(own(same)["force"], rel=2e-3)
