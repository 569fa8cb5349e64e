"""The questions: scenes, maps, judged rays, truths, sweeps, explained rays, choices."""

from __future__ import annotations

import ctypes as c
import json
import os
import tomllib
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _library as lib
from ._forms import SHAPES, Form, Intersector, forms_of, word
from ._results import Choice, Explanation, Judgement, Map, Sweep, Truths
from ._trace import Unfollowed

Floats = NDArray[Any]
_counts = {shape: sum(count for _, count in keys) for shape, keys in SHAPES.items()}


# ---- arrays, read where they lie ----


def _array(value: Any, name: str, columns: int, rows: Optional[int] = None, kinds: str = "f") -> Tuple[Any, lib.Array]:
    """An array of one's own, whatever its strides, and how C finds its items. A sentence for what it cannot be."""
    if value is None:
        return None, lib.Array()
    if not isinstance(value, np.ndarray):
        raise lib.InputError(f"{name} is {_article(value)}; write np.array({name}, dtype=np.float32) or float64: the type "
                             "says which arithmetic is meant")
    if value.dtype.kind not in kinds or value.dtype.itemsize not in (1, 4, 8):
        wanted = "float32 or float64" if kinds == "f" else "booleans"
        raise lib.InputError(f"{name} is an array of {value.dtype}; it is of {wanted}")
    if not value.dtype.isnative:
        raise lib.InputError(f"{name} has its bytes in the other order ({value.dtype.str}); write "
                             f"{name}.astype({name}.dtype.newbyteorder('='))")
    wanted_shape = "n" if columns == 0 else f"n x {columns}"
    if columns and value.ndim == 1 and rows is None and len(value) == columns:
        value = value[None]
    if value.ndim != (2 if columns else 1) or columns and value.shape[1] != columns:
        raise lib.InputError(f"{name} has shape {value.shape}; it is {wanted_shape}")
    if rows is not None and len(value) != rows:
        raise lib.InputError(f"{name} has {len(value)} rows and o has {rows}; there is one a ray")
    return value, lib.Array(value.ctypes.data, value.strides[0], value.strides[1] if columns else 0,
                            8 * value.dtype.itemsize)


def _article(value: Any) -> str:
    kind = type(value).__name__
    return ("an " if kind[0] in "aeiou" else "a ") + kind


class _Rays:
    """Arrays as lostbits_rays; it keeps them alive."""

    def __init__(self, o: Any, d: Any, solids: Any, shape: str, t: Any = None, hit: Any = None, tmin: Any = None,
                 tmax: Any = None, paired: bool = False, format: Optional[str] = None, direction: str = "any",
                 touching: str = "hit", at_origin: str = "hit", inside: str = "usual") -> None:
        from ._forms import _inside, _yes_no

        o, origin = _array(o, "o", 3)
        n = len(o) if o is not None else 0
        if o is None or d is None:
            raise lib.InputError("o and d are the origins and directions of rays, n x 3; give both")
        d, along = _array(d, "d", 3, n)
        if n == 0:
            raise lib.InputError("o is empty: there are no rays to ask about")
        self.kept = [o, d]
        raw = lib.Rays(count=n, origin=origin, direction=along)
        if isinstance(solids, Scene):
            raw.scene, self.kept = solids.handle.pointer, [*self.kept, solids]
        else:
            count = word(shape, _counts, "shape")
            solids, raw.solids = _array(solids, "solids", count, n if paired else None)
            if solids is None:
                raise lib.InputError(f"solids is None; give an array of {count} numbers a {shape}, or a scene")
            raw.shape, raw.solid_count, raw.paired = shape.encode(), len(solids), int(paired)
            self.kept.append(solids)
        if t is not None and hit is None and isinstance(t, np.ndarray) and t.dtype.kind == "f" and (t < 0).any():
            raise lib.InputError("t has numbers below 0, which may be misses or hits; say which in hit=, as in hit=t >= 0")
        for field, value, kinds in (("t", t, "f"), ("hit", hit, "b"), ("tmin", tmin, "f"), ("tmax", tmax, "f")):
            value, array = _array(value, field, 0, n, kinds)
            setattr(raw, field, array)
            self.kept.append(value)
        raw.format = format.encode() if format else None
        raw.unit = word(direction, {"any": 0, "unit": 1}, "direction")
        raw.touching = word(touching, {"hit": 0, "miss": 1}, "touching")
        raw.at_origin, raw.inside = word(at_origin, _yes_no, "at_origin"), word(inside, _inside, "inside")
        self.raw, self.count = raw, n


