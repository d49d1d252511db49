"""Input that means harm, or is merely far too much: one line, exit code 2, little memory, nothing
run and nothing written.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from faults import files
from fingerpad.cli import main
from wrong_scenes import changed, specimen, write

pytestmark = pytest.mark.unit

MOST_MB = 1000
"""Of memory, that any refusal may take."""


def bomb(levels=9, width=10, plain=True):
    """YAML that is small, and very large when its aliases are written out; by lists, or by merged
    mappings.
    """
    lines = ["a0: &a0 [x]" if plain else "a0: &a0 {x: 1}"]
    for n in range(1, levels):
        aliases = ", ".join([f"*a{n - 1}"] * width)
        lines.append(f"a{n}: &a{n} [{aliases}]" if plain else f"a{n}: &a{n} {{<<: [{aliases}]}}")
    return "\n".join([*lines, f"stimulus: *a{levels - 1}", ""])


def many(path, head, line, size=130_000_000):
    """A file of one line over and over."""
    with path.open("wb") as file:
        file.write(head)
        for _ in range(size // (len(line) * 100_000)):
            file.write(line * 100_000)


def mesh_head(nodes, elements):
    counts = f"$Nodes\n1 {nodes} 1 {nodes}\n$EndNodes\n$Elements\n1 {elements} 1 {elements}\n"
    return f"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n{counts}"


def scene_of_much(folder):
    many(folder / "my_scene.yaml", b"stimulus: {shape: flat}\n", b"# x\n")


def profile_of_much(folder):
    many(folder / "p.csv", b"x (mm),y (mm)\n", b"1.0001,0.01\n")
    write(folder, changed(stimulus={"shape": "sampled", "csv": "p.csv"}))


def mesh_of_much(elements, size):
    def make(folder):
        many(folder / "m.msh", mesh_head(elements // 2, elements).encode(), b"1 2 3 4\n", size)
        write(folder, specimen(mesh="m.msh"))

    return make


# name: what is written into the folder, words of the line
HUGE = {
    "aliases of lists": (lambda folder: write(folder, bomb()), "aliases"),
    "aliases of mappings": (lambda folder: write(folder, bomb(plain=False)), "aliases"),
    "a scene of 100 MB": (scene_of_much, "more than 1.05 MB"),
    "ten million points": (profile_of_much, "more than 33.6 MB"),
    "a million elements": (mesh_of_much(1_000_000, 130_000_000), "1000000 elements"),
    "a mesh of 300 MB": (mesh_of_much(10, 300_000_000), "more than 268 MB"),
}


MEASURED = """
import resource, subprocess, sys
code = subprocess.run(sys.argv[1:]).returncode
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print(used.ru_maxrss, used.ru_utime)
sys.exit(code)
"""


@pytest.mark.parametrize("name", HUGE)
def test_what_is_huge_is_refused_in_little_memory(tmp_path, name):
    make, said = HUGE[name]
    make(tmp_path)
    before = sorted(path.name for path in tmp_path.iterdir())
    # measured by a small process between: a child's peak begins with the memory of whoever started
    # it
    plan = [sys.executable, "-m", "fingerpad", "plan", "my_scene.yaml"]
    words = [sys.executable, "-c", MEASURED, *plan]
    process = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True)
    assert process.returncode == 2 and process.stderr.count("\n") == 1 and said in process.stderr, (
        process.stderr
    )
    peak_kb, seconds = (float(word) for word in process.stdout.split()[-2:])
    assert peak_kb / 1024 < MOST_MB and seconds < 30
    assert sorted(path.name for path in tmp_path.iterdir()) == before


# --- what is small, but no file to read, or leads out of the folder -------------------------------


def pipe_scene(folder):
    os.mkfifo(folder / "my_scene.yaml")


def pipe_profile(folder):
    os.mkfifo(folder / "p.csv")


def pipe_mesh(folder):
    os.mkfifo(folder / "m.msh")


def link_to_device(folder):
    (folder / "p.csv").symlink_to("/dev/zero")


def link_in_circle(folder):
    (folder / "p.csv").symlink_to("p.csv")


def infinite(folder):
    (folder / "p.csv").write_text("x (mm),y (mm)\n0,0\n1,inf\n")


def endless(folder):
    (folder / "p.csv").write_text("x (mm)" * 200_000)


def script(folder):
    """A script that gmsh runs when it opens the mesh beside it."""
    calls = f'SystemCall "touch {folder}/run";\n'
    (folder / "m.msh").write_text("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n")
    (folder / "m.msh.opt").write_text(calls)
    (folder / "m.geo").write_text(f"$MeshFormat\n{calls}")


def circle(folder):
    (folder / "a").mkdir()
    write(folder, {"extends": "a/../a/../my_scene.yaml"})


def long_chain(folder):
    for n in range(200):
        write(folder, {"extends": f"s{n + 1}.yaml"}, f"s{n}.yaml")
    write(folder, changed(), "s200.yaml")
    write(folder, {"extends": "s0.yaml"})


def endless_unit(folder):
    write(folder, changed(friction="1 " + "m" * 300_000))


def family_of_a_million(folder):
    write(folder, {"over": {k: {str(n): {} for n in range(100)} for k in "abc"}})


HARM = yaml.safe_load(Path(__file__).with_name("attacks.yaml").read_text(encoding="utf-8"))


def written(attack):
    """The document of an attack; None where a function makes it."""
    if "changed" in attack:
        return changed(**attack["changed"])
    if "over" in attack:
        return {"scene": changed(accuracy="draft"), "over": attack["over"]}
    if "times" in attack:
        return attack["text"] + attack["then"] * attack["times"]
    return attack.get("text", attack.get("document"))


@pytest.mark.parametrize("name", HARM)
def test_harm_is_refused_in_one_line_and_does_nothing(tmp_path, capsys, monkeypatch, name):
    attack, folder = HARM[name], tmp_path / "inside"
    folder.mkdir()
    monkeypatch.chdir(folder)
    monkeypatch.setattr("fingerpad.files.PATIENCE", 0.1)
    if "made" in attack:
        globals()[attack["made"]](folder)
    document = written(attack)
    if document is not None:
        write(folder, document)
    path = Path(attack.get("from", folder / "my_scene.yaml"))
    command = "sweep" if isinstance(document, dict) and "scene" in document else "run"
    words = [command, path, "--out", folder / "out"]
    before = sorted(str(each) for each in tmp_path.rglob("*"))
    assert main([str(word) for word in words]) == 2
    out, err = capsys.readouterr()
    assert out == "" and err.count("\n") == 1 and attack["said"] in err, err
    assert len(err) < 1000 + len(str(path)), err
    assert sorted(str(each) for each in tmp_path.rglob("*")) == before


@pytest.mark.parametrize("number", ["nan", "inf", "-1e400"])
def test_numbers_that_are_none_in_a_mesh(tmp_path, capsys, number):
    scene = write(tmp_path, changed(accuracy={"skin_edge": "0.8 mm", "steps": 2}))
    assert main(["mesh", str(scene), "--out", str(tmp_path / "m.msh")]) == 0
    head, nodes, rest = (tmp_path / "m.msh").read_text().partition("$Nodes")
    lines = rest.split("\n")
    place = next(n for n, line in enumerate(lines) if "." in line)
    lines[place] = " ".join([number, *lines[place].split()[1:]])
    (tmp_path / "m.msh").write_text(head + nodes + "\n".join(lines))
    capsys.readouterr()
    assert main(["plan", str(write(tmp_path, specimen(mesh="m.msh")))]) == 2
    err = capsys.readouterr().err
    assert err.count("\n") == 1 and "specimen.mesh" in err


def test_names_of_scenes_stay_names(tmp_path, capsys, monkeypatch):
    """Results without --out go below the working directory, whatever the scene's file is called."""
    monkeypatch.chdir(tmp_path)
    inner = tmp_path / "a" / "b"
    inner.mkdir(parents=True)
    names = "..yaml", "x\ny.yaml", " .yaml", "-.yaml"
    for name in names:
        write(inner, changed(stimulus={"shape": "sampled", "csv": "none.csv"}), name)
        assert main(["run", str(inner / name)]) == 2
        assert capsys.readouterr().err.count("\n") == 1
    assert set(files(tmp_path)) == {f"a/b/{name}" for name in names}
