"""The questions: maps, judged rays, truths, crossings, sweeps, explained rays, offsets, choices, mended forms."""

from __future__ import annotations

import ctypes as c
import json
import os
import tomllib
from typing import Any, Mapping, Sequence, Union

import numpy as np
from numpy.typing import NDArray

from . import _library as lib
from ._arrays import Floats, Rays, array_of
from ._forms import Asked, Form, Forms, Texts
from ._results import Choice, Explanation, Hits, Inside, Judgement, Map, Mended, Offsets, Sweep, Truths
from ._scene import Scene, scene as make_scene, scene_of, toml_text
from ._tables import Table, tables_of, texts_of

_both = ("f32", "f64")


def map(scene: Union[Scene, str], forms: Forms = None, formats: Texts = _both, metrics: Texts = (), *,
        pixels: bool = True, threads: int = 0, progress: bool = True) -> Map:
    """Every form in every format over the pixels of a scene, against the certified truth: where bits are lost.

    `forms`: names and globs ("sphere.unified", "box.*") and intersectors of one's own; none: all that fit. `formats`:
    "f32", "f64", "fp16", "bf16", "tf32", "p11" (11 significand bits), "p5..p12". `metrics`: beside the default ones,
    such as "culprit", "model_error", "condition". The result: `m.summary`, a row a form and format; `m.frame`, the same
    in pandas; `m.pixels["sphere.unified", "f32"].lost_bits`, height x width, nan where there is none. Bits are those of
    `lostbits map`. Ctrl-C ends it within a second.

    >>> m = lb.map("near-benign", ["sphere.unified", "sphere.schoolbook"])
    """
    on, asked = scene_of(scene), Asked(forms, formats, metrics, pixels)
    asked.write_for(on.sample)
    _, result = asked.call("lostbits_map", on.handle.pointer, threads=threads, progress=progress)
    return Map(tables_of(result), on.size)


def judge(o: Floats, d: Floats, t: Floats | None, hit: NDArray[np.bool_] | None = None, solids: Any = None, *,
          shape: str = "sphere", paired: bool = False, forms: Forms = None, formats: Texts = (), metrics: Texts = (),
          by: Any = None, bits: float | None = None, tolerance: float | None = None, rows: bool = True,
          threads: int = 0, progress: bool = True, tmin: Floats | None = None, tmax: Floats | None = None,
          matrix: Floats | None = None, open_ends: str = "none", format: str | None = None, direction: str = "any",
          touching: str = "hit", at_origin: str = "hit", inside: str = "usual", facing: str = "both") -> Judgement:
    """Rays and the answers that some code gave to them, against the certified truth.

    `o`, `d`: n x 3, float32 or float64, read where they lie, whatever their strides. `t`: n, in lengths of d (of d
    normalised with direction="unit"), nan where it misses; `hit`: n booleans, where t does not say it. `solids`: m x k
    numbers of a `shape`, which every ray is aimed at, or with paired=True one a ray, or a scene. `tmin`, `tmax`: where
    each ray begins and ends, both ends being part of it but for open_ends="tmin", "tmax" or "both". `matrix`, n x 12 or
    n x 3 x 4: what each ray's solid stands under, from its own space to the world, with one solid for all rays or with
    paired=True. `forms`: others that answer to the same rays. `format`: what t was computed in (default: its type).

    The result: `.summary`, `.frame`, `.rays` (a row a ray: outcome, lost_bits, truth, ...), `.of["sphere.unified",
    "f32"]`. `by`, an item a ray (depth, material, instance): the summary also has a row for each value, in its column
    `by`. `bits`: counts, in enough_bits_too_few, the hits that keep fewer. `tolerance`, in the unit of length of the
    numbers given: in tolerance_beyond those farther than it from the true point, along the ray.
    """
    wished = [f"enough_bits:{bits!r}"] if bits is not None else []
    if tolerance is not None:
        wished += ["distance_error", f"tolerance:{float(tolerance)!r}"]
    given = Rays(o, d, solids, shape, paired, t=t, hit=hit, tmin=tmin, tmax=tmax, by=by, matrix=matrix,
                 open_ends=open_ends, format=format, direction=direction, touching=touching, at_origin=at_origin,
                 inside=inside, facing=facing)
    own_format = format or ("f64" if t is not None and t.dtype == np.float64 else "f32")
    asked = Asked(forms, formats or own_format, [*lib.texts(metrics, "metrics"), *wished], rows)
    _, result = asked.call("lostbits_judge", c.byref(given.raw), threads=threads, progress=progress)
    tables = tables_of(result)
    if by is not None:
        tables["summary"].columns["by"].rename(given.values)
    return Judgement(tables)


