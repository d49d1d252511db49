from fingerpad.documents import SceneError as SceneError
from fingerpad.emulator.fitting import emulate as emulate
from fingerpad.emulator.growing import grow as grow
from fingerpad.emulator.model import Emulator as Emulator
from fingerpad.emulator.model import load_emulator as load_emulator
from fingerpad.healing import simulate as simulate
from fingerpad.mechanics.stepping import NonConvergence as NonConvergence
from fingerpad.planning.plan import Plan as Plan
from fingerpad.planning.plan import PlanError as PlanError
from fingerpad.planning.plan import plan as plan
from fingerpad.planning.plan import read_plan as read_plan
from fingerpad.receptors.recovery import ReceptorError as ReceptorError
from fingerpad.receptors.respond import respond as respond
from fingerpad.results import ResultError as ResultError
from fingerpad.results import read_history as read_history
from fingerpad.results import summary as summary
from fingerpad.results import write_history as write_history
from fingerpad.scenes.scene import Scene as Scene
from fingerpad.scenes.scene import load_scene as load_scene
from fingerpad.specimen.outline import OutlineError as OutlineError
from fingerpad.specimen.pad import MeshError as MeshError
from fingerpad.sweeps.engine import NotFinished as NotFinished
from fingerpad.sweeps.engine import SweepError as SweepError
from fingerpad.sweeps.engine import sweep as sweep

__version__: str
