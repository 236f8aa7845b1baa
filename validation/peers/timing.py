"""Clocks of long runs on a busy machine."""

import time


def clock():
    return time.perf_counter(), time.process_time()


def since(start):
    """Seconds of wall or CPU time, the smaller: on a busy machine a long run waits. All tools work on one thread."""
    return min(now - then for now, then in zip(clock(), start))
