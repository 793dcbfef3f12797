# SPDX-License-Identifier: Apache-2.0
"""What the tests of a change run of many similar cases. `make soak` runs all of them."""

from collections.abc import Iterable
from typing import Any

import pytest


def sampled(cases: Iterable[Any], every: int) -> list[Any]:
    """Parameters of a test: outside of `make soak` the first case and each `every`-th after it.

    A case that is a tuple has a value for each parameter.
    """
    return [
        case if k % every == 0 else in_soak(*(case if isinstance(case, tuple) else (case,)))
        for k, case in enumerate(cases)
    ]


def amounts(few: Any, many: Any) -> list[Any]:
    """How many random cases a test tries before a change, and how many in `make soak`."""
    return [few, in_soak(many)]


def in_soak(*values: Any) -> Any:
    """Parameters with which only `make soak` runs a test."""
    return pytest.param(*values, marks=pytest.mark.soak)
