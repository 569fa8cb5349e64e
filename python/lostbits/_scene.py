"""Scenes: by name, from files, texts and arrays."""

from __future__ import annotations

import ctypes as c
import json
import os
from typing import Any, Dict, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike

from . import _library as lib
from ._arrays import COUNTS, Floats, HasScene, with_article
from ._forms import SHAPES, word
from ._tables import Table, tables_of


class Scene(HasScene):
    """What rays are made of and aimed at: solids and a camera. Made by `scene`."""

    def __init__(self, handle: lib.Handle, text: Optional[str], name: Optional[str]) -> None:
        self.handle, self.text, self.name = handle, text, name
        self._rays: Optional[Dict[str, Table]] = None

    @property
    def rays(self) -> Dict[str, Table]:
        """Tables: `rays` (x, y, ox ... dz of every pixel, as every form gets them), and a table a shape of solids."""
        if self._rays is None:
            result = lib.Handle("result")
            lib.call("lostbits_scene_rays", self.handle.pointer, c.byref(result.pointer))
            self._rays = tables_of(result)
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
        solids = np.empty((0, COUNTS[shape])) if table is None else np.stack([table[k] for k in table], axis=1)
        return o, d, solids.astype(dtype)

    def sample(self, shape: str, dtype: Any) -> Tuple[Floats, Floats, Floats]:
        """At most some thousand of its rays, evenly, a stretch of them to each of the solids."""
        o, d, solids = self.arrays(shape, dtype)
        step = max(1, len(o) // 4096)
        o, d = np.ascontiguousarray(o[::step]), np.ascontiguousarray(d[::step])
        return o, d, solids[np.arange(len(o)) * len(solids) // len(o)]

    def __repr__(self) -> str:
        return f"<lostbits scene {self.name or 'of arrays'}, {self.size[0]} x {self.size[1]}>"


def _where(size: Optional[Tuple[int, int]], changes: Sequence[str], data: Optional[str]) -> lib.Where:
    try:
        width, height = (int(n) for n in size or (0, 0))
    except (TypeError, ValueError):
        raise lib.InputError(f"scene: size is {size!r}; write width and height, as in size=(48, 48)") from None
    texts = lib.words(list(changes))
    made = lib.Where(data.encode() if data else lib.data_folder(), width, height, texts)
    made.kept = texts
    return made


def toml_text(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value)
    if isinstance(value, (list, tuple, np.ndarray)):
        return "[" + ", ".join(toml_text(v) for v in value) + "]"
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
    `ellipsoids` n x 6, `cylinders`, `capsules` and `tubes` n x 7, `cones` and `discs` n x 8, `planes` n x 6, or `mesh` =
    (vertices n x 3, faces m x 3), which `transform` (4 x 4, or 3 x 4) moves, in float64. Solids are doubles; with inputs="shared" they are rounded once to
    float32, so that every format gets the same numbers, with "own" each format rounds them itself.
    """
    plurals = {("boxes" if shape == "box" else shape + "s"): shape for shape in SHAPES}
    for key in solids:
        word(key, plurals, "a solid's name")
    handle = lib.Handle("scene")
    if name is not None and not isinstance(name, (str, os.PathLike)):
        raise lib.InputError(f"scene: {name!r} is no name; write that of a scene, a path, or the text of a scene file")
    if name is not None:
        name = os.fspath(name)
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
    text = "\n".join(['schema = "lostbits-scene/1"', 'title = "arrays"', f"inputs = {toml_text(inputs)}",
                      f"size = {toml_text(list(size or (256, 256)))}", "[camera]",
                      *(f"{key} = {toml_text(value)}" for key, value in camera.items()),
                      "[[sphere]]", "centre = [0, 0, 0]", "radius = 1", ""])
    where = _where(None, set, data)
    lib.call("lostbits_scene_text", text.encode(), c.byref(where), c.byref(handle.pointer))
    for key, value in solids.items():
        shape = plurals[key]
        numbers = np.ascontiguousarray(_numbers(value, key), dtype=np.float64)
        numbers = numbers[None] if numbers.ndim == 1 else numbers
        if numbers.ndim != 2 or numbers.shape[1] != COUNTS[shape]:
            raise lib.InputError(f"{key} has shape {numbers.shape}; it is n x {COUNTS[shape]}: "
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
        raise lib.InputError(f"mesh: vertices have shape {vertices.shape} and faces {faces.shape}; they are n x 3 and "
                             "m x 3")
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


def scene_of(value: Union[Scene, str]) -> Scene:
    if isinstance(value, Scene):
        return value
    if isinstance(value, str):
        return scene(value)
    raise lib.InputError(f"a scene is a name or what lb.scene(...) makes, not {with_article(value)}")
