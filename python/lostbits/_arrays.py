"""The caller's arrays, read in place without a copy, and the options that say what they mean."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _library as lib
from ._tables import tables_of

Floats = NDArray[Any]
ROOTS = {"both": 0, "near": 1, "first": 2, "none": 3}
_contracts = {"direction": {"any": 0, "unit": 1}, "touching": {"hit": 0, "miss": 1},
              "at_origin": {"hit": 0, "miss": 1, "exit": 2},
              "inside": {"usual": 0, "exit": 16, "zero": 32, "near": 48, "miss": 64},
              "facing": {"both": 0, "front": 256, "back": 512}}


def _shapes() -> dict[str, list[tuple[str, int]]]:
    """Keys of each shape with their counts of numbers, in the order of lostbits_plugin.h."""
    table, made = tables_of(lib.result_of("lostbits_shapes"))["shapes"], dict[str, list[tuple[str, int]]]()
    for shape, key, numbers in zip(table["shape"], table["key"], table["numbers"]):
        made.setdefault(shape, []).append((key, int(numbers)))
    return made


SHAPES = _shapes()
COUNTS = {shape: sum(count for _, count in keys) for shape, keys in SHAPES.items()}


PLURALS = {{"box": "boxes", "torus": "tori"}.get(shape, shape + "s"): shape for shape in SHAPES}


def renamed(named: dict[str, Any]) -> None:
    """Puts the keyword `solids` of earlier versions into `named` as `primitives`, with a warning."""
    if "solids" in named:
        warnings.warn("solids is called primitives now; write primitives=", DeprecationWarning, stacklevel=3)
        named["primitives"] = named.pop("solids")


def primitives_in(primitives: Any, shape: str, named: dict[str, Any]) -> tuple[Any, str]:
    """The primitives and their shape, from `primitives` and `shape` or from a keyword such as `spheres`."""
    renamed(named)
    if "primitives" in named and primitives is None:
        primitives = named.pop("primitives")
    for key in named:
        word(key, PLURALS, "a keyword for primitives")
    if len(named) + (primitives is not None) > 1:
        raise lib.InputError(f"primitives are given twice; leave out all but one of {', '.join(named)} and primitives")
    return (primitives, shape) if not named else next((value, PLURALS[key]) for key, value in named.items())


def word(value: Any, of: dict[str, Any], name: str) -> Any:
    """`of[value]`. Raises an InputError that lists the keys of `of` if `value` is not one of them."""
    if not isinstance(value, str) or value not in of:
        raise lib.InputError(f"{name} is {value!r}; it must be one of {', '.join(of)}")
    return of[value]


def contract(**words: str) -> dict[str, int]:
    """Values of direction, touching, at_origin, inside and facing in the C interface."""
    return {name: word(value, _contracts[name], name) for name, value in words.items()}


def with_article(value: Any) -> str:
    kind = type(value).__name__
    return ("an " if kind[0] in "aeiou" else "a ") + kind


def array_of(value: Any, name: str, columns: int, rows: int | None = None, kinds: str = "f") -> tuple[Any, lib.Array]:
    """The array `value`, with any strides, and its description for C: address, steps in bytes, bits of an item.

    `columns` is 0 for an array of shape (n,). Raises an InputError if the type, byte order or shape is wrong.
    """
    if value is None:
        return None, lib.Array()
    if not isinstance(value, np.ndarray):
        raise lib.InputError(f"{name} is {with_article(value)}, but a numpy array is needed; write "
                             f"np.array({name}, dtype=np.float32), or float64 (the type says in which format the "
                             "numbers were computed)")
    if value.dtype.kind not in kinds or value.dtype.itemsize not in (1, 4, 8):
        wanted = "float32 or float64" if kinds == "f" else "booleans"
        raise lib.InputError(f"{name} is an array of {value.dtype}; it must be of {wanted}")
    if not value.dtype.isnative:
        raise lib.InputError(f"{name} does not have the byte order of this machine ({value.dtype.str}); write "
                             f"{name}.astype({name}.dtype.newbyteorder('='))")
    if columns and value.ndim == 1 and rows is None and len(value) == columns:
        value = value[None]
    if value.ndim != (2 if columns else 1) or columns and value.shape[1] != columns:
        raise lib.InputError(f"{name} has shape {value.shape}; it must be "
                             f"{f'(n, {columns})' if columns else '(n,)'}")
    if rows is not None and len(value) != rows:
        raise lib.InputError(f"{name} has {len(value)} rows and o has {rows}; give one row per ray")
    return value, lib.Array(value.ctypes.data, value.strides[0], value.strides[1] if columns else 0,
                            8 * value.dtype.itemsize)


class Rays:
    """The caller's arrays as a lostbits_rays, which keeps them alive. `values[k]` is the item of `by` with code k."""

    def __init__(self, o: Any, d: Any, primitives: Any, shape: str, paired: bool = False, *, t: Any = None,
                 hit: Any = None, tmin: Any = None, tmax: Any = None, by: Any = None, matrix: Any = None,
                 open_ends: str = "none", format: str | None = None, **words: str) -> None:
        if o is None or d is None:
            raise lib.InputError("o or d is None; give both, the origins and the directions of the rays, each n x 3")
        o, origin = array_of(o, "o", 3)
        n = self.count = len(o)
        d, along = array_of(d, "d", 3, n)
        if n == 0:
            raise lib.InputError("o is empty; give at least one ray")
        self.kept = [o, d]
        meant = contract(**words)
        raw = self.raw = lib.Rays(count=n, origin=origin, direction=along, 
                                  open_ends=lib.in_utf8(open_ends, "open_ends"),
                                  format=lib.in_utf8(format, "format") if format is not None else None,
                                  unit=meant.pop("direction", 0), **meant)
        if isinstance(getattr(primitives, "handle", None), lib.Handle):  # a scene
            raw.scene, self.kept = primitives.handle.pointer, [*self.kept, primitives]
        else:
            count = word(shape, COUNTS, "shape")
            primitives, raw.primitives = array_of(primitives, "primitives", count, n if paired else None)
            if primitives is None:
                raise lib.InputError(f"primitives is None; give an array with {count} numbers per {shape}, or a scene")
            raw.shape, raw.primitive_count, raw.paired = shape.encode(), len(primitives), int(bool(paired))
            self.kept.append(primitives)
        if isinstance(matrix, np.ndarray) and matrix.ndim == 3 and matrix.shape[1:] in ((3, 4), (4, 4)):
            matrix = matrix[:, :3].reshape(len(matrix), 12)
        codes = None
        if by is not None:
            by = np.asarray(by)
            if by.shape != (n,):
                raise lib.InputError(f"by has shape {by.shape} but there are {n} rays; give one item per ray")
            try:
                self.values, codes = np.unique(by, return_inverse=True)
            except TypeError:
                raise lib.InputError("the items of by cannot be sorted; give numbers or strings") from None
            codes = codes.astype(np.float64)
        for field, value, kinds, columns in (
                ("t", t, "f", 0), ("hit", hit, "b", 0), ("tmin", tmin, "f", 0), ("tmax", tmax, "f", 0),
                ("by", codes, "f", 0), ("matrix", matrix, "f", 12)):
            value, array = array_of(value, field, columns, n, kinds)
            setattr(raw, field, array)
            self.kept.append(value)


