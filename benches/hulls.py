"""Convex hulls of all models of a folder beside those of scipy (Qhull): how far volumes are apart.

    pip install numpy scipy
    python benches/hulls.py target/release/trisect FOLDER
"""
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
from scipy.spatial import ConvexHull

ENDINGS = (".off", ".obj", ".stl", ".ply", ".glb", ".gltf")
LARGEST = 2_500_000  # bytes of a file; larger ones take long to read as text here


def points(path):
    """The vertices that faces of an OFF file use."""
    words = path.read_text().split()
    vertices, faces = int(words[1]), int(words[2])
    positions = np.array(words[4:4 + 3 * vertices], float).reshape(-1, 3)
    rest, used = iter(words[4 + 3 * vertices:]), set()
    for _ in range(faces):
        used.update(int(next(rest)) for _ in range(int(next(rest))))
    return positions[sorted(used)]


def main():
    program, folder = sys.argv[1:3]
    worst, count = 0.0, 0
    with tempfile.TemporaryDirectory() as place:
        off, out = pathlib.Path(place, "model.off"), pathlib.Path(place, "hull.off")
        for path in sorted(pathlib.Path(folder).rglob("*")):
            if path.suffix.lower() not in ENDINGS or path.stat().st_size > LARGEST:
                continue
            if subprocess.run([program, "convert", path, "-o", off, "-q"], capture_output=True).returncode:
                continue
            ran = subprocess.run([program, "hull", path, "-o", out, "--json", "-q"], capture_output=True, text=True)
            if ran.returncode:
                print("%s: %s" % (path.name, json.loads(ran.stdout)["error"]["message"]))
                continue
            found, other = json.loads(ran.stdout)["result"], ConvexHull(points(off))
            assert found["closed"] and found["manifold"] and found["genus"] == 0, path
            apart = abs(found["volume"] - other.volume) / other.volume
            count, worst = count + 1, max(worst, apart)
            if apart > 1e-12:
                print("%s: volumes %.3g apart, %d and %d vertices" % (path.name, apart, found["vertices"], len(other.vertices)))
    print("%d models, volumes at most %.3g apart" % (count, worst))


if __name__ == "__main__":
    main()
