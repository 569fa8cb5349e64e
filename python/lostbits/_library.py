"""Interface to liblostbits.so through ctypes: its structs, its calls, and the exceptions of failed calls."""

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

ABI = 10


class Error(Exception):
    """An error of lostbits. Its text says what is wrong, why, and what to try. `code`: the program's exit status for it.
    """

    code = 70


class InputError(Error, ValueError):
    """An argument or a file is not valid. Exit status 2."""

    code = 2


class EnvironmentFault(Error, OSError):
    """The machine is at fault: no memory, a file that cannot be read or written, a missing library. Exit status 3."""

    code = 3


class NothingSelected(Error, LookupError):
    """A pattern selects nothing. Exit status 4."""

    code = 4


def in_utf8(value: Any, name: str) -> bytes:
    """A string in UTF-8 for C, where a zero byte ends it. Raises an InputError if it has none or holds a zero byte."""
    if not isinstance(value, str):
        raise InputError(f"{name} is {value!r}; it must be a string")
    if "\0" in value:
        raise InputError(f"{name} is {value!r}; remove the zero byte, which ends a string in C")
    try:
        return value.encode()
    except UnicodeEncodeError:
        raise InputError(f"{name} is {value!r}; it cannot be written in UTF-8, since it contains half of a surrogate "
                         "pair") from None


def whole(value: Any, name: str, least: int = -2**31, most: int = 2**31 - 1) -> int:
    """A whole number within C's int. Without the check, ctypes would silently keep the lowest 32 bits."""
    try:
        number = operator.index(value)
    except TypeError:
        raise InputError(f"{name} is {value!r}; it must be a whole number") from None
    if not least <= number <= most:
        raise InputError(f"{name} is {number}; it must be from {least} to {most}")
    return number


def number(value: Any, name: str) -> float:
    try:
        return math.fsum([value])  # unlike float(), refuses a string
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{name} is {value!r}; it must be a number that fits into a double") from None


def texts(value: Any, name: str) -> list[str]:
    """One string or several, as a list."""
    try:
        return [value] if isinstance(value, str) else list(value)
    except TypeError:
        raise InputError(f"{name} is {value!r}; it must be a string or a list of strings") from None


class Words(c.Structure):
    """A list of strings for C, which keeps them alive."""

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
    """A struct of lostbits.h or lostbits_plugin.h.

    `fields` lists its fields in order, as in `kind name, name; kind name`. A part that is only a name takes its kind
    from `others`.
    """
    listed = []
    for part in fields.split("; "):
        kind, _, names = part.partition(" ")
        listed += [(word, _kinds[kind]) for word in names.split(", ")] if names else [(kind, others[kind])]
    return type(name, (c.Structure,), {"_fields_": listed})


ErrorText = _struct("ErrorText", "int code; text", text=c.c_char * 4000)
Where = _struct("Where", "text data; int width, height; words set; stop", stop=c.POINTER(c.c_ubyte))
Batch = _struct("Batch", "size size; pointer rays, ends, primitives; size primitive_stride; "
                "pointer near_far, hit, own, starts")
FormWords = _struct("FormWords", "text name, title, source; int shape, format, direction, roots, touching, at_origin; "
                    "unsigned flags; pointer own; run", run=RunBatch)
Operation = _struct("Operation", "text op; operands; double value; text label", operands=c.c_int32 * 3)
Choice = _struct("Choice", "words forms; pointer own; size own_count; words formats, metrics; int rows, written")
Run = _struct("Run", "int threads; stop; progress; pointer own", stop=c.POINTER(c.c_ubyte), progress=Progress)
Rays = _struct("Rays", "size count; array origin, direction, tmin, tmax; text open_ends, shape; array primitives; "
               "size primitive_count; int paired; pointer scene; array t, hit; text format; "
               "int unit, touching, at_origin, inside, facing; array by, matrix")
MeshAnswers = _struct("MeshAnswers", "text column; array values, objects; int rows")
Requirement = _struct("Requirement", "double bits, tolerance, wrong; text at")
TableWords = _struct("TableWords", "text name; size columns, rows")
ColumnWords = _struct("ColumnWords", "text name, type, unit, meaning; pointer numbers; texts texts; "
                      "pointer categories; texts names; size name_count; pointer colours")
_here = Path(__file__).resolve().parent


def _find_library() -> str:
    """Looks in $LOSTBITS_LIBRARY, in the package, in build/ of the source tree around it, then on the system."""
    places = [os.environ.get("LOSTBITS_LIBRARY", ""), str(_here / "lib" / "liblostbits.so"),
              str(_here.parent.parent / "build" / "liblostbits.so")]
    found = next((p for p in places if p and os.path.isfile(p)), None) or ctypes.util.find_library("lostbits")
    if not found:
        raise EnvironmentFault("liblostbits.so was not found in the package, in build/ or on the system; build it "
                               "(ninja -C build lostbits_library) or set LOSTBITS_LIBRARY to its path")
    return found


