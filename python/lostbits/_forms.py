"""Intersectors of the user: makes a numpy function over whole batches of rays a form beside those of lostbits."""

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
from ._wrap import of_batches, refuse_marks, with_miss

_one_thread = 4
_formats = {"f32": (32, np.float32), "f64": (64, np.float64)}
Sample = Callable[[str, Any], tuple[Floats, Floats, Floats]]


class _Failures:
    """Exceptions of the user's function, each under a mark that the library's error message repeats.

    The mark lets each of several concurrent calls raise its own exception. When no call runs, the rest is dropped.
    """

    _marks = itertools.count(1)

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.raised: dict[int, tuple[BaseException, Any]] = {}
        self.calls = 0

    def add(self, error: BaseException) -> int:
        """Stores an exception. Returns the address of the message that the library is given."""
        try:
            words = f"{type(error).__name__}: {error}"
        except Exception:  # raised by its own __str__
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
    """A numpy function as the form `py.NAME`. It can still be called as a plain function."""

    def __init__(self, function: Callable[..., Any], shape: str, roots: str = "first", name: str | None = None,
                 miss: float | None = None, per_ray: bool = False, **words: str) -> None:
        self.keys = word(shape, SHAPES, "shape")
        self.counts = [count for _, count in self.keys]
        if not callable(function):
            raise lib.InputError("intersector: what it decorates is not a function; write @lb.intersector(\"sphere\") "
                                 "above a function")
        self.function, self.shape, self.roots = function, shape, roots
        self.name = "py." + str(name or getattr(function, "__name__", "form"))
        wanted = 2 + len(self.keys)
        try:
            inspect.signature(function).bind(*[None] * wanted)
        except TypeError:
            raise lib.InputError(f"{self.name}: a form for a {shape} takes {wanted} arrays: o, d, "
                                 + ", ".join(key for key, _ in self.keys)) from None
        self.__doc__ = function.__doc__
        self._batch = of_batches(function, self.name) if per_ray else function
        if miss is not None and not np.isnan(lib.number(miss, "miss")):
            self._batch = with_miss(self._batch, miss)
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
        """Makes the form without its operations."""
        handle = lib.Handle("form")
        lib.call("lostbits_form_make", self._words, c.c_size_t(2), c.byref(handle.pointer))
        return handle

    def unlock(self) -> None:
        """Starts without running calls, as after a fork, which keeps no other thread."""
        self._writing, self.failures = threading.Lock(), _Failures()

    def __call__(self, *arguments: Any) -> Any:
        return self.function(*arguments)

    def __repr__(self) -> str:
        return f"<lostbits intersector {self.name} of a {self.shape}>"

    # ---- called by the library ----

    def _answering(self, dtype: np.dtype[Any]) -> Callable[[int], int | None]:
        def view(address: int, n: int, columns: int, of: np.dtype[Any] = dtype) -> NDArray[Any]:
            memory: Any = (c.c_char * (n * columns * of.itemsize)).from_address(address)
            return np.frombuffer(memory, dtype=of).reshape(n, columns)

        def run(address: int) -> int | None:
            b = lib.Batch.from_address(address)
            n = int(b.size)
            try:
                # Copies, since the function may keep or change its arrays. The library's memory allows neither.
                rays = view(b.rays, n, 6).copy()
                primitives = view(b.primitives, n if b.primitive_stride else 1, sum(self.counts)).copy()
                wide = np.broadcast_to(primitives, (n, primitives.shape[1]))
                parts = np.split(wide, np.cumsum(self.counts)[:-1], axis=1)
                keys = [part if part.shape[1] > 1 else part[:, 0] for part in parts]
                with np.errstate(all="ignore"):
                    answer = self._batch(rays[:, :3], rays[:, 3:], *keys)
                self._put(answer, n, dtype, view(b.near_far, n, 2), view(b.hit, n, 1, np.dtype(np.uint8))[:, 0])
                return None
            except BaseException as error:  # raised again by the call that asked the library
                return self.failures.add(error)

        return run

    def _put(self, answer: Any, n: int, dtype: Any, near_far: NDArray[Any], hit: NDArray[Any]) -> None:
        if self.roots == "none":
            hit[:] = self._checked(answer, (n,), np.dtype(bool))
            return
        if self.roots != "both":
            answer = (answer, answer)
        elif not isinstance(answer, tuple) or len(answer) != 2:
            raise lib.InputError(f"{self.name}: with roots=\"both\", return a tuple of two arrays, (near, far)")
        near, far = (self._checked(each, (n,), dtype) for each in answer)
        refuse_marks(near, self.roots, self.name)
        near_far[:, 0], near_far[:, 1] = near, far
        hit[:] = ~np.isnan(near_far[:, 0])

    def _checked(self, array: Any, shape: tuple[int, ...], dtype: Any) -> NDArray[Any]:
        """The array that the function returned. Raises an InputError if it has another kind, shape or type."""
        if not isinstance(array, np.ndarray):
            raise lib.InputError(f"{self.name} returned {type(array).__name__}; the function gets whole batches of "
                                 "rays, so return a numpy array with one item per ray")
        if array.shape != shape:
            raise lib.InputError(f"{self.name} returned an array of shape {array.shape}; it must have shape {shape}, "
                                 "one item per ray")
        if array.dtype != dtype:
            raise lib.InputError(f"{self.name} returned {array.dtype} where the rays are {dtype}: something in the "
                                 "function computes in another type, so the wrong arithmetic would be measured; give "
                                 "arrays of constants the type of the rays (dtype=o.dtype)")
        return array

    # ---- its operations ----

    def write(self, sample: Sample) -> None:
        """Follows the function and gives its operations to the library.

        `sample(shape, dtype)` returns rays (o, d, primitives). On these the operations must give the same bits as the
        function; otherwise Unfollowed is raised, with the reason.
        """
        with self._writing:
            if self.tapes:
                return
            # A new handle, since calls of other threads may be reading the current one.
            handle, tapes = self._made(), dict[str, Tape]()
            for format in _formats:
                tapes[format] = self._followed(handle, format, sample)
            self.handle, self.tapes = handle, tapes

    def _followed(self, handle: lib.Handle, format: str, sample: Sample) -> Tape:
        bits, dtype = _formats[format]
        first: str | None = None
        for implicit in (False, True):
            written, hit, t = follow(self._batch, self.counts, dtype, self.roots, implicit)
            self._say(handle, bits, written, hit, t)
            wrong = self._differs(handle, format, *sample(self.shape, dtype))
            if wrong is None:
                return written
            first = first or wrong
        where = [f"{line}: `if` on any() or all() decides for all rays at once; " for line in written.branches[:1]]
        raise Unfollowed("".join(where) + f"{self.name}: {first}")

    def _say(self, handle: lib.Handle, bits: int, written: Tape, hit: int, t: int) -> None:
        array = (lib.Operation * len(written.ops))(*[
            lib.Operation(op.encode(), (c.c_int32 * 3)(*operands), value, written.labels.get(i, "").encode() or None)
            for i, (op, operands, value) in enumerate(written.ops)])
        lib.call("lostbits_form_write", handle.pointer, bits, array, c.c_size_t(len(array)), c.c_int32(hit),
                 c.c_int32(t))

    def _differs(self, handle: lib.Handle, format: str, o: Floats, d: Floats, primitives: Floats) -> str | None:
        """A message about the first ray on which the operations and the function differ, or None."""
        rays = Rays(o, d, primitives, self.shape, True)
        own, said = (Asked(self, format, written=written).answers(rays, handles=[handle]) for written in (False, True))
        i = int(np.argmax((own.hit != said.hit) | ((own.t != said.t) & own.hit)))
        if own.hit[i] == said.hit[i] and (own.t[i] == said.t[i] or not own.hit[i]):
            return None
        return (f"in {format} the function gives t = {own.t[i]!r} (hit: {bool(own.hit[i])}) on a ray, but the recorded "
                f"operations give {said.t[i]!r} (hit: {bool(said.hit[i])}); some operation was not recorded")


