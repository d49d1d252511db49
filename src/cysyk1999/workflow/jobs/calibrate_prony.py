"""The force of a ramp and hold, the elastic curves and measured time constants -> the Prony series,
how certain.
"""

from pathlib import Path

from cysyk1999.measures.inputs import read_results
from cysyk1999.publishing.write import write_frame
from cysyk1999.reference_data import read_relaxation
from cysyk1999.studies.calibration.relaxation import study, with_series
from fingerpad import load_scene, plan, simulate
from fingerpad.specimen import read_pad_mesh


def run(job):
    """`relaxation`, `histories` of plate, long_term and `scene`, its `mesh`, `accuracy` -> `data`:
    prony, estimates.
    """
    scene, mesh = load_scene(job.scene[0]), read_pad_mesh(job.mesh[0])
    if job.accuracy != ["as_stated"]:
        scene = scene.with_accuracy(job.accuracy[0])
    how = plan(scene)

    def full(prony):
        return (
            simulate(with_series(scene, prony), how, mesh=mesh).force.values
            * scene.specimen.contact_length
        )

    histories, _, _ = read_results(job.histories)
    plate, other, held = (histories[Path(path).parent.name] for path in job.histories)
    result = study(plate, other, held, read_relaxation(job.relaxation[0]), full)
    for path, frame in zip(job.data, (result.prony, result.estimates), strict=True):
        write_frame(frame, Path(path))
