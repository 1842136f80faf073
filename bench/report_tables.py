"""The tables of the report as Markdown, one function each. Numbers come from the CSV files only."""

from report_results import KERNELS, PARTS, SPLITS, fit_slope, pick, pick_one, power_of_ten, values

MISSING = "-"


def make_table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    lines += ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join(lines)


def show(value, digits=3):
    """A number with few digits; '-' where there is none."""
    if value is None or value != value:
        return MISSING
    return f"{value:.{digits}g}"


def show_error(value):
    return MISSING if value is None or value != value else f"{value:.1e}"


def show_count(value):
    return f"{int(value):,}".replace(",", " ")


def compute_ratio(above, below, key="cpu_seconds"):
    return above[key] / below[key] if above and below else None


def tabulate_machine(results):
    machine = results.machine
    return make_table(["processor", "compiler", "date"],
                      [[machine["processor"], machine["compiler"], machine["date"]]])


def find_at(results, kernel, split, tolerance, n=None):
    return pick_one(results.error_time, kernel=kernel, split=split, tolerance=tolerance,
                    n=n or results.n_tables)


def list_goals(results):
    """(what, goal text, measured, whether the goal is met; None: not measured)."""
    goals = []

    def add(what, text, value, is_met):
        goals.append((what, text, show(value), None if value is None else is_met(value)))

    def at_most(limit):
        return lambda value: value <= limit

    def at_least(limit):
        return lambda value: value >= limit

    n = show_count(results.n_tables)
    for tolerance, limit in ((1e-3, 0.9), (1e-6, 2.5)):
        row = find_at(results, "SL", "pswf", tolerance)
        add(f"SL, pswf, {power_of_ten(tolerance)}, n = {n}: us per point", f"<= {limit}",
            row and row["us_per_point"], at_most(limit))
    for tolerance in (1e-3, 1e-4, 1e-6):
        add(f"SL, {power_of_ten(tolerance)}, n = {n}: time spme / pswf", ">= 3",
            compute_ratio(find_at(results, "SL", "spme", tolerance),
                          find_at(results, "SL", "pswf", tolerance)), at_least(3.0))
    for tolerance in (1e-3, 1e-6):
        add(f"pswf, {power_of_ten(tolerance)}, n = {n}: time SL+DL / SL", "<= 2.5",
            compute_ratio(find_at(results, "SL+DL", "pswf", tolerance),
                          find_at(results, "SL", "pswf", tolerance)), at_most(2.5))
    ratios = [ratio for *_, found in list_growth(results) for ratio in found if ratio]
    add("8 times more points: time, largest of all cases", "<= 9", max(ratios, default=None),
        at_most(9.0))
    efficiencies = [e for _, _, _, n, _, _, e in list_efficiencies(results)
                    if n == max(values(results.ranks, "n"))]
    add("two ranks, most points: efficiency, smallest of all cases", ">= 0.85",
        min(efficiencies, default=None), at_least(0.85))
    ratios = [row["measured_error"] / row["tolerance"] for row in results.accuracy]
    add("measured / requested error, largest of all cases", "<= 1", max(ratios), at_most(1.0))
    add("measured / requested error, smallest of all cases", ">= 0.1", min(ratios), at_least(0.1))
    row = pick_one(results.suspension, forces="membrane", split="pswf", tolerance=1e-3, ranks=1.0)
    add("suspension, 1e-3, one rank: CPU ms per cell", "<= 4", row and row["cpu_ms_per_cell"],
        at_most(4.0))
    return goals


def tabulate_goals(results):
    words = {True: "yes", False: "**no**", None: MISSING}
    return make_table(["quantity", "goal", "measured", "met"],
                      [[what, text, value, words[is_met]]
                       for what, text, value, is_met in list_goals(results)])


def tabulate_error_time(results):
    head = ["tolerance"]
    for kernel in KERNELS:
        head += [f"{kernel} {split}" for split in SPLITS]
    rows = []
    for tolerance in reversed(values(results.error_time, "tolerance")):
        cells = []
        for kernel in KERNELS:
            for split in SPLITS:
                row = find_at(results, kernel, split, tolerance)
                cells.append(f"{show(row['us_per_point'])} ({show_error(row['measured_error'])})"
                             if row else MISSING)
        rows.append([power_of_ten(tolerance)] + cells)
    return make_table(head, rows)


def tabulate_ratios(results):
    head = ["n", "tolerance"] + [f"{kernel}: spme / pswf" for kernel in KERNELS]
    head += [f"{split}: SL+DL / SL" for split in SPLITS]
    rows = []
    for n in values(results.error_time, "n"):
        for tolerance in (1e-3, 1e-4, 1e-6):
            found = {(kernel, split): find_at(results, kernel, split, tolerance, n)
                     for kernel in KERNELS for split in SPLITS}
            if not any(found.values()):
                continue
            ratios = [compute_ratio(found[kernel, "spme"], found[kernel, "pswf"])
                      for kernel in KERNELS]
            ratios += [compute_ratio(found["SL+DL", split], found["SL", split])
                       for split in SPLITS]
            rows.append([show_count(n), power_of_ten(tolerance)] +
                        [show(ratio) for ratio in ratios])
    return make_table(head, rows)


