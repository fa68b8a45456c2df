"""Robot files by Atheris, which keeps mutants that reach new lines of wmrgen: ``python -m tests.hostile.fuzz 600``.

Each is read, and derived with all its files where it describes a robot of at most `WHEELS` wheels. Nothing but an error
of wmrgen may come of it, within `SECONDS`. Atheris prints what fails and leaves it as build/fuzz/crash-*.
"""

from __future__ import annotations

import random
import re
import sys
from pathlib import Path

WHEELS = 3
SECONDS = 60  # for one text: Atheris's instruments and tests beside it slow it ten times and more
LENGTH = 1500  # bytes
BUILD = Path("build/fuzz")


def derive(data: bytes) -> None:
    """What `wmrgen derive` does with a text, but for the writing."""
    import wmrgen
    from wmrgen.derivation.emit import artifacts
    from wmrgen.errors import WmrgenError
    from wmrgen.robotfile.load import read_text
    from wmrgen.robotfile.text import decode
    from wmrgen.tools.lint import Subject, findings

    try:
        spec = read_text(decode(data, "fuzz.yaml"), "fuzz.yaml")
        robot = wmrgen.robot_of(spec)
        if len(robot.wheels) <= WHEELS:
            derivation = wmrgen.derive(robot)
            findings(Subject(spec, robot, derivation.mobility))
            artifacts(derivation)
    except WmrgenError as error:
        str(error).encode()
    except OverflowError:
        pass  # the command line tells it in words


def corpus(folder: Path) -> None:
    """The gallery and short robots of every type, as a start."""
    from tests.robotfile.files import KEYS, robot, wheel

    folder.mkdir(parents=True, exist_ok=True)
    for path in Path("robots").glob("*.yaml"):
        text = re.sub(r"\s*#.*|^(description|source):.*", "", path.read_text(encoding="utf-8"), flags=re.M)
        (folder / path.stem).write_text(text, encoding="utf-8")
    for name in KEYS:
        (folder / f"one_{name}").write_text(
            robot(wheel("a", name), wheel("b", name, y="-0.2")), encoding="utf-8"
        )


def words() -> list[str]:
    """Every word of the reference of robot files, and what expressions are made of."""
    reference = Path("docs/robot_file.md").read_text(encoding="utf-8")
    values = "0 1 -1 0.1 1e30 1e-30 pi/2 -pi 1/3 sqrt(2) (a+b)**4 a/b 45_deg 1_in".replace("_", " ").split(
        " "
    )
    return [*sorted(set(re.findall(r"[A-Za-z_0-9.]{1,20}", reference))), *values * 20]


def mutated(data: bytes, size: int, seed: int) -> bytes:
    """Half of the time one word for another, so that many texts stay robot files; else what libFuzzer does."""
    import atheris

    chance = random.Random(seed)
    if chance.random() < 0.5:
        return bytes(atheris.Mutate(data, size))
    parts = re.split(r"([\w.]+)", data.decode("utf-8", "replace"))
    for _ in range(chance.randint(1, 3)):
        parts[chance.randrange(len(parts))] = chance.choice(
            [*chance.choices(WORDS, k=4), chance.choice(parts)]
        )
    return "".join(parts).encode("utf-8", "replace")[:size]


def main() -> None:
    import atheris

    corpus(BUILD / "corpus")
    with atheris.instrument_imports(include=["wmrgen"]):
        pass
    options = (
        f"-max_total_time={sys.argv[1]}", f"-timeout={SECONDS}", f"-max_len={LENGTH}", "-rss_limit_mb=3000", "-seed=1",
        f"-artifact_prefix={BUILD}/", "-print_final_stats=1", "-len_control=0",
    )  # fmt: skip
    atheris.Setup([sys.argv[0], *options, str(BUILD / "corpus")], derive, custom_mutator=mutated)
    atheris.Fuzz()


WORDS = words()

if __name__ == "__main__":
    main()
