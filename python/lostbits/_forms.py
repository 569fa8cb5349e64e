"""Intersectors of one's own: a numpy function over whole batches of rays as a form among those of lostbits."""

from __future__ import annotations

import ctypes as c
import inspect
import itertools
import os
import re
import threading
import weakref
from typing import Any, Callable, Sequence, Union

import numpy as np
from numpy.typing import NDArray

from . import _library as lib
from ._arrays import ROOTS, SHAPES, Floats, Rays, contract, word
from ._follow import follow
from ._tables import Table, tables_of
from ._trace import Tape, Unfollowed

_one_thread = 4
_formats = {"f32": (32, np.float32), "f64": (64, np.float64)}
Sample = Callable[[str, Any], tuple[Floats, Floats, Floats]]


class _Failures:
    """What one's function raised, by the mark that the library's sentence about it carries: of calls that run at once,
    each raises its own. When no call runs, what nobody asked for is forgotten."""

    _marks = itertools.count(1)

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.raised: dict[int, tuple[BaseException, Any]] = {}
        self.calls = 0

    def add(self, error: BaseException) -> int:
        """Where the sentence lies that the library is given."""
        try:
            words = f"{type(error).__name__}: {error}"
        except Exception:  # of its own __str__
            words = type(error).__name__
        with self.lock:
            mark = next(self._marks)
            text = c.create_string_buffer(f"#{mark} raised {words}".encode(errors="backslashreplace")[:1000])
            self.raised[mark] = error, text
        return c.addressof(text)

    def named_in(self, sentence: str) -> BaseException | None:
        mark = re.search(r": #(\d+) raised ", sentence)
        with self.lock:
            return self.raised[int(mark[1])][0] if mark and int(mark[1]) in self.raised else None

    def begin(self) -> None:
        with self.lock:
            self.calls += 1

    def end(self) -> None:
        with self.lock:
            self.calls -= 1
            if self.calls == 0:
                self.raised.clear()


