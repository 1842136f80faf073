"""Evaluations, error and CPU time of the steppers: CSV.

    bench/time.py --lmp build/lmp_biem --work FOLDER --output time.csv
                  [--nodes 162,642,2562] [--Ca 0.1,0.5,2] [--end 10]
    bench/time.py --lmp build/lmp_biem --work FOLDER --output orders.csv --orders

One red cell in shear, in units of its radius, the viscosity and the shear rate. Errors are
distances of the nodes at the time 'end' to those of a converged run, which --work keeps. Its own
error is a third of the distance to the run with twice its step. Rows that the output file has
already are not measured again, so an interrupted benchmark goes on where it was.
--orders: error after a unit of time against the step, at 162 nodes and Ca 0.5, from the unstressed
shape and from the shape at the time 1.
"""

import argparse

import numpy as np

from time_scene import Cell, Program, Stopped, Table, distances

# Stepper, further keywords, and either time steps or dt times the spectral radius from which on the
# step is made smaller until the run is stable. Limits: dt times
# spectral radius 2 (Euler) and 1 (Adams-Bashforth).
CASES = (
    ("euler", "", None, 1.6),
    ("ab2", "", None, 0.8),
    ("rkc2", "", (0.3, 0.2, 0.1, 0.05, 0.025), None),
    ("rkc2", "error/tolerance 1e-3", (0.2,), None),
    ("rkc2", "error/tolerance 1e-4", (0.2,), None),
    ("rkc2", "multirate yes", (0.2, 0.1), None),
)
SMALLEST = 0.1             # dt times spectral radius at which the search for a stable step ends
SHRINK = 0.7               # of the step in that search
REFERENCE = (0.0125, 0.00625)    # time steps of the two runs of the converged trajectory
# A run that oscillates from step to step has much more power than the converged one.
POWER_LIMIT, VOLUME_LIMIT = 1.5, 1e-3

ORDERS = {"euler": (320, 640, 1280, 2560), "ab2": (320, 640, 1280, 2560),
          "rkc2": (5, 10, 20, 40, 80, 160, 320, 640)}
ORDERS_REFERENCE = 5120    # steps of ab2
ORDERS_ACCURACY = "1e-8"


class Reference:
    """The converged run: positions, their error, mean power, largest spectral radius, CPU seconds
    before the first step."""

    def __init__(self, program, cell, options):
        path = program.folder / f"{cell.name()}_{options.end:g}_{options.accuracy}.npz"
        if not path.exists():
            self.measure(path, program, cell, options)
        data = np.load(path)
        self.positions, self.error = data["positions"], float(data["error"])
        self.power, self.setup = float(data["power"]), float(data["setup"])
        self.radius = float(data["radius"])

    @staticmethod
    def measure(path, program, cell, options):
        coarse, fine = (program.run(cell, "rkc2", step, options.end) for step in REFERENCE)
        step = 1e-9 * options.end
        setup = program.run(cell, "rkc2", step, step).cpu_seconds
        np.savez(path, positions=fine.positions, power=fine.mean_power(), setup=setup,
                 radius=fine.largest("radius"),
                 error=distances(coarse.positions, fine.positions)[0] / 3.0)


def measure(program, cell, case, timestep, reference, end):
    """Columns of one run."""
    stepper, more, _, _ = case
    row = dict.fromkeys(("state", "mean_step", "evaluations", "cheap", "repeated", "rms_error",
                         "max_error", "reference_error", "volume_error", "radius",
                         "cpu_seconds"), "")
    row["reference_error"] = f"{reference.error:.2e}"
    try:
        run = program.run(cell, stepper, timestep, end, more)
    except Stopped as stopped:
        row["state"] = f"stopped: {str(stopped)[:160]}"
        return row
    rms, largest = distances(run.positions, reference.positions)
    is_stable = (run.mean_power() < POWER_LIMIT * reference.power
                 and run.largest("volume_error") < VOLUME_LIMIT)
    time = run.last("time")
    row.update(state="stable" if is_stable else "unstable",
               mean_step=f"{time / run.last('step'):.4g}",
               evaluations=f"{run.last('evaluations') / time:.4g}",
               cheap=f"{run.last('cheap') / time:.4g}", repeated=f"{run.last('repeated'):.0f}",
               rms_error=f"{rms:.3e}", max_error=f"{largest:.3e}",
               radius=f"{run.largest('radius'):.4g}",
               volume_error=f"{run.largest('volume_error'):.1e}",
               cpu_seconds=f"{max(0.0, run.cpu_seconds - reference.setup) / time:.4g}")
    return row


