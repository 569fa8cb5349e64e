"""Functions as people have them: of one ray, with a number that means a miss; requirements for tests; keywords."""

import unittest
import warnings

import numpy as np

import lostbits as lb

F = np.float32


def roots(o, d, centre, radius):
    f = o - centre
    a, b, c = np.sum(d * d, axis=1), np.sum(f * d, axis=1), np.sum(f * f, axis=1) - radius * radius
    disc = b * b - a * c
    return (-b - np.sqrt(disc)) / a, disc


def marks(value):
    """The near root, and `value` for a miss."""
    def near(o, d, centre, radius):
        t, disc = roots(o, d, centre, radius)
        return np.where(disc < 0, o.dtype.type(value), t)
    return near


def dot(v, w):
    """Written out, since np.dot rounds as the BLAS of this numpy does."""
    return v[0] * w[0] + v[1] * w[1] + v[2] * w[2]


def of_one(o, d, centre, radius):
    f = o - centre
    a, b, c = dot(d, d), dot(f, d), dot(f, f) - radius * radius
    disc = b * b - a * c
    return (-b - np.sqrt(disc)) / a if disc >= 0 else None


def of_one_masked(o, d, centre, radius, dot=dot):
    f = o - centre
    a, b, c = dot(d, d), dot(f, d), dot(f, f) - radius * radius
    disc = b * b - a * c
    return np.where(disc < 0, o.dtype.type(np.nan), (-b - np.sqrt(disc)) / a)


def dot_adds_in_float():
    """False with OpenBLAS, which adds the products of floats in double."""
    x, y = np.random.default_rng(1).random((2, 64, 3)).astype(F)
    p = x * y
    return np.array_equal([np.dot(v, w) for v, w in zip(x, y)], p[:, 0] + p[:, 1] + p[:, 2])


def small():
    return lb.scene("near-benign", size=(48, 32))


def form(function, **how):
    return lb.intersector("sphere", name="f", **how)(function)


def bits_of(m):
    return {name: m.pixels["f", "f32"][name].tobytes() for name in ("t", "lost_bits")}


class Misses(unittest.TestCase):
    def test_a_number_that_means_a_miss_is_refused_with_advice(self):
        for value, word in ((-1, "-1.0"), (np.inf, "np.inf"), (-np.inf, "-np.inf"), (np.finfo(F).max, "3.4028")):
            with self.assertRaises(lb.InputError) as caught:
                lb.map(small(), form(marks(value)), "f32", progress=False)
            self.assertIn(f"miss={word}", str(caught.exception))

    def test_a_near_root_may_be_minus_one(self):
        self.assertEqual(len(lb.map(small(), form(marks(-1), roots="near"), "f32", progress=False).summary), 1)

    def test_a_declared_number_is_a_miss_and_is_traced(self):
        plain = lb.map(small(), form(marks(np.nan)), "f32", ["culprit"], progress=False)
        for value in (-1, np.inf, np.finfo(F).max):
            m = lb.map(small(), form(marks(value), miss=value), "f32", ["culprit"], progress=False)
            self.assertEqual(bits_of(m), bits_of(plain))
            np.testing.assert_array_equal(m.pixels["f", "f32"].culprit, plain.pixels["f", "f32"].culprit)

    def test_a_value_that_is_not_a_number_is_refused(self):
        with self.assertRaisesRegex(lb.InputError, "miss"):
            form(marks(-1), miss="none")


class OneRay(unittest.TestCase):
    def test_a_function_of_one_ray_is_measured_and_explained(self):
        # Products of arrays and of numbers are summed in different orders, so that the two masked forms are compared.
        m = lb.map(small(), form(of_one_masked, per_ray=True), "f32", ["culprit"], progress=False)
        self.assertEqual(int(m.summary["agree_hit"][0]), int(lb.map(small(), "sphere.unified", "f32", progress=False)
                                                             .summary["agree_hit"][0]))
        self.assertIn("c = dot(o - centre, o - centre)", " ".join(str(x) for x in set(m.pixels["f", "f32"].culprit.ravel())))

    def test_the_dot_of_numpy_is_followed_or_refused_with_advice(self):
        def by_numpy(o, d, centre, radius):
            return of_one_masked(o, d, centre, radius, np.dot)
        if dot_adds_in_float():
            m = lb.map(small(), form(by_numpy, per_ray=True), "f32", ["culprit"], progress=False)
            self.assertEqual(int(m.summary["rays"][0]), 48 * 32)
        else:
            with self.assertRaisesRegex(lb.Unfollowed, r"test_functions.py:\d+: numpy adds 3 .*write the sum out with \+"):
                lb.map(small(), form(by_numpy, per_ray=True), "f32", ["culprit"], progress=False)

    def test_none_is_a_miss_and_the_branch_is_named(self):
        self.assertEqual(bits_of(lb.map(small(), form(of_one, per_ray=True), "f32", progress=False)),
                         bits_of(lb.map(small(), form(of_one_masked, per_ray=True), "f32", progress=False)))
        with self.assertRaisesRegex(lb.Unfollowed, r"test_functions.py:\d+: `if`"):
            lb.map(small(), form(of_one, per_ray=True), "f32", ["culprit"], progress=False)

    def test_both_roots_and_decisions(self):
        def both(o, d, centre, radius):
            t = of_one(o, d, centre, radius)
            return (None, None) if t is None else (t, t + o.dtype.type(1))

        def hits(*ray):
            return of_one(*ray) is not None
        for function, promised in ((both, "both"), (hits, "none")):
            m = lb.map(small(), form(function, per_ray=True, roots=promised), "f32", progress=False)
            self.assertEqual(int(m.summary["false_miss"][0]), 0)

    def test_another_type_and_another_kind_are_refused(self):
        for function, words in ((lambda o, d, c, r: 2.5, "float64 where the ray is float32"),
                                (lambda o, d, c, r: "t", "returned str for a ray"),
                                (lambda o, d, c, r: o, "returned ndarray for a ray")):
            with self.assertRaisesRegex(lb.InputError, words):
                lb.map(small(), form(function, per_ray=True), "f32", progress=False)


