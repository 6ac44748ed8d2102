# SPDX-License-Identifier: GPL-3.0-or-later
"""Calls of a library that on some damaged files does not end, or ends the process by a fault."""
import os
import pickle
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

INTERVAL = 0.2  # between looks at the clock, s


@contextmanager
def limited(seconds: float, message: str | Callable[[], str]) -> Iterator[None]:
    """End the program with exit code 2 and a message if the body takes longer, in processor time of the process, s."""
    done, stop = threading.Event(), time.process_time() + seconds

    def watch() -> None:
        while not done.wait(INTERVAL):
            if time.process_time() > stop:
                print(f"error: {message if isinstance(message, str) else message()}", file=sys.stderr, flush=True)
                os._exit(2)  # the body holds the main thread

    watcher = threading.Thread(target=watch, daemon=True)
    watcher.start()
    try:
        yield
    finally:
        done.set()
        watcher.join()


def supervised(body: Callable[..., Any], message: str) -> None:
    """Call a function in a child process; end the program with its exit code, or with 2 and a message if a fault ended
    it."""
    if not hasattr(os, "fork"):
        body()
        return
    sys.stdout.flush()
    child = os.fork()
    if not child:
        body()
        return
    status = wait_for(child)
    if os.WIFSIGNALED(status) and os.WTERMSIG(status) not in (2, 13, 15):  # interrupted, pipe closed, terminated
        print(f"error: {message}", file=sys.stderr, flush=True)
        sys.exit(2)
    sys.exit(os.WEXITSTATUS(status) if os.WIFEXITED(status) else 128 + os.WTERMSIG(status))


@contextmanager
def beside(body: Callable[[], Any]) -> Iterator[None]:
    """Call a function that writes a file in a child process, beside the block; after the block if that fails."""
    child = os.fork() if hasattr(os, "fork") else None
    if child == 0:
        code = 1
        try:
            body()
            code = 0
        finally:
            os._exit(code)
    failed = True
    try:
        yield
    finally:
        if child:
            failed = wait_for(child) != 0
    if failed:
        body()


def started(body: Callable[[], Any]) -> Callable[[], Any]:
    """Start a function in a child process; return a function that waits for its result. It is called here if that
    fails."""
    if not hasattr(os, "fork"):
        return body
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        code = 1
        try:
            os.close(reading)
            with os.fdopen(writing, "wb") as pipe:
                pickle.dump(body(), pipe, pickle.HIGHEST_PROTOCOL)
            code = 0
        finally:
            os._exit(code)
    os.close(writing)

    def result() -> Any:
        with os.fdopen(reading, "rb") as pipe:
            data = pipe.read()
        return pickle.loads(data) if wait_for(child) == 0 else body()

    return result


def wait_for(child: int) -> int:
    """Return the status of a child, which gets the interrupts too."""
    while True:
        try:
            return os.waitpid(child, 0)[1]
        except KeyboardInterrupt:
            pass
