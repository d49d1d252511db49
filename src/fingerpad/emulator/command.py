"""The commands ``fingerpad emulate`` and ``fingerpad explore``."""

from __future__ import annotations

from pathlib import Path

from rich.console import Console
from rich.table import Table

from fingerpad.emulator.explorer import page
from fingerpad.emulator.fitting import emulate
from fingerpad.emulator.model import Emulator, load_emulator
from fingerpad.files import write_text


def emulate_folder(folder: Path, out: Path, unseen: Path | None, quiet: bool) -> None:
    """Fit an emulator, write it, and show how far off it is. Raises SceneError."""
    emulator = emulate(folder, unseen)
    emulator.save(out)
    if not quiet:
        _show(emulator, out)


def _show(emulator: Emulator, out: Path) -> None:
    console = Console(highlight=False)
    held_out = emulator.about["held_out"]
    title = f"{held_out[0]['scenes']} scenes that the fit did not see"
    table = Table(title=title, title_justify="left")
    for head in ("quantity", "median error", "95 % within", "within the band"):
        table.add_column(head, justify="left" if head == "quantity" else "right")
    for row in held_out:
        shares = (f"{100 * row[k]:.3g} %" for k in ("median", "within_95", "covered"))
        table.add_row(row["quantity"].replace("_", " "), *shares)
    console.print(table)
    left_out = emulator.about["scenes_left_out"]
    lost = f", {left_out} with gaps were left out" if left_out else ""
    console.print(f"{emulator.about['scenes']} scenes{lost}; the emulator is in {out}", crop=False)


def explore(file: Path, out: Path) -> None:
    """Write the page of an emulator. Raises SceneError."""
    write_text(out, page(load_emulator(file)))
    print(f"the page is {out}; it needs no server and no network")
