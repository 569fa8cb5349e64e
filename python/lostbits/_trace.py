"""The operations of a numpy function, followed without changing it.

The function runs once on arrays of one ray whose items also know which operation made them. What it does to them
(arithmetic, sqrt, where, comparisons, sums, cross products, masks) is written down as a list that liblostbits.so runs in
every arithmetic. A nan is not a number of the list: where an item is nan because the function wrote nan there, it is the
decision of a miss.
"""

from __future__ import annotations

import math
import sys
import threading
from pathlib import Path
from typing import Any, Callable, Dict, Iterator, List, Optional, Sequence, Tuple

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

ALWAYS = -1  # of `valid`: no decision makes it nan
_package = str(Path(__file__).resolve().parent)
_numpy = str(Path(np.__file__).resolve().parent)


class Unfollowed(TypeError):
    """Something in a function that cannot be followed; says where."""


def _user_line() -> Tuple[str, int]:
    frame: Any = sys._getframe(1)
    while frame is not None:
        name = frame.f_code.co_filename
        if not name.startswith((_package, _numpy, "<__array_function__")):
            return name, frame.f_lineno
        frame = frame.f_back
    return "?", 0


def fail(what: str) -> Unfollowed:
    name, line = _user_line()
    return Unfollowed(f"{name}:{line}: {what}")


class Tape:
    """The list that is being written; `implicit`: the root of a negative number is the decision of a miss, too."""

    def __init__(self, dtype: Any, implicit: bool) -> None:
        self.dtype, self.implicit = np.dtype(dtype), implicit
        self.ops: List[Tuple[str, Tuple[int, int, int], float]] = []
        self.labels: Dict[int, str] = {}
        self.lines: List[int] = []
        self._made: Dict[Tuple[str, Tuple[int, int, int], float], int] = {}

    def add(self, op: str, *operands: int, value: float = 0.0) -> int:
        a, b, k = (*operands, -1, -1, -1)[:3]
        row = (op, (a, b, k), value)
        once = op in ("constant", "both", "either", "opposite")
        if once and math.copysign(1, value) > 0 and row in self._made:
            return self._made[row]
        self.ops.append(row)
        self.lines.append(_user_line()[1])
        if once:
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

    def is_decision(self, node: int) -> bool:
        return self.ops[node][0] in ("less", "less_equal", "greater", "greater_equal", "both", "either", "opposite")


_here = threading.local()


def tape() -> Tape:
    return _here.tape  # type: ignore[no-any-return]


_comparisons = {"less": "less", "less_equal": "less_equal", "greater": "greater", "greater_equal": "greater_equal"}
_plain = {"add": "add", "subtract": "sub", "multiply": "mul", "divide": "div", "true_divide": "div",
          "negative": "neg", "absolute": "abs", "fabs": "abs", "copysign": "copysign", "minimum": "min",
          "maximum": "max", "fmin": "min", "fmax": "max"}
_logic = {"logical_and": "both", "bitwise_and": "both", "logical_or": "either", "bitwise_or": "either"}


