"""Google Benchmark's JSON to CSV: report_near.py <JSON file> <CSV file>."""

import csv
import json
import sys
from pathlib import Path


def main():
    benchmarks = json.loads(Path(sys.argv[1]).read_text())["benchmarks"]
    if not benchmarks:
        raise SystemExit(f"report: {sys.argv[1]} has no results")
    with open(sys.argv[2], "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["name", "ns_per_pair"])
        for row in benchmarks:
            writer.writerow([row["name"], f"{row['ns_per_pair']:.4g}"])


if __name__ == "__main__":
    main()
