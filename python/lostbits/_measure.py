"""The questions: maps, judged rays, truths, sweeps, explained rays, choices."""

from __future__ import annotations

import ctypes as c
import json
import os
import tomllib
from typing import Any, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import NDArray

from . import _library as lib
from ._arrays import Floats, Rays, choice_of, measured
from ._forms import Form, Intersector, forms_of
from ._results import Choice, Explanation, Judgement, Map, Sweep, Truths
from ._scene import Scene, scene_of, toml_text
from ._tables import Table, tables_of, texts_of


def _write_all(own: Sequence[Intersector], on: Optional[Scene], formats: Sequence[str], metrics: Sequence[str]) -> None:
    """The operations of one's own forms, where something is asked that needs them."""
    formats = [formats] if isinstance(formats, str) else formats
    if all(f in ("f32", "f64") for f in formats) and not metrics:
        return
    for form in own:
        if on is not None:
            form.write(lambda dtype, form=form: on.sample(form.shape, dtype))  # type: ignore[misc]


def map(scene: Union[Scene, str], forms: Union[Form, Sequence[Form], None] = None,
        formats: Sequence[str] = ("f32", "f64"), metrics: Sequence[str] = (), *, pixels: bool = True, threads: int = 0,
        progress: bool = True) -> Map:
    """Every form in every format over the pixels of a scene, against the certified truth: where bits are lost.

    `forms`: names and globs ("sphere.unified", "box.*") and intersectors of one's own; none: all that fit. `formats`:
    "f32", "f64", "fp16", "bf16", "tf32", "p11" (11 significand bits), "p5..p12". `metrics`: beside the default ones,
    such as "culprit", "model_error", "condition". The result: `m.summary`, a row a form and format; `m.frame`, the same
    in pandas; `m.pixels["sphere.unified", "f32"].lost_bits`, height x width, nan where there is none. Bits are those of
    `lostbits map`. Ctrl-C ends it within a second.

    >>> m = lb.map("near-benign", ["sphere.unified", "sphere.schoolbook"])
    """
    on = scene_of(scene)
    own, names = forms_of(forms)
    _write_all(own, on, formats, metrics)
    _, result = measured("lostbits_map", on.handle.pointer, c.byref(choice_of(own, names, formats, metrics, pixels)),
                          own=own, threads=threads, progress=progress, title="map")
    return Map(tables_of(result), on.size)


def judge(o: Floats, d: Floats, t: Optional[Floats], hit: Optional[NDArray[np.bool_]] = None, solids: Any = None, *,
          shape: str = "sphere", paired: bool = False, forms: Union[Form, Sequence[Form], None] = None,
          formats: Sequence[str] = (), metrics: Sequence[str] = (), rows: bool = True, threads: int = 0,
          progress: bool = True, tmin: Optional[Floats] = None, tmax: Optional[Floats] = None,
          format: Optional[str] = None, direction: str = "any", touching: str = "hit", at_origin: str = "hit",
          inside: str = "usual") -> Judgement:
    """Rays and the answers that some code gave to them, against the certified truth.

    `o`, `d`: n x 3, float32 or float64, read where they lie, whatever their strides. `t`: n, in lengths of d (of d
    normalised with direction="unit"), nan where it misses; `hit`: n booleans, where t does not say it. `solids`: m x k
    numbers of a `shape`, which every ray is aimed at, or with paired=True one a ray, or a scene. `forms`: others that
    answer to the same rays. `format`: what t was computed in; by its type where absent. The result: `.summary`,
    `.frame`, `.rays` (a row a ray: outcome, lost_bits, truth, ...), `.of["sphere.unified", "f32"]`.
    """
    own, names = forms_of(forms)
    given = Rays(o, d, solids, shape, t, hit, tmin, tmax, paired, format, direction, touching, at_origin, inside)
    formats = list(formats) or [format or ("f64" if t is not None and t.dtype == np.float64 else "f32")]
    _, result = measured("lostbits_judge", c.byref(given.raw), c.byref(choice_of(own, names, formats, metrics, rows)),
                          own=own, threads=threads, progress=progress, title="judge")
    return Judgement(tables_of(result))


