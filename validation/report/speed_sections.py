"""The sections of the page of `kiloband bench`: plots, commands beside them, tables of the numbers."""

import markup
import speed_plots
from speed_data import backend_label, distinct, has_value, lines, pick, way_label

COLUMNS = [
    ("scene", "scene"),
    ("channels", "K"),
    ("part", "channels of a path"),
    ("pool", "pool"),
    ("depth", "depth"),
    ("samples", "samples per pixel"),
    ("series", ""),
    ("channel_nm", "nm"),
]


def figure(svg, caption, records, name):
    """A plot with the command that repeats it, and its numbers folded below; nothing where there is no plot."""
    if not svg:
        return ""
    return markup.plot(svg, caption, name) + numbers(records)


def command_of(results, case):
    """The command line that runs a case again."""
    words = ["kiloband bench", case]
    if results.get("quick"):
        words.append("--quick")
    if results.get("seed") is not None:
        words.append(f"--seed {results['seed']}")
    return " ".join(words + ["-o DIR"])


def command(text):
    return f'<p class="soft">Repeats it: <code>{markup.text(text)}</code></p>'


def numbers(records):
    """Folded: every number of a figure, with its command."""
    if not records:
        return ""
    used = [(key, head) for key, head in COLUMNS if any(r.get(key) is not None for r in records)]
    heads = ["", *(head for _, head in used), "quantity", "value", "±", "unit", "of", "note", "command"]
    rows = []
    for r in records:
        cells = [markup.text(way_label(r))] + [cell(r.get(key)) for key, _ in used]
        cells += [markup.text(r.get("quantity")), markup.number(r.get("value"), 4), markup.number(r.get("error"), 2)]
        cells += [markup.text(r.get("unit") or ""), markup.text(r.get("repetitions")), markup.text(r.get("note") or "")]
        rows.append(markup.row(cells + [f"<code>{markup.text(r.get('command') or '')}</code>"]))
    kinds = ", ".join(f"± is the {kind}" for kind in distinct(records, "error_kind"))
    table = markup.table(heads, rows, caption=f"{kinds}; of: how many repetitions" if kinds else "")
    return f"<details><summary>{len(records)} numbers and their commands</summary>{table}</details>"


def cell(value):
    return markup.number(value, 6) if isinstance(value, float) else markup.text("" if value is None else value)


def section(results, case, title, text, body):
    """A case with its heading and command; nothing where it has no figure."""
    failure = next((c.get("failure") for c in results["cases"] if c.get("name") == case), None)
    if failure:
        body = f'<div class="failure">{markup.text(failure)}</div>' + body
    if not body:
        return ""
    load = next((c.get("load_before") for c in results["cases"] if c.get("name") == case), None)
    note = f'<p class="soft">Load average before it: {markup.number(load, 2)}.</p>' if markup.is_number(load) else ""
    return f'<h2 id="{case}">{title}</h2><p>{text}</p>{command(command_of(results, case))}{note}{body}'


def by_scene(records, x, label):
    return {scene: lines(pick(records, scene=scene), x, label) for scene in distinct(records, "scene")}


def channels(results):
    records = pick(results["records"], case="channels")
    body = ""
    for quantity, y_label, reference in (
        ("paths_per_second", "paths per second", None),
        ("frames_per_second", "frames per second", None),
        ("speed_up_over_pt", "paths per second over those of pt", 1),
    ):
        shown = pick(records, quantity=quantity)
        svg = speed_plots.panels(by_scene(shown, "channels", backend_label), "channels K", y_label, reference=reference)
        body += figure(svg, CAPTIONS[quantity], shown, quantity)
    text = (
        "Paths and frames per second against the number of channels (figures 8 and 9 of the DPEPT paper): the three methods of the "
        "OpenCL backend and the CPU. Each point is the median of rounds in which all take turns, the bar half of their range."
    )
    return section(results, "channels", "Speed against the number of channels", text, body)


CAPTIONS = {
    "paths_per_second": "A path is one sample of one pixel, of all K channels. Kernels are compiled and nothing is written.",
    "frames_per_second": "A frame is one sample of every pixel, added to a film that goes on, as the viewer asks for it.",
    "speed_up_over_pt": "What deferring the evaluation gains: above the dashed line it is faster than pt, which carries K throughputs along every path.",
}


def error(results):
    records = pick(results["records"], case="error")
    body = ""
    for scale in ("pixel", "tile", "image"):
        shown = pick(records, quantity="relative_error", series=scale)
        curves = {scene: error_curves(records, scene, scale) for scene in distinct(shown, "scene")}
        svg = speed_plots.panels(curves, "seconds per image", f"relative error of a {scale}")
        reference = pick(records, quantity="reference_error", series=scale)
        body += figure(svg, reference_caption(reference, scale), shown + reference, f"error of a {scale} against time")
    body += efficiencies(records) + channel_errors(records)
    text = (
        "Root mean square of the difference from a reference, over the channel's mean in the image, of all pixels (tiles of 8×8, the image) and "
        "channels; the reference's own variance is taken away. 1/(error² × seconds) is what a second buys: twice as much is half the time to any error."
    )
    return section(results, "error", "Error against time", text, body)


