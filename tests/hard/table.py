"""The table of hard cases as Markdown: case, promise, what happened.

    tests/hard/table.py [--long] [--only TEXT] [--page doc/hard-cases.md]

Runs the cases of test_*.py here, in the short or the long variant; --only takes those whose name
has the text. With --page the table of that page is replaced, between '<!-- begin table -->' and
'<!-- end table -->'; with --only, only the rows of these cases. Environment: BIEM_LMP, the program;
HARD_STEPPER, the stepper.
"""

import argparse
import importlib
import re
import sys
import time
from pathlib import Path

FOLDER = Path(__file__).resolve().parent
BEGIN, END = "<!-- begin table -->", "<!-- end table -->"


def find_cases():
    sys.path.insert(0, str(FOLDER))
    return [case for path in sorted(FOLDER.glob("test_*.py"))
            for case in importlib.import_module(path.stem).CASES]


def run_case(case, size):
    """(name, row)"""
    begun = time.monotonic()
    try:
        happened = "kept: " + case.run(size)
    except AssertionError as broken:
        happened = f"**not kept**: {broken}"
    happened = re.sub(r"\s+", " ", happened).replace("|", "/")
    seconds = time.monotonic() - begun
    return case.name, f"| {case.name} | {case.promise} | {happened} | {seconds:.0f} |"


def insert_rows(text, rows, order):
    """The page with these rows new or replaced, in the order of the cases."""
    begin, end = text.index(BEGIN) + len(BEGIN), text.index(END)
    old = {line.split("|")[1].strip(): line for line in text[begin:end].splitlines()
           if line.startswith("| ")}
    return text[:begin] + "\n\n" + make_table({**old, **rows}, order) + "\n\n" + text[end:]


def make_table(rows, order):
    lines = ["| case | promise | what happened | seconds |", "|---|---|---|---|"]
    return "\n".join(lines + [rows[name] for name in order if name in rows])


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--long", action="store_true")
    parser.add_argument("--only", default="")
    parser.add_argument("--page", type=Path)
    options = parser.parse_args()
    size, cases = "long" if options.long else "short", find_cases()
    rows, order = {}, [case.name for case in cases]
    for case in cases:
        if options.only in case.name and case.sizes[size] is not None:
            name, rows[case.name] = run_case(case, size)
            print(rows[name], file=sys.stderr, flush=True)
            if options.page:
                options.page.write_text(insert_rows(options.page.read_text(),
                                                    {name: rows[name]}, order))
    if not options.page:
        print(make_table(rows, order))


if __name__ == "__main__":
    main()