def measure_case(program, cell, case, options, table):
    """One row for each time step; with a search, down to the first stable one."""
    stepper, more, steps, scaled = case
    reference = Reference(program, cell, options)
    while True:
        if steps is None:
            wanted = (scaled / reference.radius,)
        else:
            wanted = steps
        for timestep in wanted:
            row = {"nodes": cell.nodes, "Ca": f"{cell.capillary_number:g}", "stepper": stepper,
                   "keywords": more, "timestep": f"{timestep:.4g}"}
            found = table.find(row)
            if not found:
                found = table.add({**row, **measure(program, cell, case, timestep, reference,
                                                    options.end)})
        if steps is not None or found["state"] == "stable" or scaled < SMALLEST:
            return
        scaled *= SHRINK


def compare(options):
    table = Table(options.output, ("nodes", "Ca", "stepper", "keywords", "timestep"))
    program = Program(options.lmp, options.work, options.accuracy)
    for nodes in options.nodes:
        for capillary_number in options.Ca:
            cell = Cell(int(nodes), capillary_number, options.dilatation)
            for case in CASES:
                if case[0] in options.steppers:
                    measure_case(program, cell, case, options, table)


def measure_orders(options):
    table = Table(options.output, ("start", "stepper", "steps"))
    program = Program(options.lmp, options.work, ORDERS_ACCURACY)
    cell = Cell(162, 0.5, options.dilatation)
    for start in ("unstressed", "developed"):
        if start == "developed":
            cell.restart = program.prepare_restart(cell, 1.0 / ORDERS["rkc2"][-1])
        exact = program.run(cell, "ab2", 1.0 / ORDERS_REFERENCE, 1.0).positions
        for stepper, counts in ORDERS.items():
            for steps in counts if stepper in options.steppers else ():
                row = {"start": start, "stepper": stepper, "steps": steps}
                if not table.find(row):
                    run = program.run(cell, stepper, 1.0 / steps, 1.0)
                    table.add({**row, **describe_order(run, 1.0 / steps, exact)})


def describe_order(run, timestep, exact):
    rms, largest = distances(run.positions, exact)
    return {"timestep": f"{timestep:.6g}", "evaluations": f"{run.last('evaluations'):.0f}",
            "rms_error": f"{rms:.4e}", "max_error": f"{largest:.4e}"}


def to_numbers(text):
    return [float(word) for word in text.split(",")]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--lmp", required=True)
    parser.add_argument("--work", required=True, help="folder for converged runs")
    parser.add_argument("--output", required=True, help="CSV file; rows are appended")
    parser.add_argument("--orders", action="store_true")
    parser.add_argument("--nodes", type=to_numbers, default=[162, 642, 2562])
    parser.add_argument("--Ca", type=to_numbers, default=[0.1, 0.5, 2.0])
    parser.add_argument("--steppers", type=lambda text: text.split(","),
                        default=["euler", "ab2", "rkc2"])
    parser.add_argument("--end", type=float, default=10.0)
    parser.add_argument("--accuracy", default="1e-3")
    parser.add_argument("--dilatation", type=float, default=100.0, help="ED")
    options = parser.parse_args()
    if options.orders:
        measure_orders(options)
    else:
        compare(options)


if __name__ == "__main__":
    main()