def error_curves(records, scene, scale):
    """{way: [(seconds, error, standard error)]}"""
    seconds = {}
    for r in pick(records, scene=scene, quantity="seconds"):
        seconds[(way_label(r), r.get("samples"))] = r.get("value")
    found = {}
    for r in pick(records, scene=scene, quantity="relative_error", series=scale):
        time = seconds.get((way_label(r), r.get("samples")))
        if has_value(r) and time:
            found.setdefault(way_label(r), []).append((time, r["value"], r.get("error") or 0.0))
    return {way: sorted(points) for way, points in found.items()}


def reference_caption(reference, scale):
    parts = [
        f"{markup.text(r.get('scene'))} {markup.number(r.get('value'), 2)} ({r.get('samples')} samples per pixel, {markup.text(r.get('note'))})"
        for r in reference
    ]
    return f"Relative error of the reference itself, of a {scale}: {'; '.join(parts)}." if parts else ""


def efficiencies(records):
    """The best of each way: the number at its largest number of samples that the reference resolves."""
    body = ""
    shown = [r for r in pick(records, quantity="efficiency", series="pixel") if has_value(r) and not r.get("note")]
    for scene in distinct(shown, "scene"):
        last = {}
        for r in pick(shown, scene=scene):
            if r.get("samples", 0) >= last.get(way_label(r), {}).get("samples", 0):
                last[way_label(r)] = r
        rows = sorted(((way, r["value"], r.get("error") or 0.0) for way, r in last.items()), key=lambda row: -row[1])
        caption = f"{markup.text(scene)}: efficiency of pixels at the largest number of samples that was rendered; bars: one standard error."
        body += figure(speed_plots.bars(rows, "1 / (error² × seconds), 1/s"), caption, list(last.values()), "efficiency")
    return body


def channel_errors(records):
    shown = pick(records, quantity="channel_error", series="pixel")
    most = max((r.get("samples", 0) for r in shown), default=0)
    shown = [r for r in shown if r.get("samples") == most]
    svg = speed_plots.panels(by_scene(shown, "channel_nm", way_label), "wavelength / nm", "relative error of a pixel")
    return figure(svg, f"Error of each channel at {most} samples per pixel.", shown, "error of each channel")


def ratio_label(record):
    return f"CPU {record.get('sampler')} : {record.get('series')}"


def peers(results):
    records = pick(results["records"], case="peers")
    body = missing_peers(records)
    for quantity, y_label, label in (
        ("equal_error_speed", "times sooner at equal error", ratio_label),
        ("path_speed", "paths per second over theirs", ratio_label),
        ("paths_per_second", "paths per second", way_label),
        ("mean_difference", "", None),
    ):
        shown = pick(records, quantity=quantity)
        if label:
            reference = None if quantity == "paths_per_second" else 1
            svg = speed_plots.panels(by_scene(shown, "channels", label), "channels K", y_label, reference=reference)
            body += figure(svg, PEER_CAPTIONS[quantity], shown, quantity)
        elif shown:
            rest = pick(records, quantity="warm_up_seconds") + pick(records, quantity="load_seconds")
            body += f"<h3>Means, warm-up and reading</h3><p>{PEER_CAPTIONS[quantity]}</p>{numbers(shown + rest)}"
    text = (
        "Other renderers on the same scene, channels and machine, in the same run. Equal-error speed is the ratio of 1/(error² × seconds) of "
        "pixels, against one reference; what compiles (a first render) and reading the scene are timed apart and not part of it."
    )
    return section(results, "peers", "Beside other renderers", text, body)


PEER_CAPTIONS = {
    "equal_error_speed": "How many times sooner kiloband's CPU backend reaches an error than the other renderer; bars: one standard error.",
    "path_speed": "Paths per second, whatever they carry: kiloband's have all K channels, Mitsuba's four wavelengths.",
    "paths_per_second": "Mitsuba traces without Embree's flag ROBUST, kiloband with it. Bars: half of the range over rounds.",
    "mean_difference": "Means of the image against the reference come first: an error would contain their difference.",
}


def missing_peers(records):
    gone = [r for r in pick(records, quantity="paths_per_second") if not has_value(r)]
    items = "".join(f"<li>{markup.text(backend_label(r))}: {markup.text(r.get('note'))}</li>" for r in gone)
    return f"<ul>{items}</ul>" if items else ""


SECTIONS = [channels, error, peers]
