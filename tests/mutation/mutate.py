#!/usr/bin/python3
"""Mutation testing: changes one operator or number of a module at a time and
counts the changes that a test notices.

All mutants of a run are woven into one build (weave.py), where an environment
variable chooses one; a first run of the tests records which of them come across
which mutants, and only those run again with it: the module's own first, the
quickest of other modules' then. Everything is kept in build/mutation, where an
interrupted run goes on.

Usage: mutate.py [--seed=N] [--count=N] [--jobs=N] [--seconds=N] [--again]
                 [--tests=MODULES] [MODULE...]
  --seed=N     of the sample of mutants (default 1)
  --count=N    mutants a module, or all there are (default 200)
  --jobs=N     tests and compilers at once (default 2)
  --seconds=N  of other modules' tests a mutant, after its own module's
               (default 60)
  --again      runs the survivors of earlier runs once more
  --tests=MODULES
               only the tests of these modules, separated by commas
  MODULE       of src/ (default model kernel identifiability solve uncertainty)
"""

import argparse
import collections
import concurrent.futures
import hashlib
import json
import os
import random
import re
import subprocess
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import run_tests
import weave

ROOT = os.path.realpath(os.path.join(os.path.dirname(__file__), "../.."))
WORK = os.path.join(ROOT, "build/mutation")
SOURCE = os.path.join(WORK, "source")
BUILD = os.path.join(WORK, "build")
MODULES = ["model", "kernel", "identifiability", "solve", "uncertainty"]
# Tests of the program as a process say nothing of what they come across.
NOT_RUN = {"cli", "studies"}
# Of one module, for its range of numbers (kMostMutants of mutation.h).
MOST_SITES = 1 << 13

# One mutant: the site's place, its token before and after, its edits.
Mutant = collections.namedtuple(
    "Mutant", "module file line column end_line old new edits")


def key_of(mutant):
    return (f"{mutant.file}:{mutant.line}:{mutant.column}: "
            f"{mutant.old} -> {mutant.new}")


def read(path):
    with open(path, "rb") as file:
        return file.read()


def load(name, default):
    path = os.path.join(WORK, name)
    if not os.path.exists(path):
        return default
    return json.loads(read(path))


def save(name, value):
    path = os.path.join(WORK, name)
    with open(path + ".new", "w") as file:
        json.dump(value, file)
    os.replace(path + ".new", path)


def write_if_new(path, content):
    if os.path.exists(path) and read(path) == content:
        return False
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "wb") as file:
        file.write(content)
    return True


def module_digest(module):
    digest = hashlib.sha256()
    directory = os.path.join(ROOT, "src", module)
    for name in sorted(os.listdir(directory)):
        digest.update(read(os.path.join(directory, name)))
    digest.update(read(weave.__file__))
    return digest.hexdigest()


# ------------------------------------------------------------------ sites


def commands():
    path = os.path.join(BUILD, "compile_commands.json")
    return {os.path.relpath(entry["file"], SOURCE): entry["command"].split()
            for entry in json.loads(read(path))}


def collect_file(arguments):
    """The sites of one source and of the module's headers that it includes."""
    module, file, command = arguments
    import clang.cindex
    flags = [word.replace(SOURCE, ROOT) for word in command
             if re.match(r"-[ID]|-std", word)]
    system = [command[k + 1] for k, word in enumerate(command)
              if word == "-isystem"]
    for path in system:
        flags += ["-isystem", path]
    unit = clang.cindex.Index.create().parse(os.path.join(ROOT, file), flags)
    errors = [d for d in unit.diagnostics if d.severity >= d.Error]
    if errors:
        print(f"mutate: {file}: {errors[0]}", file=sys.stderr)
    collector = weave.Collector(ROOT, os.path.join("src", module),
                                clang.cindex)
    return list(collector.collect(unit).values())


