"""Commands of the machine: doctor, and a stage for the rules of the pipeline."""

import resource
import sys
import time
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
    from churchpipe.io.atomic import write_text
    from churchpipe.terminal import Reporter

    begin = time.perf_counter()
    takes_progress = name in stages.LONG
    code = Reporter(name, label, sys.stderr).run(stages.STAGES[name], *paths, takes_progress=takes_progress)
    write_text(Path("benchmark", name, f"{label}.tsv"), _cost(time.perf_counter() - begin))
    raise typer.Exit(code)


def _cost(seconds: float) -> str:
    """Return what this process and those that it waited for have cost, as a table of two lines: time, processor time, memory."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    processor = sum(one.ru_utime + one.ru_stime for one in used)
    memory = max(one.ru_maxrss for one in used) / 2**10
    return f"s\tcpu_time\tmax_rss\n{seconds:.4f}\t{processor:.2f}\t{memory:.2f}\n"
