"""The ``wmrgen`` command: ``python -m wmrgen``."""

from __future__ import annotations

import gc
import sys


def main() -> None:
    """Run the command line; exits with its code."""
    # A short run makes few cycles and many objects: collecting often costs a tenth of it.
    gc.set_threshold(200_000, 20, 20)
    from wmrgen.cli.console import close, prepare

    prepare()
    from wmrgen.cli.outcome import Stopped, heed_signals, stopped

    heed_signals()
    try:
        from wmrgen.cli.app import app

        app()
    except Stopped as stop:
        sys.exit(stopped(stop))
    finally:
        close()
        gc.freeze()  # the process ends here: spare it a last search for cycles through all of sympy


if __name__ == "__main__":
    main()
