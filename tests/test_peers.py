"""The same press by public packages and by this one."""

import pytest

from cysyk1999.studies.peers.run import PEERS, enough, own, peer, scenes

pytestmark = [pytest.mark.verification, pytest.mark.slow]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("press")


@pytest.mark.parametrize("name", PEERS)
def test_peers_find_the_same_force(name, folder):
    """On the same mesh, each with contact of its own, to the softness of the peer's."""
    pytest.importorskip(name, reason="an optional dependency: pip install -e .[peers]")
    same, _ = scenes("plate", folder, "600 um")
    found = peer(name, folder, enough(name, folder))
    assert found["force"] == pytest.approx(own(same)["force"], rel=2e-3)
