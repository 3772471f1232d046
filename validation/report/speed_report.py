#!/usr/bin/env python3
"""Makes DIR/report.html of what `kiloband bench -o DIR` wrote: one page that needs no other file.

Usage: speed_report.py DIR    (needs numpy and matplotlib: apt-get install python3-matplotlib)

Reads DIR/bench.json alone. Cases and numbers that are missing are left out: a run that was interrupted has a page too.
"""

import pathlib
import re
import sys

sys.dont_write_bytecode = True  # nothing is left in the source folder

import markup  # noqa: E402
import speed_sections  # noqa: E402
from speed_data import SpeedError, read_bench  # noqa: E402

STYLE = "<style>code { font-size: 12px; overflow-wrap: anywhere; } details table { font-size: 12px; } details code { white-space: nowrap; }</style>"


def gibibytes(value):
    return f"{value / 2**30:.1f} GiB" if markup.is_number(value) else markup.DASH


def device_line(device):
    if not device:
        return "no device"
    tuned = "; ".join(f"{one['method']} at {one['channels']} channels: {one['sizes']}" for one in device.get("tuned") or [])
    return f"{device.get('name')} ({device.get('platform')}, {device.get('driver')})" + (f", tuned ({tuned})" if tuned else "")


def head(results):
    machine = results.get("machine") or {}
    facts = [
        ("program", f"{machine.get('version')}, commit {machine.get('commit') or 'unknown'}"),
        ("processor", f"{machine.get('processor')}, {machine.get('threads')} threads, {machine.get('isa')}"),
        ("memory", gibibytes(machine.get("memory_bytes"))),
        ("OpenCL", device_line(machine.get("opencl") or {})),
        ("run", f"{machine.get('date')}; {'quick' if results.get('quick') else 'full'}, {markup.duration(results.get('seconds'))}"),
        ("load average", f"{markup.number(machine.get('load_average'), 2)} when it began"),
    ]
    rows = "".join(f"<dt>{name}</dt><dd>{markup.text(value)}</dd>" for name, value in facts)
    return f"<h1>Speed of kiloband</h1><dl class=facts>{rows}</dl>" + warnings(results)


def warnings(results):
    text = ""
    if results.get("quick"):
        text += (
            '<div class="verdict open">A quick run: small images, few repetitions. It shows that everything works, and no more than '
            "factors; <code>kiloband bench -o DIR</code> measures.</div>"
        )
    if results.get("interrupted"):
        text += '<div class="verdict open"><b>Interrupted</b> What was measured until then is here.</div>'
    return text


def navigation(body):
    links = re.findall(r'<h2 id="([\w-]+)">([^<]*)</h2>', body)
    return f"<nav>{''.join(f'<a href=#{anchor}>{title}</a>' for anchor, title in links)}</nav>"


def report_html(directory):
    results = read_bench(directory / "bench.json")
    body = "\n".join(make(results) for make in speed_sections.SECTIONS)
    return markup.page("Speed of kiloband", STYLE + head(results) + navigation(body) + body)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    directory = pathlib.Path(sys.argv[1])
    try:
        (directory / "report.html").write_text(report_html(directory), encoding="utf-8")
    except (SpeedError, OSError) as error:
        sys.exit(f"speed_report.py: {error}")


if __name__ == "__main__":
    main()
