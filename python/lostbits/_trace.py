"""Follows the operations of a numpy function without changing it.

The function runs once on arrays of one ray. Each item of these arrays also knows which operation made it. All that the
function does to them (arithmetic, sqrt, where, comparisons, sums, cross products, masks) is recorded in a list, the
tape, which liblostbits.so can run in every format. A nan is not a number of the list. An item that is nan because the
function wrote nan there stands for the decision "miss".
"""

from __future__ import annotations

import functools
import math
import os
import sys
import threading
from typing import Any, Callable, Iterator

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

ALWAYS = -1  # in `valid`: no decision makes the item nan
# Folders as code objects name them, with links not resolved. The final separator keeps them from matching a file of the
# user beside them whose name begins in the same way.
PACKAGE = os.path.join(os.path.dirname(__file__), "")
NUMPY = os.path.join(os.path.dirname(np.__file__), "")


class Unfollowed(TypeError):
    """A function does something that cannot be followed. If one line is the cause, the text begins with file:line."""


def user_line() -> tuple[str, int]:
    frame: Any = sys._getframe(1)
    while frame and frame.f_code.co_filename.startswith((PACKAGE, NUMPY, "<__array_function__")):
        frame = frame.f_back
    return (frame.f_code.co_filename, frame.f_lineno) if frame else ("?", 0)


def fail(what: str) -> Unfollowed:
    return Unfollowed("{}:{}: {}".format(*user_line(), what))


class Tape:
    """The list of operations being recorded. `implicit`: the root of a negative number also counts as a miss."""

    def __init__(self, dtype: Any, implicit: bool) -> None:
        self.dtype, self.implicit = np.dtype(dtype), implicit
        self.ops: list[tuple[str, tuple[int, ...], float]] = []
        self.labels: dict[int, str] = {}
        self.branches: list[str] = []  # file:line of each `if` on a whole batch
        self.lines: list[int] = []
        self._made: dict[tuple[str, tuple[int, ...], float], int] = {}

    def add(self, op: str, *operands: int, value: float = 0.0) -> int:
        row = (op, (*operands, -1, -1, -1)[:3], value)
        once = op in ("constant", "both", "either", "opposite")
        if once and math.copysign(1, value) > 0 and row in self._made:
            return self._made[row]
        self.ops.append(row)
        self.lines.append(user_line()[1])
        self._made[row] = len(self.ops) - 1
        return len(self.ops) - 1

    def both(self, a: int, b: int) -> int:
        if a == ALWAYS or a == b:
            return b
        return a if b == ALWAYS else self.add("both", a, b)

    def never(self) -> int:
        return self.add("less", self.add("constant", value=1.0), self.add("constant", value=0.0))

    def opposite(self, a: int) -> int:
        return self.never() if a == ALWAYS else self.add("opposite", a)


here = threading.local()
# The numpy functions that can be followed, with what runs in their place; `_sums` adds to it.
known: dict[Any, Callable[..., Any]] = {}


def tape() -> Tape:
    return here.tape  # type: ignore[no-any-return]


_comparisons = {"less": "less", "less_equal": "less_equal", "greater": "greater", "greater_equal": "greater_equal"}
_plain = {"add": "add", "subtract": "sub", "multiply": "mul", "divide": "div", "true_divide": "div",
          "negative": "neg", "absolute": "abs", "fabs": "abs", "copysign": "copysign", "minimum": "min",
          "maximum": "max", "fmin": "min", "fmax": "max"}
_logic = {"logical_and": "both", "bitwise_and": "both", "logical_or": "either", "bitwise_or": "either"}


