"""Sweeps: every trial leaves a record, whatever becomes of its process, its worker or the sweep itself."""

import ctypes
import errno
import json
import os
import signal
import subprocess
import sys
import time
from contextlib import ExitStack
from pathlib import Path

import pytest
from made_missions import made_robot

from mr_experiments.bench.bench_speed import dask_cluster
from mr_experiments.sweep import dask_cluster as cluster_module
from mr_experiments.sweep import trial_process
from mr_experiments.sweep.dask_cluster import ClusterLostError, DaskCluster
from mr_experiments.sweep.run_command import LOST, main
from mr_experiments.sweep.sweep import Done, LocalPool, remove_failed, split_done
from mr_experiments.sweep.trial_process import failed_record, record_path
from mr_experiments.trial.trial import Trial, TrialError
from mr_measures.record.files import document_of, read_record, write_record
from mr_measures.record.mission_record import Asked, Measured, MissionRecord, Outcome, Team


def trial_of(seed, limit=1.0, **options):
    return Trial("small8x8", 1, seed, limit=limit, **options)


TRIALS = [trial_of(seed) for seed in (1, 2, 3)]


def recorded(folder, trial):
    return json.loads(record_path(folder, trial).read_text())


def without_measured(record):
    return {key: value for key, value in record.items() if key != "measured"}


@pytest.fixture
def fake_mission(monkeypatch):
    """Trials with these seeds do this instead of a mission; the others leave a record at once."""

    def install(deeds):
        def run(trial, _, progress):
            progress(12.5)
            return deeds.get(trial.seed, int)() or failed_record(trial, "made by the test")

        monkeypatch.setattr(trial_process, "run_trial", run)

    return install


# On this computer.


def test_every_trial_leaves_its_record(tmp_path):
    done = list(LocalPool(2).run(TRIALS[:2], tmp_path))
    assert {entry.trial.seed for entry in done} == {1, 2}
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(f"{trial.key}.json" for trial in TRIALS[:2])
    for entry in done:
        record = recorded(tmp_path, entry.trial)
        assert record["trial"] == json.loads(json.dumps(entry.trial.to_json()))
        assert entry == Done.of(entry.trial, read_record(record_path(tmp_path, entry.trial)))
        assert entry.status == "unfinished" and "limit of 1 s" in entry.reason


@pytest.mark.parametrize(
    "deed, reason",
    [
        (lambda: os.kill(os.getpid(), signal.SIGKILL), "ended by SIGKILL"),
        (lambda: os.abort(), "ended by SIGABRT"),
        (lambda: os._exit(7), "exit code 7"),
        (lambda: sys.exit(3), "exit code 3"),
        (lambda: 1 / 0, "ZeroDivisionError: division by zero"),
        (lambda: {"value": float("nan")}, "ValueError: Out of range float"),
    ],
    ids=["killed", "aborted", "_exit", "exit", "exception", "unwritable"],
)
def test_lost_process_is_a_failed_record_and_the_others_go_on(tmp_path, fake_mission, deed, reason):
    fake_mission({2: deed})
    done = {entry.trial.seed: entry for entry in LocalPool(1).run(TRIALS, tmp_path)}
    assert set(done) == {1, 2, 3}
    assert done[2].status == "failed" and reason in done[2].reason
    assert recorded(tmp_path, TRIALS[1])["outcome"]["reason"] == done[2].reason
    if "SIGABRT" in reason:
        assert "Fatal Python error: Aborted" in recorded(tmp_path, TRIALS[1])["outcome"]["traceback"]
    assert recorded(tmp_path, TRIALS[1])["outcome"]["time"] == 12.5
    assert done[1].reason == done[3].reason == "made by the test"


def test_a_folder_without_room_is_lost_and_its_missions_are_no_failures(short, fake_mission, monkeypatch, capsys):
    """They counted as crashes of an engine."""

    def no_room(record, path):
        raise OSError(errno.ENOSPC, "No space left on device")

    fake_mission({})
    monkeypatch.setattr(trial_process, "write_record", no_room)
    assert main([*short, "--trials", "1"]) == LOST
    told = capsys.readouterr().err
    assert "small8x8-r1-short-7-s1.json cannot be written: No space left on device" in told


