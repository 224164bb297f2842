// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// What the tests of the page share: a browser, and for each test a server double and a page. Importing it sets them up.

import assert from "node:assert/strict";
import { after, afterEach, before } from "node:test";
import { FakeServer } from "../../support/viewer_page/fake_server.mjs";
import { launchBrowser, openPage } from "./browser.mjs";

export let browser, server, page;

before(async () => { browser = await launchBrowser(); });
after(() => browser.close());
afterEach(async () => {
  const { complaints = [], outside = [] } = page ?? {};
  await page?.close();
  await server?.stop();
  page = server = undefined;
  assert.deepEqual(complaints, [], "errors and warnings of the page");
  assert.deepEqual(outside, [], "requests to other hosts");
});

/** A server for the page under test; port: a free one by default. */
export async function serve(options = {}, port = undefined) {
  server = await new FakeServer(options).start(port);
  return server;
}

/** The page under test is another one. */
export function take(other) {
  page = other;
}

export async function open(options = {}, view = {}) {
  await serve(options);
  take(await openPage(browser, server.address, view));
  return page;
}

export async function until(condition) {
  for (let i = 0; i < 100; ++i) {
    if (condition()) return;
    await new Promise((resolve) => setTimeout(resolve, 100));
  }
  assert.fail(`never true: ${condition}`);
}
