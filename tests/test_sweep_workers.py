"""Sweeps on worker processes and on a Dask cluster: interrupts, workers that die, the same table whoever works."""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from sweep_fakes.files import Here, evaluated, options, started, written

from pyjkr.errors import RunError
from pyjkr.sweep import crews, executing
from pyjkr.sweep.command import run_sweep

# For a process to appear or to end; a busy machine takes a while to start Python.
PATIENCE = 30.0


def wait_for(condition: Callable[[], bool], what: str) -> None:
    deadline = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < deadline, what
        time.sleep(0.05)


def programs(directory: Path) -> list[int]:
    return [int(mark.name.split("-")[1]) for mark in (directory / "marks").glob("program-*")]


def alive(process: int) -> bool:
    try:
        state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state != "Z"


def interrupted_by(number: signal.Signals, tmp_path: Path) -> int:
    """Exit status of a sweep of which two points are done, one runs a program for long and one waits its turn."""
    path, out = written(tmp_path, [2.0, 3.0, 5.0]), tmp_path / "out"
    (tmp_path / "marks" / "wait-5").touch()
    sweep = started(path, out)
    try:
        wait_for(lambda: bool(programs(tmp_path)) and len(list((out / "points").glob("*.json"))) == 2, "the sweep does not get going")
        # Ctrl-C reaches every process of the terminal's group, a kill the one that is named.
        os.killpg(sweep.pid, number) if number == signal.SIGINT else sweep.send_signal(number)
        _, messages = sweep.communicate(timeout=PATIENCE)
        said = "pyjkr: interrupted; the same command goes on where this one stopped\n"
        assert messages == said or number == signal.SIGKILL, "workers complain about an interrupt that is not theirs"
    finally:
        sweep.kill()
    wait_for(lambda: not any(map(alive, programs(tmp_path))), "what a worker ran outlives the sweep")
    return sweep.returncode


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL])
def test_an_interrupted_sweep_ends_its_programs_and_goes_on_where_it_stopped(tmp_path, number, monkeypatch):
    status = interrupted_by(number, tmp_path)
    assert status == (130 if number == signal.SIGINT else -signal.SIGKILL)
    assert not (tmp_path / "out" / "result.json").exists()
    (tmp_path / "marks" / "wait-5").unlink()
    monkeypatch.setattr(executing, "crew", lambda workers, scheduler: Here())
    # Not kept out by the lock of a process that was killed.
    run_sweep(options(tmp_path / "squares.toml", tmp_path / "out"))
    assert evaluated(tmp_path) == {"2": 1, "3": 1, "5": 2}


def test_a_worker_that_dies_costs_the_point_that_killed_it_and_no_other(tmp_path):
    path = written(tmp_path, [2.0, 3.0, 5.0, 7.0])
    (tmp_path / "marks" / "die-3").touch()
    with pytest.raises(RunError) as caught:
        run_sweep(options(path, tmp_path / "out"))
    lines = str(caught.value).splitlines()
    assert lines[0].startswith("1 of 4 points failed")
    assert lines[1] == "  number 3: its worker died: killed, out of memory, or a crash in compiled code"
    assert len(list((tmp_path / "out" / "points").glob("*.json"))) == 3
    children = Path(f"/proc/self/task/{os.getpid()}/children").read_text().split()
    assert not [child for child in children if b"spawn_main" in Path(f"/proc/{child}/cmdline").read_bytes()], "a worker is left behind"


def test_a_cluster_gives_the_same_table_as_processes(tmp_path):
    distributed = pytest.importorskip("distributed", reason="pip install 'pyjkr[cluster]'")
    path = written(tmp_path, [2.0, 3.0, 5.0])
    (tmp_path / "marks" / "fail-7").touch()
    run_sweep(options(path, tmp_path / "pool", workers=1))
    cluster = distributed.LocalCluster(
        n_workers=1, threads_per_worker=2, processes=False, protocol="tcp", host="127.0.0.1", dashboard_address=None
    )
    with cluster:
        assert cluster.scheduler_address.startswith("tcp://")
        run_sweep(options(path, tmp_path / "cluster", scheduler=cluster.scheduler_address))
        with pytest.raises(RunError, match="1 of 3 points failed") as caught:
            run_sweep(options(written(tmp_path, [2.0, 3.0, 7.0]), tmp_path / "cluster", scheduler=cluster.scheduler_address))
    assert "number 7: ValueError: 7 is not to my taste" in str(caught.value)
    assert evaluated(tmp_path) == {"2": 2, "3": 2, "5": 2, "7": 1}
    run_sweep(options(written(tmp_path, [2.0, 3.0, 5.0]), tmp_path / "cluster"))
    assert (tmp_path / "cluster" / "table.csv").read_bytes() == (tmp_path / "pool" / "table.csv").read_bytes()


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:1", "no scheduler", "tcp://127.0.0.1:not-a-port"])
def test_a_scheduler_that_is_not_there_is_one_line(tmp_path, address, monkeypatch):
    pytest.importorskip("distributed", reason="pip install 'pyjkr[cluster]'")
    monkeypatch.setattr(crews, "ANSWER_SECONDS", 1.0)
    began = time.monotonic()
    with pytest.raises(RunError, match="no answer") as caught:
        run_sweep(options(written(tmp_path, [2.0]), tmp_path / "out", scheduler=address))
    assert "\n" not in str(caught.value) and address in str(caught.value)
    assert time.monotonic() - began < 10


def test_without_dask_the_option_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(RunError, match=r"pip install 'pyjkr\[cluster\]'"):
        run_sweep(options(written(tmp_path, [2.0]), tmp_path / "out", scheduler="tcp://127.0.0.1:8786"))

