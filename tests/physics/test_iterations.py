"""GMRES iterations of small scenes at a tolerance of 1e-4, started from extrapolated solutions."""

import unittest

import iteration_cases as scenes


class Iterations(unittest.TestCase):
    def check(self, name, count, warm, cold):
        print(f"  {name}: cold start {count.cold:.0f}, mean of the run {count.warm:.2f}, "
              f"largest {count.most:.0f}")
        self.assertLessEqual(count.warm, warm)
        self.assertLessEqual(count.cold, cold)
        return count

    def test_ratio_1_between_lattice_walls_needs_none(self):
        count = scenes.channel(n_platelets=0)
        self.assertEqual((count.cold, count.most), (0, 0))

    def test_channel_with_platelets(self):
        self.check("channel, 4 cells, 2 platelets", scenes.channel(), 5, 8)

    def test_channel_with_platelets_and_finer_walls(self):
        self.check("the same, walls twice as fine", scenes.channel(edge=0.2), 5, 8)

    def test_ratio_5(self):
        self.check("lambda 5, hematocrit 0.2", scenes.suspension(5.0), 4, 12)

    def test_ratio_20(self):
        self.check("lambda 20, hematocrit 0.2", scenes.suspension(20.0), 10, 20)

    def test_small_gaps(self):
        self.check("rigid spheres, gap 0.01", scenes.pair("rigid"), 10, 18)
        self.check("capsules of lambda 5, gap 0.01", scenes.pair(5.0), 10, 14)


if __name__ == "__main__":
    unittest.main()
