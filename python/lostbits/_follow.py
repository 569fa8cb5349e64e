"""Runs a numpy function once on arrays that record each operation done to them."""

from __future__ import annotations

import inspect
import os
import sys
import threading
from typing import Any, Callable, Sequence

import numpy as np

from ._sums import CREATED, filled
from ._trace import ALWAYS, NUMPY, PACKAGE, Tape, Traced, Unfollowed, here, traced

_lock = threading.Lock()
_before = {name: getattr(np, name) for name in ("full", *CREATED)}


def _put_back() -> None:
    for name, own in _before.items():
        setattr(np, name, own)


def _unlock() -> None:
    """Restores numpy in a process that was forked while another thread followed a function.

    That thread does not exist in the child, but the functions that it put into numpy do.
    """
    global _lock
    if _lock.locked():
        _put_back()
    _lock = threading.Lock()


os.register_at_fork(after_in_child=_unlock)


class _Creating:
    """Makes np.full, np.zeros, np.ones and np.empty return arrays that can be followed, for calls of this thread."""

    def __enter__(self) -> None:
        _lock.acquire()
        me = threading.get_ident()
        for name, own in _before.items():

            def chosen(shape: Any, *a: Any, _name: str = name, _own: Any = own, **o: Any) -> Any:
                by_user = not sys._getframe(1).f_code.co_filename.startswith((PACKAGE, NUMPY))
                boolean = np.dtype(o.get("dtype") or (a[-1] if a and isinstance(a[-1], type) else float)) == bool
                if threading.get_ident() != me or not by_user or boolean:
                    return _own(shape, *a, **o)
                return filled(shape, CREATED[_name] if _name in CREATED else o.get("fill_value", a[0] if a else None))

            setattr(np, name, chosen)

    def __exit__(self, *_: Any) -> None:
        _put_back()
        _lock.release()


class _Names:
    """Labels operations with the names of the function's variables."""

    def __init__(self, written: Tape, file: str) -> None:
        self.written, self.file = written, file
        self.seen: dict[tuple[int, str], int] = {}

    def __call__(self, frame: Any, event: str, _: Any) -> Any:
        if frame.f_code.co_filename != self.file:
            return None
        if event in ("line", "return"):
            for name, value in frame.f_locals.items():
                if not isinstance(value, Traced) or value.size != 1 or value.dtype == bool:
                    continue
                node = int(value.nodes.reshape(-1)[0])
                if self.seen.get((id(frame), name)) != node:
                    self.seen[id(frame), name] = node
                    self.written.labels.setdefault(node, name)
        return self


def follow(function: Callable[..., Any], counts: Sequence[int], dtype: Any, roots: str,
           implicit: bool) -> tuple[Tape, int, int]:
    """Records what `function(o, d, *keys)` does to one ray.

    Returns the tape, the index of the decision (hit or miss) and the index of t. `counts`: the number of values of
    each key. Raises Unfollowed if something cannot be followed.
    """
    written = Tape(dtype, implicit)
    before, tracer = getattr(here, "tape", None), sys.gettrace()
    here.tape = written
    try:
        place, arguments = 0, []
        for count in (3, 3, *counts):
            nodes = [written.add("input", place + k) for k in range(count)]
            place += count
            value = np.linspace(0.25, 0.75, count).astype(dtype)[None]
            arguments.append(Traced(value, np.array([nodes])) if count > 1 else Traced(value[:, 0], np.array(nodes)))
        names = _Names(written, inspect.unwrap(function).__code__.co_filename)
        with _Creating():
            sys.settrace(names)
            try:
                answer = function(*arguments)
            finally:
                sys.settrace(tracer)
        if isinstance(answer, tuple):
            raise Unfollowed(f"{function.__name__} returns several arrays and cannot be followed; return t alone")
        answer = traced(answer, dtype)
        if answer.shape != (1,):
            raise Unfollowed(f"{function.__name__} returns an array of shape {answer.shape} for one ray; it must have "
                             "shape (1,)")
        t, valid = int(answer.nodes[0]), int(answer.valid[0])
        zero = written.add("constant", value=0.0)
        if roots == "near":
            valid = written.both(valid, written.opposite(written.add("less", t, zero)))
        if valid == ALWAYS:
            valid = written.add("less_equal", zero, zero)
        return written, valid, t
    finally:
        here.tape = before
