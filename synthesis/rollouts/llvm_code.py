"""The LLVM code of loops and programs: what CasADi says of one item and column, written out for all."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import casadi as ca
import numpy as np
from llvmlite import ir

from .loops import ENDS, At, LoopNest, Part, arrays_of, program_arrays, program_sizes

INDEX = ir.IntType(64)


def write_program(
    module: ir.Module, name: str, loops: Mapping[str, LoopNest], parts: Sequence[Part], real: ir.Type
) -> None:
    """The LLVM function that runs loops of the module one after the other: for every step, for every part."""
    sizes, arrays = program_sizes(parts), program_arrays(loops, parts)
    kinds = [INDEX] * (3 + len(sizes)) + [INDEX.as_pointer()] * len(ENDS) + [real.as_pointer()] * len(arrays)
    function = ir.Function(module, ir.FunctionType(ir.VoidType(), kinds), name)
    steps, first, columns, *rest = function.args
    counts = dict(zip(sizes, rest, strict=False))
    ends, pointers = rest[len(sizes) : -len(arrays)], dict(zip(arrays, rest[-len(arrays) :], strict=True))
    builder = ir.IRBuilder(function.append_basic_block())

    def over_parts(step: ir.Value) -> None:
        number = builder.add(first, step)
        for part in parts:
            loop, items = loops[part.loop], counts[part.items]
            values = {array: loop.function.size1_in(k) for k, (array, _) in enumerate(loop.reads)}
            own = {array: pointers[part.name(array)] for array in arrays_of(loop)}
            for array in part.moving:
                size = builder.mul(items, ir.Constant(INDEX, values[array]))
                own[array] = builder.gep(own[array], [builder.mul(number, size)])
            builder.call(module.get_global(part.loop), [items, columns, counts["vehicles"], *ends, *own.values()])

    _count(builder, steps, over_parts)
    builder.ret_void()


def write_loop(module: ir.Module, name: str, loop: LoopNest, real: ir.Type) -> None:
    """The LLVM function of a loop over numbers of one type: for every item, for every column."""
    arrays = arrays_of(loop)
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
    """The results of a CasADi function, each with its number and place in it, where `read` gives the arguments."""
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
    return ir.Constant(real, float(np.float32(value)) if isinstance(real, ir.FloatType) else value)


def _intrinsic(builder: ir.IRBuilder, name: str, value: ir.Value) -> ir.Value:
    return builder.call(builder.module.declare_intrinsic(name, [value.type]), [value])


def _truth(builder: ir.IRBuilder, condition: ir.Value, a: ir.Value) -> ir.Value:
    """1 where a condition holds, else 0, as a number of the type of `a`."""
    return builder.select(condition, _constant(a.type, 1), _constant(a.type, 0))


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
    ca.OP_SQRT: lambda builder, a: _intrinsic(builder, "llvm.sqrt", a),
    ca.OP_LT: lambda builder, a, b: _truth(builder, builder.fcmp_ordered("<", a, b), a),
    ca.OP_LE: lambda builder, a, b: _truth(builder, builder.fcmp_ordered("<=", a, b), a),
    ca.OP_FABS: lambda builder, a: _intrinsic(builder, "llvm.fabs", a),
    ca.OP_FLOOR: lambda builder, a: _intrinsic(builder, "llvm.floor", a),
    ca.OP_FMAX: _larger,
    ca.OP_FMIN: lambda builder, a, b: _larger(builder, a, b, ">"),
    ca.OP_NOT: lambda builder, a: _truth(builder, builder.fcmp_ordered("==", a, _constant(a.type, 0)), a),
    ca.OP_IF_ELSE_ZERO: lambda builder, a, b: builder.select(
        builder.fcmp_ordered("!=", a, _constant(a.type, 0)), b, _constant(a.type, 0)
    ),
}
