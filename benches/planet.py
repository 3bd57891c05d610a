#!/usr/bin/env python3
"""A planet on paper: the schedule of its tasks on a cluster, from the measured tasks of a region.

    benches/planet.py TASKS.csv [--km 120e6] [--vehicles 35] [--price 0.0162] [--lost 0.05]

TASKS.csv is what benches/spark.py writes. Tasks are drawn from it until they have the length of the planet's directed edges. A core that is free takes the
next task, the dearest first. `--lost`: the share of cores that are taken away in an hour, as spot machines are; what they were doing is done again.
`--price`: dollars for a core and hour. By default that of a spot machine of 96 cores in an example of AWS (EC2 Auto Scaling user guide, "Spot price per
unit hour example": c5.24xlarge, 1.555 dollars).
"""

import argparse
import csv
import heapq
import random


def schedule(costs, cores, lost_an_hour, draw):
    """Hours until all tasks are done, and hours of work that were lost."""
    free = [(0.0, core) for core in range(cores)]
    heapq.heapify(free)
    end = lost = 0.0
    for cost in costs:
        begin, core = heapq.heappop(free)
        # A core is taken away while it works; another one takes the task after five minutes.
        while draw.random() < 1 - (1 - lost_an_hour) ** cost:
            part = draw.random() * cost
            lost += part
            begin += part + 5 / 60
        heapq.heappush(free, (begin + cost, core))
        end = max(end, begin + cost)
    return end, lost


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tasks")
    parser.add_argument("--km", type=float, default=120e6, help="kilometres of directed edges")
    parser.add_argument("--vehicles", type=int, default=35)
    parser.add_argument("--price", type=float, default=0.0162)
    parser.add_argument("--lost", type=float, default=0.05)
    asked = parser.parse_args()
    with open(asked.tasks, newline="", encoding="utf-8") as file:
        measured = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]
    draw = random.Random(1)
    drawn, length = [], 0.0
    while length < asked.km:
        task = draw.choice(measured)
        drawn.append(task)
        length += task["length_km"]
    stages = [sorted((task[stage] * asked.vehicles / 3600 for task in drawn), reverse=True) for stage in ("strokes_s", "turns_s")]
    work = sum(map(sum, stages))
    print(f"{len(drawn):,} tasks, {length / 1e6:.0f} million km, {asked.vehicles} vehicles: {work:,.0f} core hours\n")
    print("| cores | hours | at best | lost to machines taken away | dollars |\n| --- | --- | --- | --- | --- |")
    for cores in (64, 512, 4096):
        parts = [schedule(costs, cores, asked.lost, draw) for costs in stages]
        hours, lost = (sum(part[i] for part in parts) for i in (0, 1))
        print(f"| {cores} | {hours:,.0f} | {work / cores:,.0f} | {lost / work:.1%} | {hours * cores * asked.price:,.0f} |")


if __name__ == "__main__":
    main()
