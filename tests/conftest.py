"""What the slow tests hold: `@pytest.mark.slow("FILE: what of it")` names the documented figures, and the summary lists them."""

import pytest

HOLDS = "holds"


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        for mark in item.iter_markers("slow"):
            item.user_properties += [(HOLDS, place) for place in mark.args or ("no document",)]


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    found: dict[str, dict[str, int]] = {}
    for outcome in ("passed", "failed", "error"):
        for report in terminalreporter.getreports(outcome):
            for name, place in getattr(report, "user_properties", ()):
                if name == HOLDS:
                    counts = found.setdefault(place, {})
                    counts[outcome] = counts.get(outcome, 0) + 1
    if found:
        terminalreporter.section("documented figures held by these tests")
    for place, counts in sorted(found.items()):
        terminalreporter.line(f"{place}: {', '.join(f'{count} {outcome}' for outcome, count in counts.items())}")