def test_what_another_sweep_has_recorded_meanwhile_stays(tmp_path):
    """A sweep removed it when it began the trial, and lost it when it was stopped then."""
    path = record_path(tmp_path, TRIALS[0])
    for robots, outcome, stays in (
        ([made_robot()], Outcome("unfinished", 60.0), True),
        ([], Outcome("failed", 3.0), False),
    ):
        written = {f"robot_{number}": robot for number, robot in enumerate(robots)}
        write_record(MissionRecord(Asked(TRIALS[0].to_json()), outcome, robots=written), path)
        remove_failed(path)
        assert path.exists() == stays


def test_a_robot_that_starts_outside_the_walls_is_refused_before_its_mission(short, capsys):
    assert main([*short, "--starts", "100", "100", "0"]) == 2
    assert "start where nothing can be explored" in capsys.readouterr().err


def test_trial_that_stands_still_is_ended_and_says_where(tmp_path, fake_mission):
    def hang_in_compiled_code():
        ctypes.PyDLL(None).sleep(60)  # with Python's lock held

    fake_mission({2: hang_in_compiled_code})
    begun = time.monotonic()
    done = {entry.trial.seed: entry for entry in LocalPool(2, patience=1.0).run(TRIALS, tmp_path)}
    assert time.monotonic() - begun < 10.0
    assert done[2].status == "failed"
    assert done[2].reason == "made no progress for 1 s of real time and was ended"
    outcome = recorded(tmp_path, TRIALS[1])["outcome"]
    assert outcome["time"] == 12.5 and "hang_in_compiled_code" in outcome["traceback"]
    assert done[3].reason == "made by the test"


def test_progress_is_told_while_trials_run(tmp_path, fake_mission):
    fake_mission({1: lambda: time.sleep(1.5)})
    told = []
    list(LocalPool(2).run(TRIALS[:1], tmp_path, lambda running, trouble: told.append((running, trouble))))
    assert len(told) >= 3 and set(told) == {(1, "")}


def test_no_trial_outlives_a_pool_that_is_left(tmp_path, fake_mission):
    fake_mission({seed: lambda: time.sleep(60.0) for seed in (2, 3)})
    results = LocalPool(3).run(TRIALS, tmp_path)
    next(results)
    children = f"/proc/{os.getpid()}/task/{os.getpid()}/children"
    with open(children, encoding="ascii") as file:
        before = file.read().split()
    results.close()
    with open(children, encoding="ascii") as file:
        after = file.read().split()
    assert len(before) - len(after) == 2
    assert [path.name for path in tmp_path.iterdir()] == [f"{TRIALS[0].key}.json"]


# Going on where an earlier run was stopped.


def test_recorded_trials_are_not_run_again(tmp_path, fake_mission):
    fake_mission({})
    list(LocalPool(1).run(TRIALS[:2], tmp_path))
    left, done = split_done(TRIALS, tmp_path)
    assert left == [TRIALS[2]]
    assert [(entry.trial, entry.status) for entry in done] == [(TRIALS[0], "failed"), (TRIALS[1], "failed")]
    assert split_done(TRIALS, tmp_path, retry_failed=True) == (TRIALS, [])
    fake_mission({1: lambda: os._exit(7)})
    again = list(LocalPool(1).run(TRIALS[:1], tmp_path))
    assert "exit code 7" in again[0].reason


def test_records_of_other_code_are_told(short, tmp_path, capsys):
    short = [*short, "--trials", "1"]
    assert main(short) == 1
    assert "other code" not in capsys.readouterr().out
    for path in (tmp_path / "records").iterdir():
        record = json.loads(path.read_text())
        record["versions"]["code"] = "another"
        path.write_text(json.dumps(record))
    assert main(short) == 1
    assert "1 of them were made by other code or parameters" in capsys.readouterr().out


def broken(**values):
    return json.dumps({**document_of(failed_record(TRIALS[0], "x")), **values})


@pytest.mark.parametrize(
    "content, told",
    [
        ("", "cannot be read as JSON: Expecting value"),
        (broken()[:50], "cannot be read as JSON"),
        ("[1, 2]", "no record of a mission"),
        ("{}", "no record of a mission: it has no format number; choose another --out or remove it"),
        (broken(outcome={}), "damaged record: outcome.status is missing"),
        (broken(robots=[]), "damaged record: robots must be an object"),
        (broken(format=0), "format 0; this version reads formats 1 and 2; choose another --out"),
        (broken(trial=trial_of(1, limit=2.0).to_json()), "another trial .limit: 2.0, not 1.0.; choose another --out"),
        (broken(trial=5), "damaged record: trial must be an object"),
    ],
)
def test_file_of_something_else_is_told(tmp_path, content, told):
    path = record_path(tmp_path, TRIALS[0])
    path.write_text(content)
    with pytest.raises(TrialError, match=told) as error:
        split_done(TRIALS, tmp_path)
    assert str(path) in str(error.value) and "\n" not in str(error.value)


