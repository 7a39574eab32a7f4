"""Subnormal numbers as zeros while a kernel runs: motions that die out take sixty times as long with them.

They are below 2.3e-308, so that what is lost of a motion is less than its last digit by three hundred powers of ten.
On processors other than x86-64 nothing is set.
"""

import platform
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

FLUSHED = 0x8040
"""Bits of the control register of SSE: results flush to zero, and subnormal operands are zeros."""

IS_X86 = platform.machine() in ("x86_64", "AMD64")

Generated = tuple[Any, Callable[..., Any]]


@intrinsic
def flush_subnormals(_typing: Any) -> Generated:
    """Give the control register as it is, for `restore`, and let subnormals be zeros from here on."""

    def generate(_context: Any, builder: Any, _signature: Any, _arguments: Any) -> Any:
        if not IS_X86:
            return ir.Constant(ir.IntType(32), 0)
        place = builder.alloca(ir.IntType(32))
        _call(builder, "llvm.x86.sse.stmxcsr", place)
        before = builder.load(place)
        builder.store(builder.or_(before, ir.Constant(ir.IntType(32), FLUSHED)), place)
        _call(builder, "llvm.x86.sse.ldmxcsr", place)
        return before

    return types.uint32(), generate


@intrinsic
def restore(_typing: Any, before: Any) -> Generated:
    """Set the control register as it was."""

    def generate(_context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        if IS_X86:
            place = builder.alloca(ir.IntType(32))
            builder.store(arguments[0], place)
            _call(builder, "llvm.x86.sse.ldmxcsr", place)
        return ir.Constant(ir.IntType(32), 0)

    return types.uint32(before), generate


def _call(builder: Any, name: str, place: Any) -> None:
    pointer = ir.IntType(8).as_pointer()
    function = builder.module.declare_intrinsic(name, (), ir.FunctionType(ir.VoidType(), [pointer]))
    builder.call(function, [builder.bitcast(place, pointer)])
