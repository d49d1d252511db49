"""The command ``fingerpad``: plan, run or mesh one scene, without the workflow.

Exit codes: 0 done; 2 the input is wrong (one line on standard error: file, key, what is wrong, what is
allowed); 3 the simulation could not be completed (its last converged state is saved); 130 interrupted.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fingerpad.planning.plan import Plan
    from fingerpad.scenes.scene import Scene

DONE, WRONG_INPUT, NOT_CONVERGED, INTERRUPTED = 0, 2, 3, 130
RESULTS = ("plan.json", "history.nc", "summary.json", "last_converged.nc", "vtu")

# errors of wrong input: where they are defined, and the key they are about when they do not name it
_ERRORS = {
    "SceneError": ("scenes.documents", ""),
    "PlanError": ("planning.plan", ""),
    "OutlineError": ("specimen.outline", "specimen.outline"),
    "MeshError": ("specimen.mesh", "specimen.mesh"),
    "ReceptorError": ("receptors.material_points", "outputs.receptors"),
}


class _Refusal(ValueError):
    """A request that cannot be met; its text is the one line shown."""


def main(arguments: list[str] | None = None) -> int:
    """Run the command line and return the exit code.

    Args:
        arguments: the words after ``fingerpad``; those of the process when None.

    Raises:
        SystemExit: by argparse, with code 2 for a wrong command line and 0 after help and version.
    """
    options = _parser().parse_args(arguments)
    try:
        code = options.command(options)
        sys.stdout.flush()
        return code
    except KeyboardInterrupt:
        return _say("interrupted", INTERRUPTED)
    except BrokenPipeError:
        # the reader of a pipe has gone; leave nothing for the interpreter to flush into it
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return DONE
    except _input_errors() as error:
        return _say(str(error), WRONG_INPUT)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="fingerpad", description="Simulate touch on a human fingerpad.")
    parser.add_argument("--version", action=_Version, nargs=0, help="show the version and exit")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    plan = commands.add_parser("plan", help="say what would be simulated, why, and what it would cost")
    plan.add_argument("--json", action="store_true", help="print plan.json instead of a table")
    plan.set_defaults(command=_plan)

    run = commands.add_parser("run", help="simulate a scene: history.nc, summary.json, plan.json")
    run.add_argument("--out", metavar="DIR", type=Path, required=True, help="where the results go")
    run.add_argument("--vtu", action="store_true", help="also write the scene's snapshots for ParaView, in DIR/vtu")
    run.add_argument("--quiet", action="store_true", help="no progress bar, no closing line")
    run.set_defaults(command=_run)

    mesh = commands.add_parser("mesh", help="write the mesh a scene would be simulated on")
    mesh.add_argument("--out", metavar="FILE.msh", type=Path, required=True, help="mesh file, coordinates in mm")
    mesh.set_defaults(command=_mesh)

    for command in (plan, run, mesh):
        command.add_argument("scene", metavar="SCENE.yaml", type=Path, help="the scene")
        command.add_argument(
            "--accuracy",
            metavar="X",
            help="draft, thesis, fine or a tolerance; replaces what the scene states",
        )
    return parser


class _Version(argparse.Action):
    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> None:
        import fingerpad

        print(f"fingerpad {fingerpad.__version__}")
        parser.exit()


# --- commands -------------------------------------------------------------------------------------


def _plan(options: argparse.Namespace) -> int:
    scene, plan = _prepare(options)
    if options.json:
        print(json.dumps(plan.to_dict(), indent=2))
    else:
        _print_plan(scene, plan)
    return DONE


def _run(options: argparse.Namespace) -> int:
    _check_writable(options.out, directory=True)
    scene, plan = _prepare(options)
    mesh = _mesh_for(options.scene, scene, plan)

    import fingerpad
    from fingerpad.mechanics.stepping import NonConvergence
    from fingerpad.results import summary, write_history, write_vtu

    with _directory(options.out) as directory:
        try:
            with _naming(options.scene, scene), _progress(scene.name, quiet=options.quiet) as progress:
                dataset = fingerpad.simulate(scene, plan=plan, mesh=mesh, progress=progress)
        except NonConvergence as error:
            return _say(_rescue(error, plan, directory), NOT_CONVERGED)
        with _staged(directory, replacing=RESULTS) as stage:
            _write_json(plan.to_dict(), stage / "plan.json")
            write_history(dataset, stage / "history.nc")
            totals = summary(dataset)
            _write_json(totals, stage / "summary.json")
            if options.vtu and scene.outputs.snapshots:
                (stage / "vtu").mkdir()
                write_vtu(dataset, mesh, stage / "vtu")
    if not options.quiet:
        if options.vtu and not scene.outputs.snapshots:
            print("no vtu: the scene has no outputs.snapshots")
        print(_closing_line(totals, directory))
    return DONE


def _mesh(options: argparse.Namespace) -> int:
    if options.out.suffix != ".msh":
        raise _Refusal(f"--out: '{options.out}' is not a mesh file; allowed: a name ending in .msh")
    _check_writable(options.out, directory=False)
    mesh = _mesh_for(options.scene, *_prepare(options))
    with _directory(options.out.parent) as directory, _staged(directory) as stage:
        mesh.write(stage / options.out.name)
    for name, value in mesh.quality().items():
        print(f"{name}: {value:.6g}" if isinstance(value, float) else f"{name}: {value}")
    return DONE


# --- scene, plan and mesh, with errors that name the file -----------------------------------------


def _prepare(options: argparse.Namespace) -> tuple[Scene, Plan]:
    """The scene, at the accuracy asked for, and its plan."""
    from fingerpad.scenes.scene import SceneError, load_scene

    scene = load_scene(options.scene)
    if options.accuracy is not None:
        try:
            scene = scene.with_accuracy(options.accuracy)
        except SceneError as error:
            raise _Refusal(str(error).replace(f"{scene.name}: accuracy", "--accuracy", 1)) from None

    from fingerpad.planning.plan import plan

    with _naming(options.scene, scene):
        return scene, plan(scene)


def _mesh_for(path: Path, scene: Scene, plan: Plan) -> Any:
    from fingerpad.specimen import mesh_for

    with _naming(path, scene):
        return mesh_for(scene, plan)


def _input_errors() -> tuple[type[ValueError], ...]:
    """What counts as wrong input; a module that was not imported cannot have raised its error."""
    loaded = ((sys.modules.get(f"fingerpad.{module}"), name) for name, (module, _) in _ERRORS.items())
    return (_Refusal, *(getattr(module, name) for module, name in loaded if hasattr(module, name)))


@contextlib.contextmanager
def _naming(path: Path, scene: Scene) -> Iterator[None]:
    """Puts file and key before the message of an error met after the scene was read."""
    try:
        yield
    except _input_errors() as error:
        message = str(error).removeprefix(f"{scene.name}: ")
        key = _ERRORS.get(type(error).__name__, ("", ""))[1]
        if key == "specimen.mesh" and scene.specimen.mesh is None:
            key = "specimen.outline"
        message = message.removeprefix(f"{key.rpartition('.')[2]}: ")
        raise _Refusal(": ".join(filter(None, [str(path), key, message]))) from None


# --- files ----------------------------------------------------------------------------------------


def _check_writable(path: Path, directory: bool) -> None:
    """Refuses an output path that cannot be written, without writing anything."""
    if path.is_dir() != directory and (path.exists() or path.is_symlink()):
        raise _Refusal(f"--out: '{path}' is {'not ' if directory else ''}a directory")
    nearest = path.absolute() if directory else path.absolute().parent
    while not nearest.exists():
        nearest = nearest.parent
    if not nearest.is_dir() or not os.access(nearest, os.W_OK | os.X_OK):
        raise _Refusal(f"--out: '{path}' cannot be written; allowed: a path in a directory that can")


@contextlib.contextmanager
def _directory(path: Path) -> Iterator[Path]:
    """The directory, made if need be; one that was made is removed again when nothing was put in it."""
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
def _staged(directory: Path, replacing: tuple[str, ...] = ()) -> Iterator[Path]:
    """A scratch directory whose content appears in `directory` only when everything was written.

    What is there already under the names `replacing` then goes, so that results of two runs never mix.
    """
    try:
        stage = Path(tempfile.mkdtemp(prefix=".fingerpad-", dir=directory))
    except OSError as error:
        raise _Refusal(f"--out: '{directory}' cannot be written: {error.strerror}") from None
    try:
        yield stage
        written = sorted(item.name for item in stage.iterdir())
        for name in {*replacing, *written}:
            target = directory / name
            if target.is_dir() and not target.is_symlink():
                shutil.rmtree(target)
            elif name not in written:
                target.unlink(missing_ok=True)
        for name in written:
            os.replace(stage / name, directory / name)
    except OSError as error:
        raise _Refusal(f"--out: '{directory}' cannot be written: {error.strerror or error}") from None
    finally:
        shutil.rmtree(stage, ignore_errors=True)


def _write_json(data: Any, path: Path) -> None:
    path.write_text(json.dumps(data, indent=2) + "\n", encoding="utf-8")


def _rescue(error: Any, plan: Plan, directory: Path) -> str:
    """Saves what converged before `error` (its ``dataset``); returns the message that says where."""
    from fingerpad.results import write_history

    dataset = getattr(error, "dataset", None)
    with _staged(directory, replacing=RESULTS) as stage:
        _write_json(plan.to_dict(), stage / "plan.json")
        if dataset is not None:
            write_history(dataset, stage / "last_converged.nc")
    if dataset is None:
        return f"{error}; no step had converged, so there is no state to save"
    return f"{error}; the last converged state is saved in {directory / 'last_converged.nc'}"


# --- what a person sees ---------------------------------------------------------------------------


def _say(message: str, code: int) -> int:
    """One line on standard error."""
    print(f"fingerpad: {' '.join(message.split())}", file=sys.stderr)
    return code


def _print_plan(scene: Scene, plan: Plan) -> None:
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    console = Console(highlight=False)
    effects = Table("effect", "", "why", title=f"Plan of {scene.name}", title_justify="left")
    for name, effect in plan.effects.items():
        state = Text("on", style="bold green") if effect.on else Text("off", style="dim")
        effects.add_row(Text(name.replace("_", " ")), state, Text(str(effect.why)))
    console.print(effects)
    details = Table("discretisation", "")
    for name, value in plan.discretisation.items():
        details.add_row(Text(name.replace("_", " ")), Text(f"{value:.4g}" if isinstance(value, float) else str(value)))
    console.print(details)
    console.print(Text(f"expected error: {plan.estimated_error:.1%} (depth, width, pressure, strain energy)"))
    console.print(Text(f"predicted cost: {plan.predicted_cost_s:.2g} s of one core"))


@contextlib.contextmanager
def _progress(name: str, quiet: bool) -> Iterator[Callable[[dict[str, Any]], None] | None]:
    """A progress bar on a terminal's standard error, as a function to call after each step; else None."""
    if quiet or not sys.stderr.isatty():
        yield None
        return

    from rich.console import Console
    from rich.markup import escape
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (
        TextColumn(escape(name)),
        BarColumn(),
        TextColumn("t = {task.completed:.3g} of {task.total:.3g} s"),
        TextColumn("contact {task.fields[width]:.2f} mm"),
        TextColumn("{task.fields[iterations]} iterations, {task.fields[cutbacks]} cuts"),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as progress:
        task = progress.add_task(name, total=1.0, width=0.0, iterations=0, cutbacks=0)

        def show(state: dict[str, Any]) -> None:
            progress.update(
                task,
                completed=state["time_s"],
                total=state["end_time_s"],
                width=state["contact_width_mm"],
                iterations=state["iterations"],
                cutbacks=state["cutbacks"],
            )

        yield show


def _closing_line(totals: dict[str, Any], directory: Path) -> str:
    last, run = totals["legs"][-1], totals["run"]
    return (
        f"depth {last['depth_mm']:.3g} mm, force {last['force_N_per_m']:.3g} N/m, "
        f"contact {last['contact_width_mm']:.3g} mm wide; {run['steps']} steps, "
        f"{run['newton_iterations']} iterations, {run['wall_s']:.2g} s; "
        f"error about {run['estimated_error']:.1%}; results in {directory}"
    )


if __name__ == "__main__":
    sys.exit(main())