def list_growth(results):
    """(kernel, split, tolerance, rows by n, ratios of the times of successive n)."""
    cases = []
    for kernel in values(results.scaling, "kernel"):
        for split in SPLITS:
            for tolerance in reversed(values(results.scaling, "tolerance")):
                rows = sorted(pick(results.scaling, kernel=kernel, split=split,
                                   tolerance=tolerance), key=lambda row: row["n"])
                ratios = [compute_ratio(b, a) for a, b in zip(rows, rows[1:])]
                cases.append((kernel, split, tolerance, rows, ratios))
    return cases


def tabulate_growth(results):
    numbers = values(results.scaling, "n")
    head = ["kernel", "split", "tolerance"]
    head += [f"us per point, n = {show_count(n)}" for n in numbers]
    head += [f"{show_count(b)} : {show_count(a)}" for a, b in zip(numbers, numbers[1:])]
    rows = [[kernel, split, power_of_ten(tolerance)] +
            [show(row["us_per_point"]) for row in found] + [show(ratio) for ratio in ratios] +
            [show(fit_slope(found))]
            for kernel, split, tolerance, found, ratios in list_growth(results)]
    return make_table(head + ["slope"], rows)


def list_efficiencies(results):
    """(kernel, split, tolerance, n, row on one rank, row on two ranks, efficiency)."""
    cases = []
    for one in pick(results.ranks, ranks=1.0):
        key = {name: one[name] for name in ("kernel", "split", "tolerance", "n")}
        two = pick_one(results.ranks, ranks=2.0, **key)
        if two:
            cases.append((*key.values(), one, two, one["cpu_seconds"] / (2.0 * two["cpu_seconds"])))
    return cases


def tabulate_ranks(results):
    head = ["kernel", "split", "tolerance", "n", "one rank, ms", "two ranks, ms", "efficiency",
            "waiting and messages, ms"]
    rows = []
    for kernel, split, tolerance, n, one, two, efficiency in list_efficiencies(results):
        rows.append([kernel, split, power_of_ten(tolerance), show_count(n),
                     show(1e3 * one["cpu_seconds"]), show(1e3 * two["cpu_seconds"]),
                     f"{100.0 * efficiency:.0f} %", show(1e3 * (two["exchange"] + two["ghosts"]))])
    return make_table(head, rows)


def tabulate_accuracy(results):
    head = ["points", "kernel"]
    for split in SPLITS:
        head += [f"{split}: smallest", f"{split}: largest", "at"]
    rows = []
    for kind in values(results.accuracy, "points"):
        for kernel in KERNELS:
            cells = [kind, kernel]
            for split in SPLITS:
                found = pick(results.accuracy, points=kind, kernel=kernel, split=split)
                found.sort(key=lambda row: row["measured_error"] / row["tolerance"])
                low, high = found[0], found[-1]
                cells += [show(row["measured_error"] / row["tolerance"], 2) for row in (low, high)]
                cells.append(f"{high['cell']}, {high['label']}")
            rows.append(cells)
    return make_table(head, rows)


def tabulate_suspension(results):
    head = ["ranks", "split", "tolerance", "error, membrane", "error, smooth", "CPU ms per cell",
            "membrane", "near", "far", "communication", "rest"]
    far = [part for part in PARTS if part not in ("membrane", "near", "communication", "rest")]
    rows = []
    for row in pick(results.suspension, forces="membrane"):
        smooth = pick_one(results.suspension, forces="smooth", split=row["split"],
                          tolerance=row["tolerance"], ranks=row["ranks"])
        rows.append([show(row["ranks"]), row["split"], row["label"],
                     show_error(row["measured_error"]),
                     show_error(smooth and smooth["measured_error"]), show(row["cpu_ms_per_cell"]),
                     show(row["membrane"], 2), show(row["near"], 2),
                     show(sum(row[part] for part in far), 2), show(row["communication"], 2),
                     show(row["rest"], 2)])
    return make_table(head, rows)


def tabulate_blocks(results):
    head = ["scene", "accuracy", "error", "time per step, ms", "membrane forces' sum",
            "coupled system", "everything else", "iterations", "cold"]
    rows = []
    for row in results.blocks:
        rest = row["wall_ms"] - row["forces_ms"] - row["coupled_ms"]
        rows.append([row["scene"], power_of_ten(row["accuracy"]), show_error(row["error"]),
                     show(row["wall_ms"]), show(row["forces_ms"]), show(row["coupled_ms"]),
                     show(rest), show(row["iterations"], 2), show(row["cold_iterations"])])
    return make_table(head, rows)


def tabulate_near(results):
    return make_table(["case", "ns per pair"],
                      [[f"`{row['name']}`", show(row["ns_per_pair"])] for row in results.near])


TABLES = {
    "machine": tabulate_machine,
    "goals": tabulate_goals,
    "error_time": tabulate_error_time,
    "ratios": tabulate_ratios,
    "growth": tabulate_growth,
    "ranks": tabulate_ranks,
    "accuracy": tabulate_accuracy,
    "suspension": tabulate_suspension,
    "blocks": tabulate_blocks,
    "near": tabulate_near,
}
