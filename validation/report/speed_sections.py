"""The sections of the page of `kiloband bench`: plots, commands beside them, tables of the numbers."""

import markup
import speed_plots
from speed_data import backend_label, distinct, has_value, lines, pick, ratio_label, way_label

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


def case_field(results, case, field):
    return next((c.get(field) for c in results["cases"] if c.get("name") == case), None)


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
    failure = case_field(results, case, "failure")
    if failure:
        body = f'<div class="failure">{markup.text(failure)}</div>' + body
    if not body:
        return ""
    load = case_field(results, case, "load_before")
    note = f'<p class="soft">Load average before it: {markup.number(load, 2)}.</p>' if markup.is_number(load) else ""
    return f'<h2 id="{case}">{title}</h2><p>{text}</p>{command(case_field(results, case, "command"))}{note}{body}'


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
    svg = speed_plots.panels(by_scene(shown, "channel_nm", way_label), "wavelength / nm", "relative error of a pixel", x_scale="linear")
    return figure(svg, f"Error of each channel at {most} samples per pixel.", shown, "error of each channel")


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
    "path_speed": "Paths per second, whatever they carry: kiloband's and Raysect's have all K channels, Mitsuba's four wavelengths.",
    "paths_per_second": "Mitsuba traces without Embree's flag ROBUST, kiloband with it. Bars: half of the range over rounds.",
    "mean_difference": "Means of the image against the reference come first: an error would contain their difference.",
}


def missing_peers(records):
    gone = [r for r in pick(records, quantity="paths_per_second") if not has_value(r)]
    items = "".join(f"<li>{markup.text(missing_label(r))}: {markup.text(r.get('note'))}</li>" for r in gone)
    return f"<ul>{items}</ul>" if items else ""


def missing_label(record):
    return ", ".join(filter(None, (backend_label(record), record.get("scene"))))


def pool(results):
    records = pick(results["records"], case="pool")
    body = ""
    for quantity, y_label in (
        ("paths_per_second", "paths per second"),
        ("paths_in_flight", "paths that the pool has room for"),
        ("device_memory", "device memory / byte"),
    ):
        shown = pick(records, quantity=quantity)
        titles = {f"K = {k}": lines(pick(shown, channels=k), "pool", backend_label) for k in distinct(shown, "channels")}
        body += figure(speed_plots.panels(titles, "paths of the pool, asked for", y_label), POOL_CAPTIONS[quantity], shown, quantity)
    text = (
        "The pool of the OpenCL backend, 256² to 2048² paths. pt keeps two numbers per channel for every path of the pool; where that does not fit into "
        "the memory that the device may use (<code>--device-memory</code>, 4GiB is the paper's card) the pool becomes smaller, or the image is rendered in groups of pixels."
    )
    return section(results, "pool", "Sizes of the pool", text, body)


POOL_CAPTIONS = {
    "paths_per_second": "Medians of rounds.",
    "paths_in_flight": "Below the diagonal: not all of the pool that was asked for had room, or the image had no more paths to give it.",
    "device_memory": "The most that was allocated on the device: pool, film, scene, spectra.",
}


def memory(results):
    records = pick(results["records"], case="memory")
    body = ""
    for series, x, x_label in (("channels", "channels", "channels K"), ("depth", "depth", "longest path (--max-depth)")):
        measured = pick(records, series=series, quantity="device_memory")
        formula = pick(records, series=series, quantity="formula_of_paths")
        resident = pick(records, series=series, quantity="resident_memory")
        titles = {
            "on the device, measured": lines(measured, x, backend_label),
            "paths of the pool, by formula": lines(formula, x, backend_label),
            "CPU: resident memory of a process": lines(resident, x, backend_label),
        }
        svg = speed_plots.panels(titles, x_label, "byte", columns=3)
        body += figure(svg, MEMORY_CAPTIONS[series], measured + formula + resident, f"memory against {series}")
    text = "Memory against K and depth (figures 4 and 7 of the DPEPT paper). What is measured has the film, the scene and its spectra in it, the formula only the paths."
    return section(results, "memory", "Memory", text, body)


MEMORY_CAPTIONS = {
    "channels": "At depth 6: what pt keeps of a path grows with K, what dpept keeps does not.",
    "depth": "At 64 channels: what dpept keeps grows with the vertices of a path; the formula counts longest paths in flight, the backend has room for all paths of a round, of the length that it meets.",
}


