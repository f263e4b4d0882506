"""The [project] table of a case: whose work a report is."""

from dataclasses import dataclass
from typing import Annotated


@dataclass(frozen=True, slots=True)
class Project:
    """The title block of the report."""

    title: Annotated[str, "What the report is about; by default the name of the case."] = ""
    client: Annotated[str, "For whom it is made."] = ""
    author: Annotated[str, "Who answers for it."] = ""
    date: Annotated[str, "Of the work, in quotes, as it shall be printed."] = ""
    revision: Annotated[str, "Of the report."] = ""
