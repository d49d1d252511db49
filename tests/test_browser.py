"""The built documentation and the report in a browser: Debian's chromium, without a window.

A page of this test loads every page of the site into a frame as wide as a phone, and reads what a
reader would meet: dead links, pictures without words, text that is cut off at the right.
"""

import functools
import http.server
import json
import re
import shutil
import subprocess
import threading
from pathlib import Path
from types import SimpleNamespace

import pytest

from cysyk1999.publishing.html import report_pages

pytestmark = pytest.mark.browser

ROOT = Path(__file__).parents[1]
SITE = ROOT / "docs/_build/html"
FIGURES = ROOT / "figures"
REPORT = ROOT / "results/report.zip"
BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser"))), None)
PHONE = 390
"""Width (px) of the narrowest screen that pages are made for."""

WALK = """<!doctype html><body><script>
const frame = document.body.appendChild(document.createElement("iframe"));
frame.style = "width:%(width)dpx;height:800px;border:0";
const found = {};
async function visit(page) {
  const loaded = new Promise(done => { frame.onload = done; });
  frame.src = page;
  await loaded;
  const text = frame.contentDocument, root = text.documentElement;
  const images = [...text.images];
  images.forEach(i => { i.loading = "eager"; });
  await Promise.race([Promise.all(images.map(i => i.decode().catch(() => 0))),
                      new Promise(done => setTimeout(done, 5000))]);
  found[page] = {
    width: root.scrollWidth, words: text.body.innerText.length,
    mute: images.filter(i => !i.alt.trim()).map(i => i.src),
    missing: images.filter(i => !i.naturalWidth).map(i => i.src),
    links: [...text.querySelectorAll("a[href]")].map(a => a.href),
    names: [...text.querySelectorAll("[id]")].map(e => e.id)};
}
(async () => {
  for (const page of %(pages)s) await visit(page);
  await fetch("/found", {method: "POST", body: JSON.stringify(found)});
})();
</script></body>"""


class Site(http.server.SimpleHTTPRequestHandler):
    """A folder, and the page that walks through it; what the walk finds is kept by the server."""

    def do_GET(self):
        if self.path != "/walk":
            return super().do_GET()
        self.send_response(200)
        self.send_header("Content-Type", "text/html")
        self.end_headers()
        self.wfile.write(self.server.walk.encode())

    def do_POST(self):
        self.server.found = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
        self.send_response(204)
        self.end_headers()
        self.server.done.set()

    def log_message(self, *_):
        pass


def walk(folder, pages, width, tmp_path):
    """What a browser finds on the pages of a folder, and what it says in its console."""
    handler = functools.partial(Site, directory=str(folder))
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
    server.walk, server.done = (
        WALK % {"width": width, "pages": json.dumps(pages)},
        threading.Event(),
    )
    threading.Thread(target=server.serve_forever, daemon=True).start()
    said = tmp_path / "said.txt"
    options = ["--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"]
    options += ["--enable-logging=stderr", f"--user-data-dir={tmp_path / 'profile'}"]
    address = f"http://127.0.0.1:{server.server_port}/walk"
    with open(said, "w") as out:
        process = subprocess.Popen(
            [BROWSER, *options, "--remote-debugging-port=0", address],
            stdout=subprocess.DEVNULL,
            stderr=out,
        )
        try:
            assert server.done.wait(600), said.read_text()[-2000:]
        finally:
            process.terminate()
            process.wait(30)
            server.shutdown()
    console = re.findall(r"CONSOLE[^\]]*\] (.*)", said.read_text())
    return server.found, console


@pytest.fixture(scope="module")
def browser():
    if BROWSER is None:
        pytest.skip("no chromium here: apt-get install chromium")


@pytest.fixture(scope="module")
def site(browser, tmp_path_factory):
    """Every page of the documentation at the width of a phone, and the console."""
    if not (SITE / "index.html").exists():
        pytest.skip("the documentation is not built: make docs")
    pages = sorted(f"/{path.relative_to(SITE).as_posix()}" for path in SITE.rglob("*.html"))
    return walk(SITE, pages, PHONE, tmp_path_factory.mktemp("browser"))


def test_the_console_is_silent(site):
    assert not site[1]


def test_every_picture_is_there_and_has_words(site):
    assert not {page: of["missing"] for page, of in site[0].items() if of["missing"]}
    assert not {page: of["mute"] for page, of in site[0].items() if of["mute"]}


def test_pages_fit_a_phone(site):
    wide = {page: of["width"] for page, of in site[0].items() if of["width"] > PHONE}
    assert len(site[0]) > 50 and not wide


def test_no_link_is_broken(site):
    """Every link within the site: its page and the place on it. Links to files beside, too; not
    those of listings of code, which sphinx writes.
    """
    found, broken = site[0], set()
    for page, of in found.items():
        if page.startswith("/_modules/"):
            continue
        for link in of["links"]:
            inside = re.fullmatch(r"http://127\.0\.0\.1:\d+(/[^#?]*)(?:\?[^#]*)?(?:#(.*))?", link)
            if not inside:
                continue
            path, name = inside[1], inside[2]
            path += "index.html" * path.endswith("/")
            if not (SITE / path[1:]).exists() or (
                name and path in found and name not in found[path]["names"]
            ):
                broken.add((page, link.split("/", 3)[3]))
    assert sum(len(of["links"]) for of in found.values()) > 1000
    assert not broken


def test_a_wrong_page_is_found(browser, tmp_path):
    """The mutant: a page with every fault that is looked for."""
    (tmp_path / "site").mkdir()
    (tmp_path / "site/bad.html").write_text(
        "<img src=none.png><p style='width:900px'>wide</p><script>nothing()</script>"
    )
    found, console = walk(tmp_path / "site", ["/bad.html"], PHONE, tmp_path)
    bad = found["/bad.html"]
    assert bad["width"] > PHONE and len(bad["mute"]) == len(bad["missing"]) == 1
    assert any("nothing is not defined" in line for line in console)


@pytest.fixture(scope="module")
def report(browser, tmp_path_factory):
    """Pages of the report: every published table and some figures, at the width of a phone."""
    folder, tables = tmp_path_factory.mktemp("report"), sorted((FIGURES / "tables").glob("*.csv"))
    tables = [path for path in tables if path.with_suffix(".md").exists()]
    shown = [FIGURES / f"{name}.png" for name in ("thesis/fig_4-11", "studies/overview")]
    sources = [*shown, *tables]
    pages = [str(folder / f"{path.stem}.html") for path in sources]
    report_pages(
        SimpleNamespace(
            shown=shown, published=tables, titles=[path.stem for path in sources], pages=pages
        )
    )
    return walk(
        folder, [f"/{Path(page).name}" for page in pages], PHONE, tmp_path_factory.mktemp("walk")
    )


def test_tables_of_the_report_can_be_read(report):
    found, console = report
    assert not console and len(found) > 20
    assert not {page: of["width"] for page, of in found.items() if of["width"] > PHONE}
    assert not [page for page, of in found.items() if of["missing"] or of["mute"]]
    assert min(of["words"] for of in found.values()) > 100


def test_the_report_opens(browser, tmp_path):
    """The whole of it, where `make report` has made it."""
    if not REPORT.exists():
        pytest.skip("there is no report: make report")
    shutil.unpack_archive(REPORT, tmp_path / "report")
    (start,) = (tmp_path / "report").rglob("report.html")
    found, console = walk(start.parent, ["/report.html"], 1280, tmp_path)
    assert not [line for line in console if "error" in line.lower()]
    assert found["/report.html"]["words"] > 100
