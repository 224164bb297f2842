// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// What @mcap/core makes of a file, one line per message: topic, sequence, log_time, publish_time, data in hex.
//   node mcap_js.cjs PACKAGES stream FILE   in file order, all CRCs checked
//   node mcap_js.cjs PACKAGES index FILE    by index
//   node mcap_js.cjs PACKAGES write FILE    writes one with 50 messages, in two chunks
const fs = require("fs");
const path = require("path");
const [packages, action, file] = process.argv.slice(2);
const load = require("module").createRequire(path.join(path.resolve(packages), "from.js"));
const { McapStreamReader, McapIndexedReader, McapWriter } = load("@mcap/core");
const { loadDecompressHandlers } = load("@mcap/support");

function line(message, channel) {
  const data = Buffer.from(message.data).toString("hex");
  console.log(`${channel.topic} ${message.sequence} ${message.logTime} ${message.publishTime} ${data}`);
}

async function stream() {
  const reader = new McapStreamReader({ decompressHandlers: await loadDecompressHandlers(), validateCrcs: true });
  reader.append(fs.readFileSync(file));
  const channels = new Map();
  for (let record; (record = reader.nextRecord()); ) {
    if (record.type === "Channel") channels.set(record.id, record);
    if (record.type === "Message") line(record, channels.get(record.channelId));
  }
  if (!reader.done()) throw new Error("the stream reader wants more than the file has");
}

async function index() {
  const handle = await fs.promises.open(file);
  const readable = {
    size: async () => BigInt((await handle.stat()).size),
    read: async (offset, size) => {
      const buffer = new Uint8Array(Number(size));
      await handle.read(buffer, 0, buffer.length, Number(offset));
      return buffer;
    },
  };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers: await loadDecompressHandlers() });
  for await (const message of reader.readMessages({})) line(message, reader.channelsById.get(message.channelId));
  await handle.close();
}

async function write() {
  const parts = [];
  let position = 0n;
  const writable = {
    position: () => position,
    write: async (bytes) => {
      parts.push(Buffer.from(bytes));
      position += BigInt(bytes.byteLength);
    },
  };
  const writer = new McapWriter({ writable, chunkSize: 1500 });
  await writer.start({ profile: "ros2", library: "mcap_js" });
  const schemaId = await writer.registerSchema({ name: "a", encoding: "ros2msg", data: Buffer.from("int32 a") });
  const channelId = await writer.registerChannel({ schemaId, topic: "/a", messageEncoding: "cdr", metadata: new Map() });
  for (let i = 0; i < 50; ++i) {
    const time = BigInt(i);
    await writer.addMessage({ channelId, sequence: i, logTime: time, publishTime: time, data: Buffer.alloc(20, i) });
  }
  await writer.addAttachment({ name: "n", logTime: 1n, createTime: 1n, mediaType: "text/plain", data: Buffer.from("abc") });
  await writer.addMetadata({ name: "m", metadata: new Map([["k", "v"]]) });
  await writer.end();
  fs.writeFileSync(file, Buffer.concat(parts));
}

({ stream, index, write })[action]().catch((error) => {
  console.error(error);
  process.exit(1);
});
