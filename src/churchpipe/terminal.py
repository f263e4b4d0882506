"""What the command line shows: progress of a run, tables; and the news that stages send it."""

import errno
import math
import time
from collections.abc import Callable, Mapping, Sequence
from datetime import datetime
from pathlib import Path
from typing import Any, TextIO

from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TaskID, TextColumn, TimeElapsedColumn
from rich.table import Table
from rich.text import Text

from churchpipe.doctor import Finding
from churchpipe.engine import Event, say, unfinished
from churchpipe.errors import InputError
from churchpipe.io.movement_record import ENDINGS, Movement
from churchpipe.io.records import Analysis
from churchpipe.io.summary import Summary, read_summary
from churchpipe.model.checks import DisplacementCheck, SafetyCheck
from churchpipe.model.names import AS_IT_IS, GOOD
from churchpipe.model.quantities import in_unit
from churchpipe.model.swept import friction_of_material
from churchpipe.report.safety import NOT_SATISFIED, verdict, what_moves
from churchpipe.report.table import factor_words, interval_text
from churchpipe.text_table import TextTable
from churchpipe.wording import counted, four_figures, three_figures

# Between two lines of progress of one stage, seconds: on a terminal, and where each line stays.
PAUSE, PATIENCE = 0.25, 30.0
# Longer lists are folded.
MOST_ROWS, MOST_LINES = 40, 8
# What a disk says that takes no more: no defect of a stage.
_NO_PLACE = {errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EACCES, errno.EFBIG, errno.EIO}
# A joint is no crack that is open by less, m: rounding opens joints of stones that stay together.
_SHUT = 1e-6
STATUS_STYLES = {"optimal": "green", "converged": "green", "unbounded": "cyan"}


class Display:
    """Progress of a run: a bar on a terminal; elsewhere a line for each finished stage, and now and then one for those that take
    long. Errors are kept for the end."""

    def __init__(self, console: Console) -> None:
        self.errors: list[str] = []
        self.finished = 0
        self._console = console
        self._bar = Progress(
            SpinnerColumn(),
            TextColumn("{task.description}", markup=False),
            BarColumn(),
            TextColumn("{task.percentage:3.0f} %"),
            TimeElapsedColumn(),
            console=console,
            transient=True,
            disable=not console.is_terminal,
        )
        self._all = self._bar.add_task("all stages", total=None)
        self._running: dict[tuple[str, str], TaskID] = {}
        self._said: dict[tuple[str, str], float] = {}
        self._total = 0.0

    def __enter__(self) -> "Display":
        self._bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._bar.stop()

    def show(self, event: Event) -> None:
        """Take one event."""
        key = (event.stage, event.name)
        match event.kind:
            case "total":
                self._total = event.share
                self._bar.update(self._all, total=event.share)
            case "start":
                self._said[key] = time.perf_counter()
                self._running[key] = self._bar.add_task(f"{event.stage}  {event.name}", total=100)
            case "progress" if key in self._running:
                description = f"{event.stage}  {event.name}: {event.text}"
                self._bar.update(self._running[key], description=description, completed=100 * event.share)
                if not self._console.is_terminal and time.perf_counter() - self._said[key] >= PATIENCE:
                    self._said[key] = time.perf_counter()
                    self._console.print(f"{description}, {100 * event.share:.0f} %", soft_wrap=True)
            case "done" | "error":
                if key in self._running:
                    self._bar.remove_task(self._running.pop(key))
                self._close(event)

    def _close(self, event: Event) -> None:
        if event.kind == "error":
            self.errors.append(event.text)
            return
        self.finished += 1
        self._bar.advance(self._all)
        share = f"{100 * self.finished / self._total:6.0f} %" if self._total else ""
        self._console.print(f"{event.stage:<9} {event.name:<44} {event.share:7.1f} s{share}")


