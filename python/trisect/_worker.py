"""A worker process of a batch: jobs as JSON Lines in, reports as JSON Lines out."""

from __future__ import annotations

import json
import os
import sys


def serve(folder: str) -> None:
    """Runs jobs until there are none."""
    # What anybody prints goes elsewhere than reports do.
    reports = os.fdopen(os.dup(1), "wb", buffering=0)
    os.dup2(2, 1)
    from ._jobs import run_on_one_thread

    for line in sys.stdin.buffer:
        # As many workers as cores: each on one thread.
        report = run_on_one_thread(json.loads(line), folder)
        reports.write(json.dumps(report).encode() + b"\n")


if __name__ == "__main__":
    serve(sys.argv[1] if len(sys.argv) > 1 else ".")
