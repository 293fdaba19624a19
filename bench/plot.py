#!/usr/bin/env python3
"""Draws what `hemiray bench --json FILE`, `hemiray stability --json FILE` or `factor_growth --json FILE` wrote.
Usage: plot.py FILE FOLDER

Into FOLDER, each as .png and .svg: rates (Mrays/s of every tracer, a panel for each scene and size), builds (ms of every
tree), and, where a scene was measured at several sizes, growth (both against the number of triangles). Of a ladder:
tunnelling (share of rays that pass the next surface, against the gap to it). Of form factors: factors (time and memory
against the number of patches)."""
import json
import os
import sys

import matplotlib

matplotlib.use("Agg")
matplotlib.rcParams["svg.hashsalt"] = "hemiray"  # the same file from the same figures
import matplotlib.pyplot as plt  # noqa: E402

OURS = "#1b6ca8"
THEIRS = "#9a9a9a"
INVALID = "#c0392b"


def colour(name, valid=True):
    if not valid:
        return INVALID
    return OURS if name.startswith("device/") else THEIRS


def title(scene):
    return f"{os.path.basename(scene['scene'])}, {scene['triangles']:,} triangles"


def unique(items):
    return list(dict.fromkeys(items))


def save(figure, folder, name):
    figure.tight_layout()
    for ending, about in (("png", None), ("svg", {"Date": None})):
        figure.savefig(os.path.join(folder, f"{name}.{ending}"), dpi=120, metadata=about)
    plt.close(figure)


def bars(axis, labels, spreads, colours, unit):
    """Horizontal bars of the medians, the first on top, with whiskers from least to most."""
    medians = [s["median"] for s in spreads]
    errors = [[s["median"] - s["least"] for s in spreads], [s["most"] - s["median"] for s in spreads]]
    places = range(len(labels))
    axis.barh(places, medians, xerr=errors, color=colours, error_kw={"elinewidth": 0.8, "ecolor": "#333333"})
    axis.set_yticks(list(places))
    axis.set_yticklabels(labels, fontsize=7)
    axis.invert_yaxis()
    axis.set_xlabel(unit, fontsize=8)
    axis.tick_params(axis="x", labelsize=7)


def rate_spread(trace):
    """The spread of a rate [Mrays/s]: the least time is the most rate."""
    rate = {key: trace["ray_count"] / (ms * 1e3) for key, ms in trace["ms"].items() if key != "runs"}
    return {"median": rate["median"], "least": rate["most"], "most": rate["least"]}


def draw_rates(scenes, folder):
    sets = unique(t["rays"] for scene in scenes for t in scene["traces"])
    most = max(sum(t["rays"] == s for t in scene["traces"]) for scene in scenes for s in sets)
    height = 0.8 + 0.2 * most
    figure, axes = plt.subplots(len(scenes), len(sets), figsize=(4.2 * len(sets), height * len(scenes)), squeeze=False)
    for row, scene in enumerate(scenes):
        for column, name in enumerate(sets):
            traces = [t for t in scene["traces"] if t["rays"] == name]
            colours = [colour(t["tracer"], t["valid"]) for t in traces]
            axis = axes[row][column]
            bars(axis, [t["tracer"] for t in traces], [rate_spread(t) for t in traces], colours, "Mrays/s")
            axis.set_title(f"{name}: {title(scene)}", fontsize=8)
    save(figure, folder, "rates")


def draw_builds(scenes, folder):
    height = 0.8 + 0.25 * max(len(scene["builds"]) for scene in scenes)
    figure, axes = plt.subplots(len(scenes), 1, figsize=(6.5, height * len(scenes)), squeeze=False)
    for axis, scene in zip(axes[:, 0], scenes):
        names = [b["tree"] for b in scene["builds"]]
        bars(axis, names, [b["ms"] for b in scene["builds"]], [colour(name) for name in names], "ms")
        axis.set_title(f"build: {title(scene)}", fontsize=8)
    save(figure, folder, "builds")


