"""liblostbits.so through ctypes: its structs, its calls, and what is raised where one fails."""

from __future__ import annotations

import atexit
import ctypes as c
import ctypes.util
import math
import operator
import os
import queue
import sys
import threading
import time
from pathlib import Path
from typing import Any, Sequence

ABI = 7


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


def in_utf8(value: Any, name: str) -> bytes:
    """A text as C has it, which ends at a zero byte."""
    if not isinstance(value, str):
        raise InputError(f"{name} is {value!r}; it is a text")
    if "\0" in value:
        raise InputError(f"{name} is {value!r}; a text has no zero byte")
    try:
        return value.encode()
    except UnicodeEncodeError:
        raise InputError(f"{name} is {value!r}; half of a character has no bytes in UTF-8") from None


def whole(value: Any, name: str, least: int = -2**31, most: int = 2**31 - 1) -> int:
    """A whole number that C's int holds: ctypes keeps the lowest 32 bits of any."""
    try:
        number = operator.index(value)
    except TypeError:
        raise InputError(f"{name} is {value!r}; it is a whole number") from None
    if not least <= number <= most:
        raise InputError(f"{name} is {number}; it is from {least} to {most}")
    return number


def number(value: Any, name: str) -> float:
    try:
        return math.fsum([value])  # unlike float(), of no text
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{name} is {value!r}; it is a number, as a double holds it") from None


def texts(value: Any, name: str) -> list[str]:
    """One text, or several."""
    try:
        return [value] if isinstance(value, str) else list(value)
    except TypeError:
        raise InputError(f"{name} is {value!r}; it is a text or a list of texts") from None


class Words(c.Structure):
    """A list of texts as C has it; it keeps them alive."""

    _fields_ = [("words", c.c_void_p), ("count", c.c_size_t)]

    def __init__(self, texts: Sequence[str], name: str) -> None:
        self.kept = (c.c_char_p * len(texts))(*[in_utf8(text, name) for text in texts])
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
    if given is not None:
        return in_utf8(os.fspath(given) if isinstance(given, os.PathLike) else given, "data") or None
    found = next((p for p in places if p and os.path.isdir(os.path.join(p, "scenes"))), None)
    return os.fsencode(found) if found else None


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


class _Job:
    """A call on its way. It keeps what the library reads and writes until the call is over."""

    def __init__(self, function: Any, arguments: tuple[Any, ...], stop: Any) -> None:
        self.function, self.arguments, self.stop = function, arguments, stop
        self.over = threading.Event()
        self.code = 70

    def run(self) -> None:
        try:
            self.code = self.function(*self.arguments)
        except BaseException as error:  # of ctypes, about an argument
            self.failed: BaseException | None = error
        else:
            self.failed = None


