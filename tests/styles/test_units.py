"""One problem in every unit style that has viscosity gives one dimensionless trajectory."""

import unittest

import numpy as np

import flow_cases as flow
from styles import membrane_cases as cases

LENGTH, VISCOSITY, RATE = 2.82e-6, 1.2e-3, 100.0    # m, Pa s, 1/s
FORCE = VISCOSITY * RATE * LENGTH ** 2    # N
CAPILLARY_NUMBER = 0.5
BOX = np.array([6.0, 6.0, 6.0])

# Energy per volume [Pa] of units real and metal as LAMMPS has them (nktv2p, right to 1e-7).
KCAL_PER_MOL, ELECTRONVOLT = 68568.415 * 101325.0, 1.6021765e6 * 1e5    # per cubic Angstrom

# unit style: length [m], time [s], force / length [N/m], viscosity [Pa s] of one unit
UNITS = {
    "lj": (LENGTH, 1.0 / RATE, FORCE / LENGTH, VISCOSITY),
    "si": (1.0, 1.0, 1.0, 1.0),
    "cgs": (1e-2, 1.0, 1e-3, 0.1),
    "micro": (1e-6, 1e-6, 1e-3, 1e-3),
    "nano": (1e-9, 1e-9, 1e-3, 1e-3),
    "real": (1e-10, 1e-15, KCAL_PER_MOL * 1e-10, 0.1),
    "metal": (1e-10, 1e-12, ELECTRONVOLT * 1e-10, 0.1),
}


class Units(flow.FlowCase):
    def trajectory(self, units, kind):
        """Frames in units of LENGTH and RATE."""
        length, time, tension, viscosity = UNITS[units]
        scale = LENGTH / length
        stretch = (1.1, 0.9, 1.0)
        made = [flow.make_red_cell((0.1, 5.9, 0.05), 30.0, stretch),
                flow.make_red_cell((3.0, 2.9, 3.0), 80.0)]
        box = tuple(float(side) for side in BOX * scale)
        self.write(*((x * scale, reference * scale) for x, reference in made), box=box,
                   tilt=(0.0, 2.9 * scale, 0.0))
        shear = VISCOSITY * RATE * LENGTH / CAPILLARY_NUMBER / tension
        bending = 3.3e-3 * shear * scale ** 2
        velocity = LENGTH * RATE * time / length
        flows = {"shear": f"shear xz {RATE * time!r}",
                 "mean": f"mean {0.3 * velocity!r} 0 {-0.2 * velocity!r}"}
        script = (flow.make_header(units, 0.2 * scale) + cases.READ.format(data=self.data) +
                  flow.make_styles(shear, 50.0 * shear, bending) +
                  flow.make_flow(flows[kind], viscosity=VISCOSITY / viscosity,
                                 timestep=0.004 / RATE / time) +
                  flow.make_dump("trajectory.txt", 10) + "run 20\n")
        self.output = flow.run(script, self.folder)
        frames = flow.read_dump(self.folder / "trajectory.txt")
        columns = np.array([1.0 / scale] * 3 + [1.0 / velocity] * 6)
        return {step: rows * columns for step, rows in frames.items()}

    def test_every_unit_style(self):
        for kind in ("shear", "mean"):
            first = self.trajectory("lj", kind)
            self.assertGreater(np.abs(first[20][:, 6:9]).max(), 0.1)
            for units in UNITS:
                with self.subTest(kind=kind, units=units):
                    self.assert_same_frames(first, self.trajectory(units, kind), 1e-8)
                    self.assertIn(f"units {units}:", self.output)

    def test_units_without_viscosity(self):
        self.write(flow.make_red_cell((3.0, 3.0, 3.0)))
        script = (flow.make_header("electron") + cases.READ.format(data=self.data) +
                  flow.make_styles() + flow.make_flow() + "run 0\n")
        result = cases.run(script, self.folder)
        self.assertNotEqual(result.returncode, 0)
        self.assertIn("units electron has no unit of viscosity", result.stdout)


if __name__ == "__main__":
    unittest.main()
