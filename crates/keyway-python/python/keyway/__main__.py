"""The program ``keyway``."""

import signal
import sys

from keyway import program


def main() -> int:
    """Runs the command line and returns the exit code."""
    # Python would only remember Ctrl-C until the program has ended.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return program(sys.argv[1:])


if __name__ == "__main__":
    sys.exit(main())
