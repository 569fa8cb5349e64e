"""Tests threads, forks, the end of the interpreter, memory that a function keeps, and numbers too large for C types."""

import multiprocessing
import os
import subprocess
import sys
import textwrap
import threading
import time
import unittest

import numpy as np

import lostbits as lb

CAMERA = {"kind": "orthographic", "eye": [0, 0, 5], "look_at": [0, 0, 0], "width": 3}
O = np.array([[0, 0, 5], [0.25, 0, 5], [9, 0, 5]], np.float32)
D = np.array([[0, 0, -1]] * 3, np.float32)
S = np.array([[0, 0, 0, 1]], np.float32)


def near(o, d, centre, radius):
    f = o - centre
    a, b, c = np.sum(d * d, axis=1), np.sum(f * d, axis=1), np.sum(f * f, axis=1) - radius * radius
    disc = b * b - a * c
    return np.where(disc < 0, np.nan, (-b - np.sqrt(disc)) / a)


def form(function=near, name="near"):
    def made(o, d, centre, radius):
        return function(o, d, centre, radius)
    return lb.intersector("sphere", roots="near", name=name)(made if function is not near else near)


def small():
    return lb.scene("near-benign", size=(24, 16))


def rows_of_a_map(forms):
    return len(lb.map(small(), forms, "f32", progress=False).summary)


def run(program, **how):
    """Runs a program. No time limit is needed, since the watch over the test also ends the program."""
    return subprocess.run([sys.executable, "-c", textwrap.dedent(program)], capture_output=True, text=True, **how)


class Threads(unittest.TestCase):
    def test_a_new_function_runs_in_many_threads(self):
        # In a separate process, because the defect was a crash.
        said = run("""
            import sys, threading
            sys.path.insert(0, "")
            from test_processes import *
            sys.setswitchinterval(1e-5)
            scene = lb.scene("near-benign", size=(64, 48))
            for turn in range(5):
                own, found = form(), []
                def go(place):
                    time.sleep(0.01 * place)  # one measures while the next one follows
                    m = lb.map(scene, own, "f32", ["culprit"] if place % 4 else [], progress=False)
                    found.append(m.pixels["near", "f32"].lost_bits.tobytes())
                threads = [threading.Thread(target=go, args=(place,)) for place in range(8)]
                for thread in threads: thread.start()
                for thread in threads: thread.join()
                assert len(found) == 8 and len(set(found)) == 1, len(found)
            print("done")
        """)
        self.assertEqual((said.returncode, said.stdout), (0, "done\n"), said.stderr)

    def test_each_call_raises_the_exception_of_its_own_function(self):
        def fails(o, d, centre, radius):
            raise ValueError("old")
        first, second = form(fails, "first"), form(fails, "second")
        for _ in range(3):  # both fail, and one of the two exceptions is raised
            with self.assertRaisesRegex(ValueError, "old"):
                lb.map(small(), [first, second], "f32", progress=False)
            for each in (first, second):  # another call does not raise an exception that was left over
                with self.assertRaisesRegex(lb.InputError, "700"):
                    lb.explain("sphere.press", "near-benign", (700, 3))
                with self.assertRaises(lb.NothingSelected):
                    lb.map(small(), [each, "nothing.*"], "f32", progress=False)
        caught = {}

        def named(o, d, centre, radius):
            raise KeyError(float(radius[0]))
        own = form(named, "named")

        def go(radius):
            try:
                lb.ask(own, O, D, np.array([[0, 0, 0, radius]], np.float32))
            except KeyError as error:
                caught.setdefault(radius, set()).add(error.args[0])
        for _ in range(20):
            threads = [threading.Thread(target=go, args=(float(k),)) for k in range(1, 5)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
        self.assertEqual(caught, {float(k): {float(k)} for k in range(1, 5)})

    def test_an_exception_that_cannot_be_printed_is_still_raised(self):
        class Mute(Exception):
            def __str__(self):
                raise RuntimeError

        def fails(o, d, centre, radius):
            raise Mute
        with self.assertRaises(Mute):
            rows_of_a_map(form(fails))


class Forks(unittest.TestCase):
    def test_a_forked_process_measures(self):
        self.assertEqual(rows_of_a_map([form(), "sphere.press"]), 2)
        with multiprocessing.get_context("fork").Pool(2) as pool:
            self.assertEqual(pool.map(rows_of_a_map, ["sphere.press", "sphere.unified"] * 4), [1] * 8)
        for _ in range(20):  # right after a call, while its threads are still coming to rest
            rows_of_a_map("sphere.*")
            child = os.fork()
            if child == 0:
                os._exit(0 if rows_of_a_map([form(), "sphere.press"]) == 2 else 1)
            self.assertEqual(os.waitpid(child, 0)[1], 0)
        self.assertEqual(rows_of_a_map("sphere.press"), 1)  # the process that forked still measures

    def test_a_process_forked_during_a_call_reports_it(self):
        children = []

        def forks(o, d, centre, radius):
            if not children:
                children.append(os.fork())
                if children[0] == 0:
                    try:
                        rows_of_a_map("sphere.press")
                    except lb.EnvironmentFault as error:
                        os._exit(3 if "spawn" in str(error) else 4)
                    os._exit(0)
            return near(o, d, centre, radius)
        self.assertEqual(rows_of_a_map(form(forks)), 1)
        self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(children[0], 0)[1]), 3)


