"""The commands ``fingerpad emulate`` and ``fingerpad explore``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from fingerpad.documents import SceneError
from fingerpad.emulator.explorer import page
from fingerpad.emulator.fitting import emulate
from fingerpad.emulator.growing import grow
from fingerpad.emulator.model import Emulator, load_emulator
from fingerpad.files import write_text


def emulate_folder(options: Any) -> None:
    """Fit an emulator, write it, and show how far off it is. Raises SceneError."""
    budget = {n: v for n in ("scenes", "seconds") if (v := getattr(options, n)) is not None}
    if options.grow is None:
        for name in budget:
            raise SceneError(f"--{name}: says when growing ends; allowed: with --grow")
        emulator = emulate(options.folder, options.unseen)
    else:
        budget["cores"] = options.cores
        progress = None if options.quiet else _tell
        emulator = grow(
            options.folder, options.grow, unseen=options.unseen, progress=progress, **budget
        )
    emulator.save(options.out)
    if not options.quiet:
        _show(emulator, options.out)


def _tell(added: int, error: float) -> None:
    print(f"{added} scenes added: 95 % of the sweep's scenes are within {100 * error:.3g} %")


def _show(emulator: Emulator, out: Path) -> None:
    console = Console(highlight=False)
    held_out = emulator.about["held_out"]
    count = held_out[0]["scenes"]
    title = f"{count} scene{'s' * (count != 1)} that the fit did not see"
    table = Table(title=title, title_justify="left")
    for head in ("quantity", "median error", "95 % within", "within the band"):
        table.add_column(head, justify="left" if head == "quantity" else "right")
    for row in held_out:
        shares = (f"{100 * row[k]:.3g} %" for k in ("median", "within_95", "covered"))
        table.add_row(row["quantity"].replace("_", " "), *shares)
    console.print(table)
    left_out = emulator.about["scenes_left_out"]
    lost = f", {left_out} with gaps were left out" if left_out else ""
    if grown := emulator.about.get("grown"):
        asked = f"{100 * grown['tolerance']:.3g} %"
        end = f"{asked} is reached" if grown["met"] else f"the budget is spent before {asked}"
        console.print(f"{grown['added']} scenes added: {end}")
    console.print(f"{emulator.about['scenes']} scenes{lost}; the emulator is in {out}", crop=False)


def explore(file: Path, out: Path) -> None:
    """Write the page of an emulator. Raises SceneError."""
    write_text(out, page(load_emulator(file)))
    print(f"the page is {out}; it needs no server and no network")
