"""What a job rests on is found from its imports, and what a result was made with from the code's
content.
"""

import pytest

from cysyk1999.sources import imported_sources
from fingerpad.provenance import code_digest

pytestmark = pytest.mark.unit


def names(*modules: str) -> set[str]:
    return {"/".join(path.parts[-2:]) for path in imported_sources(*modules)}


def test_figures_rest_on_laws_of_receptors_and_not_on_mechanics():
    found = names("cysyk1999.figures.registry")
    assert {"figures/registry.py", "receptors/laws.py", "fingerpad/__init__.py"} <= found
    assert not {
        name for name in found if name.startswith("mechanics/") or name == "planning/plan.py"
    }


def test_data_of_a_module_s_name_count_as_the_module():
    assert "planning/rules.yaml" in names("fingerpad.planning.rules")


def test_a_verb_of_the_package_brings_what_it_runs():
    assert {"mechanics/stepping.py", "fingerpad/simulation.py"} <= names(
        "cysyk1999.workflow.simulate"
    )


def test_a_register_brings_the_files_that_it_does_not_name():
    found = names("cysyk1999.workflow.simulate")
    assert {"laws/yeoh.py", "effects/friction.py", "effects/ridges.py"} <= found


def test_the_digest_follows_names_and_contents(tmp_path):
    (tmp_path / "a.py").write_text("1")
    seen = {code_digest(tmp_path)}
    files = {"b.py": "2", "notes.txt": "4", "notes.yaml": "5", "a.py": "1"}
    for name, text in [*files.items(), ("b.py", "3"), ("b.yaml", "6")]:
        (tmp_path / name).write_text(text)
        code_digest.cache_clear()
        seen.add(code_digest(tmp_path))
    assert len(seen) == 4
