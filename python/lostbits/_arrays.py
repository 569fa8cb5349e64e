"""Arrays of one's own, read where they lie, and what a call chooses and raises."""

from __future__ import annotations

import ctypes as c
from typing import Any, Optional, Sequence, Tuple

import numpy as np
from numpy.typing import NDArray

from . import _library as lib
from ._forms import INSIDE, SHAPES, YES_NO, Intersector, word

Floats = NDArray[Any]
COUNTS = {shape: sum(count for _, count in keys) for shape, keys in SHAPES.items()}


class HasScene:
    """Something with the handle of a scene."""

    handle: lib.Handle


def array_of(value: Any, name: str, columns: int, rows: Optional[int] = None,
             kinds: str = "f") -> Tuple[Any, lib.Array]:
    """An array of one's own, whatever its strides, and how C finds its items. A sentence for what it cannot be."""
    if value is None:
        return None, lib.Array()
    if not isinstance(value, np.ndarray):
        raise lib.InputError(f"{name} is {with_article(value)}; write np.array({name}, dtype=np.float32) or float64: "
                             "the type says which arithmetic is meant")
    if value.dtype.kind not in kinds or value.dtype.itemsize not in (1, 4, 8):
        wanted = "float32 or float64" if kinds == "f" else "booleans"
        raise lib.InputError(f"{name} is an array of {value.dtype}; it is of {wanted}")
    if not value.dtype.isnative:
        raise lib.InputError(f"{name} has its bytes in the other order ({value.dtype.str}); write "
                             f"{name}.astype({name}.dtype.newbyteorder('='))")
    wanted_shape = "n" if columns == 0 else f"n x {columns}"
    if columns and value.ndim == 1 and rows is None and len(value) == columns:
        value = value[None]
    if value.ndim != (2 if columns else 1) or columns and value.shape[1] != columns:
        raise lib.InputError(f"{name} has shape {value.shape}; it is {wanted_shape}")
    if rows is not None and len(value) != rows:
        raise lib.InputError(f"{name} has {len(value)} rows and o has {rows}; there is one a ray")
    return value, lib.Array(value.ctypes.data, value.strides[0], value.strides[1] if columns else 0,
                            8 * value.dtype.itemsize)


def with_article(value: Any) -> str:
    kind = type(value).__name__
    return ("an " if kind[0] in "aeiou" else "a ") + kind


class Rays:
    """Arrays as lostbits_rays; it keeps them alive."""

    def __init__(self, o: Any, d: Any, solids: Any, shape: str, t: Any = None, hit: Any = None, tmin: Any = None,
                 tmax: Any = None, paired: bool = False, format: Optional[str] = None, direction: str = "any",
                 touching: str = "hit", at_origin: str = "hit", inside: str = "usual") -> None:
        o, origin = array_of(o, "o", 3)
        n = len(o) if o is not None else 0
        if o is None or d is None:
            raise lib.InputError("o and d are the origins and directions of rays, n x 3; give both")
        d, along = array_of(d, "d", 3, n)
        if n == 0:
            raise lib.InputError("o is empty: there are no rays to ask about")
        self.kept = [o, d]
        raw = lib.Rays(count=n, origin=origin, direction=along)
        if isinstance(solids, HasScene):
            raw.scene, self.kept = solids.handle.pointer, [*self.kept, solids]
        else:
            count = word(shape, COUNTS, "shape")
            solids, raw.solids = array_of(solids, "solids", count, n if paired else None)
            if solids is None:
                raise lib.InputError(f"solids is None; give an array of {count} numbers a {shape}, or a scene")
            raw.shape, raw.solid_count, raw.paired = shape.encode(), len(solids), int(paired)
            self.kept.append(solids)
        if t is not None and hit is None and isinstance(t, np.ndarray) and t.dtype.kind == "f" and (t < 0).any():
            raise lib.InputError("t has numbers below 0, which may be misses or hits; say which by hit=t >= 0")
        for field, value, kinds in (("t", t, "f"), ("hit", hit, "b"), ("tmin", tmin, "f"), ("tmax", tmax, "f")):
            value, array = array_of(value, field, 0, n, kinds)
            setattr(raw, field, array)
            self.kept.append(value)
        raw.format = format.encode() if format else None
        raw.unit = word(direction, {"any": 0, "unit": 1}, "direction")
        raw.touching = word(touching, {"hit": 0, "miss": 1}, "touching")
        raw.at_origin, raw.inside = word(at_origin, YES_NO, "at_origin"), word(inside, INSIDE, "inside")
        self.raw, self.count = raw, n


def choice_of(own: Sequence[Intersector], names: Sequence[str], formats: Sequence[str], metrics: Sequence[str] = (),
            rows: bool = False, written: bool = False) -> lib.Choice:
    handles = (c.c_void_p * len(own))(*[form.handle.pointer for form in own])
    formats = [formats] if isinstance(formats, str) else formats
    metrics = [metrics] if isinstance(metrics, str) else metrics
    texts = [lib.words(list(each)) for each in (names, formats, metrics)]
    made = lib.Choice(texts[0], c.cast(handles, c.POINTER(c.c_void_p)), len(own), texts[1], texts[2], int(rows),
                      int(written))
    made.kept = (handles, texts, own)
    return made


def measured(name: str, *arguments: Any, own: Sequence[Intersector] = (), **how: Any) -> Tuple[int, lib.Handle]:
    """A long call; what a function of the user's raised on the way is raised here."""
    try:
        return lib.long_call(name, *arguments, **how)
    except lib.Error:
        for form in own:
            form.raise_own()
        raise
