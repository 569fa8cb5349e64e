"""Tests that `judge` reads what a renderer writes with lostbits_dump.h."""

import csv
import os
import subprocess
import tempfile
import unittest

import numpy as np

import lostbits as lb


# A primitive of each shape that is hit by the ray from (0, 0, 9) along -z.
SOLIDS = {
    "sphere": (0, 0, 0, 1), "box": (-1, -1, -1, 1, 1, 1), "triangle": (-1, -1, 0, 1, -1, 0, 0, 1, 0),
    "ellipsoid": (0, 0, 0, 1, 2, 3), "cylinder": (0, 0, -1, 0, 0, 1, 0.5), "capsule": (0, 0, -1, 0, 0, 1, 0.5),
    "tube": (0, -1, 0, 0, 1, 0, 0.5), "cone": (0, 0, -1, 0, 0, 1, 2, 0.5), "disc": (0, 0, 0, 0, 0, 1, 1, 0),
    "plane": (0, 0, 0.25, 0, 0, 1), "torus": (1, 0, 0, 0, 0, 1, 1, 0.5),
}


class Dump(unittest.TestCase):
    def test_every_shape(self):
        self.assertEqual(set(SOLIDS), set(lb.SHAPES))
        o, d = np.array([[0.0, 0, 9]]), np.array([[0.0, 0, -1]])
        for shape, numbers in SOLIDS.items():
            with self.subTest(shape), tempfile.TemporaryDirectory() as folder:
                truth = lb.truth(o, d, np.array([numbers], dtype=np.float64), shape=shape)
                self.assertTrue(truth.hit[0])
                path, out = os.path.join(folder, "rays.npy"), os.path.join(folder, "out")
                written = []
                for program in (os.environ["LOSTBITS_DEVICE_DUMPS"], os.environ["LOSTBITS_DUMPS"]):
                    subprocess.run([program, shape, path, repr(float(truth.t[0])), *map(str, numbers)], check=True)
                    written.append(np.load(path))
                self.assertEqual(len(written[0]), 1)
                np.testing.assert_array_equal(*written)
                subprocess.run([os.environ["LOSTBITS_PROGRAM"], "-q", "judge", path, "-o", out], check=True)
                with open(os.path.join(out, "rays", "summary.csv"), newline="", encoding="utf-8") as file:
                    row = next(csv.DictReader(file))
                self.assertEqual((row["agree_hit"], float(row["lost_bits_max"])), ("1", 0.0))

    def test_the_path_tracer(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "rays.npy")
            told = subprocess.run([os.environ["LOSTBITS_TRACER"], path], check=True, capture_output=True,
                                  text=True).stdout
            rays = np.load(path)
            self.assertEqual(told, f"{len(rays)} rays\n")
            self.assertGreater(len(rays), 48 * 32 * 4)
            self.assertEqual(set(rays["id"]), {0, 1, 2})
            o, d, spheres = (np.stack([rays[name] for name in names], axis=1) for names in
                             (("ox", "oy", "oz"), ("dx", "dy", "dz"), ("cx", "cy", "cz", "radius")))
            # The two threads tear no record: the first bounce starts at the eye, and each t belongs to its ray.
            self.assertTrue((o[rays["id"] == 0] == np.float32([0, -9, 1])).all())
            f = o - spheres[:, :3]
            a, b, c = np.sum(d * d, 1), 2 * np.sum(f * d, 1), np.sum(f * f, 1) - spheres[:, 3] * spheres[:, 3]
            disc = b * b - 4 * a * c
            with np.errstate(invalid="ignore"):
                near, far = ((-b + sign * np.sqrt(disc)) / (2 * a) for sign in (-1, 1))
            t = np.where(near >= rays["tmin"], near, far)
            hit = (disc >= 0) & (t >= rays["tmin"])
            np.testing.assert_array_equal(rays["hit"] != 0, hit)
            np.testing.assert_array_equal(rays["t"], np.where(hit, t, 0))
            out = os.path.join(folder, "out")
            subprocess.run([os.environ["LOSTBITS_PROGRAM"], "-q", "judge", path, "-o", out], check=True)
            with open(os.path.join(out, "rays", "summary.csv"), newline="", encoding="utf-8") as file:
                row = next(csv.DictReader(file))
            j = lb.judge(o, d, rays["t"], rays["hit"] != 0, spheres, paired=True, tmin=rays["tmin"], tmax=rays["tmax"],
                         progress=False)
            for name in ("rays", "agree_hit", "false_hit", "false_miss", "lost_bits_p50", "lost_bits_max"):
                self.assertEqual(float(row[name]), float(j.summary[name][0]), name)
            self.assertEqual(int(row["rays"]), len(rays))


if __name__ == "__main__":
    unittest.main()
