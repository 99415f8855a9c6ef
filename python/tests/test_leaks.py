"""Memory stays flat over many calls, whether they succeed or fail."""

from __future__ import annotations

import gc
import os
import tracemalloc
from typing import Any, Callable

import numpy as np
import pytest

import trisect

PAGE = 4096
# Refused calls; more by `TRISECT_CALLS`, for a long look.
CALLS = int(os.environ.get("TRISECT_CALLS", "6000"))


def resident() -> int:
    """Bytes of memory that this process has in use."""
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * PAGE


def refused(call: Callable[[], Any]) -> None:
    """Calls what is to be refused."""
    try:
        call()
    except trisect.Error:
        return
    raise AssertionError("it was not refused")


@pytest.mark.skipif(not os.path.exists("/proc/self/statm"), reason="needs /proc")
def test_many_calls_leak_nothing(cube: Any, pair: Any) -> None:
    corners, squares = cube
    turned = np.asfortranarray(corners.astype(np.float32))
    spoiled = corners * np.nan
    a, b = pair

    def calls(count: int) -> None:
        for i in range(count):
            solid = trisect.Solid(corners, squares)
            assert trisect.Solid(turned, squares[::-1]).faces[0, 0] >= 0
            refused(lambda: trisect.Solid(spoiled, squares))
            refused(lambda: trisect.Solid(corners, squares - 1))
            refused(lambda: trisect.Solid(corners, squares[1:]))
            _ = solid.vertices.sum() + solid.volume
            if i % 20 == 0:
                cut = a - b
                _ = (cut.origins, cut.curves, cut.certificate, cut.attributes, hash(cut))
                refused(lambda: trisect.union(a, b, memory=1))

    calls(200)
    gc.collect()
    before = resident()
    tracemalloc.start()
    calls(200)
    gc.collect()
    start, _ = tracemalloc.get_traced_memory()
    calls(200)
    gc.collect()
    end, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    # (Six hundred solids of Python's own, kept, would be some hundred kilobytes.)
    assert end - start < 50_000
    # (Three of them are refused in each round.)
    calls(max(0, CALLS // 3 - 600))
    gc.collect()
    # As many solids of a cube, kept, would be 6 MB at least, and more with more calls; pages come and go.
    grown = resident() - before
    print(f"{CALLS} refused calls: {grown} bytes more in use, {end - start} bytes more of Python's own")
    assert grown < 6_000_000