class Reporter:
    """Runs a stage and sends news of it as lines."""

    def __init__(self, stage: str, name: str, stream: TextIO) -> None:
        self._stage, self._name, self._stream = stage, name, stream
        self._last = 0.0

    def run(self, work: Callable[..., Any], *arguments: Any, takes_progress: bool) -> int:
        """Call the stage; return the exit code: 1 when its input cannot be taken."""
        begin = time.perf_counter()
        self._send("start")
        try:
            work(*arguments, **({"progress": self.progress} if takes_progress else {}))
        except InputError as error:
            self._send("error", str(error.within(Path.cwd())))
            return 1
        except OSError as error:
            if error.errno not in _NO_PLACE:
                raise
            place = f"{Path(error.filename).absolute()}: " if error.filename else "A file cannot be written: "
            self._send("error", f"{place}{error.strerror}. Make room there, or choose another folder with --out.")
            return 1
        self._send("done", share=time.perf_counter() - begin)
        return 0

    def progress(self, text: str, share: float) -> None:
        """Take news from inside a stage; too frequent ones are dropped."""
        now = time.perf_counter()
        if now - self._last >= PAUSE:
            self._last = now
            self._send("progress", text, share)

    def _send(self, kind: str, text: str = "", share: float = 0.0) -> None:
        # One write a line: stages that run side by side share the stream.
        self._stream.write(say(Event(kind, self._stage, self._name, text, share)) + "\n")
        self._stream.flush()


def sizes_words(summary: Summary) -> str:
    """Return the case of summary.json and the sizes of its models, as words."""
    sizes = f"{counted(summary.blocks, 'stone')}, {counted(summary.interfaces, 'interface')}"
    shells = list(summary.shells.values()) or [summary.shell]
    meshes = ", ".join(f"{shell.elements}" for shell in shells if shell and shell.elements)
    shell = f"; shell of {meshes} elements" if meshes else ""
    return f"{summary.case}: {sizes}, {four_figures(summary.weight / 1e3)} kN{shell}"


def results_table(summary: Summary) -> Table:
    """Return the analyses of summary.json as a table."""
    analyses = summary.analyses
    title = sizes_words(summary)
    table = TextTable(title)
    both = len({analysis.model for analysis in analyses}) > 1
    swept = [key for key in dict.fromkeys(k for a in analyses for k in a.swept) if not friction_of_material(key)]
    variants = any(analysis.variant for analysis in analyses)
    for title in (
        *(["variant"] if variants else []),
        "load",
        *(["model"] if both else []),
        "analysis" if both else "flow",
        "friction",
        *swept,
    ):
        table.add_column(title, overflow="fold")
    checked = any(analysis.check and analysis.check.satisfied is not None for analysis in analyses)
    safety = {"zeta_E": "zeta_e", "of stones": "zeta_e_stones"} if checked else {}
    ranged = any(map(interval_text, analyses))
    for title in ("load factor", *(["interval"] if ranged else []), "bounds apart", *safety, "s"):
        table.add_column(title, justify="right", overflow="fold")
    table.add_column("status", overflow="fold")
    if safety:
        table.add_column("check", overflow="fold")
    for analysis in analyses[:MOST_ROWS]:
        check = analysis.check if analysis.check and analysis.check.satisfied is not None else None
        table.add_row(
            *([analysis.variant or AS_IT_IS] if variants else []),
            analysis.load,
            *([analysis.model_words] if both else []),
            analysis.kind,
            _words(analysis.friction),
            *(_words(analysis.swept.get(key)) for key in swept),
            "no limit" if analysis.status == "unbounded" else _figure(analysis.load_factor),
            *([interval_text(analysis)] if ranged else []),
            _bounds(analysis),
            *(_figure(getattr(check, key), 2) if check else "" for key in safety.values()),
            f"{analysis.seconds:.1f}",
            Text(analysis.status, STATUS_STYLES.get(analysis.status, "red")),
            *([Text(word := verdict(check), "red" if word == NOT_SATISFIED else "")] if safety else []),
        )
    words = factor_words(analyses, _OF_PUSH)
    _explain(table, len(analyses), [*words, _OF_BOUNDS, *([_OF_INTERVAL] if ranged else []), *(_OF_CHECK if safety else [])])
    return table


# What columns are, for whoever sees them for the first time.
_OF_PUSH = "load factor: load that brings it down, over the weight that is pushed"
_OF_BOUNDS = "bounds apart: upper less lower bound of the load factor, both proved"
_OF_INTERVAL = "interval: without dilatancy, the load factors that fit the same mechanism"
_OF_CHECK = (
    "zeta_E: ground acceleration that it withstands, over that of the site",
    "of stones: the same with e* of stones below, less careful",
)
_OF_MECHANISM = ("a0*: acceleration that starts it, as one body", "e* of stones: share of the moving mass that takes part")


def _explain(table: Table, rows: int, words: Sequence[str]) -> None:
    """Write below a table what its columns are, and how many rows are left out."""
    table.caption = "\n".join([*filter(None, [_folded(rows)]), *words])
    table.caption_justify = "left"


