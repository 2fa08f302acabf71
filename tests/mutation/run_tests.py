"""Runs the woven test programs: once to record what each test comes across, and
then a few tests for each mutant until one fails."""

import collections
import concurrent.futures
import json
import math
import os
import re
import resource
import signal
import subprocess
import sys
import tempfile
import threading
import time

# A mutant may ask for any memory and write any file; mapped_file_test makes a
# sparse one of 20 GB.
MEMORY = 6 << 30
FILE_SIZE = 20 << 30
# Tests of a program that run together: those that take seconds come after
# those that take less.
QUICK = 1.0

Test = collections.namedtuple("Test", "module name seconds reached")


class Results:
    """What became of each mutant, a line each in a file that only grows."""

    def __init__(self, path):
        self.path = path
        self.lock = threading.Lock()
        self.entries = {}
        if os.path.exists(path):
            with open(path) as file:
                for line in file:
                    entry = json.loads(line)
                    self.entries[(entry["key"], entry["stamp"])] = entry

    def get(self, key, stamp):
        return self.entries.get((key, stamp))

    def add(self, entry):
        with self.lock, open(self.path, "a") as file:
            self.entries[(entry["key"], entry["stamp"])] = entry
            file.write(json.dumps(entry) + "\n")

    def of(self, stamps):
        stamps = set(stamps)
        return {key: entry for (key, stamp), entry in self.entries.items()
                if stamp in stamps}


def run(program, directory, environment, seconds):
    """Status and output of a program, killed with its children after so much
    time of a processor, which a busy machine does not shorten: status None."""
    most = None if seconds is None else math.ceil(seconds)

    def limit():
        if most is not None:
            resource.setrlimit(resource.RLIMIT_CPU, (most, most))
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        resource.setrlimit(resource.RLIMIT_FSIZE, (FILE_SIZE, FILE_SIZE))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

    with tempfile.TemporaryDirectory() as scratch, tempfile.TemporaryFile() as (
            output):
        process = subprocess.Popen(
            [program, "--gtest_brief=1"], cwd=directory, stdout=output,
            stderr=subprocess.STDOUT, start_new_session=True,
            preexec_fn=limit,
            env={**os.environ, "TMPDIR": scratch, **environment})
        try:
            # One that waits takes no time of a processor.
            status = process.wait(None if most is None else 60 + 20 * most)
            if -status in (signal.SIGXCPU, signal.SIGKILL):
                status = None
        except subprocess.TimeoutExpired:
            status = None
        finally:
            try:
                os.killpg(process.pid, 9)
            except ProcessLookupError:
                pass
            process.wait()
        output.seek(0)
        return status, output.read(1 << 20).decode(errors="replace")


def record_one(build, module):
    path = os.path.join(build, f"{module}.reached")
    program = os.path.join(build, "tests", f"{module}_test")
    stamp = str(os.stat(program).st_mtime_ns)
    if os.path.exists(path):
        with open(path) as file:
            if file.readline().strip() == stamp:
                return path
    with open(path + ".new", "w") as file:
        file.write(stamp + "\n")
    status, output = run(program, build,
                         {"ALIDADE_MUTANTS_REACHED": path + ".new"}, None)
    if status not in (0, 1):
        sys.exit(f"mutate: without a mutant, {program} ended with status "
                 f"{status}:\n{output[-2000:]}")
    os.replace(path + ".new", path)
    return path


def record(build, modules, jobs):
    """All tests that pass without mutants, with what they come across."""
    tests = []
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        paths = list(pool.map(lambda module: record_one(build, module),
                              modules))
    for module, path in zip(modules, paths):
        with open(path) as file:
            for line in file.read().splitlines()[1:]:
                name, milliseconds, passed, reached = line.split("\t")
                if passed == "1":
                    tests.append(Test(module, name, int(milliseconds) / 1e3,
                                      frozenset(map(int, reached.split()))))
                else:
                    print(f"mutate: {name} fails without a mutant")
    return tests


def batches(number, module, tests, seconds):
    """The tests that reach a mutant: its own module's, then, as far as
    `seconds` go, the quickest of others. Those of a program run together."""
    reaching = sorted((test for test in tests if number in test.reached),
                      key=lambda test: test.seconds)
    groups = collections.OrderedDict()
    spent = 0.0
    for test in reaching:
        if test.module == module:
            is_slow = test.seconds > QUICK
            groups.setdefault((0, is_slow, module), []).append(test)
    for test in reaching:
        if test.module != module:
            spent += test.seconds
            if spent <= seconds:
                is_slow = test.seconds > QUICK
                groups.setdefault((1, is_slow, test.module), []).append(test)
    return [groups[key] for key in sorted(
        groups, key=lambda key: (key[:2], sum(t.seconds for t in groups[key])))]


def outcome(build, tests, number, module, seconds):
    """killed, survived or not reached; by which test; and after how long."""
    status = "not reached"
    begun = time.time()
    for batch in batches(number, module, tests, seconds):
        status = "survived"
        normal = sum(test.seconds for test in batch)
        program = os.path.join(build, "tests", f"{batch[0].module}_test")
        code, output = run(
            program, build,
            {"ALIDADE_MUTANT": str(number), "GTEST_FAIL_FAST": "1",
             "GTEST_FILTER": ":".join(test.name for test in batch)},
            2.0 + 5.0 * normal)
        if code != 0:
            failed = re.search(r"\[  FAILED  \] ([^\s,]+)", output)
            by = ("timeout" if code is None else
                  f"status {code}" if not failed else failed.group(1))
            return {"status": "killed", "by": f"{batch[0].module}: {by}",
                    "seconds": round(time.time() - begun, 2)}
    return {"status": status, "by": "",
            "seconds": round(time.time() - begun, 2)}


def run_all(build, tests, todo, options, results, identify):
    begun = time.time()
    done = 0

    def one(item):
        nonlocal done
        number, mutant = item
        found = outcome(build, tests, number, mutant.module, options.seconds)
        key, stamp = identify(mutant)
        results.add({"key": key, "stamp": stamp, **found})
        done += 1
        if done % 50 == 0:
            print(f"{done} of {len(todo)} mutants, "
                  f"{time.time() - begun:.0f} s", flush=True)

    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        list(pool.map(one, todo.items()))
