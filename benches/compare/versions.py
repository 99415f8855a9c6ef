"""Two builds of trisect turn by turn: is the newer one as fast, and does it give the same bits?

    python benches/compare/versions.py OLD.so NEW.so --cases a_330k,h_tiny --rounds 11

Each library is built by `cargo build --release` in this folder of its version. One thread, from arrays to arrays; the order
changes every round, so that a machine that slows down slows down both.
"""
import argparse
import gc
import os
import time

import numpy as np

os.environ.setdefault("TRISECT_THREADS", "1")

import cases
import trisect_engine


def engine(path):
    trisect_engine.LIBRARY = os.path.abspath(path)
    return trisect_engine.Trisect()


def run(engine, case, operation):
    """Seconds from arrays to arrays, and the result."""
    start = time.perf_counter()
    solids = [engine.conv(*mesh) for mesh in case.meshes]
    if case.way == "pair":
        result = engine.pair(*solids, operation)
    elif case.way == "many":
        result = engine._run(solids, operation)
    else:
        result = solids[0]
        for tool in solids[1:]:
            made = engine.pair(solids[0] if case.way == "reuse" else result, tool, operation)
            result = made
    positions, triangles = engine.out(result)
    return time.perf_counter() - start, positions.tobytes() + triangles.tobytes()


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("old")
    arguments.add_argument("new")
    arguments.add_argument("--cases", default="a_330k,b_local,c_bumpy,d_menger3,e_cubes,f_spheres,g_knot,h_tiny")
    arguments.add_argument("--rounds", type=int, default=11)
    arguments = arguments.parse_args()
    engines = [engine(arguments.old), engine(arguments.new)]
    gc.disable()
    print("%-10s %-13s %10s %10s %8s %8s  %s" % ("case", "operation", "old, ms", "new, ms", "median", "least", "bits"))
    for name in arguments.cases.split(","):
        case = cases.case(name)
        for operation in case.operations:
            times, bits = [[], []], [None, None]
            for round_number in range(arguments.rounds + 1):
                for i in (0, 1) if round_number % 2 == 0 else (1, 0):
                    seconds, bits[i] = run(engines[i], case, operation)
                    if round_number:  # the first one warms up
                        times[i].append(seconds)
                gc.collect()
            old, new = (np.array(of) * 1e3 for of in times)
            same = "same" if bits[0] == bits[1] else "DIFFERENT"
            ratios = np.median(new) / np.median(old), new.min() / old.min()
            print("%-10s %-13s %10.3f %10.3f %8.3f %8.3f  %s" % (name, operation, np.median(old), np.median(new), *ratios, same), flush=True)


if __name__ == "__main__":
    main()
