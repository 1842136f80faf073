"""The plots of the report, one function each; each returns a matplotlib figure."""

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from report_results import (KERNELS, PARTS, PHASES, SPLITS, fit_slope, pick, power_of_ten,
                            values)

COLORS = {"pswf": "#1f6fb4", "spme": "#d9601a"}
SHADES = {"pswf": ["#9ecae1", "#4f9fd0", "#1f6fb4", "#08306b"],
          "spme": ["#fdc28c", "#f58b45", "#d9601a", "#7f2704"]}
MARKERS = ["o", "s", "^", "D", "v"]
PHASE_COLORS = ["#b2182b", "#f4a582", "#2166ac", "#67a9cf", "#fddb7f", "#b8b8b8", "#7a7a7a",
                "#5aae61", "#a6dba0"]
PART_COLORS = ["#762a83", "#c2a5cf", "#b2182b", "#7a7a7a", "#b8b8b8", "#f4a582", "#2166ac",
               "#67a9cf", "#fddb7f", "#5aae61", "#e0e0e0"]
NAMES = {"real_space": "real space", "kernel_scaling": "scaling", "transform": "FFT",
         "search": "sorting", "exchange": "point exchange", "ghosts": "ghost velocities",
         "near": "near field"}

plt.rcParams.update({"font.size": 10, "axes.grid": True, "grid.alpha": 0.3,
                     "axes.axisbelow": True, "figure.constrained_layout.use": True})


def name_of(part):
    return NAMES.get(part, part)


def plot_error_time(results):
    """Measured error against time per point; the curves of one split get darker with n."""
    figure, axes = plt.subplots(1, 3, figsize=(13, 4.6), sharey=True)
    numbers = values(results.error_time, "n")
    for axis, kernel in zip(axes, KERNELS):
        for split in SPLITS:
            for i, n in enumerate(numbers):
                rows = pick(results.error_time, kernel=kernel, split=split, n=n)
                if not rows:
                    continue
                axis.loglog([row["us_per_point"] for row in rows],
                            [row["measured_error"] for row in rows], marker=MARKERS[i],
                            color=SHADES[split][i], markersize=4.5, linewidth=1.4,
                            linestyle="-" if split == "pswf" else "--",
                            label=f"{split}, n = {power_of_ten(n)}")
        axis.set_title(kernel)
        axis.set_xlabel("CPU time per point [us]")
        axis.set_xticks([0.5, 1, 2, 5, 10], ["0.5", "1", "2", "5", "10"])
        axis.minorticks_off()
    axes[0].set_ylabel("measured relative error")
    axes[0].legend(fontsize=8)
    return figure


def plot_growth(results):
    """Time against the number of points, with the fitted exponent."""
    kernels = values(results.scaling, "kernel")
    figure, axes = plt.subplots(1, len(kernels), figsize=(11, 4.4), sharey=True, squeeze=False)
    for axis, kernel in zip(axes[0], kernels):
        for split in SPLITS:
            for tolerance in reversed(values(results.scaling, "tolerance")):
                rows = pick(results.scaling, kernel=kernel, split=split, tolerance=tolerance)
                axis.loglog([row["n"] for row in rows], [row["cpu_seconds"] for row in rows],
                            marker="o", markersize=4.5, color=COLORS[split],
                            linestyle="-" if tolerance > 1e-5 else "--",
                            label=f"{split}, {power_of_ten(tolerance)}: "
                                  f"slope {fit_slope(rows):.2f}")
        axis.set_title(kernel)
        axis.set_xlabel("points n")
        numbers = values(results.scaling, "n")
        axis.set_xticks(numbers, [f"{int(n)}" for n in numbers])
        axis.minorticks_off()
        axis.legend(fontsize=9)
    axes[0][0].set_ylabel("CPU time of one evaluation [s]")
    return figure


def draw_bars(axis, labels, rows, parts, colors, scale):
    """Stacked bars: one for each row, parts from the bottom to the top. Returns the height."""
    bottom = [0.0] * len(rows)
    for part, color in zip(parts, colors):
        heights = [scale(row) * row[part] for row in rows]
        axis.bar(range(len(rows)), heights, bottom=bottom, width=0.7, color=color,
                 label=name_of(part), edgecolor="white", linewidth=0.4)
        bottom = [low + height for low, height in zip(bottom, heights)]
    for i, total in enumerate(bottom):
        axis.text(i, total, f"{total:.2f}", ha="center", va="bottom", fontsize=8)
    axis.set_xticks(range(len(rows)), labels)
    axis.grid(False, axis="x")
    return max(bottom)


