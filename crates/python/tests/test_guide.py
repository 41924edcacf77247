"""The page of the guide runs, and the README of the wheel."""

import re

import pytest
from conftest import ROOT


@pytest.mark.parametrize("page", ["docs/guide/python.md", "crates/python/README.md", "README.md"])
def test_code_of_the_pages(page):
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / page).read_text(encoding="utf-8"), re.S)
    assert blocks
    for block in blocks:
        exec(compile(block, page, "exec"), {})
