"""What a returned mesh is, judged without any of the engines."""
import hashlib

import numpy as np


def verdict(positions, triangles):
    positions = np.asarray(positions, np.float64).reshape(-1, 3)
    triangles = np.asarray(triangles, np.int64).reshape(-1, 3)
    result = {
        "vertices": len(positions),
        "triangles": len(triangles),
        "digest": hashlib.sha256(positions.tobytes() + triangles.tobytes()).hexdigest()[:16],
    }
    if len(triangles) == 0:
        return result | {"volume": 0.0, "closed": True, "manifold": True, "zero_area": 0}
    if triangles.min() < 0 or triangles.max() >= len(positions):
        return result | {"volume": float("nan"), "closed": False, "manifold": False, "zero_area": 0}
    a, b, c = (positions[triangles[:, k]] - positions[triangles[:, 0]].mean(axis=0) for k in range(3))
    normals = np.cross(b - a, c - a)
    repeated = (triangles == np.roll(triangles, 1, axis=1)).any(axis=1)
    result["volume"] = float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)
    result["zero_area"] = int((repeated | ~normals.any(axis=1)).sum())
    # Closed: every directed edge is met by its opposite equally often; manifold (but for vertices): once.
    u, v = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    edges, count = np.unique(u * len(positions) + v, return_counts=True)
    opposites, opposite_count = np.unique(v * len(positions) + u, return_counts=True)
    result["closed"] = bool(np.array_equal(edges, opposites) and np.array_equal(count, opposite_count))
    result["manifold"] = bool(result["closed"] and (count == 1).all())
    return result
