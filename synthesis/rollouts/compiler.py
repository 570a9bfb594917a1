"""Loops over items and columns, compiled by LLVM: what CasADi says of one of them, done for all in one precision.

Nothing but sums, products, quotients, roots and roundings, in one order: the same numbers on every processor, and in a
column the same whatever stands beside it.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import llvmlite.binding as llvm
import numpy as np
from llvmlite import ir

from ...models.arrays import Array
from .llvm_code import write_loop, write_program
from .loops import ENDS, LoopNest, Part, arrays_of, program_arrays, program_sizes

Single, Double = np.float32, np.float64
REALS: dict[Any, ir.Type] = {Single: ir.FloatType(), Double: ir.DoubleType()}

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
        self._names, self._call = arrays_of(loop), call

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


class Program:
    """Loops that run one after the other, again and again."""

    def __init__(self, loops: Mapping[str, LoopNest], parts: Sequence[Part], call: Callable[..., None]) -> None:
        self._sizes, self._names, self._call = program_sizes(parts), program_arrays(loops, parts), call

    def bind(
        self,
        sizes: Mapping[str, int],
        columns: int,
        arrays: Mapping[str, Pointer],
        ends: Sequence[Pointer | None] = (None, None),
    ) -> Callable[..., None]:
        """A function of (steps, first step = 0) that runs the program over these arrays; see `Compiled.bind`.

        `sizes` are how many items there are of every kind; the ends of edges are rows out of `vehicles`.
        """
        fixed = (columns, *(sizes[name] for name in self._sizes), *ends, *(arrays[name] for name in self._names))

        def run(steps: int, first: int = 0) -> None:
            self._call(steps, first, *fixed)

        return run


def compiled(loops: Mapping[str, LoopNest], real: Any = Single) -> dict[str, Compiled]:
    """The loops over numbers of type `real`, ready to run."""
    engine = _engine(str(_module(loops, real)))
    calls = {name: _call(engine, name, 3, len(arrays_of(loop))) for name, loop in loops.items()}
    return {name: Compiled(loop, calls[name]) for name, loop in loops.items()}


def compiled_programs(
    loops: Mapping[str, LoopNest], programs: Mapping[str, Sequence[Part]], real: Any = Single
) -> dict[str, Program]:
    """Programs of loops over numbers of type `real`, ready to run. One kind of items must be `vehicles`."""
    module = _module(loops, real)
    for name, parts in programs.items():
        write_program(module, name, loops, parts, REALS[real])
    engine = _engine(str(module))
    ready = {}
    for name, parts in programs.items():
        call = _call(engine, name, 3 + len(program_sizes(parts)), len(program_arrays(loops, parts)))
        ready[name] = Program(loops, parts, call)
    return ready


def _module(loops: Mapping[str, LoopNest], real: Any) -> ir.Module:
    module = ir.Module("loops")
    module.triple = llvm.get_default_triple()
    for name, loop in loops.items():
        write_loop(module, name, loop, REALS[real])
    return module


def _call(engine: Any, name: str, integers: int, arrays: int) -> Callable[..., None]:
    """The compiled function of that name."""
    kinds = [ctypes.c_int64] * integers + [Pointer] * (len(ENDS) + arrays)
    call = ctypes.CFUNCTYPE(None, *kinds)(engine.get_function_address(name))
    call.engine = engine  # type: ignore[attr-defined]  # keeps the engine alive, so the code is not freed
    return call


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
