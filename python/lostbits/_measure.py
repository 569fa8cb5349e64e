"""The calls that measure: map, judge, judge_mesh, ask, truth, hits, inside, studies, sweep, explain, choose, mend."""

from __future__ import annotations

import ctypes as c
import json
import os
import tomllib
import warnings
from typing import Any, Mapping, Sequence, Union

import numpy as np
from numpy.typing import NDArray

from . import _library as lib
from ._arrays import Floats, Rays, array_of, one_per_record, primitives_in, word
from ._forms import Asked, Form, Forms, Texts
from ._results import (Checked, Choice, Explanation, Hits, Inside, Judgement, Map, Mended, MeshJudgement, Study, Sweep,
                       Trade, Truths)
from ._scene import Scene, scene as make_scene, scene_of, toml_text
from ._tables import Table, tables_of, texts_of

_both = ("f32", "f64")


def map(scene: Union[Scene, str], forms: Forms = None, formats: Texts = _both, metrics: Texts = (), *,
        pixels: bool = True, threads: int = 0, progress: bool = True) -> Map:
    """Compares every form in every format with the certified truth, over the pixels of a scene.

    - `scene`: a name, a path, the text of a scene file, or what lb.scene returns.
    - `forms`: names, globs ("sphere.unified", "box.*") and intersectors of your own. None: all that fit the scene.
    - `formats`: "f32", "f64", "fp16", "bf16", "tf32", "p11" (11 significand bits), "p5..p12".
    - `metrics`: metrics beside the default ones, such as "culprit", "model_error", "condition".
    - `pixels`: False leaves out the results of single pixels and saves memory.
    - `threads`: 0 for one per core. `progress`: shows the progress on a terminal or in a notebook.

    The result `m` has `m.summary`, one row per form and format, and `m.frame`, the same in pandas.
    `m.pixels["sphere.unified", "f32"].lost_bits` is an array of shape (height, width), in bits, with nan where the
    pixel has no value. The numbers are those of `lostbits map`, to the bit.

    Ctrl-C ends the call within a second. Raises InputError, EnvironmentFault or NothingSelected, and what a function of
    yours raised.

    >>> m = lb.map("near-benign", ["sphere.unified", "sphere.schoolbook"])
    """
    on, asked = scene_of(scene), Asked(forms, formats, metrics, pixels)
    asked.write_for(on.sample)
    _, result = asked.call("lostbits_map", on.handle.pointer, threads=threads, progress=progress)
    _warn(result)
    return Map(tables_of(result), on.size)


class Suspicious(UserWarning):
    """A function, or given answers, are wrong on most rays, and what mistake would explain it."""


class OpenMesh(UserWarning):
    """A mesh is not closed, or its faces do not all face the same side, so that a result depends on the ray chosen."""


def _warn(result: lib.Handle) -> None:
    for text in texts_of(result):
        warnings.warn(text, Suspicious, stacklevel=3)


def check(form: Form, scene: Union[Scene, str], *, bits: float | None = None, wrong: float = 0, at: str = "max",
          format: str = "f32", threads: int = 0) -> Checked:
    """Tells if a form meets a requirement on the rays of a scene. The result is true if it does.

    - `form`: a name, or an intersector of your own.
    - `bits`: correct bits of t that must be kept, or None.
    - `at`: the share of the correct hits on which they must be kept: "p50", "p99", "p99.9" or "max" (every hit).
    - `wrong`: largest allowed fraction of rays with a wrong decision, 0 to 1. A ray whose truth is not proved counts.

    The result has `.ok`, `.text` (what was required and found, and the worst pixel) and `.summary`, as lb.map.
    """
    shares = {"p50": 0.5, "p99": 0.01, "p99.9": 0.001, "max": 0.0}
    fewer = word(at, shares, "at")
    most = lib.number(wrong, "wrong")
    if not 0 <= most <= 1:
        raise lib.InputError(f"wrong is {wrong}; it must be a fraction of the rays, from 0 to 1")
    if bits is not None and not 0 < lib.number(bits, "bits") <= 53:
        raise lib.InputError(f"bits is {bits}; it must be above 0 and at most 53")
    needed = [] if bits is None else [f"enough_bits:{float(bits)!r}"]
    found = map(scene, form, format, needed, pixels=False, threads=threads, progress=False)
    if len(found.summary) != 1:
        raise lib.InputError(f"check takes one form in one format, and {len(found.summary)} were chosen; name one")
    return Checked(found.summary, bits, fewer, most)