def refraction(results):
    records = pick(results["records"], case="refraction")
    body = ""
    shown = pick(records, quantity="relative_error")
    titles = {f"error of a {scale}": lines(pick(shown, series=scale), "samples", dispersion_label) for scale in ("pixel", "tile")}
    body += figure(speed_plots.panels(titles, "samples per pixel", "relative error"), "", shown, "error against samples")
    gain = pick(records, quantity="efficiency", series="pixel")
    svg = speed_plots.panels({"pixels": lines(gain, "samples", dispersion_label)}, "samples per pixel", "1 / (error² × seconds), 1/s")
    body += figure(svg, "What a second buys: spectral MIS takes more time per path.", gain, "efficiency")
    channel = pick(records, quantity="channel_error", series="pixel")
    most = max((r.get("samples", 0) for r in channel), default=0)
    channel = [r for r in channel if r.get("samples") == most]
    svg = speed_plots.panels({f"{most} samples per pixel": lines(channel, "channel_nm", dispersion_label)}, "wavelength / nm", "relative error of a pixel", x_scale="linear")
    body += figure(svg, "Error of each channel.", channel, "error of each channel")
    text = "A ball of rough flint glass at 64 wavelengths: where a path goes on with one of its channels (degrade, figure 3 of the DPEPT paper) and where it keeps all (spectral MIS)."
    return section(results, "refraction", "Refraction", text, body)


def dispersion_label(record):
    return {"mis": "spectral MIS", "degrade": "degradation"}.get(record.get("dispersion"), "")


def split(results):
    records = pick(results["records"], case="split")
    shown = pick(records, quantity="efficiency", series="pixel")
    body = best_splits(pick(records, quantity="gain_of_best_split"))
    svg = speed_plots.panels(by_scene(shown, "part", channels_label), "channels that a path carries", "1 / (error² × seconds), 1/s")
    body += figure(svg, "The rightmost point of each curve is no split. Bars: one standard error.", shown, "efficiency of splits")
    text = (
        "Should a path carry all channels? K channels are rendered in ranges of neighbours, each by paths of its own, as many paths in all: "
        "1/(error² × seconds) of pixels against how many channels a path carries."
    )
    return section(results, "split", "Paths that carry a part of the channels", text, body)


def channels_label(record):
    return f"K = {record.get('channels')}"


def best_splits(records):
    rows = [
        markup.row(
            [markup.text(r.get("scene")), markup.text(r.get("channels")), markup.text(r.get("part")), markup.number(r.get("value"), 3), markup.number(r.get("error"), 2)],
            numeric=(1, 2, 3, 4),
        )
        for r in records
    ]
    return markup.table(["scene", "K", "best: channels of a path", "efficiency over no split", "± standard error"], rows, numeric=(1, 2, 3, 4))


def stages(results):
    records = pick(results["records"], case="stages")
    shown = pick(records, quantity="time_per_path")
    body = ""
    for scene in distinct(shown, "scene"):
        for backend, caption in STAGE_CAPTIONS.items():
            own = pick(shown, scene=scene, backend=backend)
            titles = {f"{scene}, {name}": stage_lines(pick_backend(own, name)) for name in distinct_backends(own)}
            svg = speed_plots.panels(titles, "channels K", "ns per path", columns=3)
            body += figure(svg, caption, own, f"time by stage, {backend}")
    fractions = [r for r in records if str(r.get("quantity")).startswith("fraction_of")]
    limits = [r for r in records if r not in fractions and r not in shown]
    if fractions:
        svg = speed_plots.panels(by_scene(fractions, "channels", fraction_label), "channels K", "part of the limit", reference=1)
        body += figure(svg, FRACTIONS, fractions + limits, "part of the limit that is attained")
    text = "Time by stage, and what part of its limit a stage attains."
    return section(results, "stages", "Stages and their limits", text, body)


STAGE_CAPTIONS = {
    "cpu": "One thread. A stage takes the difference to the one before: rays, shading, evaluation with the film.",
    "opencl": "All of the device, by profiling events; small kernels (film, rows of spectra, pool) are added up.",
}
EVALUATION = ("pt_update", "dpept_path", "dpept_batch")
SMALL = ("film_clear", "film_finish", "resample_rows", "reset_pool", "compact")


def stage_lines(records):
    """Kernels that do the same job in every method have one name; the small ones of a K are one point."""
    found, small = {}, {}
    for label, points in lines(records, "channels", lambda r: r.get("series")).items():
        if label in SMALL:
            for k, value, _ in points:
                small[k] = small.get(k, 0) + value
        else:
            found["evaluation" if label in EVALUATION else label] = points
    if small:
        found["small kernels"] = [(k, value, 0.0) for k, value in sorted(small.items())]
    return found


FRACTIONS = (
    "CPU: the time of bare Embree packets with the same rays over that of path generation, and of the whole render; the operations of evaluation alone "
    "against multiply-adds in the registers of one thread. OpenCL's evaluation: pt's bytes against a triad's bandwidth over as many bytes as the pool's "
    "state, dpept's operations against multiply-adds in registers."
)


def fraction_label(record):
    return f"{backend_label(record)}: {record.get('series')}, {str(record.get('quantity')).replace('_', ' ')}"


def distinct_backends(records):
    return list(dict.fromkeys(backend_label(r) for r in records))


def pick_backend(records, label):
    return [r for r in records if backend_label(r) == label]


SECTIONS = [channels, pool, memory, refraction, error, stages, peers, split]
