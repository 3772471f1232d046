"""All drawings: SVG (or PNG, for maps of pixels) as bytes."""

import functools
import io
import math

import matplotlib

matplotlib.use("Agg")
import matplotlib.image  # noqa: E402
import matplotlib.pyplot as plt  # noqa: E402
import matplotlib.ticker  # noqa: E402
import numpy  # noqa: E402

SIDE_A, SIDE_B, OTHER = "#1f5fa8", "#c2571a", "#b5bcc6"
Z_LIMIT = 6  # standard errors at the ends of the colour scale
COLOURS = ["#1f5fa8", "#c2571a", "#2b8a57", "#8a4f9e", "#9c7a18", "#4aa3b8", "#b33a5e", "#555f6b"]

plt.rcParams.update(
    {
        "font.size": 9,
        "axes.grid": True,
        "grid.alpha": 0.3,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.titlesize": 9.5,
        "axes.titlelocation": "left",
        "legend.fontsize": 8,
        "legend.frameon": False,
        "svg.hashsalt": "kiloband",
        "lines.linewidth": 1.3,
    }
)


def numbers(values):
    """null becomes NaN."""
    return numpy.array([math.nan if v is None else v for v in values or []], float)


def _svg(figure):
    stream = io.BytesIO()
    figure.savefig(stream, format="svg", metadata={"Date": None})
    plt.close(figure)
    return stream.getvalue()


def png(pixels):
    stream = io.BytesIO()
    matplotlib.image.imsave(stream, pixels, format="png")
    return stream.getvalue()


def z_map(t, columns, rows):
    """t of every unit, row by row; blue: A is darker, red: A is brighter, grey: not tested."""
    colours = matplotlib.colormaps["RdBu_r"].with_extremes(bad="#9aa0a6")
    scaled = numpy.ma.masked_invalid(numbers(t).reshape(rows, columns)) / (2 * Z_LIMIT) + 0.5
    return png(colours(scaled))


def z_scale():
    return png(matplotlib.colormaps["RdBu_r"](numpy.linspace(0, 1, 130))[None, :, :])


@functools.lru_cache(maxsize=32)
def _band(count):
    """Order statistics of `count` independent uniform numbers: 2.5 % and 97.5 % quantiles, from 400 draws."""
    draws = numpy.sort(numpy.random.default_rng(1).random((400, count)), axis=1)
    return numpy.quantile(draws, [0.025, 0.975], axis=0)


def _thinned(count, most=160):
    """Indices, dense where p is small."""
    return numpy.unique(numpy.geomspace(1, count, min(count, most)).astype(int)) - 1


def draw_qq(axes, series):
    """series: (p-values, whether it is the one that is shown)."""
    smallest = 1.0
    for values, shown in series:
        p = numpy.sort(numpy.maximum(values, 1e-16))
        keep = _thinned(p.size)
        expected = (keep + 0.5) / p.size
        smallest = min(smallest, expected[0], p[0])
        if shown:
            low, high = _band(p.size)[:, keep]
            axes.fill_between(
                -numpy.log10(expected),
                -numpy.log10(high),
                -numpy.log10(numpy.maximum(low, 1e-16)),
                color="#dfe4ea",
                linewidth=0,
            )
        axes.plot(
            -numpy.log10(expected),
            -numpy.log10(p[keep]),
            color=SIDE_A if shown else OTHER,
            linewidth=1.5 if shown else 0.9,
            marker="." if shown else None,
            markersize=3,
            zorder=3 if shown else 2,
        )
    end = -math.log10(smallest)
    axes.plot([0, end], [0, end], color="#1d2530", linewidth=0.8, linestyle=(0, (4, 3)))
    axes.set(xlabel="expected −log$_{10}$ p", ylabel="found −log$_{10}$ p", title="p-values of the pixels")


