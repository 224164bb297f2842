// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// A server that speaks the protocol of rtd-viewer about a synthetic room, for work on the page and for its tests.
//   node fake_server.mjs [--port 8765] [--points 5000] [--keyframes 60] [--robots 1] [--read-only] [--no-replay] [--empty]
// The npm package ws is looked up in RTD_NODE_TOOLS, or Debian's node-ws is taken.

import { createReadStream } from "node:fs";
import { createServer } from "node:http";
import { createRequire } from "node:module";
import { extname, join, normalize } from "node:path";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";
import { FakeRobot } from "./fake_robot.mjs";

const kPage = fileURLToPath(new URL("../../../services/viewer/page/", import.meta.url));
const kMapPage = fileURLToPath(new URL("../../../common/map_page/map_page.html", import.meta.url));
const kThree = "/usr/share/javascript/three/";
const kTypes = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml" };
const kTick_ms = 33;

/** A package from the folder of the tests' npm packages, or from Debian's. */
export function requirePackage(name) {
  for (const folder of [process.env.RTD_NODE_TOOLS, "/usr/share/nodejs"]) {
    if (!folder) continue;
    const require = createRequire(join(folder, folder.endsWith("nodejs") ? name : "x", "x.js"));
    try {
      return folder.endsWith("nodejs") ? require(join(folder, name)) : require(name);
    } catch (error) {
      if (error.code !== "MODULE_NOT_FOUND") throw error;
    }
  }
  throw new Error(`the npm package ${name} is not installed`);
}

function answerHttp(request, response) {
  const path = normalize(new URL(request.url, "http://localhost").pathname);
  const file = path.startsWith("/three/") ? join(kThree, path.slice("/three/".length)) : path === "/map_page.html" ? kMapPage : join(kPage, path === "/" ? "index.html" : path);
  response.setHeader("content-type", kTypes[extname(file)] ?? "application/octet-stream");
  createReadStream(file).on("error", () => response.writeHead(404).end()).pipe(response);
}

export class FakeServer {
  /** options: of FakeRobot, and robots (how many), control, empty (no robot at all). */
  constructor(options = {}) {
    this.options = { robots: 1, control: true, lookToken: "picture", empty: false, ...options };
    this.robots = this.options.empty ? [] : Array.from({ length: this.options.robots }, (_, i) => new FakeRobot(i, this.options));
    this.calls = [];       // {name, argument} in the order of arrival
    this.wanted = [];      // options of the pages
    this.clients = new Set();
    this.sent = { text: 0, binary: 0 };
  }

  async start(port = 0) {
    const { WebSocketServer, Server } = requirePackage("ws");
    this.http = createServer(answerHttp).listen(port, "127.0.0.1");
    await new Promise((resolve, reject) => this.http.once("listening", resolve).once("error", reject));
    this.port = this.http.address().port;
    const Sockets = WebSocketServer ?? Server;
    this.sockets = new Sockets({ server: this.http, path: "/live", handleProtocols: () => "rtd.viewer.v1" });
    this.sockets.on("connection", (socket) => this.#welcome(socket));
    this.started_ms = Date.now();
    this.ticks = 0;
    this.timer = setInterval(() => this.#tick(), kTick_ms);
    return this;
  }

  get address() {
    return `http://127.0.0.1:${this.port}/`;
  }

  /** As if the process had been killed: no close handshake. */
  stop() {
    clearInterval(this.timer);
    for (const socket of this.clients) socket.terminate();
    this.http.closeAllConnections();
    return new Promise((resolve) => this.http.close(resolve));
  }

  /** To all pages: an object as JSON, or bytes. */
  send(message) {
    for (const socket of this.clients) this.#sendTo(socket, message);
  }

  #sendTo(socket, message) {
    const binary = Buffer.isBuffer(message), bytes = binary ? message : JSON.stringify(message);
    this.sent[binary ? "binary" : "text"] += bytes.length;
    socket.send(bytes, { binary });
  }

  #welcome(socket) {
    this.clients.add(socket);
    socket.on("close", () => this.clients.delete(socket));
    socket.on("message", (text) => this.#receive(socket, JSON.parse(text)));
    const names = this.robots.map(({ index, name }) => ({ index, name }));
    this.#sendTo(socket, { type: "hello", protocol: 1, version: "0.9.0", domain: 0, vendor: "fastdds",
                           control: this.options.control, look_token: this.options.lookToken, server_ms: Date.now() });
    this.#sendTo(socket, { type: "robots", robots: names });
    for (const robot of this.robots) {
      for (const message of robot.wholeState()) this.#sendTo(socket, message);
    }
  }

  #receive(socket, message) {
    if (message.op === "ping") this.#sendTo(socket, { type: "pong", sent_ms: message.sent_ms, server_ms: Date.now() });
    if (message.op === "options") this.wanted.push(message);
    if (message.op !== "call") return;
    this.calls.push({ name: message.name, argument: message.argument });
    const robot = this.robots.find(({ index }) => index === message.robot);
    const { answer, messages } = robot.call(message.name, message.argument);
    this.#sendTo(socket, { type: "answer", id: message.id, ...answer });
    for (const one of messages) this.send(one);
  }

  #tick() {
    this.ticks += 1;
    for (const robot of this.robots) {
      for (const message of robot.tick(this.ticks, kTick_ms / 1000)) this.send(message);
    }
    if (this.ticks % 30 === 0) this.send({ type: "link", kBps: 412, dropped: 0, clients: this.clients.size });
  }
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const { values } = parseArgs({ options: {
    port: { type: "string", default: "8765" }, points: { type: "string", default: "5000" }, keyframes: { type: "string", default: "60" },
    robots: { type: "string", default: "1" }, "read-only": { type: "boolean", default: false },
    "no-replay": { type: "boolean", default: false }, empty: { type: "boolean", default: false } } });
  const server = await new FakeServer({
    points: Number(values.points), keyframes: Number(values.keyframes), robots: Number(values.robots),
    control: !values["read-only"], replay: !values["no-replay"], empty: values.empty }).start(Number(values.port));
  console.log(`open ${server.address}`);
}
