"""Communication and memory on many ranks, on paper: from one measured evaluation of a suspension
and the formulas of the page's section 'Beyond this machine'."""

import math

from report_results import pick_one, power_of_ten
from report_tables import make_table, show_count

TOLERANCE = 1e-3
HEMATOCRIT = 0.15
BYTES = 8
MEGABYTE = 1e6
SOURCES_PER_NODE = 3    # far rule: one at each node, one in each of two triangles
FIELDS = 3              # single layer; a double layer adds one on the way to Fourier space
NEAR_PAIR_BYTES = 4


class Paper:
    """Per node constants of the measured evaluation, and what follows for n nodes on r ranks."""

    def __init__(self, row):
        self.nodes_per_cell = row["n_nodes"]
        nodes = row["n_cells"] * row["n_nodes"]
        self.grid_per_node = math.prod(int(m) for m in row["grid"].split("x")) / nodes
        self.order = row["order"]
        self.reach = row["cutoff"] + 0.2    # of the ghosts: cutoff plus an edge, in cell radii
        self.near_pairs = row["near_pairs_per_cell"] / row["n_nodes"]
        self.seconds_per_node = 1e-3 * row["cpu_ms_per_cell"] / row["n_nodes"]

    def planes(self, n):
        return round((self.grid_per_node * n) ** (1.0 / 3.0))

    def copies(self, n, ranks):
        """Slabs to which a point is sent, average."""
        return 1.0 + (self.order - 1.0) * ranks / self.planes(n) if ranks > 1 else 1.0

    def grid_bytes(self, n, ranks):
        return (FIELDS + 1.0) * BYTES * self.grid_per_node * n / ranks    # 1: buffer of FFTW

    def point_bytes(self, n, ranks):
        routed = (SOURCES_PER_NODE + 1.0) * self.copies(n, ranks) * BYTES * (3.0 + 3.0 * self.order)
        own = (SOURCES_PER_NODE + 1.0) * 12.0 * BYTES + self.near_pairs * NEAR_PAIR_BYTES
        return n / ranks * (routed + own)

    def transposed_bytes(self, n, ranks):
        return 2.0 * FIELDS * BYTES * self.grid_per_node * n / ranks * (1.0 - 1.0 / ranks)

    def exchanged_bytes(self, n, ranks):
        values = 6.0 * SOURCES_PER_NODE + 6.0    # positions and forces; positions and velocities
        return values * BYTES * n / ranks * self.copies(n, ranks)

    def ghosts(self, n, ranks):
        length = (4.0 * math.pi / 3.0 / HEMATOCRIT * n / self.nodes_per_cell / ranks) ** (1.0 / 3.0)
        return n / ranks * ((1.0 + 2.0 * self.reach / length) ** 3 - 1.0)


def tabulate_beyond(results):
    row = pick_one(results.suspension, forces="membrane", split="pswf", tolerance=TOLERANCE,
                   ranks=1.0)
    if row is None:
        raise SystemExit(f"report: suspension.csv has no row for {TOLERANCE} on one rank")
    paper = Paper(row)
    head = ["nodes", "planes M", "ranks", "CPU s per evaluation", "grids, MB", "points, MB",
            "transposed, MB", "messages", "point exchange, MB", "ghosts", "ghost values, MB"]
    rows = []
    for n, rank_counts in ((1e6, (8, 64, 0)), (1e8, (64, 512, 0))):
        for ranks in rank_counts:
            ranks = ranks or paper.planes(n)    # 0: as many as there are planes
            ghosts = paper.ghosts(n, ranks)
            megabytes = [paper.grid_bytes(n, ranks), paper.point_bytes(n, ranks),
                         paper.transposed_bytes(n, ranks)]
            cells = [f"{power_of_ten(n)}", show_count(paper.planes(n)), show_count(ranks),
                     f"{n / ranks * paper.seconds_per_node:.2g}"]
            cells += [f"{value / MEGABYTE:.3g}" for value in megabytes]
            cells += [show_count(2 * FIELDS * (ranks - 1)),
                      f"{paper.exchanged_bytes(n, ranks) / MEGABYTE:.3g}", f"{ghosts:.2g}",
                      f"{2 * 3 * BYTES * ghosts / MEGABYTE:.2g}"]
            rows.append(cells)
    return make_table(head, rows)
