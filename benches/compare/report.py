#!/usr/bin/env python3
"""Markdown tables from the records of compare.py.

    python report.py results/NAME.jsonl [MORE.jsonl ...] > tables.md
    python report.py --clock processor --statistic min results/NAME.jsonl     for a machine that others use too

Where several records tell of the same case, engine, operation, scope and threads, the last one counts.
"""
import argparse
import json
import statistics
import sys

import cases
import engines

# What the times of trisect must not exceed, as multiples of others': one thread, from arrays to arrays.
# (title, cases, of manifold, of trueform, of the fastest of all others)
BARS = [
    ("a, 20 k and 80 k", ("a_20k", "a_80k"), 0.20, 0.5, 0.7),
    ("a, 330 k and 1.3 M", ("a_330k", "a_1.3M"), 0.06, 0.25, 0.4),
    ("b", ("b_local",), 0.04, 0.15, 0.2),
    ("c", ("c_bumpy",), 0.15, 0.15, 0.2),
    ("d, Menger 3", ("d_menger3",), 0.5, 0.2, 0.5),
    ("d, Menger 4", ("d_menger4",), 0.2, 0.1, 0.25),
    ("e", ("e_cubes",), 0.5, 0.2, 0.5),
    ("f", ("f_spheres",), 0.33, 0.05, 0.33),
    ("g", ("g_knot",), 0.15, 0.25, 0.33),
    ("g, long", ("g_long",), 0.02, 0.02, 0.05),
    ("h", ("h_tiny",), 0.33, 0.03, 0.33),
    ("i", ("i_chain100", "i_reuse100"), 0.03, 0.1, 0.15),
    ("j", tuple("j_" + model for model in cases.MODELS), 0.15, 0.25, 0.33),
]
GAIN_BAR = ("a_1.3M", "c_bumpy", "f_spheres"), 1.6
MEMORY_BAR = 150
OURS = engines.Trisect.name
# A volume this far from the reference, relative to the volume, is another body and not rounding.
TOLERANCE = {"single": 1e-4, "double": 1e-9}
SINGLE = (engines.Trueform32.name, engines.MeshLib.name, engines.MeshLibPairs.name)


class Records:
    def __init__(self, paths, clock, statistic):
        self.machines, self.versions, self.cases = [], {}, {}
        self.times, self.first, self.stopped, self.verdicts, self.memory = {}, {}, {}, {}, {}
        choose = {"median": statistics.median, "min": min}[statistic]
        for path in paths:
            with open(path) as file:
                for line in file:
                    self.add(json.loads(line), clock, choose)
        known = [name for name in cases.NAMES if name in self.cases]
        self.names = known + [name for name in self.cases if name not in known]
        taking_part = {key[1] for key in self.times} | {engine for _, engine in self.stopped}
        self.engines = [engine for engine in engines.ENGINES if engine in taking_part]

    def add(self, entry, clock, choose):
        event = entry["event"]
        if event == "machine":
            self.machines.append(entry)
        elif event == "version":
            self.versions[entry["engine"]] = entry["version"]
        elif event == "case":
            self.cases[entry["case"]] = entry
            # A new run of the case replaces what engines failed at in an older one.
            self.stopped = {key: value for key, value in self.stopped.items() if key[0] != entry["case"]}
        elif event == "stopped":
            self.stopped.setdefault((entry["case"], entry["engine"]), []).append(entry)
        elif event == "verdict":
            self.verdicts[entry["case"], entry["engine"], entry["operation"], entry["threads"]] = entry
        elif event == "memory":
            self.memory[entry["case"], entry["engine"], entry["operation"]] = entry
        elif event == "time":
            key = entry["case"], entry["engine"], entry["operation"], entry["scope"], entry["threads"]
            self.times[key] = choose(entry[clock])

    def time(self, *key):
        """(seconds, whether that is only a lower limit), or None."""
        if key in self.times:
            return self.times[key], False
        for stop in self.stopped.get(key[:2], []):
            if stop["kind"] == "limit":
                return stop["detail"], True
        return None

    def failure(self, case, engine):
        stops = self.stopped.get((case, engine), [])
        return stops[0]["kind"] if stops else None

    def rows(self):
        for name in self.names:
            for operation in self.cases[name]["operations"]:
                yield name, operation


