"""GMRES iterations of the coupled system on coarse and fine meshes, with few and many bodies.
With --table it prints the rows of doc/validation.md instead of testing."""

import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "physics"))

import iteration_cases as scenes    # noqa: E402

# name, largest mean that is allowed, and the variants: label and call
TABLE = (
    ("channel, lambda 1, no platelets", 0, (
        ("4 cells of 162 nodes, wall edge 0.4", lambda: scenes.channel(n_platelets=0)),
        ("wall edge 0.2", lambda: scenes.channel(n_platelets=0, edge=0.2)))),
    ("channel, lambda 1, 2 platelets per 4 cells", 5, (
        ("4 cells of 162 nodes, wall edge 0.4", scenes.channel),
        ("wall edge 0.2", lambda: scenes.channel(edge=0.2)),
        ("cells of 642 nodes", lambda: scenes.channel(nodes=642)),
        ("16 cells, 8 platelets, length 32",
         lambda: scenes.channel(n_cells=16, n_platelets=8, length=32.0)))),
    ("channel, lambda 5, 2 platelets", 5, (
        ("4 cells of 162 nodes, wall edge 0.4", lambda: scenes.channel(ratio=5.0)),
        ("wall edge 0.2", lambda: scenes.channel(ratio=5.0, edge=0.2)))),
    ("one cell, lambda 0.2", 4, (
        ("162 nodes", lambda: scenes.single(0.2)), ("642 nodes", lambda: scenes.single(0.2, 642)))),
    ("hematocrit 0.2, lambda 5", 4, (
        ("4 cells of 162 nodes", lambda: scenes.suspension(5.0)),
        ("cells of 642 nodes", lambda: scenes.suspension(5.0, nodes=642)),
        ("16 cells", lambda: scenes.suspension(5.0, n_cells=16)))),
    ("hematocrit 0.2, lambda 20", 10, (
        ("4 cells of 162 nodes", lambda: scenes.suspension(20.0)),
        ("cells of 642 nodes", lambda: scenes.suspension(20.0, nodes=642)),
        ("16 cells", lambda: scenes.suspension(20.0, n_cells=16)))),
    ("two rigid spheres, gap 0.01", 10, (
        ("162 nodes", lambda: scenes.pair("rigid")),
        ("642 nodes", lambda: scenes.pair("rigid", nodes=642)))),
    ("two capsules of lambda 5, gap 0.01", 10, (
        ("162 nodes", lambda: scenes.pair(5.0)),
        ("642 nodes", lambda: scenes.pair(5.0, nodes=642)))),
    ("two capsules of lambda 20, gap 0.01", 10, (
        ("162 nodes", lambda: scenes.pair(20.0)),)),
)
GROWTH = 1.5    # iterations that refinement or more bodies may add


class Iterations(unittest.TestCase):
    def test_table(self):
        for name, goal, variants in TABLE:
            means = []
            for label, run in variants:
                count = run()
                means.append(count.warm)
                print(f"  {name}, {label}: {count.cold:.0f} cold, {count.warm:.2f} mean")
                self.assertLessEqual(count.warm, goal, f"{name}, {label}")
            self.assertLessEqual(max(means), means[0] + GROWTH, name)


def print_table():
    print("| scene | variant | first evaluation | mean of the run | largest | goal |")
    print("|---|---|---|---|---|---|")
    for name, goal, variants in TABLE:
        for label, run in variants:
            count = run()
            print(f"| {name} | {label} | {count.cold:.0f} | {count.warm:.1f} | {count.most:.0f} | "
                  f"{goal} |", flush=True)
            name = ""


if __name__ == "__main__":
    if "--table" in sys.argv:
        print_table()
    else:
        unittest.main()
