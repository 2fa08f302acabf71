#!/usr/bin/python3
"""Calls the program with files and flags that no user means: every command with
every bad file in every place, the others being good. Each line has ten seconds
and 1 GiB; it must end with a documented status, say why on standard error, one
line a message, and leave no result where the input was wrong.

Usage: hostile_lines.py PROGRAM [--every=N]   (N: only each Nth line)
"""

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time

SECONDS = 10
MEMORY = 1 << 30
DOCUMENTED = {0, 1, 2, 3}

ARM = """format: alidade-arm-1
name: two axes
units: {length: mm, angle: deg}
convention: standard
joints:
  - {type: revolute, theta: 0, d: 400, a: 25, alpha: -90, limits: [-170, 170]}
  - {type: revolute, theta: -90, d: 0, a: 455, alpha: 0, limits: [-190, 45]}
"""
JOB = """format: alidade-job-1
title: small
arm: arm.yaml
data: data.csv
parameters: [joints]
measurement: {sigma: {length: 0.1 mm}}
"""
ROWS = ["0,0,25,0,855", "10,-20,20,30,800", "30,-40,100,50,700",
        "-50,-60,200,-150,600", "70,-80,300,300,500", "90,10,1,2,3"]
DATA = "q1_deg,q2_deg,x_mm,y_mm,z_mm\n" + "\n".join(ROWS) + "\n"
CHAIN = 20000


def chain_urdf(kind):
    links = ["<robot name='r'><link name='l0'/>"]
    for k in range(CHAIN):
        links.append(
            f"<link name='l{k + 1}'/><joint name='j{k}' type='{kind}'>"
            f"<parent link='l{k}'/><child link='l{k + 1}'/>"
            "<axis xyz='0 0 1'/></joint>")
    return "".join(links) + "</robot>"


