"""Random robots, every wheel type and every kind of coupling, as layouts that `harness.robot_text` writes."""

from __future__ import annotations

import math
import random
from typing import Any

Layout = dict[str, Any]
Wheel = dict[str, Any]
KINDS = ("none", "steer", "spin", "synchro", "castor steer", "castor spin", "fixed spin", "geared", "mixed",
         "opposed", "opposed synchro")  # fmt: skip
_GAMMAS = (0.0, math.pi / 4, -math.pi / 4, 0.6, -0.9)


def robot(seed: int, kind: str = "none") -> Layout:
    """The robot of ``seed``; ``kind``: what is coupled."""
    rng = random.Random(f"{seed} {kind}")
    wheels = _axle(rng, rng.choice((0, 0, 1, 2, 2, 3)))
    least = 0 if wheels else 2
    types = ("steered", "steered", "castor", "swedish", "swedish", "spherical")
    wheels += [_wheel(rng, rng.choice(types)) for _ in range(rng.randint(least, 4))]
    couplings: list[tuple[str, list[str]]] = []
    if kind != "none":
        wheels, couplings = _coupled(rng, wheels, kind)
    if rng.random() < 0.25:
        interval = (-rng.choice((20, 60, 90, 100, 170)), rng.choice((40, 100, 170, 180, 200, 340)))
        for w in wheels:
            if w["type"] == "steered" and not w["coupled"]:
                w["limits"] = {"steer": interval}
    rng.shuffle(wheels)
    names = {id(w): f"w{i}" for i, w in enumerate(wheels)}
    for w in wheels:
        w["name"] = names[id(w)]
        del w["coupled"]
    order = {name: i for i, name in enumerate(names.values())}
    found = [
        (joint, sorted((names[id(w)] for w in set_), key=order.__getitem__)) for joint, set_ in couplings
    ]
    return {"wheels": wheels, "couplings": found}


def moved(layout: Layout, scale: str, shift: str) -> Layout:
    """The layout with every length ``scale`` times as long, then P moved by ``shift`` [m] along -x."""

    def wheel(w: Wheel) -> Wheel:
        text = w["text"] | {k: f"({w['text'].get(k, repr(w[k]))})*{scale}" for k in ("x", "y")}
        text["x"] += f" + {shift}"
        lengths = {k: w[k] * float(scale) for k in ("x", "y", "r", "d", "o") if k in w}
        return w | lengths | {"x": lengths["x"] + float(shift), "text": text}

    return layout | {"wheels": [wheel(w) for w in layout["wheels"]]}


def _number(rng: random.Random, low: float, high: float, digits: int = 3) -> float:
    return rng.randint(round(low * 10**digits), round(high * 10**digits)) / 10**digits


def _offset(rng: random.Random) -> float:
    return rng.choice((-1, 1)) * _number(rng, 0.01, 0.2)


def _angle(rng: random.Random) -> tuple[str, float]:
    """A multiple of pi/12 as text, or a decimal that is not near one."""
    if rng.random() < 0.6:
        k = rng.randint(-12, 12)
        return f"{k}*pi/12", k * math.pi / 12
    while True:
        a = _number(rng, -3.1, 3.1, 2)
        if abs(a * 12 / math.pi - round(a * 12 / math.pi)) > 0.01:
            return repr(a), a


def _axle(rng: random.Random, count: int) -> list[Wheel]:
    """Fixed wheels on one axle line, mostly; now and then one stands askew and locks the robot."""
    px, py, k = _number(rng, -0.9, 0.9), _number(rng, -0.9, 0.9), rng.randint(-12, 12)
    heading = k * math.pi / 12
    wheels: list[Wheel] = []
    for t in rng.sample(range(-900, 900), count):
        text = {"x": f"{px} - ({t / 1000})*sin({k}*pi/12)", "y": f"{py} + ({t / 1000})*cos({k}*pi/12)"}
        flip = rng.random() < 0.3
        text["heading"] = f"{k}*pi/12" + (" + pi" if flip else "")
        x, y = px - t / 1000 * math.sin(heading), py + t / 1000 * math.cos(heading)
        wheels.append(_record("fixed", x, y, heading + math.pi * flip, text, _number(rng, 0.02, 0.3)))
    if wheels and rng.random() < 0.12:
        wheels.append(_wheel(rng, "fixed"))
    return wheels


def _record(type_: str, x: float, y: float, heading: float, text: dict[str, str], r: float) -> Wheel:
    return {
        "type": type_, "x": x, "y": y, "heading": heading, "text": text, "r": r, "coupled": False,
    }  # fmt: skip