class Traced(NDArrayOperatorsMixin):
    """An array whose items know their operation: `value` as numpy has it, `nodes` their places in the list, `valid` the
    decision under which each is a number (ALWAYS: in any case)."""

    __array_priority__ = 1000.0

    def __init__(self, value: Any, nodes: Any, valid: Any = None) -> None:
        self.value, self.nodes = np.asarray(value), np.asarray(nodes, dtype=np.int64)
        self.valid = np.full(self.nodes.shape, ALWAYS) if valid is None else np.asarray(valid, dtype=np.int64)
        self.of_batch = False

    shape = property(lambda self: self.value.shape)
    ndim = property(lambda self: self.value.ndim)
    size = property(lambda self: self.value.size)
    dtype = property(lambda self: self.value.dtype)
    T = property(lambda self: self.transpose())

    def __len__(self) -> int:
        return len(self.value)

    def __iter__(self) -> Iterator["Traced"]:
        return (self[i] for i in range(len(self)))

    def _like(self, change: Callable[[Any], Any]) -> "Traced":
        return Traced(change(self.value), change(self.nodes), change(self.valid))

    def __bool__(self) -> bool:
        if self.of_batch:
            return True  # a short cut for batches without a hit, or with nothing but hits, changes no answer
        raise fail("`if` (or `and`, `or`, `not`) on an array of rays: each ray may differ; write np.where or a mask")

    def _no_number(self, *_: Any, **__: Any) -> Any:
        raise fail("an array of rays becomes a number or a plain array here (float(x), math.f(x), np.array(x), a call "
                   "into C): what happens to it then cannot be followed")

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
        new = _traced(value, self.dtype)
        if mask is None:
            self.value[key], self.nodes[key], self.valid[key] = new.value, new.nodes, new.valid
            return
        chosen = where(mask if mask.ndim == self.ndim else mask[(...,) + (None,) * (self.ndim - mask.ndim)], new, self)
        self.value, self.nodes, self.valid = chosen.value, chosen.nodes, chosen.valid

    # ---- methods of arrays ----

    def reshape(self, *shape: Any, **_: Any) -> "Traced":
        return self._like(lambda a: a.reshape(*shape))

    def transpose(self, *axes: Any) -> "Traced":
        return self._like(lambda a: a.transpose(*axes))

    def copy(self, *_: Any, **__: Any) -> "Traced":
        return self._like(lambda a: a.copy())

    def ravel(self, *_: Any) -> "Traced":
        return self._like(lambda a: a.ravel())

    flatten = ravel

    def squeeze(self, axis: Any = None) -> "Traced":
        return self._like(lambda a: a.squeeze(axis))

    def astype(self, dtype: Any, *_: Any, **__: Any) -> "Traced":
        if np.dtype(dtype) != self.dtype:
            raise fail(f"astype({np.dtype(dtype)}): the arithmetic changes within the function, which is not followed")
        return self.copy()

    def sum(self, axis: Any = None, **options: Any) -> "Traced":
        return _reduce(np.add, self, axis, **options)

    def min(self, axis: Any = None, **options: Any) -> "Traced":
        return _reduce(np.minimum, self, axis, **options)

    def max(self, axis: Any = None, **options: Any) -> "Traced":
        return _reduce(np.maximum, self, axis, **options)

    def any(self, axis: Any = None, **options: Any) -> "Traced":
        return _reduce(np.logical_or, self, axis, **options)

    def all(self, axis: Any = None, **options: Any) -> "Traced":
        return _reduce(np.logical_and, self, axis, **options)

    def dot(self, other: Any) -> "Traced":
        return _product(np.dot, self, other)

    # ---- what numpy asks ----

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **options: Any) -> Any:
        out = options.pop("out", (None,))[0]
        if options.get("where", True) is not True:
            raise fail(f"np.{ufunc.__name__} with where= is not followed; write np.where")
        if ufunc is np.matmul and method == "__call__":
            made = _product(np.matmul, *inputs)
        elif method == "__call__":
            made = _elementwise(ufunc, [_traced(x, None) for x in inputs])
        elif method == "reduce":
            made = _reduce(ufunc, inputs[0], options.get("axis", 0), keepdims=options.get("keepdims", False))
        else:
            raise fail(f"np.{ufunc.__name__}.{method} is not followed")
        if out is None:
            return made
        if not isinstance(out, Traced):
            raise fail("the result goes to a plain array (out=, or `a += b` with a plain a): it cannot be followed there")
        out.value, out.nodes, out.valid = (np.broadcast_to(a, out.shape).copy()
                                           for a in (made.value, made.nodes, made.valid))
        return out

    def __array_function__(self, function: Any, types: Any, arguments: Any, options: Any) -> Any:
        known = _functions.get(function)
        if known is None:
            raise fail(f"np.{function.__name__} is not followed; known are arithmetic, sqrt, where, minimum, maximum, "
                       "sum, dot, einsum, cross, norm, comparisons, masks, and what moves items")
        return known(*arguments, **options)


