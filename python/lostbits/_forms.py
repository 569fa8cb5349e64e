"""Intersectors of one's own: a numpy function over whole batches of rays as a form among those of lostbits."""

from __future__ import annotations

import ctypes as c
import inspect
from typing import Any, Callable, Dict, List, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import NDArray

from . import _library as lib
from ._follow import follow
from ._trace import Tape, Unfollowed

# Of lostbits_plugin.h: the shapes in their order, with how many numbers each key has.
SHAPES: Dict[str, Tuple[Tuple[str, int], ...]] = {
    "sphere": (("centre", 3), ("radius", 1)),
    "box": (("lo", 3), ("hi", 3)),
    "triangle": (("a", 3), ("b", 3), ("c", 3)),
    "ellipsoid": (("centre", 3), ("radii", 3)),
    "cylinder": (("base", 3), ("top", 3), ("radius", 1)),
    "capsule": (("start", 3), ("end", 3), ("radius", 1)),
    "tube": (("bottom", 3), ("top", 3), ("radius", 1)),
    "cone": (("base", 3), ("top", 3), ("base_radius", 1), ("top_radius", 1)),
    "disc": (("centre", 3), ("normal", 3), ("outer_radius", 1), ("inner_radius", 1)),
    "plane": (("through", 3), ("normal", 3)),
}
ROOTS = {"both": 0, "near": 1, "first": 2, "none": 3}
YES_NO = {"hit": 0, "miss": 1, "exit": 2}
INSIDE = {"usual": 0, "exit": 16, "zero": 32, "near": 48, "miss": 64}
_one_thread = 4


def word(value: str, of: Dict[str, Any], name: str) -> Any:
    """What a word stands for, or a sentence about the words there are."""
    if value not in of:
        raise lib.InputError(f"{name} is {value!r}; it is one of {', '.join(of)}")
    return of[value]


