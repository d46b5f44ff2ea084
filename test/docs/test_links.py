"""Every relative link of every page leads to a file, and to a heading where it names one."""

import pytest
from pages import REPOSITORY, anchors, links, pages


@pytest.mark.parametrize("page", pages(), ids=lambda page: str(page.relative_to(REPOSITORY)))
def test_links_lead_somewhere(page):
    wrong = []
    for link in links(page):
        path, _, anchor = link.target.partition("#")
        target = (page.parent / path).resolve() if path else page
        if not target.exists():
            wrong.append(f"line {link.line}: {link.target}: there is no such file")
        elif anchor and (target.suffix != ".md" or anchor not in anchors(target)):
            wrong.append(f"line {link.line}: {link.target}: there is no such heading")
    assert not wrong, "\n".join(wrong)


def test_every_tutorial_and_page_of_docs_can_be_reached_from_the_readme():
    reached, waiting = set(), [REPOSITORY / "README.md"]
    while waiting:
        page = waiting.pop()
        if page in reached:
            continue
        reached.add(page)
        targets = ((page.parent / link.target.partition("#")[0]).resolve() for link in links(page))
        waiting += [target for target in targets if target.suffix == ".md" and target.exists()]
    assert {page for page in pages() if (REPOSITORY / "docs") in page.parents} <= reached