def whole_numbers(value: Any, name: str, count: int | None = None, or_booleans: bool = False) -> Any:
    """The whole numbers of an array of shape (n,), as float64; booleans too where they are answers."""
    made = np.asarray(value)
    if made.ndim != 1 or made.dtype.kind not in ("iub" if or_booleans else "iu") or count not in (None, len(made)):
        wanted = f"{count} " if count is not None else ""
        raise lib.InputError(f"{name} must have {wanted}whole numbers{' or booleans' if or_booleans else ''}; it has "
                             f"shape {made.shape} of {made.dtype}")
    return made.astype(np.float64)


def one_per_record(kind: str, value: Any, primitive: Any, t: Any, count: int) -> tuple[Any, Any, Any, Any]:
    """Answers about a mesh as the columns of a file: values, triangles, indices of rays, and t.

    Triangles, rays and t are None if a kind does not have them. Without rays, answer i is that of ray i.

    The hits of a list become records in the order of their rays, with their hit_index from 0; a ray without a hit
    becomes one with a hit_index of -1.
    """
    if kind != "hit_index":
        if primitive is not None or t is not None:
            raise lib.InputError(f"primitive and t belong to hits; leave them out beside {kind}, or give ray")
        return whole_numbers(value, kind, count, or_booleans=True), None, None, None
    ray = whole_numbers(value, "ray").astype(np.int64)
    if primitive is None:
        raise lib.InputError("primitive is None; give the triangle of each hit, one number for each item of ray")
    primitive = whole_numbers(primitive, "primitive", len(ray))
    t = array_of(t, "t", 0)[0]
    if t is not None and len(t) != len(ray):
        raise lib.InputError(f"t has {len(t)} items and ray has {len(ray)}; give one item per hit")
    if len(ray) and not 0 <= ray.min() <= ray.max() < count:
        raise lib.InputError(f"ray has items from {ray.min()} to {ray.max()}, but there are {count} rays, from 0")
    without = np.setdiff1d(np.arange(count), ray)
    order = np.argsort(np.concatenate([ray, without]), kind="stable")
    missing = np.full(len(without), -1.0)
    first = np.searchsorted(np.sort(ray), ray)
    index = np.empty(len(ray))
    index[np.argsort(ray, kind="stable")] = np.arange(len(ray))
    values = np.concatenate([index - first, missing])[order]
    of_t = None if t is None else np.concatenate([t, np.full(len(without), np.nan, t.dtype)])[order]
    return values, np.concatenate([primitive, missing])[order], np.concatenate([ray, without])[order], of_t