def _mask_of(key: Any) -> Optional[Traced]:
    """The decision that an index is; None of an index of places."""
    if isinstance(key, Traced):
        if key.dtype != bool:
            raise fail("an index that depends on the rays is not followed; write a mask")
        return key
    if isinstance(key, tuple) and any(isinstance(k, Traced) for k in key):
        raise fail("a mask beside other indices is not followed; write a[mask]")
    return None


def _traced(x: Any, dtype: Any) -> Traced:
    """Constants too: their items are operations of the list."""
    if isinstance(x, Traced):
        return x
    value = np.asarray(x) if dtype is None else np.asarray(x, dtype=dtype)
    if value.dtype == object:
        raise fail(f"{type(x).__name__} is not an array of numbers")
    nodes, valid = np.empty(value.shape, dtype=np.int64), np.full(value.shape, ALWAYS)
    written = tape()
    for i in np.ndindex(value.shape):
        if value.dtype == bool:
            zero, one = written.add("constant", value=0.0), written.add("constant", value=1.0)
            nodes[i] = written.add("less", zero, one) if value[i] else written.add("less", one, zero)
            continue
        number = float(written.dtype.type(value[i]))
        nan = math.isnan(number)
        nodes[i] = written.add("constant", value=0.0 if nan else number)
        valid[i] = written.never() if nan else ALWAYS
    return Traced(value if value.dtype == bool else value.astype(np.float64 if dtype is None else dtype), nodes, valid) \
        if value.ndim else _scalar(x, value, nodes, valid)


def _scalar(x: Any, value: Any, nodes: Any, valid: Any) -> Traced:
    made = Traced(value, nodes, valid)
    made.value = x if not isinstance(x, np.ndarray) else value  # numpy chooses types by what a scalar is
    made.value = np.asarray(made.value)
    return made


def _computed(made: Any, what: str) -> Any:
    """The value of an operation, which has the type of the rays."""
    made = np.asarray(made)
    if made.dtype != bool and made.dtype != tape().dtype:
        raise fail(f"np.{what} gives {made.dtype} of rays of {tape().dtype}: an array of another type takes part; make "
                   "constants of arrays with the type of the rays (np.array(…, dtype=o.dtype))")
    return made


def _elementwise(ufunc: Any, inputs: List[Traced]) -> Traced:
    name, written = ufunc.__name__, tape()
    if name == "power":
        return _power(*inputs)
    with np.errstate(all="ignore"):
        # One item has a type of its own; a constant is weak beside arrays.
        given = [x.value if x.ndim or x.value.dtype == bool else x.value[()].item() for x in inputs]
        value = _computed(ufunc(*given), name)
    nodes, valid = np.empty(value.shape, dtype=np.int64), np.full(value.shape, ALWAYS)
    of = [np.broadcast_to(x.nodes, value.shape) for x in inputs]
    when = [np.broadcast_to(x.valid, value.shape) for x in inputs]
    for i in np.ndindex(value.shape):
        nodes[i], valid[i] = _one(written, name, [a[i] for a in of], [a[i] for a in when])
    return Traced(value, nodes, valid)


def _one(written: Tape, name: str, a: List[int], valid: List[int]) -> Tuple[int, int]:
    """One item: its place in the list, and under which decision it is a number."""
    a = [int(k) for k in a]
    all_valid = ALWAYS
    for v in valid:
        all_valid = written.both(all_valid, int(v))
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
    raise fail(f"np.{name} is not followed: it is not a correctly rounded operation of IEEE 754, or not one of ours")


def _power(base: Traced, exponent: Traced) -> Traced:
    power = exponent.value.item() if exponent.size == 1 else None
    of = {2: np.square, 1: np.positive, 0.5: np.sqrt, -1: np.reciprocal}.get(power)  
    if of is None:
        raise fail("a power other than 2, 1, 0.5 and -1 is not followed")
    return _elementwise(of, [base])


