"""How far the analytic model can be trusted, for one statue: strength and frequency of its shaking divided by what models say."""
