"""Follows sums, in numpy's own order, and the numpy functions that are made of operations or only move items."""

from __future__ import annotations

import functools
from typing import Any, Callable

import numpy as np

from ._trace import Traced, elementwise, fail, known, tape, traced


_orders: dict[Any, Any] = {}
_numbers = np.random.default_rng(1).random(1 << 14)
_candidates: dict[int, dict[str, Callable[[Any, Any], Any]]] = {
    3: {"in order": lambda p, add: add(add(p[0], p[1]), p[2]),
        "last pair first": lambda p, add: add(p[0], add(p[1], p[2])),
        "ends first": lambda p, add: add(add(p[0], p[2]), p[1])},
    2: {"in order": lambda p, add: add(p[0], p[1])},
    4: {"in order": lambda p, add: add(add(add(p[0], p[1]), p[2]), p[3]),
        "pairs": lambda p, add: add(add(p[0], p[1]), add(p[2], p[3])),
        "crossed pairs": lambda p, add: add(add(p[0], p[2]), add(p[1], p[3]))},
}


def _random(shape: tuple[int, ...], which: int = 0) -> Any:
    """Random numbers of many rays, whose sums differ by their order. Each `which` gives other numbers."""
    many = (64, *shape[1:]) if shape and shape[0] == 1 else shape
    return np.roll(_numbers, 4111 * which)[:int(np.prod(many))].reshape(many).astype(tape().dtype)


def _random_vectors(length: int, which: int = 0) -> Any:
    """64 random vectors, for sums of a single one: the sum of one alone has the same bits in several orders."""
    return _random((64, length), which)


_plus: Callable[[Any, Any], Traced] = lambda x, y: elementwise(np.add, [x, y])


def _order(key: Any, terms: int, ask: Callable[[], tuple[Any, list[Any]]]) -> Any:
    """The order in which numpy adds: the candidate that gives the same bits as numpy on random numbers.

    `ask()` returns numpy's result for such numbers, and their terms.
    """
    if key not in _orders:
        if terms == 1:
            return lambda p, add: p[0]
        found, parts = ask()
        for name, order in _candidates.get(terms, {}).items():
            if np.array_equal(order(parts, np.add), found):
                _orders[key] = order
                break
        else:
            raise fail(f"numpy adds {terms} terms here in an order, or with roundings, that lostbits does not know; "
                       "write the sum out with +")
    return _orders[key]


def _reduce(ufunc: Any, array: Any, axis: Any = None, keepdims: Any = False, dtype: Any = None, out: Any = None,
            initial: Any = None, **_: Any) -> Traced:
    array, name = traced(array, None), ufunc.__name__
    if out is not None or initial is not None and initial is not getattr(np, "_NoValue", None):
        raise fail(f"np.{name}.reduce with out= or initial= is not followed; leave them out")
    if name in ("logical_or", "logical_and") and (axis is None or axis == 0) and array.ndim == 1:
        made = Traced(np.array(name == "logical_or"), np.array(0))
        made.of_batch = True
        return made
    if axis is None and array.ndim != 1 or isinstance(axis, tuple) and len(axis) != 1:
        raise fail(f"np.{name}.reduce over several axes at once is not followed; name one axis")
    at = (axis[0] if isinstance(axis, tuple) else 0 if axis is None else axis) % array.ndim
    if at == 0 and array.shape[0] == 1 and array.ndim > 1:
        raise fail("a sum, minimum or maximum over all rays is not followed: lostbits runs each ray by itself")
    parts = [array[(slice(None),) * at + (k,)] for k in range(array.shape[at])]
    combine: Any = lambda x, y: elementwise(ufunc, [x, y])
    if name == "add":
        def ask() -> tuple[Any, list[Any]]:
            if array.ndim == 1:
                vectors = _random_vectors(len(parts))
                return np.array([np.add.reduce(v) for v in vectors]), list(vectors.T)
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
        raise fail("np.einsum is followed for two arrays and without optimize=; write it so")
    spec = subscripts.replace(" ", "")
    left, _, result = spec.partition("->")
    names = left.split(",")
    if not result or "..." in spec and not all(n.startswith("...") for n in names):
        raise fail("np.einsum without ->, or with ... elsewhere than in front, is not followed; write 'ij,ij->i'")
    summed = [s for s in dict.fromkeys(names[0] + names[1]) if s not in result and s != "."]
    a, b = (traced(x, tape().dtype) for x in operands)
    if len(summed) != 1 or any(n.count(summed[0]) != 1 for n in names):
        raise fail("np.einsum is followed only if it sums over one letter, which both arrays have once, as in "
                   "'ij,ij->i'")
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

    def ask() -> tuple[Any, list[Any]]:
        x, y = _random(a.shape), _random(b.shape, 1)
        return np.einsum(spec, x, y), [items(x, 0, k) * items(y, 1, k) for k in range(a.shape[axes[0]])]

    order = _order((spec, a.shape, b.shape, tape().dtype), a.shape[axes[0]], ask)
    parts = [items(a, 0, k) * items(b, 1, k) for k in range(a.shape[axes[0]])]
    return order(parts, _plus)  # type: ignore[no-any-return]


