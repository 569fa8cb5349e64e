"""liblostbits.so through ctypes: its structs, its calls, and its results as arrays.

One struct here is one of analysis/library/lostbits.h, field by field.
"""

from __future__ import annotations

import ctypes as c
import ctypes.util
import os
import sys
from concurrent.futures import ThreadPoolExecutor, wait
from pathlib import Path
from typing import Any, Optional, Sequence, Tuple

ABI = 1


class Error(Exception):
    """What lostbits says is wrong: what, why, and what to try. `code` is the exit code of the program."""

    code = 70


class InputError(Error, ValueError):
    """An argument, or a file, that does not say what it should."""

    code = 2


class EnvironmentFault(Error, OSError):
    """The machine: memory, a file, a library that cannot be loaded."""

    code = 3


class NothingSelected(Error, LookupError):
    """A pattern that selects nothing."""

    code = 4


_errors = {2: InputError, 3: EnvironmentFault, 4: NothingSelected}


class ErrorText(c.Structure):
    _fields_ = [("code", c.c_int), ("text", c.c_char * 4000)]


class Words(c.Structure):
    _fields_ = [("words", c.POINTER(c.c_char_p)), ("count", c.c_size_t)]


class Where(c.Structure):
    _fields_ = [("data", c.c_char_p), ("width", c.c_int), ("height", c.c_int), ("set", Words)]


class Batch(c.Structure):
    """lb_batch of lostbits_plugin.h."""

    _fields_ = [("size", c.c_size_t), ("rays", c.c_void_p), ("ends", c.c_void_p), ("solids", c.c_void_p),
                ("solid_stride", c.c_size_t), ("near_far", c.c_void_p), ("hit", c.c_void_p), ("own", c.c_void_p),
                ("starts", c.c_void_p)]


RunBatch = c.CFUNCTYPE(c.c_void_p, c.POINTER(Batch))


class FormWords(c.Structure):
    """lb_form of lostbits_plugin.h."""

    _fields_ = [("name", c.c_char_p), ("title", c.c_char_p), ("source", c.c_char_p), ("shape", c.c_int),
                ("format", c.c_int), ("direction", c.c_int), ("roots", c.c_int), ("touching", c.c_int),
                ("at_origin", c.c_int), ("flags", c.c_uint), ("own", c.c_void_p), ("run", RunBatch)]


class Operation(c.Structure):
    _fields_ = [("op", c.c_char_p), ("operands", c.c_int32 * 3), ("value", c.c_double), ("label", c.c_char_p)]


class Choice(c.Structure):
    _fields_ = [("forms", Words), ("own", c.POINTER(c.c_void_p)), ("own_count", c.c_size_t), ("formats", Words),
                ("metrics", Words), ("rows", c.c_int), ("written", c.c_int)]


Progress = c.CFUNCTYPE(None, c.c_void_p, c.c_uint64, c.c_uint64)


class Run(c.Structure):
    _fields_ = [("threads", c.c_int), ("stop", c.POINTER(c.c_ubyte)), ("progress", Progress), ("own", c.c_void_p)]


class Array(c.Structure):
    _fields_ = [("data", c.c_void_p), ("step", c.c_ssize_t), ("item_step", c.c_ssize_t), ("bits", c.c_int)]


class Rays(c.Structure):
    _fields_ = [("count", c.c_size_t), ("origin", Array), ("direction", Array), ("tmin", Array), ("tmax", Array),
                ("shape", c.c_char_p), ("solids", Array), ("solid_count", c.c_size_t), ("paired", c.c_int),
                ("scene", c.c_void_p), ("t", Array), ("hit", Array), ("format", c.c_char_p), ("unit", c.c_int),
                ("touching", c.c_int), ("at_origin", c.c_int), ("inside", c.c_int)]


class TableWords(c.Structure):
    _fields_ = [("name", c.c_char_p), ("columns", c.c_size_t), ("rows", c.c_size_t)]


class ColumnWords(c.Structure):
    _fields_ = [("name", c.c_char_p), ("type", c.c_char_p), ("unit", c.c_char_p), ("meaning", c.c_char_p),
                ("numbers", c.POINTER(c.c_double)), ("texts", c.POINTER(c.c_char_p)),
                ("categories", c.POINTER(c.c_ubyte)), ("names", c.POINTER(c.c_char_p)), ("name_count", c.c_size_t)]


_here = Path(__file__).resolve().parent


def _find_library() -> str:
    """$LOSTBITS_LIBRARY, the package's own, that of the tree that the package lies in, then the system's."""
    places = [os.environ.get("LOSTBITS_LIBRARY", ""), str(_here / "lib" / "liblostbits.so"),
              str(_here.parent.parent / "build" / "liblostbits.so")]
    for place in places:
        if place and os.path.isfile(place):
            return place
    found = ctypes.util.find_library("lostbits")
    if found:
        return found
    raise EnvironmentFault("liblostbits.so is not in the package, in build/ or on the system; build it "
                           "(ninja -C build lostbits_library) or name it in $LOSTBITS_LIBRARY")


