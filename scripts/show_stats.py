#!/usr/bin/python3
"""Prints what runs cost, from the files that --stats wrote.

usage: scripts/show_stats.py FILE...
"""
import json
import sys


def megabytes(count):
    return f"{count / 1e6:.1f} MB"


def show(path):
    with open(path, encoding="utf-8") as file:
        stats = json.load(file)
    print(f"{stats['program']}: {stats['seconds_wall']:.2f} s ({stats['seconds_cpu']:.2f} s of CPU, "
          f"{stats['threads']} threads), peak memory {megabytes(stats['peak_bytes'])}")
    counts = ", ".join(f"{value:,} {name}" for name, value in stats.get("counts", {}).items())
    if counts:
        print(f"  {counts}")
    for phase in stats.get("phases", []):
        print(f"  {phase['name']:<12} {phase['seconds_wall']:8.2f} s")
    times = sorted(frame["ms"] for frame in stats.get("frames", []))
    if times:
        print(f"  pictures: {len(times)}, median {times[len(times) // 2]:.1f} ms, slowest {times[-1]:.1f} ms")


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__.strip().splitlines()[-1])
    for path in sys.argv[1:]:
        show(path)


if __name__ == "__main__":
    main()
