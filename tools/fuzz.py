"""Coverage-guided fuzzing of `fuzz/`: builds the targets by the stable compiler and runs each.

    python tools/fuzz.py [TARGET ...] [--seconds 60] [--jobs 2]

Needs a C++ compiler, for libFuzzer. Begins with the texts of `fuzz/corpus/TARGET` and of the
repository; what is new goes to `out/fuzz/TARGET`, what ends a target is kept there as `crash-*`,
`oom-*` or `timeout-*`, and the exit status is 1.
"""

from __future__ import annotations

import argparse
import concurrent.futures
import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

#: LLVM's counters of edges, comparisons and the assertions of a development build.
FLAGS = [
    "-Cpasses=sancov-module",
    "-Cllvm-args=-sanitizer-coverage-level=4",
    "-Cllvm-args=-sanitizer-coverage-inline-8bit-counters",
    "-Cllvm-args=-sanitizer-coverage-pc-table",
    "-Cllvm-args=-sanitizer-coverage-trace-compares",
    "-Cdebug-assertions",
    "--cfg",
    "fuzzing",
]

#: What each target begins with, by the endings of files of the repository; and its dictionary.
SEEDS = {
    "document": ("*.sdl", "sdl"),
    "engine_messages": ("", "messages"),
    "lsp_frames": ("", "messages"),
    "expressions": ("", "sdl"),
    "model_file": ("*.ms2", "sdl"),
    "readers": ("*.dat", ""),
    "sdl_format": ("*.sdl", "sdl"),
    "sdl_parse": ("*.sdl", "sdl"),
    "sdl_run": ("*.sdl", "sdl"),
    "sketch": ("*.skt", "sketch"),
}


def words() -> str:
    """The dictionary of programs: kinds, fields, functions, words of the language."""
    from moldloft.language import reference

    found: set[str] = set()
    for row in reference():
        found.add(row["name"])
        found |= {field["name"] for field in row["fields"]}
    return "".join(f'"{word}"\n' for word in sorted(found) if '"' not in word)


def built(triple: str) -> Path:
    """Builds all targets; the folder of the programs."""
    target = ROOT / "target" / "fuzz"
    environment = dict(os.environ)
    environment["RUSTFLAGS"] = " ".join(FLAGS)
    environment["CARGO_TARGET_DIR"] = str(target)
    # The counters cost more than optimisation gains beyond the first level.
    environment["CARGO_PROFILE_RELEASE_OPT_LEVEL"] = "1"
    environment["CARGO_PROFILE_RELEASE_LTO"] = "off"
    command = ["cargo", "build", "--release", "--quiet", "--target", triple]
    subprocess.run(command, cwd=ROOT / "fuzz", env=environment, check=True)
    return target / triple / "release"


def run(name: str, folder: Path, seconds: int) -> tuple[str, int, str]:
    """Runs one target; name, exit status, the last lines."""
    out = ROOT / "out" / "fuzz" / name
    out.mkdir(parents=True, exist_ok=True)
    seeds = out.parent / f"{name}.seeds"
    shutil.rmtree(seeds, ignore_errors=True)
    seeds.mkdir()
    pattern, dictionary = SEEDS[name]
    sources = [
        path for base in ("examples", "tests/corpus") for path in (ROOT / base).rglob(pattern)
    ]
    for number, path in enumerate(sources if pattern else []):
        if path.is_file() and path.stat().st_size <= 16_384:
            shutil.copy(path, seeds / f"{number}-{path.name}")
    command = [str(folder / name), str(out), str(seeds), str(ROOT / "fuzz" / "corpus" / name)]
    if dictionary == "sdl":
        path = out.parent / "sdl.dict"
        path.write_text(words(), encoding="utf-8")
        command.append(f"-dict={path}")
    elif dictionary:
        command.append(f"-dict={ROOT / 'fuzz' / 'dictionaries' / f'{dictionary}.dict'}")
    command += [
        f"-max_total_time={seconds}",
        f"-artifact_prefix={out}/",
        "-rss_limit_mb=2048",
        "-malloc_limit_mb=1024",
        "-timeout=10",
        "-max_len=16384",
        "-print_final_stats=1",
    ]
    done = subprocess.run(command, capture_output=True, text=True, errors="replace", check=False)
    return name, done.returncode, "\n".join(done.stderr.splitlines()[-12:])


def main() -> int:
    """Runs the targets that are named, or all."""
    parser = argparse.ArgumentParser(description="coverage-guided fuzzing of the targets in fuzz/")
    parser.add_argument("targets", nargs="*", metavar="TARGET", choices=[*SEEDS, []])
    parser.add_argument("--seconds", type=int, default=60, help="time of each target (default 60)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="targets at once")
    options = parser.parse_args()
    host = subprocess.run(["rustc", "-vV"], capture_output=True, text=True, check=True).stdout
    triple = next(line.split()[1] for line in host.splitlines() if line.startswith("host:"))
    folder = built(triple)
    failed = 0
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        runs = [pool.submit(run, n, folder, options.seconds) for n in options.targets or SEEDS]
        for future in concurrent.futures.as_completed(runs):
            name, status, last = future.result()
            print(
                f"{name}: {'no fault' if status == 0 else f'status {status}'}\n{last}\n", flush=True
            )
            failed |= status != 0
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
