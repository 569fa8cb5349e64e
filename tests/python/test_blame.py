"""Tests that unchanged numpy functions, in the style of public code, get the same culprits as the C++ forms."""

import inspect
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

import lostbits as lb


@lb.intersector("sphere")
def schoolbook(o, d, centre, radius):
    f = o - centre
    a = np.einsum("ij,ij->i", d, d)
    b = 2 * np.einsum("ij,ij->i", f, d)
    c = np.einsum("ij,ij->i", f, f) - radius**2
    disc = b * b - 4 * a * c
    with np.errstate(invalid="ignore"):
        root = np.sqrt(disc)
    t0 = (-b - root) / (2 * a)
    t1 = (-b + root) / (2 * a)
    t = np.where(t0 < 0, t1, t0)
    return np.where((disc < 0) | (t < 0), np.nan, t)


@lb.intersector("sphere", name="with_masks")
def with_masks(o, d, centre, radius):
    """The same operations, in the style of masks and np.full."""
    oc = o - centre
    a = (d * d).sum(axis=-1)
    b = 2.0 * (oc * d).sum(axis=-1)
    c = (oc * oc).sum(axis=-1) - radius * radius
    disc = b * b - 4.0 * a * c
    t = np.full(len(o), np.nan, dtype=o.dtype)
    ok = disc >= 0
    if not ok.any():
        return t
    root = np.sqrt(disc[ok])
    near = (-b[ok] - root) / (2 * a[ok])
    far = (-b[ok] + root) / (2 * a[ok])
    t[ok] = np.where(near < 0, far, near)
    t[t < 0] = np.nan
    return t


EPSILON = 2.0**-23


@lb.intersector("triangle")
def moller_trumbore(o, d, a, b, c):
    e1, e2 = b - a, c - a
    p = np.cross(d, e2)
    det = np.einsum("ij,ij->i", e1, p)
    inverse = 1 / det
    s = o - a
    u = np.einsum("ij,ij->i", s, p) * inverse
    q = np.cross(s, e1)
    v = np.einsum("ij,ij->i", d, q) * inverse
    t = np.einsum("ij,ij->i", e2, q) * inverse
    hit = ~(np.abs(det) < EPSILON) & (u >= 0) & (u <= 1) & ~((v < 0) | (u + v > 1)) & ~(t < 0)
    return np.where(hit, t, np.nan)


