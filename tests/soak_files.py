"""Files as strangers bring them, damaged at random, through the whole command line: ``make soak
FILES=1``.

Meshes lose parts, nodes move, names change, tables are cut, cells and bytes are replaced. Whatever
is left of a file, the exit code is 0, 2 or 3, an error is one line, and a result balances. The
first file that does otherwise is kept and named.
"""

from __future__ import annotations

import contextlib
import re
import shutil
import tempfile
import time
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import yaml

from cysyk1999.receptors.recordings import read_rates
from cysyk1999.reference_data import ReferenceDataError, read_force_depth
from cysyk1999.studies.common.plans import OutOfTime, time_limit
from fingerpad.specimen import write_pad
from own_meshes import SLAB, slab_mesh
from soak import command, judged, require, said

SLOWEST = 30.0
"""s of process time after which a run is let go."""
REFERENCE = Path(__file__).parents[1] / "config" / "reference"
READERS = {
    "force_depth/dandekar_2003.csv": read_force_depth,
    "impulse_rates/cysyk_1999.csv": read_rates,
}
"""Published files of measured data, and what reads files like them."""
WORDS = ("skin", "base", "foam", "", "Skin", "fat", "bone", "3", "a b", "\u00b5", '"', "0")
CELLS = (*'nan inf 1e999 -1 0 1e-300 abc 1,5 1.5.2 999999999999 -- " \u00b5m # 1;2'.split(), "")


def meshes(folder: Path) -> list[str]:
    """Good meshes of every kind of element, as text of both versions and as binary."""
    import gmsh

    base = slab_mesh(1e-3, left=-6e-3, right=6e-3, low=-6e-3, high=6e-3, height=3e-3)
    flat = replace(
        base,
        element="tri3",
        cells=np.concatenate([base.cells[:, [0, 1, 2]], base.cells[:, [0, 2, 3]]]),
    )
    flat = replace(flat, region=np.tile(base.region, 2))
    made = {"quad4": base, "quad9": base.raised(), "tri3": flat, "tri6": flat.raised()}
    for name, mesh in made.items():
        write_pad(mesh, folder / f"{name}.msh")
    for version, binary, name in ((2.2, 0, "old"), (4.1, 1, "binary"), (2.2, 1, "old_binary")):
        gmsh.initialize(["", "-v", "0"], readConfigFiles=False, interruptible=False)
        gmsh.open(str(folder / "quad4.msh"))
        gmsh.option.setNumber("Mesh.MshFileVersion", version)
        gmsh.option.setNumber("Mesh.Binary", binary)
        gmsh.write(str(folder / f"{name}.msh"))
        gmsh.finalize()
    return [f"{name}.msh" for name in (*made, "old", "binary", "old_binary")]


def tables(folder: Path) -> None:
    """Good tables."""
    x, time_s = np.linspace(-5, 5, 101), np.linspace(0, 1, 101)
    depth, samples = np.minimum(time_s, 0.3), [[50.0, 0.0], [100.0, 0.1]]
    for name, header, rows, delimiter in (
        ("profile.csv", "x (mm),y (mm)", zip(x, 0.1 * x**2, strict=True), ","),
        ("scan.csv", "# x (um);y (um);z (um)", zip(1e3 * x, 0 * x, 100 * x**2, strict=True), ";"),
        ("motion.csv", "time (s),depth (mm)", zip(time_s, depth, strict=True), ","),
        ("force.csv", "time (ms)\tforce (gf)", zip(1e3 * time_s, 10 * time_s, strict=True), "\t"),
        ("samples.csv", "stimulus.curvature (1/m),friction", samples, ","),
    ):
        how = {"delimiter": delimiter, "header": header, "comments": "", "fmt": "%.6g"}
        np.savetxt(folder / name, list(rows), **how)


def documents(folder: Path) -> list[tuple[str, object, dict]]:
    """The file to damage, the command (or what reads the file), and the document that names it."""
    plain = {
        "stimulus": {"shape": "cylinder", "curvature": "100 1/m"},
        "motion": [{"press_to_force": "5 gf"}],
        "accuracy": "draft",
    }
    tables(folder)
    wanted = [(name, "run", SLAB(name) | {"accuracy": "draft"}) for name in meshes(folder)]
    for name in ("profile.csv", "scan.csv"):
        wanted.append((name, "run", plain | {"stimulus": {"shape": "sampled", "csv": name}}))
    for name in ("motion.csv", "force.csv"):
        wanted.append((name, "run", plain | {"motion": {"table": name}}))
    wanted.append(("samples.csv", "plan", {"scene": plain, "over": {"table": "samples.csv"}}))
    wanted.append(("scene.yaml", "run", plain))
    for name, reader in READERS.items():  # files of measured data, read without the workflow
        shutil.copy(REFERENCE / name, folder / Path(name).name)
        wanted.append((Path(name).name, reader, plain))
    return wanted


# --- damage ---------------------------------------------------------------------------------------


