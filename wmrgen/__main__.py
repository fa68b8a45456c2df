"""The ``wmrgen`` command: ``python -m wmrgen``."""

from __future__ import annotations

import gc
import sys


def main() -> None:
    """Run the command line and exit with its code."""
    # A run is short and makes many objects but few reference cycles: frequent collections would cost a tenth of it.
    gc.set_threshold(1_000_000, 20, 20)
    from wmrgen.cli import console

    console.prepare()
    console.install_signal_handlers()
    try:
        from wmrgen.cli.commands import app

        app()
    except console.Stopped as stop:
        sys.exit(console.stopped(stop))
    finally:
        console.close()
        gc.freeze()  # the process ends here: this avoids a last search for cycles through all of sympy


if __name__ == "__main__":
    main()
