"""What LIGGGHTS prints -> steps, loop time, errors, and the faults that its exit status does not tell.

Covers thermo output on one line and on several, in any order of its columns. Read line by line while it runs.
"""

from __future__ import annotations

import math
import re
from collections import deque
from dataclasses import dataclass, field

# Lines at the end of an output that are shown where a run failed.
TAIL_LINES = 15

_LOOP = re.compile(r"Loop time of (\S+) on \d+ procs for (\d+) steps")
_MULTI_LINE_STEP = re.compile(r"-+ Step +(\d+) -")
_MULTI_LINE_VALUE = re.compile(r"\w+ += +(\S+)")


@dataclass
class Screen:
    """What LIGGGHTS has printed so far, read line by line."""

    steps: int = 0
    loop_time: float = 0.0
    current_step: int | None = None
    errors: list[str] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)
    tail: deque[str] = field(default_factory=lambda: deque(maxlen=TAIL_LINES))
    _header: list[str] = field(default_factory=list)
    _multi_line: bool = False

    def read(self, line: str) -> None:
        self.tail.append(line)
        words = line.split()
        if "ERROR" in line:
            self.errors.append(line)
        elif "Lost atoms" in line:
            self._fault(line)
        elif "SIGINT/SIGTERM caught" in line:
            # LIGGGHTS then stops, prints the loop time of all the steps that were asked for, and exits with status 0.
            self._fault("stopped by a signal before its end")
        elif loop := _LOOP.search(line):
            self.loop_time += float(loop[1])
            self.steps += int(loop[2])
            self._header, self._multi_line = [], False
        elif "Step" in words and all(word[0].isalpha() for word in words):
            self._header = words
        elif multi := _MULTI_LINE_STEP.match(line):
            self.current_step, self._multi_line = int(multi[1]), True
        elif self._header and len(words) == len(self._header) and all(map(_is_number, words)):
            self.current_step = int(words[self._header.index("Step")])
            self._refuse_nonfinite(words, ", ".join(map(" = ".join, zip(self._header, words, strict=True))))
        elif self._multi_line:
            self._refuse_nonfinite(_MULTI_LINE_VALUE.findall(line), line)

    def _refuse_nonfinite(self, values: list[str], shown: str) -> None:
        if any(_is_number(value) and not math.isfinite(float(value)) for value in values):
            self._fault(f"thermo output is not finite at step {self.current_step}: {shown}")

    def _fault(self, what: str) -> None:
        if len(self.faults) < 3:
            self.faults.append(what)


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True