class Intersector:
    """A numpy function as a form, `py.NAME`; it can still be called as the function that it is."""

    def __init__(self, function: Callable[..., Any], shape: str, roots: str = "first", direction: str = "any",
                 touching: str = "hit", at_origin: str = "hit", inside: str = "usual",
                 name: Optional[str] = None) -> None:
        if not callable(function):
            raise lib.InputError("intersector: is given to a function, as in @lb.intersector(\"sphere\")")
        self.keys = word(shape, SHAPES, "shape")
        self.function, self.shape, self.roots = function, shape, roots
        own_name = str(name or getattr(function, "__name__", "form"))
        self.name = "py." + own_name
        wanted = 2 + len(self.keys)
        try:
            inspect.signature(function).bind(*[None] * wanted)
        except TypeError:
            raise lib.InputError(f"{self.name}: a form for a {shape} takes {wanted} arrays: o, d, "
                                 + ", ".join(key for key, _ in self.keys)) from None
        self.__doc__ = function.__doc__
        self.failed: Optional[BaseException] = None
        self.tapes: Dict[int, Tape] = {}
        self.why_not: Optional[Exception] = None
        self._kept: List[Any] = []
        words = []
        for bits, dtype in ((32, np.float32), (64, np.float64)):
            run = lib.RunBatch(self._answering(dtype))
            words.append(lib.FormWords(
                self.name.encode(), None, None, list(SHAPES).index(shape), bits,
                word(direction, {"any": 0, "unit": 1}, "direction"), word(roots, ROOTS, "roots"),
                word(touching, {"hit": 0, "miss": 1}, "touching"), word(at_origin, YES_NO, "at_origin"),
                word(inside, INSIDE, "inside") | _one_thread, None, run))
            self._kept.append(run)
        array = (lib.FormWords * 2)(*words)
        self.handle = lib.Handle("form")
        lib.call("lostbits_form_make", array, c.c_size_t(2), c.byref(self.handle.pointer))

    def __call__(self, *arguments: Any) -> Any:
        return self.function(*arguments)

    def __repr__(self) -> str:
        return f"<lostbits intersector {self.name} of a {self.shape}>"

    # ---- asked by the library ----

    def _answering(self, dtype: Any) -> Callable[[Any], Optional[int]]:
        size = np.dtype(dtype).itemsize
        numbers = sum(count for _, count in self.keys)

        def view(address: int, shape: Tuple[int, ...]) -> NDArray[Any]:
            bytes_ = int(np.prod(shape)) * size
            memory: Any = (c.c_char * bytes_).from_address(address)
            array: NDArray[Any] = np.frombuffer(memory, dtype=dtype).reshape(shape)
            return array

        def run(batch: Any) -> Optional[int]:
            b = batch.contents
            n = int(b.size)
            try:
                rays = view(b.rays, (n, 6))
                solids = view(b.solids, (n if b.solid_stride else 1, numbers))
                keys, place = [], 0
                for _, count in self.keys:
                    part = solids[:, place] if count == 1 else solids[:, place:place + count]
                    keys.append(np.broadcast_to(part, (n,) if count == 1 else (n, count)))
                    place += count
                with np.errstate(all="ignore"):
                    answer = self.function(rays[:, :3], rays[:, 3:], *keys)
                self._put(answer, n, np.dtype(dtype), view(b.near_far, (n, 2)),
                          np.ctypeslib.as_array(c.cast(b.hit, c.POINTER(c.c_ubyte)), (n,)))
                return None
            except BaseException as error:  # what it raises is raised again where the call was made
                self.failed = self.failed or error
                self._kept.append(c.create_string_buffer(f"raised {type(error).__name__}: {error}".encode()[:1000]))
                return c.addressof(self._kept[-1])

        return run

    def _put(self, answer: Any, n: int, dtype: Any, near_far: NDArray[Any], hit: NDArray[Any]) -> None:
        if self.roots == "none":
            hits = checked(answer, (n,), np.dtype(bool), f"{self.name} returned")
            hit[:] = hits
            return
        if self.roots == "both":
            if not isinstance(answer, tuple) or len(answer) != 2:
                raise lib.InputError(f"{self.name}: roots=\"both\" returns two arrays, near and far")
        else:
            answer = (answer, answer)
        near, far = (checked(a, (n,), dtype, f"{self.name} returned") for a in answer)
        hit[:] = ~np.isnan(near)
        near_far[:, 0], near_far[:, 1] = near, far

    def raise_own(self) -> None:
        """What the function itself raised, where it did."""
        failed, self.failed = self.failed, None
        if failed is not None:
            raise failed

    # ---- its operations ----

    def write(self, sample: Callable[[Any], Tuple[NDArray[Any], ...]]) -> None:
        """Follows the function and says its operations to the library. `sample(dtype)` gives rays (o, d, solids) on
        which the operations must give the function's own bits. Unfollowed, which says where, if they do not."""
        if self.tapes:
            return
        counts = [count for _, count in self.keys]
        for bits, dtype in ((32, np.float32), (64, np.float64)):
            first: Optional[str] = None
            for implicit in (False, True):
                written, hit, t = follow(self.function, counts, dtype, self.roots, implicit)
                self._say(bits, written, hit, t)
                wrong = self._differs(bits, sample(dtype))
                if wrong is None:
                    self.tapes[bits] = written
                    break
                first = first or wrong
            else:
                self.tapes.clear()
                raise Unfollowed(f"{self.name}: {first}")

    def _say(self, bits: int, written: Tape, hit: int, t: int) -> None:
        array = (lib.Operation * len(written.ops))()
        for i, (op, operands, value) in enumerate(written.ops):
            label = written.labels.get(i)
            array[i] = lib.Operation(op.encode(), (c.c_int32 * 3)(*operands), value,
                                     None if label is None else label.encode())
        lib.call("lostbits_form_write", self.handle.pointer, bits, array, c.c_size_t(len(array)), c.c_int32(hit),
                 c.c_int32(t))

    def _differs(self, bits: int, sample: Tuple[NDArray[Any], ...]) -> Optional[str]:
        from ._measure import ask

        o, d, solids = sample
        form = "f32" if bits == 32 else "f64"
        own = ask(self, o, d, solids, shape=self.shape, format=form, paired=True)
        said = ask(self, o, d, solids, shape=self.shape, format=form, paired=True, written=True)
        same = (own.hit == said.hit) & ((own.t == said.t) | ~own.hit)
        if same.all():
            return None
        i = int(np.flatnonzero(~same)[0])
        return (f"in {form} it gives t = {own.t[i]!r} (hit: {bool(own.hit[i])}) on a ray, and the operations that were "
                f"followed give {said.t[i]!r} (hit: {bool(said.hit[i])}); something in it was not followed")


