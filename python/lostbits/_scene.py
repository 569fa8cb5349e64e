"""Scenes: by name, from files, texts and arrays."""

from __future__ import annotations

import ctypes as c
import json
import os
from functools import cached_property
from typing import Any, Mapping, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike

from . import _library as lib
from ._arrays import COUNTS, PLURALS, SHAPES, Floats, renamed, with_article, word
from ._tables import Table, tables_of


class Scene:
    """A camera and the primitives that its rays are aimed at. Made by `scene`."""

    def __init__(self, handle: lib.Handle, name: str | None) -> None:
        self.handle, self.name = handle, name

    @cached_property
    def rays(self) -> dict[str, Table]:
        """Tables: `rays` (x, y, ox ... dz of every pixel, as every form gets them), and one per shape of primitive."""
        return tables_of(lib.result_of("lostbits_scene_rays", self.handle.pointer))

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the picture in pixels."""
        rays = self.rays["rays"]
        return int(rays["x"][-1]) + 1, int(rays["y"][-1]) + 1

    def arrays(self, shape: str = "sphere", dtype: Any = np.float32) -> tuple[Floats, Floats, Floats]:
        """o and d, each n x 3 with a row per pixel, and the m x k numbers of the primitives of `shape`.

        Matrices of the primitives are left out.
        """
        rays, table = self.rays["rays"], self.rays.get(shape)
        o, d = (np.stack([rays[k + axis] for axis in "xyz"], axis=1).astype(dtype) for k in "od")
        primitives = [table[k] for k in list(table)[:COUNTS[shape]]] if table else [np.empty(0)] * COUNTS[shape]
        return o, d, np.stack(primitives, axis=1).astype(dtype)

    def sample(self, shape: str, dtype: Any) -> tuple[Floats, Floats, Floats]:
        """A few thousand rays of the scene (fewer than 8192), evenly spread, each with a primitive of `shape`.

        Each primitive gets a run of consecutive rays.
        """
        o, d, primitives = self.arrays(shape, dtype)
        step = max(1, len(o) // 4096)
        o, d = np.ascontiguousarray(o[::step]), np.ascontiguousarray(d[::step])
        return o, d, primitives[np.arange(len(o)) * len(primitives) // len(o)]

    def __repr__(self) -> str:
        return f"<lostbits scene {self.name or 'of arrays'}, {self.size[0]} x {self.size[1]}>"


def toml_text(value: Any) -> str:
    if isinstance(value, (list, tuple, np.ndarray)):
        return "[" + ", ".join(toml_text(v) for v in value) + "]"
    if isinstance(value, (bool, str, int)):
        return json.dumps(value)
    return str(int(value)) if isinstance(value, np.integer) else repr(float(value))


def scene(name: str | None = None, *, camera: Mapping[str, Any] | None = None,
          mesh: tuple[ArrayLike, ArrayLike] | None = None, transform: ArrayLike | None = None,
          size: tuple[int, int] | None = None, set: Sequence[str] = (), inputs: str = "shared",
          data: str | None = None, shape: str = "sphere", **primitives: Any) -> Scene:
    """Makes a scene by name, from a file, from text, or from arrays.

    With `name`:

    - `name`: a scene that ships with lostbits ("rtg-fig-7-3-4100-oblique"), the path of a .toml file, or the text of
      one (recognised by its line break).
    - `size`: (width, height) in pixels.
    - `set`: changes, as in "sphere[0].radius=10".
    - `data`: the folder with scenes/ and sweeps/, by default that of the package.

    Without `name`:

    - `camera`, as in docs/files.md: {"kind": "pinhole", "eye": [0, 0, 5], "look_at": [0, 0, 0], "fov_deg": 40}.
    - Primitives by the plural of their shape: `spheres` n x 4 (centre, radius), `boxes` n x 6 (lo, hi), `triangles`
      n x 9, `tori` n x 8, ... lb.SHAPES has the keys of each. Or `primitives` with a `shape`.
    - `mesh`: (vertices n x 3, faces m x 3). Faces hold indices of vertices, from 0.
    - `transform` (4 x 4 or 3 x 4): the stored matrix from the space of the primitives to the world, for all primitives.
      Their numbers stay as they are. Name forms with a transform method ("triangle.undivided@pbrt").
    - `inputs`: primitives and matrix are doubles. "shared" rounds them once to float32, so that every format gets the
      same numbers. With "own", each format rounds them itself.

    Raises InputError if an argument is missing or has another shape or type.
    """
    try:
        width, height = (lib.whole(n, "size", 1) for n in size) if size is not None else (0, 0)
    except lib.InputError:
        raise
    except (TypeError, ValueError):
        raise lib.InputError(f"scene: size is {size!r}; give width and height, as in size=(48, 48)") from None
    changes = lib.Words(lib.texts(set, "set"), "set")
    stop = c.c_ubyte(0)
    where = c.byref(lib.Where(lib.data_folder(data), width, height, changes, c.pointer(stop)))
    renamed(primitives)
    if "primitives" in primitives:
        one_of = {shape: plural for plural, shape in PLURALS.items()}
        primitives.setdefault(word(shape, one_of, "shape"), primitives.pop("primitives"))
    for key in primitives:
        word(key, PLURALS, "an argument of lb.scene")
    handle = lib.Handle("scene")
    if name is not None:
        if not isinstance(name, (str, os.PathLike)):
            raise lib.InputError(f"scene: name is {name!r}; give the name of a scene, a path, or the text of a file")
        if camera is not None or mesh is not None or primitives:
            raise lib.InputError("scene: a name was given together with a camera or primitives; give one or the other")
        name = os.fspath(name)
        is_text = "\n" in name
        lib.stoppable_call("lostbits_scene_text" if is_text else "lostbits_scene_open", lib.in_utf8(name, "name"), where,
                           c.byref(handle.pointer), stop=stop)
        return Scene(handle, None if is_text else name)
    if camera is None:
        raise lib.InputError("scene: no name and no camera; give a name, or camera={\"kind\": \"pinhole\", \"eye\": "
                             "..., \"look_at\": ..., \"fov_deg\": 40}")
    if mesh is None and not primitives:
        raise lib.InputError("scene: no primitives; give spheres=, boxes=, triangles=, ... or mesh=(vertices, faces)")
    text = "\n".join(['schema = "lostbits-scene/1"', 'title = "arrays"', f"inputs = {toml_text(inputs)}",
                      f"size = {toml_text(list(size or (256, 256)))}", "[camera]",
                      *(f"{key} = {toml_text(value)}" for key, value in camera.items()),
                      "[[sphere]]", "centre = [0, 0, 0]", "radius = 1", ""])
    lib.call("lostbits_scene_text", lib.in_utf8(text, "camera"), where, c.byref(handle.pointer))
    for key, value in primitives.items():
        kind = PLURALS[key]
        keys = ": " + ", ".join(f"{k} {n}" for k, n in SHAPES[kind])
        numbers = _numbers(value, key, COUNTS[kind], keys)
        lib.call("lostbits_scene_primitives", handle.pointer, kind.encode(), numbers.ctypes, c.c_size_t(len(numbers)))
    if mesh is not None:
        _put_mesh(handle, mesh)
    if transform is not None:
        _put_under(handle, transform)
    return Scene(handle, None)


def _numbers(value: Any, name: str, columns: int, means: str = "", dtype: Any = np.float64) -> Any:
    try:
        array = np.atleast_2d(np.asarray(value))
        if array.dtype.kind not in "fiub":
            raise TypeError
        whole = dtype is np.float64 or array.dtype.kind in "iu" and (array.size == 0 or array.min() >= 0)
        if whole and dtype is not np.float64 and array.size and array.max() > np.iinfo(dtype).max:
            raise lib.InputError(f"{name} contains {array.max()}; indices must be from 0 to {np.iinfo(dtype).max}")
        numbers = np.ascontiguousarray(array, dtype=dtype)
    except lib.InputError:
        raise
    except (TypeError, ValueError):
        raise lib.InputError(f"{name} is not an array of numbers") from None
    if numbers.ndim != 2 or numbers.shape[1] != columns or name == "transform" and len(numbers) not in (3, 4):
        raise lib.InputError(f"{name} has shape {numbers.shape}; it must be (n, {columns}){means}")
    if not whole:
        raise lib.InputError(f"{name} is of {array.dtype}; it must hold whole numbers from 0, indices of vertices")
    return numbers


def _put_under(handle: lib.Handle, transform: Any) -> None:
    matrix = _numbers(transform, "transform", 4, " with 3 or 4 rows")
    if len(matrix) == 4 and matrix[3].tolist() != [0, 0, 0, 1]:
        raise lib.InputError(f"transform has {matrix[3].tolist()} as its last row; it must be affine, with the row "
                             "0, 0, 0, 1 last")
    lib.call("lostbits_scene_transform", handle.pointer, matrix.ctypes, c.c_int(0))


def _put_mesh(handle: lib.Handle, mesh: Any) -> None:
    if not isinstance(mesh, (tuple, list)) or len(mesh) != 2:
        raise lib.InputError("mesh must be (vertices, faces): an array n x 3 of numbers, and an array m x 3 of indices "
                             "of vertices")
    vertices = _numbers(mesh[0], "mesh: the array of vertices", 3)
    faces = _numbers(mesh[1], "mesh: the array of faces", 3, dtype=np.uint32)
    lib.call("lostbits_scene_mesh", handle.pointer, vertices.ctypes, c.c_size_t(len(vertices)), faces.ctypes,
             c.c_size_t(len(faces)))


def scene_of(value: Union[Scene, str]) -> Scene:
    if isinstance(value, Scene):
        return value
    if isinstance(value, str):
        return scene(value)
    raise lib.InputError(f"the scene is {with_article(value)}; give a name or what lb.scene(...) returns")
