"""Tests that each natural mistake raises an exception with one clear sentence, and that Ctrl-C ends a call."""

import os
import signal
import subprocess
import sys
import textwrap
import time
import unittest

import numpy as np

import lostbits as lb

N = 50
O = np.zeros((N, 3), np.float32) + np.float32(0.1)
O[:, 2] = 5
D = np.zeros((N, 3), np.float32)
D[:, 2] = -1
S = np.array([[0, 0, 0, 1]], np.float32)
T = np.full(N, 4, np.float32)
CAMERA = {"kind": "orthographic", "eye": [0, 0, 5], "look_at": [0, 0, 0], "width": 3}


def form(body):
    def made(o, d, centre, radius):
        return body(o, d)
    return lb.intersector("sphere", name="made")(made)


class Mistakes(unittest.TestCase):
    def hold(self, kind, words, ask):
        with self.assertRaises(kind) as caught:
            ask()
        said = str(caught.exception)
        self.assertIn(words, said)
        self.assertLess(len(said), 500)
        self.assertNotIn("\n", said.strip())
        self.assertNotRegex(said, r"(^|[ (])(--?[a-z])", "it speaks of options, not of arguments")

    def test_arrays(self):
        wrong = lb.InputError
        for words, ask in (
            ("o is a list", lambda: lb.truth([[0, 0, 5]], D, S)),
            ("o is a float", lambda: lb.truth(0.5, D, S)),
            ("give both", lambda: lb.truth(O, None, S)),
            ("o has shape (50, 2); it must be (n, 3)", lambda: lb.truth(O[:, :2], D, S)),
            ("d has 49 rows and o has 50", lambda: lb.truth(O, D[1:], S)),
            ("o is an array of int64", lambda: lb.truth(O.astype(np.int64), D, S)),
            ("o is an array of float16", lambda: lb.truth(O.astype(np.float16), D, S)),
            ("byte order of this machine (>f4)", lambda: lb.truth(O.astype(">f4"), D, S)),
            ("o is empty", lambda: lb.truth(O[:0], D[:0], S)),
            ("primitives has shape (1, 3)", lambda: lb.truth(O, D, S[:, :3])),
            ("primitives is None", lambda: lb.truth(O, D, None)),
            ("primitives has 1 rows and o has 50", lambda: lb.truth(O, D, S, paired=True)),
            ("shape is 'ball'; it must be one of sphere", lambda: lb.truth(O, D, S, shape="ball")),
            ("ray 0: ox is nan", lambda: lb.truth(O * np.float32(np.nan), D, S)),
            ("direction is 0,0,0", lambda: lb.truth(O, D * 0, S)),
            ("radius", lambda: lb.truth(O, D, -S)),
            ("give hit too", lambda: lb.judge(O, D, T - 9, None, S)),
            ("hit is an array of int64; it must be of booleans", lambda: lb.judge(O, D, T, np.ones(N, np.int64), S)),
            ("t has shape (50, 1); it must be (n,)", lambda: lb.judge(O, D, T[:, None], None, S)),
            ("direction is 'units'", lambda: lb.judge(O, D, T, None, S, direction="units")),
            ("open_ends is \"left\"; write none", lambda: lb.truth(O, D, S, tmin=T, open_ends="left")),
            ("tmin is -4", lambda: lb.truth(O, D, S, tmin=-T)),
            ("tmax has 49 rows", lambda: lb.truth(O, D, S, tmax=T[1:])),
            ("by has shape (49,)", lambda: lb.judge(O, D, T, None, S, by=T[1:])),
            ("finite number of at least 0", lambda: lb.judge(O, D, T, None, S, tolerance=-1)),
        ):
            with self.subTest(words):
                self.hold(wrong, words, ask)

    def test_arrays_with_any_strides_are_read_in_place(self):
        plain = lb.truth(O, D, S)
        self.assertTrue(plain.hit.all())
        wide = np.zeros((N, 7), np.float32)
        wide[:, 1:4], wide[:, 4:7] = O, D
        for o, d in ((np.asfortranarray(O), np.asfortranarray(D)), (wide[:, 1:4], wide[:, 4:7]),
                     (O[::-1], D[::-1]), (O, np.broadcast_to(D[:1], D.shape)), (O.astype(np.float64), D)):
            np.testing.assert_array_equal(lb.truth(o, d, S).t, plain.t)

    def test_functions(self):
        for kind, words, ask in (
            (lb.InputError, "returned float", lambda: lb.map("near-benign", form(lambda o, d: 4.0), "f32")),
            (lb.InputError, "of shape (", lambda: lb.map("near-benign", form(lambda o, d: o), "f32")),
            (lb.InputError, "returned float64 where the rays are float32",
             lambda: lb.map("near-benign", form(lambda o, d: o[:, 0] * np.ones(len(o))), "f32")),
            (lb.InputError, "returned NoneType", lambda: lb.map("near-benign", form(lambda o, d: None), "f32")),
            (ZeroDivisionError, "division", lambda: lb.map("near-benign", form(lambda o, d: 1 // 0), "f32")),
            (ValueError, "ambiguous", lambda: lb.map("near-benign", form(lambda o, d: o if o > 0 else d), "f32")),
        ):
            with self.subTest(words):
                self.hold(kind, words, ask)

    def test_calls(self):
        for kind, words, ask in (
            (lb.InputError, "did you mean", lambda: lb.map("near-bening")),
            (lb.InputError, "sphere.unified", lambda: lb.map("near-benign", "sphere.unifeid")),
            (lb.NothingSelected, "no form matches", lambda: lb.map("near-benign", "cube.*")),
            (lb.InputError, "use \"f32\" for float32", lambda: lb.map("near-benign", "sphere.*", "float32")),
            (lb.InputError, "takes 4 arrays: o, d, centre, radius", lambda: lb.intersector("sphere")(lambda o, d: o)),
            (lb.InputError, "the shape is missing", lambda: lb.intersector(lambda o, d: o)),
            (lb.InputError, "is a plain function; say which shape", lambda: lb.map("near-benign", np.sqrt)),
            (lb.InputError, "the scene is an int; give a name", lambda: lb.map(3)),
            (lb.InputError, "no name and no camera", lambda: lb.scene(spheres=S)),
            (lb.InputError, "no primitives", lambda: lb.scene(camera={"kind": "pinhole"})),
            (lb.InputError, "spheres has shape (1, 3)", lambda: lb.scene(camera=CAMERA, spheres=[[0, 0, 0]])),
            (lb.InputError, "fov_deg", lambda: lb.scene(camera={"kind": "pinhole", "eye": [0, 0, 5],
             "look_at": [0, 0, 0]}, spheres=S)),
            (lb.InputError, "it must be (column, row)", lambda: lb.explain("sphere.press", "near-benign", 3)),
            (lb.InputError, "700", lambda: lb.explain("sphere.press", "near-benign", (700, 3))),
            (lb.InputError, "the scene is an int; give a name", lambda: lb.sweep(3)),
            (lb.InputError, "the items of by cannot be sorted",
             lambda: lb.judge(O, D, T, None, S, by=np.array([None] * N))),
            (lb.InputError, "spheres is not an array of numbers",
             lambda: lb.scene(camera=CAMERA, spheres=[[0, 0, 0, 1], [1]])),
            (lb.InputError, "the matrix is singular",
             lambda: lb.scene(camera=CAMERA, spheres=np.ones((1, 4)), transform=np.diag([1, 0, 1, 1]))),
            (lb.InputError, "as its last row",
             lambda: lb.scene(camera=CAMERA, spheres=np.ones((1, 4)), transform=2 * np.eye(4))),
            (lb.InputError, "give one primitive for all rays",
             lambda: lb.truth(np.zeros((1, 3)), np.ones((1, 3)), np.ones((2, 4)), matrix=np.eye(4)[None])),
            (lb.InputError, "transform has shape (2, 4)",
             lambda: lb.scene(camera=CAMERA, mesh=(np.eye(3), [[0, 1, 2]]), transform=np.eye(4)[:2])),
            (lb.InputError, "say what changes", lambda: lb.sweep(lb.scene("near-benign"), "sphere.press")),
            (lb.InputError, "study \"consistenc\" is unknown", lambda: lb.study("consistenc", "near-benign")),
            (lb.InputError, "option \"chek\" is unknown", lambda: lb.study("consistency", "near-benign", chek="end")),
            (lb.InputError, "shape \"sphera\" is unknown", lambda: lb.trade(shape="sphera")),
            (lb.InputError, "leave out one of the two", lambda: lb.trade("near-benign", shape="sphere")),
            (lb.InputError, "bits must be from 0 to 53", lambda: lb.choose("near-benign", 60)),
            (lb.InputError, "bits must be from 0 to 53", lambda: lb.mend("sphere.press", "near-benign", 60)),
            (lb.InputError, "works in f32 and f64 only", lambda: lb.mend("sphere.press", "near-benign", 6, format="p11")),
            (lb.InputError, "name one form and one format", lambda: lb.mend("sphere.*", "near-benign", 6)),
            (lb.InputError, "each format makes the rays of this scene",
             lambda: lb.mend("sphere.press", lb.scene("camera-far.endless", set="camera.rays=\"bevy\""), 6)),
            (lb.InputError, "the requirement is missing", lambda: lb.choose("near-benign")),
            (lb.InputError, "metrics lost_bit", lambda: lb.map("near-benign", "sphere.press", metrics="lost_bit")),
            (lb.InputError, "formats", lambda: lb.map("near-benign", "sphere.press", "f16")),
            (lb.InputError, "checks", lambda: lb.consistency("near-benign", checks="none such")),
            (lb.InputError, "strategies", lambda: lb.offsets("near-benign", strategies="none such")),
            (lb.InputError, "points is", lambda: lb.offsets("near-benign", points="all")),
            (lb.InputError, "stage is", lambda: lb.render("raycast-acne.ulp1", stages="last")),
            (lb.InputError, "render draws spheres", lambda: lb.render("box-one", "box.*")),
            (lb.InputError, "size", lambda: lb.scene("near-benign", size=(0, -3))),
            (lb.InputError, "size is 48", lambda: lb.scene("near-benign", size=48)),
            (lb.InputError, "set sphere", lambda: lb.scene("near-benign", set="sphere[0].radios=1")),
            (lb.InputError, "p50, p99", lambda: lb.choose("near-benign", 16, at="p101")),
            (lb.InputError, "mesh: the array of faces is of float64",
             lambda: lb.scene(camera=CAMERA, mesh=(np.eye(3), [[0.5, 1, 2]]))),
            (lb.InputError, "face 0 names vertex 3", lambda: lb.scene(camera=CAMERA, mesh=(np.eye(3), [[1, 2, 3]]))),
            (lb.InputError, "mesh: the array of vertices has shape (3, 2)",
             lambda: lb.scene(camera=CAMERA, mesh=(np.eye(3)[:, :2], [[0, 1, 2]]))),
            (KeyError, "no table for sphere.press in f64", 
             lambda: lb.map("near-benign", "sphere.press", "f32").pixels["sphere.press", "f64"]),
            (AttributeError, "no column 'lost_bit'",
             lambda: lb.map("near-benign", "sphere.press", "f32").summary.lost_bit),
        ):
            with self.subTest(words):
                self.hold(kind, words, ask)

    def test_the_session_continues_after_an_error(self):
        bad = form(lambda o, d: 1 // 0)
        with self.assertRaises(ZeroDivisionError):
            lb.map("near-benign", bad, "f32")
        self.assertEqual(len(lb.map("near-benign", "sphere.press", "f32").summary), 1)

    def test_interrupts(self):
        program = textwrap.dedent("""
            import sys, time
            import lostbits as lb
            s = lb.scene("near-benign", size=(4096, 4096))
            print("begins", flush=True)
            try:
                lb.map(s, "sphere.*", progress=False)
                print("ended by itself")
            except KeyboardInterrupt:
                print("interrupted", len(lb.map("near-benign", "sphere.press", "f32").summary), flush=True)
        """)
        started = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True,
                                   env=dict(os.environ))
        self.assertEqual(started.stdout.readline(), "begins\n")

        def computed():  # processor seconds; on a busy machine they pass more slowly than clock seconds
            with open(f"/proc/{started.pid}/stat", encoding="ascii") as file:
                ticks = file.read().rpartition(")")[2].split()[11:13]
            return sum(map(int, ticks)) / os.sysconf("SC_CLK_TCK")
        begun = computed()
        while computed() - begun < 1.5 and started.poll() is None:
            time.sleep(0.02)
        time_at_signal = computed()
        started.send_signal(signal.SIGINT)
        self.assertEqual(started.stdout.readline(), "interrupted 1\n")
        self.assertLess(computed() - time_at_signal, 20 * os.cpu_count())
        started.stdout.close()
        self.assertEqual(started.wait(), 0)


if __name__ == "__main__":
    unittest.main()
