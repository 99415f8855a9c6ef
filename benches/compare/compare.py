#!/usr/bin/env python3
"""Times trisect and other engines on the same inputs, turn by turn, and records what they return.

    python compare.py                                    every case, every engine
    python compare.py --cases a_20k,h_tiny --engines trisect,manifold --threads one
    python compare.py --models FOLDER                    the cases with models from files too
    python report.py results/NAME.jsonl                  the tables

Every engine sits in a process of its own for each case, with one core or with all. For each operation the engines take
turns, one round each (A B C D A B C D ...), first with their own objects in hand ("alone"), then from arrays to arrays
("whole": making the objects, with the checks an engine makes, the operation, arrays out). A round of a quick operation is
several runs, of which the median counts. An engine that takes longer than the case's limit is stopped and left out of the
rest of the case. Memory is measured in one more process for each engine and operation.
"""
import argparse
import json
import os
import pathlib
import platform
import select
import signal
import statistics
import subprocess
import sys
import tempfile
import time

import cases
import engines

HERE = pathlib.Path(__file__).parent
LOADING_LIMIT = 120.0
ROUND_SECONDS = 0.05
MOST_REPEATS = 500


class Stopped(Exception):
    """An engine took too long, died, or said that it failed."""


class Process:
    def __init__(self, path, engine, cores):
        self.engine = engine
        command = [sys.executable, str(HERE / "worker.py"), str(path), engine, ",".join(map(str, cores))]
        self.errors = tempfile.TemporaryFile("w+")
        self.process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self.errors, text=True, start_new_session=True
        )
        self.version = self.answer(LOADING_LIMIT)["version"]

    def ask(self, limit, **request):
        self.process.stdin.write(json.dumps(request) + "\n")
        self.process.stdin.flush()
        return self.answer(limit)

    def answer(self, limit):
        readable, _, _ = select.select([self.process.stdout], [], [], limit)
        if not readable:
            self.end()
            raise Stopped("limit", limit)
        line = self.process.stdout.readline()
        if not line:
            code = self.process.wait()
            self.errors.seek(0)
            last = (self.errors.read().strip().splitlines() or [""])[-1][:300]
            reason = "signal %d" % -code if code < 0 else "exit %d" % code
            raise Stopped("died", ("%s %s" % (reason, last)).strip())
        answer = json.loads(line)
        if "error" in answer:
            raise Stopped("error", answer["error"])
        return answer

    def end(self):
        try:
            os.killpg(self.process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
        self.process.wait()


class Comparison:
    def __init__(self, options, record):
        self.options, self.record = options, record
        self.stopped = set()  # (case, engine): not asked again

    def case(self, name):
        options = self.options
        path = cases.stored(name, options.cache, options.models)
        case = cases.restored(path)
        limit = options.limit or case.limit
        operations = [op for op in case.operations if op in options.operations]
        taking_part = [engine for engine in options.engines if case.way in engines.ENGINES[engine].ways]
        self.record(
            event="case", case=name, way=case.way, operations=operations, meshes=len(case.meshes), limit=limit,
            triangles=sum(len(triangles) for _, triangles in case.meshes), exact=case.exact,
        )
        for threads in options.threads:
            cores = [options.core] if threads == "one" else sorted(os.sched_getaffinity(0))
            processes = self.started(name, path, taking_part, threads, cores)
            try:
                for operation in operations:
                    for scope in options.scopes:
                        self.rounds(name, operation, scope, threads, processes, limit)
                    self.judge(name, operation, threads, processes, limit)
            finally:
                for process in processes:
                    process.end()
        if options.memory:
            for operation in operations:
                for engine in taking_part:
                    self.memory(name, operation, path, engine, limit)

    def started(self, name, path, taking_part, threads, cores):
        processes = []
        for engine in taking_part:
            if (name, engine) in self.stopped:
                continue
            try:
                process = Process(path, engine, cores)
                processes.append(process)
                self.record(event="version", engine=engine, version=process.version)
            except Stopped as stop:
                self.stop(name, engine, None, None, threads, stop)
        return processes

    def stop(self, name, engine, operation, scope, threads, stop):
        kind, detail = stop.args
        self.record(
            event="stopped", case=name, engine=engine, operation=operation, scope=scope, threads=threads, kind=kind,
            detail=detail,
        )
        if kind != "error":
            self.stopped.add((name, engine))

    def attempt(self, name, process, threads, limit, **request):
        """An answer, or None from an engine that has been stopped."""
        if (name, process.engine) in self.stopped:
            return None
        try:
            return process.ask(limit, **request)
        except Stopped as stop:
            scope = request.get("scope", request["do"])
            self.stop(name, process.engine, request["operation"], scope, threads, stop)
            return None

    def rounds(self, name, operation, scope, threads, processes, limit):
        request = {"do": "run", "operation": operation, "scope": scope}
        turns = []
        for process in processes:
            ask = lambda repeats, process=process: self.attempt(
                name, process, threads, limit * repeats, repeats=repeats, **request
            )
            first = ask(1)
            if first is None:
                continue
            turn = {"process": process, "ask": ask, "first": first["wall"][0], "wall": [], "processor": []}
            second = ask(1) if turn["first"] < 5 else first
            if second is None:
                continue
            one = second["wall"][0]
            turn["repeats"] = max(1, min(MOST_REPEATS, round(ROUND_SECONDS / one)))
            seconds = self.options.seconds / (one * turn["repeats"])
            least = 3 if one < 10 else 2 if one < 30 else 1
            turn["rounds"] = int(max(least, min(self.options.rounds, seconds)))
            turns.append(turn)
        for number in range(self.options.rounds):
            for turn in list(turns):
                if number >= turn["rounds"]:
                    continue
                answer = turn["ask"](turn["repeats"])
                if answer is None:
                    turns.remove(turn)
                    continue
                for clock in ("wall", "processor"):
                    turn[clock].append(statistics.median(answer[clock]))
        for turn in turns:
            self.record(
                event="time", case=name, engine=turn["process"].engine, operation=operation, scope=scope,
                threads=threads, first=turn["first"], repeats=turn["repeats"], wall=turn["wall"],
                processor=turn["processor"], load=os.getloadavg()[0],
            )

    def judge(self, name, operation, threads, processes, limit):
        for process in processes:
            answer = self.attempt(
                name, process, threads, 2 * limit + LOADING_LIMIT, do="judge", operation=operation
            )
            if answer is not None:
                self.record(
                    event="verdict", case=name, engine=process.engine, operation=operation, threads=threads, **answer
                )

    def memory(self, name, operation, path, engine, limit):
        if (name, engine) in self.stopped:
            return
        try:
            process = Process(path, engine, sorted(os.sched_getaffinity(0)))
        except Stopped as stop:
            return self.stop(name, engine, operation, "memory", "all", stop)
        answer = self.attempt(name, process, "all", 2 * limit, do="memory", operation=operation)
        if answer is not None:
            self.record(event="memory", case=name, engine=engine, operation=operation, **answer)
        process.end()


def machine():
    with open("/proc/cpuinfo") as file:
        processor = next((line.split(":")[1].strip() for line in file if line.startswith("model name")), "unknown")
    with open("/proc/meminfo") as file:
        memory = int(file.readline().split()[1]) / 2**20
    commit = subprocess.run(
        ["git", "describe", "--always", "--dirty"], cwd=HERE, capture_output=True, text=True, check=False
    ).stdout.strip()
    return {
        "event": "machine", "processor": processor, "cores": len(os.sched_getaffinity(0)), "memory_gib": round(memory, 1),
        "system": "%s %s" % (platform.system(), platform.release()), "python": platform.python_version(),
        "commit": commit, "date": time.strftime("%Y-%m-%d %H:%M"), "load": os.getloadavg()[0],
    }


def listed(known):
    def parse(text):
        names = text.split(",")
        unknown = [name for name in names if known is not None and name not in known]
        if unknown:
            raise argparse.ArgumentTypeError("unknown: %s; known: %s" % (", ".join(unknown), ", ".join(known)))
        return names
    return parse


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=listed(None), help="names, or the letters of groups; default: all")
    parser.add_argument("--engines", type=listed(engines.ENGINES), default=list(engines.ENGINES))
    parser.add_argument("--threads", type=listed(("one", "all")), default=["one", "all"])
    parser.add_argument("--scopes", type=listed(("alone", "whole")), default=["alone", "whole"])
    parser.add_argument("--operations", type=listed(cases.ALL_OPERATIONS), default=list(cases.ALL_OPERATIONS))
    parser.add_argument("--models", help="folder with the models of cases j")
    parser.add_argument("--rounds", type=int, default=11, help="most rounds of one operation")
    parser.add_argument("--seconds", type=float, default=8.0, help="about how long one engine's rounds take in all")
    parser.add_argument("--limit", type=float, help="seconds one run may take; default: that of the case")
    parser.add_argument("--core", type=int, default=0, help="the core of one-thread runs")
    parser.add_argument("--no-memory", dest="memory", action="store_false")
    parser.add_argument("--cache", default=os.path.join(tempfile.gettempdir(), "trisect-compare"))
    parser.add_argument("--out", default=str(HERE / "results" / time.strftime("%Y%m%d-%H%M%S.jsonl")))
    options = parser.parse_args()

    names = [name for name in cases.NAMES if options.models or not name.startswith("j_")]
    if options.cases:
        by_group = lambda wanted: [name for name in names if name.split("_")[0] == wanted] or [wanted]
        names = [name for wanted in options.cases for name in by_group(wanted)]
    pathlib.Path(options.out).parent.mkdir(parents=True, exist_ok=True)
    with open(options.out, "a") as file:
        def record(**entry):
            file.write(json.dumps(entry) + "\n")
            file.flush()
            if entry["event"] == "time":
                print("%-12s %-14s %-12s %-5s %-3s %10.3f ms" % (
                    entry["case"], entry["engine"], entry["operation"], entry["scope"], entry["threads"],
                    1e3 * statistics.median(entry["wall"])), flush=True)
            elif entry["event"] == "stopped":
                print("%-12s %-14s stopped: %s %s" % (
                    entry["case"], entry["engine"], entry["kind"], entry["detail"]), flush=True)

        record(**machine())
        comparison = Comparison(options, record)
        for name in names:
            comparison.case(name)
    print(options.out)


if __name__ == "__main__":
    main()