def sites_of(module, jobs):
    digest = module_digest(module)
    kept = load(f"sites_{module}.json", {})
    if kept.get("digest") == digest:
        return [weave.Site(*site) for site in kept["sites"]]
    work = [(module, file, command) for file, command in commands().items()
            if file.startswith(f"src/{module}/") and file.endswith(".cc")]
    sites = {}
    with concurrent.futures.ProcessPoolExecutor(jobs) as pool:
        for found in pool.map(collect_file, sorted(work)):
            for site in found:
                sites[(site.file, site.line, site.column)] = site
    found = [sites[key] for key in sorted(sites)]
    save(f"sites_{module}.json", {"digest": digest, "sites": found})
    return found


def shuffled(module, sites, seed):
    """Every site once, in an order and with a change drawn from the seed."""
    engine = random.Random(f"{seed} {module}")
    mutants = []
    for site in sites:
        new = engine.choice(site.choices)
        mutants.append(Mutant(module, site.file, site.line, site.column,
                              site.end_line, site.old, new, site.forms[new]))
    engine.shuffle(mutants)
    return mutants


# --------------------------------------------------------------- building


def copy_tree(woven):
    """The files of the repository, those of `woven` with their mutants."""
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT, check=True, capture_output=True).stdout.decode()
    for name in filter(None, listed.split("\0")):
        path = os.path.join(ROOT, name)
        if not os.path.isfile(path):
            continue
        content = woven[name].encode() if name in woven else read(path)
        if name == "tests/CMakeLists.txt":
            content = content.replace(
                b"add_executable(${target} ${ARGN})",
                b"add_executable(${target} ${ARGN} mutation/recorder.cc)")
        if write_if_new(os.path.join(SOURCE, name), content):
            os.chmod(os.path.join(SOURCE, name), os.stat(path).st_mode)


def configure():
    if os.path.exists(os.path.join(BUILD, "build.ninja")):
        return
    copy_tree({})
    subprocess.run(
        ["cmake", "-S", SOURCE, "-B", BUILD, "-G", "Ninja",
         "-DCMAKE_BUILD_TYPE=Debug", "-DCMAKE_CXX_FLAGS_DEBUG=-O1",
         "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON", "-DALIDADE_BUILD_TESTS=ON",
         "-DALIDADE_BUILD_PYTHON=OFF"], check=True, stdout=subprocess.DEVNULL)


def weave_all(numbered):
    by_file = collections.defaultdict(list)
    for number, mutant in numbered.items():
        by_file[mutant.file].append((number, mutant.edits))
    return {file: weave.weave(read(os.path.join(ROOT, file)), mutants)
            for file, mutants in by_file.items()}


def blamed(output, numbered):
    """The mutants on lines that the compiler's errors name."""
    lines = collections.defaultdict(set)
    relevant = False
    context = []
    for line in output.splitlines():
        match = re.match(r"(?:In file included from |\s+from )?(\S+?):(\d+)",
                         line)
        if not match:
            continue
        place = (os.path.relpath(os.path.join(BUILD, match.group(1)), SOURCE),
                 int(match.group(2)))
        if "error:" in line:
            for file, number in context + [place]:
                lines[file].add(number)
            context = []
            relevant = True
        elif "required" in line or "In instantiation" in line:
            context.append(place)
            if relevant:
                lines[place[0]].add(place[1])
        elif "inlined from" in line or "called from here" in line:
            lines[place[0]].add(place[1])
        else:
            context = []
    return {number for number, mutant in numbered.items()
            if any(first_line(mutant) <= line <= mutant.end_line
                   for line in lines[mutant.file])}


def first_line(mutant):
    """Of the expression, which may begin above its operator."""
    begin = min(offset for offset, _, _ in mutant.edits)
    return read(os.path.join(ROOT, mutant.file)).count(b"\n", 0, begin) + 1


