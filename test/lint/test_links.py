# Copyright 2026 diffdrive_kinematics contributors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""Every link within the repository leads to a file, and to a heading where it names one."""

from pathlib import Path
import re

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGES = sorted([*ROOT.glob('*.md'), *ROOT.glob('docs/**/*.md'), *ROOT.glob('test/*.md')])
BLOCK = re.compile(r'^(```|~~~).*?^\1', re.DOTALL | re.MULTILINE)
CODE = re.compile(r'`[^`\n]*`')
LINK = re.compile(r'\]\(([^)\s]+)\)|^\[[^\]]+\]:\s+(\S+)', re.MULTILINE)
HEADING = re.compile(r'^#+ +(.+?) *$', re.MULTILINE)


def anchors(page):
    """Return the names under which the headings of a page are found."""
    text = BLOCK.sub('', page.read_text(encoding='utf-8'))
    return {re.sub(r'[^\w\- ]', '', heading.lower()).replace(' ', '-')
            for heading in HEADING.findall(text)}


def broken_links(page, text):
    """Return the links of a page with a text that lead nowhere."""
    broken = []
    prose = CODE.sub('', BLOCK.sub('', text))
    for link in (inline or named for inline, named in LINK.findall(prose)):
        if re.match(r'[a-z]+:', link):
            continue
        file, _, anchor = link.partition('#')
        target = (page.parent / file).resolve() if file else page
        if not target.exists() or (anchor and anchor not in anchors(target)):
            broken.append(link)
    return broken


@pytest.mark.linter
@pytest.mark.parametrize('page', PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_somewhere(page):
    assert broken_links(page, page.read_text(encoding='utf-8')) == []


@pytest.mark.parametrize('link', ['docs/nowhere.md', '#no-heading', 'README.md#no-heading'])
def test_a_link_that_leads_nowhere_is_found(link):
    page = ROOT / 'README.md'
    assert broken_links(page, f'a [link]({link})') == [link]
    assert broken_links(page, f'[link]: {link}') == [link]
    assert broken_links(page, f'code `[link]({link})`, [site](https://ros.org)') == []
