// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// The panel of services and hosts: state, drops, clocks, where objects are detected, what the links pass.

import { byId, el, setAttribute, setText } from "./dom.js";
import { count, metric, ms, rate, vendorName } from "./format.js";
import { badness, byHost, detectorLine, linkTopics, summarize } from "./services.js";

const kOld_ms = 2000;

export class SystemPanel {
  constructor() {
    this.rows = new Map();
    this.passed = new Map();   // topic of a link -> {messages, at_s, hz}
  }

  update(session, robot, connection, now_s) {
    const services = robot?.services ?? [];
    byId("services-none").hidden = services.length > 0;
    const summaries = byHost(services.map(summarize));
    const several = summaries.some(({ host }) => host !== summaries[0].host);
    this.#updateRows(several ? summaries : summaries.map((service) => ({ ...service, host: "" })));
    setText(byId("host"), summaries[0]?.host ?? "");
    byId("host-row").hidden = several || !summaries[0]?.host;
    setText(byId("detector"), detectorLine(services));
    byId("detector-row").hidden = detectorLine(services) === "";
    this.#updateLinks(services, now_s);
    this.#updatePage(session, connection);
  }

  #updateRows(summaries) {
    for (const name of [...this.rows.keys()]) {
      if (summaries.some((service) => service.name === name)) continue;
      this.rows.get(name).node.remove();
      this.rows.delete(name);
    }
    summaries.forEach((service, i) => {
      if (!this.rows.has(service.name)) this.rows.set(service.name, createRow(service.name));
      const row = this.rows.get(service.name), list = byId("services");
      if (list.children[i] !== row.node) list.insertBefore(row.node, list.children[i] ?? null);
      updateRow(row, service);
    });
  }

  #updateLinks(services, now_s) {
    const topics = linkTopics(services), list = byId("links");
    byId("links-row").hidden = topics.length === 0;
    for (const { direction, topic, messages } of topics) {
      const key = `${direction} ${topic}`, before = this.passed.get(key);
      if (!before) this.passed.set(key, { messages, at_s: now_s, hz: NaN });
      else if (now_s - before.at_s > 1) {
        this.passed.set(key, { messages, at_s: now_s, hz: Math.max(0, messages - before.messages) / (now_s - before.at_s) });
      }
    }
    const lines = topics.map(({ direction, topic, messages }) => {
      const { hz } = this.passed.get(`${direction} ${topic}`);
      return `${direction === "out" ? "→" : "←"} ${topic}: ${Number.isFinite(hz) ? `${hz.toFixed(1)} Hz` : count(messages)}`;
    });
    if (list.dataset.lines === lines.join("\n")) return;
    list.dataset.lines = lines.join("\n");
    list.replaceChildren(...lines.map((line) => el("li", {}, line)));
  }

  #updatePage({ hello, link }, { clock, reconnects }) {
    const parts = [];
    if (link) parts.push(rate(link.kBps), `${count(link.clients)} ${link.clients === 1 ? "page" : "pages"} open`);
    if (link?.dropped > 0) parts.push(`${count(link.dropped)} messages skipped`);
    if (Number.isFinite(clock.round_trip_ms)) parts.push(`round trip ${ms(clock.round_trip_ms)}`);
    if (Math.abs(clock.offset_ms) >= 1) parts.push(`server's clock ${clock.offset_ms > 0 ? "+" : ""}${ms(clock.offset_ms)}`);
    if (reconnects > 0) parts.push(`${reconnects} ${reconnects === 1 ? "reconnect" : "reconnects"}`);
    setText(byId("page-link"), parts.join(" · ") || "–");
    setText(byId("server"), hello ? `rtd-viewer ${hello.version}, DDS domain ${hello.domain}, ${vendorName(hello.vendor)}` : "–");
  }
}

function createRow(name) {
  const row = { state: el("span", { class: "service-state" }), place: el("span", { class: "muted" }), drops: el("span", { class: "drops" }),
                message: el("p", { class: "service-message" }), metrics: el("dl", { class: "metrics" }) };
  row.dot = el("i", { class: "dot" });
  const head = el("summary", {}, row.dot, el("b", {}, name), row.state, row.place, row.drops);
  row.node = el("li", {}, el("details", { class: "service" }, head, row.metrics), row.message);
  return row;
}

function updateRow(row, service) {
  const silent = service.age_ms > kOld_ms && badness[service.state] < 2 && service.state !== "finished";
  setAttribute(row.dot, "data-level", silent ? 2 : badness[service.state] ?? 1);
  setText(row.state, silent ? `silent for ${ms(service.age_ms)}` : service.state);
  setText(row.place, service.host);
  setText(row.drops, service.drops > 0 ? `${count(service.drops)} dropped` : "");
  const clocks = service.clocks.map(({ peer, offset_ms }) => `clock of ${peer} ${offset_ms > 0 ? "+" : ""}${ms(offset_ms)}`);
  const message = [service.message, ...service.troubles, ...clocks].filter(Boolean).join(" · ");
  setText(row.message, message);
  row.message.hidden = message === "";
  const values = service.metrics.map(([name, value]) => `${name} ${metric(value)}`).join("\n");
  if (row.values === values) return;
  row.values = values;
  row.metrics.replaceChildren(...service.metrics.flatMap(([name, value]) =>
    [el("dt", {}, name.replaceAll("_", " ")), el("dd", {}, metric(value))]));
}