class Intersector:
    """A numpy function as a form, `py.NAME`; it can still be called as the function that it is."""

    def __init__(self, function: Callable[..., Any], shape: str, roots: str = "first", name: str | None = None,
                 **words: str) -> None:
        self.keys = word(shape, SHAPES, "shape")
        self.counts = [count for _, count in self.keys]
        if not callable(function):
            raise lib.InputError("intersector: is given to a function, as in @lb.intersector(\"sphere\")")
        self.function, self.shape, self.roots = function, shape, roots
        self.name = "py." + str(name or getattr(function, "__name__", "form"))
        wanted = 2 + len(self.keys)
        try:
            inspect.signature(function).bind(*[None] * wanted)
        except TypeError:
            raise lib.InputError(f"{self.name}: a form for a {shape} takes {wanted} arrays: o, d, "
                                 + ", ".join(key for key, _ in self.keys)) from None
        self.__doc__ = function.__doc__
        self.tapes: dict[str, Tape] = {}
        meant, promised = contract(**words), word(roots, ROOTS, "roots")
        flags = meant.pop("inside", 0) | meant.pop("facing", 0) | _one_thread
        self._asked = [lib.RunBatch(self._answering(np.dtype(dtype))) for _, dtype in _formats.values()]
        self._words = (lib.FormWords * 2)(*[
            lib.FormWords(name=lib.in_utf8(self.name, "name"), shape=list(SHAPES).index(shape), format=bits,
                          roots=promised, flags=flags, run=run, **meant)
            for (bits, _), run in zip(_formats.values(), self._asked)])
        self.handle = self._made()
        self.unlock()
        _all.add(self)

    def _made(self) -> lib.Handle:
        """The form without operations."""
        handle = lib.Handle("form")
        lib.call("lostbits_form_make", self._words, c.c_size_t(2), c.byref(handle.pointer))
        return handle

    def unlock(self) -> None:
        """Begins without calls: of a process that is forked, no other thread is here."""
        self._writing, self.failures = threading.Lock(), _Failures()

    def __call__(self, *arguments: Any) -> Any:
        return self.function(*arguments)

    def __repr__(self) -> str:
        return f"<lostbits intersector {self.name} of a {self.shape}>"

    # ---- asked by the library ----

    def _answering(self, dtype: np.dtype[Any]) -> Callable[[int], int | None]:
        def view(address: int, n: int, columns: int, of: np.dtype[Any] = dtype) -> NDArray[Any]:
            memory: Any = (c.c_char * (n * columns * of.itemsize)).from_address(address)
            return np.frombuffer(memory, dtype=of).reshape(n, columns)

        def run(address: int) -> int | None:
            b = lib.Batch.from_address(address)
            n = int(b.size)
            try:
                # Copies: the function may keep them or change them, and the library's memory is neither.
                rays = view(b.rays, n, 6).copy()
                solids = view(b.solids, n if b.solid_stride else 1, sum(self.counts)).copy()
                parts = np.split(np.broadcast_to(solids, (n, solids.shape[1])), np.cumsum(self.counts)[:-1], axis=1)
                keys = [part if part.shape[1] > 1 else part[:, 0] for part in parts]
                with np.errstate(all="ignore"):
                    answer = self.function(rays[:, :3], rays[:, 3:], *keys)
                self._put(answer, n, dtype, view(b.near_far, n, 2), view(b.hit, n, 1, np.dtype(np.uint8))[:, 0])
                return None
            except BaseException as error:  # what it raises is raised again where the call was made
                return self.failures.add(error)

        return run

    def _put(self, answer: Any, n: int, dtype: Any, near_far: NDArray[Any], hit: NDArray[Any]) -> None:
        if self.roots == "none":
            hit[:] = self._checked(answer, (n,), np.dtype(bool))
            return
        if self.roots != "both":
            answer = (answer, answer)
        elif not isinstance(answer, tuple) or len(answer) != 2:
            raise lib.InputError(f"{self.name}: roots=\"both\" returns two arrays, near and far")
        near_far[:, 0], near_far[:, 1] = (self._checked(each, (n,), dtype) for each in answer)
        hit[:] = ~np.isnan(near_far[:, 0])

    def _checked(self, array: Any, shape: tuple[int, ...], dtype: Any) -> NDArray[Any]:
        """What the function returned, held to what it must be."""
        if not isinstance(array, np.ndarray):
            raise lib.InputError(f"{self.name} returned {type(array).__name__}; return a numpy array, one item a ray: "
                                 "the function is given whole batches")
        if array.shape != shape:
            raise lib.InputError(f"{self.name} returned an array of shape {array.shape}; it is {shape}, one item a ray")
        if array.dtype != dtype:
            raise lib.InputError(f"{self.name} returned {array.dtype} where the rays are {dtype}: something in it "
                                 "computes in another type, so that it is not the arithmetic that is measured; give "
                                 "arrays of constants the type of the rays")
        return array

    # ---- its operations ----

    def write(self, sample: Sample) -> None:
        """Follows the function and says its operations to the library. `sample(shape, dtype)` gives rays (o, d,
        solids) on which the operations must give the function's own bits. Unfollowed, saying where, if they do not."""
        with self._writing:
            if self.tapes:
                return
            # A handle of its own: calls of other threads may be reading the one that there is.
            handle, tapes = self._made(), dict[str, Tape]()
            for format in _formats:
                tapes[format] = self._followed(handle, format, sample)
            self.handle, self.tapes = handle, tapes

    def _followed(self, handle: lib.Handle, format: str, sample: Sample) -> Tape:
        bits, dtype = _formats[format]
        first: str | None = None
        for implicit in (False, True):
            written, hit, t = follow(self.function, self.counts, dtype, self.roots, implicit)
            self._say(handle, bits, written, hit, t)
            wrong = self._differs(handle, format, *sample(self.shape, dtype))
            if wrong is None:
                return written
            first = first or wrong
        where = [f"{line}: `if` on any() or all() asks all rays at once; " for line in written.branches[:1]]
        raise Unfollowed("".join(where) + f"{self.name}: {first}")

    def _say(self, handle: lib.Handle, bits: int, written: Tape, hit: int, t: int) -> None:
        array = (lib.Operation * len(written.ops))(*[
            lib.Operation(op.encode(), (c.c_int32 * 3)(*operands), value, written.labels.get(i, "").encode() or None)
            for i, (op, operands, value) in enumerate(written.ops)])
        lib.call("lostbits_form_write", handle.pointer, bits, array, c.c_size_t(len(array)), c.c_int32(hit),
                 c.c_int32(t))

    def _differs(self, handle: lib.Handle, format: str, o: Floats, d: Floats, solids: Floats) -> str | None:
        """A sentence about the first ray on which the operations do not give what the function gives."""
        rays = Rays(o, d, solids, self.shape, True)
        own, said = (Asked(self, format, written=written).answers(rays, handles=[handle]) for written in (False, True))
        i = int(np.argmax((own.hit != said.hit) | ((own.t != said.t) & own.hit)))
        if own.hit[i] == said.hit[i] and (own.t[i] == said.t[i] or not own.hit[i]):
            return None
        return (f"in {format} it gives t = {own.t[i]!r} (hit: {bool(own.hit[i])}) on a ray, and the operations that "
                f"were followed give {said.t[i]!r} (hit: {bool(said.hit[i])}); something in it was not followed")


