"""What contact engines share that locate events inside a step: so far the account of everything that is written to a body."""
