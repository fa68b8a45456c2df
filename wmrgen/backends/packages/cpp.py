"""``<robot>.hpp``: the C functions for C++17, in a namespace, by reference; it copies nothing."""

from __future__ import annotations

from collections.abc import Iterator

from wmrgen.interface import Argument, arguments, members
from wmrgen.ir.nodes import Function, Module, Role
from wmrgen.render import render

_PREPARED = Argument("prepared", "prepared", {}, {})
_PARAMS = Argument("params", "params", {}, {})
_FILLED = {"x": "x"}  # of an argument that a function fills, whatever with


def header(module: Module, scalar: str) -> str:
    """The text of the header."""
    shared = members(module)
    prepare = module.prepare
    kinds = [*shared, *(["prepared"] if prepare else []), *(["params"] if prepare and prepare.inputs else [])]
    return render(
        "package/robot.hpp.j2",
        robot=module.name,
        upper=module.name.upper(),
        scalar=scalar,
        types=[(_name(kind), f"{module.name}_{kind}") for kind in kinds],
        views=[
            (_name(kind), len(ports), ", ".join(f"&of.{port.name}" for port in ports))
            for kind, ports in shared.items()
        ],
        functions=[
            line for name, own in _functions(module).items() for line in _wrapped(module.name, name, own)
        ],
    )


def passed(module: Module, function: Function) -> tuple[Argument, ...]:
    """The arguments of a function of ``module``, what `prepare` gives among them."""
    reads = any(port.role is Role.PREPARED for port in function.inputs)
    return (*([_PREPARED] if reads else []), *arguments(function, module.joints))


def preparing(module: Module) -> dict[str, tuple[Argument, ...]]:
    """Name -> arguments of what is called before functions that read what `prepare` gives."""
    if not module.prepare:
        return {}
    params, prepared = (argument._replace(writes=_FILLED) for argument in (_PARAMS, _PREPARED))
    if not module.prepare.inputs:
        return {"prepare": (prepared,)}
    return {"params_default": (params,), "prepare": (_PARAMS, prepared)}


def _functions(module: Module) -> dict[str, tuple[Argument, ...]]:
    """Name -> arguments of every C function."""
    steps = {function.name: passed(module, function) for function in module.functions if function.outputs}
    return preparing(module) | steps


def _name(kind: str) -> str:
    """``PoseCovariance`` of ``pose_covariance``."""
    return "".join(word.capitalize() for word in kind.split("_"))


def _wrapped(robot: str, name: str, own: tuple[Argument, ...]) -> Iterator[str]:
    declared = ", ".join(_declared(robot, name, argument) for argument in own)
    words = ", ".join(f"{'' if argument.by_value else '&'}{argument.name}" for argument in own)
    yield from (f"inline void {name}({declared}) noexcept", "{", f"    ::{robot}_{name}({words});", "}")
    if any(argument.reads or argument is _PARAMS for argument in own):
        head = f"[[nodiscard]] inline Status {name}_checked({declared}) noexcept"
        yield from (head, "{", f"    return ::{robot}_{name}_checked({words});", "}")


def _declared(robot: str, function: str, argument: Argument) -> str:
    if not argument.kind:
        return f"Scalar &{argument.name}" if argument.writes else f"Scalar {argument.name}"
    kind = f"{robot}_{function}_{argument.kind}" if argument.kind in ("in", "out") else _name(argument.kind)
    return f"{'' if argument.writes else 'const '}{kind} &{argument.name}"