def where(condition: Any, a: Any = None, b: Any = None) -> Traced:
    """np.where: a nan on one side is the decision of a miss, and no operation."""
    if a is None or b is None:
        raise fail("np.where with one argument gives places, which are not followed; write np.where(condition, a, b)")
    written = tape()
    m, x, y = _traced(condition, None), _traced(a, None), _traced(b, None)
    with np.errstate(all="ignore"):
        sides: List[Any] = [v.value if v.ndim else v.value[()].item() for v in (x, y)]
        value = np.where(m.value, sides[0], sides[1])
    if value.dtype != bool:
        value = value.astype(written.dtype)
    nodes, valid = np.empty(value.shape, dtype=np.int64), np.full(value.shape, ALWAYS)
    parts = [np.broadcast_to(p, value.shape) for p in (m.nodes, x.nodes, x.valid, y.nodes, y.valid)]
    for i in np.ndindex(value.shape):
        k, xn, xv, yn, yv = (int(p[i]) for p in parts)
        never = written.never() if ALWAYS not in (xv, yv) or xv != yv else ALWAYS
        if value.dtype == bool:
            nodes[i] = written.add("either", written.both(k, xn), written.both(written.opposite(k), yn))
        elif yv == never and yv != ALWAYS:
            nodes[i], valid[i] = xn, written.both(k, xv)
        elif xv == never and xv != ALWAYS:
            nodes[i], valid[i] = yn, written.both(written.opposite(k), yv)
        else:
            nodes[i] = xn if xn == yn else written.add("select", k, xn, yn)
            if xv != yv:
                valid[i] = written.add("either", written.both(k, xv), written.both(written.opposite(k), yv))
            else:
                valid[i] = xv
    return Traced(value, nodes, valid)


# ---- sums, whose order is numpy's own ----

_orders: Dict[Any, Any] = {}
_numbers = np.random.default_rng(1).random(1 << 14)
_candidates: Dict[int, Dict[str, Callable[[Any, Any], Any]]] = {
    3: {"in order": lambda p, add: add(add(p[0], p[1]), p[2]), "last pair first": lambda p, add: add(p[0], add(p[1], p[2])),
        "ends first": lambda p, add: add(add(p[0], p[2]), p[1])},
    2: {"in order": lambda p, add: add(p[0], p[1])},
    4: {"in order": lambda p, add: add(add(add(p[0], p[1]), p[2]), p[3]),
        "pairs": lambda p, add: add(add(p[0], p[1]), add(p[2], p[3])),
        "crossed pairs": lambda p, add: add(add(p[0], p[2]), add(p[1], p[3]))},
}


def _random(shape: Tuple[int, ...], which: int = 0) -> Any:
    """Numbers of many rays, which rounding tells apart; those of `which` differ."""
    many = (64, *shape[1:]) if shape and shape[0] == 1 else shape
    return np.roll(_numbers, 4111 * which)[:int(np.prod(many))].reshape(many).astype(tape().dtype)


def _order(key: Any, terms: int, ask: Callable[[], Tuple[Any, List[Any]]]) -> Any:
    """How numpy adds: the order that gives its very bits on random numbers. `ask()` returns what numpy makes of them and
    the terms."""
    if key not in _orders:
        if terms == 1:
            return lambda p, add: p[0]
        found, parts = ask()
        for name, order in _candidates.get(terms, {}).items():
            if np.array_equal(order(parts, np.add), found):
                _orders[key] = order
                break
        else:
            raise fail(f"numpy adds {terms} terms here in an order, or with roundings, that are not known")
    return _orders[key]


