"""Commands of the machine: doctor, and a stage for the rules of the pipeline."""

import sys
from pathlib import Path

import typer

from churchpipe.cli.app import FINDINGS, app, out


@app.command()
def doctor() -> None:
    """Check what is native or heavy, draw one picture, and print the line that installs what is missing."""
    from churchpipe.doctor import examine
    from churchpipe.terminal import findings_table

    findings = examine()
    out.print(findings_table(findings))
    for remedy in dict.fromkeys(finding.remedy for finding in findings if finding.remedy):
        out.print(remedy, soft_wrap=True)
    if not all(finding.passed for finding in findings):
        raise typer.Exit(FINDINGS)


@app.command(hidden=True)
def stage(name: str, label: str, paths: list[Path]) -> None:
    """Run one stage: what the rules of the pipeline call."""
    from churchpipe import stages
    from churchpipe.terminal import Reporter

    takes_progress = name in stages.LONG
    code = Reporter(name, label, sys.stderr).run(stages.STAGES[name], *paths, takes_progress=takes_progress)
    raise typer.Exit(code)
