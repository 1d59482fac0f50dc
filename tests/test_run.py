"""Running decks: what counts as a whole run, and what becomes of one that fails, is stopped or is asked for again."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import textwrap
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from pyjkr.errors import RunError
from pyjkr.run import RECORD, Simulator, find_simulator, read_run, run_deck

# Long enough for a simulator to be in its time loop on a busy machine [s].
IN_FULL_SWING = 1.0
# Longest time that a stopped run may take to be gone: 2 s of mpirun, the grace of run_deck, and a busy machine [s].
SOON = 20.0


def program(path: Path, script: str) -> Simulator:
    """A stand-in for LIGGGHTS that runs a shell script."""
    path.write_text("#!/bin/sh\n" + textwrap.dedent(script))
    path.chmod(0o755)
    return Simulator(path)


@pytest.fixture
def deck(tmp_path: Path) -> Path:
    path = tmp_path / "in.deck"
    path.write_text("run 30\n")
    return path


@pytest.fixture
def bare(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """Nowhere to find a simulator: no variable, an empty PATH, an empty package."""
    monkeypatch.delenv("PYJKR_LIGGGHTS", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path / "path"))
    for folder in ("path", "venv", "checkout/pyjkr", "checkout/build"):
        (tmp_path / folder).mkdir(parents=True)
    monkeypatch.setattr(sys, "executable", str(tmp_path / "venv/python"))
    monkeypatch.setattr("pyjkr.simulator.__file__", str(tmp_path / "checkout/pyjkr/simulator.py"))
    return tmp_path


def test_simulator_is_taken_from_the_variable_then_python_then_package_then_path_then_build(
    bare: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    places = ["checkout/build", "path", "checkout/pyjkr", "venv"]
    for place in places:
        program(bare / place / "liggghts-jkr", "exit 0")
        assert find_simulator() == Simulator(bare / place / "liggghts-jkr", plugin=True)
    monkeypatch.setenv("PYJKR_LIGGGHTS", str(program(bare / "mine", "exit 0").executable))
    assert find_simulator() == Simulator(bare / "mine", plugin=False)


def test_stock_liggghts_is_used_with_the_plugin_of_the_package(bare: Path) -> None:
    stock = program(bare / "path/liggghts", "exit 0").executable
    plugin = bare / "checkout/pyjkr/libliggghts_jkr.so"
    plugin.touch()
    assert find_simulator() == Simulator(stock, preload=plugin, plugin=True)


def test_missing_simulator_is_an_error_that_says_what_to_install(bare: Path) -> None:
    program(bare / "path/liggghts", "exit 0")
    with pytest.raises(RunError, match=r"apt-get install libliggghts-dev.*make run"):
        find_simulator()


def test_variable_that_names_no_program_is_an_error(bare: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYJKR_LIGGGHTS", "/no/such/liggghts")
    with pytest.raises(RunError, match="PYJKR_LIGGGHTS=/no/such/liggghts"):
        find_simulator()


def test_missing_deck_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(RunError, match=r"in\.none: the deck cannot be read"):
        run_deck(tmp_path / "in.none")


def test_steps_and_loop_times_are_summed_over_the_runs(deck: Path, tmp_path: Path) -> None:
    script = """
        echo "Step Atoms KinEng"
        echo "0 3 1.5"
        echo "Loop time of 0.25 on 1 procs for 10 steps with 3 atoms, finish time today"
        echo "Ave neighs/atom = -nan"
        echo "Loop time of 0.5 on 1 procs for 20 steps with 3 atoms, finish time today"
        """
    run = run_deck(deck, simulator=program(tmp_path / "sim", script))
    assert (run.steps, run.loop_time) == (30, 0.75)


@pytest.mark.parametrize("ranks", [1, 2])
def test_preloaded_plugin_reaches_the_program(deck: Path, tmp_path: Path, ranks: int) -> None:
    if ranks > 1 and shutil.which("mpirun") is None:
        (pytest.fail if os.environ.get("CI") else pytest.skip)("mpirun is missing: apt-get install openmpi-bin")
    simulator = program(tmp_path / "sim", 'echo "$LD_PRELOAD" > seen')
    run_deck(deck, ranks=ranks, simulator=Simulator(simulator.executable, preload=Path("libm.so.6")))
    assert "libm.so.6" in (tmp_path / "seen").read_text().split()


def test_run_without_the_plugin_that_was_to_be_preloaded_fails(deck: Path, tmp_path: Path) -> None:
    simulator = program(tmp_path / "sim", "exit 0")
    with pytest.raises(RunError, match=r"plugin\.so.*cannot be preloaded"):
        run_deck(deck, simulator=Simulator(simulator.executable, preload=tmp_path / "plugin.so"))


@pytest.mark.parametrize(
    ("printed", "message"),
    [
        ("Step Atoms KinEng\n 10 3 -nan\n", "not finite at step 10: Step = 10, Atoms = 3, KinEng = -nan"),
        ("Atoms Step c_a[1]\n 3 20 inf\n", "not finite at step 20"),
        ("---------- Step       40 ----- CPU =      0.0 (sec) ----\nTotEng = 1.5 KinEng = nan\n", "not finite at step 40"),
        ("WARNING: Lost atoms: original 3 current 2 (thermo.cpp:454)\n", "Lost atoms: original 3 current 2"),
        ("SIGINT/SIGTERM caught\nLoop time of 1 on 1 procs for 99 steps with 3 atoms\n", "stopped by a signal"),
    ],
)
def test_run_with_exit_status_zero_that_cannot_be_trusted_fails(deck: Path, tmp_path: Path, printed: str, message: str) -> None:
    (tmp_path / "printed").write_text(printed)
    with pytest.raises(RunError, match="exit status 0, but ") as caught:
        run_deck(deck, simulator=program(tmp_path / "sim", "cat printed"))
    assert message in str(caught.value)
    assert read_run(tmp_path) is None


def test_crash_names_the_signal_and_shows_the_output_where_there_is_no_log(deck: Path, tmp_path: Path) -> None:
    with pytest.raises(RunError, match="SIGSEGV") as caught:
        run_deck(deck, simulator=program(tmp_path / "sim", "echo so far so good; kill -SEGV $$"))
    assert "so far so good" in str(caught.value)


def test_run_that_takes_too_long_is_ended(deck: Path, tmp_path: Path) -> None:
    started = time.monotonic()
    with pytest.raises(RunError, match=r"stopped after the 0\.3 s"):
        run_deck(deck, simulator=program(tmp_path / "sim", "exec sleep 60"), timeout=0.3)
    assert time.monotonic() - started < SOON


def test_program_that_ignores_the_first_signal_is_killed(deck: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("pyjkr.process._GRACE_SECONDS", 0.3)
    stubborn = program(tmp_path / "sim", "trap '' INT TERM; echo $$ > pid; while :; do sleep 0.1; done")
    with pytest.raises(RunError, match="stopped after"):
        run_deck(deck, simulator=stubborn, timeout=0.5)
    with pytest.raises(ProcessLookupError):
        os.kill(int((tmp_path / "pid").read_text()), 0)


def test_nothing_is_printed_without_a_terminal(deck: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    run_deck(deck, simulator=program(tmp_path / "sim", "echo out; echo err >&2"))
    assert capfd.readouterr() == ("", "")


def test_progress_can_be_forced_and_goes_to_stderr(deck: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    script = 'printf "Step Atoms\\n0 3\\n30 3\\n"'
    run_deck(deck, simulator=program(tmp_path / "sim", script), total_steps=30, progress=True)
    shown = capfd.readouterr()
    assert shown.out == ""
    assert "30/30" in shown.err


def test_every_new_step_is_told_once(deck: Path, tmp_path: Path) -> None:
    told: list[int] = []
    script = (
        'printf "Step Atoms\\n0 3\\n10 3\\nnoise\\n20 3\\nLoop time of 1 on 1 procs for 20 steps\\nStep Atoms\\n20 3\\n30 3\\n"'
    )
    run_deck(deck, simulator=program(tmp_path / "sim", script), on_step=told.append)
    assert told == [0, 10, 20, 30]


def test_a_watcher_that_raises_ends_the_run(deck: Path, tmp_path: Path) -> None:
    def stop(step: int) -> None:
        raise KeyboardInterrupt

    stubborn = program(tmp_path / "sim", 'echo $$ > pid; printf "Step Atoms\\n0 3\\n"; exec sleep 60')
    with pytest.raises(KeyboardInterrupt):
        run_deck(deck, simulator=stubborn, on_step=stop)
    with pytest.raises(ProcessLookupError):
        os.kill(int((tmp_path / "pid").read_text()), 0)
    assert read_run(tmp_path) is None


def test_the_record_says_which_simulator_ran(deck: Path, tmp_path: Path) -> None:
    simulator = program(tmp_path / "sim", "exit 0")
    assert run_deck(deck, simulator=simulator).simulator == str(tmp_path / "sim")
    assert read_run(tmp_path).simulator == str(tmp_path / "sim")
    preloaded = Simulator(simulator.executable, preload=Path("libm.so.6"))
    assert run_deck(deck, simulator=preloaded).simulator == f"LD_PRELOAD=libm.so.6 {tmp_path / 'sim'}"
    record = tmp_path / RECORD
    record.write_text("".join(line for line in record.read_text().splitlines() if "simulator" not in line).replace(",}", "}"))
    assert read_run(tmp_path).simulator is None


@pytest.mark.parametrize("damage", ['{"status": "complete"}', "{", "[]", '{"status": "running", "deck": "in.deck"}'])
def test_damaged_record_counts_as_no_run(deck: Path, tmp_path: Path, damage: str) -> None:
    (tmp_path / RECORD).write_text(damage)
    assert read_run(tmp_path) is None


def test_failed_run_takes_away_the_record_of_the_run_before(deck: Path, tmp_path: Path) -> None:
    run = run_deck(deck, simulator=program(tmp_path / "sim", "exit 0"))
    assert read_run(tmp_path) == run
    with pytest.raises(RunError, match="exit status 7"):
        run_deck(deck, simulator=program(tmp_path / "sim", "exit 7"))
    assert read_run(tmp_path) is None


@pytest.mark.liggghts
@pytest.mark.parametrize("ranks", [1, 2])
def test_whole_run_is_recorded_and_found_again_until_the_deck_changes(
    spheres_deck: Callable[..., Path], liggghts: Simulator, ranks: int
) -> None:
    deck = spheres_deck("run 20", "run 30")
    run = run_deck(deck, ranks=ranks, simulator=liggghts)
    assert (run.steps, run.exit_status, run.ranks) == (50, 0, ranks)
    assert 0 < run.loop_time < run.wall_time
    assert "Loop time" in run.log.read_text()
    assert read_run(deck.parent) == run
    deck.write_text(deck.read_text() + "run 3\n")
    assert read_run(deck.parent) is None


@pytest.mark.liggghts
@pytest.mark.parametrize("ranks", [1, 2])
def test_error_of_the_deck_is_shown_with_deck_status_and_log(
    spheres_deck: Callable[..., Path], liggghts: Simulator, ranks: int
) -> None:
    deck = spheres_deck("run 5", "fix nonsense all no/such/style")
    with pytest.raises(RunError, match="exit status 1\n") as caught:
        run_deck(deck, ranks=ranks, simulator=liggghts)
    message = str(caught.value)
    assert message.startswith(f"{deck}: ")
    assert message.count("ERROR: Invalid fix style") >= 1
    assert "fix nonsense all no/such/style" in message
    assert message.endswith(f"whole log: {deck.parent / 'log.liggghts'}")
    assert read_run(deck.parent) is None


@pytest.mark.liggghts
@pytest.mark.parametrize("ranks", [1, 2])
def test_lost_atoms_fail_the_run(spheres_deck: Callable[..., Path], liggghts: Simulator, ranks: int) -> None:
    deck = spheres_deck("thermo_modify lost warn", "velocity all set 90.0 0.0 0.0", "run 300")
    with pytest.raises(RunError, match="Lost atoms"):
        run_deck(deck, ranks=ranks, simulator=liggghts)


def processes_of(deck: Path) -> list[str]:
    """Command lines of the processes that still run the deck."""
    listing = subprocess.run(["ps", "-eo", "pid,stat,args"], capture_output=True, text=True, check=True).stdout
    return [line for line in listing.splitlines() if f"-in {deck.name}" in line and " Z" not in line]


@pytest.mark.liggghts
@pytest.mark.parametrize("ranks", [1, 2])
def test_interrupted_run_leaves_no_process_and_no_record_and_can_be_run_again(
    spheres_deck: Callable[..., Path], liggghts: Simulator, ranks: int
) -> None:
    deck = spheres_deck("thermo 1000", "run 200000000")
    deck = deck.rename(deck.with_name(f"in.interrupted{os.getpid()}_{ranks}"))
    script = f"""