def show_legend(axis):
    handles, labels = axis.get_legend_handles_labels()
    axis.legend(handles[::-1], labels[::-1], fontsize=9, loc="center left",
                bbox_to_anchor=(1.0, 0.5))


def plot_phases(results):
    """Breakdown of one evaluation by phase, one rank."""
    figure, axes = plt.subplots(1, len(KERNELS), figsize=(13, 4.4), sharey=True)
    heights = []
    for axis, kernel in zip(axes, KERNELS):
        rows, labels = [], []
        for tolerance in (1e-3, 1e-4, 1e-6):
            for split in SPLITS:
                found = pick(results.error_time, kernel=kernel, split=split, tolerance=tolerance,
                             n=results.n_tables)
                rows += found
                labels += [f"{power_of_ten(tolerance)}\n{split}"] * len(found)
        heights.append(draw_bars(axis, labels, rows, PHASES, PHASE_COLORS,
                                 lambda row: 1e6 / row["n"]))
        axis.set_title(f"{kernel}, n = {power_of_ten(results.n_tables)}")
    axes[0].set_ylim(0.0, 1.08 * max(heights))
    axes[0].set_ylabel("CPU time per point [us]")
    show_legend(axes[-1])
    return figure


def plot_accuracy(results):
    """Measured over requested error; the band is what is asked for."""
    kinds = values(results.accuracy, "points")
    cells = values(results.accuracy, "cell")
    kernel_colors = dict(zip(KERNELS, ["#1b7837", "#762a83", "#d9601a"]))
    figure, axes = plt.subplots(2, len(kinds), figsize=(13, 6.6), sharex=True, sharey=True)
    for line, split in zip(axes, SPLITS):
        for axis, kind in zip(line, kinds):
            axis.axhspan(0.1, 1.0, color="#d9ead3", zorder=0)
            for k, kernel in enumerate(KERNELS):
                for c, cell in enumerate(cells):
                    rows = pick(results.accuracy, points=kind, split=split, kernel=kernel,
                                cell=cell)
                    axis.loglog([row["tolerance"] * 1.18 ** (k - 1) for row in rows],
                                [row["measured_error"] / row["tolerance"] for row in rows],
                                linestyle="none", marker=MARKERS[c], markersize=4.5,
                                markerfacecolor="none", color=kernel_colors[kernel],
                                label=f"{kernel}, {cell}")
            axis.set_title(f"{split}: {kind}")
    for axis in axes[-1]:
        axis.set_xlabel("requested error")
    for line in axes:
        line[0].set_ylabel("measured / requested")
    axes[0][0].invert_xaxis()
    handles, labels = axes[0][0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="upper center", bbox_to_anchor=(0.5, 0.0), fontsize=9,
                  ncol=2 * len(KERNELS))
    return figure


def plot_suspension(results):
    """Breakdown of one velocity evaluation of a suspension."""
    rows = pick(results.suspension, forces="membrane")
    ranks = values(rows, "ranks")
    figure, axes = plt.subplots(1, len(ranks), figsize=(13, 4.6), sharey=True, squeeze=False)
    heights = []
    for axis, n_ranks in zip(axes[0], ranks):
        found = sorted(pick(rows, ranks=n_ranks), key=lambda row: (-row["tolerance"], row["split"]))
        labels = [f"{row['label']}\n{row['split']}" for row in found]
        heights.append(draw_bars(axis, labels, found, PARTS, PART_COLORS, lambda row: 1.0))
        axis.axhline(4.0, color="black", linewidth=1.0, linestyle=":")
        axis.set_title(f"{int(n_ranks)} rank{'s' if n_ranks > 1 else ''}")
    axes[0][0].set_ylim(0.0, max(4.4, 1.08 * max(heights)))
    axes[0][0].set_ylabel("CPU time per cell [ms]")
    show_legend(axes[0][-1])
    return figure


PLOTS = {
    "error_time": plot_error_time,
    "growth": plot_growth,
    "phases": plot_phases,
    "accuracy": plot_accuracy,
    "suspension": plot_suspension,
}
