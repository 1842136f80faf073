"""One red cell in shear at Ca = 0.5 (Zhao et al. 2012 parameters) to t = 20: volume, area and
tank-treading inclination. In free space at 642 nodes, mean over t = 24 ... 60: 17.5 +- 2.9 deg."""

import unittest

from single_cell import average, run_single_cell

AREA = 16.845    # of the unstressed discocyte of volume 4 pi/3


class RedCell(unittest.TestCase):
    nodes, timestep = 162, 0.004

    def test_volume_area_and_inclination(self):
        Ca = 0.5
        series = run_single_cell("rbc", self.nodes, ES=1 / Ca, ED=100.0, EB=3.3e-3 / Ca,
                                 timestep=self.timestep, duration=20.0)
        volume_error, area = series[:, 1].max(), series[:, 2]
        inclination = average(series, start=8.0)[3]
        print(f"  nodes {self.nodes}: volume within {volume_error:.1e}, area {area.min():.3f} ... "
              f"{area.max():.3f}, mean inclination {inclination:.2f} deg")
        self.assertEqual(series[-1, 0], 20.0)
        self.assertLess(volume_error, 1e-6)
        self.assertLess(abs(area / area[0] - 1).max(), 0.01)
        self.assertLess(abs(area[0] / AREA - 1), 0.01)
        self.assertLess(abs(inclination - 17.5), 2.9)


if __name__ == "__main__":
    unittest.main()
