"""The one exception that a user's wrong numbers raise."""

from typing import final


@final
class AnalyticInputError(ValueError):
    """Raised for numbers that no run can use; the sentence says what was wanted, what came and what to do."""
