"""What a command prints is one text, however it comes: the notebooks' own merging begins a line at
every piece of it.
"""

from myst_nb.core import render


def setup(app):
    render.coalesce_streams = joined
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def joined(outputs):
    """The outputs of a cell, pieces of a stream put together where its first one is."""
    made, streams = [], {}
    for output in outputs or []:
        if output["output_type"] != "stream":
            made.append(output)
        elif output["name"] in streams:
            streams[output["name"]]["text"] += output["text"]
        else:
            streams[output["name"]] = output
            made.append(output)
    return made
