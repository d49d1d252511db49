"""The command ``fingerpad``, or ``python -m fingerpad``."""

import resource
import sys

LEAST_BYTES = 0.9e9
"""Of addresses that the libraries take before anything is solved."""


def main() -> int:
    """Run the command line, where there is memory enough to import it; the exit code."""
    limit, _ = resource.getrlimit(resource.RLIMIT_AS)
    if limit != resource.RLIM_INFINITY and limit < LEAST_BYTES:
        need = f"a limit (ulimit -v) below {LEAST_BYTES / 1e9:.2g} GB"
        print(f"fingerpad: not enough memory: {need}", file=sys.stderr)
        return 3
    try:
        from fingerpad.cli import main as command
    except KeyboardInterrupt:  # it takes seconds where nothing is compiled
        print("fingerpad: interrupted", file=sys.stderr)
        return 130
    return command()


if __name__ == "__main__":
    sys.exit(main())