def assert_keeps(form: Form, scene: Union[Scene, str], bits: float | None = None, **how: Any) -> None:
    """Raises an AssertionError, with the text of lb.check, if a form does not meet a requirement; for tests.

    >>> def test_mine(): lb.assert_keeps(mine, "near-benign", bits=16)
    """
    found = check(form, scene, bits=bits, **how)
    if not found.ok:
        raise AssertionError(found.text)


def judge(o: Floats, d: Floats, t: Floats | None, hit: NDArray[np.bool_] | None = None, primitives: Any = None, *,
          shape: str = "sphere", paired: bool = False, forms: Forms = None, formats: Texts = (), metrics: Texts = (),
          by: Any = None, bits: float | None = None, tolerance: float | None = None, rows: bool = True,
          threads: int = 0, progress: bool = True, tmin: Floats | None = None, tmax: Floats | None = None,
          matrix: Floats | None = None, open_ends: str = "none", format: str | None = None, direction: str = "any",
          touching: str = "hit", at_origin: str = "hit", inside: str = "usual", facing: str = "both",
          **named: Any) -> Judgement:
    """Compares answers that other code gave to rays with the certified truth.

    - `o`, `d`: origins and directions, n x 3, float32 or float64. They are read in place, with any strides.
    - `t`: n distances in lengths of d (of d normalised with direction="unit"), nan for a miss. None if no answers are
      judged but only `forms`.
    - `hit`: n booleans, needed if t does not mark misses by nan.
    - `primitives`: primitives, m x k numbers of a `shape`, which every ray may hit; with paired=True n x k, one per ray;
      or a scene. `spheres=array` is short for primitives=array, shape="sphere", and so on for every shape.
    - `tmin`, `tmax`: n numbers each, the range of each ray. Both ends belong to it, except those that `open_ends` names
      ("tmin", "tmax" or "both").
    - `matrix`: n x 12 or n x 3 x 4. The transform of the primitive of each ray, from the space of the primitive to the
      world. Needs one primitive for all rays, or paired=True.
    - `forms`: forms that answer the same rays. `formats`: their formats, by default that of t.
    - `format`: the format that t was computed in, by default its type.
    - `direction`, `touching`, `at_origin`, `inside`, `facing`: what counts as right, as in lb.intersector.
    - `by`: one item per ray (depth, material, instance). The summary then also has one row per value, named in its
      column `by`.
    - `bits`: the column enough_bits_too_few counts the hits that keep fewer correct bits.
    - `tolerance`, in the unit of length of the given numbers: the column tolerance_beyond counts the hits that are
      farther than this from the true point, along the ray.

    The result has `.summary`, `.frame`, `.rays` (one row per ray: outcome, lost_bits, truth, ...; kept with rows=True)
    and `.of["sphere.unified", "f32"]`, the rays of one form. Raises InputError for arrays of another shape or type.
    """
    primitives, shape = primitives_in(primitives, shape, named)
    needed = [f"enough_bits:{bits!r}"] if bits is not None else []
    if tolerance is not None:
        needed += ["distance_error", f"tolerance:{float(tolerance)!r}"]
    given = Rays(o, d, primitives, shape, paired, t=t, hit=hit, tmin=tmin, tmax=tmax, by=by, matrix=matrix,
                 open_ends=open_ends, format=format, direction=direction, touching=touching, at_origin=at_origin,
                 inside=inside, facing=facing)
    own_format = format or ("f64" if t is not None and t.dtype == np.float64 else "f32")
    asked = Asked(forms, formats or own_format, [*lib.texts(metrics, "metrics"), *needed], rows)
    _, result = asked.call("lostbits_judge", c.byref(given.raw), threads=threads, progress=progress)
    _warn(result)
    tables = tables_of(result)
    if by is not None:
        tables["summary"].columns["by"].rename(given.values)
    return Judgement(tables)