class Requirements(unittest.TestCase):
    def test_a_requirement_is_met_or_fails_with_numbers(self):
        self.assertTrue(lb.check("sphere.unified", "near-benign", bits=16))
        found = lb.check("sphere.schoolbook", "near-benign", bits=21)
        m = lb.map("near-benign", "sphere.schoolbook", "f32", ["enough_bits:21"], pixels=False, progress=False)
        self.assertFalse(found)
        self.assertIn(f"on {m.summary['enough_bits_too_few'][0]} of {m.summary['agree_hit'][0]} correct hits",
                      found.text)
        self.assertIn("lostbits explain near-benign --pixel", found.text)
        self.assertTrue(lb.check("sphere.schoolbook", "near-benign", bits=21, at="p50"))
        lb.assert_keeps("sphere.unified", "near-benign", 16)
        with self.assertRaisesRegex(AssertionError, "keeps fewer than 21 bits"):
            lb.assert_keeps("sphere.schoolbook", "near-benign", 21)

    def test_a_share_of_wrong_decisions_can_be_allowed(self):
        def outside(o, d, centre, radius):
            t, disc = roots(o, d, centre, radius)
            return np.where(disc < radius * radius / 16, o.dtype.type(np.nan), t)
        own = form(outside)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", lb.Suspicious)
            summary = lb.map(small(), own, "f32", progress=False).summary
            missed = int(summary["false_miss"][0] + summary["wrong_primitive"][0])
            self.assertGreater(missed, 0)
            self.assertFalse(lb.check(own, small()))
            self.assertFalse(lb.check(own, small(), wrong=(missed - 0.5) / (48 * 32)))
            self.assertTrue(lb.check(own, small(), wrong=missed / (48 * 32)))
            self.assertIn("lb.explain(f, scene, pixel=(", lb.check(own, small()).text)

    def test_an_impossible_requirement_is_refused(self):
        for how, words in (({"bits": 0}, "bits is 0"), ({"bits": 54}, "bits is 54"), ({"wrong": 2}, "wrong is 2"),
                           ({"at": "p42"}, "p42")):
            with self.assertRaisesRegex(lb.InputError, words):
                lb.check("sphere.unified", "near-benign", **how)
        with self.assertRaisesRegex(lb.InputError, "name one"):
            lb.check("sphere.*", small())


class Suspicions(unittest.TestCase):
    def test_mostly_wrong_answers_are_reported_with_their_likely_cause(self):
        def doubled(o, d, centre, radius):
            t, disc = roots(o, d, centre, radius)
            return np.where(disc < 0, o.dtype.type(np.nan), t * o.dtype.type(2))
        with self.assertWarnsRegex(lb.Suspicious, r"py\.f f32: .*all \d+ rays that hit and should hit are wrong"):
            lb.map(small(), form(doubled), "f32", progress=False)
        o, d, primitives = small().arrays()
        truth = lb.truth(o, d, spheres=primitives)
        with self.assertWarnsRegex(lb.Suspicious, r"all \d+ rays that hit and should hit are wrong"):
            lb.judge(o, d, (2 * truth.t).astype(F), truth.hit, primitives, progress=False)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            lb.map(small(), form(marks(np.nan)), "f32", progress=False)
            lb.judge(o, d, truth.t.astype(F), truth.hit, primitives, progress=False)


class Keywords(unittest.TestCase):
    def test_primitives_are_accepted_under_their_plural_and_as_primitives(self):
        o, d, primitives = small().arrays()
        one = lb.truth(o, d, primitives)
        np.testing.assert_array_equal(lb.truth(o, d, spheres=primitives).t, one.t)
        np.testing.assert_array_equal(lb.ask("sphere.unified", o, d, spheres=primitives).hit,
                                      lb.ask("sphere.unified", o, d, primitives).hit)
        camera = {"kind": "orthographic", "eye": [0, 0, 5], "look_at": [0, 0, 0], "width": 3}
        boxes = np.array([[-1.0, -1, -1, 1, 1, 1]])
        for scene in (lb.scene(camera=camera, boxes=boxes), lb.scene(camera=camera, primitives=boxes, shape="box")):
            self.assertEqual(list(scene.rays), ["rays", "box"])
        with self.assertRaisesRegex(lb.InputError, "given twice"):
            lb.truth(o, d, primitives, spheres=primitives)
        with self.assertRaisesRegex(lb.InputError, "spherez"):
            lb.truth(o, d, spherez=primitives)


if __name__ == "__main__":
    unittest.main()
