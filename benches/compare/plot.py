#!/usr/bin/env python3
"""Draws cost against size, from the lines that `scale triangles` and `scale curve` print, as SVG.

    target/release/scale triangles > size.jsonl; target/release/scale curve >> size.jsonl
    python plot.py size.jsonl ../../docs/images/cost-against-size.svg
"""
import json
import math
import sys

WIDTH, HEIGHT, MARGIN = 420, 320, 56
PANELS = [("triangles", "triangles", "triangles of the body (the cut stays the same)"),
          ("curve", "curve_vertices", "vertices of the curve (the meshes stay as large)")]


def slope(points):
    """By least squares, in logarithms."""
    xs, ys = zip(*((math.log(x), math.log(y)) for x, y in points))
    x0, y0 = sum(xs) / len(xs), sum(ys) / len(ys)
    return sum((x - x0) * (y - y0) for x, y in zip(xs, ys)) / sum((x - x0) ** 2 for x in xs)


def panel(points, left, label):
    """One diagram, with both axes logarithmic."""
    decades = [range(math.floor(math.log10(min(values))), math.ceil(math.log10(max(values))) + 1) for values in zip(*points)]

    def place(point):
        shares = [(math.log10(value) - axis[0]) / (axis[-1] - axis[0]) for value, axis in zip(point, decades)]
        return left + MARGIN + shares[0] * (WIDTH - MARGIN - 16), HEIGHT - MARGIN - shares[1] * (HEIGHT - MARGIN - 40)

    lines = []
    for power in decades[0]:
        x, bottom = place((10.0 ** power, 10.0 ** decades[1][0]))
        lines.append(f'<path d="M{x:.1f} {bottom:.1f}V40" stroke="#ddd"/><text x="{x:.1f}" y="{bottom + 16:.1f}" text-anchor="middle">10<tspan dy="-4" font-size="8">{power}</tspan></text>')
    for power in decades[1]:
        x, y = place((10.0 ** decades[0][0], 10.0 ** power))
        lines.append(f'<path d="M{x:.1f} {y:.1f}H{left + WIDTH - 16}" stroke="#ddd"/><text x="{x - 6:.1f}" y="{y + 4:.1f}" text-anchor="end">{10.0 ** (power + 3):g} ms</text>')
    path = "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in map(place, points))
    lines.append(f'<path d="{path}" fill="none" stroke="#1f6fb4" stroke-width="2"/>')
    lines += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.5" fill="#1f6fb4"/>' for x, y in map(place, points)]
    last = slope(points[-4:])
    lines.append(f'<text x="{left + WIDTH / 2}" y="{HEIGHT - 14}" text-anchor="middle">{label}</text>')
    lines.append(f'<text x="{left + WIDTH / 2}" y="24" text-anchor="middle">slope of the last four points {last:.2f}</text>')
    return lines


def main():
    source, target = sys.argv[1:3]
    with open(source) as file:
        runs = [json.loads(line) for line in file]
    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{2 * WIDTH}" height="{HEIGHT}" font-family="sans-serif" font-size="11">',
             f'<rect width="{2 * WIDTH}" height="{HEIGHT}" fill="white"/>']
    for place, (series, size, label) in enumerate(PANELS):
        points = [(run[size], run["median"]) for run in runs if run["series"] == series]
        lines += panel(points, place * WIDTH, label)
    with open(target, "w") as file:
        file.write("\n".join(lines + ["</svg>"]) + "\n")


if __name__ == "__main__":
    main()
