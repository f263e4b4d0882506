"""The report as pages of A4, for people who print, sign and file it."""

import logging
from pathlib import Path

from churchpipe.errors import Extra, InputError
from churchpipe.io.atomic import replacing


def write_pdf(report: Path, pdf: Path) -> int:
    """Print a report (HTML) to a PDF and return its number of pages. Scripts do not run: figures stand for the 3-D view.

    Raises
    ------
    InputError: the library that prints, or a library of the system below it, is missing; it fails.
    """
    try:
        with Extra("the report as a PDF"):
            import weasyprint
    except OSError as error:
        remedy = "churchpipe doctor names the line that installs it."
        found = str(error).splitlines()[0]
        raise InputError("the report as a PDF", "a library of the system is missing", found=found, remedy=remedy) from None
    # It warns of each property of the style that concerns screens alone.
    logging.getLogger("weasyprint").setLevel(logging.ERROR)
    try:
        document = weasyprint.HTML(filename=str(report)).render()
    except Exception as error:
        remedy = "Print the report from a browser, and please report this with the report's file."
        found = f"{type(error).__name__} {error}".strip()
        raise InputError("the report as a PDF", "the library that prints failed", found=found, remedy=remedy) from error
    with replacing(pdf) as part:
        document.write_pdf(part)
    return len(document.pages)