def _choice(own: Sequence[Intersector], names: Sequence[str], formats: Sequence[str], metrics: Sequence[str] = (),
            rows: bool = False, written: bool = False) -> lib.Choice:
    handles = (c.c_void_p * len(own))(*[form.handle.pointer for form in own])
    formats = [formats] if isinstance(formats, str) else formats
    metrics = [metrics] if isinstance(metrics, str) else metrics
    texts = [lib.words(list(each)) for each in (names, formats, metrics)]
    made = lib.Choice(texts[0], c.cast(handles, c.POINTER(c.c_void_p)), len(own), texts[1], texts[2], int(rows),
                      int(written))
    made.kept = (handles, texts, own)
    return made


def _measured(name: str, *arguments: Any, own: Sequence[Intersector] = (), **how: Any) -> Tuple[int, lib.Handle]:
    """A long call; what a function of the user's raised on the way is raised here."""
    try:
        return lib.long_call(name, *arguments, **how)
    except lib.Error:
        for form in own:
            form.raise_own()
        raise


# ---- scenes ----


class Scene:
    """What rays are made of and aimed at: solids and a camera. Made by `scene`."""

    def __init__(self, handle: lib.Handle, text: Optional[str], name: Optional[str]) -> None:
        self.handle, self.text, self.name = handle, text, name
        self._rays: Optional[Dict[str, lib.Table]] = None

    @property
    def rays(self) -> Dict[str, lib.Table]:
        """Tables: `rays` (x, y, ox ... dz of every pixel, as every form gets them), and a table a shape of solids."""
        if self._rays is None:
            result = lib.Handle("result")
            lib.call("lostbits_scene_rays", self.handle.pointer, c.byref(result.pointer))
            self._rays = lib.tables_of(result)
        return self._rays

    @property
    def size(self) -> Tuple[int, int]:
        """Width and height of the picture in pixels."""
        rays = self.rays["rays"]
        return int(rays["x"][-1]) + 1, int(rays["y"][-1]) + 1

    def arrays(self, shape: str = "sphere", dtype: Any = np.float32) -> Tuple[Floats, Floats, Floats]:
        """o, d (a row a pixel) and the solids of a shape."""
        rays, table = self.rays["rays"], self.rays.get(shape)
        o, d = (np.stack([rays[k + axis] for axis in "xyz"], axis=1).astype(dtype) for k in "od")
        solids = np.empty((0, _counts[shape])) if table is None else np.stack([table[k] for k in table], axis=1)
        return o, d, solids.astype(dtype)

    def _sample(self, shape: str, dtype: Any) -> Tuple[Floats, Floats, Floats]:
        """At most some thousand of its rays, evenly, a stretch of them to each of the solids."""
        o, d, solids = self.arrays(shape, dtype)
        step = max(1, len(o) // 4096)
        o, d = np.ascontiguousarray(o[::step]), np.ascontiguousarray(d[::step])
        return o, d, solids[np.arange(len(o)) * len(solids) // len(o)]

    def __repr__(self) -> str:
        return f"<lostbits scene {self.name or 'of arrays'}, {self.size[0]} x {self.size[1]}>"


def _where(size: Optional[Tuple[int, int]], changes: Sequence[str], data: Optional[str]) -> lib.Where:
    width, height = size or (0, 0)
    texts = lib.words(list(changes))
    made = lib.Where(data.encode() if data else lib.data_folder(), width, height, texts)
    made.kept = texts
    return made


def _toml(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value)
    if isinstance(value, (list, tuple, np.ndarray)):
        return "[" + ", ".join(_toml(v) for v in value) + "]"
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    return repr(float(value))


def scene(name: Optional[str] = None, *, camera: Optional[Mapping[str, Any]] = None,
          mesh: Optional[Tuple[ArrayLike, ArrayLike]] = None, transform: Optional[ArrayLike] = None,
          size: Optional[Tuple[int, int]] = None, set: Sequence[str] = (), inputs: str = "shared",
          data: Optional[str] = None, **solids: Any) -> Scene:
    """A scene: by name, from a file, from text, or from arrays.

    `name`: that of a scene which ships with lostbits ("rtg-fig-7-3-4100-oblique"), a path to a .toml file, or the text
    of one (it holds a line break). `size`: width and height in pixels. `set`: changes, as in "sphere[0].radius=10".

    Without a name: `camera` as in docs/files.md, {"kind": "pinhole", "eye": [0, 0, 5], "look_at": [0, 0, 0],
    "fov_deg": 40}, and solids: `spheres` n x 4 (centre, radius), `boxes` n x 6 (lo, hi), `triangles` n x 9,
    `ellipsoids` n x 6, `cylinders` n x 7, `capsules` n x 7, or `mesh` = (vertices n x 3, faces m x 3), which
    `transform` (4 x 4, or 3 x 4) moves, in float64. Solids are doubles; with inputs="shared" they are rounded once to
    float32, so that every format gets the same numbers, with "own" each format rounds them itself.
    """
    plurals = {("boxes" if shape == "box" else shape + "s"): shape for shape in SHAPES}
    for key in solids:
        word(key, plurals, "a solid's name")
    handle = lib.Handle("scene")
    if name is not None:
        if camera is not None or mesh is not None or solids:
            raise lib.InputError("scene: has a name, and solids or a camera of its own; write one or the other")
        is_text = "\n" in name
        where = _where(size, set, data)
        lib.call("lostbits_scene_text" if is_text else "lostbits_scene_open", name.encode(), c.byref(where),
                 c.byref(handle.pointer))
        return Scene(handle, name if is_text else None, None if is_text else name)
    if camera is None:
        raise lib.InputError("scene: no name and no camera; write camera={\"kind\": \"pinhole\", \"eye\": ..., "
                             "\"look_at\": ..., \"fov_deg\": 40}")
    if mesh is None and not solids:
        raise lib.InputError("scene: no solids; write spheres=, boxes=, triangles=, ... or mesh=(vertices, faces)")
    text = "\n".join(['schema = "lostbits-scene/1"', 'title = "arrays"', f"inputs = {_toml(inputs)}",
                      f"size = {_toml(list(size or (256, 256)))}", "[camera]",
                      *(f"{key} = {_toml(value)}" for key, value in camera.items()),
                      "[[sphere]]", "centre = [0, 0, 0]", "radius = 1", ""])
    where = _where(None, set, data)
    lib.call("lostbits_scene_text", text.encode(), c.byref(where), c.byref(handle.pointer))
    for key, value in solids.items():
        shape = plurals[key]
        numbers = np.ascontiguousarray(_numbers(value, key), dtype=np.float64)
        numbers = numbers[None] if numbers.ndim == 1 else numbers
        if numbers.ndim != 2 or numbers.shape[1] != _counts[shape]:
            raise lib.InputError(f"{key} has shape {numbers.shape}; it is n x {_counts[shape]}: "
                                 + ", ".join(f"{k} {n}" for k, n in SHAPES[shape]))
        lib.call("lostbits_scene_solids", handle.pointer, shape.encode(), numbers.ctypes.data_as(c.c_void_p),
                 c.c_size_t(len(numbers)))
    if mesh is not None:
        _put_mesh(handle, mesh, transform)
    return Scene(handle, None, None)


def _numbers(value: Any, name: str) -> Any:
    try:
        return np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise lib.InputError(f"{name} is not an array of numbers") from None


def _put_mesh(handle: lib.Handle, mesh: Any, transform: Any) -> None:
    if not isinstance(mesh, (tuple, list)) or len(mesh) != 2:
        raise lib.InputError("mesh is (vertices, faces): arrays n x 3 of numbers and m x 3 of places among them")
    vertices, faces = _numbers(mesh[0], "the mesh's vertices"), np.asarray(mesh[1])
    if vertices.ndim != 2 or vertices.shape[1] != 3 or faces.ndim != 2 or faces.shape[1] != 3:
        raise lib.InputError(f"mesh: vertices have shape {vertices.shape} and faces {faces.shape}; they are n x 3 and m x 3")
    if faces.dtype.kind not in "iu" or faces.size and (faces.min() < 0 or faces.max() >= len(vertices)):
        raise lib.InputError(f"mesh: faces are whole numbers from 0 to {len(vertices) - 1}, places among the vertices")
    if transform is not None:
        matrix = _numbers(transform, "transform")
        if matrix.shape not in ((4, 4), (3, 4)):
            raise lib.InputError(f"transform has shape {matrix.shape}; it is 4 x 4 or 3 x 4")
        vertices = vertices @ matrix[:3, :3].T + matrix[:3, 3]
    vertices, faces = np.ascontiguousarray(vertices), np.ascontiguousarray(faces, dtype=np.uint32)
    lib.call("lostbits_scene_mesh", handle.pointer, vertices.ctypes.data_as(c.c_void_p), c.c_size_t(len(vertices)),
             faces.ctypes.data_as(c.c_void_p), c.c_size_t(len(faces)))


def _scene(value: Union[Scene, str]) -> Scene:
    if isinstance(value, Scene):
        return value
    if isinstance(value, str):
        return scene(value)
    raise lib.InputError(f"a scene is a name or what lb.scene(...) makes, not {_article(value)}")


def _write_all(own: Sequence[Intersector], on: Optional[Scene], formats: Sequence[str], metrics: Sequence[str]) -> None:
    """The operations of one's own forms, where something is asked that needs them."""
    formats = [formats] if isinstance(formats, str) else formats
    if all(f in ("f32", "f64") for f in formats) and not metrics:
        return
    for form in own:
        if on is not None:
            form.write(lambda dtype, form=form: on._sample(form.shape, dtype))  # type: ignore[misc]


# ---- questions ----


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
    on = _scene(scene)
    own, names = forms_of(forms)
    _write_all(own, on, formats, metrics)
    _, result = _measured("lostbits_map", on.handle.pointer, c.byref(_choice(own, names, formats, metrics, pixels)),
                          own=own, threads=threads, progress=progress, title="map")
    return Map(lib.tables_of(result), on.size)


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
    given = _Rays(o, d, solids, shape, t, hit, tmin, tmax, paired, format, direction, touching, at_origin, inside)
    formats = list(formats) or [format or ("f64" if t is not None and t.dtype == np.float64 else "f32")]
    _, result = _measured("lostbits_judge", c.byref(given.raw), c.byref(_choice(own, names, formats, metrics, rows)),
                          own=own, threads=threads, progress=progress, title="judge")
    return Judgement(lib.tables_of(result))


def ask(form: Form, o: Floats, d: Floats, solids: Any, *, shape: str = "sphere", format: str = "f32",
        paired: bool = False, written: bool = False, threads: int = 0) -> lib.Table:
    """What a form answers to rays, in any format: a table of `hit` (n booleans) and `t` (n, nan where it misses).

    `written`: of an intersector of one's own, what its operations give, which is what other formats than f32 and f64 run.
    """
    own, names = forms_of(form)
    given = _Rays(o, d, solids, own[0].shape if own else shape, paired=paired)
    if own and not written and format not in ("f32", "f64"):
        dtype_of = given.kept
        own[0].write(lambda dtype: _paired_sample(dtype_of, paired, dtype))
    _, result = _measured("lostbits_answers", c.byref(given.raw),
                          c.byref(_choice(own, names, [format], (), False, written)), own=own, threads=threads)
    return next(iter(lib.tables_of(result).values()))


def _paired_sample(kept: Sequence[Any], paired: bool, dtype: Any) -> Tuple[Floats, Floats, Floats]:
    o, d, solids = (np.asarray(a, dtype=dtype)[:4096] for a in kept[:3])
    return o, d, solids if paired else solids[np.arange(len(o)) * len(solids) // len(o)]


def truth(o: Floats, d: Floats, solids: Any, *, shape: str = "sphere", paired: bool = False, direction: str = "any",
          touching: str = "hit", at_origin: str = "hit", inside: str = "usual", tmin: Optional[Floats] = None,
          tmax: Optional[Floats] = None, threads: int = 0) -> Truths:
    """The certified truth of rays: `hit` (booleans), `t` (the nearest double, nan of a miss) and `t_lo` (what is left, so
    that t + t_lo is the exact t to 2^-72 of itself), `solid` (which is hit first, from 0; -1 of a miss), `resolved`.

    `o`, `d`: n x 3 of float32 or float64, taken as exact. `solids`: m x k numbers of a `shape` (spheres: centre, radius),
    or a scene.
    """
    given = _Rays(o, d, solids, shape, None, None, tmin, tmax, paired, "f64", direction, touching, at_origin, inside)
    _, result = _measured("lostbits_truth", c.byref(given.raw), threads=threads)
    return Truths(lib.tables_of(result)["truth"])


def sweep(of: Union[Scene, str], forms: Union[Form, Sequence[Form], None] = None,
          formats: Sequence[str] = ("f32", "f64"), *, along: Union[str, Mapping[str, float], None] = None,
          start: Optional[float] = None, to: Optional[float] = None, steps: int = 41, spacing: str = "log2",
          metrics: Sequence[str] = (), data: Optional[str] = None, threads: int = 0, progress: bool = True) -> Sweep:
    """The numbers of a map along a parameter, and where they first go wrong.

    `of`: a sweep that ships with lostbits, a path to one, its text; or a scene, with `along` the path of the number that
    changes ("sphere[0].radius"), several paths and the factor of each ({"camera.eye[2]": 2}), or "distance": the one
    sphere of the scene moves away from the camera. The number goes from `start` (that of the scene, where the path is
    one number) `to`, in `steps`, spacing "log2" or "linear". The result: `.samples`, `.onsets`, `.frame`, `.plot()`.
    """
    own, names = forms_of(forms)
    folder = data.encode() if data else lib.data_folder()
    text, is_text, on = (of, "\n" in of, None) if isinstance(of, str) else ("", True, of)
    if along is not None:
        on = _scene(of)
        text, is_text = _sweep_text(on, along, start, to, steps, spacing, folder), True
    elif on is not None:
        raise lib.InputError("sweep: of a scene, say what changes: along=\"sphere[0].radius\", to=1e6")
    _write_all(own, on, formats, metrics)
    _, result = _measured("lostbits_sweep", text.encode(), int(is_text), folder,
                          c.byref(_choice(own, names, formats, metrics)), own=own, threads=threads, progress=progress,
                          title="sweep")
    return Sweep(lib.tables_of(result))


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
        raise lib.InputError("sweep: say where it begins, as in start=1")
    lines = ['schema = "lostbits-sweep/1"', f"title = {_toml(f'{on.name} along {name}')}", 'source = "-"', f"scene = {_toml(path)}",
             "[[axis]]", f"name = {_toml(name)}", 'unit = "world"', f"spacing = {_toml(spacing)}",
             f"from = {_toml(float(start))}", f"to = {_toml(float(to))}", f"steps = {int(steps)}",
             f"set = {_toml(list(paths))}", f"factors = {_toml(list(paths.values()))}"]
    if bases is not None and any(bases):
        lines.append(f"bases = {_toml(bases)}")
    return "\n".join(lines) + "\n"


def explain(form: Form, scene: Union[Scene, str], pixel: Tuple[int, int], format: str = "f32") -> Explanation:
    """One ray of a scene, operation by operation: which one loses the bits.

    `form`: a name, or an intersector of one's own, whose unchanged function is followed; what cannot be followed is an
    Unfollowed with the file and line. `pixel`: column and row, from the left and from the top. The result prints what
    `lostbits explain` says; `.operations` is a table of them (`.frame` in pandas), `.culprit` names the one to blame.
    """
    on = _scene(scene)
    own, names = forms_of(form)
    if len(own) + len(names) != 1:
        raise lib.InputError("explain looks at one form; name one")
    if not (isinstance(pixel, tuple) and len(pixel) == 2):
        raise lib.InputError(f"pixel is (column, row), such as (100, 90), not {pixel!r}")
    for mine in own:
        mine.write(lambda dtype: on._sample(mine.shape, dtype))
    result = lib.Handle("result")
    try:
        lib.call("lostbits_explain", on.handle.pointer, c.c_int(pixel[0]), c.c_int(pixel[1]),
                 c.byref(_choice(own, names, [format])), c.byref(result.pointer))
    except lib.Error:
        for mine in own:
            mine.raise_own()
        raise
    text, found = lib.texts_of(result)
    lines = own[0].tapes[64 if format == "f64" else 32] if own else None
    return Explanation(text, json.loads(found), lines)


def choose(scene: Union[Scene, str], bits: float, *, wrong: float = 0, at: str = "p99",
           forms: Union[Form, Sequence[Form], None] = None, formats: Sequence[str] = ("f32", "f64"), threads: int = 0,
           progress: bool = True) -> Choice:
    """The cheapest form and format that keeps `bits` correct bits of t on `at` ("p99", "max") of the hits and decides at
    most a share `wrong` of the rays wrongly. The result: `.chosen`, (form, format) or None; `.candidates`, cheapest
    first; `.room`, how far it holds; `.text`. Times are measured anew each time.
    """
    on = _scene(scene)
    own, names = forms_of(forms)
    code, result = _measured("lostbits_choose", on.handle.pointer, c.c_double(bits), c.c_double(wrong),
                             at.encode(), c.byref(_choice(own, names, formats)), own=own, threads=threads,
                             progress=progress, title="choose")
    return Choice(lib.tables_of(result), lib.texts_of(result)[0], code == 0)


__all__ = ["Scene", "Unfollowed", "ask", "choose", "explain", "judge", "map", "scene", "sweep", "truth"]