class Blame(unittest.TestCase):
    def hold_culprits(self, mine, theirs, scene, format, least):
        m = lb.map(scene, [mine, theirs], format, ["culprit"], progress=False)
        own, others = m.pixels[mine, format], m.pixels[theirs, format]
        self.assertGreater(own.t.size, 10000)
        np.testing.assert_array_equal(own.t, others.t)
        culprits = own.culprit
        self.assertGreater(sum(x is not None for x in culprits.ravel()), least)
        return culprits, others.culprit

    def test_schoolbook_culprits_match_the_form(self):
        scene = lb.scene("rtg-fig-7-3-4100-oblique", size=(128, 128))
        for mine in (schoolbook_in_order, with_masks):
            for format in ("f32", "f64"):
                with self.subTest(form=mine.name, format=format):
                    own, others = self.hold_culprits(mine, "sphere.schoolbook", scene, format, 5000)
                    np.testing.assert_array_equal(own, others)

    def test_moller_trumbore_culprits_match_the_form(self):
        camera = {"kind": "orthographic", "eye": [3, 2, 5], "look_at": [0.1, 0.2, 0], "width": 2.5}
        triangle = np.array([[-0.9, -0.8, 0.3, 1.1, -0.7, 0.11, 0.2, 1.3, -0.4]])
        scene = lb.scene(camera=camera, triangles=triangle, size=(128, 128))
        own, others = self.hold_culprits(moller_in_order, "triangle.moller_trumbore", scene, "f32", 1000)
        # `inverse` of the function is `1/det` of the form.
        self.assertEqual([x and x.replace("inverse", "1/det") for x in own.ravel()], list(others.ravel()))

    def test_einsum_is_traced_in_the_order_of_numpy(self):
        scene = lb.scene("rtg-fig-7-3-4100-oblique", size=(64, 64))
        for format in ("f32", "f64"):
            e = lb.explain(schoolbook, scene, (30, 30), format)  # refused if its bits differ on the scene's rays
            self.assertTrue(e.operations)
        camera = {"kind": "orthographic", "eye": [0, 0, 5], "look_at": [0, 0, 0], "width": 3}
        triangles = lb.scene(camera=camera, triangles=[[-1, -1, 0, 1, -1, 0, 0, 1, 0]])
        self.assertTrue(lb.explain(moller_trumbore, triangles, (120, 128)).operations)

    def test_every_width_and_exact_arithmetic(self):
        o, d, spheres = lb.scene("near-benign", size=(64, 64)).arrays()
        for format in ("fp16", "bf16", "p11", "p40"):
            a = lb.ask(with_masks, o, d, spheres[:1], format=format)
            b = lb.ask("sphere.schoolbook", o, d, spheres[:1], format=format)
            np.testing.assert_array_equal(a.hit, b.hit)
            np.testing.assert_array_equal(a.t, b.t)
            self.assertGreater(a.hit.sum(), 50)
        m = lb.map("near-benign", [with_masks, "sphere.schoolbook"], "f32", ["model_error", "rounding_error"],
                   progress=False)
        for metric in ("model_error", "rounding_error"):  # measured from the formula without rounding
            np.testing.assert_array_equal(m.pixels["with_masks", "f32"][metric],
                                          m.pixels["sphere.schoolbook", "f32"][metric])

    def test_a_function_is_repaired_like_the_form(self):
        scene = lb.scene("rtg-fig-7-3-4100-oblique", size=(64, 64))
        mine, theirs = (lb.mend(form, scene, 16, progress=False) for form in (schoolbook_in_order, "sphere.schoolbook"))
        self.assertTrue(mine.meets)
        kept = {form: list(zip(m.forms["kind"], m.forms["wrong"], m.forms["kept_bits"]))
                for form, m in (("mine", mine), ("theirs", theirs))}
        self.assertEqual(kept["mine"], kept["theirs"])
        self.assertEqual(len(mine.operations), len(theirs.operations))
        self.assertTrue(all(row["line"] is None for row in theirs.operations))

    def test_operations_that_must_be_wider_have_line_numbers(self):
        m = lb.mend(with_masks, lb.scene("near-benign", size=(32, 32)), 20, progress=False)
        code = with_masks.function.__code__
        with open(code.co_filename, encoding="utf-8") as file:
            source = file.read().split("\n")
        self.assertGreater(len(m.operations), 3)
        names = 0
        for row in m.operations:
            name = row["operation"].split(" = ")[0]
            if name in ("a", "b", "c", "disc", "root"):  # the names that the function gives
                self.assertIn(f" {name} = ", source[row["line"] - 1])
                names += 1
        self.assertGreater(names, 1)

    def test_the_culprit_has_a_line_and_variable_names(self):
        e = lb.explain(with_masks, "rtg-fig-7-3-4100-oblique", (100, 90))
        names = {row["name"]: row for row in e.operations}
        self.assertIn("disc", names)
        first = with_masks.function.__code__.co_firstlineno
        self.assertEqual(names["disc"]["line"], first + 7)
        self.assertIn(e.line, range(first + 3, first + 7))
        self.assertIn("d", e.culprit)

    def hold_refused(self, function, words, shape="sphere"):
        form = lb.intersector(shape)(function)
        with self.assertRaises(lb.Unfollowed) as caught:
            lb.explain(form, "near-benign", (100, 90))
        self.assertIn("test_blame.py:", str(caught.exception))
        self.assertIn(words, str(caught.exception))
        line = int(str(caught.exception).split("test_blame.py:")[1].split(":")[0])
        self.assertIn(line, range(function.__code__.co_firstlineno, function.__code__.co_firstlineno + 6))

    def test_code_that_cannot_be_traced_is_reported_with_its_place(self):
        def into_c(o, d, centre, radius):
            return np.array([float(x) for x in o[:, 0]], dtype=o.dtype)

        def branches(o, d, centre, radius):
            if o[0, 0] < 1:
                return o[:, 0]
            return o[:, 1]

        def exponential(o, d, centre, radius):
            return np.exp(o[:, 0])

        def wider(o, d, centre, radius):
            return (o[:, 0].astype(np.longdouble) + 1).astype(o.dtype)

        def other_library(o, d, centre, radius):
            import math
            return o[:, 0] * math.sqrt(o[0, 0])

        self.hold_refused(into_c, "cannot be followed")
        self.hold_refused(branches, "np.where or a mask")
        self.hold_refused(exponential, "np.exp")
        self.hold_refused(wider, "astype")
        self.hold_refused(other_library, "cannot be followed")

    def test_a_function_whose_bits_differ_from_its_trace_is_refused(self):
        calls = []

        def changes(o, d, centre, radius):
            calls.append(1)
            return o[:, 0] + (d[:, 0] if len(o) == 1 else d[:, 1])

        with self.assertRaises(lb.Unfollowed) as caught:
            lb.explain(lb.intersector("sphere")(changes), "near-benign", (100, 90))
        self.assertIn("some operation was not recorded", str(caught.exception))

    def test_a_branch_for_the_whole_batch_is_refused_with_its_line(self):
        def branches(o, d, centre, radius):
            f = o - centre
            b, c = np.sum(f * d, axis=1), np.sum(f * f, axis=1) - radius * radius
            if (b < 0).all():
                return -b
            return c

        self.hold_refused(branches, "decides for all rays at once")
        with self.assertRaises(lb.Unfollowed) as caught:
            lb.explain(lb.intersector("sphere")(branches), "near-benign", (100, 90))
        self.assertIn(f":{branches.__code__.co_firstlineno + 3}: ", str(caught.exception))

    def test_a_shortcut_for_uniform_batches_is_traced(self):
        @lb.intersector("sphere", name="short_cut")
        def short_cut(o, d, centre, radius):
            f = o - centre
            a, b = np.sum(d * d, axis=1), 2 * np.sum(f * d, axis=1)
            disc = b * b - 4 * a * (np.sum(f * f, axis=1) - radius * radius)
            hit = disc >= 0
            if (~hit).all():
                return np.full_like(disc, np.nan)
            t = (-b - np.sqrt(np.where(hit, disc, 0))) / (2 * a)
            if hit.all():
                return t
            return np.where(hit, t, np.nan)

        self.assertTrue(lb.explain(short_cut, "rtg-fig-7-3-4100-oblique", (100, 90)).culprit)

    def test_numpy_is_left_unchanged(self):
        before = (np.full, np.zeros, np.empty, np.ones)
        lb.explain(lb.intersector("sphere")(with_masks.function), "near-benign", (100, 90))
        self.assertEqual(before, (np.full, np.zeros, np.empty, np.ones))

    def test_a_function_beside_the_package_is_traced_and_a_linked_package_is_not(self):
        ask = 'e = lb.explain(with_masks, "rtg-fig-7-3-4100-oblique", (100, 90))\nprint(e.line, e.culprit)\n'
        source = inspect.getsource(with_masks.function)
        with tempfile.TemporaryDirectory() as folder:
            os.symlink(Path(lb.__file__).resolve().parent, Path(folder, "lostbits"))
            mine = Path(folder, "lostbits_mine.py")
            mine.write_text("import lostbits as lb\nimport numpy as np\n" + source + ask)
            told = subprocess.run([sys.executable, mine], env={**os.environ, "PYTHONPATH": folder}, text=True,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT).stdout
        e = lb.explain(with_masks, "rtg-fig-7-3-4100-oblique", (100, 90))
        self.assertEqual(told, f"{e.line - with_masks.function.__code__.co_firstlineno + 3} {e.culprit}\n")


def _in_order(name, shape, function):
    """The same function with sums along the last axis, which numpy adds in order."""
    source = inspect.getsource(function.function)
    source = source[source.index("def "):]
    for pair in ("d, d", "f, d", "f, f", "e1, p", "s, p", "d, q", "e2, q"):
        x, y = pair.split(", ")
        source = source.replace(f'np.einsum("ij,ij->i", {pair})', f"np.sum({x} * {y}, axis=1)")
    space = {"np": np, "EPSILON": EPSILON}
    exec(compile(source, "test_blame.py", "exec"), space)
    return lb.intersector(shape, name=name)(space[function.function.__name__])


schoolbook_in_order = _in_order("schoolbook_in_order", "sphere", schoolbook)
moller_in_order = _in_order("moller_in_order", "triangle", moller_trumbore)

if __name__ == "__main__":
    unittest.main()