def _axis_of(channels_nm):
    """Bounds in the unit to plot, the unit, widths in nm."""
    bounds = numpy.array(channels_nm, float)
    long = bounds.max() > 2500
    return bounds / (1000 if long else 1), "µm" if long else "nm", numpy.maximum(bounds[:, 1] - bounds[:, 0], 1e-300)


def _draw_steps(axes, bounds, values, colour, **style):
    """A level per channel; NaN between channels breaks the line where they leave gaps or overlap."""
    order = numpy.argsort(bounds[:, 0], kind="stable")
    x, y = [], []
    for k in order:
        if x and abs(bounds[k, 0] - x[-1]) > 1e-9 * abs(x[-1]):
            x.append(x[-1])
            y.append(math.nan)
        x += [bounds[k, 0], bounds[k, 1]]
        y += [values[k], values[k]]
    axes.plot(x, y, color=colour, **style)


def _draw_sides(axes, bounds, widths, unit, shown):
    a, b, error = (numbers(shown.get(key)) / widths for key in ("image_a", "image_b", "image_error"))
    for k in range(len(a)):
        if math.isfinite(error[k]) and math.isfinite(b[k]):
            axes.fill_between(
                bounds[k], b[k] - 2 * error[k], b[k] + 2 * error[k], color=SIDE_B, alpha=0.22, linewidth=0
            )
    _draw_steps(axes, bounds, b, SIDE_B, label=f"B: {shown.get('b')}")
    _draw_steps(axes, bounds, a, SIDE_A, label=f"A: {shown.get('a')}", linestyle=(0, (5, 2)))
    finite = numpy.concatenate([a, b])
    finite = finite[numpy.isfinite(finite)]
    if finite.size and finite.min() >= 0:
        axes.set_ylim(0, (1.3 * finite.max()) or 1)
    axes.legend(loc="upper left", ncols=1)
    axes.set(
        title="mean of the image, ± 2 standard errors of the difference",
        ylabel="W m$^{-2}$ sr$^{-1}$ nm$^{-1}$",
        xlabel=f"wavelength / {unit}",
    )


def in_standard_errors(pairing, count):
    """(A - B) / standard error per channel; NaN where there is no error or the lists do not fit."""
    a, b, error = (numbers(pairing.get(key)) for key in ("image_a", "image_b", "image_error"))
    if not a.size == b.size == error.size == count:
        return numpy.full(count, math.nan)
    with numpy.errstate(divide="ignore", invalid="ignore"):
        t = (a - b) / error
    return numpy.where(error > 0, t, math.nan)


def _draw_differences(axes, bounds, unit, shown, others):
    centres = bounds.mean(axis=1)
    order = numpy.argsort(centres, kind="stable")
    for other in others:
        axes.plot(centres[order], in_standard_errors(other, len(bounds))[order], color=OTHER, linewidth=0.8)
    t = in_standard_errors(shown, len(bounds))
    known = numpy.isfinite(t)
    axes.vlines(centres[known], 0, t[known], color=SIDE_A, linewidth=1.2)
    axes.plot(centres, t, "o", color=SIDE_A, markersize=3.2)
    axes.axhspan(-2, 2, color="#dfe4ea", alpha=0.6, linewidth=0, zorder=0)
    axes.axhline(0, color="#1d2530", linewidth=0.8)
    largest = numpy.abs(t[known]).max() if known.any() else 0
    limit = max(4.5, 1.1 * largest)
    axes.set(ylim=(-limit, limit), title="A − B", ylabel="standard errors", xlabel=f"wavelength / {unit}")


def case_plot(channels_nm, shown, others, qq):
    """Spectra, differences and (if qq is not empty) the QQ plot of a case. None without spectra."""
    if not channels_nm or not all(
        len(shown.get(key) or []) == len(channels_nm) for key in ("image_a", "image_b", "image_error")
    ):
        return None
    bounds, unit, widths = _axis_of(channels_nm)
    panels = 3 if qq else 2
    figure, axes = plt.subplots(1, panels, figsize=(11.4, 3.0), width_ratios=[1.5, 1.2, 0.9][:panels])
    figure.subplots_adjust(left=0.055, right=0.995, bottom=0.15, top=0.91, wspace=0.19)
    _draw_sides(axes[0], bounds, widths, unit, shown)
    _draw_differences(axes[1], bounds, unit, shown, others)
    if qq:
        draw_qq(axes[2], qq)
    return _svg(figure)


