// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// The WebSocket to rtd-viewer: opens it, opens it again when it closes, measures the server's clock.

import { ClockOffset } from "./clock.js";

export const kSubprotocol = "rtd.viewer.v1";
const kFirstRetry_ms = 500;
const kLongestRetry_ms = 5000;
const kPing_ms = 2000;
const kSilence_ms = 8000;      // the server sends something every second

/** ws://HOST/live for the page's own address, with its token. */
export function liveAddress(location) {
  const token = new URLSearchParams(location.search).get("token");
  const scheme = location.protocol === "https:" ? "wss:" : "ws:";
  return `${scheme}//${location.host}/live${token ? `?token=${encodeURIComponent(token)}` : ""}`;
}

/** Waiting time before attempt number `attempt` (from 0) after a connection was lost. */
export const retryDelay_ms = (attempt) => Math.min(kLongestRetry_ms, kFirstRetry_ms * 2 ** attempt);

export class Connection {
  /** on: {open(), text(message), binary(buffer), close()} */
  constructor(address, on) {
    this.address = address;
    this.on = on;
    this.state = "connecting";   // connecting, open, closed
    this.reconnects = 0;
    this.clock = new ClockOffset();
    this.opened = false;
    this.attempt = 0;
    setInterval(() => this.#watch(), kPing_ms);
    this.connect();
  }

  /** Without the token: for people. */
  get shownAddress() {
    return this.address.replace(/\?.*/, "");
  }

  get retry_s() {
    return this.state === "closed" ? Math.max(0, Math.ceil((this.retryAt_ms - performance.now()) / 1000)) : 0;
  }

  connect() {
    clearTimeout(this.timer);
    this.received_ms = performance.now();
    const socket = new WebSocket(this.address, kSubprotocol);
    this.socket = socket;
    socket.binaryType = "arraybuffer";
    socket.onopen = () => this.#open();
    socket.onclose = () => this.#closed(socket);
    socket.onmessage = ({ data }) => this.#receive(data);
  }

  /** For the impatient: the next attempt now. */
  retryNow() {
    if (this.state === "closed" && this.socket.readyState === WebSocket.CLOSED) this.connect();
  }

  /** False when nothing can be sent now. */
  send(message) {
    if (this.state !== "open") return false;
    this.socket.send(JSON.stringify(message));
    return true;
  }

  #open() {
    this.state = "open";
    this.attempt = 0;
    this.reconnects += this.opened ? 1 : 0;
    this.opened = true;
    this.clock = new ClockOffset();
    this.on.open();
    this.#ping();
  }

  #closed(socket) {
    if (socket !== this.socket) return;
    this.state = "closed";
    const delay_ms = retryDelay_ms(this.attempt++);
    this.retryAt_ms = performance.now() + delay_ms;
    this.timer = setTimeout(() => this.connect(), delay_ms);
    this.on.close();
  }

  #receive(data) {
    this.received_ms = performance.now();
    if (typeof data !== "string") {
      this.on.binary(data);
      return;
    }
    const message = JSON.parse(data);
    if (message.type === "pong") this.clock.add(message.sent_ms, message.server_ms, Date.now());
    this.on.text(message);
  }

  #ping() {
    this.send({ op: "ping", sent_ms: Date.now() });
  }

  /** A host that vanished closes nothing: silence does. */
  #watch() {
    if (this.state !== "open") return;
    if (performance.now() - this.received_ms > kSilence_ms) {
      const silent = this.socket;
      silent.close();
      this.#closed(silent);
      silent.onclose = silent.onmessage = null;
    } else {
      this.#ping();
    }
  }
}