def duration(seconds):
    for factor, unit in ((1, "s"), (1e3, "ms"), (1e6, "µs")):
        if seconds * factor >= 1:
            break
    return "%.3g %s" % (seconds * factor, unit)


def ratio(ours, theirs):
    """(value, text, whether the other only has a lower limit); None without both times."""
    if ours is None or theirs is None or ours[1]:
        return None
    value = ours[0] / theirs[0]
    return value, ("< " if theirs[1] else "") + "%.2g" % value, theirs[1]


def fastest_of_others(records, name, operation, scope, threads):
    found = [records.time(name, engine, operation, scope, threads) for engine in records.engines if engine != OURS]
    found = [time for time in found if time is not None]
    # A time, even a longer one, tells more than a limit.
    return min(found, default=None)


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


def times_table(records, scope, threads):
    rows = []
    for name, operation in records.rows():
        ours = records.time(name, OURS, operation, scope, threads)
        cells = ["%s %s" % (name, operation)]
        for engine in records.engines:
            time = records.time(name, engine, operation, scope, threads)
            if time is not None:
                cells.append(("> " if time[1] else "") + duration(time[0]))
            else:
                cells.append(records.failure(name, engine) or "")
        others = [
            records.time(name, engines.Manifold.name, operation, scope, threads),
            records.time(name, engines.Trueform.name, operation, scope, threads),
            fastest_of_others(records, name, operation, scope, threads),
        ]
        ratios = [ratio(ours, other) for other in others]
        if any(cells[1:]):
            rows.append(cells + [found[1] if found else "" for found in ratios])
    header = ["case"] + records.engines + ["÷ manifold", "÷ trueform", "÷ fastest"]
    return table(header, rows) if rows else "Not measured.\n"


def bars_table(records, scope="whole", threads="one"):
    """For every bar the worst of its cases and operations."""
    rows = []
    for title, names, *bars in BARS:
        measured = [(name, operation) for name, operation in records.rows() if name in names]
        cells, verdicts = [title], []
        for bar, engine in zip(bars, (engines.Manifold.name, engines.Trueform.name, None)):
            ratios = []
            for name, operation in measured:
                key = operation, scope, threads
                theirs = records.time(name, engine, *key) if engine else fastest_of_others(records, name, *key)
                found = ratio(records.time(name, OURS, *key), theirs)
                if found:
                    ratios.append(found)
            worst = max(ratios, default=None)
            if worst is None:
                cells.append("– (%g)" % bar)
                verdicts.append(None)
                continue
            # Against a limit alone a ratio above the bar proves nothing.
            verdict = True if worst[0] <= bar else None if worst[2] else False
            cells.append("%s (%g)%s" % (worst[1], bar, {True: "", False: " ✗", None: " ?"}[verdict]))
            verdicts.append(verdict)
        if not measured:
            outcome = "not measured"
        else:
            outcome = "miss" if False in verdicts else "open" if None in verdicts else "pass"
        rows.append(cells + [outcome])
    return table(["case", "÷ manifold (bar)", "÷ trueform (bar)", "÷ fastest (bar)", "outcome"], rows)


def gain_table(records):
    names, bar = GAIN_BAR
    rows = []
    for name, operation in records.rows():
        one, all_ = (records.time(name, OURS, operation, "alone", threads) for threads in ("one", "all"))
        if name in names and one and all_ and not one[1] and not all_[1]:
            gain = one[0] / all_[0]
            rows.append(["%s %s" % (name, operation), "%.2f" % gain, "pass" if gain >= bar else "miss"])
    return table(["case", "one thread ÷ all", "at least %g" % bar], rows) if rows else "Not measured.\n"


def memory_table(records):
    rows = []
    for name, operation in records.rows():
        found = {engine: records.memory.get((name, engine, operation)) for engine in records.engines}
        ours = found.get(OURS)
        if not any(found.values()):
            continue
        cells = ["%s %s" % (name, operation)]
        for engine in records.engines:
            entry = found[engine]
            # Peak per triangle, and in all.
            cells.append("%.0f (%.0f MB)" % (per_triangle(entry), entry["peak"] / 1e6) if entry else "")
        big = ours and ours["triangles_in"] >= 100_000
        cells.append(("pass" if per_triangle(ours) <= MEMORY_BAR else "miss") if big else "")
        rows.append(cells)
    return table(["case"] + records.engines + ["≤ %d" % MEMORY_BAR], rows) if rows else "Not measured.\n"


