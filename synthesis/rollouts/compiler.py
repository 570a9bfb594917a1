"""A CasADi function describes one item. This compiles a loop that applies it to all items and columns.

A loop computes in one precision and only with sums, products, quotients and roundings in a fixed order. So every
processor gives the same numbers, and a column does not depend on the columns beside it.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from enum import Enum
from functools import partial
from typing import Any, NamedTuple

import casadi as ca
import llvmlite.binding as llvm
import numpy as np
from llvmlite import ir

from ...models.algebra.ops import Ops, casadi_ops
from ...models.arrays import Array

Single, Double = np.float32, np.float64
REALS: dict[Any, ir.Type] = {Single: ir.FloatType(), Double: ir.DoubleType()}
INDEX = ir.IntType(64)
LARGEST = 6.1  # for larger arguments tanh(6.1) is used


class At(Enum):
    """The last axes of an array, by item and column. The first axis of the array counts the values read together."""

    EACH = "(items, columns)"
    ITEM = "(items,)"
    COLUMN = "(columns,)"
    TAIL = "(others, columns), in the row that is the tail of the item"
    HEAD = "(others, columns), in the row that is its head"


ENDS = At.TAIL, At.HEAD


class LoopNest(NamedTuple):
    """A function of vectors, the arrays it reads its arguments from and those it writes its results to, by name."""

    function: ca.Function
    reads: Sequence[tuple[str, At]]
    writes: Sequence[tuple[str, At]]


Pointer = ctypes.c_void_p


def pointer(array: Array, kind: Any = Single) -> Pointer:
    """The address of an array; while this pointer is kept, the array stays in memory.

    Raises TypeError for an array of another type, or one that is not contiguous.
    """
    if array.dtype != kind or not array.flags.c_contiguous:
        raise TypeError(
            f"an array of {array.dtype} with strides {array.strides} is not a contiguous array of {kind.__name__}"
        )
    where: Pointer = array.ctypes.data_as(Pointer)
    return where


class Compiled:
    """A loop that has been compiled."""

    def __init__(self, loop: LoopNest, call: Callable[..., None]) -> None:
        self._names, self._call = _arrays(loop), call

    def bind(
        self,
        items: int,
        columns: int,
        arrays: Mapping[str, Pointer],
        ends: Sequence[Pointer | None] = (None, None),
        others: int = 0,
    ) -> Callable[[], None]:
        """A function that runs the loop over these arrays.

        `ends` are the rows (items,) out of `others` that belong to the tail and to the head of every item. An array
        that is written must not share memory with another one.
        """
        return partial(self._call, items, columns, others, *ends, *(arrays[name] for name in self._names))


def compiled(loops: Mapping[str, LoopNest], real: Any = Single) -> dict[str, Compiled]:
    """The loops over numbers of type `real`, ready to run."""
    module = ir.Module("loops")
    module.triple = llvm.get_default_triple()
    for name, loop in loops.items():
        _write(module, name, loop, REALS[real])
    engine, found = _engine(str(module)), {}
    for name, loop in loops.items():
        kinds = [ctypes.c_int64] * 3 + [Pointer] * (len(ENDS) + len(_arrays(loop)))
        call = ctypes.CFUNCTYPE(None, *kinds)(engine.get_function_address(name))
        call.engine = engine  # type: ignore[attr-defined]  # keeps the engine alive, so the code is not freed
        found[name] = Compiled(loop, call)
    return found


def single_ops() -> Ops:
    """`casadi_ops` with sin, cos and tanh replaced by sums, products and quotients, within 1e-5."""
    return replace(casadi_ops(), sin=_sin, cos=_cos, tanh=_tanh)


def _tanh(s: Array) -> Array:
    """Lambert's continued fraction s / (1 + s^2 / (3 + s^2 / (5 + ...))), cut off at 17."""
    s = ca.fmin(ca.fmax(s, -LARGEST), LARGEST)
    square = s * s
    over = _polynomial(square, [34459425, 4729725, 135135, 990, 1])
    return s * over / _polynomial(square, [34459425, 16216200, 945945, 13860, 45])


def _sin(s: Array) -> Array:
    rest, sign = _half_turn(s)
    return sign * rest * _polynomial(rest * rest, [(-1) ** k / math.factorial(2 * k + 1) for k in range(5)])


def _cos(s: Array) -> Array:
    rest, sign = _half_turn(s)
    return sign * _polynomial(rest * rest, [(-1) ** k / math.factorial(2 * k) for k in range(6)])


def _half_turn(s: Array) -> tuple[Array, Array]:
    """s minus the nearest multiple of pi, and the sign that sin and cos get from it."""
    turns = ca.floor(s / math.pi + 0.5)
    pi = float(Single(math.pi))  # the rest of pi is subtracted afterwards
    rest = (s - turns * pi) - turns * (math.pi - pi)
    return rest, 1 - 4 * (turns / 2 - ca.floor(turns / 2))


def _polynomial(s: Array, coefficients: Sequence[float]) -> Array:
    """By Horner's rule, the constant first."""
    *rest, value = coefficients
    for coefficient in reversed(rest):
        value = value * s + coefficient
    return value


def _arrays(loop: LoopNest) -> list[str]:
    return list(dict.fromkeys(name for name, _ in (*loop.reads, *loop.writes)))


