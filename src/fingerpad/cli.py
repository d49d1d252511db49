"""The command ``fingerpad``: plan, run or mesh a scene; plan, run or emulate a sweep.

Exit codes: 0 done; 1 an error of the program (one line; the details are in a file); 2 the input is
wrong (one line on standard error: file, key, what is wrong, what is allowed); 3 the simulation
could not be completed (its last converged state is saved) or its results could not be written
(those there are as they were); 130 interrupted (what had converged is saved).
"""

from __future__ import annotations

import argparse
import contextlib
import errno
import json
import os
import platform
import shutil
import sys
import tempfile
import traceback
import warnings
from collections.abc import Callable, Iterable, Iterator
from importlib.metadata import version
from pathlib import Path, PurePosixPath
from typing import Any

from rich.console import Console
from rich.progress import TextColumn, TimeElapsedColumn

from fingerpad.benchmark import command as benchmarks
from fingerpad.documents import SceneError, read_yaml
from fingerpad.emulator import command as emulators
from fingerpad.files import (
    InUse,
    disk_is_full,
    files_below,
    is_file,
    locked,
    read_input,
    staged,
    unusable,
)
from fingerpad.healing import simulate
from fingerpad.mechanics.stepping import NonConvergence
from fingerpad.planning.bounds import PlanError, percent
from fingerpad.planning.plan import Plan, plan
from fingerpad.processes import progress_bar
from fingerpad.receptors.recovery import ReceptorError
from fingerpad.results import summary, write_history, write_vtu
from fingerpad.revolved import SLICES
from fingerpad.scenes.families import read_scene
from fingerpad.scenes.scene import Scene, load_scene
from fingerpad.specimen import mesh_for, quality_of, write_pad
from fingerpad.specimen.outline import OutlineError
from fingerpad.specimen.pad import MeshError
from fingerpad.sweeps import command as sweeps
from fingerpad.sweeps.engine import NotFinished
from fingerpad.units import QuantityError, parse_quantity, unit_of

DONE, UNFORESEEN, WRONG_INPUT, NOT_COMPLETED, INTERRUPTED = 0, 1, 2, 3, 130
RESULTS = ("plan.json", "history.nc", "summary.json", "last_converged.nc")
"""Files that a run may write; plan.json names those it did write, and no other is ever removed."""
FIELDS = ("vtu/*.vtu", "vtu/*.series", "vtu/*.pvd")
_GAPS = 0.97
"""Share of a contact's width that touches, below which it has gaps."""


class _Refusal(ValueError):
    """A request that cannot be met; its text is the one line shown."""


class _NotWritten(OSError):
    """Results that could not be written; its text is the one line shown."""


KEYS = {OutlineError: "specimen.outline", MeshError: "specimen.mesh"}
KEYS |= {ReceptorError: "outputs.receptors"}
"""Errors that do not name a key -> the key that they are about."""
INPUT_ERRORS = (_Refusal, SceneError, PlanError, *KEYS)

_OF_THE_SYSTEM = frozenset(
    getattr(errno, name)
    for name in "ENOSPC EDQUOT EIO EACCES EPERM EROFS EFBIG EMFILE ENFILE ENOMEM ENODEV ESTALE "
    "ETIMEDOUT ENAMETOOLONG EBUSY EEXIST ENOTDIR EISDIR ELOOP".split()
)
"""Errors of the system that no program can do anything about."""