class Function(Intersector):
    """A function in a file of C, C++, Rust, GLSL, HLSL, SPIR-V or LLVM IR as it stands: the form `function.NAME`.

    `.signature` says what its arguments are taken for. `words` overrides it, as in `"sphere(o, d, c, r), miss = -1"`
    (docs/your-function.md). Raises InputError for a file that does not compile and for what cannot be followed.

    >>> lb.explain(lb.function("scene.c", "hit_sphere"), "rtg-fig-7-3-4100-oblique", pixel=(128, 128))
    """

    def __init__(self, file: str, name: str, words: str = "") -> None:
        self.handle = lib.Handle("form")
        named = f"{os.fspath(file)}:{name}" + (f":{words}" if words else "")
        _, result = lib.long_call("lostbits_form_function", lib.in_utf8(named, "function"),
                                  c.byref(self.handle.pointer))
        about = tables_of(result)["function"]
        self.name, self.shape, self.signature = (str(about[key][0]) for key in ("name", "shape", "signature"))
        self.tapes: dict[str, Tape] = {}
        self.unlock()
        _all.add(self)

    def __call__(self, *arguments: Any) -> Any:
        raise lib.InputError(f"{self.name} is compiled code and takes no arrays; write lb.ask(form, o, d, primitives)")

    def write(self, sample: Sample) -> None:
        """Its operations are known."""


