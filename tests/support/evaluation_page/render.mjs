// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// Prints what a page of the evaluation shows: node render.mjs PAGE.html [WIDTH [WIDTH WHEN TURNED]]. A document of a few
// lines takes the place of a browser: it knows only what the page's script uses, and markup in a text stays text, as in a browser.

import { readFileSync } from "node:fs";
import vm from "node:vm";

const escaped = (text) => String(text).replace(/[&<>"']/g, (letter) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;", "'": "&#39;" })[letter]);

class Element {
  constructor(name) { Object.assign(this, { name, attributes: {}, children: [] }); }
  setAttribute(key, value) { this.attributes[key] = String(value); }
  getAttribute(key) { return this.attributes[key]; }
  append(...children) { this.children.push(...children); }
  replaceChildren(...children) { this.children = children; }
  toString() {
    return `<${this.name}${Object.entries(this.attributes).map(([key, value]) => ` ${key}="${escaped(value)}"`).join("")}>${this.children.map((child) => child instanceof Element ? child : escaped(child)).join("")}</${this.name}>`;
  }
}

const page = readFileSync(process.argv[2], "utf8"), main = new Element("main");
const [, dataText] = page.match(/<script type="application\/json" id="data">(.*?)<\/script>/s), [, script] = page.match(/<script>(.*?)<\/script>/s);
const document = {
  title: "",
  getElementById: (id) => ({ main, data: { textContent: dataText }, svg: { namespaceURI: "svg" } })[id],
  createElement: (name) => new Element(name),
  createElementNS: (space, name) => new Element(name),
};
let turned = () => {};
const window = { document, atob, URL, innerWidth: Number(process.argv[3] ?? 1280), location: new URL("file:///a run/report.html"),
                 requestAnimationFrame: (draw) => draw(), addEventListener: (event, handler) => { turned = handler; } };
vm.runInNewContext(script, window);
if (process.argv[4]) {
  window.innerWidth = Number(process.argv[4]);
  turned();
}
process.stdout.write(`<title>${escaped(document.title)}</title>${main}`);