def check_syntax(arguments):
    file, command = arguments
    words = list(command)
    at = words.index("-o")
    del words[at:at + 2]
    words = words[words.index("/usr/bin/c++") if "/usr/bin/c++" in words
                  else 0:]
    done = subprocess.run(
        words + ["-fsyntax-only", "-w", "-Werror=vla", "-fno-diagnostics-color"],
        cwd=BUILD, capture_output=True, text=True)
    return file, done.returncode, done.stderr


class Weaver:
    """Draws mutants until `count` of each module compile, and builds them."""

    def __init__(self, modules, options):
        self.options = options
        self.drawn = {module: shuffled(module, sites_of(module, options.jobs),
                                       options.seed) for module in modules}
        self.dropped = set(load("dropped.json", []))
        self.clean = set(load("clean.json", []))

    def numbered(self):
        """The mutants of the sample by their numbers, which stay the same when
        others are dropped."""
        numbered = {}
        modules = sorted(os.listdir(os.path.join(ROOT, "src")))
        for module, mutants in self.drawn.items():
            first = (modules.index(module) + 1) * MOST_SITES
            good = [(first + k, mutant) for k, mutant in enumerate(mutants)
                    if key_of(mutant) not in self.dropped]
            numbered.update(good[:self.options.count])
        return numbered

    def drop(self, numbers, numbered, output):
        if not numbers:
            sys.exit("mutate: the woven sources do not compile:\n" + output)
        self.dropped |= {key_of(numbered[number]) for number in numbers}
        save("dropped.json", sorted(self.dropped))

    def draw(self):
        build(["cmake_pch"], self.options.jobs)
        while True:
            numbered = self.numbered()
            woven = weave_all(numbered)
            copy_tree(woven)
            todo = self.unchecked(numbered, woven)
            print(f"{len(numbered)} mutants, {len(todo)} sources to check",
                  file=sys.stderr)
            if not todo:
                return numbered
            bad, output = set(), ""
            with concurrent.futures.ThreadPoolExecutor(
                    self.options.jobs) as pool:
                for file, status, text in pool.map(check_syntax, todo):
                    if status == 0:
                        self.clean.add(self.stamp(file, woven))
                    else:
                        bad |= blamed(text, numbered)
                        output = text
            save("clean.json", sorted(self.clean))
            if output:
                self.drop(bad, numbered, output)

    def stamp(self, file, woven):
        """Of one source and the headers that it may include."""
        module = os.path.dirname(file)
        digest = hashlib.sha256(woven.get(file, "").encode())
        for name in sorted(woven):
            if name.startswith(module) and name.endswith(".h"):
                digest.update(woven[name].encode())
        return file + " " + digest.hexdigest()

    def unchecked(self, numbered, woven):
        modules = {mutant.module for mutant in numbered.values()}
        return [(file, command) for file, command in commands().items()
                if file.startswith("src/") and file.split("/")[1] in modules
                and self.stamp(file, woven) not in self.clean]

    def build(self, programs):
        while True:
            numbered = self.draw()
            done = build(programs, self.options.jobs)
            if done.returncode == 0:
                save("mutants.json", numbered)
                return numbered
            self.drop(blamed(done.stdout, numbered), numbered, done.stdout)


