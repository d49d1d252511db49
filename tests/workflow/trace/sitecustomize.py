"""Record which files of the project a process opens and how many timers it sets: on the path of
traced processes only.
"""

import atexit
import json
import os
import sys
import threading
import uuid

if "TRACE_DIRECTORY" in os.environ:
    root = os.path.realpath(os.environ["TRACE_ROOT"]) + os.sep
    opened, timers = set(), []

    class _Timer(threading.Timer):
        def start(self):
            timers.append(self.interval)
            super().start()

    def _hook(event, args):
        if event == "open" and isinstance(args[0], str):
            opened.add(args[0])

    def _write():
        files = {os.path.realpath(path) for path in opened}
        files |= {
            os.path.realpath(module.__file__)
            for module in list(sys.modules.values())
            if getattr(module, "__file__", None)
        }
        inside = sorted(path[len(root) :] for path in files if path.startswith(root))
        with open(os.path.join(os.environ["TRACE_DIRECTORY"], f"{uuid.uuid4()}.json"), "w") as out:
            json.dump({"argv": sys.orig_argv[1:], "files": inside, "timers": len(timers)}, out)

    threading.Timer = _Timer
    sys.addaudithook(_hook)
    atexit.register(_write)