_all: weakref.WeakSet[Intersector] = weakref.WeakSet()


def _unlock_all() -> None:
    for form in list(_all):
        form.unlock()


os.register_at_fork(after_in_child=_unlock_all)


def intersector(shape: str, roots: str = "first", direction: str = "any", touching: str = "hit",
                at_origin: str = "hit", inside: str = "usual", facing: str = "both",
                name: str | None = None) -> Callable[[Callable[..., Any]], Intersector]:
    """Makes a numpy function a form that lostbits measures.

    The function is given whole batches: `o` and `d`, n x 3 (origins and directions, as the scene has them, or of length
    one with direction="unit"), and then an array for each key of the shape, n x 3 or n: sphere centre, radius; box lo,
    hi; triangle a, b, c; ellipsoid centre, radii; cylinder base, top, radius; lb.SHAPES lists all. They are of the type
    that is measured, float32 or float64, and so is what it returns: t, n items, in lengths of d, and nan where it
    misses. roots="first": the first t >= 0; "near": the smaller root, a t < 0 being a miss; "both": a tuple (near,
    far); "none": booleans. touching, at_origin, inside and facing say what is right in the cases that geometry leaves
    open, as in docs/your-own-intersector.md.

    >>> @lb.intersector("sphere", roots="near")
    ... def mine(o, d, centre, radius): ...
    """
    if callable(shape):
        raise lib.InputError("intersector: write the shape, as in @lb.intersector(\"sphere\")")
    return lambda function: Intersector(function, shape, roots, name, direction=direction, touching=touching,
                                        at_origin=at_origin, inside=inside, facing=facing)


Form = Union[str, Intersector]
Forms = Union[Form, Sequence[Form], None]
Texts = Union[str, Sequence[str]]


class Asked:
    """Forms, formats and metrics as lostbits_choice, which it keeps alive; and the calls that take one."""

    def __init__(self, forms: Forms, formats: Texts, metrics: Texts = (), rows: bool = False,
                 written: bool = False) -> None:
        single = isinstance(forms, str) or callable(forms)
        listed: list[Any] = [] if forms is None else [forms] if single else lib.texts(forms, "forms")
        for form in listed:
            if callable(form) and not isinstance(form, Intersector):
                raise lib.InputError(f"{getattr(form, '__name__', form)!r} is a function; say what it meets first: "
                                     "@lb.intersector(\"sphere\")")
            if not isinstance(form, (str, Intersector)):
                raise lib.InputError(f"a form is a name such as \"sphere.unified\" or an intersector, not "
                                     f"{type(form).__name__}")
        self.own = [form for form in listed if isinstance(form, Intersector)]
        self.names = [form for form in listed if isinstance(form, str)]
        self.formats, self.metrics = lib.texts(formats, "formats"), lib.texts(metrics, "metrics")
        words = [lib.Words(each, name) for each, name in
                 ((self.names, "forms"), (self.formats, "formats"), (self.metrics, "metrics"))]
        self.raw = lib.Choice(words[0], None, len(self.own), *words[1:], int(bool(rows)), int(bool(written)))
        self._kept = words

    def write_for(self, sample: Sample, always: bool = False) -> None:
        """The operations of one's own forms, where something is asked that needs them."""
        plain = all(format in _formats for format in self.formats)
        if always or not plain or any(not m.startswith(("tolerance:", "enough_bits:")) for m in self.metrics):
            for form in self.own:
                form.write(sample)

    def call(self, name: str, *arguments: Any, quick: bool = False, handles: Sequence[lib.Handle] | None = None,
             **how: Any) -> tuple[int, lib.Handle]:
        """A call that takes this choice behind its own arguments; what a function of the user's raised is raised.

        `handles`: of one's own forms, where they are not those that the forms have now."""
        held = [form.handle for form in self.own] if handles is None else handles
        pointers = (c.c_void_p * len(held))(*[handle.pointer for handle in held])
        self.raw.own = c.cast(pointers, c.c_void_p)
        for form in self.own:
            form.failures.begin()
        try:
            if quick:
                return 0, lib.result_of(name, *arguments, c.byref(self.raw))
            return lib.long_call(name, *arguments, c.byref(self.raw), **how)
        except lib.Error as error:
            for form in self.own:
                if (raised := form.failures.named_in(str(error))) is not None:
                    raise raised from None
            raise
        finally:
            for form in self.own:
                form.failures.end()

    def answers(self, rays: Rays, **how: Any) -> Table:
        return next(iter(tables_of(self.call("lostbits_answers", c.byref(rays.raw), **how)[1]).values()))
