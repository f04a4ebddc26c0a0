"""``make fuzz``: readers against mutated files, for as long as you like.

With atheris (``pip install atheris``) mutations are guided by the branches that they reach;
without it they are random. Either way a file that breaks a reader is written to the folder of
``--crashes`` and the run ends with its traceback.
"""

from __future__ import annotations

import argparse
import random
import sys
import time
import traceback
from pathlib import Path

SECONDS_A_FILE = 10.0


def main() -> None:
    """Parse the options and run."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--crashes", type=Path, default=Path("build/fuzz"))
    parser.add_argument("--plain", action="store_true", help="without atheris")
    options = parser.parse_args()
    try:
        import atheris
    except ImportError:
        atheris = None
    if atheris is None or options.plain:
        random_run(options)
    else:
        guided_run(options, atheris)


def guided_run(options: argparse.Namespace, atheris: object) -> None:
    """Atheris: the first byte of an input chooses the format."""
    with atheris.instrument_imports(include=["gaitsmith"]):
        from readers import SEEDS, WORDS, try_to_read
    suffixes = list(SEEDS)
    corpus = options.crashes / "corpus"
    corpus.mkdir(parents=True, exist_ok=True)
    for i, suffix in enumerate(suffixes):
        (corpus / f"good{suffix}").write_bytes(bytes([i]) + SEEDS[suffix])
    words = options.crashes / "words.dict"
    quoted = ("".join(f"\\x{byte:02x}" for byte in word) for word in WORDS if len(word) < 100)
    words.write_text("".join(f'"{word}"\n' for word in quoted))

    def one(data: bytes) -> None:
        if data:
            try_to_read(suffixes[data[0] % len(suffixes)], data[1:])

    arguments = [
        *(sys.argv[0], str(corpus), f"-max_total_time={options.seconds:.0f}"),
        *(f"-seed={options.seed + 1}", f"-timeout={SECONDS_A_FILE:.0f}", f"-dict={words}"),
        *("-rss_limit_mb=2048", "-max_len=20000", f"-artifact_prefix={options.crashes}/"),
        "-print_final_stats=1",
    ]
    atheris.Setup(arguments, one)
    atheris.Fuzz()


def random_run(options: argparse.Namespace) -> None:
    """Random cuts, doublings and words."""
    from readers import SEEDS, try_to_read

    rng = random.Random(options.seed)
    end, count, good = time.monotonic() + options.seconds, 0, 0
    while time.monotonic() < end:
        suffix = rng.choice(list(SEEDS))
        data = mutated(rng, SEEDS[suffix])
        start = time.monotonic()
        try:
            good += try_to_read(suffix, data)
            if time.monotonic() - start > SECONDS_A_FILE:
                raise TimeoutError(f"{time.monotonic() - start:.1f} s for {len(data)} bytes")
        except Exception:
            traceback.print_exc()
            options.crashes.mkdir(parents=True, exist_ok=True)
            path = options.crashes / f"crash-{options.seed}-{count}{suffix}"
            path.write_bytes(data)
            sys.exit(f"{path} broke its reader")
        count += 1
    print(f"{count} files, {good} of them readable, none broke a reader")


def mutated(rng: random.Random, data: bytes) -> bytes:
    """``data`` with one to six changes."""
    from readers import WORDS

    for _ in range(rng.randint(1, 6)):
        at, length = rng.randint(0, len(data)), rng.choice((0, 1, 1, 5, 20, 100))
        put = rng.choice(
            (
                b"",
                rng.choice(WORDS),
                bytes([rng.randrange(256)]),
                data[(start := rng.randint(0, len(data))) : start + rng.choice((5, 40, 400))],
                repr(rng.choice((rng.uniform(-1e3, 1e3), 10.0 ** rng.uniform(-320, 308)))).encode(),
            )
        )
        data = (data[:at] + put + data[at + length :])[:200_000]
    return data


if __name__ == "__main__":
    main()