def _product(function: Any, a: Any, b: Any) -> Traced:
    """np.dot, np.inner and np.matmul with a vector as the second argument."""
    a, b = traced(a, tape().dtype), traced(b, tape().dtype)
    if a.ndim == 0 or b.ndim == 0:
        return a * b  # type: ignore[no-any-return]
    if b.ndim != 1:
        raise fail(f"np.{function.__name__} with a matrix as the second argument is not followed; write "
                   "np.einsum('ij,ij->i', a, b)")

    def ask() -> tuple[Any, list[Any]]:
        if a.ndim == 1:  # BLAS sums single vectors: OpenBLAS adds products of floats in double
            x, y = _random_vectors(len(a)), _random_vectors(len(b), 1)
            return np.array([function(v, w) for v, w in zip(x, y)]), list((x * y).T)
        x, y = _random(a.shape), _random(b.shape, 1)
        return function(x, y), [x[..., k] * y[k] for k in range(len(y))]

    order = _order((function.__name__, a.shape, b.shape, tape().dtype), len(b), ask)
    return order([a[..., k] * b[k] for k in range(len(b))], _plus)  # type: ignore[no-any-return]


def _cross(a: Any, b: Any, axisa: int = -1, axisb: int = -1, axisc: int = -1, axis: Any = None) -> Traced:
    if axis not in (None, -1) or (axisa, axisb, axisc) != (-1, -1, -1):
        raise fail("np.cross is followed only along the last axis; leave its axes out")
    a, b = traced(a, tape().dtype), traced(b, tape().dtype)
    p, q = ([v[..., k] for k in range(3)] for v in (a, b))
    return _moved(np.stack)([p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]], axis=-1)


def _norm(x: Any, ord: Any = None, axis: Any = None, keepdims: bool = False) -> Traced:
    if ord not in (None, 2) or axis is None:
        raise fail("np.linalg.norm is followed only for the length along one axis; write norm(x, axis=-1)")
    return elementwise(np.sqrt, [_reduce(np.add, x * x, axis, keepdims)])


def _moved(function: Any) -> Callable[..., Traced]:
    """Follows a function that only moves items, on an array or a list of arrays."""

    def run(first: Any, *arguments: Any, **options: Any) -> Traced:
        several = isinstance(first, (list, tuple))
        parts = [traced(x, tape().dtype) for x in (first if several else [first])]

        def moved(what: str) -> Any:
            arrays = [getattr(p, what) for p in parts]
            return function(arrays if several else arrays[0], *arguments, **options)

        return Traced(moved("value"), moved("nodes"), moved("valid"))

    return run


CREATED = {"zeros": 0, "empty": 0, "ones": 1}  # the value that np.NAME fills an array with


def filled(shape: Any, value: Any) -> Traced:
    made = traced(value, tape().dtype)
    return Traced(np.full(shape, made.value, dtype=tape().dtype), np.full(shape, made.nodes),
                  np.full(shape, made.valid))


def _clip(a: Any, low: Any = None, high: Any = None, **_: Any) -> Traced:
    a = a if low is None else np.maximum(a, low)
    return a if high is None else np.minimum(a, high)  # type: ignore[no-any-return]


known.update({
    "reduce": _reduce, np.einsum: _einsum, np.cross: _cross, np.linalg.norm: _norm, np.clip: _clip,
    np.shape: lambda a: a.shape, np.ndim: lambda a: a.ndim, np.size: lambda a: a.size,
    np.full_like: lambda a, fill_value, **o: filled(o.get("shape") or a.shape, fill_value),
})
for _function in (np.matmul, np.dot, np.inner):
    known[_function] = functools.partial(_product, _function)
for _name, _ufunc in (("sum", np.add), ("min", np.minimum), ("max", np.maximum), ("amin", np.minimum),
                      ("amax", np.maximum), ("any", np.logical_or), ("all", np.logical_and)):
    known[getattr(np, _name)] = functools.partial(_reduce, _ufunc)
for _name, _value in CREATED.items():
    known[getattr(np, _name + "_like")] = functools.partial(known[np.full_like], fill_value=_value)
for _name in ("stack", "concatenate", "moveaxis", "transpose", "reshape", "squeeze", "expand_dims", "broadcast_to",
              "copy", "swapaxes", "atleast_1d", "atleast_2d", "ravel", "take", "roll", "flip", "vstack",
              "column_stack"):
    known[getattr(np, _name)] = _moved(getattr(np, _name))
