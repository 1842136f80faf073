"""Errors of the flow in empty vessels against mesh size, and walls from files beside lattices."""

import sys
import unittest
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "physics"))

import wall_cases as cases    # noqa: E402
from wall_cases import Scene    # noqa: E402


def print_table(title, rows):
    """Table of errors {mesh size: errors}, and the order between the finest two meshes."""
    edges = sorted(rows, reverse=True)
    print(f"  {title}")
    for edge in edges:
        print(f"    edge {edge}: {cases.format_errors(rows[edge])}")
    fine, finer = (rows[edge] for edge in edges[-2:])
    orders = {name: np.log(abs(fine[name] / finer[name])) / np.log(edges[-2] / edges[-1])
              for name in fine if finer[name] and name not in ("balance", "iterations")}
    print("    order: " + ", ".join(f"{name} {order:.1f}" for name, order in orders.items()))
    return orders


class Convergence(unittest.TestCase):
    def test_channel(self):
        """A uniform force density is exact on every mesh: no error but that of the periodic sum
        and of the near field."""
        rows = {edge: cases.measure_channel(cases.make_channel(edge), "mean 1 0 0")
                for edge in (0.8, 0.4, 0.2)}
        print_table("channel", rows)
        for errors in rows.values():
            for name in ("resistance", "maximum", "profile", "shear"):
                self.assertLess(abs(errors[name]), 5e-4, name)

    def test_duct(self):
        rows = {edge: cases.measure_duct(edge) for edge in (0.8, 0.4, 0.2, 0.1)}
        print_table("duct", rows)
        self.assertLess(abs(rows[0.4]["resistance"]), 0.3 * abs(rows[0.8]["resistance"]))
        self.assertLess(abs(rows[0.2]["resistance"]), 0.3 * abs(rows[0.4]["resistance"]))
        self.assertLess(abs(rows[0.1]["resistance"]), 2e-4)

    def test_tube(self):
        rows = {edge: cases.measure_tube(cases.make_tube(edge)) for edge in (0.6, 0.3, 0.15)}
        orders = print_table("tube", rows)
        for name in ("mean", "maximum"):
            self.assertAlmostEqual(orders[name], 2.0, delta=0.3)


class Files(unittest.TestCase):
    def test_sheets(self):
        """Nodes on a lattice and shifted at random, without the inverse by Fourier transforms."""
        for seed in (None, 1, 2):
            for steps in ((8, 6), (16, 12)):
                text = cases.make_sheet_off(cases.CHANNEL[:2], steps, seed)
                errors = cases.measure_channel(
                    Scene(cases.CHANNEL, "create_wall mesh sheet.off group wall",
                          files={"sheet.off": text}), "mean 1 0 0")
                print(f"  sheet {steps}, seed {seed}: {cases.format_errors(errors)}")
                for name in ("resistance", "maximum", "profile", "shear"):
                    self.assertLess(abs(errors[name]), 1e-3, name)

    def test_tube(self):
        """The tube of create_wall and the same surface as an STL file."""
        edge, center = 0.3, 0.5 * cases.TUBE_SIDE
        steps = [int(np.ceil(length / edge)) for length in
                 (cases.TUBE_LENGTH, 2.0 * np.pi * cases.TUBE_RADIUS)]
        text = cases.make_tube_stl(cases.TUBE_LENGTH, cases.TUBE_RADIUS, (center, center), steps)
        made = cases.measure_tube(cases.make_tube(edge))
        read = cases.measure_tube(Scene((cases.TUBE_LENGTH, cases.TUBE_SIDE, cases.TUBE_SIDE),
                                        "create_wall mesh tube.stl group wall",
                                        files={"tube.stl": text}))
        print(f"  tube of create_wall: {cases.format_errors(made)}\n"
              f"  tube of a file: {cases.format_errors(read)}")
        for name in ("mean", "maximum", "profile"):
            self.assertAlmostEqual(made[name], read[name], delta=1e-3)


if __name__ == "__main__":
    unittest.main()
