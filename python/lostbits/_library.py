"""liblostbits.so through ctypes: its structs, its calls, and what is raised where one fails."""

from __future__ import annotations

import ctypes as c
import ctypes.util
import os
import sys
from concurrent.futures import ThreadPoolExecutor, wait
from pathlib import Path
from typing import Any, Sequence

ABI = 6


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


class Words(c.Structure):
    """A list of texts as C has it; it keeps them alive."""

    _fields_ = [("words", c.c_void_p), ("count", c.c_size_t)]

    def __init__(self, texts: Sequence[str] = ()) -> None:
        self.kept = (c.c_char_p * len(texts))(*[text.encode() for text in texts])
        super().__init__(c.cast(self.kept, c.c_void_p), len(texts))


class Array(c.Structure):
    _fields_ = [("data", c.c_void_p), ("step", c.c_ssize_t), ("item_step", c.c_ssize_t), ("bits", c.c_int)]


_kinds = {"int": c.c_int, "unsigned": c.c_uint, "size": c.c_size_t, "double": c.c_double, "text": c.c_char_p,
          "texts": c.POINTER(c.c_char_p), "pointer": c.c_void_p, "words": Words, "array": Array}
RunBatch = c.CFUNCTYPE(c.c_void_p, c.c_void_p)
Progress = c.CFUNCTYPE(None, c.c_void_p, c.c_uint64, c.c_uint64)


def _struct(name: str, fields: str, **others: Any) -> Any:
    """A struct of lostbits.h or lostbits_plugin.h, field by field: `kind name, name; kind name`, `name` of `others`."""
    listed = []
    for part in fields.split("; "):
        kind, _, names = part.partition(" ")
        listed += [(word, _kinds[kind]) for word in names.split(", ")] if names else [(kind, others[kind])]
    return type(name, (c.Structure,), {"_fields_": listed})


ErrorText = _struct("ErrorText", "int code; text", text=c.c_char * 4000)
Where = _struct("Where", "text data; int width, height; words set; stop", stop=c.POINTER(c.c_ubyte))
Batch = _struct("Batch", "size size; pointer rays, ends, solids; size solid_stride; pointer near_far, hit, own, starts")
FormWords = _struct("FormWords", "text name, title, source; int shape, format, direction, roots, touching, at_origin; "
                    "unsigned flags; pointer own; run", run=RunBatch)
Operation = _struct("Operation", "text op; operands; double value; text label", operands=c.c_int32 * 3)
Choice = _struct("Choice", "words forms; pointer own; size own_count; words formats, metrics; int rows, written")
Run = _struct("Run", "int threads; stop; progress; pointer own", stop=c.POINTER(c.c_ubyte), progress=Progress)
Rays = _struct("Rays", "size count; array origin, direction, tmin, tmax; text open_ends, shape; array solids; "
               "size solid_count; int paired; pointer scene; array t, hit; text format; "
               "int unit, touching, at_origin, inside, facing; array by, matrix")
Wish = _struct("Wish", "double bits, tolerance, wrong; text at")
TableWords = _struct("TableWords", "text name; size columns, rows")
ColumnWords = _struct("ColumnWords", "text name, type, unit, meaning; pointer numbers; texts texts; "
                      "pointer categories; texts names; size name_count")
_here = Path(__file__).resolve().parent


def _find_library() -> str:
    """$LOSTBITS_LIBRARY, the package's own, that of the tree that the package lies in, then the system's."""
    places = [os.environ.get("LOSTBITS_LIBRARY", ""), str(_here / "lib" / "liblostbits.so"),
              str(_here.parent.parent / "build" / "liblostbits.so")]
    found = next((p for p in places if p and os.path.isfile(p)), None) or ctypes.util.find_library("lostbits")
    if not found:
        raise EnvironmentFault("liblostbits.so is not in the package, in build/ or on the system; build it "
                               "(ninja -C build lostbits_library) or name it in $LOSTBITS_LIBRARY")
    return found


