"""Tables and plots of the page on speed and error, from its CSV files: report.py <folder>.

<folder>/results/*.csv are read; <folder>/README.md gets its tables between the lines
'<!-- begin table: NAME -->' and '<!-- end table -->'; the plots are <folder>/*.png.
"""

import re
import sys
from pathlib import Path

from report_beyond import tabulate_beyond
from report_plots import PLOTS
from report_results import Results
from report_tables import TABLES as MEASURED_TABLES

TABLES = {**MEASURED_TABLES, "beyond": tabulate_beyond}


def insert_tables(text, results, tables):
    """The page with every marked table replaced; every known table must be there once."""
    seen = []

    def replace(match):
        name = match.group(1)
        if name not in tables:
            raise SystemExit(f"report: the page asks for a table '{name}'; known: "
                             f"{', '.join(tables)}")
        seen.append(name)
        return f"<!-- begin table: {name} -->\n\n{tables[name](results)}\n\n<!-- end table -->"

    text = re.sub(r"<!-- begin table: (\w+) -->.*?<!-- end table -->", replace, text,
                  flags=re.DOTALL)
    if sorted(seen) != sorted(tables):
        raise SystemExit(f"report: the page has the tables {seen}, but each of {list(tables)} "
                         "must be there once")
    return text


def main():
    folder = Path(sys.argv[1])
    results = Results(folder / "results")
    page = folder / "README.md"
    page.write_text(insert_tables(page.read_text(), results, TABLES))
    for name, plot in PLOTS.items():
        figure = plot(results)
        figure.savefig(folder / f"{name}.png", dpi=110, bbox_inches="tight")


if __name__ == "__main__":
    main()
