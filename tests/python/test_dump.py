"""What a renderer writes with lostbits_dump.h is what `judge` reads."""

import csv
import os
import subprocess
import tempfile
import unittest

import numpy as np

import lostbits as lb


class Dump(unittest.TestCase):
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
            # No record is torn by the two threads: the first bounce begins at the eye, and each t is that of its ray.
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