def _reduce(ufunc: Any, array: Any, axis: Any = None, keepdims: Any = False, dtype: Any = None, out: Any = None,
            initial: Any = None, **_: Any) -> Traced:
    array, name = _traced(array, None), ufunc.__name__
    if out is not None or initial is not None and initial is not getattr(np, "_NoValue", None):
        raise fail(f"np.{name}.reduce with out= or initial= is not followed")
    if name in ("logical_or", "logical_and") and (axis is None or axis == 0) and array.ndim == 1:
        made = Traced(np.array(True), np.array(0))
        made.of_batch = True
        return made
    if axis is None and array.ndim != 1 or isinstance(axis, tuple) and len(axis) != 1:
        raise fail(f"np.{name}.reduce over several axes at once is not followed; name one axis")
    at = (axis[0] if isinstance(axis, tuple) else 0 if axis is None else axis) % array.ndim
    if at == 0 and array.shape[0] == 1 and array.ndim > 1:
        raise fail("a sum, least or largest over all rays: each ray is asked by itself")
    parts = [array[(slice(None),) * at + (k,)] for k in range(array.shape[at])]
    combine: Any = lambda x, y: _elementwise(ufunc, [x, y])
    if name == "add":
        def ask() -> Tuple[Any, List[Any]]:
            numbers = _random(array.shape)
            return np.add.reduce(numbers, axis=at), [numbers.take(k, at) for k in range(len(parts))]
        made = _order(("sum", array.shape, at, tape().dtype), len(parts), ask)(parts, combine)
    else:
        made = parts[0]
        for part in parts[1:]:
            made = combine(made, part)
    kept: Traced = made._like(lambda a: np.expand_dims(a, at)) if keepdims is True else made
    return kept


def _einsum(subscripts: str, *operands: Any, **options: Any) -> Traced:
    if len(operands) != 2 or options.get("optimize"):
        raise fail("np.einsum of other than two arrays is not followed")
    spec = subscripts.replace(" ", "")
    left, _, result = spec.partition("->")
    names = left.split(",")
    if not result or "..." in spec and not all(n.startswith("...") for n in names):
        raise fail("np.einsum without -> or with ... inside is not followed")
    summed = [s for s in dict.fromkeys(names[0] + names[1]) if s not in result and s != "."]
    a, b = (_traced(x, tape().dtype) for x in operands)
    if len(summed) != 1 or any(n.count(summed[0]) != 1 for n in names):
        raise fail("np.einsum is followed where one letter is summed, once in both arrays, as in 'ij,ij->i'")
    s = summed[0]
    each = [n.replace("...", "") for n in names]
    axes = [x.ndim - len(n) + n.index(s) for x, n in zip((a, b), each)]
    rest = [n.replace(s, "") for n in names]

    def items(x: Any, which: int, k: int) -> Any:
        taken = x[(slice(None),) * axes[which] + (k,)]
        if rest[which] == result:
            return taken
        if set(rest[which]) <= set(result) and "." not in spec:  # broadcast to the result's letters
            key = tuple(slice(None) if letter in rest[which] else None for letter in result)
            return taken[key]
        raise fail(f"np.einsum({subscripts!r}) moves axes, which is not followed")

    def ask() -> Tuple[Any, List[Any]]:
        x, y = _random(a.shape), _random(b.shape, 1)
        return np.einsum(spec, x, y), [items(x, 0, k) * items(y, 1, k) for k in range(a.shape[axes[0]])]

    order = _order((spec, a.shape, b.shape, tape().dtype), a.shape[axes[0]], ask)
    parts = [items(a, 0, k) * items(b, 1, k) for k in range(a.shape[axes[0]])]
    return order(parts, lambda x, y: _elementwise(np.add, [x, y]))  # type: ignore[no-any-return]