def data_folder(given: str | None = None) -> bytes | None:
    """The folder with scenes/ and sweeps/: as given, $LOSTBITS_DATA, the package's, the tree's; None leaves it to C."""
    places = (os.environ.get("LOSTBITS_DATA", ""), str(_here / "data"), str(_here.parent.parent / "data"))
    found = given or next((p for p in places if p and os.path.isdir(os.path.join(p, "scenes"))), None)
    return found.encode() if found else None


def _load() -> c.CDLL:
    path = _find_library()
    try:
        loaded = c.CDLL(path)
    except OSError as error:
        raise EnvironmentFault(f"{path}: cannot be loaded: {error}") from None
    if loaded.lostbits_abi() != ABI:
        raise EnvironmentFault(f"{path}: is of version {loaded.lostbits_abi()} of lostbits.h and this package of "
                               f"{ABI}; install the two that belong together")
    loaded.lostbits_version.restype = loaded.lostbits_result_text.restype = c.c_char_p
    for kind in ("scene", "form", "result"):
        getattr(loaded, f"lostbits_{kind}_free").argtypes = [c.c_void_p]
    return loaded


library = _load()


class Handle:
    """A handle of the library, given back when nobody holds it any more."""

    def __init__(self, kind: str) -> None:
        self.pointer = c.c_void_p()
        self._free = getattr(library, f"lostbits_{kind}_free")

    def __del__(self) -> None:
        self._free(self.pointer)


def raise_for(code: int, error: Any) -> int:
    """Raises what a code stands for; 0 and 1 are returned."""
    if code == 130:
        raise KeyboardInterrupt
    if code not in (0, 1):
        kinds = {kind.code: kind for kind in (InputError, EnvironmentFault, NothingSelected)}
        raise kinds.get(code, Error)(error.text.decode(errors="replace"))
    return code


def call(name: str, *arguments: Any) -> int:
    """A call that takes no time: its code, 0 or 1. Raises what the other codes stand for."""
    error = ErrorText()
    return raise_for(getattr(library, name)(*arguments, c.byref(error)), error)


def result_of(name: str, *arguments: Any) -> Handle:
    """The result of such a call."""
    result = Handle("result")
    call(name, *arguments, c.byref(result.pointer))
    return result


_workers = ThreadPoolExecutor(max_workers=64, thread_name_prefix="lostbits")


def long_call(name: str, *arguments: Any, threads: int = 0, progress: bool = False) -> tuple[int, Handle]:
    """A call that measures: in a thread of its own, so that Ctrl-C ends it within a second and leaves nothing behind.

    `arguments` are those before `run`.
    """
    stop, result = c.c_ubyte(0), Handle("result")
    bar = Bar(name.removeprefix("lostbits_")) if progress else None
    run = Run(threads, c.pointer(stop), Progress(bar.advance) if bar else c.cast(0, Progress), None)
    try:
        return stoppable_call(name, *arguments, c.byref(run), c.byref(result.pointer), stop=stop), result
    finally:
        if bar is not None:
            bar.close()


def stoppable_call(name: str, *arguments: Any, stop: Any) -> int:
    """A call that takes its time, in a thread of its own: Ctrl-C sets `stop`, which the call asks, and waits for it."""
    error = ErrorText()
    # Threads that stay: one that is new to the library's scheduler, and goes, costs 4 ms.
    working = _workers.submit(getattr(library, name), *arguments, c.byref(error))
    try:
        while not working.done():
            wait([working], 0.05)
    except BaseException:
        stop.value = 1
        wait([working])
        raise
    return raise_for(working.result(), error)


class Bar:
    """How far a call is, on a terminal or under a cell of a notebook: one line, written again and again."""

    def __init__(self, title: str) -> None:
        self.title, self.shown = title, ""
        self.wanted = sys.stderr.isatty() or "ipykernel" in sys.modules

    def advance(self, _own: int, done: int, of: int) -> None:
        share = f"{min(100, 100 * done // of)} %" if of else f"{done} tried"
        if self.wanted and share != self.shown:
            self.shown = share
            print(f"\r{self.title}: {share}", end="", file=sys.stderr, flush=True)

    def close(self) -> None:
        if self.wanted and self.shown:
            print("\r" + " " * (len(self.title) + len(self.shown) + 2) + "\r", end="", file=sys.stderr, flush=True)