def draw_growth(scenes, folder):
    names = [name for name in unique(s["scene"] for s in scenes) if sum(s["scene"] == name for s in scenes) > 1]
    if not names:
        return
    figure, axes = plt.subplots(len(names), 2, figsize=(11, 4 * len(names)), squeeze=False)
    for row, name in enumerate(names):
        of_name = sorted((s for s in scenes if s["scene"] == name), key=lambda s: s["triangles"])
        build, trace = axes[row]
        for tree in unique(b["tree"] for s in of_name for b in s["builds"]):
            points = [(s["triangles"], b["ms"]["median"]) for s in of_name for b in s["builds"] if b["tree"] == tree]
            build.loglog(*zip(*points), marker="o", markersize=3, label=tree)
        for tracer in unique(t["tracer"] for s in of_name for t in s["traces"] if t["rays"] == "diffuse"):
            points = [
                (s["triangles"], 1e3 / t["mrays_per_s"])
                for s in of_name
                for t in s["traces"]
                if t["rays"] == "diffuse" and t["tracer"] == tracer
            ]
            trace.semilogx(*zip(*points), marker="o", markersize=3, label=tracer)
        for axis, what, unit in ((build, "build", "ms"), (trace, "diffuse rays", "ns a ray")):
            axis.set_title(f"{os.path.basename(name)}: {what}", fontsize=9)
            axis.set_xlabel("triangles")
            axis.set_ylabel(unit)
            axis.grid(True, which="major", linewidth=0.3)
            axis.legend(fontsize=6)
    save(figure, folder, "growth")


def draw_tunnelling(cases, folder):
    """Of the cases named "gap...", whose rungs are named by the gap. A hollow mark: none of the rays, whose rate is less
    than the mark's with 95 % confidence."""
    gaps = [case for case in cases if case["case"].startswith("gap")]
    if not gaps:
        return
    figure, axis = plt.subplots(figsize=(7, 4.2))
    for case, tint in zip(gaps, (OURS, INVALID, THEIRS)):
        rungs = sorted(case["rungs"], key=lambda rung: float(rung["rung"]))
        seen = [(float(r["rung"]), r["tunnelled"]) for r in rungs if r["tunnelled"] > 0]
        none = [(float(r["rung"]), r["upper_95"]["tunnelled"]) for r in rungs if r["tunnelled"] == 0]
        if seen:
            label = f"{case['case']}: tunnelled, of {max(r['rays'] for r in rungs):,} rays"
            axis.loglog(*zip(*seen), marker="o", markersize=4, color=tint, label=label)
        if none:
            label = f"{case['case']}: none, 95 % bound"
            axis.loglog(*zip(*none), marker="v", markersize=5, color=tint, markerfacecolor="none", linestyle="", label=label)
    axis.set_xlabel("gap [distance from the origin]")
    axis.set_ylabel("share of rays that pass the next surface")
    axis.grid(True, which="major", linewidth=0.3)
    axis.legend(fontsize=7)
    save(figure, folder, "tunnelling")


def draw_factors(runs, folder):
    figure, axes = plt.subplots(1, 2, figsize=(10, 4))
    time, memory = axes
    for method, tint in zip(unique(run["method"] for run in runs), (OURS, INVALID, THEIRS)):
        of_method = sorted((run for run in runs if run["method"] == method), key=lambda run: run["patches"])
        patches = [run["patches"] for run in of_method]
        for axis, key, unit, style, label in (
            (time, "factors_ms", 1e3, "-", "form factors"),
            (time, "solve_ms", 1e3, ":", "solution"),
            (memory, "factor_bytes", 2**30, "-", "used"),
            (memory, "factor_bytes_predicted", 2**30, ":", "predicted, at most"),
        ):
            values = [run[key] / unit for run in of_method]
            axis.loglog(patches, values, style, marker="o", markersize=3, color=tint, label=f"{method}: {label}")
    for axis, unit in ((time, "s"), (memory, "GiB")):
        axis.set_xlabel("patches")
        axis.set_ylabel(unit)
        axis.grid(True, which="major", linewidth=0.3)
        axis.legend(fontsize=7)
    save(figure, folder, "factors")


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    with open(sys.argv[1], encoding="utf-8") as file:
        report = json.load(file)
    if "cases" in report:
        draw_tunnelling(report["cases"], sys.argv[2])
    elif "factors" in report:
        draw_factors(report["factors"], sys.argv[2])
    elif report["scenes"]:
        draw_rates(report["scenes"], sys.argv[2])
        draw_builds(report["scenes"], sys.argv[2])
        draw_growth(report["scenes"], sys.argv[2])


if __name__ == "__main__":
    main()