def ask(form: Form, o: Floats, d: Floats, solids: Any, *, shape: str = "sphere", format: str = "f32",
        paired: bool = False, written: bool = False, tmin: Floats | None = None, tmax: Floats | None = None,
        threads: int = 0) -> Table:
    """What a form answers to rays, in any format: a table of `hit` (n booleans) and `t` (n, nan where it misses).

    `written`: of an intersector of one's own, what its operations give, which other formats than f32 and f64 run.
    """
    asked = Asked(form, format, written=written)
    given = Rays(o, d, solids, asked.own[0].shape if asked.own else shape, paired, tmin=tmin, tmax=tmax)

    def sample(_: str, dtype: Any) -> Any:
        o, d, solids = (np.asarray(a, dtype=dtype)[:4096] for a in given.kept[:3])
        return o, d, solids if paired else solids[np.arange(len(o)) * len(solids) // len(o)]

    asked.write_for(sample)
    return asked.answers(given, threads=threads)


def truth(o: Floats, d: Floats, solids: Any, *, shape: str = "sphere", paired: bool = False, direction: str = "any",
          touching: str = "hit", at_origin: str = "hit", inside: str = "usual", facing: str = "both",
          tmin: Floats | None = None, tmax: Floats | None = None, matrix: Floats | None = None,
          open_ends: str = "none", threads: int = 0) -> Truths:
    """The certified truth of rays: `hit` (booleans), `t` (the nearest double, nan of a miss) and `t_lo` (what is
    left, so that t + t_lo is the exact t to 2^-72 of itself), `solid` (which is hit first, from 0; -1 of a miss),
    `resolved`.

    `o`, `d`: n x 3 of float32 or float64, taken as exact. `solids`: m x k numbers of a `shape` (spheres: centre,
    radius), or a scene. `tmin`, `tmax`, `open_ends`, `matrix`: as in lb.judge.
    """
    given = Rays(o, d, solids, shape, paired, tmin=tmin, tmax=tmax, matrix=matrix, open_ends=open_ends, format="f64",
                 direction=direction, touching=touching, at_origin=at_origin, inside=inside, facing=facing)
    return Truths(tables_of(lib.long_call("lostbits_truth", c.byref(given.raw), threads=threads)[1])["truth"])


def hits(o: Floats, d: Floats, mesh: Any, *, tmin: Floats | None = None, tmax: Floats | None = None,
         open_ends: str = "none", threads: int = 0) -> Hits:
    """Every crossing of rays with triangles, certified, in the exact order of t; crossings at the same t share a place.

    `o`, `d`: n x 3 of float32 or float64, taken as exact. `mesh`: (vertices n x 3, faces m x 3), triangles m x 9, or a
    scene of meshes and triangles alone. Triangles are closed and met from both sides. `tmin`, `tmax`, `open_ends`: as in
    lb.judge. The result: `.ray`, `.place`, `.solid` (the triangle), `.t` and `.t_lo`, `.front` (the ray meets the side
    on which the corners run counter-clockwise), `.at_rim` (through an edge or a vertex), `.of(ray)`, `.resolved`.
    """
    given = Rays(o, d, _of_mesh(mesh), "triangle", tmin=tmin, tmax=tmax, open_ends=open_ends, format="f64")
    return Hits(tables_of(lib.long_call("lostbits_hits", c.byref(given.raw), threads=threads)[1]))


def inside(points: Floats, mesh: Any, *, threads: int = 0) -> Inside:
    """Tells which points lie in a mesh, certified, by winding numbers: exact counts of the crossings of a ray.

    `points`: n x 3 of float32 or float64. `mesh`: (vertices n x 3, faces m x 3), or a scene of meshes alone. The result:
    `.inside`, `.winding` (1 inside a closed mesh whose corners run counter-clockwise seen from outside), `.on_surface`
    (the winding is 0 there), `.crossings` of the ray that was counted, `.resolved`, and `.mesh`: the number of edges,
    and of those that keep the mesh from being closed.
    """
    kept, array = array_of(points, "points", 3)
    if kept is None:
        raise lib.InputError("points is None; give an array, n x 3")
    on = _of_mesh(mesh)
    if not isinstance(on, Scene):
        raise lib.InputError("mesh is (vertices, faces): arrays n x 3 of numbers and m x 3 of places among them")
    return Inside(tables_of(lib.long_call("lostbits_inside", on.handle.pointer, c.byref(array), c.c_size_t(len(kept)),
                                          threads=threads)[1]))


def _of_mesh(mesh: Any) -> Any:
    """A scene of (vertices, faces), whose numbers stay as they are; anything else as it is."""
    if not isinstance(mesh, (tuple, list)):
        return mesh
    camera = {"kind": "orthographic", "eye": [0, 0, 1], "look_at": [0, 0, 0], "width": 1}
    return make_scene(camera=camera, mesh=mesh, inputs="own")  # type: ignore[arg-type]


def offsets(scene: Union[Scene, str], forms: Forms = None, formats: Texts = "f32", strategies: Texts = (),
            points: str = "both", *, threads: int = 0, progress: bool = True) -> Offsets:
    """How far the origin of the next ray must move, point by point, and what published strategies do.

    `forms` find the points and are asked for self-hits; none: sphere.half_b, box.ieee_minmax, one of each other shape.
    `strategies`: names and globs; none: all. `points`: "computed", "projected" (put back onto the surface) or "both".
    The result: `.summary`, a row a strategy, side, point, form and format, with lengths in the scene's own unit.
    """
    on, asked, words = scene_of(scene), Asked(forms, formats), lib.Words(lib.texts(strategies, "strategies"), "strategies")
    _, result = asked.call("lostbits_offsets", on.handle.pointer, c.byref(words), lib.in_utf8(points, "points"), threads=threads,
                           progress=progress)
    return Offsets(tables_of(result)["offsets"])


def sweep(of: Union[Scene, str], forms: Forms = None, formats: Texts = _both, *,
          along: Union[str, Mapping[str, float], None] = None, start: float | None = None, to: float | None = None,
          steps: int = 41, spacing: str = "log2", metrics: Texts = (), data: str | None = None, threads: int = 0,
          progress: bool = True) -> Sweep:
    """The numbers of a map along a parameter, and where they first go wrong.

    `of`: a sweep that ships with lostbits, a path to one, its text; or a scene, with `along` the path of the number
    that changes ("sphere[0].radius"), several paths and the factor of each ({"camera.eye[2]": 2}), or "distance": the
    one sphere of the scene moves away from the camera. The number goes from `start` (of "distance": what it is in the
    scene) `to`, in `steps`, spacing "log2" or "linear". The result: `.samples`, `.onsets`, `.frame`, `.plot()`.
    """
    folder, asked = lib.data_folder(data), Asked(forms, formats, metrics)
    on = of if isinstance(of, Scene) else None
    text = _sweep_text(scene_of(of), along, start, to, steps, spacing, folder) if along is not None else of
    if not isinstance(text, str):
        raise lib.InputError(f"sweep: of {scene_of(text)!r}, say what changes: along=\"sphere[0].radius\", to=1e6")
    if on is not None:
        asked.write_for(on.sample)
    _, result = asked.call("lostbits_sweep", lib.in_utf8(text, "of"), int("\n" in text), folder, threads=threads,
                           progress=progress)
    return Sweep(tables_of(result))


def _sweep_text(on: Scene, along: Union[str, Mapping[str, float]], start: float | None, to: float | None, steps: int,
                spacing: str, folder: bytes | None) -> str:
    if to is None:
        raise lib.InputError("sweep: say how far, as in to=1e6")
    if on.name is None:
        raise lib.InputError("sweep: this scene has no file; save its text as one, and name that")
    in_data = os.path.join((folder or b"data").decode(), "scenes", on.name + ".toml")
    path = os.path.abspath(on.name if os.path.isfile(on.name) else in_data)
    bases, name = list[float](), "value"
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
    if start is None:
        raise lib.InputError(f"sweep: along={along!r} is a number of the scene, and says nothing of where it begins; "
                             "write start=1, or along=\"distance\"")
    paths = {along: 1.0} if isinstance(along, str) else dict(along)
    axis = {"name": name, "unit": "world", "spacing": spacing, "from": lib.number(start, "start"),
            "to": lib.number(to, "to"), "steps": lib.whole(steps, "steps"), "set": list(paths), "factors": list(paths.values()),
            **({"bases": bases} if any(bases) else {})}
    lines = ['schema = "lostbits-sweep/1"', f"title = {toml_text(f'{on.name} along {name}')}", 'source = "-"',
             f"scene = {toml_text(path)}", "[[axis]]", *(f"{key} = {toml_text(value)}" for key, value in axis.items())]
    return "\n".join(lines) + "\n"


def explain(form: Form, scene: Union[Scene, str], pixel: tuple[int, int], format: str = "f32") -> Explanation:
    """One ray of a scene, operation by operation: which one loses the bits.

    `form`: a name, or an intersector of one's own, whose unchanged function is followed; what cannot be followed is an
    Unfollowed with the file and line. `pixel`: column and row, from the left and from the top. The result prints what
    `lostbits explain` says; `.operations` is a table of them (`.frame` in pandas), `.culprit` names the one to blame.
    """
    on, asked = scene_of(scene), Asked(form, format)
    if len(asked.own) + len(asked.names) != 1:
        raise lib.InputError("explain looks at one form; name one")
    if not (isinstance(pixel, tuple) and len(pixel) == 2):
        raise lib.InputError(f"pixel is (column, row), such as (100, 90), not {pixel!r}")
    place = [lib.whole(k, f"pixel[{i}]") for i, k in enumerate(pixel)]
    asked.write_for(on.sample, always=True)
    _, result = asked.call("lostbits_explain", on.handle.pointer, *(c.c_int(k) for k in place), quick=True)
    text, found = texts_of(result)
    tapes = asked.own[0].tapes if asked.own else {}
    return Explanation(text, json.loads(found), tapes.get(format, tapes.get("f32")))


def _wish(bits: float, tolerance: float, wrong: float, at: str) -> Any:
    return lib.Wish(lib.number(bits, "bits"), lib.number(tolerance, "tolerance"), lib.number(wrong, "wrong"),
                    lib.in_utf8(at, "at"))


def choose(scene: Union[Scene, str], bits: float | None = None, *, tolerance: float | None = None, wrong: float = 0,
           at: str = "p99", forms: Forms = None, formats: Texts = _both, threads: int = 0,
           progress: bool = True) -> Choice:
    """The cheapest form and format that keeps `bits` correct bits of t on `at` ("p99", "max") of the hits, whose hit
    point is no farther than `tolerance` from the true one along the ray (in the scene's own unit of length), and that
    decides at most a share `wrong` of the rays wrongly. The result: `.chosen`, (form, format) or None; `.candidates`,
    cheapest first; `.room`, how far it holds; `.text`. Times are measured anew each time.
    """
    if bits is None and tolerance is None:
        raise lib.InputError("choose: no wish is given; add bits=16 (of t) or tolerance=0.001 (of the hit point)")
    on, asked = scene_of(scene), Asked(forms, formats)
    wish = _wish(bits or 0, -1 if tolerance is None else tolerance, wrong, at)
    code, result = asked.call("lostbits_choose", on.handle.pointer, c.byref(wish), threads=threads, progress=progress)
    return Choice(tables_of(result), texts_of(result)[0], code == 0)


def mend(form: Form, scene: Union[Scene, str], bits: float, *, wrong: float = 0, at: str = "max", format: str = "f32",
         two_words: bool = False, threads: int = 0, progress: bool = True) -> Mended:
    """What to change in a form so that t keeps `bits` correct bits on `at` ("p99", "max") of the hits of a scene, and at
    most a share `wrong` of the rays is decided wrongly: the fewest operations that must be done in float64 (with
    two_words=True in two floats), and other ways of writing it.

    `form`: a name, or an intersector of one's own, whose unchanged function is followed as in lb.explain. The result
    prints what `lostbits mend` says; `.operations` are those that must be wider, each with its `line` in the function's
    file; `.forms` a row for each form that came out and each of the catalogue; `.code` the one to take as C++, or None.
    """
    on, asked = scene_of(scene), Asked(form, format)
    if len(asked.own) + len(asked.names) != 1:
        raise lib.InputError("mend changes one form; name one")
    asked.write_for(on.sample, always=True)
    wish = _wish(bits, -1, wrong, at)
    code, result = asked.call("lostbits_mend", on.handle.pointer, c.byref(wish), c.c_int(bool(two_words)), threads=threads,
                              progress=progress)
    tapes = asked.own[0].tapes if asked.own else {}
    return Mended(tables_of(result), texts_of(result), code == 0, tapes.get(format))
