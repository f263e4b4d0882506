"""Files that come with the package: the pipeline and the sample cases."""

from pathlib import Path

from churchpipe.errors import InputError, UsageError

# Generators whose sample case has another name.
_ALIASES = {"prototype": "s22"}


def pipeline_folder() -> Path:
    """Return where the Snakefile is: inside the installed package, else in the repository."""
    here = Path(__file__).resolve()
    for folder in (here.parent / "_pipeline", here.parents[2] / "pipeline"):
        if (folder / "Snakefile").is_file():
            return folder
    raise InputError(
        "churchpipe", "its pipeline is missing", expected="churchpipe/_pipeline/Snakefile", remedy="Install it again."
    )


def sample_names() -> list[str]:
    """Return the names that `sample_case` knows."""
    return sorted({path.stem for path in (pipeline_folder() / "cases").glob("*.toml")} | set(_ALIASES))


def sample_case(name: str) -> str:
    """Return the text of a commented case file: a generator's or a published structure's."""
    if name not in sample_names():
        raise UsageError(f"generate {name}", "unknown case", expected=", ".join(sample_names()))
    return (pipeline_folder() / "cases" / f"{_ALIASES.get(name, name)}.toml").read_text(encoding="utf-8")
