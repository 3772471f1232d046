"""Drawings of speed: curves with error bars on logarithmic axes, a panel for each scene."""

import functools
import math

import matplotlib.pyplot as plt
from matplotlib import ticker
from plots import _svg as svg

# Okabe and Ito: told apart with every common kind of colour blindness; black is for what is compared with.
COLOURS = {
    "CPU": "#0072b2",
    "OpenCL dpept-batch": "#d55e00",
    "OpenCL dpept-path": "#009e73",
    "OpenCL pt": "#cc79a7",
    "Mitsuba": "#1d2530",
    "Raysect": "#7a7f87",
}
OTHERS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#1d2530", "#7a7f87", "#a6761d"]
MARKERS = "os^Dv<>P*"


def tick_text(value, _=None):
    """Two digits suffice where ticks stand at 1, 1.5, 2, 3, 5, 7."""
    if value <= 0:
        return ""
    exponent = math.floor(math.log10(value) + 1e-9)
    if -3 <= exponent < 4:
        return f"{value:g}"
    mantissa = f"{value / 10**exponent:.2g}"
    power = f"10^{{{exponent}}}"
    return f"${power}$" if mantissa == "1" else rf"${mantissa}\cdot{power}$"


def label_ticks(axis):
    """A logarithmic axis of which at least two ticks, and not many, have numbers."""
    low, high = axis.get_view_interval()
    if high < 2.5 * low:  # widened about its middle
        low, high = math.sqrt(low * high) / 1.6, math.sqrt(low * high) * 1.6
        axis.axes.set(**{f"{axis.axis_name}lim": (low, high)})
    steps = (1, 1.5, 2, 3, 5, 7) if high < 6 * low else (1, 2, 5) if high < 50 * low else (1, 3) if high < 3000 * low else (1,)
    axis.set_major_locator(ticker.LogLocator(subs=steps, numticks=20))
    axis.set_major_formatter(ticker.FuncFormatter(tick_text))
    axis.set_minor_locator(ticker.LogLocator(subs=range(1, 10), numticks=20))
    axis.set_minor_formatter(ticker.NullFormatter())


@functools.lru_cache(maxsize=256)
def style_of(label, place):
    """Colour by backend (of a ratio, by what it is over), or by place where the label names none; dashes: independent numbers; marker: by place."""
    known = next((colour for name, colour in COLOURS.items() if label.split(" : ")[-1].startswith(name)), None)
    dashed = "independent" in label or "scalar" in label
    return {
        "color": known or OTHERS[place % len(OTHERS)],
        "linestyle": (0, (4, 2)) if dashed else (0, (1, 1.2)) if "replicates" in label else "-",
        "marker": MARKERS[place % len(MARKERS)],
        "markerfacecolor": "white" if "per-path" in label else None,
    }


def draw_lines(axes, found, labels):
    """found: {label: [(x, value, error)]}. Lower ends of error bars stay above 0."""
    for label, points in found.items():
        style = {k: v for k, v in style_of(label, labels.index(label)).items() if v is not None}
        x, y, error = zip(*points)
        low = [min(e, 0.9 * v) for v, e in zip(y, error)]
        axes.errorbar(x, y, yerr=(low, error), label=label, markersize=4, linewidth=1.2, elinewidth=0.9, capsize=2, **style)


def panels(found_by_title, x_label, y_label, columns=2, reference=None, x_scale="log"):
    """One panel for each title: {title: {label: points}}; all with the same axes' names. None without a point.

    reference: a horizontal line at this value
    """
    found_by_title = {title: found for title, found in found_by_title.items() if found}
    if not found_by_title:
        return None
    columns = min(columns, len(found_by_title))
    rows = math.ceil(len(found_by_title) / columns)
    labels = list(dict.fromkeys(label for found in found_by_title.values() for label in found))
    width = 11.4 if columns > 1 else 7.4
    across = max(1, min(4, int(width / (0.6 + 0.068 * max(map(len, labels))))))
    legend = 0.2 * math.ceil(len(labels) / across) + 0.15
    height = 3.1 * rows + legend
    figure, grid = plt.subplots(rows, columns, figsize=(width, height), squeeze=False)
    for axes, (title, found) in zip(grid.flat, found_by_title.items()):
        draw_lines(axes, found, labels)
        if reference is not None:
            axes.axhline(reference, color="#1d2530", linewidth=0.9, linestyle=(0, (5, 3)), zorder=1)
        axes.set(xscale=x_scale, yscale="log", title=title, xlabel=x_label, ylabel=y_label)
        if x_scale == "log":
            label_ticks(axes.xaxis)
        label_ticks(axes.yaxis)
    for axes in list(grid.flat)[len(found_by_title) :]:
        axes.set_visible(False)
    figure.tight_layout(rect=(0, legend / height, 1, 1))
    handles = {}
    for axes in grid.flat:
        for handle, label in zip(*axes.get_legend_handles_labels()):
            handles.setdefault(label, handle)
    figure.legend(handles.values(), handles.keys(), loc="lower center", ncols=across)
    return svg(figure)


def bars(rows, x_label):
    """rows: [(name, value, error)], drawn from above; a logarithmic axis. None without a row."""
    rows = [row for row in rows if row[1] > 0]
    if not rows:
        return None
    figure, axes = plt.subplots(figsize=(8.6, 0.9 + 0.27 * len(rows)))
    names, values, errors = zip(*rows[::-1])
    colours = [style_of(name, place)["color"] for place, name in enumerate(names)]
    low = [min(e, 0.9 * v) for v, e in zip(values, errors)]
    axes.errorbar(values, range(len(rows)), xerr=(low, errors), fmt="none", ecolor="#5d6977", capsize=2.5, elinewidth=1)
    axes.scatter(values, range(len(rows)), color=colours, zorder=3, s=26)
    axes.set(xscale="log", xlabel=x_label, ylim=(-0.7, len(rows) - 0.3))
    axes.set_yticks(range(len(rows)), names)
    label_ticks(axes.xaxis)
    figure.tight_layout()
    return svg(figure)