class _Workers:
    """The threads that calls run in. They stay: one that is new to the library's scheduler, and goes, costs 4 ms.

    At the end of the interpreter, calls that daemon threads wait for are stopped. A process that is forked has none of
    the threads: they end before, with the library's, and begin anew on both sides. Where they cannot, since a call
    runs, the child refuses calls, which would wait for ever for locks that nobody gives back.
    """

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.idle: list[tuple[threading.Thread, queue.SimpleQueue[_Job | None]]] = []
        self.running: set[_Job] = set()
        self.is_ending = self.are_lost = self.child_loses = False

    def start(self, function: Any, arguments: tuple[Any, ...], stop: Any) -> _Job:
        job = _Job(function, arguments, stop)
        with self.lock:
            if self.is_ending:
                raise SystemExit
            if self.are_lost:
                raise EnvironmentFault("this process was forked while a call of lostbits, or other work of its library "
                                       "of threads, ran: what that locked stays locked; fork between calls, or start "
                                       "processes with multiprocessing.get_context(\"spawn\")")
            self.running.add(job)
            jobs = self.idle.pop()[1] if self.idle else self._new()
        jobs.put(job)
        return job

    def _new(self) -> queue.SimpleQueue[_Job | None]:
        jobs: queue.SimpleQueue[_Job | None] = queue.SimpleQueue()
        threading.Thread(target=self._work, args=(jobs,), name="lostbits", daemon=True).start()
        return jobs

    def _work(self, jobs: queue.SimpleQueue[_Job | None]) -> None:
        while (job := jobs.get()) is not None:
            job.run()
            with self.lock:
                self.running.discard(job)
                self.idle.append((threading.current_thread(), jobs))
            job.over.set()
            del job

    def end(self) -> None:
        """Ends the calls that run; nobody can use what they find."""
        with self.lock:
            self.is_ending = True
            running = list(self.running)
        for job in running:
            if job.stop is not None:
                job.stop.value = 1
        for job in running:
            job.over.wait(10)  # one whose function waits for ever is left to the system

    def before_fork(self) -> None:
        self.lock.acquire()
        self.child_loses = self.are_lost or bool(self.running)
        if self.child_loses:
            return
        for _, jobs in self.idle:
            jobs.put(None)
        for thread, _ in self.idle:
            thread.join()
        # join() returns when Python is done with a thread. The thread gives its share of the scheduler back a little
        # later, when the system ends it: on a busy machine one fork in some hundreds came in between.
        give_up = time.monotonic() + (5 if self.idle else 0)
        self.idle.clear()
        while library.lostbits_end_threads(None) != 0:
            if time.monotonic() > give_up:
                self.child_loses = True
                return
            time.sleep(0.001)

    def after_fork_in_parent(self) -> None:
        self.lock.release()

    def after_fork_in_child(self) -> None:
        self.lock, self.are_lost = threading.Lock(), self.child_loses
        self.idle, self.running = [], set()


_workers = _Workers()
atexit.register(_workers.end)
os.register_at_fork(before=_workers.before_fork, after_in_parent=_workers.after_fork_in_parent,
                    after_in_child=_workers.after_fork_in_child)


def _run(function: Any, arguments: tuple[Any, ...], error: Any, stop: Any = None) -> int:
    """A call in a worker: its code, 0 or 1, once it is over. Ctrl-C stops it, and is raised then."""
    job = _workers.start(function, (*arguments, c.byref(error)), stop)
    interrupted: BaseException | None = None
    while not job.over.is_set():
        try:
            job.over.wait(0.05)
        except BaseException as asked:  # a second one too: what the call reads lies here until it is over
            interrupted = asked
            if stop is not None:
                stop.value = 1
    if interrupted is not None:
        raise interrupted
    if job.failed is not None:
        raise job.failed
    if job.code == 130 and _workers.is_ending:
        raise SystemExit
    return raise_for(job.code, error)


def call(name: str, *arguments: Any) -> int:
    """A call that takes no time: its code, 0 or 1. Raises what the other codes stand for."""
    return _run(getattr(library, name), arguments, ErrorText())


def result_of(name: str, *arguments: Any) -> Handle:
    """The result of such a call."""
    result = Handle("result")
    call(name, *arguments, c.byref(result.pointer))
    return result


def long_call(name: str, *arguments: Any, threads: int = 0, progress: bool = False) -> tuple[int, Handle]:
    """A call that measures: Ctrl-C ends it within a second and leaves nothing behind.

    `arguments` are those before `run`.
    """
    stop, result = c.c_ubyte(0), Handle("result")
    bar = Bar(name.removeprefix("lostbits_")) if progress else None
    run = Run(whole(threads, "threads", 0), c.pointer(stop), Progress(bar.advance) if bar else c.cast(0, Progress), None)
    try:
        return stoppable_call(name, *arguments, c.byref(run), c.byref(result.pointer), stop=stop), result
    finally:
        if bar is not None:
            bar.close()


def stoppable_call(name: str, *arguments: Any, stop: Any) -> int:
    """A call that takes its time, in a thread of its own: Ctrl-C sets `stop`, which the call asks, and waits for it."""
    return _run(getattr(library, name), arguments, ErrorText(), stop)


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
