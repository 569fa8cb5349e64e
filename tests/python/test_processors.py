"""Tests that the library gives the same bits on processors without AVX-512 and without AVX2."""

import os
import shutil
import subprocess
import sys
import unittest

ASKED = """
import hashlib
import numpy as np
import lostbits as lb
found, draw = hashlib.sha256(), np.random.default_rng(3)
for dtype in (np.float32, np.float64):
    o, d = (draw.uniform(-5, 5, (2000, 3)).astype(dtype) for _ in "od")
    t = lb.truth(o, d, np.array([[0, 0, 0, 2], [3, 1, 0, 1]], dtype=dtype))
    assert 100 < t.hit.sum() < 1900
    found.update(t.hit.tobytes() + t.t.tobytes() + t.t_lo.tobytes())
for name, forms in (("near-benign", "sphere.*"), ("box-far", "box.*"), ("triangle-far", "triangle.*")):
    m = lb.map(lb.scene(name, size=(24, 16)), forms, progress=False)
    for row in m.pixels:
        found.update(np.nan_to_num(m.pixels[row].lost_bits).tobytes())
print(found.hexdigest())
"""


class Processors(unittest.TestCase):
    def test_same_bits(self):
        emulator = shutil.which("qemu-x86_64")
        if emulator is None or os.uname().machine != "x86_64":
            self.skipTest("qemu-x86_64 is not installed (qemu-user), or this is another kind of processor")

        def answer(*through):
            return subprocess.run([*through, sys.executable, "-c", ASKED], check=True, capture_output=True,
                                  text=True).stdout

        here = answer()
        self.assertEqual(len(here), 65)
        for processor, has in (("Haswell", "AVX2"), ("Nehalem", "SSE 4.2")):
            self.assertEqual(answer(emulator, "-cpu", processor), here, has)


if __name__ == "__main__":
    unittest.main()
