// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// Calls of runtime commands: every one gets an answer, if need be that there was none.

const kPatience_ms = 30_000;

export class Calls {
  /** send: message -> whether it was sent */
  constructor(send) {
    this.send = send;
    this.nextId = 1;
    this.open = new Map();
  }

  /** {success, message} of a command; argument: text. */
  call(robot, name, argument = "") {
    const id = this.nextId++;
    if (!this.send({ op: "call", id, robot, name, argument })) {
      return Promise.resolve({ success: false, message: "not sent: the page is not connected" });
    }
    return new Promise((resolve) => {
      const timer = setTimeout(
        () => this.answer({ id, success: false, message: `no answer for ${kPatience_ms / 1000} s` }), kPatience_ms);
      this.open.set(id, { resolve, timer });
    });
  }

  answer({ id, success, message }) {
    const waiting = this.open.get(id);
    if (!waiting) return;
    this.open.delete(id);
    clearTimeout(waiting.timer);
    waiting.resolve({ success, message });
  }

  /** The connection is closed: it is unknown what became of the open calls. */
  abandon() {
    for (const id of [...this.open.keys()]) {
      this.answer({ id, success: false, message: "the connection closed before the answer came" });
    }
  }
}
