"""The command that counts statements that hold and verdicts that do not."""

from tests.engines_for_tests import ready
from tests.measures.random_scenes import row_of
from tests.measures.seeded_scenes import GENERATORS


def test_a_row_holds_each_engine_s_statement_and_each_pair_s_verdict() -> None:
    ready("pybullet")
    row = row_of("random", 20_900)
    for name, item in row.engines.items():
        assert item.engine == name
        assert item.rotation_holds == (item.error_rad <= item.stated_rad), name
        assert item.slip_holds == (item.error_m <= item.stated_m), name
        assert 0.0 < item.share <= 1.0
    assert len(row.pairs) == 3
    assert all(pair.refuted is None or pair.verdict == "differ: model" for pair in row.pairs.values())


def test_generators_are_reproducible_and_differ() -> None:
    for name, make in GENERATORS.items():
        a, b, other = make(5), make(5), make(6)
        assert a.statue.mass_kg == b.statue.mass_kg != other.statue.mass_kg, name
    assert len({make(5).base_excitation.x.peak_m_s2 for make in GENERATORS.values()}) == 3