_all: weakref.WeakSet[Intersector] = weakref.WeakSet()


def _unlock_all() -> None:
    for form in list(_all):
        form.unlock()


os.register_at_fork(after_in_child=_unlock_all)


def intersector(shape: str, roots: str = "first", direction: str = "any", touching: str = "hit",
                at_origin: str = "hit", inside: str = "usual", facing: str = "both", name: str | None = None,
                miss: float | None = None, per_ray: bool = False) -> Callable[[Callable[..., Any]], Intersector]:
    """Decorator that makes a numpy function a form, which lostbits can measure. The form is called `py.NAME`.

    The function gets whole batches of n rays and returns t:

    - `o` and `d`, n x 3: origins and directions. Directions are as in the scene, or of length 1 with direction="unit".
    - One array for each key of `shape`, n x 3 or n: sphere centre, radius; box lo, hi; triangle a, b, c; ellipsoid
      centre, radii; cylinder base, top, radius. lb.SHAPES lists the keys of all shapes.
    - It returns t, n items, in lengths of d, with nan for a miss.

    All arrays have the type that is measured, float32 or float64. t must have the same type.

    `roots` says what is returned: "first", the first t >= 0; "near", the smaller root, where t < 0 is a miss; "both", a
    tuple (near, far); "none", n booleans (hit or not). `touching`, `at_origin`, `inside` and `facing` say what counts
    as right in the cases that geometry leaves open, as in docs/your-own-intersector.md.

    `miss`: the value that the function returns for a miss, such as -1 or np.inf, if that is not nan. `per_ray`: the
    function gets one ray (o and d of 3 items, a number or 3 items for each key) and returns one t, or None for a miss.
    It is called once for each ray: 7 us a ray for the root of a sphere, fifty times as long as in whole batches.

    Raises InputError for an unknown shape or option, and if the function does not take these arrays.

    >>> @lb.intersector("sphere", roots="near")
    ... def mine(o, d, centre, radius): ...
    """
    if callable(shape):
        raise lib.InputError("intersector: the shape is missing; write it, as in @lb.intersector(\"sphere\")")
    return lambda function: Intersector(function, shape, roots, name, miss, per_ray, direction=direction,
                                        touching=touching, at_origin=at_origin, inside=inside, facing=facing)


Form = Union[str, Intersector]
Forms = Union[Form, Sequence[Form], None]
Texts = Union[str, Sequence[str]]


class Asked:
    """Forms, formats and metrics as a lostbits_choice, which it keeps alive, with the calls that take one."""

    def __init__(self, forms: Forms, formats: Texts, metrics: Texts = (), rows: bool = False,
                 written: bool = False) -> None:
        single = isinstance(forms, str) or callable(forms)
        listed: list[Any] = [] if forms is None else [forms] if single else lib.texts(forms, "forms")
        for form in listed:
            if callable(form) and not isinstance(form, Intersector):
                raise lib.InputError(f"{getattr(form, '__name__', form)!r} is a plain function; say which shape it "
                                     "intersects with a decorator, as in @lb.intersector(\"sphere\")")
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
        """Follows the user's forms if a format or a metric needs their operations."""
        plain = all(format in _formats for format in self.formats)
        if always or not plain or any(not m.startswith(("tolerance:", "enough_bits:")) for m in self.metrics):
            for form in self.own:
                form.write(sample)

    def call(self, name: str, *arguments: Any, quick: bool = False, handles: Sequence[lib.Handle] | None = None,
             **how: Any) -> tuple[int, lib.Handle]:
        """Makes a call that takes this choice after its own arguments. Raises what a function of the user raised.

        `handles`: handles of the user's forms to use instead of their current ones.
        """
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