# The command.


@pytest.fixture
def short(tmp_path):
    path = tmp_path / "short.yaml"
    path.write_text("description: over soon\nworld: small8x8\nrobots: [1]\nlimit: 1.5\n")
    return ["--scenario", str(path), "--out", str(tmp_path / "records")]


@pytest.mark.parametrize(
    "options, told",
    [
        (["--scenario", "nothing"], "no scenario 'nothing'; there are"),
        (["--world", "nowhere"], 'no world "nowhere"'),
        (["--world", "a" * 300], 'no world "aaaa'),
        (["--robots", "99"], "asked for 99: ask for others with --robots"),
        (["--starts", "1", "2"], "--starts takes X Y DEGREES for each robot, not 2 numbers"),
        (["--starts", "1", "2", "0", "--robots", "2"], "gives 1 start pose; 2 robots are asked for"),
        (["--starts", "-0.1", "1", "0"], "starts inside a wall"),
        (["--robots", "0"], "at least one robot, not 0"),
        (["--robots", "two"], "argument --robots: invalid int value: 'two'"),
        (["--strategy", "12"], "strategy 12 is unknown; there are 0"),
        (["--strategy", "best"], "and those that EXPLORER_STRATEGIES=FILE.py:Class names"),
        (["--trials", "0"], "--trials 0 must be at least 1"),
        (["--jobs", "-1"], "--jobs -1 must be at least 1"),
        (["--seed", "-1"], "--seed -1 must be at least 0"),
        (["--seed", str(2**31)], "seeds must be below 2147483648"),
        (["--snapshots", "0"], "--snapshots 0 must be a positive number"),
        (["--snapshots", "nan"], "--snapshots nan must be a positive number"),
        (["--scheduler", "somewhere"], "--scheduler somewhere: expected tcp://HOST:PORT"),
        (["--scheduler", "tcp://host:port"], "expected tcp://HOST:PORT"),
        (["--out", "/dev/null/x"], "--out /dev/null/x: Not a directory"),
        (["--speed", "9"], "unrecognized arguments: --speed 9 (--help lists"),
    ],
)
def test_bad_option_is_told_in_one_line(short, capsys, options, told):
    assert main([*short, *options]) == 2
    captured = capsys.readouterr()
    assert told in captured.err and captured.err.startswith("run: ") and captured.err.count("\n") == 1
    assert captured.out == ""


def test_sweep_runs_goes_on_and_tells(short, tmp_path, capsys):
    assert main([*short, "--trials", "1", "--seed", "4"]) == 1
    assert "unfinished: limit of" in capsys.readouterr().out
    path = tmp_path / "records" / "small8x8-r1-short-7-s4.json"
    before = path.read_text()
    assert main([*short, "--trials", "2", "--seed", "4", "--robots", "1", "1"]) == 1
    told = capsys.readouterr().out
    assert "1 of 2 trials are recorded" in told and "s5: unfinished" in told and "s4:" not in told
    row = [line.split() for line in told.splitlines()][-2]
    assert row[:6] == ["1", "7", "2", "0", "2", "0"]
    assert path.read_text() == before
    assert len(list(path.parent.iterdir())) == 2


TWO = """
define rover position ( size [ 0.44 0.38 0.25 ] ranger ( sensor ( range [ 0 8 ] fov 270 samples 91 ) ) )
define wall model ( size [ 0.1 8 1 ] )
wall ( pose [ 4 0 0 0 ] ) wall ( pose [ -4 0 0 0 ] ) wall ( pose [ 0 4 0 90 ] ) wall ( pose [ 0 -4 0 90 ] )
rover ( pose [ 0 0 0 0 ] ) rover ( pose [ 0 1 0 0 ] )
"""


def test_teams_are_as_large_as_the_world_allows_unless_told(tmp_path, fake_mission, capsys):
    world, records = tmp_path / "two.world", tmp_path / "records"
    world.write_text(TWO)
    fake_mission({})
    call = ["--world", str(world), "--trials", "1", "--out", str(records)]
    assert main(call) == 1
    assert sorted(path.name[:6] for path in records.iterdir()) == ["two-r1", "two-r2"]
    assert f"run: {world} has starts for 2: teams of 1 and 2; give more with --starts" in capsys.readouterr().err
    assert main([*call, "--robots", "2", "3"]) == 2
    assert "two.world defines 2 robots; asked for 3: ask for others with --robots" in capsys.readouterr().err