def _wheel(rng: random.Random, type_: str) -> Wheel:
    text, heading = _angle(rng)
    x, y = _number(rng, -0.9, 0.9), _number(rng, -0.9, 0.9)
    w = _record(type_, x, y, heading, {"heading": text}, _number(rng, 0.02, 0.3))
    if type_ == "swedish":
        w["gamma"] = rng.choice(_GAMMAS)
    if type_ == "castor":
        w["d"] = _offset(rng)
    if type_ in ("steered", "castor"):
        w["o"] = rng.choice((0.0, _offset(rng)))
        w["actuated"] = rng.choice((["spin", "steer"], ["steer"], ["spin"], []) if type_ == "steered" else (
            [], ["spin", "steer"]))  # fmt: skip
        w["sensed"] = rng.choice((["spin", "steer"], ["spin", "steer"], ["steer"], []))
    elif type_ == "spherical" and x > 0:
        w["driven"] = True
    elif type_ != "spherical":
        w["actuated"] = rng.choice((["spin"], ["spin"], []))
        w["sensed"] = rng.choice((["spin"], ["spin"], []))
    return w


def _coupled(rng: random.Random, wheels: list[Wheel], kind: str) -> tuple[list[Wheel], list[Any]]:
    """``wheels`` with those that the coupling needs, and the coupled sets."""
    type_ = {"steer": "steered", "synchro": "steered", "opposed": "steered", "opposed synchro": "steered",
             "spin": "steered", "castor steer": "castor", "castor spin": "castor", "fixed spin": "fixed",
             }.get(kind)  # fmt: skip
    if kind in ("geared", "mixed"):
        pool = [w for w in wheels if w["type"] != "spherical"]
        if not any(w["type"] == "steered" for w in pool):
            pool.append(_wheel(rng, "steered"))
            wheels = [*wheels, pool[-1]]
    else:
        pool = [w for w in wheels if w["type"] == type_]
        extra = _more(rng, str(type_), max(0, rng.randint(2, 3) - len(pool)), pool, wheels)
        pool, wheels = pool + extra, wheels + extra
    if kind in ("synchro", "opposed synchro", "geared") or rng.random() < 0.4:
        _alike(rng, pool, kind)
    if (
        kind in ("spin", "geared", "mixed") and rng.random() < 0.85
    ):  # else refused, and so are castors beside them
        pool = [w for w in pool if w["type"] != "castor" or kind != "mixed"]
        for w in pool:
            w["o"] = 0.0
    while len(pool) < 2:
        pool.append(_wheel(rng, "swedish"))
        wheels = [*wheels, pool[-1]]
    members = rng.sample(pool, rng.randint(2, len(pool)))
    for w in pool:
        w["coupled"] = True
    if kind.startswith("opposed"):
        for w in members:
            w["sign"] = rng.choice((1, -1))
    if kind in ("synchro", "opposed synchro"):
        return wheels, [("steer", members), ("spin", members)]
    if kind == "mixed":
        return wheels, _mixed(rng, pool, members)
    return wheels, [("steer" if kind in ("steer", "castor steer", "opposed") else "spin", members)]


def _mixed(rng: random.Random, pool: list[Wheel], members: list[Wheel]) -> list[Any]:
    """A set of equal spins, and a set of equal angles of steered wheels or castors."""
    turning = [w for w in pool if w["type"] in ("steered", "castor")]
    sets: list[Any] = [("spin", members)]
    if len(turning) > 1:
        sets.append(("steer", rng.sample(turning, 2)))
    return sets


def _more(rng: random.Random, type_: str, count: int, pool: list[Wheel], wheels: list[Wheel]) -> list[Wheel]:
    """``count`` further wheels of a type; fixed ones on the axle line that is there."""
    if type_ != "fixed":
        return [_wheel(rng, type_) for _ in range(count)]
    if pool:
        return []
    del wheels
    return _axle(rng, max(count, 2))


def _alike(rng: random.Random, pool: list[Wheel], kind: str) -> None:
    """Wheels as real coupled ones are: equal radii, headings equal or opposite, no lateral offset."""
    lead = pool[0]
    flip = rng.random() < 0.2
    for k, w in enumerate(pool):
        w["r"] = lead["r"]
        if w.get("o") and w["type"] == "steered":
            w["o"] = 0.0
        if w["type"] in ("steered", "castor") and kind != "geared":
            turned = flip and k % 2 == 1
            w["heading"] = lead["heading"] + math.pi * turned
            w["text"] = w["text"] | {"heading": lead["text"]["heading"] + (" + pi" if turned else "")}
