"""Tables and plot of the steppers from the CSV files of time.py: time_report.py <folder>.

<folder>/results/{time,orders,scenes}.csv are read; <folder>/README.md gets its tables between
the lines '<!-- begin table: NAME -->' and '<!-- end table -->'; the plot is <folder>/error_cpu.png.
"""

import sys
from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.ticker import FormatStrFormatter, LogLocator, NullFormatter

from report import insert_tables
from report_results import pick, read_csv, values
from report_tables import MISSING, make_table, show, show_error

COLORS = {"euler": "#7a7a7a", "ab2": "#d9601a", "rkc2": "#1f6fb4", "rkc2 multirate": "#1b7837"}
MARKERS = {False: "o", True: "s"}    # with a tolerance

plt.rcParams.update({"font.size": 10, "axes.grid": True, "grid.alpha": 0.3,
                     "axes.axisbelow": True, "figure.constrained_layout.use": True})


class Results:
    def __init__(self, folder):
        self.time = read_csv(folder / "time.csv")
        self.orders = read_csv(folder / "orders.csv")
        self.scenes = read_csv(folder / "scenes.csv")


def find_stable(results, **wanted):
    return [row for row in pick(results.time, **wanted) if row["state"] == "stable"]


def name_of(row):
    return f"{row['stepper']} {row['keywords']}".strip()


def tabulate_time(results):
    """The stable runs; of a search for the largest step only the one that was stable."""
    head = ["nodes", "Ca", "stepper", "dt", "mean dt", "evaluations / time", "inner / time",
            "rms error at the end", "largest", "CPU s / time"]
    rows = []
    for row in results.time:
        if row["state"] != "stable":
            rows.append([f"{row['nodes']:.0f}", show(row["Ca"]), name_of(row),
                         show(row["timestep"]), f"**{row['state']}**"] + [MISSING] * 5)
            continue
        rows.append([f"{row['nodes']:.0f}", show(row["Ca"]), name_of(row), show(row["timestep"]),
                     show(row["mean_step"]), show(row["evaluations"]), show(row["cheap"]),
                     show_error(row["rms_error"]), show_error(row["max_error"]),
                     show(row["cpu_seconds"])])
    return make_table(head, rows)


def tabulate_references(results):
    head = ["nodes", "Ca", "error of the converged run (rms)"]
    rows = [[f"{nodes:.0f}", show(number), show_error(found[0]["reference_error"])]
            for nodes in values(results.time, "nodes") for number in values(results.time, "Ca")
            for found in [pick(results.time, nodes=nodes, Ca=number)] if found]
    return make_table(head, rows)


def fit_order(rows):
    """Slope of the error against the step, least squares in the logarithms."""
    return np.polyfit(np.log([row["timestep"] for row in rows]),
                      np.log([row["rms_error"] for row in rows]), 1)[0]


def tabulate_orders(results):
    head = ["start", "stepper", "dt", "evaluations", "rms error", "order from the row above",
            "fitted order"]
    rows = []
    for start in values(results.orders, "start"):
        for stepper in values(results.orders, "stepper"):
            found = sorted(pick(results.orders, start=start, stepper=stepper),
                           key=lambda row: -row["timestep"])
            for i, row in enumerate(found):
                rows.append([start, stepper, show(row["timestep"]), f"{row['evaluations']:.0f}",
                             show_error(row["rms_error"]),
                             f"{fit_order(found[i - 1:i + 1]):.2f}" if i else "",
                             f"{fit_order(found):.2f}" if i + 1 == len(found) else ""])
    return make_table(head, rows)


def tabulate_scenes(results):
    head = ["scene", "stepper", "dt", "evaluations / time", "inner / time", "rms error", "largest",
            "CPU s / time", "gain over ab2"]
    rows = []
    for scene in values(results.scenes, "scene"):
        found = pick(results.scenes, scene=scene)
        slowest = next((row for row in found if row["stepper"] == "ab2"), None)
        for row in found:
            gain = show(slowest["cpu_seconds"] / row["cpu_seconds"], 2) if slowest else MISSING
            rows.append([scene, name_of(row), show(row["timestep"]), show(row["evaluations"]),
                         show(row["inner"]), show_error(row["rms_error"]),
                         show_error(row["max_error"]), show(row["cpu_seconds"]), gain])
    return make_table(head, rows)


TABLES = {"time": tabulate_time, "references": tabulate_references, "orders": tabulate_orders,
          "scenes": tabulate_scenes}


def plot_error_cpu(results):
    """Error at the end against CPU time, one panel for each mesh and capillary number."""
    meshes, numbers = values(results.time, "nodes"), values(results.time, "Ca")
    figure, axes = plt.subplots(len(meshes), len(numbers), squeeze=False, sharey=True,
                                figsize=(4.2 * len(numbers), 3.4 * len(meshes)))
    for line, nodes in zip(axes, meshes):
        for axis, number in zip(line, numbers):
            found = find_stable(results, nodes=nodes, Ca=number)
            if not found:
                axis.set_axis_off()
                continue
            for stepper, color in COLORS.items():
                for has_tolerance, marker in MARKERS.items():
                    rows = [row for row in found
                            if row["stepper"] + " multirate" * ("multirate" in row["keywords"])
                            == stepper and ("tolerance" in row["keywords"]) == has_tolerance]
                    if rows:
                        axis.loglog([row["cpu_seconds"] for row in rows],
                                    [row["rms_error"] for row in rows], marker=marker,
                                    color=color, linewidth=1.2, markersize=5,
                                    label=stepper + ", tolerance" * has_tolerance)
            axis.axhline(3e-3, color="black", linestyle=":", linewidth=1.0)
            axis.set_title(f"{nodes:.0f} nodes, Ca {number:g}")
            axis.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            axis.xaxis.set_major_formatter(FormatStrFormatter("%g"))
            axis.xaxis.set_minor_formatter(NullFormatter())
    for axis in axes[-1]:
        axis.set_xlabel("CPU seconds per unit time")
    for line in axes:
        line[0].set_ylabel("rms error [a]")
    axes[0][0].legend(fontsize=8)
    return figure


def main():
    folder = Path(sys.argv[1])
    results = Results(folder / "results")
    page = folder / "README.md"
    page.write_text(insert_tables(page.read_text(), results, TABLES))
    plot_error_cpu(results).savefig(folder / "error_cpu.png", dpi=110, bbox_inches="tight")


if __name__ == "__main__":
    main()
