"""Limits, Ctrl-C, progress, threads and forked processes."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
from typing import Any, List, Tuple

import pytest

import trisect


def test_a_deadline_stops(balls: Any) -> None:
    with pytest.raises(trisect.DeadlineError) as raised:
        trisect.union(*balls, deadline=0.0)
    assert isinstance(raised.value, TimeoutError) and isinstance(raised.value, trisect.LimitError)
    assert trisect.union(*balls, deadline=600).volume > 4


def test_a_ceiling_on_memory_stops(balls: Any) -> None:
    with pytest.raises(trisect.MemoryLimitError) as raised:
        trisect.union(*balls, memory="10K")
    assert isinstance(raised.value, MemoryError) and raised.value.limit == 10240 < raised.value.needed
    assert trisect.union(*balls, memory="4GiB").volume > 4


def test_the_same_bits_on_any_number_of_threads(balls: Any) -> None:
    results = [trisect.difference(*balls, threads=threads) for threads in (1, 2, 5)]
    assert results[0] == results[1] == results[2]


def test_progress_is_told_in_the_callers_thread(balls: Any) -> None:
    told: List[Tuple[str, float, int]] = []
    trisect.union(*balls, progress=lambda stage, fraction: told.append((stage, fraction, threading.get_ident())))
    assert told and all(0 <= fraction <= 1 for _, fraction, _ in told)
    assert {thread for *_, thread in told} == {threading.get_ident()}


def test_progress_moves_a_bar(balls: Any) -> None:
    class Bar:
        total: Any = None
        n = -1
        text = ""

        def update(self, by: int) -> None: ...

        def set_description(self, text: str, refresh: bool = True) -> None:
            self.text = text

        def refresh(self) -> None: ...

    bar = Bar()
    trisect.union(*balls, progress=bar)
    assert bar.total == 100 and bar.n >= 0 and bar.text
    with pytest.raises(TypeError):
        trisect.union(*balls, progress=7)


def test_what_progress_raises_ends_the_call(balls: Any) -> None:
    class Enough(Exception):
        pass

    def stop(stage: str, fraction: float) -> None:
        raise Enough

    with pytest.raises(Enough):
        trisect.union(*balls, progress=stop)


def run_python(code: str, **given: Any) -> "subprocess.Popen[str]":
    """A Python of its own that runs the code."""
    return subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(code)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **given
    )


def test_ctrl_c_cancels() -> None:
    process = run_python(
        """
        import signal
        import trisect
        # What a shell starts in the background ignores the signal, and so does what that starts.
        signal.signal(signal.SIGINT, signal.default_int_handler)
        ball = trisect.icosphere(1.0, level=6)
        other = ball.rotated([1, 2, 3], 40).translated([0.5, 0, 0])
        print("ready", flush=True)
        try:
            while True:
                ball | other
        except KeyboardInterrupt:
            print("interrupted", (trisect.cuboid([0, 0, 0], [1, 1, 1]) | trisect.cuboid([0, 0, 0], [1, 1, 2])).volume, flush=True)
        """
    )
    try:
        assert process.stdout is not None and process.stdout.readline() == "ready\n"
        time.sleep(0.3)
        process.send_signal(signal.SIGINT)
        output, errors = process.communicate(timeout=300)
    finally:
        process.kill()
    assert output == "interrupted 2.0\n", errors


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork")
def test_processes_forked_after_use_work() -> None:
    process = run_python(
        """
        import multiprocessing, trisect
        ball = trisect.icosphere(1.0, level=5)
        other = ball.translated([0.5, 0.1, 0.2])
        expected = ball | other          # threads of this process are there now
        def work(threads):
            return trisect.union(ball, other, threads=threads)
        with multiprocessing.get_context("fork").Pool(2) as pool:
            results = pool.map_async(work, [None, 2, 1]).get(timeout=120)
        print(all(result == expected for result in results))
        """
    )
    output, errors = process.communicate(timeout=200)
    assert output == "True\n", errors


def test_the_lock_is_let_go_of(balls: Any) -> None:
    a, b = balls
    ticks = 0
    done = threading.Event()

    def work() -> None:
        for _ in range(3):
            trisect.union(a, b)
        done.set()

    thread = threading.Thread(target=work)
    thread.start()
    while not done.is_set():
        ticks += 1
        time.sleep(0.001)
    thread.join()
    assert ticks > 3