def data_folder(given: str | None = None) -> bytes | None:
    """The folder that has scenes/ and sweeps/.

    In this order: as given, $LOSTBITS_DATA, in the package, in the source tree. None lets the library look for it.
    """
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
        raise EnvironmentFault(f"{path}: has version {loaded.lostbits_abi()} of the interface lostbits.h, but this "
                               f"package needs version {ABI}; install a library and a package of the same release")
    loaded.lostbits_version.restype = loaded.lostbits_result_text.restype = c.c_char_p
    for kind in ("scene", "form", "result"):
        getattr(loaded, f"lostbits_{kind}_free").argtypes = [c.c_void_p]
    return loaded


library = _load()


class Handle:
    """A handle of the library. It is freed when nothing refers to it any more."""

    def __init__(self, kind: str) -> None:
        self.pointer = c.c_void_p()
        self._free = getattr(library, f"lostbits_{kind}_free")

    def __del__(self) -> None:
        self._free(self.pointer)


def raise_for(code: int, error: Any) -> int:
    """Raises the exception for an exit status. Returns 0 and 1."""
    if code == 130:
        raise KeyboardInterrupt
    if code not in (0, 1):
        kinds = {kind.code: kind for kind in (InputError, EnvironmentFault, NothingSelected)}
        raise kinds.get(code, Error)(error.text.decode(errors="replace"))
    return code


class _Job:
    """A running call. It keeps alive what the library reads and writes until the call is over."""

    def __init__(self, function: Any, arguments: tuple[Any, ...], stop: Any) -> None:
        self.function, self.arguments, self.stop = function, arguments, stop
        self.over = threading.Event()
        self.code = 70

    def run(self) -> None:
        try:
            self.code = self.function(*self.arguments)
        except BaseException as error:  # raised by ctypes about an argument
            self.failed: BaseException | None = error
        else:
            self.failed = None


class _Workers:
    """Threads that calls run in. They are kept, since a thread that joins the library's scheduler and ends costs 4 ms.

    At the end of the interpreter, calls that daemon threads wait for are stopped.

    A forked child has none of the threads. So they end before a fork, together with the library's own threads, and new
    ones start on both sides. They cannot end while a call runs. Then the child refuses all calls, because they would
    wait for ever for locks that nobody releases.
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
                raise EnvironmentFault("this process was forked while a call of lostbits, or other work in TBB's "
                                       "threads, was running, so locks of that work stay locked here; fork between "
                                       "calls, or start processes with multiprocessing.get_context(\"spawn\")")
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
        """Stops the running calls, whose results nobody can use any more."""
        with self.lock:
            self.is_ending = True
            running = list(self.running)
        for job in running:
            if job.stop is not None:
                job.stop.value = 1
        for job in running:
            job.over.wait(10)  # seconds; a call whose function waits for ever is left to the system

    def before_fork(self) -> None:
        self.lock.acquire()
        self.child_loses = self.are_lost or bool(self.running)
        if self.child_loses:
            return
        for _, jobs in self.idle:
            jobs.put(None)
        for thread, _ in self.idle:
            thread.join()
        # join() returns when Python is done with a thread. The thread leaves the library's scheduler a little later,
        # when the system ends it. On a busy machine, one fork in some hundreds happened in between.
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
    """Makes a call in a worker. Returns its code, 0 or 1. Ctrl-C stops the call and is raised when it is over."""
    job = _workers.start(function, (*arguments, c.byref(error)), stop)
    interrupted: BaseException | None = None
    while not job.over.is_set():
        try:
            job.over.wait(0.05)
        except BaseException as asked:  # a second Ctrl-C too: the call reads memory kept here until it is over
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
    """Makes a short call. Returns its code, 0 or 1, and raises the exception for any other."""
    return _run(getattr(library, name), arguments, ErrorText())


def result_of(name: str, *arguments: Any) -> Handle:
    """Makes a short call and returns its result."""
    result = Handle("result")
    call(name, *arguments, c.byref(result.pointer))
    return result


def long_call(name: str, *arguments: Any, threads: int = 0, progress: bool = False) -> tuple[int, Handle]:
    """Makes a call that measures. Returns its code, 0 or 1, and its result. Ctrl-C ends it within a second.

    `arguments`: the arguments before `run`. `threads`: 0 for one per core.
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
    """Makes a long call in a worker. Ctrl-C sets `stop`, which the call polls, and waits for the call to end."""
    return _run(getattr(library, name), arguments, ErrorText(), stop)


class Bar:
    """Progress of a call on a terminal or under a cell of a notebook: one line that is rewritten."""

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
