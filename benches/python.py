#!/usr/bin/env python3
"""`netcert.certify` from Python beside the same calls from Rust, one after the other on one thread.

    cargo build --release --example certify_bends
    RAYON_NUM_THREADS=1 benches/python.py target/release/examples/certify_bends VEHICLE BENDS [RUNS]

The Python that runs this needs the package `netcert`, built with the release profile. Both sums of RSCs have to be equal.
"""

import math
import statistics
import subprocess
import sys
import time

import netcert
import numpy as np


def bend(number):
    """The bends of examples/certify_bends.rs."""
    radius = 20.0 + number % 60
    angle = np.arange(61) * (math.pi / 2) / 60
    arc = np.column_stack([radius * np.sin(angle), radius * (1 - np.cos(angle))])
    return np.vstack([[-200.0, 0.0], arc, [radius, radius + 200.0]])


def main():
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    rust, vehicle_id, bends, *runs = sys.argv[1:]
    vehicle = netcert.vehicles()[vehicle_id]
    corridors = [netcert.Corridor(bend(number), width_m=8.0) for number in range(int(bends))]
    rates = []
    print("| run | Rust, s | Python, s | Python / Rust |\n| --- | --- | --- | --- |")
    for run in range(int(runs[0]) if runs else 5):
        begin = time.perf_counter()
        total = 0.0
        for corridor in corridors:
            total += netcert.certify(corridor, vehicle).rsc_m or 0.0
        ours = time.perf_counter() - begin
        told = subprocess.run([rust, vehicle_id, bends], check=True, capture_output=True, text=True).stdout.split()
        if abs(float(told[1]) - total) > 1e-6:
            sys.exit(f"the sums of RSCs differ: {told[1]} and {total}")
        rates.append(ours / float(told[0]))
        print(f"| {run + 1} | {float(told[0]):.2f} | {ours:.2f} | {rates[-1]:.3f} |", flush=True)
    print(f"\nmedian: {statistics.median(rates):.3f}")


if __name__ == "__main__":
    main()