def spectra_plot(channels_nm, shown):
    return case_plot(channels_nm, shown, [], [])


def _curve_style(label, backends):
    """Colour: backend; line: sampler; marker: wavelength mode."""
    words = label.split(" ")
    return {
        "color": COLOURS[backends.index(words[0]) % len(COLOURS)],
        "linestyle": "-" if "sobol" in words else (0, (4, 2)),
        "marker": "o" if "shared" in words else "^",
    }


def _draw_fit(axes, samples, errors, slope, colour):
    """The fitted line: through the mean of the points' logarithms."""
    x, y = numpy.log(samples), numpy.log(errors)
    axes.plot(samples, numpy.exp(y.mean() + slope * (x - x.mean())), color=colour, linewidth=0.7, alpha=0.7)


def _label_ticks(axes):
    """Errors often span less than a decade: 2 and 5 are labelled too, 3 digits are written out."""
    for axis in (axes.xaxis, axes.yaxis):
        low, high = axis.get_view_interval()
        steps = (1, 2, 5) if high < 30 * low else (1, 3) if high < 1000 * low else (1,)
        axis.set_major_locator(matplotlib.ticker.LogLocator(subs=steps))
        axis.set_major_formatter(
            matplotlib.ticker.FuncFormatter(lambda v, _: f"{v:g}" if 1e-3 <= v < 1e4 else f"{v:.0e}")
        )
        axis.set_minor_formatter(matplotlib.ticker.NullFormatter())


def convergence_plot(curves):
    """curves as in results.json. None if none has a point that can be drawn."""
    labels = [str(c.get("configuration")) for c in curves]
    backends = sorted({label.split(" ")[0] for label in labels})
    height = 3.2 + 0.19 * math.ceil(len(curves) / 4)
    figure, (by_samples, by_seconds, gain) = plt.subplots(1, 3, figsize=(11.4, height))
    drawn = 0
    for curve, label in zip(curves, labels):
        columns = [
            numbers([p.get(key) for p in curve.get("points") or []])
            for key in ("samples", "relative_error", "seconds", "efficiency")
        ]
        if not columns[0].size:
            continue
        good = numpy.all([numpy.isfinite(c) & (c > 0) for c in columns], axis=0)
        samples, errors, seconds, efficiency = (c[good] for c in columns)
        if not samples.size:
            continue
        drawn += 1
        style = _curve_style(label, backends) | {"markersize": 3.5, "linewidth": 1.1}
        by_samples.plot(samples, errors, **(style | {"linestyle": ""}))
        if isinstance(curve.get("slope"), (int, float)) and samples.size > 1:
            _draw_fit(by_samples, samples, errors, curve["slope"], style["color"])
        by_seconds.plot(seconds, errors, label=label, **style)
        gain.plot(samples, efficiency, **style)
    for axes in (by_samples, by_seconds, gain):
        axes.set(xscale="log", yscale="log")
        _label_ticks(axes)
    by_samples.set(xlabel="samples per pixel", ylabel="relative error (rms)", title="error and fitted slopes")
    by_seconds.set(xlabel="seconds per image", ylabel="relative error (rms)", title="error against time")
    gain.set(xlabel="samples per pixel", ylabel="1 / (error² · s)", title="efficiency")
    if drawn:
        figure.tight_layout(rect=(0, 1 - 3.15 / height, 1, 1))
        figure.legend(*by_seconds.get_legend_handles_labels(), loc="lower center", ncols=4)
        return _svg(figure)
    plt.close(figure)
    return None
