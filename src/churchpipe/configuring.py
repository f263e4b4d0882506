"""From a case file to the folder of a run: the plan, and the settings of each of its stages."""

from collections.abc import Sequence
from pathlib import Path

from churchpipe.closure import codes_of
from churchpipe.config.asrun import as_run, claim
from churchpipe.config.samples import plan_with_samples
from churchpipe.config.selection import ALL, Selection
from churchpipe.io.atomic import canonical_json, write_if_changed
from churchpipe.stages import STAGES


def configure(case: str | Path, out: str | Path, overrides: Sequence[str] = (), selection: Selection = ALL) -> Path:
    """Write the plan of a run and the settings of each stage into `out`; a file whose content is unchanged is not touched.

    Files: case-file.txt (whose run it is), plan.json, as-run.toml (the case with what --set changed), settings.json of each
    stage: geometry/NAME (with tolerances.json, of its joints), shell/NAME (with carried.json, of its loads), rigid/NAME,
    curve/NAME, movement/NAME, limit/NAME, pushover/NAME, sample/NAME, and code/STAGE.txt. Returns the path of plan.json.
    """
    out = Path(out)
    todo, samples = plan_with_samples(case, overrides, selection)
    # First of all: what is written no further, as where a disk is full, is known as the folder of this case.
    claim(out, Path(case))
    for name, table in (todo.files | {f"sample/{name}/settings": table for name, table in samples.items()}).items():
        write_if_changed(out / f"{name}.json", canonical_json(table))
    for stage, code in codes_of(STAGES).items():
        # The rules take it as an input: an edited module runs again what depends on it.
        write_if_changed(out / "code" / f"{stage}.txt", code)
    write_if_changed(out / "as-run.toml", as_run(Path(case), overrides))
    write_if_changed(out / "plan.json", canonical_json(todo.index))
    return out / "plan.json"
