"""News of the stages in the output of the engine."""

import pytest

from churchpipe import engine

NEWS = engine.Event("done", "blocks", "blocks", 'a "text"\nof two lines', 1.5)


# Snakemake writes the end of its own lines apart, so that a stage's news may come between the two.
@pytest.mark.parametrize("before", ["", "Select jobs to execute...", "[Mon Nov 23 21:00:00 2026]"])
def test_news_behind_the_words_of_the_engine_are_heard(before: str) -> None:
    assert engine.heard(before + engine.say(NEWS) + "\n") == NEWS


def test_a_line_of_the_engine_alone_has_no_news() -> None:
    assert engine.heard("Finished jobid: 3 (Rule: blocks)\n") is None