def build(targets, jobs):
    if targets == ["cmake_pch"]:
        listed = subprocess.run(["ninja", "-C", BUILD, "-t", "targets", "all"],
                                capture_output=True, text=True).stdout
        targets = re.findall(r"^(src/\S+cmake_pch.hxx.gch):", listed, re.M)
    return subprocess.run(
        ["ninja", "-C", BUILD, f"-j{jobs}", "-k0"] + targets,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


# ---------------------------------------------------------------- reports


def shown(mutant):
    """The source's line before and after, without its margin."""
    lines = read(os.path.join(ROOT, mutant.file)).decode().splitlines()
    before = lines[mutant.line - 1]
    at = mutant.column - 1
    after = before[:at] + mutant.new + before[at + len(mutant.old):]
    return before.strip(), after.strip()


def equivalents():
    """Of equivalent.txt: file, line before and after -> reason."""
    found = {}
    path = os.path.join(ROOT, "tests/mutation/equivalent.txt")
    paragraphs = re.split(r"\n\n+", read(path).decode())
    for paragraph in paragraphs:
        lines = paragraph.strip().splitlines()
        if lines and lines[0].startswith("src/"):
            found[(lines[0], lines[1][2:], lines[2][2:])] = " ".join(lines[3:])
    return found


def report(numbered, results, modules):
    known = equivalents()
    rows = ["| module | mutants | killed | of these by time | equivalent | "
            "survived | not reached | score |", "|---|---|---|---|---|---|---|---|"]
    texts = []
    for module in modules:
        counts = collections.Counter()
        by_time = 0
        for mutant in numbered.values():
            if mutant.module != module:
                continue
            status = results[key_of(mutant)]["status"]
            before, after = shown(mutant)
            reason = known.get((mutant.file, before, after))
            if status != "killed":
                title = "equivalent" if reason else status
                texts.append(f"{mutant.file}:{mutant.line}: {title}\n"
                             f"- {before}\n+ {after}\n{reason or ''}")
                status = title
            counts[status] += 1
            by_time += results[key_of(mutant)]["by"].endswith(": timeout")
        total = sum(counts.values())
        real = total - counts["equivalent"]
        rows.append(
            f"| {module} | {total} | {counts['killed']} | {by_time} | "
            f"{counts['equivalent']} | {counts['survived']} | "
            f"{counts['not reached']} | "
            f"{100 * counts['killed'] / max(real, 1):.1f} % |")
    table = "\n".join(rows)
    with open(os.path.join(WORK, "survivors.txt"), "w") as file:
        file.write("\n\n".join(texts) + "\n")
    with open(os.path.join(WORK, "report.md"), "w") as file:
        file.write(table + "\n")
    print(table)


# ------------------------------------------------------------------- main


def parse():
    usage = __doc__[__doc__.index("Usage:"):].replace("mutate.py",
                                                      "scripts/mutate")
    parser = argparse.ArgumentParser(usage=usage[len("Usage: "):],
                                     add_help=False)
    for name, default in [("seed", 1), ("count", 200), ("jobs", 2),
                          ("seconds", 60)]:
        parser.add_argument(f"--{name}", type=int, default=default)
    parser.add_argument("--again", action="store_true")
    parser.add_argument("--tests", default="")
    parser.add_argument("modules", nargs="*", metavar="MODULE")
    options = parser.parse_args()
    for module in options.modules:
        if not os.path.isdir(os.path.join(ROOT, "src", module)):
            parser.error(f"no module '{module}'")
    return options


def main():
    options = parse()
    modules = options.modules or MODULES
    os.makedirs(WORK, exist_ok=True)
    configure()
    text = read(os.path.join(ROOT, "tests/CMakeLists.txt")).decode()
    tested = [module for module in
              re.findall(r"^alidade_test\((\w+)", text, re.M)
              if module not in NOT_RUN and
              (not options.tests or module in options.tests.split(","))]
    numbered = Weaver(modules, options).build(
        [f"{module}_test" for module in tested])
    tests = run_tests.record(BUILD, tested, options.jobs)
    results = run_tests.Results(os.path.join(WORK, "results.jsonl"))
    stamp = {module: module_digest(module)[:12] for module in modules}
    known = equivalents()
    todo = {}
    for number, mutant in numbered.items():
        old = results.get(key_of(mutant), stamp[mutant.module])
        is_open = old is None or (options.again and old["status"] != "killed"
                                  and (mutant.file, *shown(mutant)) not in known)
        if is_open:
            todo[number] = mutant
    run_tests.run_all(BUILD, tests, todo, options, results,
                      lambda m: (key_of(m), stamp[m.module]))
    report(numbered, results.of(stamp.values()), modules)


if __name__ == "__main__":
    main()