def _folded(count: int) -> str | None:
    return f"and {count - MOST_ROWS} more, all of them in table.csv and in the report" if count > MOST_ROWS else None


def mechanism_table(summary: Summary) -> Table | None:
    """Return what moves in each mechanism and what the safety check finds of it, None where nothing is known of either."""
    listed = [one for one in summary.analyses if one.parts or _activated(one)]
    if not listed:
        return None
    table = TextTable("Mechanisms")
    table.add_column("analysis", overflow="fold")
    if named := any(one.parts for one in listed):
        table.add_column("what moves: share of the motion", overflow="fold")
    for title in ("moving, kN", "a0*, m/s2", "e* of stones"):
        table.add_column(title, justify="right", overflow="fold")
    _explain(table, len(listed), _OF_MECHANISM)
    for one in listed[:MOST_ROWS]:
        check = _activated(one)
        names = ("moving_weight", "a0_lumped", "mass_fraction")
        figures = [four_figures(round(in_unit(check, name)[0], 9) + 0.0) for name in names] if check else [""] * 3
        words = [what_moves(one)] if named else []
        table.add_row(one.name or one.load, *words, *figures)
    return table


def _activated(record: Analysis) -> SafetyCheck | None:
    """Return the check with a behaviour factor of an analysis, if it was made."""
    return record.check if isinstance(record.check, SafetyCheck) and math.isfinite(record.check.alpha0) else None


def runs_table(folder: Path) -> Table | None:
    """Return the runs that lie in a folder, the latest first, None where there is none."""
    runs = [plan.parent for plan in folder.glob("*/plan.json")]
    if not runs:
        return None
    table = TextTable(f"Runs in {folder}")
    for title in ("run", "when", "analyses", "load factors", "end"):
        table.add_column(title, overflow="fold")
    for run in sorted(runs, key=lambda run: -(run / "plan.json").stat().st_mtime):
        table.add_row(run.name, *_run_words(run))
    return table


def _run_words(run: Path) -> list[str]:
    when = datetime.fromtimestamp((run / "plan.json").stat().st_mtime).strftime("%Y-%m-%d %H:%M")
    if why := unfinished(run):
        return [when, "", "", why.splitlines()[0]]
    try:
        analyses = read_summary(run / "summary.json").analyses
    except (InputError, OSError):
        return [when, "", "", "no results"]
    factors = [one.load_factor for one in analyses if math.isfinite(one.load_factor)]
    ends = f"{min(factors):.4f}" + (f" to {max(factors):.4f}" if len(factors) > 1 else "") if factors else "none"
    bad = sum(one.status not in GOOD for one in analyses)
    return [when, str(len(analyses)), ends, f"{bad} without a result" if bad else "well"]


def gate_lines(summary: Summary) -> list[str]:
    """Return what the comparison of the two models has to say: a gate that failed, stones missing from the shell or moved
    for it."""
    lines: list[str] = []
    for name, gate in summary.gates.items():
        place = f" ({name})" if name else ""
        differ = ", ".join(item.name for item in gate.figures if not item.passed)
        if not gate.passed:
            lines.append(f"No shell{place}. {gate.message or f'The two models do not match: {differ}.'} The rigid blocks stand.")
        elif unfit := gate.unfit:
            more = f" and {len(unfit) - 8} more" if len(unfit) > 8 else ""
            lines.append(f"Stones that fit no wall and are missing from the shell{place}: {', '.join(unfit[:8])}{more}.")
        if gate.moved:
            lines.append(gate.moved)
    return list(dict.fromkeys(lines))


def remarks(summary: Summary) -> list[str]:
    """Return what stands under the table: joints and near misses, the gate, which load factor to use and why, doubtful input;
    before it what samples say."""
    from churchpipe.compare import account_of_joints
    from churchpipe.report.table import Row, named_of
    from churchpipe.report.uncertainty import uncertainty_lines

    analyses = summary.analyses
    # Of a load that has no check the site is known all the same, where the case names one.
    checked = any(one.check and (one.check.satisfied is not None or math.isfinite(one.check.a_g)) for one in analyses)
    return [
        *uncertainty_lines(summary.uncertainty, [Row(record) for record in analyses]),
        *account_of_joints(summary),
        *gate_lines(summary),
        *_few([_failure(one) for one in analyses if one.status not in GOOD and one.message]),
        *_endless([one for one in analyses if one.status == "unbounded"]),
        *_few([line for one in analyses if one.status in GOOD for line in _left_out(one, checked)]),
        *(_movement(one) for one in summary.movements),
        *summary.guidance,
        *(
            f"{named_of(f'Load {one.load}', one.variant, one.swept)}: {' '.join(check.said)}"
            for one in analyses
            if isinstance(check := one.check, DisplacementCheck)
            if check.governs
        ),
        *_few([f"Question: {text}" for text in summary.questions]),
    ]


