"""Trials of many seeds in a few processes, of which any may be killed."""

import multiprocessing
import signal
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from typing import Callable, Dict, Iterator, List, Sequence

from .figures import Trial

SEEDS_OF_A_PROCESS = 100
"""A process ends after about so many pairs, and with it whatever memory it has piled up."""
MOST_DEATHS = 2
"""Deaths of processes on the same few seeds; a seed that kills every process is told, not tried for ever."""


def trials_of(seeds: Sequence[int], jobs: int, trial_of_seed: Callable[[int], Trial]) -> Iterator[Trial]:
    """The trials of the seeds as they are ready, `jobs` at a time. `trial_of_seed` must be a function of a module.

    A killed process costs the pairs that were under way, which are tried again. RuntimeError with their seeds if that
    happens repeatedly.
    """
    at_once = jobs * SEEDS_OF_A_PROCESS
    for first in range(0, len(seeds), at_once):
        missing = list(seeds[first : first + at_once])
        deaths = 0
        while missing:
            for trial in _until_broken(missing, jobs, trial_of_seed):
                missing.remove(trial.seed)
                deaths = 0
                yield trial
            deaths += bool(missing)
            if deaths > MOST_DEATHS:
                raise RuntimeError(f"the processes were killed {deaths} times over the seeds {missing[:jobs]}")


def _until_broken(seeds: Sequence[int], jobs: int, trial_of_seed: Callable[[int], Trial]) -> Iterator[Trial]:
    """Trials of the seeds until all are done or a process has died. Only a few wait in the pool, so it is known which
    ones kill."""
    waiting: List[int] = list(reversed(seeds))
    under_way: Dict[Future[Trial], int] = {}
    with ProcessPoolExecutor(jobs, initializer=_leave_interrupts_to_the_parent) as pool:
        try:
            while waiting or under_way:
                while waiting and len(under_way) < 2 * jobs:
                    seed = waiting.pop()
                    under_way[pool.submit(trial_of_seed, seed)] = seed
                done, _ = wait(under_way, return_when=FIRST_COMPLETED)
                for future in done:
                    del under_way[future]
                    yield future.result()
        except BrokenProcessPool:
            return
        except BaseException:
            # Nobody wants what is under way: without this the pool waits for it, and hangs if interrupted twice.
            for process in multiprocessing.active_children():
                process.kill()
            raise


def _leave_interrupts_to_the_parent() -> None:
    # Ctrl-C reaches all processes; the parent alone ends them.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
