"""The program ``hamel``, which the wheel installs; also ``python -m hamel``."""

import signal
import sys

from . import _hamel


def main() -> None:
    """Runs the program with the arguments of the process, and ends the process with its exit code."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        # Python would raise `KeyboardInterrupt` beside what the program does itself.
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(_hamel.run_program(["hamel", *sys.argv[1:]]))


if __name__ == "__main__":
    main()
