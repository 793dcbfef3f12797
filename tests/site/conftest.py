# SPDX-License-Identifier: Apache-2.0
"""A browser, a server of build/site, and pages that must keep their console empty."""

import importlib.util
import threading
from collections.abc import Iterator
from typing import Any

import pytest
from playwright.sync_api import Browser, BrowserContext, Page, expect, sync_playwright

from site_pages import ROOT, Open

_spec = importlib.util.spec_from_file_location("serve_site", ROOT / "scripts" / "serve_site.py")
assert _spec is not None and _spec.loader is not None
_serve_site = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(_serve_site)

ARGUMENTS = [
    "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
]  # fmt: skip


# Only a test that fails waits that long: a busy machine is slow.
TIMEOUT_MS = 60_000
expect.set_options(timeout=TIMEOUT_MS)


@pytest.fixture(scope="session")
def address() -> Iterator[str]:
    with _serve_site.server() as serving:
        threading.Thread(target=serving.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{serving.server_port}/"
        serving.shutdown()


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path="/usr/bin/chromium", args=ARGUMENTS)
        yield chromium
        chromium.close()


@pytest.fixture
def open_page(browser: Browser, address: str) -> Iterator[Open]:
    """Opens pages; afterwards nothing may have been printed or requested from elsewhere.

    Pages move by themselves only with `moves`: drawing takes a core."""
    said: list[str] = []
    asked: list[str] = []
    contexts: list[BrowserContext] = []

    def open_page(
        place: str = "",
        *,
        width: int = 1200,
        height: int = 900,
        touch: bool = False,
        scheme: Any = "light",
        moves: bool = False,
        script: bool = True,
    ) -> Page:
        context = browser.new_context(
            viewport={"width": width, "height": height}, has_touch=touch, is_mobile=touch,
            color_scheme=scheme, reduced_motion="no-preference" if moves else "reduce",
            java_script_enabled=script, accept_downloads=True,
        )  # fmt: skip
        contexts.append(context)
        context.set_default_timeout(TIMEOUT_MS)
        page = context.new_page()
        page.on("console", lambda message: said.append(message.text))
        page.on("pageerror", lambda error: said.append(str(error)))
        page.on("request", lambda request: asked.append(request.url))
        page.goto(address + place)
        if script:
            page.wait_for_selector("html[data-ready]")
        if script and not touch:  # the browser may show the page before the window has its size
            page.wait_for_function("high => innerHeight === high", arg=height)
        return page

    yield open_page
    for context in contexts:
        context.close()
    assert said == []
    assert [url for url in asked if not url.startswith((address, "blob:"))] == []
