"""Adapters of the user's function: functions of one ray, and values that mean a miss."""

from __future__ import annotations

import functools
from typing import Any, Callable

import numpy as np

from . import _library as lib
from ._trace import Traced


def of_batches(function: Callable[..., Any], name: str) -> Callable[..., Any]:
    """A function of whole batches that calls `function(o, d, *keys)` once for each ray, with arrays of 3 and numbers.

    `function` returns t, None or nan for a miss; a tuple of two with roots="both"; a bool with roots="none".
    """
    @functools.wraps(function)
    def batch(o: Any, d: Any, *keys: Any) -> Any:
        answers = [function(*(array[i] for array in (o, d, *keys))) for i in range(len(o))]
        if answers and all(isinstance(answer, tuple) for answer in answers):
            return tuple(_column(list(column), o.dtype, name) for column in zip(*answers, strict=True))
        return _column(answers, o.dtype, name)
    return batch


def _column(answers: list[Any], dtype: Any, name: str) -> Any:
    """One answer per ray as an array. Answers in another type than the rays are refused."""
    if any(isinstance(answer, Traced) for answer in answers):
        return answers[0].reshape(1)  # a recorded function gets one ray
    if answers and all(isinstance(answer, (bool, np.bool_)) for answer in answers):
        return np.array(answers, dtype=np.bool_)
    column = np.empty(len(answers), dtype)
    for i, answer in enumerate(answers):
        kind = getattr(answer, "dtype", np.dtype(np.float64))
        if answer is not None and (not isinstance(answer, (int, float, np.generic, np.ndarray)) or np.size(answer) != 1):
            raise lib.InputError(f"{name} returned {type(answer).__name__} for a ray; with per_ray=True return one t, "
                                 "or None for a miss")
        if answer is not None and np.isfinite(answer) and kind != dtype:
            raise lib.InputError(f"{name} returned {kind} where the ray is {dtype}: something in the function computes "
                                 "in another type, so the wrong arithmetic would be measured; give constants the type "
                                 "of the ray, as in o.dtype.type(2)")
        column[i] = np.nan if answer is None else answer
    return column


def with_miss(function: Callable[..., Any], miss: float) -> Callable[..., Any]:
    """The function with nan in place of `miss`, the value that it returns for a ray that misses."""
    def marked(t: Any) -> Any:
        if not isinstance(t, (np.ndarray, Traced)) or t.dtype.kind != "f":
            return t
        return np.where(t == t.dtype.type(miss), t.dtype.type(np.nan), t)

    @functools.wraps(function)
    def batch(*arguments: Any) -> Any:
        answer = function(*arguments)
        return tuple(marked(t) for t in answer) if isinstance(answer, tuple) else marked(answer)
    return batch


def refuse_marks(t: Any, roots: str, name: str) -> None:
    """Raises an InputError if t has a value by which code marks a miss and which lostbits would measure as a hit."""
    top = float(np.finfo(t.dtype).max)
    marks: list[float] = [np.inf, -np.inf, top, -top] + ([-1.0] if roots == "first" else [])
    for mark in marks:
        if count := int(np.count_nonzero(t == mark)):
            written = {np.inf: "np.inf", -np.inf: "-np.inf"}.get(mark, repr(mark))
            raise lib.InputError(f"{name} returned {written} for {count} of {len(t)} rays, which is no t of a hit; "
                                 f"return nan for a miss, or say what means a miss: miss={written}")
