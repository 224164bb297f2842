// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Reads a recording with @mcap/core, by index and as a stream, every CRC checked, and compares counts and payloads with
// what our reader found: node check_mcap.mjs FILE DIGEST.json. Messages of standard ROS types are decoded by the text
// of their schema, to the last byte.
import { crc32Final, crc32Init, crc32Update } from "@foxglove/crc";
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import { loadDecompressHandlers } from "@mcap/support";
import assert from "node:assert/strict";
import { open, readFile } from "node:fs/promises";

/** What McapIndexedReader asks of a file. */
class FileReadable {
  constructor(handle) { this.handle = handle; }
  async size() { return BigInt((await this.handle.stat()).size); }
  async read(offset, length) {
    const bytes = new Uint8Array(Number(length));
    const { bytesRead } = await this.handle.read(bytes, 0, bytes.length, Number(offset));
    assert.equal(bytesRead, bytes.length, "short read");
    return bytes;
  }
}

/** Counts and payload CRC of each topic. */
class Digest {
  topics = new Map();
  add(topic, data) {
    const entry = this.topics.get(topic) ?? { count: 0, crc: crc32Init() };
    entry.crc = crc32Update(entry.crc, data);
    ++entry.count;
    this.topics.set(topic, entry);
  }
  compareWith(expected) {
    assert.deepEqual([...this.topics.keys()].sort(), Object.keys(expected).sort(), "topics");
    for (const [name, { count, crc }] of this.topics) {
      assert.equal(count, expected[name].count, `messages on ${name}`);
      assert.equal(crc32Final(crc), expected[name].crc, `payloads on ${name}`);
    }
  }
}

/** One decoder for each channel whose schema is a ROS 2 definition. */
function makeDecoders(reader) {
  const decoders = new Map();
  for (const channel of reader.channelsById.values()) {
    const schema = reader.schemasById.get(channel.schemaId);
    if (schema?.encoding !== "ros2msg") continue;
    const definitions = parse(new TextDecoder().decode(schema.data), { ros2: true });
    decoders.set(channel.id, new MessageReader(definitions));
  }
  return decoders;
}

async function readByIndex(handle, decompressHandlers, expected) {
  const reader = await McapIndexedReader.Initialize({ readable: new FileReadable(handle), decompressHandlers });
  assert.equal(reader.header.profile, "ros2", "profile");
  const decoders = makeDecoders(reader);
  const digest = new Digest();
  let decoded = 0;
  for await (const message of reader.readMessages({ validateCrcs: true })) {
    digest.add(reader.channelsById.get(message.channelId).topic, message.data);
    const decoder = decoders.get(message.channelId);
    if (decoder === undefined) continue;
    decoder.readMessage(message.data);
    ++decoded;
  }
  digest.compareWith(expected.topics);
  return decoded;
}

async function readAsStream(file, decompressHandlers, expected) {
  const reader = new McapStreamReader({ decompressHandlers, validateCrcs: true });
  reader.append(await readFile(file));
  let count = 0;
  for (let record = reader.nextRecord(); record !== undefined; record = reader.nextRecord()) {
    if (record.type === "Message") ++count;
  }
  assert.ok(reader.done(), "the stream ends with a footer");
  const wanted = Object.values(expected.topics).reduce((sum, topic) => sum + topic.count, 0);
  assert.equal(count, wanted, "messages in the stream");
  return count;
}

const [file, digestFile] = process.argv.slice(2);
const expected = JSON.parse(await readFile(digestFile, "utf8"));
const handlers = await loadDecompressHandlers();
const handle = await open(file);
const decoded = await readByIndex(handle, handlers, expected);
await handle.close();
const count = await readAsStream(file, handlers, expected);
console.log(`@mcap/core: ${count} messages on ${Object.keys(expected.topics).length} topics equal, CRCs valid; ` +
            `${decoded} of standard types decoded by their schema`);
