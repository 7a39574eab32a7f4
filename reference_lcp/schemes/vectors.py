"""Vectors of eight float64 in compiled code: a processor works on them in the widest registers that it has.

Loops over eight numbers leave the width to the compiler, which takes half of what many processors have.
"""

import operator
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.typing import signature
from numba.core.typing.templates import ConcreteTemplate, infer_global
from numba.extending import intrinsic, lower_builtin, models, register_model

from reference_lcp.schemes.subnormals import Generated

WIDTH = 8
"""Numbers of float64 in the widest vector register of usual processors, of 512 bits."""

LLVM = ir.VectorType(ir.DoubleType(), WIDTH)
ZEROS = ir.Constant(LLVM, [0.0] * WIDTH)


class Vector(types.Type):  # type: ignore[misc]
    """The type of a vector in compiled code; vectors are added, subtracted and multiplied number by number."""


VECTOR = Vector("vector of eight float64")


@register_model(Vector)
class _Model(models.PrimitiveModel):  # type: ignore[misc]
    def __init__(self, manager: Any, kind: Any):
        super().__init__(manager, kind, LLVM)


def _elementwise(operation: Callable[..., Any], instruction: str, operands: int = 2) -> None:
    case = signature(VECTOR, *[VECTOR] * operands)
    infer_global(operation)(type("Elementwise", (ConcreteTemplate,), {"cases": [case]}))
    lower_builtin(operation, *case.args)(
        lambda _context, builder, _case, values: getattr(builder, instruction)(*values)
    )


_elementwise(operator.add, "fadd")
_elementwise(operator.sub, "fsub")
_elementwise(operator.mul, "fmul")
_elementwise(operator.neg, "fneg", 1)


def _place(context: Any, builder: Any, array: Any, values: Any) -> Any:
    """Pointer to the vector that begins at an index of a one-dimensional array of float64 without gaps."""
    data = cgutils.create_struct_proxy(array)(context, builder, values[0]).data
    return builder.bitcast(builder.gep(data, [values[1]]), LLVM.as_pointer())


@intrinsic
def vector_at(_typing: Any, array: Any, _index: Any) -> Generated:
    """Give the vector that begins at an index of a one-dimensional array."""

    def generate(context: Any, builder: Any, case: Any, values: Any) -> Any:
        return builder.load(_place(context, builder, case.args[0], values), align=8)

    return VECTOR(array, types.intp), generate


@intrinsic
def set_vector(_typing: Any, array: Any, _index: Any, vector: Any) -> Generated:
    """Write a vector to where an index of a one-dimensional array begins."""

    def generate(context: Any, builder: Any, case: Any, values: Any) -> Any:
        builder.store(values[2], _place(context, builder, case.args[0], values), align=8)
        return context.get_dummy_value()

    return types.void(array, types.intp, vector), generate


@intrinsic
def multiply_add(_typing: Any, one: Any, other: Any, added: Any) -> Generated:
    """Give one · other + added: rounded once where the processor has an instruction for it, else twice."""

    def generate(_context: Any, builder: Any, _case: Any, values: Any) -> Any:
        kind = ir.FunctionType(LLVM, [LLVM] * 3)
        function = cgutils.get_or_insert_function(builder.module, kind, f"llvm.fmuladd.v{WIDTH}f64")
        return builder.call(function, values)

    return VECTOR(one, other, added), generate


@intrinsic
def clipped(_typing: Any, vector: Any, bound: Any) -> Generated:
    """Give the numbers between minus and plus their bounds that are nearest."""

    def generate(_context: Any, builder: Any, _case: Any, values: Any) -> Any:
        value, most = values
        least = builder.fneg(most)
        value = builder.select(builder.fcmp_ordered("<", value, most), value, most)
        return builder.select(builder.fcmp_ordered(">", value, least), value, least)

    return VECTOR(vector, bound), generate


@intrinsic
def chosen(_typing: Any, condition: Any, one: Any, other: Any) -> Generated:
    """Give the numbers of one vector where those of a condition are positive, else of the other."""

    def generate(_context: Any, builder: Any, _case: Any, values: Any) -> Any:
        return builder.select(builder.fcmp_ordered(">", values[0], ZEROS), values[1], values[2])

    return VECTOR(condition, one, other), generate


@intrinsic
def gathered(_typing: Any, array: Any, places: Any, _index: Any) -> Generated:
    """Give the numbers of an array, in the order of its memory, at eight places from an index on."""

    def generate(context: Any, builder: Any, case: Any, values: Any) -> Any:
        array, places = (
            cgutils.create_struct_proxy(kind)(context, builder, value).data
            for kind, value in zip(case.args[:2], values[:2], strict=True)
        )
        begin, vector = builder.gep(array, [values[2]]), ir.Constant(LLVM, ir.Undefined)
        for j in range(WIDTH):
            place = builder.load(builder.gep(places, [ir.Constant(ir.IntType(64), j)]))
            number = builder.load(builder.gep(begin, [place]))
            vector = builder.insert_element(vector, number, ir.Constant(ir.IntType(32), j))
        return vector

    return VECTOR(array, places, types.intp), generate


def _moved(first: int) -> Callable[..., Any]:
    @intrinsic
    def moved(_typing: Any, vector: Any) -> Generated:
        def generate(_context: Any, builder: Any, _case: Any, values: Any) -> Any:
            places = ir.Constant(ir.VectorType(ir.IntType(32), WIDTH), [(first + j) % WIDTH for j in range(WIDTH)])
            return builder.shuffle_vector(values[0], values[0], places)

        return VECTOR(vector), generate

    return moved


before, after = _moved(-1), _moved(1)
"""Give every place the number of the place before or after it, around the ends."""
