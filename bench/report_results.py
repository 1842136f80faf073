"""The measured rows of the report: reading the CSV files and picking rows."""

import csv
import math

KERNELS = ["SL", "DL", "SL+DL"]
SPLITS = ["pswf", "spme"]
PHASES = ["real_space", "spread", "transform", "kernel_scaling", "interpolate", "windows", "search",
          "exchange", "ghosts"]
PARTS = ["membrane", "near", "real_space", "search", "windows", "spread", "transform",
         "kernel_scaling", "interpolate", "communication", "rest"]


def read_csv(path):
    """List of rows, each a dict; numbers are floats, tolerances keep their text in 'label'."""
    with path.open(newline="") as file:
        rows = [{**{key: to_number(value) for key, value in row.items()},
                 "label": row.get("tolerance")} for row in csv.DictReader(file)]
    if not rows:
        raise SystemExit(f"report: {path} has no rows; its program has failed")
    return rows


def to_number(text):
    try:
        return float(text)
    except (TypeError, ValueError):
        return text


def power_of_ten(n):
    """'1e5' for 100000, '1e-3' for 0.001."""
    mantissa, exponent = f"{n:.0e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def pick(rows, **wanted):
    """Rows whose columns have the wanted values."""
    return [row for row in rows if all(row[key] == value for key, value in wanted.items())]


def pick_one(rows, **wanted):
    """The only such row, or None."""
    found = pick(rows, **wanted)
    if len(found) > 1:
        raise SystemExit(f"report: {len(found)} rows for {wanted}, one was expected")
    return found[0] if found else None


def values(rows, key):
    """Distinct values of a column, in ascending order for numbers, else as they appear."""
    found = list(dict.fromkeys(row[key] for row in rows))
    return sorted(found) if all(isinstance(value, float) for value in found) else found


def fit_slope(rows):
    """Exponent p of time ~ n^p, least squares in the logarithms."""
    x = [math.log(row["n"]) for row in rows]
    y = [math.log(row["cpu_seconds"]) for row in rows]
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    return (sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)) /
            sum((a - mean_x) ** 2 for a in x))


class Results:
    """All CSV files of one report."""

    def __init__(self, folder):
        self.error_time = read_csv(folder / "error_time.csv")
        self.scaling = read_csv(folder / "scaling.csv")
        self.ranks = read_csv(folder / "ranks.csv")
        self.accuracy = (read_csv(folder / "accuracy_pswf.csv") +
                         read_csv(folder / "accuracy_spme.csv"))
        self.suspension = read_csv(folder / "suspension.csv")
        self.blocks = read_csv(folder / "blocks.csv")
        self.near = read_csv(folder / "near_triangle.csv")
        self.machine = read_csv(folder / "machine.csv")[0]
        # The number of points of the tables: 1e5 in the full report.
        numbers = [n for n in values(self.error_time, "n") if n <= 1e5]
        self.n_tables = numbers[-1]
