"""The ``wmrgen`` command: ``python -m wmrgen``."""

from __future__ import annotations


def main() -> None:
    """Run the command line; exits with its code."""
    from wmrgen.cli.app import app
    from wmrgen.cli.console import close, prepare

    prepare()
    try:
        app()
    finally:
        close()


if __name__ == "__main__":
    main()
