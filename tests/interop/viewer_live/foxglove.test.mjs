// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0

// The viewer with Foxglove's own client library: channels, messages decoded by their schemas, services, parameters.

import assert from "node:assert/strict";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { requirePackage } from "../../support/viewer_page/fake_server.mjs";
import { Service, startViewer, stopAll } from "./rtd_process.mjs";

const { FoxgloveClient } = requirePackage("@foxglove/ws-protocol");
const { parse } = requirePackage("@foxglove/rosmsg");
const { MessageReader } = requirePackage("@foxglove/rosmsg2-serialization");
const WebSocket = requirePackage("ws");
const kPatience_ms = 30_000, kRecorded_ms = 2500;

let services = [], client, viewer;
const complaints = [];   // of the client library about what it got
const channels = new Map(), offered = new Map();
const graph = { published: new Map(), subscribed: new Map(), services: new Map() };
let info;

before(async () => {
  viewer = await startViewer();
  services = [viewer, new Service("slam"), new Service("filter", "--set", "filter.detector=off"),
              new Service("camera", "--source", "synthetic:office?frames=0", "--wait-for", "filter,slam")];
  client = new FoxgloveClient({ ws: new WebSocket(viewer.socket, [FoxgloveClient.SUPPORTED_SUBPROTOCOL]) });
  client.on("serverInfo", (message) => { info = message; });
  client.on("error", (error) => complaints.push(error.message));
  client.on("advertise", (list) => list.forEach((channel) => channels.set(channel.topic, channel)));
  client.on("advertiseServices", (list) => list.forEach((service) => offered.set(service.name, service)));
  client.on("connectionGraphUpdate", (message) => {
    for (const { name, publisherIds } of message.publishedTopics) graph.published.set(name, publisherIds);
    for (const { name, subscriberIds } of message.subscribedTopics) graph.subscribed.set(name, subscriberIds);
    for (const { name, providerIds } of message.advertisedServices) graph.services.set(name, providerIds);
  });
});
after(async () => {
  client.close();
  await stopAll(services);
});

/** What `look` returns once it is there. */
async function eventually(look, what) {
  for (const until = Date.now() + kPatience_ms; Date.now() < until; await new Promise((wake) => setTimeout(wake, 50))) {
    const found = look();
    if (found) return found;
  }
  throw new Error(`${what} did not come`);
}

function nextMessage(channel) {
  const subscription = client.subscribe(channel.id);
  return new Promise((resolve, reject) => {
    const timer = setTimeout(() => reject(new Error(`no message on ${channel.topic}`)), kPatience_ms);
    const take = (event) => {
      if (event.subscriptionId !== subscription) return;
      clearTimeout(timer);
      client.off("message", take);
      client.unsubscribe(subscription);
      resolve(event);
    };
    client.on("message", take);
  });
}

test("the server introduces itself", async () => {
  await eventually(() => info, "serverInfo");
  for (const capability of ["time", "parameters", "services", "connectionGraph"])
    assert.ok(info.capabilities.includes(capability), capability);
  assert.ok(!info.capabilities.includes("clientPublish"), "off by default");
});

for (const topic of ["/slam/odometry", "/tf", "/camera/color/image_raw/compressed", "rtd/tracking", "rtd/status", "rtd/map"])
  test(`messages of ${topic} are read by their schema`, async () => {
    const channel = await eventually(() => channels.get(topic), topic);
    assert.equal(channel.schemaEncoding, "ros2msg");
    const reader = new MessageReader(parse(channel.schema, { ros2: true }));
    const event = await nextMessage(channel);
    assert.ok(Math.abs(Number(event.timestamp) * 1e-6 - Date.now()) < 10_000, "log time");
    const message = reader.readMessage(event.data);
    if (topic === "/slam/odometry") assert.equal(message.header.frame_id, "odom");
    if (topic === "rtd/status") assert.ok(["camera", "slam", "filter", "viewer"].includes(message.service));
    if (topic === "rtd/tracking") assert.ok(message.landmarks > 0);
  });

test("the graph names who publishes, subscribes and answers", async () => {
  client.subscribeConnectionGraph();
  for (const [part, name, who] of [
    ["published", "/slam/odometry", "rtd-slam"], ["published", "rtd/features", "rtd-filter"],
    ["subscribed", "rtd/features", "rtd-slam"], ["subscribed", "rtd/frame", "rtd-filter"],
    ["services", "/slam/reset", "rtd-slam"],
  ])
    await eventually(() => graph[part].get(name)?.includes(who), `${who} at ${name} in ${part}`);
});

test("commands are services and settings are parameters", async () => {
  const service = await eventually(() => offered.get("/filter/set_mode"), "/filter/set_mode");
  const answer = new Promise((resolve) => client.on("serviceCallResponse", resolve));
  const request = new TextEncoder().encode(JSON.stringify({ argument: "geometry" }));
  client.sendServiceCallRequest({ serviceId: service.id, callId: 5, encoding: "json", data: new DataView(request.buffer) });
  const { callId, data } = await answer;
  assert.equal(callId, 5);
  assert.equal(JSON.parse(new TextDecoder().decode(data)).success, true);

  let parameters = [];
  client.on("parameterValues", (message) => { parameters = message.parameters; });
  await eventually(() => {
    client.getParameters(["filter.mode"], "q");
    return parameters.some(({ name, value }) => name === "filter.mode" && value === "geometry");
  }, "filter.mode = geometry");
});

