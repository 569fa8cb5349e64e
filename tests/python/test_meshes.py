"""Crossings of rays with meshes, and points inside of meshes, against rational numbers."""

import unittest
import warnings
from fractions import Fraction

import numpy as np

import lostbits as lb

CUBE = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], np.float64)
# Corners counter-clockwise seen from outside.
FACES = np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
                  [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]])


def exact(point):
    return [Fraction(float(x)) for x in point]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def less(a, b):
    return [x - y for x, y in zip(a, b)]


def crossing(o, d, corners):
    """(t, front, at_rim) of a ray and a triangle, or None."""
    a, b, c = (less(exact(p), exact(o)) for p in corners)
    d = exact(d)
    normal = cross(less(b, a), less(c, a))
    m = dot(d, normal)
    if m == 0:
        return None
    sides = [dot(d, e) / m for e in (cross(b, c), cross(c, a), cross(a, b))]
    t = dot(a, normal) / m
    return (t, m < 0, min(sides) == 0) if min(sides) >= 0 and t >= 0 else None


def rays(count, seed):
    draw = np.random.default_rng(seed)
    o = draw.integers(-6, 7, (count, 3)) * draw.choice([0.25, 0.5, 1], (count, 1))
    d = draw.integers(-4, 5, (count, 3)).astype(np.float64)
    d[~d.any(axis=1)] = [1, 0, 0]
    return o, d


class Hits(unittest.TestCase):
    def same(self, o, d, vertices, faces, found):
        self.assertTrue(found.resolved.all())
        for i in range(len(o)):
            expected = []
            for k, face in enumerate(faces):
                met = crossing(o[i], d[i], vertices[face])
                if met is not None:
                    expected.append((met[0], k, met[1], met[2]))
            expected.sort()
            at = found.of(i)
            self.assertEqual(list(found.primitive[at]), [k for _, k, _, _ in expected])
            self.assertEqual(list(found.front[at]), [front for _, _, front, _ in expected])
            self.assertEqual(list(found.at_rim[at]), [rim for _, _, _, rim in expected])
            places = {t: place for place, t in enumerate(sorted({t for t, _, _, _ in expected}))}
            self.assertEqual(list(found.place[at]), [places[t] for t, _, _, _ in expected])
            for t, lo, (true, _, _, _) in zip(found.t[at], found.t_lo[at], expected):
                self.assertEqual(t, float(true))
                self.assertLessEqual(abs(Fraction(t) + Fraction(lo) - true), true / 2**72)

    def test_every_crossing_of_a_cube_with_a_duplicate_and_without_a_face(self):
        o, d = rays(300, 5)
        for faces in (FACES, FACES[1:], np.concatenate([FACES, FACES[:3]])):
            self.same(o, d, CUBE, faces, lb.hits(o, d, (CUBE, faces)))

    def test_triangles_are_accepted_as_an_array_and_as_a_scene(self):
        o, d = rays(50, 6)
        array = lb.hits(o, d, CUBE[FACES].reshape(-1, 9))
        scene = lb.scene(camera={"kind": "orthographic", "eye": [0, 0, 5], "look_at": [0, 0, 0], "width": 3},
                         mesh=(CUBE, FACES))
        for other in (lb.hits(o, d, scene), lb.hits(o, d, (CUBE, FACES), threads=1)):
            for name in ("ray", "place", "primitive", "t", "t_lo", "front", "at_rim"):
                np.testing.assert_array_equal(getattr(array, name), getattr(other, name))

    def test_numbers_that_float32_cannot_hold_are_not_rounded(self):
        o, d = np.array([[0.1, 0.2, 5]]), np.array([[0, 0, -1.0]])
        found = lb.hits(o, d, (CUBE * 0.3, FACES))
        self.assertEqual(found.t[0], float(Fraction(5) - Fraction(0.3)))

    def test_a_range_keeps_crossings_within_it(self):
        o, d = np.array([[0.25, 0.5, 5]]), np.array([[0, 0, -1.0]])
        four = np.array([4.0])
        self.assertEqual(list(lb.hits(o, d, (CUBE, FACES)).t), [4, 6])
        self.assertEqual(list(lb.hits(o, d, (CUBE, FACES), tmin=four).t), [4, 6])
        self.assertEqual(list(lb.hits(o, d, (CUBE, FACES), tmin=four, open_ends="tmin").t), [6])
        self.assertEqual(list(lb.hits(o, d, (CUBE, FACES), tmax=four).t), [4])

    def test_other_primitives_are_refused(self):
        scene = lb.scene("near-benign")
        with self.assertRaisesRegex(lb.InputError, "triangles"):
            lb.hits(*rays(3, 1), scene)
        with self.assertRaisesRegex(lb.InputError, "meshes and no other"):
            lb.inside(CUBE, scene)
        with self.assertRaisesRegex(lb.InputError, "not finite"):
            lb.inside(np.array([[0, np.nan, 0]]), (CUBE, FACES))
        with self.assertRaisesRegex(lb.InputError, "points is None"):
            lb.inside(None, (CUBE, FACES))
        with self.assertRaisesRegex(lb.InputError, "vertices, faces"):
            lb.inside(CUBE, CUBE[FACES].reshape(-1, 9))