class End(unittest.TestCase):
    def test_measuring_daemon_threads_end_with_the_interpreter(self):
        for forms in ('"sphere.*"', "form()"):
            with self.subTest(forms):
                said = run(f"""
                    import sys, threading
                    sys.path.insert(0, "")
                    from test_processes import *
                    begun = threading.Event()
                    def begins(o, d, centre, radius):
                        begun.set()
                        return near(o, d, centre, radius)
                    def go():
                        while True:
                            lb.map(lb.scene("near-benign", size=(4096, 4096)), [form(begins), {forms}], progress=False)
                    threading.Thread(target=go, daemon=True).start()
                    begun.wait()
                    print("ends", flush=True)
                """)
                self.assertEqual((said.returncode, said.stdout, said.stderr), (0, "ends\n", ""))

    def test_threads_that_outlive_the_main_thread_continue(self):
        said = run("""
            import sys, threading, time
            sys.path.insert(0, "")
            from test_processes import *
            def go():
                threading.main_thread().join()
                print([rows_of_a_map("sphere.press") for _ in range(3)])
            threading.Thread(target=go).start()
        """)
        self.assertEqual((said.returncode, said.stdout, said.stderr), (0, "[1, 1, 1]\n", ""))


class Memory(unittest.TestCase):
    def test_arrays_kept_by_a_function_stay_unchanged(self):
        kept = []

        def keeps(o, d, centre, radius):
            kept.append([(a, a.copy()) for a in (o, d, centre, radius)])
            return near(o, d, centre, radius)
        own = form(keeps, "keeps")
        for scene in (small(), lb.scene("near-benign", size=(100, 80))):
            lb.map(scene, own, "f32", progress=False)
        rows_of_a_map("sphere.*")
        self.assertGreater(len(kept), 1)
        for arrays in kept:
            for now, then in arrays:
                np.testing.assert_array_equal(now, then)
                # The memory is numpy's, not the library's.
                while isinstance(now.base, np.ndarray):
                    now = now.base
                self.assertTrue(now.flags.owndata)

    def test_arrays_changed_by_a_function_change_nothing_else(self):
        def spoils(o, d, centre, radius):
            t = near(o, d, centre, radius)
            o[:], d[:] = 7, 7
            return t
        plain = lb.map(small(), [form(), "sphere.press"], "f32", progress=False)
        spoilt = lb.map(small(), [form(spoils), "sphere.press"], "f32", progress=False)
        for column in plain.summary:
            if column != "source":
                np.testing.assert_array_equal(plain.summary[column], spoilt.summary[column], column)