def write_bad(folder):
    """Files that are wrong, a kind each: their names."""
    texts = {
        "empty.yaml": b"",
        "blank.yaml": b" \n\n\t\n",
        "binary.yaml": bytes(range(256)) * 100,
        "zeros.yaml": bytes(100000),
        "latin1.yaml": ARM.replace("two axes", "zw\xf6lf").encode("latin1"),
        "utf16.yaml": ARM.encode("utf-16"),
        "escape.yaml": ARM.replace("two axes", '"a\\e[2Jb"').encode(),
        "null.yaml": ARM.replace("two axes", '"a\\0b"').encode(),
        "deep.yaml": b"a: " + b"[" * 50000,
        "dashes.yaml": b"  -\n" * 20000,
        "aliases.yaml": b"a: &a [x, x]\nb: [*a, *a]\n",
        "newline_key.yaml": b'format: alidade-arm-1\n"na\\nme\\x1b": 1\n',
        "long_line.yaml": b"format: " + b"x" * 3000000,
        "huge.yaml": ARM.replace("455", "1e308").encode(),
        "nan.yaml": ARM.replace("455", ".nan").encode(),
        "turned.yaml": ARM.replace("[-170, 170]", "[170, -170]").encode(),
        "no_joints.yaml": ARM.split("joints:")[0].encode() + b"joints: []\n",
        "many_joints.yaml": (ARM + 2000 * ARM.splitlines(True)[-1]).encode(),
        "other.yaml": b"format: alidade-nothing-7\n",
        "loop.yaml": b"format: alidade-job-1\nextends: loop.yaml\n",
        "itself.yaml": JOB.replace("arm.yaml", "itself.yaml").encode(),
        "chain.yaml": (ARM.split("convention")[0] +
                       "urdf: {file: chain.urdf}\n").encode(),
        "fixed.yaml": (ARM.split("convention")[0] +
                       "urdf: {file: fixed.urdf}\n").encode(),
        "chain.urdf": chain_urdf("revolute").encode(),
        "fixed.urdf": chain_urdf("fixed").encode(),
        "entities.urdf": b"<!DOCTYPE r [<!ENTITY a 'aaaa'>]><robot>&a;</robot>",
        "open.urdf": b"<robot><link name='a'>" * 5000,
        "empty.csv": b"",
        "header.csv": DATA.splitlines(True)[0].encode(),
        "ragged.csv": DATA.replace("0,0,25,0,855", "0,0").encode(),
        "words.csv": DATA.replace("800", "eight hundred").encode(),
        "nan.csv": DATA.replace("800", "nan").encode(),
        "infinite.csv": DATA.replace("800", "1e999").encode(),
        "wide.csv": b",".join(b"c%d" % k for k in range(100000)) + b"\n1\n",
        "long_cell.csv": DATA.encode() + b"1" * 2000000 + b",1,1,1,1\n",
        "quote.csv": DATA.encode() + b'"1,2,3\n' * 1000,
        "binary.csv": bytes(range(256)) * 100,
        "newline_header.csv": b'"q1\n\x1b[2J",q2_deg,x_mm,y_mm,z_mm\n1,2,3,4,5\n',
        "empty.npy": b"",
        "magic.npy": b"\x93NUMPY\x01\x00",
        "header.npy": b"\x93NUMPY\x01\x00\xff\xff" + b" " * 1000,
        "object.npy": b"\x93NUMPY\x01\x00\x76\x00{'descr': '|O', "
                      b"'fortran_order': False, 'shape': (3, 5)}" + b" " * 60,
        "large.npy": b"\x93NUMPY\x01\x00\x76\x00{'descr': '<f8', "
                     b"'fortran_order': False, 'shape': (9999999999999, 5)}" +
                     b" " * 47,
        "empty.json": b"",
        "deep.json": b"[" * 100000,
        "deep_old.json": b'{"format": "alidade-result-1", "a": ' +
                         b"[" * 100000 + b"]" * 100000 + b"}",
        "cut.json": b'{"format": "alidade-result-2", "arm": {"name": "x',
        "other.json": b'{"a": 1}',
        "numbers.json": b'{"format": "alidade-result-2", "verdict": 1e999}',
        "garbage.src": bytes(range(256)) * 50,
        "open.src": b"DEF X()\nPTP {X 1, Y 2\n" * 1000,
        "garbage.script": b"def f():\n movej([1,2,\n",
        "list.txt": b"nowhere.yaml\n\x00\n" + b"x" * 100000 + b"\n",
        "new\nline\x1b[2J.yaml": b"",
    }
    for name, content in texts.items():
        with open(os.path.join(folder, name), "wb") as file:
            file.write(content)
    names = list(texts)
    os.mkfifo(os.path.join(folder, "pipe.yaml"))
    os.symlink("loop2.csv", os.path.join(folder, "loop1.csv"))
    os.symlink("loop1.csv", os.path.join(folder, "loop2.csv"))
    os.mkdir(os.path.join(folder, "folder.csv"))
    for name in ["holes.csv", "holes.yaml", "holes.npy", "holes.json"]:
        with open(os.path.join(folder, name), "wb") as file:
            file.truncate(20 * 10**9)
        names.append(name)
    return names + ["pipe.yaml", "loop1.csv", "folder.csv", "/dev/zero",
                    "/dev/full", "nowhere.yaml", "x" * 5000, "", "."]


