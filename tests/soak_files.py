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

SLOWEST = 30.0
"""s of process time after which a run is let go."""
REFERENCE = Path(__file__).parents[1] / "config" / "reference"
READERS = {
    "force_depth/dandekar_2003.csv": read_force_depth,
    "impulse_rates/cysyk_1999.csv": read_rates,
}
"""Published files of measured data, and what reads files like them."""
WORDS = ("skin", "base", "foam", "", "Skin", "fat", "bone", "3", "a b", "\u00b5", '"', "0")
CELLS = (
    "",
    "nan",
    "inf",
    "1e999",
    "-1",
    "0",
    "1e-300",
    "abc",
    "1,5",
    "1.5.2",
    "999999999999",
    "--",
    '"',
    "\u00b5m",
    "#",
    "1;2",
)


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


def tables(folder: Path) -> dict[str, str]:
    """Good tables by what they are for."""
    x = np.linspace(-5, 5, 101)
    time_s = np.linspace(0, 1, 101)
    made = {
        "profile.csv": ("x (mm),y (mm)", np.column_stack([x, 0.1 * x**2]), ","),
        "scan.csv": ("# x (um);y (um);z (um)", np.column_stack([1e3 * x, 0 * x, 100 * x**2]), ";"),
        "motion.csv": (
            "time (s),depth (mm)",
            np.column_stack([time_s, np.minimum(time_s, 0.3)]),
            ",",
        ),
        "force.csv": ("time (ms)\tforce (gf)", np.column_stack([1e3 * time_s, 10 * time_s]), "\t"),
        "samples.csv": (
            "stimulus.curvature (1/m),friction",
            np.column_stack([[50.0, 100.0], [0.0, 0.1]]),
            ",",
        ),
    }
    for name, (header, rows, delimiter) in made.items():
        np.savetxt(folder / name, rows, delimiter=delimiter, header=header, comments="", fmt="%.6g")
    return {
        "profile": "profile.csv",
        "scan": "scan.csv",
        "motion": "motion.csv",
        "force": "force.csv",
        "samples": "samples.csv",
    }


def documents(folder: Path) -> list[tuple[str, str, dict]]:
    """The file to damage, the command and the document that names it."""
    plain = {
        "stimulus": {"shape": "cylinder", "curvature": "100 1/m"},
        "motion": [{"press_to_force": "5 gf"}],
        "accuracy": "draft",
    }
    found = [(name, "run", SLAB(name) | {"accuracy": "draft"}) for name in meshes(folder)]
    names = tables(folder)
    for what in ("profile", "scan"):
        found.append(
            (names[what], "run", plain | {"stimulus": {"shape": "sampled", "csv": names[what]}})
        )
    for what in ("motion", "force"):
        found.append((names[what], "run", plain | {"motion": {"table": names[what]}}))
    found.append((names["samples"], "plan", {"scene": plain, "over": {"table": names["samples"]}}))
    found.append(("scene.yaml", "run", plain))
    for (
        name,
        reader,
    ) in READERS.items():  # what the workflow reads of measured data, without the workflow
        shutil.copy(REFERENCE / name, folder / Path(name).name)
        found.append((Path(name).name, reader, {}))
    return found


# -- damage ------------------------------------------------------------------------------------------------------------------