def _product(function: Any, a: Any, b: Any) -> Traced:
    """np.dot, np.inner, np.matmul where a vector is the second."""
    a, b = _traced(a, tape().dtype), _traced(b, tape().dtype)
    if a.ndim == 0 or b.ndim == 0:
        return a * b  # type: ignore[no-any-return]
    if b.ndim != 1:
        raise fail(f"np.{function.__name__} with a matrix second is not followed; write np.einsum('ij,ij->i', a, b)")

    def ask() -> Tuple[Any, List[Any]]:
        x, y = _random(a.shape), _random(b.shape, 1)
        return function(x, y), [x[..., k] * y[k] for k in range(len(y))]

    order = _order((function.__name__, a.shape, b.shape, tape().dtype), len(b), ask)
    return order([a[..., k] * b[k] for k in range(len(b))],  # type: ignore[no-any-return]
                 lambda x, y: _elementwise(np.add, [x, y]))


def _cross(a: Any, b: Any, axisa: int = -1, axisb: int = -1, axisc: int = -1, axis: Any = None) -> Traced:
    if axis not in (None, -1) or (axisa, axisb, axisc) != (-1, -1, -1):
        raise fail("np.cross is followed along the last axis")
    a, b = _traced(a, tape().dtype), _traced(b, tape().dtype)
    p, q = ([v[..., k] for k in range(3)] for v in (a, b))
    return _moved(np.stack)([p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]], axis=-1)


def _norm(x: Any, ord: Any = None, axis: Any = None, keepdims: bool = False) -> Traced:
    if ord not in (None, 2) or axis is None:
        raise fail("np.linalg.norm is followed for the length along one axis: norm(x, axis=-1)")
    return _elementwise(np.sqrt, [_reduce(np.add, x * x, axis, keepdims)])


def _moved(function: Any) -> Callable[..., Traced]:
    """A function that only moves items, on arrays or on a list of them."""

    def run(first: Any, *arguments: Any, **options: Any) -> Traced:
        several = isinstance(first, (list, tuple))
        parts = [_traced(x, tape().dtype) for x in (first if several else [first])]

        def moved(what: str) -> Any:
            arrays = [getattr(p, what) for p in parts]
            return function(arrays if several else arrays[0], *arguments, **options)

        return Traced(moved("value"), moved("nodes"), moved("valid"))

    return run


def _filled(shape: Any, value: Any) -> Traced:
    made = _traced(value, tape().dtype)
    return Traced(np.full(shape, made.value, dtype=tape().dtype), np.full(shape, made.nodes),
                  np.full(shape, made.valid))


def _clip(a: Any, low: Any = None, high: Any = None, **_: Any) -> Traced:
    a = a if low is None else np.maximum(a, low)
    return a if high is None else np.minimum(a, high)  # type: ignore[no-any-return]


_functions: Dict[Any, Callable[..., Any]] = {
    np.where: where, np.einsum: _einsum, np.dot: lambda a, b: _product(np.dot, a, b), np.cross: _cross,
    np.inner: lambda a, b: _product(np.inner, a, b), np.linalg.norm: _norm, np.clip: _clip,
    np.sum: lambda a, axis=None, **o: _reduce(np.add, a, axis, **o),
    np.min: lambda a, axis=None, **o: _reduce(np.minimum, a, axis, **o),
    np.max: lambda a, axis=None, **o: _reduce(np.maximum, a, axis, **o),
    np.any: lambda a, axis=None, **o: _reduce(np.logical_or, a, axis, **o),
    np.all: lambda a, axis=None, **o: _reduce(np.logical_and, a, axis, **o),
    np.shape: lambda a: a.shape, np.ndim: lambda a: a.ndim, np.size: lambda a: a.size,
    np.zeros_like: lambda a, **o: _filled(o.get("shape") or a.shape, 0),
    np.empty_like: lambda a, **o: _filled(o.get("shape") or a.shape, 0),
    np.ones_like: lambda a, **o: _filled(o.get("shape") or a.shape, 1),
    np.full_like: lambda a, fill_value, **o: _filled(o.get("shape") or a.shape, fill_value),
}
for _name in ("stack", "concatenate", "moveaxis", "transpose", "reshape", "squeeze", "expand_dims", "broadcast_to",
              "copy", "swapaxes", "atleast_1d", "atleast_2d", "ravel", "take", "roll", "flip", "vstack", "column_stack"):
    _functions[getattr(np, _name)] = _moved(getattr(np, _name))