def _write(module: ir.Module, name: str, loop: LoopNest, real: ir.Type) -> None:
    """The LLVM function of a loop over numbers of one type: for every item, for every column."""
    arrays = _arrays(loop)
    kinds = [INDEX] * 3 + [INDEX.as_pointer()] * len(ENDS) + [real.as_pointer()] * len(arrays)
    function = ir.Function(module, ir.FunctionType(ir.VoidType(), kinds), name)
    for argument in function.args[3:]:
        argument.add_attribute("noalias")
    items, columns, others, *ends = function.args[:5]
    pointers = dict(zip(arrays, function.args[5:], strict=True))
    builder = ir.IRBuilder(function.append_basic_block())

    def over_columns(item: ir.Value, rows: dict[At, ir.Value], column: ir.Value) -> None:
        def address(array: str, at: At, k: int) -> ir.Value:
            if at in rows:
                size, place = builder.mul(others if at in ENDS else items, columns), builder.add(rows[at], column)
            else:
                size, place = {At.ITEM: (items, item), At.COLUMN: (columns, column)}[at]
            return builder.gep(pointers[array], [builder.add(builder.mul(size, ir.Constant(INDEX, k)), place)])

        def read(argument: int, k: int) -> ir.Value:
            return builder.load(address(*loop.reads[argument], k))

        for (result, k), value in _results(builder, loop.function, real, read):
            builder.store(value, address(*loop.writes[result], k))

    def over_items(item: ir.Value) -> None:
        rows = {At.EACH: builder.mul(item, columns)}
        if any(at in ENDS for _, at in loop.reads):
            for at, end in zip(ENDS, ends, strict=True):
                rows[at] = builder.mul(builder.load(builder.gep(end, [item])), columns)
        _count(builder, columns, lambda column: over_columns(item, rows, column))

    _count(builder, items, over_items)
    builder.ret_void()


def _count(builder: ir.IRBuilder, count: ir.Value, body: Callable[[ir.Value], None]) -> None:
    """body(k) for k = 0, ..., count - 1."""
    before = builder.block
    test, inside, after = (builder.append_basic_block() for _ in range(3))
    builder.branch(test)
    builder.position_at_end(test)
    k = builder.phi(INDEX)
    k.add_incoming(ir.Constant(INDEX, 0), before)
    builder.cbranch(builder.icmp_signed("<", k, count), inside, after)
    builder.position_at_end(inside)
    body(k)
    k.add_incoming(builder.add(k, ir.Constant(INDEX, 1)), builder.block)
    builder.branch(test)
    builder.position_at_end(after)


def _results(
    builder: ir.IRBuilder, function: ca.Function, real: ir.Type, read: Callable[[int, int], ir.Value]
) -> list[tuple[tuple[int, int], ir.Value]]:
    """The results of a CasADi function, each with its output number and its place there; `read` gives the arguments."""
    work: dict[int, ir.Value] = {}
    results = []
    for number in range(function.n_instructions()):
        kind = function.instruction_id(number)
        into, of = function.instruction_output(number), function.instruction_input(number)
        if kind == ca.OP_OUTPUT:
            results.append(((into[0], into[1]), work[of[0]]))
        elif kind == ca.OP_INPUT:
            work[into[0]] = read(of[0], of[1])
        elif kind == ca.OP_CONST:
            work[into[0]] = _constant(real, function.instruction_constant(number))
        else:
            work[into[0]] = _OPERATIONS[kind](builder, *(work[k] for k in of))
    return results


def _constant(real: ir.Type, value: float) -> ir.Value:
    return ir.Constant(real, float(Single(value)) if isinstance(real, ir.FloatType) else value)


def _intrinsic(builder: ir.IRBuilder, name: str, value: ir.Value) -> ir.Value:
    return builder.call(builder.module.declare_intrinsic(name, [value.type]), [value])


def _larger(builder: ir.IRBuilder, a: ir.Value, b: ir.Value, sign: str = "<") -> ir.Value:
    return builder.select(builder.fcmp_ordered(sign, a, b), b, a)


_OPERATIONS: dict[int, Callable[..., ir.Value]] = {
    ca.OP_ADD: lambda builder, a, b: builder.fadd(a, b),
    ca.OP_SUB: lambda builder, a, b: builder.fsub(a, b),
    ca.OP_MUL: lambda builder, a, b: builder.fmul(a, b),
    ca.OP_DIV: lambda builder, a, b: builder.fdiv(a, b),
    ca.OP_NEG: lambda builder, a: builder.fneg(a),
    ca.OP_SQ: lambda builder, a: builder.fmul(a, a),
    ca.OP_TWICE: lambda builder, a: builder.fadd(a, a),
    ca.OP_INV: lambda builder, a: builder.fdiv(_constant(a.type, 1), a),
    ca.OP_FABS: lambda builder, a: _intrinsic(builder, "llvm.fabs", a),
    ca.OP_FLOOR: lambda builder, a: _intrinsic(builder, "llvm.floor", a),
    ca.OP_FMAX: _larger,
    ca.OP_FMIN: lambda builder, a, b: _larger(builder, a, b, ">"),
    ca.OP_NOT: lambda builder, a: builder.select(
        builder.fcmp_ordered("==", a, _constant(a.type, 0)), _constant(a.type, 1), _constant(a.type, 0)
    ),
    ca.OP_IF_ELSE_ZERO: lambda builder, a, b: builder.select(
        builder.fcmp_ordered("!=", a, _constant(a.type, 0)), b, _constant(a.type, 0)
    ),
}


def _engine(text: str) -> Any:
    """LLVM's text, optimised and in memory."""
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    cpu, features = llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()
    machine = llvm.Target.from_default_triple().create_target_machine(cpu=cpu, features=features, opt=3, jit=True)
    module, options = llvm.parse_assembly(text), llvm.create_pipeline_tuning_options(speed_level=3)
    options.loop_vectorization = True
    passes = llvm.create_pass_builder(machine, options)
    passes.getModulePassManager().run(module, passes)
    engine = llvm.create_mcjit_compiler(module, machine)  # the engine owns both from now on
    engine.finalize_object()
    return engine
