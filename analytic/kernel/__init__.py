"""The compiled half of the model: numbers and arrays only, no class of the interpreter; `docs/model.md` has its equations."""
