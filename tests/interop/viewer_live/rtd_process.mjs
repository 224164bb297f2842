// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// Services of RTD-SLAM as child processes.

import { spawn } from "node:child_process";
import { setTimeout as sleep } from "node:timers/promises";

const kRtd = process.env.RTD_EXECUTABLE ?? "build/release/bin/rtd";
export const kDomain = process.env.RTD_TEST_DOMAIN ?? "92";

export class Service {
  constructor(name, ...args) {
    this.output = "";
    this.process = spawn(kRtd, [name, "--domain", kDomain, ...args]);
    for (const stream of [this.process.stdout, this.process.stderr]) stream.on("data", (text) => { this.output += text; });
    this.ended = new Promise((resolve) => this.process.on("exit", resolve));
  }
  async waitFor(pattern, seconds = 30) {
    for (const until = Date.now() + 1000 * seconds; Date.now() < until; await sleep(50)) {
      const found = this.output.match(pattern);
      if (found) return found;
    }
    throw new Error(`${pattern} was not printed: ${this.output}`);
  }
  async stop(signal = "SIGINT") {
    if (this.process.exitCode === null && this.process.signalCode === null) this.process.kill(signal);
    return this.ended;
  }
}

/** A viewer on a port of its own; address: of its page, socket: for clients; both with the token for commands. */
export async function startViewer(...args) {
  const viewer = new Service("viewer", ...(args.length > 0 ? args : ["--port", "0"]));
  const [, address, port] = await viewer.waitFor(/viewer: (http:\/\/[^/]*:(\d+)\/\S*)/);
  return Object.assign(viewer, { address, port, socket: address.replace("http:", "ws:") });
}

export const stopAll = (services) => Promise.all(services.filter(Boolean).map((service) => service.stop()));
