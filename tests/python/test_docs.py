"""Tests that the code of docs/python.md runs and gives what the page says."""

import contextlib
import io
import re
import unittest
from pathlib import Path

import numpy as np

PAGE = Path(__file__).resolve().parents[2] / "docs" / "python.md"


class Docs(unittest.TestCase):
    def test_the_code_runs_in_order(self):
        import linecache

        blocks = re.findall(r"^```python\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.M | re.S)
        self.assertGreaterEqual(len(blocks), 2)
        space: dict = {}
        for k, block in enumerate(blocks):
            name = f"docs_python_{k}.py"
            linecache.cache[name] = (len(block), None, block.splitlines(True), name)
            with contextlib.redirect_stdout(io.StringIO()):
                exec(compile(block, name, "exec"), space)
        m, e = space["m"], space["e"]
        self.assertEqual(m.pixels["mine", "f32"].lost_bits.shape, (256, 256))
        self.assertEqual(list(m.frame["form"]), ["py.mine"] * 2 + ["sphere.unified"] * 2)
        self.assertTrue(m._repr_png_().startswith(b"\x89PNG"))
        self.assertEqual(e.culprit, "dot(o - centre, d)")
        self.assertEqual(e.line, 8)
        self.assertEqual(len(e.frame), len(e.operations))

    def test_the_notebook_runs_and_its_repair_works(self):
        import ast
        import json
        import linecache

        notebook = json.loads((PAGE.parents[1] / "examples" / "notebook" / "first.ipynb").read_text(encoding="utf-8"))
        space: dict = {}
        shown = []
        for k, cell in enumerate(cell for cell in notebook["cells"] if cell["cell_type"] == "code"):
            text, name = "".join(cell["source"]), f"cell_{k}.py"
            linecache.cache[name] = (len(text), None, text.splitlines(True), name)
            tree = ast.parse(text)
            last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
            with contextlib.redirect_stdout(io.StringIO()):
                exec(compile(tree, name, "exec"), space)
            if last is not None:
                shown.append(eval(compile(ast.Expression(last.value), name, "eval"), space))
        rows = space["m"].frame.set_index("form")
        self.assertLess(rows.loc["py.mended", "lost_bits_p50"] + 2, rows.loc["py.mine", "lost_bits_p50"])
        self.assertEqual(rows.loc["py.mended", "lost_bits_max"], rows.loc["sphere.unified", "lost_bits_max"])
        self.assertTrue(shown[0]._repr_png_().startswith(b"\x89PNG"))

    def test_the_calls_of_the_table_exist(self):
        import lostbits as lb

        names = set(re.findall(r"lb\.(\w+)", PAGE.read_text(encoding="utf-8")))
        self.assertGreater(len(names), 10)
        for name in names:
            self.assertTrue(hasattr(lb, name), name)
            self.assertTrue(getattr(lb, name).__doc__, name)

    def test_a_sweep_along_the_distance(self):
        import lostbits as lb

        s = lb.sweep(lb.scene("rtg-fig-7-3-100-oblique"), "sphere.schoolbook", "f32", along="distance", to=1e5, steps=5,
                     progress=False)
        distance, bits = s.samples["distance"], s.samples["lost_bits_p50"]
        self.assertAlmostEqual(distance[0], 100, delta=1)
        self.assertAlmostEqual(distance[-1], 1e5, delta=100)
        self.assertGreater(bits[1], bits[0])
        self.assertIsNotNone(s.plot())
        self.assertIn("found", s.onsets.columns)

    def test_scenes_from_arrays(self):
        import lostbits as lb

        camera = {"kind": "orthographic", "eye": [0, 0, 5], "look_at": [0, 0, 0], "width": 4}
        spheres = np.array([[0, 0, 0, 1], [1, 0, -1, 0.5]])
        text = ('schema = "lostbits-scene/1"\ntitle = "two"\nsource = "-"\nsize = [32, 32]\n[camera]\n'
                'kind = "orthographic"\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\nwidth = 4\n'
                "[[sphere]]\ncentre = [0, 0, 0]\nradius = 1\n[[sphere]]\ncentre = [1, 0, -1]\nradius = 0.5\n")
        pair = [lb.map(s, "sphere.press", "f32", progress=False) for s in
                (lb.scene(camera=camera, spheres=spheres, size=(32, 32)), lb.scene(text))]
        for column in ("t", "lost_bits", "object"):
            np.testing.assert_array_equal(*[m.pixels["sphere.press", "f32"][column] for m in pair])
        self.assertEqual(set(np.unique(pair[0].pixels["sphere.press", "f32"].object[:, 16:])) - {np.nan}
                         >= {0.0, 1.0}, True)
        vertices = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], float)
        move = np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 2], [0, 0, 0, 1.0]])
        mesh = lb.scene(camera=camera, mesh=(vertices, [[0, 1, 2], [0, 2, 3]]), transform=move, size=(32, 32))
        t = lb.map(mesh, "triangle.pbrt@relative", "f64",
                   progress=False).pixels["triangle.pbrt@relative", "f64"].truth
        self.assertEqual(np.nanmin(t), 3.0)


if __name__ == "__main__":
    unittest.main()
