#!/usr/bin/env python3
"""Draws time and memory of blocks on boxes over their unknowns, from the table in README.md, as sizes.svg beside it."""

import math
import re
from pathlib import Path

HERE = Path(__file__).parent
WIDTH, HEIGHT, LEFT, TOP = 340, 300, 62, 46
UNKNOWNS = (7e3, 1.6e6)
COLOURS = ("#1f5fa8", "#c4551c")


def rows():
    """Unknowns, seconds of the first and the second step, and the peak of memory in GB."""
    text = (HERE / "README.md").read_text()
    table = text.split("| elements | unknowns | set-up, s | first step, s |")[1].split("\n\n")[0]
    for line in table.splitlines()[2:]:
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        yield tuple(float(re.sub(r"\s", "", cells[column])) for column in (1, 3, 4, 6))


def power(points):
    """Least squares slope of logarithms."""
    x, y = ([math.log(point[side]) for point in points] for side in (0, 1))
    centre = [sum(values) / len(points) for values in (x, y)]
    products = sum((a - centre[0]) * (b - centre[1]) for a, b in zip(x, y))
    return products / sum((a - centre[0]) ** 2 for a in x)


class Panel:
    """Two logarithmic axes at a place of the picture."""

    def __init__(self, left, title, unit, limits):
        self.left, self.limits = left, limits
        self.parts = [text(left, TOP - 22, f"{title}, {unit}", weight=600)]
        low, high = (math.ceil(math.log10(UNKNOWNS[0])), math.floor(math.log10(UNKNOWNS[1])))
        for exponent in range(low, high + 1):
            x = self.at(10**exponent, limits[0])[0]
            self.parts.append(rule(x, TOP, x, TOP + HEIGHT))
            label = f'10<tspan dy="-5" font-size="9">{exponent}</tspan>'
            self.parts.append(text(x, TOP + HEIGHT + 18, label, anchor="middle"))
        for exponent in range(math.ceil(math.log10(limits[0])), math.floor(math.log10(limits[1])) + 1):
            y = self.at(UNKNOWNS[0], 10**exponent)[1]
            self.parts.append(rule(left, y, left + WIDTH, y))
            self.parts.append(text(left - 7, y + 4, f"{10**exponent:g}", anchor="end"))
        self.parts.append(text(left + WIDTH / 2, TOP + HEIGHT + 38, "unknowns", anchor="middle"))
        frame = f'<rect x="{left}" y="{TOP}" width="{WIDTH}" height="{HEIGHT}" fill="none" stroke="#888"/>'
        self.parts.append(frame)

    def at(self, unknowns, value):
        part = [
            math.log(one / low) / math.log(high / low)
            for one, (low, high) in ((unknowns, UNKNOWNS), (value, self.limits))
        ]
        return self.left + WIDTH * part[0], TOP + HEIGHT * (1 - part[1])

    def linear(self, points):
        """The line of the power one through the last point."""
        (n, value), first = points[-1], points[0][0]
        (x0, y0), (x1, y1) = self.at(first, value * first / n), self.at(n, value)
        self.parts.append(rule(x0, y0, x1, y1, "#999", 'stroke-dasharray="3 4"'))

    def curve(self, points, name, colour, below):
        places = [self.at(*point) for point in points]
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in places)
        self.parts.append(f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="2"/>')
        self.parts += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.5" fill="{colour}"/>' for x, y in places]
        label = f"{name}: power {power(points):.2f}"
        (x, y), shift = places[1], 24 if below else -14
        anchor = "start" if below else "end"
        self.parts.append(text(x, y + shift, label, anchor, colour=colour))


def text(x, y, words, anchor="start", colour="#333", weight=400):
    return (
        f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="{colour}" '
        f'font-weight="{weight}">{words}</text>'
    )


def rule(x0, y0, x1, y1, colour="#e2e2e2", more=""):
    return f'<line x1="{x0:.1f}" y1="{y0:.1f}" x2="{x1:.1f}" y2="{y1:.1f}" stroke="{colour}" {more}/>'


def main():
    table = list(rows())
    time = Panel(LEFT, "A viscous step", "s", (0.015, 30))
    memory = Panel(2 * LEFT + WIDTH, "Peak of memory", "GB", (0.03, 6))
    first, second, peak = ([(row[0], row[side]) for row in table] for side in (1, 2, 3))
    time.linear(first)
    time.curve(first, "first step", COLOURS[0], below=False)
    time.curve(second, "second step", COLOURS[1], below=True)
    memory.linear(peak)
    memory.curve(peak, "whole process", COLOURS[0], below=True)
    width, height = 2 * (LEFT + WIDTH) + 20, TOP + HEIGHT + 56
    parts = "\n".join(time.parts + memory.parts)
    (HERE / "sizes.svg").write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
        f'viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="13">\n'
        f'<rect width="{width}" height="{height}" fill="#fff"/>\n{parts}\n</svg>\n'
    )


if __name__ == "__main__":
    main()
