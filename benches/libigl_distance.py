"""Signed distance next to libigl's, in one run on the same points.

    pip install libigl numpy
    python benches/libigl_distance.py MODEL.ply [POINTS]

MODEL is a binary PLY of float positions and triangles. Both programs use all processors they are allowed (pin with
`taskset -c 0` for one). Prints times and the largest difference of the distances.
"""

import os
import subprocess
import sys
import tempfile
import time

import igl
import numpy as np


def read_ply(path):
    with open(path, "rb") as file:
        counts = {}
        properties = 0
        while True:
            line = file.readline().split()
            if line[0] == b"element":
                counts[line[1]] = int(line[2])
            elif line[:2] == [b"property", b"float"]:
                properties += 1
            elif line[0] == b"end_header":
                break
        vertices = np.frombuffer(file.read(4 * properties * counts[b"vertex"]), "<f4")
        faces = np.frombuffer(file.read(13 * counts[b"face"]), np.uint8).reshape(-1, 13)
    vertices = vertices.reshape(-1, properties)[:, :3].astype(float)
    return vertices, faces[:, 1:].copy().view("<i4").astype(np.int64)


def main():
    model = sys.argv[1]
    count = int(sys.argv[2]) if len(sys.argv) > 2 else 1_000_000
    vertices, faces = read_ply(model)
    low, high = vertices.min(0), vertices.max(0)
    random = np.random.default_rng(1)
    points = low - 0.1 * (high - low) + 1.2 * (high - low) * random.random((count, 3))
    folder = tempfile.mkdtemp()
    name, out = os.path.join(folder, "points.npy"), os.path.join(folder, "distances")
    np.save(name, points)
    threads = len(os.sched_getaffinity(0))
    environment = dict(os.environ, RAYON_NUM_THREADS=str(threads), IGL_NUM_THREADS=str(threads))
    command = ["cargo", "bench", "-q", "--bench", "field", "--", model, name, out]
    report = subprocess.run(command, env=environment, check=True, capture_output=True, text=True).stdout
    ours = next(line for line in report.splitlines() if line.startswith("rule PseudoNormal"))
    start = time.perf_counter()
    theirs = igl.signed_distance(points, vertices, faces, igl.SIGNED_DISTANCE_TYPE_PSEUDONORMAL)[0]
    seconds = time.perf_counter() - start
    words = ours.split()
    total = float(words[words.index("total_s") + 1])
    # libigl is positive outside.
    difference = np.abs(np.fromfile(out) + theirs).max()
    print(report, end="")
    print(f"libigl PseudoNormal total_s {seconds:.3f}, {threads} threads each")
    print(f"ratio {total / seconds:.3f}, largest difference {difference:.3e}")


if __name__ == "__main__":
    main()
