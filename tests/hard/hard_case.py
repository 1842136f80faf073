"""A hard case: what is promised, how it is run, what happened; unittest classes made of cases.
Knows nothing of scenes."""

import re
import sys
import tempfile
import unittest
from pathlib import Path

LONG = "--long"

# Measures that every case may limit: text, sign (1: at most, -1: at least).
MEASURES = {
    "volume": ("volume error {:.1e}", 1), "area": ("area change {:.2%}", 1),
    "angle": ("smallest angle {:.1f} deg", -1), "gap": ("least gap {:.4f}", -1),
    "inside": ("{:.0f} points inside another surface", 1),
    "iterations": ("at most {:.0f} iterations", 1),
    "evaluations": ("{:.0f} evaluations per unit time", 1),
}


class Case:
    """function(folder, size) -> what happened; it raises AssertionError where the promise is not
    kept. sizes: {'short': ..., 'long': ...}, what the function gets; one of them may be missing."""

    def __init__(self, name, promise, function, short=None, long=None):
        self.name, self.promise, self.function = name, promise, function
        self.sizes = {"short": short, "long": long}

    def run(self, size):
        with tempfile.TemporaryDirectory() as folder:
            return self.function(Path(folder), self.sizes[size])


def check_limits(found, limits):
    """Raises where a measure is beyond its limit."""
    for name, limit in limits.items():
        sign = MEASURES[name][1]
        if not sign * found[name] <= sign * limit:
            raise AssertionError(f"{name} is {found[name]:.4g}, promised is at "
                                 f"{'most' if sign > 0 else 'least'} {limit:g}: {describe(found)}")


def describe(found):
    """The measures as text."""
    parts = [f"t = {found['time']:.4g}"] if "time" in found else []
    parts += [text.format(found[name]) for name, (text, _) in MEASURES.items()
              if name in found and not (name == "iterations" and found[name] == 0)]
    if found.get("repeated"):
        parts.append(f"{found['repeated']:.0f} steps repeated or split")
    return ", ".join(parts)


def make_tests(cases):
    """A TestCase with one test for each case of the size that the command line asks for."""
    size = "long" if LONG in sys.argv else "short"

    def make_test(case):
        def test(self):
            print(f"\n  {case.name}: {case.run(size)}", flush=True)
        test.__doc__ = f"{case.name}: {case.promise}"
        return test

    tests = {f"test_{i:02d}_{re.sub(r'[^A-Za-z0-9]+', '_', case.name)}": make_test(case)
             for i, case in enumerate(cases) if case.sizes[size] is not None}
    return type("HardCases", (unittest.TestCase,), tests)


def main():
    unittest.main(argv=[word for word in sys.argv if word != LONG])
