"""The estimated cost of a kernel, computed once and kept in the cache."""

from __future__ import annotations

from functools import cache

from bfsim.kernel import function_keys
from bfsim.kernel.costs.costs import Costs, kept_costs
from bfsim.kernel.language.function import Function
from bfsim.kernel.profile import CompilerProfile


@cache
def costs_of(function: Function, profile: CompilerProfile) -> Costs:
    """Cost `function` and its callees, or take the costs from the cache on disk; once per process."""

    def made() -> Costs:
        from bfsim.kernel.estimate.costing import costed  # most starts find all costs

        return costed(function, profile)

    return kept_costs(function_keys.key(function, profile, "costs"), made)