def per_triangle(entry):
    return entry["peak"] / max(1, entry["triangles_in"] + entry["triangles_out"])


def agreement_table(records):
    rows = []
    for name, operation in records.rows():
        found = {
            engine: records.verdicts.get((name, engine, operation, "one"))
            or records.verdicts.get((name, engine, operation, "all"))
            for engine in records.engines
        }
        volumes = [entry["volume"] for engine, entry in found.items() if entry and engine not in SINGLE]
        reference = records.cases[name]["exact"].get(operation)
        if reference is None and volumes:
            reference = statistics.median_low(volumes)
        if not any(found.values()) or reference is None:
            continue
        cells = ["%s %s" % (name, operation), "%.10g" % reference]
        for engine in records.engines:
            entry = found[engine]
            cells.append(judged(entry, engine, reference) if entry else records.failure(name, engine) or "")
        same = digests(records, name, operation)
        cells.append("" if same is None else "yes" if same else "NO")
        rows.append(cells)
    header = ["case", "volume"] + records.engines + ["trisect: same bits, one and all threads"]
    return table(header, rows) if rows else "Not measured.\n"


def judged(entry, engine, reference):
    difference = abs(entry["volume"] - reference) / max(abs(reference), 1e-300)
    words = ["%d" % entry["triangles"], "%.0e" % difference if difference else "0"]
    if not difference <= TOLERANCE["single" if engine in SINGLE else "double"]:
        words.append("WRONG")
    if not entry["closed"]:
        words.append("OPEN")
    elif not entry["manifold"]:
        words.append("edges with 4 faces")
    if entry["zero_area"]:
        words.append("%d without area" % entry["zero_area"])
    return ", ".join(words)


def digests(records, name, operation):
    found = [records.verdicts.get((name, OURS, operation, threads)) for threads in ("one", "all")]
    return found[0]["digest"] == found[1]["digest"] if all(found) else None


def stops_list(records):
    lines = []
    for (name, engine), stops in records.stopped.items():
        for stop in stops:
            detail = "%g s" % stop["detail"] if stop["kind"] == "limit" else stop["detail"]
            where = " ".join(str(stop[key]) for key in ("operation", "scope", "threads") if stop[key])
            lines.append("- %s, %s, %s: %s, %s" % (name, engine, where, stop["kind"], detail))
    return "\n".join(sorted(set(lines))) + "\n" if lines else "None.\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+")
    parser.add_argument("--clock", choices=("wall", "processor"), default="wall")
    parser.add_argument("--statistic", choices=("median", "min"), default="median")
    parser.add_argument("--only", choices=("bars",), help="this table alone")
    options = parser.parse_args()
    records = Records(options.files, options.clock, options.statistic)
    out = sys.stdout
    if options.only == "bars":
        out.write(bars_table(records))
        return
    for machine in records.machines:
        out.write(
            "- %(date)s, commit %(commit)s: %(processor)s, %(cores)d cores, %(memory_gib).0f GiB, %(system)s, "
            "Python %(python)s; load at the start %(load).1f\n" % machine
        )
    versions = ", ".join("%s %s" % item for item in records.versions.items())
    out.write("- %s\n- %s of the %s clock\n" % (versions, options.statistic, options.clock))
    out.write("\n### Bars\n\nOne thread, from arrays to arrays; the worst operation of each case.\n\n" + bars_table(records))
    for threads, title in (("one", "One thread"), ("all", "All threads")):
        for scope, what in (("whole", "from arrays to arrays"), ("alone", "operation alone")):
            out.write("\n### %s, %s\n\n%s" % (title, what, times_table(records, scope, threads)))
    out.write("\n### Gain of a second core\n\n" + gain_table(records))
    out.write("\n### Peak memory\n\nBytes for each triangle going in or out, from arrays to arrays, all threads.\n\n")
    out.write(memory_table(records))
    out.write("\n### What they return\n\nTriangles, relative difference of the volume, and what is wrong.\n\n")
    out.write(agreement_table(records))
    out.write("\n### Stopped\n\n" + stops_list(records))


if __name__ == "__main__":
    main()