test("a parameter that is set acts, is answered with its new value, and is reported to who subscribed", async () => {
  const answers = [], complaintsOfServer = [];
  client.on("parameterValues", (message) => answers.push(message));
  client.on("status", (message) => complaintsOfServer.push(message.message));
  client.subscribeParameterUpdates(["slam.localize_only"]);
  const valueIn = (message) => message.parameters.find(({ name }) => name === "slam.localize_only")?.value;
  client.setParameters([{ name: "slam.localize_only", value: true }], "set");
  const answer = await eventually(() => answers.find(({ id }) => id === "set"), "the answer");
  assert.equal(valueIn(answer), true);
  await eventually(() => answers.some((message) => message.id === undefined && valueIn(message) === true), "the update");
  client.setParameters([{ name: "filter.mode", value: "nonsense" }], "refused");
  const refused = await eventually(() => answers.find(({ id }) => id === "refused"), "the answer to what is wrong");
  assert.equal(refused.parameters[0].value, "geometry", "it stays");
  assert.match(complaintsOfServer.join(), /filter\.mode.*nonsense/);
});

/** A client of foxglove.sdk.v1, which knows playback control; Foxglove's library of above does not. */
class PlaybackClient {
  constructor(address) {
    this.states = [];
    this.times_ns = [];
    this.messages = [];
    this.channels = new Map();
    this.socket = new WebSocket(address, ["foxglove.sdk.v1"]);
    this.socket.on("message", (data, binary) => (binary ? this.#binary(data) : this.#text(JSON.parse(data))));
  }
  control({ pause, speed = 1, seek_ns, id }) {
    const name = Buffer.from(id), message = Buffer.alloc(19 + name.length);
    message.writeUInt8(3, 0);
    message.writeUInt8(pause ? 1 : 0, 1);
    message.writeFloatLE(speed, 2);
    message.writeUInt8(seek_ns === undefined ? 0 : 1, 6);
    message.writeBigUInt64LE(seek_ns ?? 0n, 7);
    message.writeUInt32LE(name.length, 15);
    name.copy(message, 19);
    this.socket.send(message);
    return eventually(() => this.states.find((state) => state.id === id), `the state after ${id}`);
  }
  #text(message) {
    if (message.op === "serverInfo") {
      this.info = message;
      this.times_ns = [];   // those before were of another clock
    }
    if (message.op === "advertise") for (const channel of message.channels) this.channels.set(channel.topic, channel.id);
  }
  #binary(data) {
    if (data[0] === 1) this.messages.push(data.readBigUInt64LE(5));
    if (data[0] === 2) this.times_ns.push(data.readBigUInt64LE(1));
    if (data[0] === 5) {
      this.states.push({ status: data[1], now_ns: data.readBigUInt64LE(2), speed: data.readFloatLE(10), did_seek: data[14] === 1,
                         id: data.subarray(19, 19 + data.readUInt32LE(15)).toString() });
    }
  }
}

const ns = ({ sec, nsec }) => BigInt(sec) * 1_000_000_000n + BigInt(nsec);

test("Foxglove's playback controls act on a replay, in recorded time", async () => {
  const folder = mkdtempSync(join(tmpdir(), "rtd_foxglove_")), recording = join(folder, "run.mcap");
  const recorder = new Service("record", "--topics", "rtd/tracking", "-o", recording);
  await recorder.waitFor(/event=/);
  await new Promise((wake) => setTimeout(wake, kRecorded_ms));
  await recorder.stop();
  await stopAll(services.filter((service) => service !== viewer));
  const replay = new Service("replay", recording, "--loop");
  services = [viewer, replay];
  const player = new PlaybackClient(viewer.socket);
  try {
    await eventually(() => player.info?.capabilities.includes("playbackControl"), "playback control");
    const begin_ns = ns(player.info.dataStartTime), end_ns = ns(player.info.dataEndTime);
    assert.ok(end_ns - begin_ns > 1_000_000_000n, `${end_ns - begin_ns} ns`);
    player.socket.send(JSON.stringify({ op: "subscribe", subscriptions: [
      { id: 1, channelId: player.channels.get("rtd/tracking") }, { id: 2, channelId: player.channels.get("rtd/status") }] }));
    await eventually(() => player.messages.length > 20 && player.times_ns.length > 1, "messages of the recording and of now");
    for (const time_ns of [...player.messages, ...player.times_ns])
      assert.ok(time_ns >= begin_ns && time_ns <= end_ns, `${time_ns} is not from ${begin_ns} to ${end_ns}`);

    const paused = await player.control({ pause: true, seek_ns: begin_ns + 1_000_000_000n, id: "seek" });
    assert.deepEqual({ ...paused, now_ns: 0 }, { status: 1, now_ns: 0, speed: 1, did_seek: true, id: "seek" });
    assert.equal(paused.now_ns, begin_ns + 1_000_000_000n);
    await eventually(() => player.states.at(-1).id === "" && player.states.at(-1).status === 1, "the replay's own word on it");
    assert.ok(player.states.at(-1).now_ns - paused.now_ns < 100_000_000n);
    const faster = await player.control({ pause: false, speed: 0.5, id: "speed" });
    assert.deepEqual([faster.status, faster.speed, faster.did_seek], [0, 0.5, false]);
    await eventually(() => player.states.at(-1).id === "" && player.states.at(-1).speed === 0.5, "the speed in a heartbeat");
  } finally {
    player.socket.close();
    await replay.stop();
    rmSync(folder, { recursive: true });
  }
});

test("Foxglove's client library understood everything", () => assert.deepEqual(complaints, []));
