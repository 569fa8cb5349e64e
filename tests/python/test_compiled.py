"""Functions in files of C and GLSL: forms like those of numpy, in every call."""

import os
import unittest

import numpy as np

import lostbits as lb

FILE = os.path.join(os.path.dirname(__file__), "../external/functions/sphere.c")
OBLIQUE = "rtg-fig-7-3-4100-oblique"


class Compiled(unittest.TestCase):
    def setUp(self):
        self.form = lb.function(FILE, "schoolbook")

    def test_it_has_the_bits_and_culprits_of_the_catalogue(self):
        scene = lb.scene(OBLIQUE, size=(48, 32))
        m = lb.map(scene, [self.form, "sphere.schoolbook"], ["f32", "fp16"], metrics="culprit", progress=False)
        for format in ("f32", "fp16"):
            mine, theirs = m.pixels[self.form.name, format], m.pixels["sphere.schoolbook", format]
            self.assertEqual(mine.t.tobytes(), theirs.t.tobytes())
            self.assertEqual(mine.lost_bits.tobytes(), theirs.lost_bits.tobytes())
            np.testing.assert_array_equal(np.isnan(mine.lost_bits), np.isnan(theirs.lost_bits))

    def test_explain_quotes_the_line(self):
        e = lb.explain(self.form, OBLIQUE, pixel=(128, 128))
        self.assertIn("sphere.c:34:55", str(e))
        self.assertIn("~^~", str(e))

    def test_functions_of_shaders_are_followed_too(self):
        form = lb.function(os.path.join(os.path.dirname(FILE), "../../../examples/shaders/sphere.glsl"), "sphere")
        self.assertIn("sphere.glsl:8:37", str(lb.explain(form, OBLIQUE, pixel=(128, 40))))

    def test_it_says_what_its_arguments_are(self):
        self.assertIn("centre = centre, radius = radius; t = the result; hit where t is not negative",
                      self.form.signature)
        self.assertEqual((self.form.name, self.form.shape), ("function.schoolbook", "sphere"))

    def test_other_calls_take_it(self):
        t = lb.ask(self.form, np.array([[0, 0, 5.0]]), np.array([[0, 0, -1.0]]), np.array([[0, 0, 0, 1.0]]),
                   format="bf16").t
        self.assertEqual(t[0], 4)
        scene = lb.scene("near-benign", size=(16, 16))
        self.assertIsNotNone(lb.choose(scene, bits=8, forms=[self.form], progress=False).chosen)
        self.assertIn("function.schoolbook", str(lb.mend(self.form, scene, bits=8, progress=False)))
        self.assertTrue(lb.check(self.form, scene, bits=8))

    def test_what_is_wrong_is_one_sentence(self):
        with self.assertRaisesRegex(lb.InputError, "no such file"):
            lb.function("nowhere.c", "f")
        with self.assertRaisesRegex(lb.InputError, "it calls sin, which is not followed"):
            lb.function(os.path.join(os.path.dirname(FILE), "refused.c"), "sine")
        with self.assertRaisesRegex(lb.InputError, "compiled code"):
            self.form(1)


if __name__ == "__main__":
    unittest.main()
