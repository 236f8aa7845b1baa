"""Faults that the audit cannot find, with their reasons: patterns of the names that the self-test gives them."""

import re

REASONS = [
    (r": relative_error,", "an estimate that a program makes of itself"),
]


def reason(name, folder):
    """Why a fault cannot be found; none where it should be."""
    return next((why for pattern, why in REASONS if re.search(pattern, name)), None)
