"""Every file of the corpus is answered with exactly the findings that it deserves, and every error says what to do."""

import pytest

from churchpipe.findings import FindingsError
from churchpipe.meshes.reader import read_file
from corpus_files import CORPUS, FILES


def test_the_corpus_holds_what_is_expected_of_it() -> None:
    assert {path.name for path in CORPUS.iterdir()} == set(FILES)
    assert max(path.stat().st_size for path in CORPUS.iterdir()) < 4000
    for name, (text, _, _) in FILES.items():
        assert (CORPUS / name).read_text(encoding="utf-8") == text


@pytest.mark.parametrize("name", FILES)
def test_a_file_of_the_corpus_has_the_findings_it_deserves(name: str) -> None:
    _, options, codes = FILES[name]
    try:
        findings = read_file(CORPUS / name, **options).findings
    except FindingsError as error:
        findings = error.findings
    assert set(findings.codes) == codes, str(findings)
    assert all(finding.remedy for finding in findings), str(findings)
