"""The records of bench.json: which of them belong together."""

import json
import math


class SpeedError(Exception):
    """The results cannot be read; the message says why."""


def read_bench(file):
    try:
        results = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise SpeedError(f"{file}: {error}") from error
    if not isinstance(results, dict) or not str(results.get("format", "")).startswith("kiloband bench"):
        raise SpeedError(f"{file}: not the results of kiloband bench")
    for section in ("cases", "records"):
        results[section] = [entry for entry in results.get(section) or [] if isinstance(entry, dict)]
    return results


def pick(records, **wanted):
    """Those whose fields have these values; a field that a record does not have is None."""
    return [r for r in records if all(r.get(key) == value for key, value in wanted.items())]


def distinct(records, field):
    """The values of a field, in the order in which they appear."""
    return list(dict.fromkeys(r[field] for r in records if r.get(field) is not None))


def has_value(record):
    value = record.get("value")
    return isinstance(value, (int, float)) and math.isfinite(value)


NAMES = {"cpu": "CPU", "opencl": "OpenCL", "mitsuba": "Mitsuba", "raysect": "Raysect"}


def backend_label(record):
    """ "CPU", "OpenCL dpept-batch", "Mitsuba llvm_ad_spectral" """
    words = [NAMES.get(record.get("backend"), str(record.get("backend"))), record.get("method")]
    return " ".join(word for word in words if word)


def ratio_label(record):
    """Ours over another program, which the series names: "CPU sobol : Mitsuba llvm_ad_spectral"."""
    backend, *variant = str(record.get("series")).split(" ")
    return f"CPU {record.get('sampler')} : {' '.join([NAMES.get(backend, backend), *variant])}"


def way_label(record):
    """The backend with modes, as far as they are given: "CPU shared sobol, 16 replicates"."""
    words = [backend_label(record), record.get("wavelengths"), record.get("sampler"), record.get("dispersion")]
    text = " ".join(word for word in words if word)
    replicates = record.get("replicates") or 1
    return text if replicates < 2 else f"{text}, {replicates} replicates"


def lines(records, x, label):
    """{label: [(x, value, error)]}, sorted by x; records without a number are left out."""
    found = {}
    for record in records:
        if has_value(record) and record.get(x) is not None:
            point = (record[x], record["value"], record.get("error") or 0.0)
            found.setdefault(label(record), []).append(point)
    return {name: sorted(points) for name, points in found.items()}