class Numbers(unittest.TestCase):
    """Guards against ctypes, which keeps the lowest bits of a number too large for a C type, and against zero bytes,
    which would end a string."""

    def test_numbers_that_c_cannot_hold_are_refused(self):
        scene = small()
        for words, ask in (
            ("pixel[0] is 1099511627776", lambda: lb.explain("sphere.press", scene, (2**40, 0))),
            ("pixel[1] is -4294967296", lambda: lb.explain("sphere.press", scene, (0, -2**32))),
            ("pixel[0] is 3.7; it must be a whole number", lambda: lb.explain("sphere.press", scene, (3.7, 4))),
            ("pixel[0] is 'a'", lambda: lb.explain("sphere.press", scene, ("a", 4))),
            ("faces contains 4294967298", lambda: lb.scene(camera=CAMERA, mesh=(np.eye(3), [[0, 1, 2**32 + 2]]))),
            ("faces contains 18446744073709551615",
             lambda: lb.scene(camera=CAMERA, mesh=(np.eye(3), np.array([[0, 1, 2**64 - 1]], np.uint64)))),
            ("faces is not an array of numbers", lambda: lb.scene(camera=CAMERA, mesh=(np.eye(3), [[0, 1, 2**70]]))),
            ("size is 1099511627776", lambda: lb.scene("near-benign", size=(2**40, 1))),
            ("size is 4294967301", lambda: lb.scene("near-benign", size=(2**32 + 5, 7))),
            ("size is 2.7", lambda: lb.scene("near-benign", size=(2.7, 3))),
            ("size is inf", lambda: lb.scene("near-benign", size=(float("inf"), 3))),
            ("threads is 4294967297", lambda: lb.map(scene, "sphere.press", "f32", threads=2**32 + 1)),
            ("threads is -1", lambda: lb.map(scene, "sphere.press", "f32", threads=-1)),
            ("threads is 2.5", lambda: lb.truth(O, D, S, threads=2.5)),
            ("bits is", lambda: lb.choose(scene, 2**2000)),
            ("bits is '6'", lambda: lb.mend("sphere.press", scene, "6")),
            ("tolerance is 'a'", lambda: lb.choose(scene, tolerance="a")),
            ("wrong is None", lambda: lb.choose(scene, 3, wrong=None)),
            ("steps is 1.5", lambda: lb.sweep("near-benign", along="sphere[0].radius", start=1, to=2, steps=1.5)),
            ("forms is 'sphere.press\\x00x'; remove the zero byte", lambda: lb.map(scene, "sphere.press\0x", "f32")),
            ("formats is 'f32\\x00x'", lambda: lb.map(scene, "sphere.press", "f32\0x")),
            ("metrics is", lambda: lb.map(scene, "sphere.press", "f32", ["condition\0"])),
            ("name is 'near-benign\\x00x'", lambda: lb.scene("near-benign\0x")),
            ("set is", lambda: lb.scene("near-benign", set=["sphere[0].radius=1\0"])),
            ("data is", lambda: lb.scene("near-benign", data="data\0x")),
            ("name is 'py.a\\x00b'", lambda: form(name="a\0b")),
            ("half of a surrogate pair", lambda: lb.map(scene, "sphere.\udcff", "f32")),
            ("checks is", lambda: lb.consistency(scene, checks="a\0")),
            ("strategies is", lambda: lb.offsets(scene, strategies="a\0")),
            ("points is 3; it must be a string", lambda: lb.offsets(scene, points=3)),
            ("at is 3", lambda: lb.choose(scene, 3, at=3)),
            ("open_ends is 3", lambda: lb.truth(O, D, S, open_ends=3)),
            ("format is 3", lambda: lb.judge(O, D, O[:, 0], None, S, format=3)),
            ("formats is 3", lambda: lb.map(scene, "sphere.press", 3)),
            ("formats is 3", lambda: lb.map(scene, "sphere.press", [3])),
            ("set is 3", lambda: lb.scene("near-benign", set=[3])),
            ("data is 3", lambda: lb.scene("near-benign", data=3)),
            ("spheres is not an array of numbers", lambda: lb.scene(camera=CAMERA, spheres=np.ones((1, 4), complex))),
        ):
            with self.subTest(words):
                with self.assertRaises(lb.InputError) as caught:
                    ask()
                self.assertIn(words, str(caught.exception))


if __name__ == "__main__":
    unittest.main()
