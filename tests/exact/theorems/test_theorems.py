"""Tests that no ray exceeds the bounds that the theorems state, and that some rays come near them."""
import math
import unittest

import backward
import offsets


class Backward(unittest.TestCase):
    """The first-order constants of docs/stability.md, over the rays of a search."""

    def test_the_near_root_stays_below_the_proved_constant_and_comes_within_a_tenth(self):
        for form, constant in backward.FORMS.items():
            worst = max(backward.search(form, True, 2500, seed, 1 + 2**-7)[0] for seed in range(2))
            self.assertLess(worst, constant)
            self.assertGreater(worst, 0.9 * constant)

    def test_the_far_root_stays_below_five(self):
        for form in backward.FORMS:
            worst = backward.search(form, False, 2500, 1)[0]
            self.assertLess(worst, 5)
            self.assertGreater(worst, 3.5)

    def limits_of_the_lemma(self, x, theta, f, h, r2):
        """The lemma needs |x| ≤ 16u |f|, and that x exceeds Θ(T + t) by at most 6u r. T is 1."""
        self.assertLessEqual(x, 16 * f)
        self.assertLessEqual(x - theta * (2 - h), 6 * math.sqrt(r2))

    def test_the_sums_of_the_proof_are_below_their_bounds(self):
        for i in range(1, 201):
            for j in range(-40, 41):
                h = i / 200  # T is 1
                l = h * 2**(j / 4)
                f, r2, size = math.hypot(1, l), l * l + h * h, l * l + h
                x = 2 * (1 - h) + 3 * f + 3 * (1 - h / 2) + 1.5 * h + 2 * (1 + l)
                self.assertLessEqual(r2 + 5 * l * l + h * h + 2 * h * x, 20 * size)  # Hearn and Baker
                self.limits_of_the_lemma(x, 5, f, h, r2)
                x = (1 - h) + 3 * f + 4 * (1 - h / 2) + 1 + 1.5 * h + (1 + l)
                self.assertLessEqual(r2 + 5 * l * l + h * h + 2 * h * x, 20 * size)  # Embree's points
                self.limits_of_the_lemma(x, 5, f, h, r2)
                c = 3 * f * f + 5 * l * l + h * h + (1 - h) * 4 * (f + h)
                x = 3 * (1 - h) + c / (1 + h)
                self.assertLessEqual(r2 + 5 * l * l + h * h + 2 * h * x, 20 * size)  # both remedies
                if f >= 2 * math.sqrt(r2):
                    self.limits_of_the_lemma(x, 5, f, h, r2)
                if f < 16 * math.sqrt(r2):
                    continue
                c = 3 * f * f + 13 * l * l + 5 * h * h + 4 * l + (1 - h) * (3 * f + h)
                x = 3 * (1 - h) + c / (1 + h)
                self.limits_of_the_lemma(x, 4.5, f, h, r2)
                theta = (5 * r2 + 5 * l * l + h * h + 2 * h * x) / (4 * size)
                self.assertLessEqual(theta, 4.5)  # the cross product
                self.assertLessEqual((2 * theta + 2 + (1 + l) / (1 - h)) / 2, 6)


class Offsets(unittest.TestCase):
    """The distances of docs/offsets-proof.md, in binary32."""

    def test_points_are_as_near_to_their_surface_as_is_proved(self):
        for name, share, start in offsets.SEARCHES:
            with self.subTest(name):
                largest = offsets.search(share, start, 6000, 1)
                self.assertLess(largest, 1)
                self.assertGreater(largest, 0.5)


if __name__ == "__main__":
    unittest.main()
