"""Files made to cost the kernel as much as possible.

    python -m tests.campaigns.hostile_files [--size BYTES] [KIND ...]

For every kind of file the kernel runs alone. Printed are what it says, its processor time and its largest memory. Exit
code 1 where it ends without a verdict or a refusal, or takes more than 10 s or 600 MB for 36 MB.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from tests.verify.certificate_documents import Document, harmonics, single

KERNEL = Path(__file__).parents[2] / "verify" / "kernel.py"
SIZE = 36_000_000  # bytes
SECONDS, MEGABYTES = 10.0, 600.0  # for a file of that size
STARTING = 0.3, 20.0  # what Python itself takes, s and MB

# The largest memory of this program alone: what getrusage says of a child counts the parent's before it began.
PROGRAM = """
import re, resource, runpy, sys
sys.argv = sys.argv[1:]
try:
    runpy.run_path(sys.argv[0], run_name="__main__")
finally:
    used = resource.getrusage(resource.RUSAGE_SELF)
    with open("/proc/self/status") as status:
        largest = int(re.search(r"VmHWM:\\s+(\\d+)", status.read())[1]) / 1024
    print("\\nUSED", used.ru_utime + used.ru_stime, largest)
"""


def repeated(text: str, count: int) -> str:
    return " ".join([text] * count)


def counted(count: int) -> str:
    return " ".join(map(str, range(count)))


def with_number(number: str) -> str:
    """The certificate with other characters where psi_bar is."""
    return json.dumps(single()).replace('"psi_bar": "1"', f'"psi_bar": {number}', 1)


def with_fleet(**change: Any) -> str:
    content = single()
    content["fleet"].update(change)
    return json.dumps(content)


PARAMETERS = ("mass", "inertia", "half_track", "wheel_radius", "torque_left", "torque_right")


def many_vehicles(count: int, value: str, **more: str) -> Document:
    """A certificate of vehicles that are all alike, each led."""
    content = single()
    fleet, gains = content["fleet"], content["gains"]
    fleet |= {"vehicles": count, **dict.fromkeys(PARAMETERS, repeated(value, count))}
    fleet |= dict.fromkeys(("offset_x", "offset_y", "wheel_inertia"), repeated("0", count))
    fleet["leader_links"] = {"vehicle": counted(count), "weight": repeated(value, count)}
    for name in gains:
        gains[name] = value if name in ("position_scale", "heading_scale") else repeated(more.get(name, value), count)
    content["tree"] = {"link": repeated("-1", count), "depth": repeated("0", count)}
    content["margins"] = {"(16*)": repeated("0", count)}
    return content


def with_edges(vehicles: int, tail: str, head: str, weight: str) -> str:
    content = many_vehicles(vehicles, "9")
    content["fleet"]["edges"] = {"tail": tail, "head": head, "weight": weight}
    return json.dumps(content)


def with_rates(content: Document, entry: str) -> Document:
    for name in ("gamma_v", "gamma_omega"):
        content["rates"][name] = {"rate": "0.001", "vector": repeated(entry, content["fleet"]["vehicles"])}
    return content


def true_vehicles(count: int, torque: str = "9999999", **more: str) -> Document:
    """Vehicles for which all conditions are true."""
    content = many_vehicles(count, "9", **more)
    content["fleet"] |= dict.fromkeys(("torque_left", "torque_right"), repeated(torque, count))
    return content


def costly_arcs(content: Document) -> Document:
    """A psi of 200 harmonics, and as many arcs as may be checked, all of them true."""
    content["fleet"]["excitation"] = harmonics(repeated("0.001", 199) + " 0.002")
    return {**content, "arcs": dict.fromkeys(("here", "opposite"), repeated("11", 3800) + " " + repeated("10", 148))}


def all_vehicles(size: int) -> Document:
    """As many as fit, with two rates; in a large file with costly arcs as well."""
    content = with_rates(true_vehicles(size // 59), "1")
    return costly_arcs(content) if size >= SIZE else content


def long_numbers(size: int) -> Document:
    """One number of many places makes all the others long."""
    content = with_rates(true_vehicles(min(size // 190, 190_000)), "9" * 40)
    return {**content, "psi_bar": "1." + "0" * 99 + "1"}


def long_columns(size: int) -> Document:
    """As many numbers of three digits as fit, each made as long as it may be."""
    count = size // 150
    content, ends = many_vehicles(count, "300"), [repeated("300", count)] * 2
    content["fleet"] |= dict.fromkeys(("mass", "inertia", "half_track", "wheel_radius", "wheel_inertia"), ends)
    content["fleet"] |= dict.fromkeys(("offset_x", "offset_y"), ends[0])
    places = min(2 * 10**7 // count, 100)
    return {**content, "psi_bar": "1." + "0" * (places - 1) + "1"}


def all_limits(size: int) -> Document:
    """All vehicles with limits of speed, turn rate and wheel speed."""
    count = size // 125
    content = true_vehicles(count, "9999999999", d_v="9999999", d_omega="9999999")
    values = " ".join([str(100 + i % 900) for i in range(count)])
    for name in ("speed", "turn_rate", "wheel_speed"):
        content["fleet"]["limits"][name] = {"vehicle": counted(count), "value": values}
        content["margins"][name] = repeated("0", count)
    return {**content, "rim_speed": repeated("9", count)}


def close_limits(size: int) -> Document:
    """All vehicles with a speed limit whose margin leaves so little that tanh is needed in all its digits."""
    count = size // 115
    content = true_vehicles(count, "9999999999", d_v="9", p_v="1")
    content["fleet"]["leader_links"]["weight"] = repeated("1", count)
    content["fleet"]["limits"]["speed"] = {"vehicle": counted(count), "value": repeated("9", count)}
    content["margins"]["speed"] = repeated("5.4401338412287889", count)  # 9 tanh 1 - sqrt2 = 5.44013384122878894...
    return content


def all_links(size: int) -> Document:
    """As many links as fit, between few vehicles."""
    vehicles = max(int((size / 4) ** 0.5), 3)
    pairs = [(i, j) for i in range(vehicles) for j in range(i + 1, vehicles)][: size // 17]
    tail, head = (" ".join([str(pair[end]) for pair in pairs]) for end in (0, 1))
    weight = " ".join([str(i) for i in range(1, len(pairs) + 1)])
    content = many_vehicles(vehicles, "9")
    content["fleet"]["edges"] = {"tail": tail, "head": head, "weight": weight}
    return content


def one_hash(size: int) -> Document:
    """Numbers 1 + k (2^61 - 1), which all have one hash as Python integers."""
    count = size // 500
    column = " ".join([str(1 + k * (2**61 - 1)) for k in range(1, count + 1)])
    content = many_vehicles(count, "9")
    content["fleet"] |= dict.fromkeys(PARAMETERS, column)
    content["fleet"]["leader_links"]["weight"] = column
    content["gains"] |= {name: column for name in content["gains"] if not name.startswith(("position", "heading"))}
    content["fleet"]["limits"]["speed"] = {"vehicle": counted(count), "value": column}
    content["margins"]["speed"] = repeated("0", count)
    return content


class Kind(NamedTuple):
    """A way to cost much: a file of about so many bytes, and words of what the kernel says of it."""

    write: Callable[[int], str | Document]
    words: str


MANY_MARKS, NO_DECIMALS = "20000 quotes, commas, colons and brackets", "decimals of one form"
HOSTILE: dict[str, Kind] = {
    "deep lists": Kind(lambda n: '{"a":' + "[" * (n // 2) + "]" * (n // 2) + "}", MANY_MARKS),
    "deep tables": Kind(lambda n: '{"a":' * (n // 6) + "1" + "}" * (n // 6), MANY_MARKS),
    "deep and not finished": Kind(lambda n: "[" * n, MANY_MARKS),
    "just not too deep": Kind(lambda _: "[" * 20_000, "nested too deeply"),
    "an integer of many digits": Kind(lambda n: with_number("9" * n), "not JSON: Exceeds the limit"),
    "a decimal of many digits": Kind(lambda n: with_number('"0.' + "9" * n + '"'), "digits after the point"),
    "a number of many digits": Kind(lambda n: with_number('"' + "9" * n + '"'), NO_DECIMALS),
    "an exponent": Kind(lambda _: with_number("1e999999999"), NO_DECIMALS),
    "a negative exponent": Kind(lambda _: with_number("-1e-999999999"), NO_DECIMALS),
    "an exponent in a string": Kind(lambda _: with_number('"1e999999999"'), NO_DECIMALS),
    "one edge for ever": Kind(
        lambda n: with_edges(10_000, repeated("0", n // 4), repeated("1", n // 4), "1"), "edges must be in rising order"
    ),
    "more edges than pairs": Kind(
        lambda n: with_edges(2, *[repeated("1", n // 6)] * 3), "links between 2 vehicles are too many"
    ),
    "one column of edges": Kind(lambda n: with_edges(5000, repeated("300", n // 4 - 80_000), "", ""), NO_DECIMALS),
    "one column of vehicles": Kind(
        lambda n: with_fleet(vehicles=n // 4, offset_x=repeated("300", n // 4)), "offset: expected a string"
    ),
    "distinct keys": Kind(lambda n: "{" + ",".join([f'"{i:08}":"{i:030}"' for i in range(n // 45)]) + "}", MANY_MARKS),
    "one key for ever": Kind(lambda n: "{" + ",".join(['"a":1'] * (n // 6)) + "}", MANY_MARKS),
    "one key a thousand times": Kind(lambda _: "{" + ",".join(['"a":1'] * 1000) + "}", "a key is listed twice"),
    "unknown keys": Kind(lambda _: "{" + ",".join(f'"a{i}":1' for i in range(1000)) + "}", "certify again"),
    "vehicles without end": Kind(lambda _: with_fleet(vehicles=10**100), "vehicles with 1 digits"),
    "vehicles without columns": Kind(lambda _: with_fleet(vehicles=9_000_000), NO_DECIMALS),
    "harmonics without end": Kind(lambda n: with_fleet(excitation=harmonics(repeated("1", n // 2))), "at most 200"),
    "terms without end": Kind(
        lambda _: with_fleet(excitation={"family": "square-wave", "mean": "0", "frequency": "1", "terms": 10**100}),
        "terms must be 1 to 100",
    ),
    "arcs without end": Kind(
        lambda n: json.dumps(single(arcs=dict.fromkeys(("here", "opposite"), repeated("20", n // 6)))), "arcs"
    ),
    "all arcs that are checked": Kind(lambda _: costly_arcs(single()), "VALID"),
    "a string without end": Kind(lambda n: '{"a":"' + "x" * n, "not JSON"),
    "a long column": Kind(lambda n: with_fleet(mass=repeated("1", n // 2)), "mass: expected a string of 1 decimals"),
    "a long text": Kind(lambda n: with_fleet(drive="x" * n), "drive one of"),
    "a long schema": Kind(lambda n: json.dumps({"schema": "x" * n}), "certify again"),
    "much white space": Kind(lambda n: json.dumps(single()) + " " * n, "VALID"),
    "all vehicles that fit": Kind(all_vehicles, "VALID"),
    "long numbers": Kind(long_numbers, "VALID"),
    "long numbers in all columns": Kind(long_columns, "INVALID"),
    "limits for all": Kind(all_limits, "VALID"),
    "limits that are close for all": Kind(close_limits, ""),  # valid where the file is small
    "all links that fit": Kind(all_links, "INVALID"),
    "numbers of one hash": Kind(one_hash, "INVALID"),
}


class Cost(NamedTuple):
    """What the kernel says of a file, its processor time in s and its largest memory in MB."""

    said: str
    seconds: float
    megabytes: float
    behaved: bool  # it ends with the exit code of a verdict or a refusal, in a few words


def cost(kind: str, size: int, folder: Path) -> Cost:
    """Run the kernel on a file of this kind and about this size."""
    path = folder / "certificate.json"
    written = HOSTILE[kind].write(size)
    path.write_text(written if isinstance(written, str) else json.dumps(written))
    command = [sys.executable, "-I", "-c", PROGRAM, str(KERNEL), str(path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=1000)
    verdict, _, used = done.stdout.rpartition("USED")
    seconds, megabytes = map(float, used.split())
    said = (verdict + done.stderr).strip()
    code = {"VALID": 0, "INVALID": 1, "REFUSED": 2}.get(said.partition("\n")[0].partition(":")[0])
    short = len(done.stderr) < 1000 and len(verdict) < 5000 and "Traceback" not in done.stderr
    return Cost(said, seconds, megabytes, done.returncode == code and short and HOSTILE[kind].words in said)


def main() -> int:
    """Print a table. Returns 1 where a bound is passed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kinds", nargs="*", metavar="KIND", help="all where none is given")
    parser.add_argument("--size", type=int, default=SIZE, help="of the files, bytes")
    options = parser.parse_args()
    share, failed = options.size / SIZE, False
    print("| kind | the kernel says | s | MB |\n|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for kind in options.kinds or HOSTILE:
            found = cost(kind, options.size, Path(folder))
            within = found.seconds < SECONDS * share + STARTING[0] and found.megabytes < MEGABYTES * share + STARTING[1]
            failed |= not (within and found.behaved)
            word = found.said.partition("\n")[0][:80].replace("|", "\\|")
            note = "" if within and found.behaved else " NOT WITHIN BOUNDS" if found.behaved else " NOT AS EXPECTED"
            print(f"| {kind} | {word}{note} | {found.seconds:.1f} | {found.megabytes:.0f} |", flush=True)
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