def _few(lines: list[str]) -> list[str]:
    return lines[:MOST_LINES] + ([f"and {len(lines) - MOST_LINES} more in the report"] if len(lines) > MOST_LINES else [])


def _failure(record: Analysis) -> str:
    return f"{_named(record)}: {record.status}, {record.message.rstrip('.')}."


def _endless(records: Sequence[Analysis]) -> list[str]:
    """Return what the load factor "no limit" means, one sentence for all loads that have it."""
    named = dict.fromkeys(one.load if one.variant is None else f"{one.load} ({one.variant})" for one in records)
    words = f'Load {", ".join(named)}: "no limit" means that no multiple of it brings down what is modelled. Look at its '
    words += "direction, the walls it pushes and the supports; masonry that crushes has a load factor (compressive_strength_MPa)."
    return [words] if named else []


def _left_out(record: Analysis, checked: bool) -> list[str]:
    """Return what a capacity curve leaves out or where it was left, and why an analysis has no check where checks are made."""
    told = [f"{_named(record)}: {record.message}."] if record.message and record.method == "curve" else []
    refused = record.check.message if checked and record.check else ""
    return told + (
        [f"{_named(record)}: no safety check, {refused.removeprefix('check: ').removeprefix('oscillator: d0: ')}"]
        if refused
        else []
    )


def _named(record: Analysis) -> str:
    words = [record.variant, f"load {record.load}", record.model_words, record.kind]
    return ", ".join(word for word in words if word)


def _movement(record: Movement) -> str:
    from churchpipe.report.table import named_of

    name = named_of(record.movement, record.variant, record.swept)
    if record.ending not in ENDINGS:
        return f"Support {name}: it could not be moved, {record.message or record.ending}"
    (ultimate, unit), (places, _) = in_unit(record, "ultimate"), in_unit(record, "displacement")
    far = ultimate if math.isfinite(ultimate) else next(iter(places[-1:]), 0.0)
    widest = [f"{three_figures(1e3 * crack.opening)} mm in {crack.place}" for crack in record.cracks if crack.opening > _SHUT]
    told = f"widest crack {(widest or ['none'])[0]}{_reaction(record)}"
    return f"Support {name}: at {far:.4g} {unit} " + "; ".join((ENDINGS[record.ending], told, *record.left_out))


def _reaction(record: Movement) -> str:
    """Return with what force a support resists as it begins to move, the larger of two values first; "" if it did not move."""
    (least, force), (reaction, _) = in_unit(record, "least_reaction"), in_unit(record, "reaction")
    if not reaction or not math.isfinite(least):
        return ""
    if max(least, reaction[0]) < 0:
        words = f"be pushed with {-least:.4g} {force} at most ({-reaction[0]:.4g} {force} without dilatancy)"
    else:
        words = f"resist with {max(least, reaction[0]):.4g} {force} without dilatancy, {least:.4g} {force} at the least"
    return f"; as it begins to move it must {words}"


def findings_table(findings: Sequence[Finding]) -> Table:
    """Return what `doctor` found as a table."""
    table = Table()
    for title in ("", "what", "for", "seen"):
        table.add_column(title, overflow="fold")
    for finding in findings:
        mark = Text("ok", "green") if finding.passed else Text("missing", "red")
        table.add_row(mark, finding.name, finding.purpose, finding.detail)
    return table


def _bounds(analysis: Analysis) -> str:
    lower, upper = analysis.lower_bound, analysis.upper_bound
    if lower is None or upper is None or not math.isfinite(upper - lower):
        return ""
    return f"{abs(upper - lower):.1e}"


def _figure(value: float | None, digits: int = 6) -> str:
    return "none" if value is None or not math.isfinite(value) else f"{value:z.{digits}f}"


def _words(value: object) -> str:
    if isinstance(value, Mapping):
        return ", ".join(f"{key} {item:g}" for key, item in value.items())
    return f"{value:g}" if isinstance(value, float) else "" if value is None else str(value)
