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


def sampled(csv):
    return changed(stimulus={"shape": "sampled", "csv": csv})


def sweep(**over):
    return {"scene": changed(accuracy="draft"), "over": over}


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
    write(folder, sampled("p.csv"))


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
    process = subprocess.run(
        [
            sys.executable,
            "-c",
            MEASURED,
            sys.executable,
            "-m",
            "fingerpad",
            "plan",
            "my_scene.yaml",
        ],
        cwd=tmp_path,
        capture_output=True,
        text=True,
    )
    assert process.returncode == 2 and process.stderr.count("\n") == 1 and said in process.stderr, (
        process.stderr
    )
    peak_kb, seconds = (float(word) for word in process.stdout.split()[-2:])
    assert peak_kb / 1024 < MOST_MB and seconds < 30
    assert sorted(path.name for path in tmp_path.iterdir()) == before


# --- what is small, but no file to read, or leads out of the folder -------------------------------


def fifo(name):
    return lambda folder: os.mkfifo(folder / name)


def opt(folder):
    """A script that gmsh runs when it opens the mesh beside it."""
    script = f'SystemCall "touch {folder}/run";\n'
    (folder / "m.msh").write_text("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n")
    (folder / "m.msh.opt").write_text(script)
    (folder / "m.geo").write_text(f"$MeshFormat\n{script}")


def circle(folder):
    (folder / "a").mkdir()
    write(folder, {"extends": "a/../a/../my_scene.yaml"})


def long_chain(folder):
    for n in range(200):
        write(folder, {"extends": f"s{n + 1}.yaml"}, f"s{n}.yaml")
    write(folder, changed(), "s200.yaml")
    write(folder, {"extends": "s0.yaml"})


def infinite(folder):
    (folder / "p.csv").write_text("x (mm),y (mm)\n0,0\n1,inf\n")


def sweep_of_files(pattern, folder="."):
    return sweep(**{"stimulus.csv": {"folder": folder, "pattern": pattern}})


LONG = {"range": [0.1, 0.9], "count": 100_000}
PATTERN = "pattern of a file's name"

# name: document, what else is written into the folder, words of the line
HARM = {
    "a scene from a device": ("/dev/zero", None, "a device"),
    "a scene from a pipe": ("my_scene.yaml", fifo("my_scene.yaml"), "nobody writes"),
    "a profile from a device": (sampled("/dev/zero"), None, "a device"),
    "a profile from a pipe": (sampled("p.csv"), fifo("p.csv"), "nobody writes"),
    "a profile that is a folder": (sampled("."), None, "directory"),
    "a profile of no path": (sampled("\0"), None, "stimulus.csv"),
    "a profile called on two lines": (sampled("a\nb.csv"), None, "not an existing file"),
    "a link to a device": (
        sampled("p.csv"),
        lambda f: (f / "p.csv").symlink_to("/dev/zero"),
        "a device",
    ),
    "a link in a circle": (
        sampled("p.csv"),
        lambda f: (f / "p.csv").symlink_to("p.csv"),
        "cannot be read",
    ),
    "infinity in a profile": (sampled("p.csv"), infinite, "no finite number"),
    "one endless line in a profile": (
        sampled("p.csv"),
        lambda f: (f / "p.csv").write_text("x (mm)" * 200_000),
        "stimulus.csv",
    ),
    "a mesh from a device": (specimen(mesh="/dev/zero"), None, "specimen.mesh"),
    "a mesh from a pipe": (specimen(mesh="m.msh"), fifo("m.msh"), "specimen.mesh"),
    "a mesh with a script beside it": (specimen(mesh="m.msh"), opt, "specimen.mesh"),
    "a script as a mesh": (specimen(mesh="m.geo"), opt, "specimen.mesh"),
    "a mesh of no path": (specimen(mesh="\0"), None, "specimen.mesh"),
    "layers from elsewhere": (specimen(layers="../../layers"), None, "not the name of a specimen"),
    "an outline from a device": (specimen(outline="/dev/zero"), None, "not the name of a specimen"),
    "a scene that extends itself by another path": (None, circle, "extends itself"),
    "a scene that extends two hundred": (None, long_chain, "one file too many"),
    "a scene that extends a device": ({"extends": "/dev/zero"}, None, "not an existing file"),
    "an alias of itself": ("a: &a [*a]\n", None, "aliases"),
    "a thousand brackets": ("[" * 1000, None, "nested too deeply"),
    "a number of very many digits": ("friction: 1" + "0" * 300_000, None, "digits"),
    "a unit of very many letters": (changed(friction="1 " + "m" * 300_000), None, "friction"),
    "a power tower": (
        changed(stimulus={"shape": "cylinder", "curvature": "1 m^9^9^9"}),
        None,
        "stimulus.curvature",
    ),
    "code": ("!!python/object/apply:os.system ['touch run']", None, "not valid YAML"),
    "a family out of the folder": (
        {"over": {"../../x": {"../y": {}}}},
        None,
        "cannot be part of the name of a file",
    ),
    "a family of a million": (
        {"over": {k: {str(n): {} for n in range(100)} for k in "abc"}},
        None,
        "makes 1000000 scenes",
    ),
    "a sweep of a million million": (
        sweep(**{"friction": LONG, "motion[1].hold": LONG}),
        None,
        "makes 10000000000 scenes",
    ),
    "a sweep over the whole disk": (sweep_of_files("**/*", "/"), None, PATTERN),
    "a sweep out of its folder": (sweep_of_files("../*"), None, PATTERN),
    "a sweep over all that is absolute": (sweep_of_files("/*"), None, PATTERN),
    "a sweep over nothing": (sweep_of_files(""), None, PATTERN),
    "a sweep of a name out of its folder": (
        sweep(friction={"values": [0.1], "name": "../x"}),
        None,
        "not one word",
    ),
    "a sweep of a device": ({"scene": "/dev/zero", "over": {"friction": [0.1]}}, None, "a device"),
}


@pytest.mark.parametrize("name", HARM)
def test_harm_is_refused_in_one_line_and_does_nothing(tmp_path, capsys, monkeypatch, name):
    document, make, said = HARM[name]
    folder = tmp_path / "inside"
    folder.mkdir()
    monkeypatch.chdir(folder)
    monkeypatch.setattr("fingerpad.files.PATIENCE", 0.1)
    if make:
        make(folder)
    path = folder / "my_scene.yaml"
    if isinstance(document, str) and document.startswith("/dev"):
        path = Path(document)
    elif document is not None and not path.exists():
        write(folder, document)
    command = "sweep" if isinstance(document, dict) and "scene" in document else "run"
    words = [command, path, "--out", folder / "out"]
    before = sorted(str(each) for each in tmp_path.rglob("*"))
    assert main([str(word) for word in words]) == 2
    out, err = capsys.readouterr()
    assert (
        out == "" and err.count("\n") == 1 and said in err and len(err) < 1000 + len(str(path))
    ), err
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
    for name in ("..yaml", "x\ny.yaml", " .yaml", "-.yaml"):
        write(
            inner, yaml.safe_dump(changed(stimulus={"shape": "sampled", "csv": "none.csv"})), name
        )
        assert main(["run", str(inner / name)]) == 2
        assert capsys.readouterr().err.count("\n") == 1
    assert set(files(tmp_path)) == {
        f"a/b/{name}" for name in ("..yaml", "x\ny.yaml", " .yaml", "-.yaml")
    }