def checked(array: Any, shape: Tuple[int, ...], dtype: Any, who: str) -> NDArray[Any]:
    """What a function returned, held to what it must be."""
    if not isinstance(array, np.ndarray):
        raise lib.InputError(f"{who} {type(array).__name__}; return a numpy array, one item a ray: the function is "
                             "given whole batches")
    if array.shape != shape:
        raise lib.InputError(f"{who} an array of shape {array.shape}; it is {shape}, one item a ray")
    if array.dtype != dtype:
        raise lib.InputError(f"{who} {array.dtype} where the rays are {dtype}: something in it computes in another "
                             "type, so that it is not the arithmetic that is measured; give arrays of constants the "
                             "type of the rays")
    return array


def intersector(shape: str, roots: str = "first", direction: str = "any", touching: str = "hit",
                at_origin: str = "hit", inside: str = "usual",
                name: Optional[str] = None) -> Callable[[Callable[..., Any]], Intersector]:
    """Makes a numpy function a form that lostbits measures.

    The function is given whole batches: `o` and `d`, n x 3 (origins and directions, as the scene has them, or of length
    one with direction="unit"), and then an array for each key of the shape, n x 3 or n: sphere centre, radius; box lo,
    hi; triangle a, b, c; ellipsoid centre, radii; cylinder base, top, radius; capsule start, end, radius. All are of
    the type that is measured, float32 or float64, and so is what it returns: t, n items, in lengths of d, and nan where
    it misses. roots="first": the first t >= 0; "near": the smaller root, a t < 0 being a miss; "both": a tuple (near,
    far); "none": booleans. touching, at_origin and inside say what is right in the cases that geometry leaves open, as
    in docs/your-own-intersector.md.

    >>> @lb.intersector("sphere", roots="near")
    ... def mine(o, d, centre, radius): ...
    """
    if callable(shape):
        raise lib.InputError("intersector: write the shape, as in @lb.intersector(\"sphere\")")

    def make(function: Callable[..., Any]) -> Intersector:
        return Intersector(function, shape, roots, direction, touching, at_origin, inside, name)

    return make


Form = Union[str, Intersector]


def forms_of(forms: Union[Form, Sequence[Form], None]) -> Tuple[List[Intersector], List[str]]:
    """Forms of one's own, and the names of others."""
    if forms is None:
        return [], []
    if isinstance(forms, (str, Intersector)) or callable(forms):
        forms = [forms]  # type: ignore[list-item]
    own: List[Intersector] = []
    names: List[str] = []
    for form in forms:
        if isinstance(form, Intersector):
            own.append(form)
        elif isinstance(form, str):
            names.append(form)
        elif callable(form):  # a function without its decorator
            raise lib.InputError(f"{getattr(form, '__name__', form)!r} is a function; say what it meets first: "
                                 "@lb.intersector(\"sphere\")")
        else:
            raise lib.InputError(f"a form is a name such as \"sphere.unified\" or an intersector, not "
                                 f"{type(form).__name__}")
    return own, names