def damaged(content: bytes, draw: np.random.Generator) -> bytes:
    """A file with one thing wrong."""
    lines = content.split(b"\n")
    kind = draw.integers(13)
    at = int(draw.integers(max(len(lines), 1)))
    more = int(draw.integers(1, 1 + max(len(lines) // 4, 1)))
    if kind == 0:
        return b"\n".join(lines[:at] + lines[at + more :])  # a part is dropped
    if kind == 1:
        return b"\n".join(
            lines[:at] + lines[at : at + more] * 2 + lines[at + more :]
        )  # or there twice
    if kind == 2:
        order = lines[at : at + more]
        draw.shuffle(order)
        return b"\n".join(lines[:at] + order + lines[at + more :])
    if kind == 3:
        return content[: int(draw.integers(len(content) + 1))]  # cut
    if kind == 4:
        where = int(draw.integers(len(content) + 1))
        return (
            content[:where]
            + bytes(draw.integers(0, 256, int(draw.integers(1, 9))).astype(np.uint8))
            + content[where:]
        )
    if kind == 5 and content:
        where = int(draw.integers(len(content)))
        return content[:where] + bytes([int(draw.integers(256))]) + content[where + 1 :]
    if kind in (6, 7, 8):  # a number becomes another one
        numbers = list(re.finditer(rb"-?\d+\.?\d*(?:e-?\d+)?", content))
        if numbers:
            chosen = numbers[int(draw.integers(len(numbers)))]
            new = (
                draw.choice(CELLS).encode()
                if kind == 6
                else str(int(draw.integers(-3, 2000))).encode()
                if kind == 7
                else f"{float(chosen[0] or 0) * draw.choice([-1, 0, 0.999, 1.01, 1e3, 1e-3]) + draw.normal():.6g}".encode()
            )
            return content[: chosen.start()] + new + content[chosen.end() :]
    if kind == 9:
        words = list(re.finditer(rb"[A-Za-z_]+", content))
        if words:
            chosen = words[int(draw.integers(len(words)))]
            return content[: chosen.start()] + draw.choice(WORDS).encode() + content[chosen.end() :]
    if kind == 10:
        encoding = draw.choice(["utf-16", "utf-8-sig", "utf-32", "cp1252"])
        return content.decode("latin1").encode(encoding, "replace")
    if kind == 11:
        return (
            content.replace(b",", draw.choice([b";", b"\t", b" ", b"|", b""]))
            if draw.integers(2)
            else content.replace(b".", b",")
        )
    if kind == 12:
        return content.replace(b"\n", draw.choice([b"\r\n", b"\r", b"\n\n", b"\0", b""]))
    return content


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
                new = [
                    f"{float(p) + draw.normal() * far:.6g}".encode() for p in coordinates[:2]
                ] + [coordinates[2]]
                lines[k] = b" ".join([*parts[:-3], *new])
    return content[:start] + b"\n".join(lines) + content[end:]


# -- many of them ------------------------------------------------------------------------------------------------------------


def soak_files(count: int, start: int, seconds: float) -> tuple[Counter, str]:
    """Outcomes of up to `count` damaged files within a time (s), and of the first failure its
    folder and why ("": none).
    """
    from soak import Failed, command, judged, said

    outcomes, begun = Counter(), time.perf_counter()
    with tempfile.TemporaryDirectory(prefix="soak-files-") as name:
        good = Path(name) / "good"
        good.mkdir()
        wanted = documents(good)
        (good / "scene.yaml").write_text(yaml.safe_dump(wanted[-1][2]))
        for number in range(count):
            if time.perf_counter() - begun > seconds:
                break
            draw = np.random.default_rng((start, number))
            file, verb, document = wanted[int(draw.integers(len(wanted)))]
            folder = Path(name) / "try"
            shutil.rmtree(folder, ignore_errors=True)
            shutil.copytree(good, folder)
            content = (folder / file).read_bytes()
            for _ in range(int(draw.integers(1, 4))):
                content = (
                    moved(content, draw)
                    if file.endswith(".msh") and draw.random() < 0.4
                    else damaged(content, draw)
                )
            (folder / file).write_bytes(content)
            path = folder / "scene.yaml"
            if file != "scene.yaml":
                path.write_text(yaml.safe_dump(document))
            if callable(verb):
                try:
                    verb(folder / file)
                    outcomes[f"{file}: completed"] += 1
                except ReferenceDataError as error:
                    if "\n" in str(error):
                        return outcomes, f"number {number} of seed {start}, {file}: {error}"
                    outcomes[f"{file}: refused"] += 1
                continue
            out = folder / "out"
            words = (
                (verb, path) if verb == "plan" else (verb, path, "--out", out, "--quiet", "--force")
            )
            try:
                with time_limit(SLOWEST):
                    code, _, err = command(*words)
                said(words, code, err)
                if code == 0 and verb == "run":
                    judged(out)
                outcomes[f"{file}: {('completed', '', 'refused', 'stopped')[code]}"] += 1
            except OutOfTime:
                outcomes[f"{file}: not done in {SLOWEST:g} s"] += 1
            except (Failed, Exception) as error:  # noqa: BLE001 - whatever it is, it is shown
                kept = Path(tempfile.mkdtemp(prefix="soak-failed-"))
                shutil.copytree(folder, kept, dirs_exist_ok=True)
                return (
                    outcomes,
                    f"number {number} of seed {start}, {file} in {kept}: {type(error).__name__}: {error}",
                )
    return outcomes, ""
