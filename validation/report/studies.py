"""Hard cases, convergence, and the comparison with an independent renderer."""

import plots
from markup import duration, group_row, number, percent, plot, probability, row, table, text, verdict_word
from comparisons import in_order
from verdict import on_backend


def _by_name(hard_cases):
    groups = {}
    for hard in hard_cases:
        groups.setdefault(str(hard.get("name")), []).append(hard)
    return groups


def _figure_rows(group, backends):
    """A row per figure: unit, reference, limit, then value and error of each backend."""
    by_backend = {h.get("backend"): {f.get("name"): f for f in h.get("figures") or []} for h in group}
    names = dict.fromkeys(name for figures in by_backend.values() for name in figures)
    rows = []
    for name in names:
        found = [by_backend.get(b, {}).get(name) for b in backends]
        first = next(f for f in found if f)
        note = f"<br><span class=soft>{text(first['note'])}</span>" if first.get("note") else ""
        cells = [
            text(name) + note,
            text(first.get("unit") or ""),
            number(first.get("reference"), 6),
            number(first.get("limit"), 2),
        ]
        for figure in found:
            if figure is None:
                cells.append("–")
                continue
            mark = "" if figure.get("passed") else ' <span class="word bad">FAILED</span>'
            cells.append(
                f"{number(figure.get('value'), 6)}<br><span class=soft>off {number(figure.get('error'), 2)}</span>{mark}"
            )
        rows.append(
            row(cells, range(2, 4 + len(backends)), "" if all(f is None or f.get("passed") for f in found) else "bad")
        )
    return rows


def hard_cases(results):
    entries = results["hard_cases"]
    if not entries:
        return ""
    backends = list(dict.fromkeys(h.get("backend") for h in entries))
    columns = 4 + len(backends)
    rows = []
    groups = sorted(_by_name(entries).items(), key=lambda item: all(h.get("passed") for h in item[1]))
    for name, group in groups:
        word = "" if all(h.get("passed") for h in group) else verdict_word(False)
        rows.append(
            group_row(f'{text(name)} {word}<span class="soft">{text(group[0].get("what") or "")}</span>', columns)
        )
        rows += [
            row([f"{text(h.get('backend'))}: {text(h['error'])}"] + [""] * (columns - 1), (), "bad")
            for h in group
            if h.get("error")
        ]
        rows += _figure_rows(group, backends)
    heads = ["figure", "unit", "reference", "limit"] + [text(b) for b in backends]
    return (
        '<h2 id="hard">Hard cases</h2><p class=soft>Scenes at the ends of what numbers, sizes and path lengths may be, against '
        "closed forms or the double-precision oracle. Grey: what the limit comes from. Per backend: the value, and how far it is "
        "from the reference.</p>"
        + table(heads, rows, range(2, columns))
    )


def _curve_table(study):
    rows = []
    for curve in study.get("curves") or []:
        points = [p for p in curve.get("points") or [] if isinstance(p, dict)]
        last = points[-1] if points else {}
        rows.append(
            row(
                [
                    text(curve.get("configuration")),
                    f"{number(curve.get('slope'))} ± {number(curve.get('slope_error'), 2)}",
                    text(last.get("samples")),
                    percent(last.get("relative_error")),
                    duration(last.get("seconds")),
                    number(last.get("efficiency")),
                ],
                range(1, 6),
            )
        )
    return table(
        ["configuration", "slope", "most samples", "error there", "time there", "1 / (error² · s) there"],
        rows,
        range(1, 6),
    )


def convergence(results):
    if not results["convergence"]:
        return ""
    parts = [
        '<h2 id="convergence">Convergence</h2><p class=soft>Root of the mean over pixels and channels of the relative variance '
        "between independent renders. Independent samples must have the slope −1/2; Sobol points may fall faster. Colour: "
        "backend; dashed: independent samples; triangles: wavelengths per path.</p>"
    ]
    for study in in_order(results["convergence"]):
        parts.append(f"<h3>{verdict_word(study.get('passed'), study.get('interrupted'))} {text(study.get('name'))}</h3>")
        if study.get("note"):
            parts.append(f'<div class="failure">{text(study["note"])}</div>')
        parts.append(plot(plots.convergence_plot(study.get("curves") or []), alt="convergence") + _curve_table(study))
    return "".join(parts)


def _mitsuba_row(scene):
    best = scene.get("detectable") or {}
    return row(
        [
            verdict_word(scene.get("passed")),
            text(scene.get("name")),
            text(scene.get("backend")),
            text(scene.get("what") or scene.get("failure") or ""),
            f"{len(scene.get('channels_nm') or [])}",
            f"{text(scene.get('replicates'))} × {text(scene.get('samples_ours'))}",
            f"{text(scene.get('replicates'))} × {text(scene.get('samples_theirs'))}",
            percent(scene.get("largest_difference")),
            probability(scene.get("p")),
            percent(best.get("typical")),
            percent(best.get("largest")),
        ],
        range(4, 11),
        "" if scene.get("passed") else "bad",
    )


def _versions(record):
    """Of what the independent renderer ran in."""
    parts = [f"{name} {text(record[key])}" for key, name in (("python", "Python"), ("numpy", "numpy")) if record.get(key)]
    return "".join(f", {part}" for part in parts)


def mitsuba(results):
    record, scenes = results["mitsuba"], in_order(results["mitsuba"]["scenes"])
    if not scenes:
        return ""
    heads = [
        "",
        "scene",
        "backend",
        "what",
        "channels",
        "ours: replicates × samples",
        "theirs",
        "largest difference",
        "p",
        "detectable bias",
        "worst channel",
    ]
    parts = [
        f'<h2 id="mitsuba">Against Mitsuba 3</h2><p>Mitsuba {text(record.get("mitsuba"))} ({text(record.get("variant"))}{_versions(record)}): '
        f"means of pixels, tiles and the image by the tests of the suite; all scenes and backends together raise a false "
        f"alarm with probability {number(record.get('rate'))}. {text(record.get('date') or results.get('date'))}, "
        f"{text(record.get('processor') or results.get('processor'))}.</p>"
        + table(heads, [_mitsuba_row(s) for s in scenes], range(4, 11))
    ]
    for scene in scenes:
        if not scene.get("ours"):
            continue
        shown = {
            "a": f"kiloband{on_backend(scene)}",
            "b": "Mitsuba",
            "image_a": scene.get("ours"),
            "image_b": scene.get("theirs"),
            "image_error": scene.get("error"),
        }
        parts.append(f"<h3>{verdict_word(scene.get('passed'))} {text(scene.get('name'))}{on_backend(scene)}</h3>")
        parts.append(
            plot(plots.spectra_plot(scene.get("channels_nm"), shown), text(scene.get("note") or ""), "spectra")
        )
    return "".join(parts)
