"""Functions as the C backend computes them: kernels in place of library calls.

Runs after optimisation and its exact checks. What comes out is float code, operation by operation: the float32
interpreter predicts its bits on every target. It is no longer exact algebra, so no pass may follow but `schedule`.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

from wmrgen.exact.number import ONE, Exact
from wmrgen.ir.kernels import trigonometry
from wmrgen.ir.kernels.choice import AVR, DEFAULT, INLINE, LIBM, M0, M4F
from wmrgen.ir.kernels.constants import EVEN32, RINT32, RINT64
from wmrgen.ir.kernels.fuse import fuse
from wmrgen.ir.kernels.integer import SOFT
from wmrgen.ir.kernels.order import ordered
from wmrgen.ir.kernels.room import ROOM, angle_by_angle, crowded, wanted
from wmrgen.ir.kernels.sharp import sharp_sum, sharp_sums
from wmrgen.ir.kernels.signs import one_comparison, signs_as_bits
from wmrgen.ir.kernels.tape import Tape
from wmrgen.ir.nodes import Function, Module, Node, Op

_TWO = Exact(2)
_INTEGER = {Op.SIN: Op.ISIN, Op.COS: Op.ICOS, Op.ATAN: Op.IATAN}


def expand(
    module: Module, scalar: str, math: str, target: str = DEFAULT.target, small: bool = False
) -> Module:
    """``module`` as operations of C: rounding and signs as arithmetic, float functions as kernels or libm's.

    ``small``: sines and cosines take their own sign, so that all are alike; the results are the same to the bit.
    """
    if scalar != "float" or target == AVR:
        math = LIBM
    prepare = None if module.prepare is None else _Expansion(module.prepare, scalar, LIBM, target).run()
    few = scalar == "float" and math == INLINE and target == M4F and _few(module)
    functions = tuple(_Expansion(f, scalar, math, target, small, few).run() for f in module.functions)
    return Module(module.name, functions, prepare)


def _few(module: Module) -> bool:
    """Whether cosines that share the constants of sines are what lets a function do with the registers there are."""
    for function in filter(crowded, module.functions):
        usual, few = (_Expansion(function, "float", INLINE, M4F, few=few).run() for few in (False, True))
        if wanted(few) <= ROOM < wanted(usual):
            return True
    return False


def rounds(module: Module) -> bool:
    """Whether an expanded module rounds to whole numbers by adding a large one."""
    large = (RINT32, EVEN32, RINT64)
    return any(node.value in large for function in module.functions for node in function.nodes)


class _Expansion:
    """One function, node by node."""

    def __init__(
        self,
        function: Function,
        scalar: str,
        math: str,
        target: str,
        small: bool = False,
        few: bool = False,
    ) -> None:
        single = scalar == "float"
        self.fused, self.bits = single and target == M4F, single and target in (M4F, M0)
        self.function = function = signs_as_bits(one_comparison(function)) if self.bits else function
        self.inline = math == INLINE
        self.magic = RINT32 if single else RINT64
        self.tape = Tape()
        self.made: list[int] = []
        self.uses = Counter(a for node in function.nodes for a in node.args) + Counter(function.results)
        self.products = {node.args for node in function.nodes if node.op is Op.MUL}
        self.constants = {i for i, node in enumerate(function.nodes) if node.value is not None}
        self.circles: dict[int, tuple[int, int, int]] = {}
        self.raised: dict[int, int] = {}  # node of `function` that is a whole number -> that plus `magic`
        self.integer = self.inline and target == M0
        self.paired = self._pairs() if self.inline and not self.integer and not small else set()
        self.small, self.few = small, few
        self.sharp = sharp_sums(function) if single else frozenset()

    def run(self) -> Function:
        for i, node in enumerate(self.function.nodes):
            self.made.append(self._node(i, node))
        results = tuple(self.made[r] for r in self.function.results)
        made = replace(self.function, nodes=tuple(self.tape.nodes), results=results)
        made = fuse(made) if self.fused else made
        made = replace(made, nodes=tuple(_soft(n) for n in made.nodes)) if self.integer else made
        deep = ordered(made)
        return min(deep, angle_by_angle(deep), key=wanted) if self.few and not self.small else deep

    def _node(self, i: int, node: Node) -> int:
        tape, args = self.tape, tuple(self.made[a] for a in node.args)
        if i in self.sharp:
            return sharp_sum(tape, node.op, args[0], args[1], self.fused)
        match node.op:
            case Op.RINT:
                self.raised[i] = tape.add(args[0], tape.const(self.magic))
                return tape.sub(self.raised[i], tape.const(self.magic))
            case Op.MIN | Op.MAX if node.args[0] in self.constants:
                args = args[::-1]  # alike wherever it stands
            case Op.FLIP:
                return self._flip(args[0], node.args[1])
            case Op.MUL:
                found = self._signed(node)
                found = self._quotient(node) if found is None else found
                return tape.mul(*args) if found is None else found
            case Op.SIN | Op.COS | Op.ATAN if self.integer:
                return tape.put(_INTEGER[node.op], *args)
            case Op.SIN | Op.COS if self.inline:
                raised, sine, cosine = self._circle(args[0])
                if node.op is Op.COS and not self.small and not self.few:
                    return trigonometry.signed_cosine(tape, self._sign(raised), cosine)
                wave = sine if node.op is Op.SIN else cosine
                return self._by(wave, raised) if self.small else tape.mul(self._sign(raised), wave)
            case Op.ATAN if self.inline:
                return trigonometry.arctangent(tape, args[0])
            case Op.ATAN2 if self.inline:
                return trigonometry.arctangent2(tape, args[0], args[1], self.integer)
        return tape.copy(node, args)

    def _signed(self, node: Node) -> int | None:
        """a (-1)**n as a flipped; a sin x and a cos x as (a flipped) s and (a flipped) c."""
        nodes, tape = self.function.nodes, self.tape
        for factor, wave in (node.args, node.args[::-1]):
            other = nodes[wave]
            if other.op is Op.FLIP and nodes[other.args[0]].value == ONE:
                return self._flip(self.made[factor], other.args[1])
            if wave in self.paired and nodes[factor].op not in (Op.SIN, Op.COS):
                raised, sine, cosine = self._circle(self.made[other.args[0]])
                flipped = self._by(self.made[factor], raised)
                return tape.mul(flipped, sine if other.op is Op.SIN else cosine)
        return None

    def _quotient(self, node: Node) -> int | None:
        """a (1/b) as a/b, and c (a/b) as (c a)/b where c a is there: a product less."""
        nodes = self.function.nodes
        for factor, other in (node.args, node.args[::-1]):
            quotient = nodes[other]
            if quotient.op is not Op.DIV or self.uses[other] > 1:
                continue
            a, b = quotient.args
            if nodes[a].value == ONE:
                return self.tape.div(self.made[factor], self.made[b])
            if (factor, a) in self.products:
                return self.tape.div(self.tape.mul(self.made[factor], self.made[a]), self.made[b])
        return None

    def _circle(self, x: int) -> tuple[int, int, int]:
        if x not in self.circles:
            if self.few:
                self.circles[x] = trigonometry.sine_cosine_of_rest(self.tape, x)
            else:
                self.circles[x] = trigonometry.sine_cosine(self.tape, x, self.fused)
        return self.circles[x]

    def _flip(self, a: int, n: int) -> int:
        """a where the whole number n, a node of `function`, is even, else -a."""
        tape = self.tape
        raised = self.raised.get(n)
        if raised is None:
            raised = self.raised[n] = tape.add(self.made[n], tape.const(self.magic))
        return self._by(a, raised)

    def _by(self, a: int, raised: int) -> int:
        """a or -a: ``raised`` has the unit 1 in the last place, so its last bit tells odd from even."""
        if self.bits:
            return self.tape.put(Op.FLIP_BIT, a, raised)
        sign = self._sign(raised)
        return sign if self.tape.nodes[a].value == ONE else self.tape.mul(a, sign)

    def _sign(self, raised: int) -> int:
        """1 or -1. Twice the magic number has the unit 2: rounding to it tells odd from even."""
        tape, magic = self.tape, self.tape.const(self.magic)
        if self.bits:
            return tape.put(Op.FLIP_BIT, tape.const(ONE), raised)
        odd = tape.sub(raised, tape.sub(tape.add(raised, magic), magic))
        return tape.sub(tape.const(ONE), tape.mul(tape.const(_TWO), tape.mul(odd, odd)))

    def _pairs(self) -> set[int]:
        """Sines and cosines that are used only as a sin x and a cos x with the same a."""
        nodes = self.function.nodes
        users: dict[int, list[int]] = {i: [] for i, n in enumerate(nodes) if n.op in (Op.SIN, Op.COS)}
        for i, node in enumerate(nodes):
            for arg in node.args:
                if arg in users:
                    users[arg].append(i)
        for result in self.function.results:
            users.get(result, []).append(-1)
        angles: dict[int, set[int]] = {}
        for i, found in users.items():
            factors = angles.setdefault(nodes[i].args[0], set())
            factors.update(_other(nodes[u], i) if u >= 0 and nodes[u].op is Op.MUL else -1 for u in found)
        return {i for i in users if len(f := angles[nodes[i].args[0]]) == 1 and -1 not in f}


def _soft(node: Node) -> Node:
    """Arithmetic of a processor without floating point."""
    return Node(SOFT[node.op], node.args) if node.op in SOFT else node


def _other(node: Node, arg: int) -> int:
    a, b = node.args
    return b if a == arg else a