def ask(form: Form, o: Floats, d: Floats, primitives: Any = None, *, shape: str = "sphere", format: str = "f32",
        paired: bool = False, written: bool = False, tmin: Floats | None = None, tmax: Floats | None = None,
        threads: int = 0, **named: Any) -> Table:
    """Answers of one form to rays, in any format: a table of `hit` (n booleans) and `t` (n, nan for a miss).

    `o`, `d`, `primitives` (or `spheres`, ...), `shape`, `paired`, `tmin`, `tmax`: as in lb.judge. `written`: runs the
    recorded operations of an intersector of your own, not the function. Formats other than f32 and f64 always do.
    """
    primitives, shape = primitives_in(primitives, shape, named)
    asked = Asked(form, format, written=written)
    given = Rays(o, d, primitives, asked.own[0].shape if asked.own else shape, paired, tmin=tmin, tmax=tmax)

    def sample(_: str, dtype: Any) -> Any:
        o, d, primitives = (np.asarray(a, dtype=dtype)[:4096] for a in given.kept[:3])
        return o, d, primitives if paired else primitives[np.arange(len(o)) * len(primitives) // len(o)]

    asked.write_for(sample)
    return asked.answers(given, threads=threads)


def truth(o: Floats, d: Floats, primitives: Any = None, *, shape: str = "sphere", paired: bool = False,
          direction: str = "any", touching: str = "hit", at_origin: str = "hit", inside: str = "usual", facing: str = "both",
          tmin: Floats | None = None, tmax: Floats | None = None, matrix: Floats | None = None,
          open_ends: str = "none", threads: int = 0, **named: Any) -> Truths:
    """Certified truth of rays.

    `o`, `d`: n x 3, float32 or float64, taken as exact. `primitives`: m x k numbers of a `shape` (spheres: centre,
    radius), or a scene; `spheres=array`, ... as in lb.judge. `tmin`, `tmax`, `open_ends`, `matrix`: as in lb.judge.

    The result has one item per ray:

    - `hit`: booleans.
    - `t`: the nearest double to the exact t, in lengths of d (of d normalised with direction="unit"); nan for a miss.
    - `t_lo`: the rest. t + t_lo is the exact t with a relative error of at most 2^-72.
    - `primitive`: index of the primitive that is hit first, from 0; -1 for a miss.
    - `resolved`: False where hit or miss could not be decided.
    """
    primitives, shape = primitives_in(primitives, shape, named)
    given = Rays(o, d, primitives, shape, paired, tmin=tmin, tmax=tmax, matrix=matrix, open_ends=open_ends, format="f64",
                 direction=direction, touching=touching, at_origin=at_origin, inside=inside, facing=facing)
    return Truths(tables_of(lib.long_call("lostbits_truth", c.byref(given.raw), threads=threads)[1])["truth"])


def hits(o: Floats, d: Floats, mesh: Any, *, tmin: Floats | None = None, tmax: Floats | None = None,
         open_ends: str = "none", threads: int = 0) -> Hits:
    """Every crossing of rays with triangles, certified, in the exact order of t; crossings at the same t share a place.

    `o`, `d`: n x 3 of float32 or float64, taken as exact. `mesh`: (vertices n x 3, faces m x 3), triangles m x 9, or a
    scene of meshes and triangles alone. Triangles are closed and met from both sides. `tmin`, `tmax`, `open_ends`: as in
    lb.judge. The result: `.ray`, `.place`, `.primitive` (the triangle), `.t` and `.t_lo`, `.front` (the ray meets the side
    on which the corners run counter-clockwise), `.at_rim` (through an edge or a vertex), `.of(ray)`, `.resolved`.
    """
    given = Rays(o, d, _of_mesh(mesh), "triangle", tmin=tmin, tmax=tmax, open_ends=open_ends, format="f64")
    return Hits(tables_of(lib.long_call("lostbits_hits", c.byref(given.raw), threads=threads)[1]))


def inside(points: Floats, mesh: Any, *, threads: int = 0) -> Inside:
    """Tells which points lie in a mesh, certified, by winding numbers: exact counts of the crossings of a ray.

    `points`: n x 3 of float32 or float64. `mesh`: (vertices n x 3, faces m x 3), or a scene of meshes alone. The result:
    `.inside`, `.winding` (1 inside a closed mesh whose corners run counter-clockwise seen from outside), `.on_surface`
    (the winding is 0 there), `.crossings` of the ray that is counted, `.resolved`, and `.mesh`: the number of edges,
    and of those that keep the mesh from being closed. Gives an lb.OpenMesh warning if there are such edges.
    """
    kept, array = array_of(points, "points", 3)
    if kept is None:
        raise lib.InputError("points is None; give an array, n x 3")
    on = _scene_of_mesh(mesh)
    found = Inside(tables_of(lib.long_call("lostbits_inside", on.handle.pointer, c.byref(array), c.c_size_t(len(kept)),
                                           threads=threads)[1]))
    odd, unbalanced, edges = (found.mesh[name] for name in ("odd", "unbalanced", "edges"))
    text = ""
    if odd > 0:
        text = (f"{odd} of the {edges} edges of the mesh belong to an odd number of faces, so the mesh is not closed; "
                "which points are inside depends on the ray")
    elif unbalanced > 0:
        text = (f"at {unbalanced} of the {edges} edges of the mesh, more faces run one way than the other, so `winding` "
                "depends on the ray; `inside` does not")
    if text:
        warnings.warn(text, OpenMesh, stacklevel=2)
    return found


def judge_mesh(mesh: Any, o: Floats, d: Floats | None = None, *, ray: Any = None, primitive: Any = None,
               t: Floats | None = None, crossings: Any = None, parity: Any = None, inside: Any = None,
               tmin: Floats | None = None, tmax: Floats | None = None, open_ends: str = "none",
               format: str | None = None, direction: str = "any", touching: str = "hit", facing: str = "both",
               rows: bool = True, threads: int = 0) -> MeshJudgement:
    """Compares answers about the whole surface of a mesh with its certified crossings, as `lostbits judge` does.

    `mesh`: (vertices n x 3, faces m x 3), or a scene of meshes alone. `o`, `d`: n x 3 of float32 or float64, the rays;
    for `inside`, `o` has points and `d` is left out. Give one of these:

    - `ray`, `primitive` and, if known, `t`: all hits of the rays, in the order of your code. Each has one item in each
      array: the index of the ray, the index of the triangle, and t. A ray that is not in `ray` has no hit.
    - `crossings`: n numbers, how often a ray crosses the surface. `parity`: n numbers, 1 for odd and 0 for even.
    - `inside`: n booleans, the points that are inside.

    `tmin`, `tmax`, `open_ends`, `format`, `direction`, `touching`, `facing`: as in lb.judge. The outcomes are those of
    docs/meshes.md. The result has `.summary`, `.frame`, and `.rays` with a row for each ray or point.
    """
    kinds = {"hit_index": ray, "crossings": crossings, "parity": parity, "inside": inside}
    given = [name for name, value in kinds.items() if value is not None]
    if len(given) != 1:
        raise lib.InputError("give one of ray (with primitive), crossings, parity and inside; " +
                             (f"{' and '.join(given)} are given" if given else "none is given"))
    kind, on = given[0], _scene_of_mesh(mesh)
    if (d is None) != (kind == "inside"):
        raise lib.InputError("points have no direction; leave out d" if d is not None else
                             "d is None; give the directions of the rays, n x 3")
    o = array_of(o, "o", 3)[0]
    values, objects, take, of_t = one_per_record(kind, kinds[kind], primitive, t, len(o))
    ends = {name: value if take is None or value is None else array_of(value, name, 0, len(o))[0][take]
            for name, value in (("tmin", tmin), ("tmax", tmax))}
    asked = Rays(o if take is None else o[take], o if d is None else d if take is None else d[take], on, "triangle",
                 t=of_t, open_ends=open_ends, format=format, direction=direction, touching=touching, facing=facing,
                 **ends)
    if d is None:
        asked.raw.direction = lib.Array()
    answers = lib.MeshAnswers(column=kind.encode(), values=array_of(values, "values", 0)[1], rows=int(bool(rows)))
    if objects is not None:
        answers.objects = array_of(objects, "objects", 0)[1]
    return MeshJudgement(tables_of(lib.long_call("lostbits_judge_mesh", c.byref(asked.raw), c.byref(answers),
                                                 threads=threads)[1]))


def _of_mesh(mesh: Any) -> Any:
    """A scene of (vertices, faces), whose numbers stay as they are, or of a name; anything else as it is."""
    if isinstance(mesh, str):
        return scene_of(mesh)
    if not isinstance(mesh, (tuple, list)):
        return mesh
    camera = {"kind": "orthographic", "eye": [0, 0, 1], "look_at": [0, 0, 0], "width": 1}
    return make_scene(camera=camera, mesh=mesh, inputs="own")  # type: ignore[arg-type]


def _scene_of_mesh(mesh: Any) -> Scene:
    on = _of_mesh(mesh)
    if not isinstance(on, Scene):
        raise lib.InputError("mesh must be (vertices, faces), arrays n x 3 of numbers and m x 3 of indices of vertices; "
                             "or the name of a scene, or what lb.scene(...) returns")
    return on


def _study(name: str, scene: Union[Scene, str], asked: Asked, threads: int, progress: bool,
           **options: tuple[str, Texts]) -> Study:
    """A study. `options`: the argument of each option, for messages, and its words."""
    on, words = scene_of(scene), []
    for option, (argument, given) in options.items():
        for text in lib.texts(given, argument):
            lib.in_utf8(text, argument)
            words.append(f"{option}={text}")
    _, result = asked.call("lostbits_study", lib.in_utf8(name, "study"), on.handle.pointer,
                           c.byref(lib.Words(words, "options")), threads=threads, progress=progress)
    return Study(tables_of(result)["summary"])


def consistency(scene: Union[Scene, str], forms: Forms = None, formats: Texts = "f32", checks: Texts = (), *,
                threads: int = 0, progress: bool = True) -> Study:
    """Puts one question to a form in two ways, at each pixel, and tells how often the answers differ.

    `forms`, `formats`: as in lb.map; None: all forms that fit. `checks`: names and globs of `lostbits list checks`,
    such as "reverse" or "packs"; none: all that apply.

    The result has `.summary`, one row per check, form and format: the counts of `lostbits consistency`.
    """
    return _study("consistency", scene, Asked(forms, formats), threads, progress, check=("checks", checks))


def offsets(scene: Union[Scene, str], forms: Forms = None, formats: Texts = "f32", strategies: Texts = (),
            points: Texts = "both", *, threads: int = 0, progress: bool = True) -> Study:
    """Measures how far the origin of the next ray must move at each hit point, and how published strategies do.

    `forms` find the points and are tested for self-hits. None: sphere.half_b, box.ieee_minmax, and one form of each
    other shape. `strategies`: names and globs; none: all. `points`: "computed", "projected" (moved back onto the
    surface) or "both".

    The result has `.summary`, one row per strategy, side, point, form and format. Lengths are in the scene's unit.
    """
    return _study("offsets", scene, Asked(forms, formats), threads, progress, strategy=("strategies", strategies),
                  points=("points", points))


def render(scene: Union[Scene, str], forms: Forms = None, formats: Texts = "f32", stages: Texts = (), *,
           threads: int = 0, progress: bool = True) -> Study:
    """Renders a scene of spheres with a form in a format, and compares every pixel with the certified picture.

    `forms` find hits and shadows. None: sphere.expanded. `stages`: "visible", "diffuse", "shadows", "phong"; none: the
    last that the scene has. A stage that it does not have is replaced by the last one before it.

    The result has `.summary`, one row per stage, form and format: the counts of `lostbits render`.
    """
    return _study("render", scene, Asked(forms, formats), threads, progress, stage=("stages", stages))


def study(name: str, scene: Union[Scene, str], forms: Forms = None, formats: Texts = "f32", *, threads: int = 0,
          progress: bool = True, **options: Texts) -> Study:
    """Measures a study of a scene by its name, such as "consistency".

    `forms`, `formats`: as in lb.map; None: the usual forms of the study. `options`: those of its command, by name:
    lb.study("consistency", "near-benign", check="reverse").

    The result has `.summary`, the columns of the command's summary.csv.
    """
    return _study(name, scene, Asked(forms, formats), threads, progress,
                  **{option: (option, words) for option, words in options.items()})


def sweep(of: Union[Scene, str], forms: Forms = None, formats: Texts = _both, *,
          along: Union[str, Mapping[str, float], None] = None, start: float | None = None, to: float | None = None,
          steps: int = 41, spacing: str = "log2", metrics: Texts = (), data: str | None = None, threads: int = 0,
          progress: bool = True) -> Sweep:
    """Measures a map at each step of a parameter, and finds where its numbers first go wrong.

    `of` is one of:

    - a sweep: the name of one that ships with lostbits, a path, or its text
    - a scene, together with `along`

    `along` says which number of the scene changes: its path ("sphere[0].radius"), several paths with a factor each
    ({"camera.eye[2]": 2}), or "distance", which moves the only sphere of the scene away from the camera. The number
    goes from `start` to `to` in `steps` steps, with spacing "log2" or "linear". For "distance", `start` defaults to the
    distance in the scene.

    The result has `.samples`, `.onsets`, `.frame` and `.plot()`. Raises InputError if `along`, `start` or `to` is
    needed but missing.
    """
    folder, asked = lib.data_folder(data), Asked(forms, formats, metrics)
    on = of if isinstance(of, Scene) else None
    text = _sweep_text(scene_of(of), along, start, to, steps, spacing, folder) if along is not None else of
    if not isinstance(text, str):
        raise lib.InputError(f"sweep: {scene_of(text)!r} is a scene; say what changes in it, as in "
                             "along=\"sphere[0].radius\", start=1, to=1e6")
    if on is not None:
        asked.write_for(on.sample)
    _, result = asked.call("lostbits_sweep", lib.in_utf8(text, "of"), int("\n" in text), folder, threads=threads,
                           progress=progress)
    return Sweep(tables_of(result))


def _sweep_text(on: Scene, along: Union[str, Mapping[str, float]], start: float | None, to: float | None, steps: int,
                spacing: str, folder: bytes | None) -> str:
    if to is None:
        raise lib.InputError("sweep: to is missing; say where the sweep ends, as in to=1e6")
    if on.name is None:
        raise lib.InputError("sweep: this scene has no file; save it as a .toml file, and give the path to that")
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
            raise lib.InputError(f"sweep: along=\"distance\" moves the only sphere, but the scene has {len(spheres)}; "
                                 "write the path of a number, as in along=\"sphere[0].centre[2]\"")
        at = float(np.dot([float(x) for x in spheres[0]["centre"]] - eye, view))
        start = at if start is None else start
        along = {f"sphere[0].centre[{k}]": float(view[k]) for k in range(3)}
        bases, name = [float(x) for x in eye], "distance"
    if start is None:
        raise lib.InputError(f"sweep: along={along!r} needs a first value; write it, as in start=1")
    paths = {along: 1.0} if isinstance(along, str) else dict(along)
    axis = {"name": name, "unit": "world", "spacing": spacing, "from": lib.number(start, "start"),
            "to": lib.number(to, "to"), "steps": lib.whole(steps, "steps"), "set": list(paths), "factors": list(paths.values()),
            **({"bases": bases} if any(bases) else {})}
    lines = ['schema = "lostbits-sweep/1"', f"title = {toml_text(f'{on.name} along {name}')}", 'source = "-"',
             f"scene = {toml_text(path)}", "[[axis]]", *(f"{key} = {toml_text(value)}" for key, value in axis.items())]
    return "\n".join(lines) + "\n"


def explain(form: Form, scene: Union[Scene, str], pixel: tuple[int, int], format: str = "f32") -> Explanation:
    """Explains one ray of a scene, operation by operation, and names the one that loses the bits.

    `form`: a name, or an intersector of your own, whose unchanged function is followed. `pixel`: (column, row), from 0,
    counted from the left and from the top.

    The result prints as the text of `lostbits explain`. `.operations` has one row per operation (`.frame` in pandas),
    and `.culprit` names the one to blame. Raises Unfollowed, with file and line, if the function does something that
    cannot be followed.
    """
    on, asked = scene_of(scene), Asked(form, format)
    if len(asked.own) + len(asked.names) != 1:
        raise lib.InputError("explain takes exactly one form; name one")
    if not (isinstance(pixel, tuple) and len(pixel) == 2):
        raise lib.InputError(f"pixel is {pixel!r}; it must be (column, row), such as (100, 90)")
    place = [lib.whole(k, f"pixel[{i}]") for i, k in enumerate(pixel)]
    asked.write_for(on.sample, always=True)
    _, result = asked.call("lostbits_explain", on.handle.pointer, *(c.c_int(k) for k in place), quick=True)
    text, found = texts_of(result)
    tapes = asked.own[0].tapes if asked.own else {}
    return Explanation(text, json.loads(found), tapes.get(format, tapes.get("f32")))


def trade(scene: Union[Scene, str, None] = None, forms: Forms = None, formats: Texts = _both, *,
          shape: str | None = None, quick: bool = False, threads: int = 0, progress: bool = True) -> Trade:
    """Measures speed against accuracy: on the rays of a scene, or on rays of known kinds at a shape (None: "sphere").

    `forms`, `formats`: as in lb.map. With `quick` the measurements are few and short.

    The result has `.times`, the columns of trade.csv; `.pareto`, those of pareto.csv, with the forms that no other one
    beats in both (`dominated` is false); and `.text`. Times are measured anew in each call.
    """
    if scene is not None and shape is not None:
        raise lib.InputError("shape: a scene is given, which has its own shapes; leave out one of the two")
    on, asked = None if scene is None else scene_of(scene), Asked(forms, formats)
    of = None if shape is None else lib.in_utf8(shape, "shape")
    _, result = asked.call("lostbits_trade", on.handle.pointer if on else None, of, c.c_int(bool(quick)),
                           threads=threads, progress=progress)
    return Trade(tables_of(result), texts_of(result)[0])


def _requirement(bits: float, tolerance: float, wrong: float, at: str) -> Any:
    return lib.Requirement(lib.number(bits, "bits"), lib.number(tolerance, "tolerance"), lib.number(wrong, "wrong"),
                           lib.in_utf8(at, "at"))


def choose(scene: Union[Scene, str], bits: float | None = None, *, tolerance: float | None = None, wrong: float = 0,
           at: str = "p99", forms: Forms = None, formats: Texts = _both, threads: int = 0,
           progress: bool = True) -> Choice:
    """Finds the cheapest form and format that meets a requirement on a scene.

    - `bits`: correct bits of t that must be kept.
    - `tolerance`: largest allowed distance of the hit point from the true one, along the ray, in the scene's unit of
      length. Give `bits`, `tolerance` or both.
    - `at`: the share of the hits on which they must hold: "p50", "p99", "p99.9" or "max" (every hit).
    - `wrong`: largest allowed fraction of rays with a wrong decision, 0 to 1.

    The result has `.chosen`, (form, format) or None if nothing meets the requirement; `.candidates`, cheapest first;
    `.room`, how far the requirement holds; and `.text`. Times are measured anew in each call.
    """
    if bits is None and tolerance is None:
        raise lib.InputError("choose: the requirement is missing; add bits=16 (correct bits of t) or tolerance=0.001 "
                             "(distance of the hit point from the true one)")
    on, asked = scene_of(scene), Asked(forms, formats)
    need = _requirement(bits or 0, -1 if tolerance is None else tolerance, wrong, at)
    code, result = asked.call("lostbits_choose", on.handle.pointer, c.byref(need), threads=threads, progress=progress)
    return Choice(tables_of(result), texts_of(result)[0], code == 0)


def mend(form: Form, scene: Union[Scene, str], bits: float, *, wrong: float = 0, at: str = "max", format: str = "f32",
         two_words: bool = False, threads: int = 0, progress: bool = True) -> Mended:
    """Finds what to change in a form so that it meets a requirement on a scene.

    It finds the fewest operations that must be done in float64 (with two_words=True, in two floats), and other ways of
    writing the form.

    - `form`: a name, or an intersector of your own, whose unchanged function is followed as in lb.explain.
    - `bits`: correct bits of t that must be kept.
    - `at`: the share of the hits on which they must be kept: "p50", "p99", "p99.9" or "max" (every hit).
    - `wrong`: largest allowed fraction of rays with a wrong decision, 0 to 1.

    The result prints as the text of `lostbits mend`. `.operations` are those that must be wider, each with its `line`
    in the function's file. `.forms` has one row per repaired form and per form of the catalogue. `.code` is the form to
    use, as C++, or None if the form itself is as good.
    """
    on, asked = scene_of(scene), Asked(form, format)
    if len(asked.own) + len(asked.names) != 1:
        raise lib.InputError("mend takes exactly one form; name one")
    asked.write_for(on.sample, always=True)
    need = _requirement(bits, -1, wrong, at)
    code, result = asked.call("lostbits_mend", on.handle.pointer, c.byref(need), c.c_int(bool(two_words)), threads=threads,
                              progress=progress)
    tapes = asked.own[0].tapes if asked.own else {}
    return Mended(tables_of(result), texts_of(result), code == 0, tapes.get(format))
