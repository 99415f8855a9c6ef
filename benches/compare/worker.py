"""One engine with the meshes of one case in a process of its own; does what the coordinator asks, one request at a time.

Requests and answers are JSON objects, one a line. What an engine itself prints goes to the error stream.
"""
import ctypes
import gc
import json
import os
import sys
import time


def memory(field):
    with open("/proc/self/status") as status:
        return next(int(line.split()[1]) * 1024 for line in status if line.startswith(field))


class Worker:
    def __init__(self, path, engine, cores):
        # Before the import: engines count the cores when they are loaded.
        os.sched_setaffinity(0, cores)
        import cases
        import engines

        self.case = cases.restored(path)
        self.engine = engines.ENGINES[engine]()
        self.arrays = [self.engine.arrays(mesh) for mesh in self.case.meshes]
        self.solids = None

    def ready(self):
        self.solids = [self.engine.solid(arrays) for arrays in self.arrays]

    def combine(self, operation, solids):
        """The operation, every step of it computed in full."""
        engine, way = self.engine, self.case.way
        if way == "pair":
            return engine.pair(operation, *solids)
        if way == "many":
            return engine.many(operation, solids)
        body, result = solids[0], None
        for tool in solids[1:]:
            result = engine.pair(operation, body, tool)
            if way == "chain":
                body = result
        return result

    def alone(self, operation):
        return self.combine(operation, self.solids)

    def whole(self, operation):
        """From arrays to arrays."""
        engine = self.engine
        if self.case.way == "reuse":
            for arrays in self.arrays[1:]:
                result = engine.result(engine.pair(operation, self.solids[0], engine.solid(arrays)))
            return result
        return engine.result(self.combine(operation, [engine.solid(arrays) for arrays in self.arrays]))

    def run(self, operation, scope, repeats):
        if self.solids is None and (scope == "alone" or self.case.way == "reuse"):
            self.ready()
        action = {"alone": self.alone, "whole": self.whole}[scope]
        wall, processor = [], []
        for _ in range(repeats):
            processor_start, start = time.process_time(), time.perf_counter()
            result = action(operation)
            wall.append(time.perf_counter() - start)
            processor.append(time.process_time() - processor_start)
            del result
        return {"wall": wall, "processor": processor}

    def judge(self, operation):
        from verdict import verdict

        if self.solids is None:
            self.ready()
        return verdict(*self.engine.result(self.alone(operation)))

    def memory(self, operation):
        """Peak memory of one run from arrays to arrays, above what was in use before it: program and input arrays."""
        from verdict import verdict

        if self.case.way == "reuse":
            self.ready()
        gc.collect()
        ctypes.CDLL(None).malloc_trim(0)
        with open("/proc/self/clear_refs", "w") as file:
            file.write("5")  # sets the peak back to what is in use
        before = memory("VmRSS")
        positions, triangles = self.whole(operation)
        peak = memory("VmHWM")
        return {
            "peak": peak - before,
            "before": before,
            "triangles_in": sum(len(triangles) for _, triangles in self.case.meshes),
            "triangles_out": len(triangles),
        }


def main():
    path, engine, cores = sys.argv[1], sys.argv[2], [int(core) for core in sys.argv[3].split(",")]
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)
    worker = Worker(path, engine, cores)
    gc.disable()
    answers.write(json.dumps({"version": worker.engine.version()}) + "\n")
    for line in sys.stdin:
        request = json.loads(line)
        what = request.pop("do")
        try:
            answer = {"run": worker.run, "judge": worker.judge, "memory": worker.memory}[what](**request)
        except Exception as error:  # whatever an engine throws is its answer
            answer = {"error": "%s: %s" % (type(error).__name__, str(error)[:300])}
        answers.write(json.dumps(answer) + "\n")


if __name__ == "__main__":
    main()