class Traced(NDArrayOperatorsMixin):
    """An array whose items know their operations.

    `value`: the numpy array. `nodes`: the index of each item in the tape. `valid`: the index of the decision under
    which each item is a number, or ALWAYS.
    """

    __array_priority__ = 1000.0

    def __init__(self, value: Any, nodes: Any, valid: Any = None) -> None:
        self.value, self.nodes = np.asarray(value), np.asarray(nodes, dtype=np.int64)
        self.valid = np.full(self.nodes.shape, ALWAYS) if valid is None else np.asarray(valid, dtype=np.int64)
        self.of_batch = False

    def __len__(self) -> int:
        return len(self.value)

    def __iter__(self) -> Iterator["Traced"]:
        return (self[i] for i in range(len(self)))

    def _like(self, change: Callable[[Any], Any]) -> "Traced":
        return Traced(change(self.value), change(self.nodes), change(self.valid))

    def __bool__(self) -> bool:
        if self.of_batch:  # any() is true and all() is false, as for a batch of hits and misses
            tape().branches.append("{}:{}".format(*user_line()))
            return bool(self.value)
        raise fail("`if` (or `and`, `or`, `not`) on an array of rays cannot be followed, since rays may differ; write "
                   "np.where or a mask")

    def _no_number(self, *_: Any, **__: Any) -> Any:
        raise fail("an array of rays becomes a number or a plain array here (float(x), math.f(x), np.array(x), a call "
                   "into C), and what is done to that cannot be followed; use numpy functions on whole arrays")

    __float__ = __int__ = __index__ = __complex__ = __array__ = item = tolist = tobytes = _no_number

    # ---- indexing ----

    def __getitem__(self, key: Any) -> "Traced":
        mask = _mask_of(key)
        if mask is None:
            return self._like(lambda a: a[key])
        everywhere = np.ones(mask.shape, dtype=np.bool_)
        return self._like(lambda a: a[everywhere])

    def __setitem__(self, key: Any, value: Any) -> None:
        mask = _mask_of(key)
        new = traced(value, self.dtype)
        if mask is None:
            self.value[key], self.nodes[key], self.valid[key] = new.value, new.nodes, new.valid
            return
        chosen = where(mask if mask.ndim == self.ndim else mask[(...,) + (None,) * (self.ndim - mask.ndim)], new, self)
        self.value, self.nodes, self.valid = chosen.value, chosen.nodes, chosen.valid

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        if name in ("shape", "ndim", "size", "dtype"):
            return getattr(self.value, name)
        if name == "T":
            return self.transpose()
        if name in ("reshape", "transpose", "copy", "ravel", "flatten", "squeeze", "swapaxes", "take"):
            return lambda *a, **o: self._like(lambda x: getattr(x, name)(*a, **o))
        if name in ("sum", "min", "max", "any", "all", "dot", "clip"):
            return lambda *a, **o: known[getattr(np, name)](self, *a, **o)
        raise fail(f"array.{name} is not followed")

    def astype(self, dtype: Any, *_: Any, **__: Any) -> "Traced":
        if np.dtype(dtype) != self.dtype:
            raise fail(f"astype({np.dtype(dtype)}) is not followed: it changes the arithmetic within the function; "
                       "keep the type of the rays")
        return self._like(np.copy)

    # ---- called by numpy ----

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **options: Any) -> Any:
        out = options.pop("out", (None,))[0]
        if options.get("where", True) is not True:
            raise fail(f"np.{ufunc.__name__} with where= is not followed; write np.where")
        if ufunc is np.matmul and method == "__call__":
            made = known[np.matmul](*inputs)
        elif method == "__call__":
            made = elementwise(ufunc, [traced(x, None) for x in inputs])
        elif method == "reduce":
            made = known["reduce"](ufunc, inputs[0], options.get("axis", 0), options.get("keepdims", False))
        else:
            raise fail(f"np.{ufunc.__name__}.{method} is not followed")
        if out is None:
            return made
        if not isinstance(out, Traced):
            raise fail("the result is written to a plain array (out=, or `a += b` with a plain a) and cannot be "
                       "followed; write a = a + b")
        out.value, out.nodes, out.valid = (np.broadcast_to(a, out.shape).copy()
                                           for a in (made.value, made.nodes, made.valid))
        return out

    def __array_function__(self, function: Any, types: Any, arguments: Any, options: Any) -> Any:
        run = known.get(function)
        if run is None:
            raise fail(f"np.{function.__name__} is not followed; use arithmetic, sqrt, where, minimum, maximum, sum, "
                       "dot, einsum, cross, norm, comparisons, masks, or functions that only move items")
        return run(*arguments, **options)


def _mask_of(key: Any) -> Traced | None:
    """The mask if an index is one, or None for plain indices."""
    if isinstance(key, Traced):
        if key.dtype != bool:
            raise fail("an index that depends on the rays is not followed; write a mask")
        return key
    if isinstance(key, tuple) and any(isinstance(k, Traced) for k in key):
        raise fail("a mask together with other indices is not followed; write a[mask]")
    return None


def _each(value: Any, parts: list[Any], one: Callable[..., tuple[int, int]]) -> Traced:
    """An array with the given value. `one` returns node and decision of each item from the same item of the parts."""
    nodes, valid = np.empty(value.shape, dtype=np.int64), np.full(value.shape, ALWAYS)
    parts = [np.broadcast_to(part, value.shape) for part in parts]
    for i in np.ndindex(value.shape):
        nodes[i], valid[i] = one(*(part[i].item() for part in parts))
    return Traced(value, nodes, valid)


def traced(x: Any, dtype: Any) -> Traced:
    """`x` as a Traced. The items of a constant become operations of the tape."""
    if isinstance(x, Traced):
        return x
    value = np.asarray(x) if dtype is None else np.asarray(x, dtype=dtype)
    if value.dtype == object:
        raise fail(f"{type(x).__name__} is not an array of numbers")
    written = tape()

    def one(item: Any) -> tuple[int, int]:
        if value.dtype == bool:
            zero, one = written.add("constant", value=0.0), written.add("constant", value=1.0)
            return written.add("less", *((zero, one) if item else (one, zero))), ALWAYS
        number = float(written.dtype.type(item))
        nan = math.isnan(number)
        return written.add("constant", value=0.0 if nan else number), written.never() if nan else ALWAYS

    weak = value.ndim == 0 or value.dtype == bool
    return _each(value if weak else value.astype(np.float64 if dtype is None else dtype), [value], one)


