"""Tests that no ray exceeds the bounds that the theorems state, and that some rays come near them."""
import unittest

import backward
import offsets


class Backward(unittest.TestCase):
    """The first-order constants of docs/stability.md, over the rays of a search."""

    def test_the_near_root_stays_below_the_proved_constant_and_comes_within_a_tenth(self):
        for form, constant in ((backward.unified, 6), (backward.cross_product, 6), (backward.hearn_baker, 6.5)):
            worst = max(backward.search(form, True, 2500, seed, 1 + 2**-7)[0] for seed in range(2))
            self.assertLess(worst, constant)
            self.assertGreater(worst, 0.9 * constant)

    def test_the_far_root_stays_below_five(self):
        for form in (backward.unified, backward.cross_product, backward.hearn_baker):
            worst = backward.search(form, False, 2500, 1)[0]
            self.assertLess(worst, 5)
            self.assertGreater(worst, 3.5)


class Offsets(unittest.TestCase):
    """The distances of docs/offsets.md, in binary32."""

    def test_points_are_as_near_to_their_surface_as_is_proved(self):
        for name, share, start in offsets.SEARCHES:
            with self.subTest(name):
                largest = offsets.search(share, start, 6000, 1)
                self.assertLess(largest, 1)
                self.assertGreater(largest, 0.5)


if __name__ == "__main__":
    unittest.main()