def data_folder() -> Optional[bytes]:
    """The folder with scenes/ and sweeps/: $LOSTBITS_DATA, the package's, the tree's; None leaves it to the library."""
    for place in (os.environ.get("LOSTBITS_DATA", ""), str(_here / "data"), str(_here.parent.parent / "data")):
        if place and os.path.isdir(os.path.join(place, "scenes")):
            return place.encode()
    return None


def _load() -> c.CDLL:
    path = _find_library()
    try:
        loaded = c.CDLL(path)
    except OSError as error:
        raise EnvironmentFault(f"{path}: cannot be loaded: {error}") from None
    if loaded.lostbits_abi() != ABI:
        raise EnvironmentFault(f"{path}: is of version {loaded.lostbits_abi()} of lostbits.h and this package of "
                               f"{ABI}; install the two that belong together")
    loaded.lostbits_version.restype = c.c_char_p
    loaded.lostbits_result_text.restype = c.c_char_p
    for name in ("scene", "form", "result"):
        free = getattr(loaded, f"lostbits_{name}_free")
        free.restype, free.argtypes = None, [c.c_void_p]
    loaded.lostbits_result_text.argtypes = [c.c_void_p, c.c_size_t]
    loaded.lostbits_result_table.argtypes = [c.c_void_p, c.c_size_t, c.c_void_p]
    loaded.lostbits_result_column.argtypes = [c.c_void_p, c.c_size_t, c.c_size_t, c.c_void_p]
    return loaded


library = _load()


class Handle:
    """A handle of the library, given back when nobody holds it any more."""

    def __init__(self, kind: str) -> None:
        self.pointer = c.c_void_p()
        self._free = getattr(library, f"lostbits_{kind}_free")

    def __del__(self) -> None:
        if self.pointer:
            self._free(self.pointer)
            self.pointer = c.c_void_p()


def words(texts: Sequence[str]) -> Words:
    """A list of texts as C has it; it keeps them alive."""
    array = (c.c_char_p * len(texts))(*[text.encode() for text in texts])
    made = Words(c.cast(array, c.POINTER(c.c_char_p)), len(texts))
    made.kept = array
    return made


def raise_for(code: int, text: str) -> None:
    """The exception that a code stands for; 0 and 1 are none."""
    if code == 130:
        raise KeyboardInterrupt
    if code not in (0, 1):
        raise _errors.get(code, Error)(text)


def call(name: str, *arguments: Any) -> int:
    """A call that takes no time: its code, 0 or 1. Raises what the other codes stand for."""
    error = ErrorText()
    code = int(getattr(library, name)(*arguments, c.byref(error)))
    raise_for(code, error.text.decode(errors="replace"))
    return code


_workers = ThreadPoolExecutor(max_workers=64, thread_name_prefix="lostbits")


def long_call(name: str, *arguments: Any, threads: int = 0, progress: bool = False,
              title: str = "") -> Tuple[int, Handle]:
    """A call that measures: in a thread of its own, so that Ctrl-C ends it within a second and leaves nothing behind.

    `arguments` are those before `run`.
    """
    stop = c.c_ubyte(0)
    error, result = ErrorText(), Handle("result")
    bar = Bar(title) if progress else None

    def advance(_own: int, done: int, of: int) -> None:
        if bar is not None:
            bar.advance(done, of)

    run = Run(threads, c.pointer(stop), Progress(advance) if bar else c.cast(0, Progress), None)

    def work() -> int:
        return int(getattr(library, name)(*arguments, c.byref(run), c.byref(result.pointer), c.byref(error)))

    # Threads that stay: one that is new to the library's scheduler, and goes, costs 4 ms.
    working = _workers.submit(work)
    try:
        while not working.done():
            wait([working], 0.05)
    except BaseException:
        stop.value = 1
        wait([working])
        raise
    finally:
        if bar is not None:
            bar.close()
    code = working.result()
    raise_for(code, error.text.decode(errors="replace"))
    return code, result


class Bar:
    """How far a call is, on a terminal or under a cell of a notebook: one line, written again and again."""

    def __init__(self, title: str) -> None:
        self.title, self.shown = title, -1
        self.wanted = sys.stderr.isatty() or "ipykernel" in sys.modules

    def advance(self, done: int, of: int) -> None:
        share = min(100, 100 * done // max(of, 1))
        if self.wanted and share != self.shown:
            self.shown = share
            print(f"\r{self.title}: {share} %", end="", file=sys.stderr, flush=True)

    def close(self) -> None:
        if self.wanted and self.shown >= 0:
            print("\r" + " " * (len(self.title) + 8) + "\r", end="", file=sys.stderr, flush=True)