for _alias in ("amin", "amax"):
    _functions[getattr(np, _alias)] = _functions[getattr(np, _alias[1:])]

_lock = threading.Lock()


class _Creating:
    """While it lives, this thread's np.full, np.zeros, np.ones and np.empty make arrays that can be followed."""

    names = {"full": lambda shape, fill_value, *a, **o: _filled(shape, fill_value),
             "zeros": lambda shape, *a, **o: _filled(shape, 0), "empty": lambda shape, *a, **o: _filled(shape, 0),
             "ones": lambda shape, *a, **o: _filled(shape, 1)}

    def __enter__(self) -> None:
        _lock.acquire()
        self.before = {name: getattr(np, name) for name in self.names}
        me = threading.get_ident()
        for name, make in self.names.items():
            own = self.before[name]

            def chosen(shape: Any, *a: Any, _make: Any = make, _own: Any = own, **o: Any) -> Any:
                mine = threading.get_ident() == me and not _user_line()[0] == "?" and _asked_by_user()
                boolean = np.dtype(o.get("dtype") or (a[-1] if a and isinstance(a[-1], type) else float)) == bool
                return _make(shape, *a, **o) if mine and not boolean else _own(shape, *a, **o)

            setattr(np, name, chosen)

    def __exit__(self, *_: Any) -> None:
        for name, own in self.before.items():
            setattr(np, name, own)
        _lock.release()


def _asked_by_user() -> bool:
    return not sys._getframe(2).f_code.co_filename.startswith((_package, _numpy))


class _Names:
    """Gives operations the names that the function's variables have."""

    def __init__(self, written: Tape, file: str) -> None:
        self.written, self.file = written, file
        self.seen: Dict[Tuple[int, str], int] = {}

    def __call__(self, frame: Any, event: str, _: Any) -> Any:
        if frame.f_code.co_filename != self.file:
            return None
        if event in ("line", "return"):
            for name, value in frame.f_locals.items():
                if not isinstance(value, Traced) or value.size != 1 or value.dtype == bool:
                    continue
                node = int(value.nodes.reshape(-1)[0])
                if self.seen.get((id(frame), name)) != node:
                    self.seen[id(frame), name] = node
                    self.written.labels.setdefault(node, name)
        return self


def follow(function: Callable[..., Any], counts: Sequence[int], dtype: Any, roots: str,
           implicit: bool) -> Tuple[Tape, int, int]:
    """The list of what `function(o, d, *keys)` does to one ray, the place of its decision and that of its t. `counts`:
    how many numbers each key has."""
    written = Tape(dtype, implicit)
    before, tracer = getattr(_here, "tape", None), sys.gettrace()
    _here.tape = written
    try:
        place, arguments = 0, []
        for count in (3, 3, *counts):
            nodes = [written.add("input", place + k) for k in range(count)]
            place += count
            value = np.linspace(0.25, 0.75, count).astype(dtype)[None]
            arguments.append(Traced(value, np.array([nodes])) if count > 1 else Traced(value[:, 0], np.array(nodes)))
        names = _Names(written, function.__code__.co_filename)
        with _Creating():
            sys.settrace(names)
            try:
                answer = function(*arguments)
            finally:
                sys.settrace(tracer)
        if isinstance(answer, tuple):
            raise Unfollowed(f"{function.__name__} returns several arrays; what returns t alone is followed")
        answer = _traced(answer, dtype)
        if answer.shape != (1,):
            raise Unfollowed(f"{function.__name__} returns an array of shape {answer.shape} for one ray")
        t, valid = int(answer.nodes[0]), int(answer.valid[0])
        zero = written.add("constant", value=0.0)
        if roots == "near":
            valid = written.both(valid, written.opposite(written.add("less", t, zero)))
        if valid == ALWAYS:
            valid = written.add("less_equal", zero, zero)
        return written, valid, t
    finally:
        _here.tape = before