def elementwise(ufunc: Any, inputs: list[Traced]) -> Traced:
    name, written = ufunc.__name__, tape()
    if name == "power":
        return _power(*inputs)
    with np.errstate(all="ignore"):
        # Scalars are passed as Python numbers, whose type gives way to that of an array, as numpy's constants do. Among
        # scalars alone, those of a ray keep their type.
        are_scalars = all(x.ndim == 0 for x in inputs)
        given = [x.value if x.ndim or x.value.dtype == bool else
                 x.value[()] if are_scalars and x.value.dtype == written.dtype else x.value[()].item() for x in inputs]
        value = np.asarray(ufunc(*given))
    if value.dtype not in (bool, written.dtype):
        raise fail(f"np.{name} gives {value.dtype}, but the rays are {written.dtype}: an array of another type takes "
                   "part; give arrays of constants the type of the rays (np.array(…, dtype=o.dtype))")
    n = len(inputs)
    return _each(value, [x.nodes for x in inputs] + [x.valid for x in inputs],
                 lambda *items: _one(written, name, list(items[:n]), list(items[n:])))


def _one(written: Tape, name: str, a: list[int], valid: list[int]) -> tuple[int, int]:
    """Records an operation for one item. Returns its node and the decision under which it is a number."""
    all_valid = functools.reduce(written.both, valid, ALWAYS)
    if name in _plain:
        return written.add(_plain[name], *a), all_valid
    if name == "sqrt":
        if written.implicit:
            all_valid = written.both(all_valid,
                                     written.add("greater_equal", a[0], written.add("constant", value=0.0)))
        return written.add("sqrt", *a), all_valid
    if name == "square":
        return written.add("mul", a[0], a[0]), all_valid
    if name == "reciprocal":
        return written.add("div", written.add("constant", value=1.0), a[0]), all_valid
    if name in ("positive", "conjugate"):
        return a[0], all_valid
    if name in _comparisons:
        return written.both(all_valid, written.add(_comparisons[name], *a)), ALWAYS
    if name in ("equal", "not_equal"):
        same = written.both(all_valid, written.add("both", written.add("less_equal", *a),
                                                   written.add("greater_equal", *a)))
        return (same if name == "equal" else written.opposite(same)), ALWAYS
    if name in _logic:
        return (a[0] if a[0] == a[1] else written.add(_logic[name], *a)), ALWAYS
    if name in ("logical_not", "invert"):
        return written.opposite(a[0]), ALWAYS
    if name in ("isnan", "isfinite"):
        valid_now = written.both(all_valid, written.add("less_equal", a[0], a[0]))
        return (written.opposite(valid_now) if name == "isnan" else valid_now), ALWAYS
    raise fail(f"np.{name} is not followed: IEEE 754 does not require it to be correctly rounded, or lostbits has no "
               "such operation")


def _power(base: Traced, exponent: Traced) -> Traced:
    power = exponent.value.item() if exponent.size == 1 else None
    of = {2: np.square, 1: np.positive, 0.5: np.sqrt, -1: np.reciprocal}.get(power)
    if of is None:
        raise fail("a power other than 2, 1, 0.5 and -1 is not followed; write it as products")
    return elementwise(of, [base])


def where(condition: Any, a: Any = None, b: Any = None) -> Traced:
    """np.where. A nan on one side stands for the decision "miss" and is not an operation."""
    if a is None or b is None:
        raise fail("np.where with one argument gives indices, which are not followed; write np.where(condition, a, b)")
    written = tape()
    m, x, y = traced(condition, None), traced(a, None), traced(b, None)
    with np.errstate(all="ignore"):
        sides: list[Any] = [v.value if v.ndim else v.value[()].item() for v in (x, y)]
        value = np.where(m.value, sides[0], sides[1])
    if value.dtype != bool:
        value = value.astype(written.dtype)

    def one(k: int, xn: int, xv: int, yn: int, yv: int) -> tuple[int, int]:
        never = written.never() if ALWAYS not in (xv, yv) or xv != yv else ALWAYS
        if value.dtype == bool:
            return written.add("either", written.both(k, xn), written.both(written.opposite(k), yn)), ALWAYS
        if yv == never and yv != ALWAYS:
            return xn, written.both(k, xv)
        if xv == never and xv != ALWAYS:
            return yn, written.both(written.opposite(k), yv)
        node = xn if xn == yn else written.add("select", k, xn, yn)
        if xv == yv:
            return node, xv
        return node, written.add("either", written.both(k, xv), written.both(written.opposite(k), yv))

    return _each(value, [m.nodes, x.nodes, x.valid, y.nodes, y.valid], one)


known[np.where] = where
