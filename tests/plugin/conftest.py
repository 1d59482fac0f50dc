"""Single-process runs start at once.

Open MPI looks for no network and starts no daemon, which takes longer than most runs here.
"""

from __future__ import annotations

from collections.abc import Iterator

import pytest


@pytest.fixture(autouse=True)
def no_network_for_a_single_process(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    for name, value in (("ess_singleton_isolated", "1"), ("pml", "ob1"), ("btl", "self")):
        monkeypatch.setenv(f"OMPI_MCA_{name}", value)
    yield
