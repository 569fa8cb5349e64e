"""Tests that the arrays of the package equal the files of the program, to the bit."""

import csv
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np

import lostbits as lb

PROGRAM = os.environ["LOSTBITS_PROGRAM"]


def run(*words):
    return subprocess.run([PROGRAM, "-q", *words], check=True, capture_output=True, text=True)


def as_numbers(rows, name):
    return np.array([float(row[name]) if row[name] else np.nan for row in rows])


class Bits(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.out = scratch.name

    def rows(self, *path):
        with open(os.path.join(self.out, *path), newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def by_form(self, *path):
        return {(row["form"], row["format"]): row for row in self.rows(*path)}

    def dump(self, o, d, **columns):
        """Writes a file of these rays, with all numbers of one type. Returns its path."""
        path = os.path.join(self.out, "own.npy")
        names = ["ox", "oy", "oz", "dx", "dy", "dz"]
        rays = np.empty(len(o), dtype=[(name, o.dtype) for name in names] +
                        [(name, column.dtype) for name, column in columns.items()])
        for k, name in enumerate(names):
            rays[name] = (o if k < 3 else d)[:, k % 3]
        for name, column in columns.items():
            rays[name] = column
        np.save(path, rays)
        return path

    def hold_table(self, table, rows, without=()):
        """Compares every column of a file with that of the table, number for number and text for text."""
        self.assertEqual(len(rows), len(table))
        names = [name for name in rows[0] if name not in without]
        self.assertGreater(len(names), 5)
        for name in names:
            column = table.columns[name]
            if column.type == "string":
                np.testing.assert_array_equal(column.values, [row[name] or None for row in rows], name)
            else:
                np.testing.assert_array_equal(np.asarray(column.values, dtype=float), as_numbers(rows, name), name)

    def test_map(self):
        run("map", "near-benign", "-i", "sphere.unified", "-i", "sphere.schoolbook", "--size", "40x30", "--metric",
            "culprit", "--pixels", "csv", "-o", self.out)
        m = lb.map(lb.scene("near-benign", size=(40, 30)), ["sphere.unified", "sphere.schoolbook"], metrics=["culprit"],
                   progress=False)
        self.hold_table(m.summary, self.rows("near-benign", "summary.csv"))
        for form in ("sphere.unified", "sphere.schoolbook"):
            for format in ("f32", "f64"):
                rows = self.rows("near-benign", f"{form}.{format}.csv")
                pixels = m.pixels[form, format]
                self.assertEqual(pixels.lost_bits.shape, (30, 40))
                exact = np.array([float.fromhex(row["t_hex"]) if row["t_hex"] else np.nan for row in rows])
                np.testing.assert_array_equal(pixels.t.ravel(), exact)
                for name in set(rows[0]) & set(pixels.columns) - {"outcome", "culprit"}:
                    np.testing.assert_array_equal(pixels[name].astype(float).ravel(), as_numbers(rows, name), name)
                for name in ("outcome", "culprit"):
                    self.assertEqual([x or "" for x in pixels[name].ravel()], [row[name] for row in rows])
        self.assertGreater(np.nanmax(m.pixels["sphere.schoolbook", "f32"].lost_bits), 1)

    def test_pixels_have_the_colours_of_the_pictures(self):
        size = (40, 30)
        scene = lb.scene("rtg-fig-7-3-4100-oblique", size=size)
        pixels = lb.map(scene, "sphere.schoolbook", "f32", progress=False).pixels["sphere.schoolbook", "f32"]
        colours, outcome = pixels.outcome_colours(), pixels["outcome"]
        self.assertEqual(colours.shape, (30, 40, 3))
        # Colours that every picture has, see src/output/image/colour.hpp.
        for name, colour in (("agree_miss", (231, 231, 231)), ("false_hit", (114, 51, 0))):
            self.assertGreater((outcome == name).sum(), 0)
            self.assertTrue((colours[outcome == name] == colour).all())
        empty = np.isnan(pixels["lost_bits"])
        names = [name for name, _ in pixels.outcomes_in(empty)]
        self.assertIn("false hit", names)
        self.assertNotIn("correct hit", names)

    def test_judge(self):
        scene = lb.scene("rtg-fig-7-3-100-oblique", size=(64, 64))
        o, d, spheres = scene.arrays()
        answers = lb.ask("sphere.press", o, d, spheres)
        t = answers.t.astype(np.float32)
        path = self.dump(o, d, hit=answers.hit, t=t)
        sphere = ",".join(str(float(x)) for x in spheres[0])
        run("judge", path, f"--sphere={sphere}", "-i", "sphere.unified", "--rows", "-o", self.out)
        j = lb.judge(o, d, t, answers.hit, spheres, forms="sphere.unified", progress=False)
        rows = self.rows("own", "summary.csv")
        self.hold_table(j.summary, rows, without=("form",))
        rows = self.rows("own", "file.own.f32.csv")
        np.testing.assert_array_equal(j.rays.lost_bits, as_numbers(rows, "lost_bits"))
        np.testing.assert_array_equal(j.rays.truth, as_numbers(rows, "truth"))
        self.assertGreater(np.isfinite(j.rays.lost_bits).sum(), 500)

    def test_ranges_groups_and_tolerances(self):
        o, d, spheres = lb.scene("rtg-fig-7-3-100-oblique", size=(48, 48)).arrays()
        t = lb.ask("sphere.press", o, d, spheres).t.astype(np.float32)
        middle = np.float32(np.nanmedian(t))
        tmin, tmax = np.full_like(t, middle), np.full_like(t, np.nanmax(t))
        hit = (t >= middle) & (t < tmax)
        material = (np.arange(len(t)) % 3).astype(np.int32) * 10
        path = self.dump(o, d, hit=hit, t=t, tmin=tmin, tmax=tmax, material=material)
        sphere = ",".join(str(float(x)) for x in spheres[0])
        run("judge", path, f"--sphere={sphere}", "--open-ends", "tmax", "--by", "material", "--bits", "21",
            "--tolerance", "0.05mm", "--unit", "m", "--rows", "-o", self.out)
        with np.errstate(invalid="ignore"):
            j = lb.judge(o, d, t, hit, spheres, tmin=tmin, tmax=tmax, open_ends="tmax", by=material, bits=21.0,
                         tolerance=0.05 / 1000, progress=False)
        rows = self.rows("own", "summary.csv")
        self.assertEqual([row["material"] for row in rows], ["", "0", "10", "20"])
        self.assertEqual(list(j.summary.by), [None, 0, 10, 20])
        self.hold_table(j.summary, rows, without=("form", "material"))
        for name in ("rays", "agree_hit", "false_hit", "false_miss", "tolerance_beyond", "enough_bits_too_few"):
            counts = as_numbers(rows, name)
            self.assertEqual(counts[0], counts[1:].sum(), name)
        self.assertGreater(as_numbers(rows, "tolerance_beyond")[0], 0)
        self.assertGreater(as_numbers(rows, "tolerance_within")[0], 0)
        self.assertGreater(as_numbers(rows, "enough_bits_too_few")[0], 0)
        # The certified truth of the same ranges, in every bit that the file has.
        rows = self.rows("own", "file.own.f32.csv")
        truth = lb.truth(o, d, spheres, tmin=tmin, tmax=tmax, open_ends="tmax")
        exact = np.array([float.fromhex(row["truth_hex"]) if row["truth_hex"] else np.nan for row in rows])
        np.testing.assert_array_equal(truth.t, exact)
        self.assertTrue((truth.t[truth.hit] >= middle).all())
        self.assertGreater(lb.truth(o, d, spheres).hit.sum(), truth.hit.sum() + 100)
        np.testing.assert_array_equal(j.rays.distance_error, as_numbers(rows, "distance_error"))
        answers = lb.ask("sphere.press", o, d, spheres, tmin=tmin, tmax=tmax)
        self.assertTrue((answers.t[answers.hit] >= middle).all())

    def test_groups_have_any_values(self):
        o, d, spheres = lb.scene("near-benign", size=(32, 32)).arrays()
        t = lb.ask("sphere.unified", o, d, spheres).t
        names = np.where(o[:, 0] + d[:, 0] > 0, "glass", "steel")
        j = lb.judge(o, d, t, None, spheres, by=names, rows=False, progress=False)
        self.assertEqual(list(j.summary.by), [None, "glass", "steel"])
        for name, rays in zip(j.summary.by[1:], j.summary.rays[1:]):
            alone = lb.judge(o[names == name], d[names == name], t[names == name], None, spheres, progress=False)
            self.assertEqual(alone.summary.rays[0], rays)
            for column in ("agree_hit", "lost_bits_max", "lost_bits_p50", "lost_bits_mean", "worst_ulp_error"):
                i = list(j.summary.by).index(name)
                self.assertEqual(alone.summary[column][0], j.summary[column][i], column)

    def test_consistency(self):
        run("consistency", "near-benign", "--size", "40x30", "-i", "sphere.half_b,sphere.press", "--check",
            "reverse,packs", "-o", self.out)
        scene = lb.scene("near-benign", size=(40, 30))
        found = lb.consistency(scene, ["sphere.half_b", "sphere.press"], checks=["reverse", "packs"], progress=False)
        self.hold_table(found.summary, self.rows("near-benign", "summary.csv"))
        every = lb.consistency(scene, "sphere.half_b", progress=False)
        self.assertIn("beyond", set(every.summary["check"]))

    def test_offsets(self):
        run("offsets", "near-benign", "--size", "40x30", "-i", "sphere.half_b,sphere.unified", "--points", "computed",
            "--strategy", "*", "-o", self.out)
        found = lb.offsets(lb.scene("near-benign", size=(40, 30)), ["sphere.half_b", "sphere.unified"],
                           points="computed", progress=False)
        self.hold_table(found.summary, self.rows("near-benign", "summary.csv"))
        one = lb.offsets(lb.scene("near-benign", size=(16, 16)), strategies=found.summary.strategy[0], progress=False)
        self.assertEqual(set(one.frame["point"]), {"computed", "projected"})
        self.assertEqual(len(set(one.frame["strategy"])), 1)

    def test_render(self):
        run("render", "raycast-acne.eps1em5", "--size", "40x30", "-i", "sphere.half_b,sphere.unified", "--stage",
            "visible,shadows", "-o", self.out)
        scene = lb.scene("raycast-acne.eps1em5", size=(40, 30))
        found = lb.render(scene, ["sphere.half_b", "sphere.unified"], stages=["visible", "shadows"], progress=False)
        self.hold_table(found.summary, self.rows("raycast-acne.eps1em5", "summary.csv"))
        self.assertEqual(len(lb.render(scene, progress=False).summary), 1)

    def test_sweep(self):
        text = Path(os.environ["LOSTBITS_DATA"], "sweeps", "triangle-distance.toml").read_text(encoding="utf-8")
        self.assertIn("steps = 45", text)
        path = os.path.join(self.out, "few.toml")
        Path(path).write_text(text.replace("steps = 45", "steps = 9"), encoding="utf-8")
        run("sweep", path, "-i", "triangle.pbrt", "-f", "f32", "-o", self.out)
        s = lb.sweep(path, "triangle.pbrt", "f32", progress=False)
        self.hold_table(s.samples, self.rows("few", "samples.csv"))
        self.hold_table(s.onsets, self.rows("few", "onsets.csv"))

    def test_trade(self):
        run("trade", "near-benign", "--size", "32x32", "--quick", "-i", "sphere.un*", "-f", "f32", "-o", self.out)
        t = lb.trade(lb.scene("near-benign", size=(32, 32)), "sphere.un*", "f32", quick=True, progress=False)
        files = self.by_form("near-benign", "pareto.csv")
        for k, form in enumerate(t.pareto["form"]):
            self.assertEqual(str(t.pareto["wrong_fraction"][k]), str(float(files[form, "f32"]["wrong_fraction"])))
            self.assertEqual(t.pareto["kept_bits_p99"][k], float(files[form, "f32"]["kept_bits_p99"]))
        self.assertTrue((t.times["time_ns"] > 0).all())
        self.assertIn("sphere.unified", t.text)

    def test_a_study_by_its_name(self):
        named = lb.study("consistency", "near-benign", "sphere.unified", check="reverse", progress=False)
        own = lb.consistency("near-benign", "sphere.unified", checks="reverse", progress=False)
        self.assertEqual(list(named.summary), list(own.summary))
        for column in own.summary:
            np.testing.assert_array_equal(named.summary[column], own.summary[column])

    def test_choose(self):
        run("choose", "near-benign", "--bits", "16", "--quick", "-i", "sphere.un*", "-o", self.out)
        c = lb.choose("near-benign", 16, forms="sphere.un*", progress=False)
        worth = ("rays", "true_hits", "wrong", "kept_bits", "meets")
        self.assertTrue(np.isnan(c.candidates["distance_error"]).all())
        files = self.by_form("near-benign", "choose.csv")
        self.assertEqual(len(files), len(c.candidates))
        for i, key in enumerate(zip(c.candidates["form"], c.candidates["format"])):
            for name in worth:
                self.assertEqual(float(c.candidates[name][i]), float(files[key][name]), (key, name))
        self.assertIn(c.chosen, files)

    def test_mend(self):
        words = ["mend", "near-benign", "-i", "sphere.half_b", "--bits", "20", "--size", "24x24"]
        text = run(*words, "-o", self.out).stdout
        m = lb.mend("sphere.half_b", lb.scene("near-benign", size=(24, 24)), 20, progress=False)
        self.assertTrue(m.meets)
        self.assertTrue(text.startswith(str(m)))
        self.hold_table(m.forms, self.rows("near-benign", "mend.csv"))
        rows = self.rows("near-benign", "minimal.csv")
        self.assertGreater(len(rows), 3)
        self.assertEqual([row["operation"] for row in rows], [row["operation"] for row in m.operations])
        self.assertIn("struct Mended", m.code)

    def test_choose_by_length(self):
        run("choose", "near-benign", "--tolerance", "0.0001cm", "--unit", "m", "--at", "max", "--quick", "-i",
            "sphere.un*", "-o", self.out)
        c = lb.choose("near-benign", tolerance=0.0001 / 100, at="max", forms="sphere.un*", progress=False)
        files = self.by_form("near-benign", "choose.csv")
        for i, key in enumerate(zip(c.candidates["form"], c.candidates["format"])):
            off = c.candidates["distance_error"][i]
            self.assertEqual(off, float(files[key]["distance_error"]))
            self.assertEqual(bool(c.candidates["meets"][i]), off <= 1e-6 and c.candidates["wrong"][i] == 0)
        self.assertGreater(c.candidates["distance_error"].max(), 1e-7)
        # distance_error is |t - t*| times the length of the direction, at the worst hit.
        on = lb.scene("near-benign")
        o, d, spheres = on.arrays()
        pixels = lb.map(on, "sphere.unified", "f32", "distance_error", progress=False).pixels["sphere.unified", "f32"]
        truth, answers = lb.truth(o, d, on), lb.ask("sphere.unified", o, d, on)
        off = np.abs((answers.t - truth.t) - truth.t_lo) * np.linalg.norm(d.astype(np.float64), axis=1)
        np.testing.assert_allclose(pixels.distance_error.ravel(), np.where(truth.hit & answers.hit, off, np.nan),
                                   rtol=1e-12)

    def test_explain(self):
        e = lb.explain("sphere.schoolbook", "near-benign", (100, 90), "f32")
        words = run("explain", "near-benign", "--pixel", "100,90", "-i", "sphere.schoolbook").stdout
        self.assertEqual(e.text, words)

    def test_arrays_outlive_the_result_they_came_from(self):
        import gc

        o, d, spheres = lb.scene("near-benign", size=(64, 64)).arrays()
        t = lb.truth(o, d, spheres).t
        kept = t.copy()
        gc.collect()
        others = [lb.truth(o + np.float32(k), d, spheres).t for k in range(1, 6)]
        np.testing.assert_array_equal(t, kept)
        self.assertEqual(len(others), 5)
        with self.assertRaises(ValueError):
            t[0] = 1  # it is the library's memory

    def test_matrices_are_returned_as_stored(self):
        from fractions import Fraction as F

        rng = np.random.default_rng(5)
        move = np.eye(4)
        move[:3] = rng.normal(size=(3, 4))
        vertices = rng.normal(size=(3, 3))
        camera = {"kind": "pinhole", "eye": [0, 0, 9], "look_at": [0, 0, 0], "fov_deg": 40}
        s = lb.scene(camera=camera, mesh=(vertices, [[0, 1, 2]]), transform=move, size=(16, 16), inputs="own")
        table = s.rays["triangle"]
        for row in range(3):
            for column in range(4):
                self.assertEqual(table[f"M{row}{column}"][0], move[row, column])
        self.assertEqual(s.arrays("triangle", np.float64)[2].shape, (1, 9))
        # Exact image of the vertices under the stored matrix, in fractions, and the point where the ray meets it.
        o, d = rng.normal(size=(300, 3)) * 3, rng.normal(size=(300, 3))
        image = [[sum(F(m) * F(x) for m, x in zip(row[:3], v)) + F(row[3]) for row in move[:3]] for v in vertices]
        minus = lambda a, b: [x - y for x, y in zip(a, b)]
        dot = lambda a, b: sum(x * y for x, y in zip(a, b))
        cross = lambda a, b: [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        b, c = minus(image[1], image[0]), minus(image[2], image[0])
        n = cross(b, c)
        corners = np.array([[float(x) for x in corner] for corner in image])
        d = rng.dirichlet((1, 1, 1), 300) @ corners + 0.1 * rng.normal(size=(300, 3)) - o
        of_scene = lb.truth(o, d, s)
        of_rays = lb.truth(o, d, vertices.reshape(1, 9), shape="triangle", matrix=np.repeat(move[None, :3], 300, axis=0))
        np.testing.assert_array_equal(of_scene.hit, of_rays.hit)
        np.testing.assert_array_equal(of_scene.t, of_rays.t)
        hits = 0
        for i in range(300):
            ray, to = [F(x) for x in o[i]], [F(x) for x in d[i]]
            t = dot(minus(image[0], ray), n) / dot(to, n)
            p = minus([x + t * y for x, y in zip(ray, to)], image[0])
            u, v = dot(cross(p, c), n) / dot(n, n), dot(cross(b, p), n) / dot(n, n)
            hit = t >= 0 and u >= 0 and v >= 0 and u + v <= 1
            self.assertEqual(bool(of_scene.hit[i]), hit)
            if hit:
                hits += 1
                self.assertLess(abs(F(of_scene.t[i]) + F(of_scene.t_lo[i]) - t), abs(t) / 2**70)
        self.assertGreater(hits, 30)
        judged = lb.judge(o, d, of_scene.t, primitives=vertices.reshape(1, 9), shape="triangle",
                          matrix=np.repeat(move[:3].reshape(1, 12), 300, axis=0), forms="triangle.undivided@relative",
                          progress=False)
        self.assertEqual(judged.summary["form"][1], "triangle.undivided@relative")
        self.assertEqual(judged.summary["lost_bits_max"][0], 0)

    def test_truth_is_exact(self):
        from fractions import Fraction as F

        rng = np.random.default_rng(3)
        o, d = rng.normal(size=(200, 3)) * 4, rng.normal(size=(200, 3))
        d = (d - o).astype(np.float64)
        truth = lb.truth(o, d, np.array([[0.0, 0.0, 0.0, 1.0]]))
        self.assertTrue(truth.resolved.all())
        self.assertGreater(truth.hit.sum(), 20)
        for i in range(200):
            a, b, c = (sum(F(x) * F(y) for x, y in zip(p, q)) for p, q in ((d[i], d[i]), (o[i], d[i]), (o[i], o[i])))
            disc = b * b - a * (c - 1)
            self.assertEqual(bool(truth.hit[i]), disc >= 0 and -b > 0 or c <= 1)
            if truth.hit[i] and c > 1:
                # a t + b = -sqrt(disc). Squaring it gives the error of t to first order.
                t = F(truth.t[i]) + F(truth.t_lo[i])
                off = ((a * t + b) ** 2 - disc) / (2 * a * (a * t + b)) if disc else F(0)
                self.assertLess(abs(off), abs(t) / 2**70)


if __name__ == "__main__":
    unittest.main()