def ask(form: Form, o: Floats, d: Floats, solids: Any, *, shape: str = "sphere", format: str = "f32",
        paired: bool = False, written: bool = False, threads: int = 0) -> Table:
    """What a form answers to rays, in any format: a table of `hit` (n booleans) and `t` (n, nan where it misses).

    `written`: of an intersector of one's own, what its operations give, which other formats than f32 and f64 run.
    """
    own, names = forms_of(form)
    given = Rays(o, d, solids, own[0].shape if own else shape, paired=paired)
    if own and not written and format not in ("f32", "f64"):
        dtype_of = given.kept
        own[0].write(lambda dtype: _paired_sample(dtype_of, paired, dtype))
    _, result = measured("lostbits_answers", c.byref(given.raw),
                          c.byref(choice_of(own, names, [format], (), False, written)), own=own, threads=threads)
    return next(iter(tables_of(result).values()))


def _paired_sample(kept: Sequence[Any], paired: bool, dtype: Any) -> Tuple[Floats, Floats, Floats]:
    o, d, solids = (np.asarray(a, dtype=dtype)[:4096] for a in kept[:3])
    return o, d, solids if paired else solids[np.arange(len(o)) * len(solids) // len(o)]


def truth(o: Floats, d: Floats, solids: Any, *, shape: str = "sphere", paired: bool = False, direction: str = "any",
          touching: str = "hit", at_origin: str = "hit", inside: str = "usual", tmin: Optional[Floats] = None,
          tmax: Optional[Floats] = None, threads: int = 0) -> Truths:
    """The certified truth of rays: `hit` (booleans), `t` (the nearest double, nan of a miss) and `t_lo` (what is
    left, so that t + t_lo is the exact t to 2^-72 of itself), `solid` (which is hit first, from 0; -1 of a miss),
    `resolved`.

    `o`, `d`: n x 3 of float32 or float64, taken as exact. `solids`: m x k numbers of a `shape` (spheres: centre,
    radius), or a scene.
    """
    given = Rays(o, d, solids, shape, None, None, tmin, tmax, paired, "f64", direction, touching, at_origin, inside)
    _, result = measured("lostbits_truth", c.byref(given.raw), threads=threads)
    return Truths(tables_of(result)["truth"])


def sweep(of: Union[Scene, str], forms: Union[Form, Sequence[Form], None] = None,
          formats: Sequence[str] = ("f32", "f64"), *, along: Union[str, Mapping[str, float], None] = None,
          start: Optional[float] = None, to: Optional[float] = None, steps: int = 41, spacing: str = "log2",
          metrics: Sequence[str] = (), data: Optional[str] = None, threads: int = 0, progress: bool = True) -> Sweep:
    """The numbers of a map along a parameter, and where they first go wrong.

    `of`: a sweep that ships with lostbits, a path to one, its text; or a scene, with `along` the path of the number
    that changes ("sphere[0].radius"), several paths and the factor of each ({"camera.eye[2]": 2}), or "distance": the
    one sphere of the scene moves away from the camera. The number goes from `start` (of "distance":
    what it is in the scene) `to`, in `steps`, spacing "log2" or "linear". The result: `.samples`, `.onsets`, `.frame`, `.plot()`.
    """
    own, names = forms_of(forms)
    folder = data.encode() if data else lib.data_folder()
    text, is_text, on = (of, "\n" in of, None) if isinstance(of, str) else ("", True, of)
    if along is not None:
        on = scene_of(of)
        text, is_text = _sweep_text(on, along, start, to, steps, spacing, folder), True
    elif on is not None:
        raise lib.InputError("sweep: of a scene, say what changes: along=\"sphere[0].radius\", to=1e6")
    _write_all(own, on, formats, metrics)
    _, result = measured("lostbits_sweep", text.encode(), int(is_text), folder,
                          c.byref(choice_of(own, names, formats, metrics)), own=own, threads=threads, progress=progress,
                          title="sweep")
    return Sweep(tables_of(result))


def _scene_path(on: Scene, folder: Optional[bytes]) -> str:
    if on.name is None:
        raise lib.InputError("sweep: this scene has no file; save its text as one, and name that")
    path = os.path.join((folder or b"data").decode(), "scenes", on.name + ".toml")
    return on.name if os.path.isfile(on.name) else path


def _sweep_text(on: Scene, along: Union[str, Mapping[str, float]], start: Optional[float], to: Optional[float],
                steps: int, spacing: str, folder: Optional[bytes]) -> str:
    if to is None:
        raise lib.InputError("sweep: say how far, as in to=1e6")
    path = os.path.abspath(_scene_path(on, folder))
    bases: Optional[List[float]] = None
    name = "value"
    if along == "distance":
        with open(path, "rb") as file:
            read = tomllib.load(file)
        eye, look = (np.array([float(x) for x in read["camera"][k]]) for k in ("eye", "look_at"))
        view = (look - eye) / np.linalg.norm(look - eye)
        spheres = read.get("sphere", [])
        if len(spheres) != 1:
            raise lib.InputError(f"sweep: along=\"distance\" moves one sphere, and the scene has {len(spheres)}")
        at = float(np.dot([float(x) for x in spheres[0]["centre"]] - eye, view))
        start = at if start is None else start
        along = {f"sphere[0].centre[{k}]": float(view[k]) for k in range(3)}
        bases, name = [float(x) for x in eye], "distance"
    paths = {along: 1.0} if isinstance(along, str) else dict(along)
    if start is None:
        raise lib.InputError(f"sweep: along={along!r} is a number of the scene, and says nothing of where it begins; "
                             "write start=1, or along=\"distance\"")
    lines = ['schema = "lostbits-sweep/1"', f"title = {toml_text(f'{on.name} along {name}')}", 'source = "-"',
             f"scene = {toml_text(path)}",
             "[[axis]]", f"name = {toml_text(name)}", 'unit = "world"', f"spacing = {toml_text(spacing)}",
             f"from = {toml_text(float(start))}", f"to = {toml_text(float(to))}", f"steps = {int(steps)}",
             f"set = {toml_text(list(paths))}", f"factors = {toml_text(list(paths.values()))}"]
    if bases is not None and any(bases):
        lines.append(f"bases = {toml_text(bases)}")
    return "\n".join(lines) + "\n"


def explain(form: Form, scene: Union[Scene, str], pixel: Tuple[int, int], format: str = "f32") -> Explanation:
    """One ray of a scene, operation by operation: which one loses the bits.

    `form`: a name, or an intersector of one's own, whose unchanged function is followed; what cannot be followed is an
    Unfollowed with the file and line. `pixel`: column and row, from the left and from the top. The result prints what
    `lostbits explain` says; `.operations` is a table of them (`.frame` in pandas), `.culprit` names the one to blame.
    """
    on = scene_of(scene)
    own, names = forms_of(form)
    if len(own) + len(names) != 1:
        raise lib.InputError("explain looks at one form; name one")
    if not (isinstance(pixel, tuple) and len(pixel) == 2):
        raise lib.InputError(f"pixel is (column, row), such as (100, 90), not {pixel!r}")
    for mine in own:
        mine.write(lambda dtype: on.sample(mine.shape, dtype))
    result = lib.Handle("result")
    try:
        lib.call("lostbits_explain", on.handle.pointer, c.c_int(pixel[0]), c.c_int(pixel[1]),
                 c.byref(choice_of(own, names, [format])), c.byref(result.pointer))
    except lib.Error:
        for mine in own:
            mine.raise_own()
        raise
    text, found = texts_of(result)
    lines = own[0].tapes[64 if format == "f64" else 32] if own else None
    return Explanation(text, json.loads(found), lines)


def choose(scene: Union[Scene, str], bits: float, *, wrong: float = 0, at: str = "p99",
           forms: Union[Form, Sequence[Form], None] = None, formats: Sequence[str] = ("f32", "f64"), threads: int = 0,
           progress: bool = True) -> Choice:
    """The cheapest form and format that keeps `bits` correct bits of t on `at` ("p99", "max") of the hits and decides
    at most a share `wrong` of the rays wrongly. The result: `.chosen`, (form, format) or None; `.candidates`, cheapest
    first; `.room`, how far it holds; `.text`. Times are measured anew each time.
    """
    on = scene_of(scene)
    own, names = forms_of(forms)
    code, result = measured("lostbits_choose", on.handle.pointer, c.c_double(bits), c.c_double(wrong),
                             at.encode(), c.byref(choice_of(own, names, formats)), own=own, threads=threads,
                             progress=progress, title="choose")
    return Choice(tables_of(result), texts_of(result)[0], code == 0)