import sys
from pathlib import Path
from pyjkr.run import Simulator, run_deck
try:
    run_deck(Path({str(deck)!r}), ranks={ranks}, simulator=Simulator(Path({str(liggghts.executable)!r})))
except KeyboardInterrupt:
    sys.exit(130)
"""
    script_process = subprocess.Popen([sys.executable, "-c", script], cwd=Path(__file__).parents[1])
    deadline = time.monotonic() + SOON
    while not processes_of(deck) and time.monotonic() < deadline:
        time.sleep(0.05)
    time.sleep(IN_FULL_SWING)
    assert processes_of(deck)
    script_process.send_signal(signal.SIGINT)
    assert script_process.wait(SOON) == 130
    assert processes_of(deck) == []
    assert read_run(deck.parent) is None
    deck.write_text(deck.read_text().replace("run 200000000", "run 70"))
    assert run_deck(deck, ranks=ranks, simulator=liggghts).steps == 70
    assert read_run(deck.parent) is not None


@pytest.mark.liggghts
def test_liggghts_that_others_tell_to_stop_does_not_count_as_done(
    spheres_deck: Callable[..., Path], liggghts: Simulator, tmp_path: Path
) -> None:
    deck = spheres_deck("thermo 1000", "run 200000000")
    # The shell hands over to LIGGGHTS, which keeps its number.
    stopped = program(tmp_path / "sim", f'(sleep {IN_FULL_SWING}; kill -TERM $$) & exec {liggghts.executable} "$@"')
    with pytest.raises(RunError, match="exit status 0, but stopped by a signal"):
        run_deck(deck, simulator=stopped)


def test_more_ranks_than_a_machine_bears_are_refused_before_any_starts(tmp_path):
    deck = tmp_path / "in.deck"
    deck.write_text("units si\n")
    with pytest.raises(RunError, match=r"ranks = 100000 is more than 8 a core of this machine \(\d+\). Ask for fewer."):
        run_deck(deck, ranks=100_000, simulator=Simulator(Path("/bin/true")))