@pytest.mark.parametrize("given", ["two.world", "./two.world", "link.world", "../{folder}/two.world", "{path}"])
def test_a_run_goes_on_however_its_world_is_named(tmp_path, fake_mission, capsys, monkeypatch, given):
    world = tmp_path / "two.world"
    world.write_text(TWO)
    (tmp_path / "link.world").symlink_to(world)
    monkeypatch.chdir(tmp_path)
    fake_mission({})
    call = ["--robots", "1", "--trials", "1", "--out", "records", "--world"]
    assert main([*call, "two.world"]) == 1
    before = (tmp_path / "records" / "two-r1-paper-7-s1.json").read_text()
    capsys.readouterr()
    assert main([*call, given.format(folder=tmp_path.name, path=world)]) == 1
    assert "1 of 1 trials are recorded" in capsys.readouterr().out
    assert [path.read_text() for path in (tmp_path / "records").iterdir()] == [before]


def test_a_run_of_before_worlds_had_one_name_goes_on(tmp_path, fake_mission, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("two.world").write_text(TWO)
    fake_mission({})
    call = ["--world", "two.world", "--robots", "1", "--trials", "1", "--out", "records"]
    assert main(call) == 1
    path = Path("records/two-r1-paper-7-s1.json")
    record = json.loads(path.read_text())
    record["trial"]["world"] = "./two.world"
    path.write_text(json.dumps(record))
    assert main(call) == 1
    assert "1 of 1 trials are recorded" in capsys.readouterr().out


def test_reasons_of_failed_trials_are_told_also_when_they_are_recorded_already(short, fake_mission, capsys):
    fake_mission({1: lambda: 1 / 0})
    assert main([*short, "--trials", "2"]) == 1
    capsys.readouterr()
    assert main([*short, "--trials", "2"]) == 1
    told = capsys.readouterr().out.splitlines()
    assert "1 failed, as small8x8-r1-short-7-s1: ZeroDivisionError: division by zero" in told
    assert "1 failed, as small8x8-r1-short-7-s2: made by the test" in told


def test_all_finished_is_zero(short, tmp_path, fake_mission, capsys):
    record = MissionRecord(
        Asked(trial_of(1).to_json()), Outcome("finished", 12.5), Team(12.5), {"robot_0": made_robot()},
        measured=Measured(real_time_factor=10.0),
    )  # fmt: skip
    fake_mission({1: lambda: record})
    assert main([*short, "--trials", "1"]) == 0
    assert "12.5 s  (10.0 x real time)" in capsys.readouterr().out


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_interruption_is_one_line_and_leaves_no_process(short, number):
    code = "import sys; from mr_experiments.sweep.run_command import main; sys.exit(main(sys.argv[1:]))"
    arguments = ["--robots", "4", "--trials", "4", "--jobs", "2", "--out", short[-1]]
    run = subprocess.Popen(
        [sys.executable, "-c", code, *arguments], stderr=subprocess.PIPE, text=True, start_new_session=True
    )
    assert wait_for(lambda: len(members(run.pid)) == 3)
    if number == signal.SIGINT:
        os.killpg(run.pid, number)  # as a terminal does
    else:
        run.send_signal(number)
    _, told = run.communicate(timeout=20.0)
    assert told == "run: interrupted; the same command goes on from here\n"
    assert run.returncode == 130
    assert members(run.pid) == []


def wait_for(condition, patience=30.0):
    deadline = time.monotonic() + patience
    while not condition() and time.monotonic() < deadline:
        time.sleep(0.1)
    return condition()


def members(session):
    """Live processes of a session."""
    listing = subprocess.run(["ps", "-o", "pid=,stat=", "-s", str(session)], capture_output=True, text=True)
    return [line for line in listing.stdout.splitlines() if "Z" not in line.split()[1]]


# On a Dask cluster.


def test_missing_dask_is_told(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(TrialError, match="apt-get install python3-distributed"):
        DaskCluster("tcp://127.0.0.1:1")


def test_silent_scheduler_is_told(monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr(cluster_module, "ANSWER_PATIENCE", 0.5)
    with pytest.raises(TrialError, match=r"--scheduler tcp://127.0.0.1:1: Timed out"):
        DaskCluster("tcp://127.0.0.1:1")


@pytest.fixture(scope="module")
def cluster():
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs=50
    ) as made:
        yield made


def test_killed_worker_loses_nothing(cluster, tmp_path):
    here, there = tmp_path / "here", tmp_path / "there"
    here.mkdir()
    there.mkdir()
    trials = [*(trial_of(seed) for seed in (1, 2, 3)), Trial("nowhere", 1, 1)]
    dask = DaskCluster(cluster.scheduler_address)
    told = []
    results = dask.run(trials, there, lambda running, trouble: told.append((running, trouble)))
    done = [next(results)]
    os.kill(cluster.workers[1].pid, signal.SIGKILL)
    done += results
    dask.close()
    assert {entry.trial.key for entry in done} == {trial.key for trial in trials} and len(done) == len(trials)
    assert told[0] == (2, "")
    list(LocalPool(2).run(trials, here))
    for trial in trials[:-1]:
        assert without_measured(recorded(there, trial)) == without_measured(recorded(here, trial))
        assert recorded(there, trial)["outcome"]["status"] == "unfinished"
    assert 'TrialError: no world "nowhere"' in recorded(there, trials[-1])["outcome"]["reason"]


def test_trial_that_stands_still_on_a_worker_is_ended(cluster, tmp_path):
    slow = Trial("large60x60", 3, 1)
    dask = DaskCluster(cluster.scheduler_address, patience=0.1)  # less than it takes to get ready
    done = list(dask.run([slow], tmp_path))
    dask.close()
    assert done[0].reason == "made no progress for 0.1 s of real time and was ended"
    outcome = recorded(tmp_path, slow)["outcome"]
    assert outcome["time"] == 0.0 and "Timeout" in outcome["traceback"] and "run_trial" in outcome["traceback"]


@pytest.mark.parametrize("killed", [False, True])
def test_lost_scheduler_and_missing_workers_are_told(tmp_path, capfd, killed):
    distributed = pytest.importorskip("distributed")
    with ExitStack() as stack:
        if killed:
            address = stack.enter_context(dask_cluster(workers=0))
        else:
            options = {"processes": True, "dashboard_address": None, "silence_logs": 50}
            address = stack.enter_context(distributed.LocalCluster(n_workers=0, **options)).scheduler_address
        dask = DaskCluster(address)
        told = []

        def tell(_, trouble):
            told.append(trouble)
            stack.close()

        with pytest.raises(ClusterLostError, match=rf"the scheduler {address} is lost \(.+\)"):
            list(dask.run(TRIALS, tmp_path, tell))
    dask.close()
    assert told[0] == f"{address} has no workers: waiting for one"
    assert list(tmp_path.iterdir()) == []
    if killed:
        assert capfd.readouterr().err == ""


def test_letting_go_of_a_silent_cluster_is_no_fault(cluster, monkeypatch):
    dask = DaskCluster(cluster.scheduler_address)
    close = dask._client.close

    def time_out(timeout):
        close()
        raise TimeoutError(f"timed out after {timeout:g} s.")

    monkeypatch.setattr(dask._client, "close", time_out)
    dask.close()
    assert dask._client.status == "closed"


def test_unfit_worker_is_told(cluster, tmp_path, monkeypatch):
    monkeypatch.setattr(cluster_module, "_CHILD", cluster_module._CHILD.replace("mr_experiments", "mr_nothing"))
    dask = DaskCluster(cluster.scheduler_address)
    with pytest.raises(ClusterLostError, match=r"cannot run trials \(\S+: ModuleNotFoundError: .*mr_nothing"):
        list(dask.run(TRIALS, tmp_path))
    dask.close()
    assert list(tmp_path.iterdir()) == []


def test_process_of_a_worker_ends_with_it(tmp_path):
    """So that the trial does not go on beside the one that replaces it."""
    code = (
        "import pickle; from mr_experiments.sweep.dask_cluster import remote_call;"
        "from mr_experiments.trial.trial import Trial;"
        "remote_call()(pickle.dumps((Trial('office26x15', 3, 1), float('inf'), 600.0)))"
    )
    worker = subprocess.Popen([sys.executable, "-c", code], start_new_session=True)
    assert wait_for(lambda: len(members(worker.pid)) == 2)
    pids = [line.split()[0] for line in members(worker.pid)]
    (child,) = (pid for pid in pids if pid != str(worker.pid))
    assert wait_for(lambda: "adhoc_engine" in Path(f"/proc/{child}/maps").read_text()), "it has not loaded its modules"
    worker.kill()
    worker.wait()
    assert wait_for(lambda: members(worker.pid) == [])