class Inside(unittest.TestCase):
    def test_points_of_a_grid_in_a_cube(self):
        points = np.array([[x, y, z] for x in range(-6, 7) for y in range(-6, 7) for z in range(-6, 7)]) / 4
        size = np.abs(points).max(axis=1)
        for faces, winding in ((FACES, 1), (FACES[:, ::-1], -1), (np.concatenate([FACES, FACES]), 2)):
            found = lb.inside(points, (CUBE, faces))
            self.assertTrue(found.resolved.all())
            np.testing.assert_array_equal(found.on_surface, size == 1)
            np.testing.assert_array_equal(found.winding, np.where(size < 1, winding, 0))
            np.testing.assert_array_equal(found.inside, size < 1)

    def test_defects_that_keep_a_mesh_from_being_closed_are_counted(self):
        def edges(faces, says=""):
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always")
                found = lb.inside(CUBE[:1] * 0.5, (CUBE, faces))
            self.assertEqual([w.category for w in caught], [lb.OpenMesh] if says else [])
            self.assertIn(says, str(caught[0].message) if says else "")
            return found.mesh
        self.assertEqual(edges(FACES), {"edges": 18, "border": 0, "non_manifold": 0, "unbalanced": 0, "odd": 0,
                                        "duplicates": 0})
        not_closed = "3 of the 18 edges of the mesh belong to an odd number of faces"
        self.assertEqual(edges(FACES[1:], not_closed), {"edges": 18, "border": 3, "non_manifold": 0, "unbalanced": 3, "odd": 3,
                                            "duplicates": 0})
        twice = np.concatenate([FACES, FACES[:1]])
        self.assertEqual(edges(twice, not_closed), {"edges": 18, "border": 0, "non_manifold": 3, "unbalanced": 3, "odd": 3,
                                        "duplicates": 1})
        turned = FACES.copy()
        turned[0] = turned[0, ::-1]
        self.assertEqual(edges(turned, "at 3 of the 18 edges"), {"edges": 18, "border": 0, "non_manifold": 0, "unbalanced": 3, "odd": 0,
                                         "duplicates": 0})
        # The parity of crossings does not ask which way a face is turned.
        self.assertTrue(lb.inside(np.array([[0.1, 0.2, 0.3]]), (CUBE, turned)).inside[0])