def _lines(content, draw):
    """Some lines are dropped, there twice, or in another order."""
    lines = content.split(b"\n")
    at = int(draw.integers(len(lines)))
    some = lines[at : at + int(draw.integers(1, 2 + len(lines) // 4))]
    shuffled = [some[k] for k in draw.permutation(len(some))]
    new = ([], some * 2, shuffled)[draw.integers(3)]
    return b"\n".join(lines[:at] + new + lines[at + len(some) :])


def _bytes(content, draw):
    """The file is cut, or some bytes are others."""
    at = int(draw.integers(len(content) + 1))
    if draw.integers(3) == 0:
        return content[:at]
    junk = draw.integers(0, 256, int(draw.integers(1, 9))).astype(np.uint8).tobytes()
    return content[:at] + junk + content[at + int(draw.integers(2)) :]


def _replaced(content, draw, pattern, new):
    """One of what a pattern finds is another, made by ``new`` of what it was."""
    found = list(re.finditer(pattern, content))
    if not found:
        return content
    chosen = found[int(draw.integers(len(found)))]
    return content[: chosen.start()] + new(chosen[0]).encode() + content[chosen.end() :]


def _number(content, draw):
    """A number is another one, or none."""

    def new(number):
        scaled = float(number) * draw.choice([-1, 0, 0.999, 1.01, 1e3, 1e-3]) + draw.normal()
        return (draw.choice(CELLS), str(draw.integers(-3, 2000)), f"{scaled:.6g}")[draw.integers(3)]

    return _replaced(content, draw, rb"-?\d+\.?\d*(?:e-?\d+)?", new)


def _word(content, draw):
    """A word is another one."""
    return _replaced(content, draw, rb"[A-Za-z_]+", lambda word: draw.choice(WORDS))


def _recoded(content, draw):
    """The encoding, the delimiters or the ends of lines are others."""
    if draw.integers(3) == 0:
        encoding = draw.choice(["utf-16", "utf-8-sig", "utf-32", "cp1252"])
        return content.decode("latin1").encode(encoding, "replace")
    signs = [(b",", b"; \t|"), (b".", b","), (b"\n", b"\r\0\n")]
    old, new = signs[draw.integers(3)]
    return content.replace(old, bytes([draw.choice(list(new))]))


def damaged(content: bytes, draw: np.random.Generator) -> bytes:
    """A file with one thing wrong."""
    kinds = (_lines, _bytes, _number, _word, _recoded)
    return draw.choice(kinds, p=[0.25, 0.2, 0.25, 0.1, 0.2])(content, draw)


def moved(content: bytes, draw: np.random.Generator) -> bytes:
    """A mesh file of text with some of its nodes elsewhere."""
    start, end = content.find(b"$Nodes"), content.find(b"$EndNodes")
    lines = content[start:end].split(b"\n")
    share, far = draw.choice([0.02, 0.3, 1.0]), draw.choice([1e-7, 1e-3, 0.1, 1.0, 20.0])
    for k, line in enumerate(lines):
        parts = line.split()
        coordinates = parts[-3:] if len(parts) in (3, 4) and any(b"." in p for p in parts) else None
        if coordinates and draw.random() < share:
            with contextlib.suppress(ValueError):  # damaged before
                x, y = (f"{float(p) + draw.normal() * far:.6g}".encode() for p in coordinates[:2])
                lines[k] = b" ".join([*parts[:-3], x, y, coordinates[2]])
    return content[:start] + b"\n".join(lines) + content[end:]


# --- many of them ---------------------------------------------------------------------------------


def soak_files(count: int, start: int, seconds: float) -> tuple[Counter, str]:
    """Outcomes of up to `count` damaged files within some process time (s); a failure, or ""."""
    outcomes, begun = Counter(), time.process_time()
    with tempfile.TemporaryDirectory(prefix="soak-files-") as name:
        good, folder = Path(name) / "good", Path(name) / "try"
        good.mkdir()
        wanted = documents(good)
        for number in range(count):
            if time.process_time() - begun > seconds:
                break
            draw = np.random.default_rng((start, number))
            file, verb, document = wanted[int(draw.integers(len(wanted)))]
            shutil.rmtree(folder, ignore_errors=True)
            shutil.copytree(good, folder)
            (folder / "scene.yaml").write_text(yaml.safe_dump(document))
            content = (folder / file).read_bytes()
            for _ in range(int(draw.integers(1, 4))):
                mesh = file.endswith(".msh") and draw.random() < 0.4
                content = (moved if mesh else damaged)(content, draw)
            (folder / file).write_bytes(content)
            try:
                outcomes[f"{file}: {_outcome(verb, folder, file)}"] += 1
            except Exception as error:  # noqa: BLE001 - whatever it is, it is shown
                kept = Path(tempfile.mkdtemp(prefix="soak-failed-"))
                shutil.copytree(folder, kept, dirs_exist_ok=True)
                why = f"{file} in {kept}: {type(error).__name__}: {error}"
                return outcomes, f"number {number} of seed {start}, {why}"
    return outcomes, ""


def _outcome(verb, folder: Path, file: str) -> str:
    """What becomes of a damaged file: completed, refused, stopped, or not done in time."""
    if callable(verb):
        try:
            verb(folder / file)
        except ReferenceDataError as error:
            require("\n" not in str(error), f"more than one line: {error}")
            return "refused"
        return "completed"
    out = folder / "out"
    more = () if verb == "plan" else ("--out", out, "--quiet", "--force")
    words = (verb, folder / "scene.yaml", *more)
    try:
        with time_limit(SLOWEST):
            code, _, err = command(*words)
    except OutOfTime:
        return f"not done in {SLOWEST:g} s"
    said(words, code, err)
    if code == 0 and verb == "run":
        judged(out)
    return ("completed", "", "refused", "stopped")[code]
