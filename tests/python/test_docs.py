"""Tests that the code of docs/python.md runs and gives what the page says."""

import contextlib
import io
import re
import unittest
from pathlib import Path

import numpy as np

PAGE = Path(__file__).resolve().parents[2] / "docs" / "python.md"


def texts(outputs):
    """Texts of a cell's outputs, without pictures."""
    return ["".join(output.get("text", output.get("data", {}).get("text/plain", []))) for output in outputs]


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

    def test_the_notebook_gives_its_outputs_and_the_mended_form_keeps_bits(self):
        import json

        import notebook

        file = PAGE.parents[1] / "examples" / "notebook" / "first.ipynb"
        kept = json.loads(file.read_text(encoding="utf-8"))
        found, space = notebook.run(kept)
        for cell, outputs in zip((cell for cell in kept["cells"] if cell["cell_type"] == "code"), found):
            self.assertEqual(texts(cell["outputs"]), texts(outputs), "run tests/python/notebook.py on " + file.name)
        pictures = [output["data"]["image/png"] for cell in found for output in cell
                    if "image/png" in output.get("data", {})]
        self.assertEqual(len(pictures), 2)
        for picture in pictures:
            self.assertTrue(picture.startswith("iVBORw0KGgo"))  # a PNG file in base64
        rows = space["m"].frame.set_index("form")
        self.assertLess(rows.loc["py.mended", "lost_bits_p50"] + 2, rows.loc["py.mine", "lost_bits_p50"])
        self.assertEqual(rows.loc["py.mended", "lost_bits_max"], rows.loc["sphere.unified", "lost_bits_max"])

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