class JudgeMesh(unittest.TestCase):
    def setUp(self):
        self.o, self.d = rays(300, 5)
        self.true = lb.hits(self.o, self.d, (CUBE, FACES))

    def outcomes(self, **answers):
        judged = lb.judge_mesh((CUBE, FACES), self.o, self.d, **answers)
        self.assertEqual(len(judged.rays), len(self.o))
        self.assertEqual(int(judged.summary["rays"][0]), len(self.o))
        return judged

    def once(self):
        """One hit for each crossing of the surface: triangles met at one t from one side are one crossing."""
        keys = np.stack([self.true.ray, self.true.place, self.true.front])
        return np.unique(keys, axis=1, return_index=True)[1]

    def test_the_true_hits_are_right_and_every_spoilt_one_is_found(self):
        keep = np.sort(self.once())
        ray, primitive, t = self.true.ray[keep], self.true.primitive[keep], self.true.t[keep]
        judged = self.outcomes(ray=ray, primitive=primitive, t=t)
        self.assertEqual(set(judged.rays["outcome"]), {"agree"})
        self.assertEqual(int(judged.summary["crossings"][0]), len(keep))
        # In any order of the rays; the hits of each stay in order.
        order = np.argsort(-ray, kind="stable")
        self.assertEqual(set(self.outcomes(ray=ray[order], primitive=primitive[order], t=t[order]).rays["outcome"]),
                         {"agree"})
        gone = self.outcomes(ray=ray[1:], primitive=primitive[1:], t=t[1:]).rays["outcome"]
        self.assertIn(gone[ray[0]], ("crack", "missing_hit"))
        self.assertEqual(set(np.delete(gone, ray[0])), {"agree"})
        twice = self.outcomes(ray=np.append(ray, ray[-1]), primitive=np.append(primitive, primitive[-1]))
        self.assertEqual(twice.rays["outcome"][ray[-1]], "double_hit")

    def test_counts_and_parity(self):
        counts = np.bincount(self.true.ray[self.once()], minlength=len(self.o))
        for answers in ({"crossings": counts}, {"parity": counts % 2}, {"parity": counts % 2 == 1}):
            self.assertEqual(set(self.outcomes(**answers).rays["outcome"]), {"agree"})
        wrong = counts.copy()
        wrong[7] += 1
        self.assertNotEqual(self.outcomes(crossings=wrong).rays["outcome"][7], "agree")

    def test_points(self):
        points = np.random.default_rng(3).uniform(-2, 2, (200, 3))
        inside = (np.abs(points) < 1).all(axis=1)
        judged = lb.judge_mesh((CUBE, FACES), points, inside=inside)
        self.assertEqual(set(judged.rays["outcome"]), {"agree"})
        judged = lb.judge_mesh((CUBE, FACES), points, inside=~inside)
        self.assertEqual(int(judged.summary["false_outside"][0]), int(inside.sum()))
        self.assertEqual(int(judged.summary["false_inside"][0]), int((~inside).sum()))

    def test_mistakes(self):
        mesh, o, d = (CUBE, FACES), self.o, self.d
        some = np.zeros(3, np.int64)
        for words, ask in (
            ("none is given", lambda: lb.judge_mesh(mesh, o, d)),
            ("crossings and parity are given", lambda: lb.judge_mesh(mesh, o, d, crossings=some, parity=some)),
            ("primitive is None", lambda: lb.judge_mesh(mesh, o, d, ray=some)),
            ("leave out d", lambda: lb.judge_mesh(mesh, o, d, inside=np.ones(len(o), bool))),
            ("d is None", lambda: lb.judge_mesh(mesh, o, crossings=np.ones(len(o), np.int64))),
            ("300 whole numbers", lambda: lb.judge_mesh(mesh, o, d, crossings=some)),
            ("there are 300 rays", lambda: lb.judge_mesh(mesh, o, d, ray=some + 300, primitive=some)),
            ("t has 2 items", lambda: lb.judge_mesh(mesh, o, d, ray=some, primitive=some, t=np.ones(2))),
            ("there are 12", lambda: lb.judge_mesh(mesh, o, d, ray=some[:1], primitive=some[:1] + 12)),
            ("whole numbers; it has", lambda: lb.judge_mesh(mesh, o, d, ray=np.ones(3, bool), primitive=some)),
            ("1 of 13 have no area (the first is face 0)", lambda: lb.judge_mesh(
                (CUBE, np.vstack([[[0, 0, 1]], FACES])), o, d, crossings=np.ones(len(o), np.int64))),
            ("odd number of faces", lambda: lb.judge_mesh((CUBE, FACES[1:]), o, inside=np.ones(len(o), bool))),
        ):
            with self.assertRaises(lb.InputError) as caught:
                ask()
            self.assertIn(words, str(caught.exception))


if __name__ == "__main__":
    unittest.main()