def main(arguments: list[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    arguments : list of str, optional
        The words after ``fingerpad``; those of the process without.

    Returns
    -------
    int
        The exit code.

    Raises
    ------
    SystemExit
        By argparse, with code 2 for a wrong command line and 0 after help and version.
    """
    for stream in (sys.stdout, sys.stderr):  # any name of a file can be printed
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")
    # warnings of libraries are for the file of an unforeseen error, not for the user
    with warnings.catch_warnings(record=not sys.warnoptions) as heard:
        if not sys.warnoptions:
            warnings.simplefilter("default")
        try:
            try:
                options = _parser().parse_args(arguments)
                return options.command(options) or DONE
            finally:
                sys.stdout.flush()
        except (Exception, KeyboardInterrupt) as error:
            return _failure(error, heard or [])


def _failure(error: Exception | KeyboardInterrupt, heard: list[warnings.WarningMessage]) -> int:
    """Show an error in one line; the exit code for it."""
    text = str(error)
    if isinstance(error, KeyboardInterrupt):
        return _say("interrupted", INTERRUPTED)
    if isinstance(error, BrokenPipeError):
        return _silence()
    if isinstance(error, INPUT_ERRORS):
        return _say(text, WRONG_INPUT)
    if isinstance(error, _NotWritten):
        return _say(text, NOT_COMPLETED)
    if isinstance(error, MemoryError):
        advice = "try a coarser accuracy or fewer receptors"
        return _say(f"not enough memory: {text or 'out of memory'}; {advice}", NOT_COMPLETED)
    if isinstance(error, OSError) and error.errno in _OF_THE_SYSTEM:
        if error.filename:
            return _say(f"'{error.filename}' fails: {error.strerror}", NOT_COMPLETED)
        _silence()
        return _say(f"output cannot be written: {error.strerror}", NOT_COMPLETED)
    if isinstance(error, ImportError) and "cannot be loaded" in text:
        return _say(text, NOT_COMPLETED)
    if isinstance(error, ImportError) and ("failed to map" in text or "cannot allocate" in text):
        what = f"not enough memory to load what a run needs: {text}"
        return _say(f"{what}; try a larger limit (ulimit -v)", NOT_COMPLETED)
    return _unforeseen(error, heard)


def _silence() -> int:
    """Leave nothing for the interpreter to flush into standard output, whose reader has gone."""
    with contextlib.suppress(OSError):  # it may be no file
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return DONE


def _unforeseen(error: Exception, heard: list[warnings.WarningMessage]) -> int:
    """Show an unforeseen error in one line; all that helps to find it goes into a file."""
    warned = [f"{w.category.__name__}: {w.message} ({w.filename}:{w.lineno})" for w in heard]
    lines = (
        f"fingerpad {version('fingerpad')}, Python {platform.python_version()}",
        platform.platform(),
        f"arguments: {sys.argv[1:]}",
        "".join(traceback.format_exception(error)),
        "warnings:",
        *warned,
    )
    try:
        handle, name = tempfile.mkstemp(prefix="fingerpad-error-", suffix=".txt")
        with os.fdopen(handle, "w", encoding="utf-8", errors="backslashreplace") as file:
            file.write("\n".join(lines))
    except OSError as reason:
        name = f"no file ({reason.strerror})"
    text = " ".join(str(error).split())
    text = text if len(text) <= 200 else text[:200] + " ..."
    cause = ": ".join(filter(None, [type(error).__name__, text]))
    return _say(
        f"internal error, {cause}: details in {name}, please report it with the scene", UNFORESEEN
    )


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="fingerpad", description="Simulate touch on a human fingerpad."
    )
    said = f"fingerpad {version('fingerpad')}"
    shown = "show the version and exit"
    parser.add_argument("--version", action="version", version=said, help=shown)
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    def command(name: str, does: Callable, described: str) -> Callable[..., Any]:
        """A command; the function that adds an option to it."""
        added = commands.add_parser(name, help=described)
        added.set_defaults(command=does)
        return added.add_argument

    plan = command("plan", _plan, "say what would be simulated, why, and what it would cost")
    run = command("run", _run, "simulate a scene: history.nc, summary.json, plan.json")
    scored = "predict published measurements of touch and score it, or score a file"
    benchmarks.options(command("benchmark", _benchmark, scored))
    mesh = command("mesh", _mesh, "write the mesh a scene would be simulated on")
    sweep = command(
        "sweep",
        _sweep,
        "simulate the scenes of a sweep: sweep.nc, sweep.csv; only what is missing",
    )
    emulate = command("emulate", _emulate, "fit an emulator to a sweep that kept its histories")
    explore = command("explore", _explore, "write a page to play with an emulator")
    is_set: dict[str, Any] = {"action": "store_true"}
    folder: dict[str, Any] = {"metavar": "DIR", "type": Path}
    count: dict[str, Any] = {"metavar": "N", "type": _cores, "default": 1}
    plan("--json", **is_set, help="print plan.json instead of a table")
    plan("--cores", **count, help="of a sweep: how many would run it")
    run("--out", **folder, help="where the results go (default: results/SCENE)")
    sweep("--out", **folder, help="where the results go (default: results/sweeps/SWEEP)")
    run("--force", **is_set, help="replace what is in DIR under the names of the results")
    sweep("--force", **is_set, help="use DIR though it holds another sweep")
    fields = "also write fields for ParaView, in DIR/vtu: snapshots, or the last state"
    run("--vtu", **is_set, help=fields)
    run("--revolved", **is_set, help="with --vtu: a body of revolution as a solid of half a turn")
    mesh_file = "mesh file, coordinates in mm"
    mesh("--out", metavar="FILE.msh", type=Path, required=True, help=mesh_file)
    sweep("--cores", **count, help="processes at a time (default: 1)")
    cluster = "a Snakemake profile instead of --cores, as workflow/profiles/slurm"
    sweep("--profile", metavar="DIR", help=cluster)
    sweep("--again", **is_set, help="also try scenes again that could not be simulated before")
    emulate("folder", metavar="SWEEP_DIR", type=Path, help="the folder of the sweep")
    judges = "the folder of another sweep over the same keys: how far off the emulator is for it"
    emulate("--unseen", metavar="SWEEP_DIR", type=Path, help=judges)
    until = "add scenes where it knows least until 95 %% are within X, such as 0.01"
    emulate("--grow", metavar="X", type=float, help=until)
    emulate("--scenes", metavar="N", type=int, help="with --grow: most to add (default: 500)")
    late = "with --grow: none is begun later (default: no limit)"
    emulate("--seconds", metavar="S", type=float, help=late)
    emulate("--cores", **count, help="processes at a time (default: 1)")
    explore("emulator", metavar="FILE", type=Path, help="the file of the emulator")
    file: dict[str, Any] = {"metavar": "FILE", "type": Path, "required": True}
    emulate("--out", **file, help="the file of the emulator, such as pad.emulator")
    explore("--out", **file, help="the page, such as explorer.html")
    for option in (run, sweep, emulate):
        option(
            "--quiet", **is_set, help="no progress bar, no closing line; errors and doubts are said"
        )
    for option in (plan, run, mesh):
        option("scene", metavar="SCENE.yaml", type=Path, help="the scene, or a sweep to plan")
    sweep("sweep", metavar="SWEEP.yaml", type=Path, help="the sweep")
    levels = "draft, thesis, fine or a tolerance; replaces what the scene states"
    for option in (plan, run, mesh, sweep):
        option("--accuracy", metavar="X", help=levels)
    return parser


def _cores(text: str) -> int:
    if not text.isdigit() or not int(text):
        raise argparse.ArgumentTypeError(f"'{text}' is not a number of cores; allowed: 1 or more")
    return int(text)


# --- commands -------------------------------------------------------------------------------------


def _plan(options: argparse.Namespace) -> None:
    if _is_sweep(options.scene):
        sweeps.plan(options.scene, options.accuracy, options.cores, options.json)
        return
    scene, chosen = _prepare(options)
    if options.json:
        print(json.dumps(chosen.to_dict(), indent=2))
    else:
        _print_plan(scene, chosen)


def _run(options: argparse.Namespace) -> int:
    out = options.out or Path("results") / options.scene.stem
    _check_writable(out, directory=True)
    scene, chosen = _prepare(options)
    if options.revolved and not (options.vtu and scene.axisymmetric):
        needs = "allowed: beside --vtu, of a scene with kinematics: axisymmetric"
        raise SceneError(
            f"{options.scene}: --revolved turns fields of a body of revolution; {needs}"
        )
    unit = _force_unit(options.scene)

    with _folder(out, scene, chosen, options) as folder:
        _check_room(out, chosen.result_bytes(scene, options.vtu))
        try:
            with (
                _naming(options.scene, scene),
                _progress(scene.name, quiet=options.quiet) as progress,
            ):
                dataset = simulate(scene, plan=chosen, progress=progress, fields=options.vtu)
        except NonConvergence as error:
            return _say(folder.rescue(error), NOT_COMPLETED)
        except KeyboardInterrupt as stop:
            return _say(folder.keep(stop), INTERRUPTED)
        # of the last run, where the tolerance took more than one
        folder.plan = json.loads(dataset.attrs.get("plan", "{}")) or folder.plan
        totals = summary(dataset)

        def results(stage: Path) -> None:
            write_history(dataset, stage / "history.nc")
            _write_json(totals, stage / "summary.json")
            if options.vtu:
                write_vtu(dataset, stage / "vtu", SLICES if options.revolved else 0)

        folder.write(results)
    doubts = totals["run"].get("doubts", [])
    if not options.quiet:
        print(_closing_line(totals, out, unit))
        for note in totals["run"].get("notes", ()):
            print(f"{'doubt' if note in doubts else 'note'}: {note}")
    for doubt in doubts if options.quiet else ():
        print(f"fingerpad: doubt: {doubt}", file=sys.stderr)
    return DONE


def _sweep(options: argparse.Namespace) -> int:
    if options.out:
        _check_writable(options.out, directory=True)
    try:
        sweeps.sweep(options)
    except NotFinished as error:
        return _say(str(error), NOT_COMPLETED)
    return DONE


def _benchmark(options: argparse.Namespace) -> int:
    if options.out:
        _check_writable(options.out, directory=True)
    try:
        benchmarks.benchmark(options)
    except NonConvergence as error:
        return _say(f"a measurement cannot be simulated: {error}", NOT_COMPLETED)
    return DONE


def _emulate(options: argparse.Namespace) -> None:
    _check_writable(options.out, directory=False)
    emulators.emulate_folder(options)


def _explore(options: argparse.Namespace) -> None:
    _check_writable(options.out, directory=False)
    emulators.explore(options.emulator, options.out)


def _mesh(options: argparse.Namespace) -> None:
    if options.out.suffix != ".msh":
        raise _Refusal(f"--out: '{options.out}' is not a mesh file; allowed: a name ending in .msh")
    _check_writable(options.out, directory=False)
    scene, chosen = _prepare(options)
    with _naming(options.scene, scene):
        mesh = mesh_for(scene, chosen)
    with _directory(options.out.parent), _unwritable(options.out):
        write_pad(mesh, options.out)
    for name, value in quality_of(mesh).items():
        print(f"{name}: {value:.6g}" if isinstance(value, float) else f"{name}: {value}")


# --- scene and plan, with errors that name the file -----------------------------------------------


def _is_sweep(path: Path) -> bool:
    """Does a file describe a sweep: variations of a scene that it names?"""
    try:
        document = read_yaml(path) if is_file(path) else None
    except SceneError:
        return False  # whoever reads the file next says what is wrong with it
    return isinstance(document, dict) and "over" in document and "scene" in document


def _prepare(options: argparse.Namespace) -> tuple[Scene, Plan]:
    """The scene, at the accuracy of the command line, and its plan."""
    if _is_sweep(options.scene):
        allowed = "fingerpad sweep, or fingerpad plan"
        raise _Refusal(f"{options.scene}: is a sweep, not a scene; allowed: {allowed}")
    scene = load_scene(options.scene)
    if options.accuracy is not None:
        try:
            scene = scene.with_accuracy(options.accuracy)
        except SceneError as error:
            raise _Refusal(str(error).replace(f"{scene.name}: accuracy", "--accuracy", 1)) from None
    with _naming(options.scene, scene):
        return scene, plan(scene)


@contextlib.contextmanager
def _naming(path: Path, scene: Scene) -> Iterator[None]:
    """Put file and key before the message of an error met after the scene was read."""
    try:
        yield
    except INPUT_ERRORS as error:
        message = str(error).removeprefix(f"{scene.name}: ")
        key = KEYS.get(type(error), "")
        if key == "specimen.mesh" and scene.specimen.mesh is None:
            shapes = ("outline", "slab", "half_round")
            key = next(f"specimen.{name}" for name in shapes if getattr(scene.specimen, name))
        message = message.removeprefix(f"{key.rpartition('.')[2]}: ")
        raise _Refusal(": ".join(filter(None, [str(path), key, message]))) from None


# --- files ----------------------------------------------------------------------------------------


def _check_writable(path: Path, directory: bool) -> None:
    """Refuses an output path that cannot be written, without writing anything."""
    if wrong := unusable(path):
        raise _Refusal(f"--out: '{path}' has {wrong} in its name; allowed: a name without")
    try:
        if path.is_dir() != directory and (path.exists() or path.is_symlink()):
            raise _Refusal(f"--out: '{path}' is {'not ' if directory else ''}a directory")
        nearest = path.absolute() if directory else path.absolute().parent
        while not nearest.exists():
            nearest = nearest.parent
    except OSError as error:
        raise _Refusal(
            f"--out: '{path}' cannot be used: {error.strerror}; allowed: a path"
        ) from None
    if not nearest.is_dir() or not os.access(nearest, os.W_OK | os.X_OK):
        raise _Refusal(
            f"--out: '{path}' cannot be written; allowed: a path in a directory that can"
        )


def _check_room(path: Path, needed: float) -> None:
    """Refuses a run whose results will not find room, before it is run."""
    if disk_is_full(path, needed):
        what = f"has no room for about {needed / 1e6:.2g} MB of results"
        raise _Refusal(f"--out: '{path}' {what}; allowed: a folder that has")


@contextlib.contextmanager
def _directory(path: Path) -> Iterator[Path]:
    """The directory, made if need be; one that was made is removed again when nothing was put in
    it.
    """
    made = [parent for parent in (path, *path.parents) if not parent.exists()]
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise _Refusal(f"--out: '{path}' cannot be made: {error.strerror}") from None
    try:
        yield path
    finally:
        with contextlib.suppress(OSError):
            for parent in made:
                parent.rmdir()


@contextlib.contextmanager
def _unwritable(path: Path) -> Iterator[None]:
    """Turns an error of writing into the line of :class:`_NotWritten`."""
    try:
        yield
    except OSError as error:
        what = error.strerror or error
        raise _NotWritten(
            f"'{path}' cannot be written: {what}; what was there is as it was"
        ) from None


@contextlib.contextmanager
def _folder(path: Path, scene: Scene, plan: Plan, options: argparse.Namespace) -> Iterator[_Folder]:
    """The folder of the results, held for this process alone; refused if it holds what is not this
    scene's.
    """
    patterns = () if options.force else RESULTS + FIELDS if options.vtu else RESULTS
    try:
        with _directory(path), locked(path):
            folder = _Folder(path, scene.name, plan.to_dict(), patterns)
            folder.check()
            yield folder
    except InUse:
        raise _Refusal(
            f"--out: '{path}' is being written by another run; allowed: another folder, or later"
        ) from None


class _Folder:
    """The folder of a run: what the run before wrote there, and how this one writes into it.

    Of files like ``patterns`` those that no run has written are left alone; none, where they may be
    replaced.
    """

    def __init__(
        self, path: Path, scene: str, plan: dict[str, Any], patterns: Iterable[str]
    ) -> None:
        self.path, self.scene, self.plan, self.patterns = path, scene, plan, tuple(patterns)
        try:
            self.before = json.loads(read_input(path / "plan.json", "table"))
            listed = [str(name) for name in self.before["files"]]
        except (OSError, ValueError, LookupError, TypeError, RecursionError):
            self.before, listed = {}, []
        self.files = [name for name in listed if _is_result(name)]

    def check(self) -> None:
        """Refuses to replace results of another scene, and files that no run has written."""
        cure = "allowed: another --out, or --force to replace"
        if self.patterns and self.files and self.before.get("scene") != self.scene:
            what = f"holds the results of the scene '{self.before.get('scene')}'"
            raise _Refusal(f"--out: '{self.path}' {what}; {cure} them")
        for found in self._foreign():
            raise _Refusal(
                f"--out: '{found}' was not written by a run that is known here; {cure} it"
            )

    def _foreign(self) -> list[Path]:
        found = sorted(file for pattern in self.patterns for file in self.path.glob(pattern))
        return [file for file in found if file.relative_to(self.path).as_posix() not in self.files]

    def write(self, fill: Callable[[Path], None], keeping: bool = False) -> None:
        """Lets ``fill`` write results into a scratch folder; they replace those of the run before,
        or come beside them when ``keeping``. Where they cannot be written here, they go to a
        temporary place, which the error names.
        """
        kept = self.files if keeping else []
        try:
            with _unwritable(self.path):
                if foreign := self._foreign():  # since the run began
                    raise FileExistsError(
                        errno.EEXIST, f"'{foreign[0].name}' has come into it meanwhile"
                    )
                with staged(self.path, "plan.json", () if keeping else self.files) as stage:
                    fill(stage)
                    self._describe(stage, kept)
        except _NotWritten as reason:
            raise _NotWritten(f"{reason}; {self._elsewhere(fill)}") from None

    def _describe(self, stage: Path, kept: Iterable[str] = ()) -> None:
        """Writes plan.json, which names the files that there are."""
        files = sorted({*kept, *files_below(stage), "plan.json"})
        plan = self.before if kept else self.plan
        _write_json(plan | {"scene": self.scene, "files": files}, stage / "plan.json")

    def _elsewhere(self, fill: Callable[[Path], None]) -> str:
        """Writes the results to a temporary place instead, and says where; or that they are
        lost.
        """
        place = None
        try:
            place = Path(tempfile.mkdtemp(prefix=f"fingerpad-{self.path.absolute().name}-"))
            fill(place)
            self._describe(place)
        except BaseException as error:
            if place is not None:
                shutil.rmtree(place, ignore_errors=True)
            if not isinstance(error, OSError):
                raise
            return f"nor can a temporary place ({error.strerror or error}): these results are lost"
        return f"these results are in '{place}'"

    def rescue(self, error: Any) -> str:
        """Saves what converged before ``error`` (its ``dataset``); returns the message that says
        where.
        """
        dataset = getattr(error, "dataset", None)
        try:
            self._last_converged(dataset)
        except _NotWritten as reason:
            return f"{error}; {reason}"
        if dataset is None:
            return f"{error}; no step had converged, so there is no state to save"
        return f"{error}; the last converged state is saved in {self.path / 'last_converged.nc'}"

    def keep(self, stop: KeyboardInterrupt) -> str:
        """Saves what had converged when the run was interrupted beside the results there are;
        returns the message.
        """
        dataset = getattr(stop, "dataset", None)
        if dataset is None:
            return "interrupted"
        self._last_converged(dataset, keeping=True)
        when = f"interrupted after t = {float(dataset['time'].values[-1]):.6g} s"
        if dataset.attrs.get("complete"):
            when = "interrupted while the run was made again with something relaxed"
        return f"{when}; what had converged is saved in {self.path / 'last_converged.nc'}"

    def _last_converged(self, dataset: Any, keeping: bool = False) -> None:
        def last(stage: Path) -> None:
            if dataset is not None:
                write_history(dataset, stage / "last_converged.nc")

        self.write(last, keeping)


def _is_result(name: str) -> bool:
    """Could a run have written a file of this (relative) name?"""
    path = PurePosixPath(name)
    return name in RESULTS or (
        len(path.parts) == 2 and any(path.match(pattern) for pattern in FIELDS)
    )


def _write_json(data: Any, path: Path) -> None:
    path.write_text(json.dumps(data, indent=2) + "\n", encoding="utf-8")


# --- what a person sees ---------------------------------------------------------------------------


def _say(message: str, code: int) -> int:
    """One line on standard error."""
    print(f"fingerpad: {' '.join(message.split())}", file=sys.stderr)
    return code


def _print_plan(scene: Scene, plan: Plan) -> None:
    Console(highlight=False).print(plan.shown(f"Plan of {scene.name}"), crop=False)


@contextlib.contextmanager
def _progress(name: str, quiet: bool) -> Iterator[Callable[[dict[str, Any]], None] | None]:
    """A progress bar of a run, as a function to call after each step; else None."""
    columns = (
        TextColumn("t = {task.completed:.3g} of {task.total:.3g} s"),
        TextColumn("contact {task.fields[contact_width_mm]:.2f} mm"),
        TextColumn("{task.fields[iterations]} iterations, {task.fields[cutbacks]} cuts"),
        TimeElapsedColumn(),
    )
    start = {"contact_width_mm": 0.0, "iterations": 0, "cutbacks": 0}
    with progress_bar(name, quiet, *columns, total=1.0, **start) as show:
        if show is None:
            yield None
            return

        def after_step(state: dict[str, Any]) -> None:
            show(completed=state["time_s"], total=state["end_time_s"], **state)

        yield after_step


def _force_unit(path: Path) -> str:
    """The unit in which a scene file states a force, or gf."""
    if path.exists() and not path.is_file():  # a pipe cannot be read again
        return "gf"
    try:
        legs = read_scene(path).document["motion"]
        return next(
            (unit_of(leg["press_to_force"]) for leg in legs if "press_to_force" in leg), "gf"
        )
    except (SceneError, QuantityError):  # it has changed since
        return "gf"


def _closing_line(totals: dict[str, Any], directory: Path, unit: str) -> str:
    last, run = totals["legs"][-1], totals["run"]
    force = last["force_N"] / parse_quantity(f"1 {unit}", "force")
    once = run.get("compiling_s", 0.0)
    compiled = f", {once:.2g} of them to compile, once" if once > 0.5 else ""
    touching = last.get("touching_width_mm", last["contact_width_mm"])
    gaps = (
        f", {touching:.3g} mm of it touching" if touching < _GAPS * last["contact_width_mm"] else ""
    )
    return (
        f"depth {last['depth_mm']:.3g} mm, "
        f"force {force:#.3g} {unit} ({_force(last)}), "
        f"contact {last['contact_width_mm']:.3g} mm wide{gaps}; {run['steps']} steps, "
        f"{run['newton_iterations']} iterations, {run['wall_s']:.2g} s{compiled}; "
        f"{_error_line(totals)}; results in {directory}"
    )


def _force(leg: dict[str, Any]) -> str:
    """The force of a plane section by its length, of a body of revolution in newtons."""
    if "force_N_per_m" in leg:
        return f"{leg['force_N_per_m']:.3g} N/m"
    return f"{leg['force_N']:.3g} N"


def _error_line(totals: dict[str, Any]) -> str:
    """The error at the end and, where it is much larger, the largest on the way; what was asked
    for; and what it leaves out.
    """
    run = totals["run"]
    end = run["estimated_error"]
    line = f"error about {percent(end)}".replace("about more", "more")
    if run["largest_error"] > 1.5 * end:
        line += f", {percent(run['largest_error'])} at most"
    if len(run.get("runs", [])) > 1:
        line += f", after {len(run['runs'])} runs"
    if run.get("tolerance_missed"):
        line += f" ({run['tolerance_missed']})"
    return (
        f"{line}; pressure is unbounded at {run['peak_pressure_unbounded_at']}"
        if run["peak_pressure_singular"]
        else line
    )