PLACES = [
    ["show", "{}"], ["show", "arm.yaml", "{}"], ["check", "{}"],
    ["check", "arm.yaml", "{}"], ["convert", "{}", "out.npy", "--arm=arm.yaml"],
    ["convert", "data.csv", "out/out.npy", "--arm={}"],
    ["import", "{}", "--arm=arm.yaml"], ["import", "data.csv", "--arm={}"],
    ["simulate", "{}"], ["plan", "{}"], ["identify", "{}"],
    ["identify", "arm.yaml", "{}"], ["calibrate", "{}"], ["compare", "{}"],
    ["montecarlo", "{}"], ["validate", "{}", "data.csv"],
    ["validate", "arm.yaml", "{}"], ["correct", "arm.yaml", "{}",
                                     "--nominal=arm.yaml"],
    ["correct", "arm.yaml", "data.csv", "--nominal={}"],
    ["export", "{}", "--as=json"], ["fk", "{}", "data.csv"],
    ["fk", "arm.yaml", "{}"], ["ik", "arm.yaml", "{}"], ["report", "{}"],
    ["batch", "{}"], ["batch", "--list={}"],
]
FLAGS = [
    ["--threads=0"], ["--threads=-1"], ["--threads=1e9"], ["--threads"],
    ["--memory=-5"], ["--memory=99999999999999999999"], ["--verbosity=7"],
    ["--seed=x"], ["--seed=-1"], ["--nosuch"], ["--nosuch=\x1b[2J\n"],
    ["--out="], ["--out=/dev/null/x"], ["--out=/proc/x"],
    ["--out=data.csv"], ["---"], ["--", "--"], ["-"], ["--help=maybe"],
    ["--=x"], ["--out=" + "y" * 5000],
]


def lines(bad):
    for place in PLACES:
        for name in bad:
            yield [part.format(name) for part in place]
    for flags in FLAGS:
        yield ["calibrate", "job.yaml"] + flags
        yield ["check", "arm.yaml"] + flags
    yield []
    yield [""]
    yield ["\x1b[2J"]
    yield ["calibrate"]
    yield ["calibrate"] + ["job.yaml"] * 3000


def limit():
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_FSIZE, (1 << 28, 1 << 28))


def faults(status, seconds, memory, error):
    found = []
    if status not in DOCUMENTED:
        found.append(f"status {status}")
    if seconds > SECONDS:
        found.append(f"{seconds:.0f} s")
    if memory > MEMORY:
        found.append(f"{memory >> 20} MiB")
    text = error.decode("utf-8", "replace")
    if "\ufffd" in text or any(ord(c) < 32 and c != "\n" for c in text):
        found.append("control characters on standard error")
    for word in ["internal error", "terminate called", "Sanitizer",
                 "basic_string", "vector::", "std::", "what():", "[json."]:
        if word in text:
            found.append(f'"{word}"')
    if status == 2 and not text.strip():
        found.append("no word why")
    return found


def run(program, line, folder):
    before = set(os.listdir(folder))
    began = time.monotonic()
    with tempfile.TemporaryFile() as errors:
        process = subprocess.Popen(
            [program] + line, cwd=folder, stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL, stderr=errors, preexec_fn=limit)
        while True:
            pid, status, usage = os.wait4(process.pid, os.WNOHANG)
            if pid:
                break
            if time.monotonic() - began > SECONDS + 1:
                process.kill()
            time.sleep(0.002)
        process.returncode = os.waitstatus_to_exitcode(status)
        errors.seek(0)
        error = errors.read()
    found = faults(process.returncode, time.monotonic() - began,
                   usage.ru_maxrss * 1024, error)
    new = set(os.listdir(folder)) - before
    if process.returncode == 2 and new - {"results"}:
        found.append(f"left {sorted(new)}")
    return found, process.returncode, error


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program", type=os.path.abspath)
    parser.add_argument("--every", type=int, default=1)
    arguments = parser.parse_args()
    failed = 0
    counts = {}
    with tempfile.TemporaryDirectory() as folder:
        for name, text in [("arm.yaml", ARM), ("job.yaml", JOB),
                           ("data.csv", DATA)]:
            with open(os.path.join(folder, name), "w") as file:
                file.write(text)
        chosen = list(lines(write_bad(folder)))[:: arguments.every]
        for line in chosen:
            found, status, error = run(arguments.program, line, folder)
            counts[status] = counts.get(status, 0) + 1
            if found:
                failed += 1
                shown = " ".join(part[:60] for part in line)[:160]
                print(f"{shown!r}: {', '.join(found)}: {error[:300]!r}")
    by_status = ", ".join(f"{count} of status {status}"
                          for status, count in sorted(counts.items()))
    print(f"{len(chosen)} command lines, {failed} wrong ({by_status})")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
