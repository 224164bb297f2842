// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Our CDR bytes against @foxglove/rosmsg2-serialization: node check_cdr.mjs TYPES.jsonl OURS.jsonl THEIRS.jsonl
// Definitions are those of @foxglove/rosmsg-msgs-common, of vision_msgs those of TYPES. Decodes and writes our samples,
// then writes samples with values of its own for us to check.
import { parse } from "@foxglove/rosmsg";
import { ros2humble } from "@foxglove/rosmsg-msgs-common";
import { MessageReader, MessageWriter } from "@foxglove/rosmsg2-serialization";
import assert from "node:assert/strict";
import { readFile, writeFile } from "node:fs/promises";

const kSamples = 50;  // of a type

const [types_file, ours, theirs] = process.argv.slice(2);

const jsonLines = async (file) => (await readFile(file, "utf8")).trim().split("\n").map((line) => JSON.parse(line));

/** Our texts of the message types. */
const ownTexts = new Map((await jsonLines(types_file)).map(({ type, text }) => [type, text]));

function parseOwn(type) {
  const [definition] = parse(ownTexts.get(type), { ros2: true, skipTypeFixup: true });
  const local = `${type.split("/")[0]}/`;
  for (const field of definition.definitions) {
    if (field.isComplex && !field.type.includes("/")) field.type = local + field.type;
  }
  return { name: type, definitions: definition.definitions };
}

/** Their definitions by name, with ours of vision_msgs, which they do not have. */
function allDefinitions() {
  const all = { ...ros2humble };
  for (const type of ownTexts.keys()) if (type.startsWith("vision_msgs/")) all[type] = parseOwn(type);
  return all;
}

/** A definition and all that it is made of. */
function closure(type, all, found = new Map()) {
  if (found.has(type)) return found;
  found.set(type, all[type]);
  assert.ok(all[type], `definition of ${type}`);
  for (const field of all[type].definitions) if (field.isComplex) closure(field.type, all, found);
  return found;
}

const kTimes = { "builtin_interfaces/Time": "time", "builtin_interfaces/Duration": "duration" };
const shape = (definition) => definition.definitions.filter((field) => !field.isConstant)
  .map((field) => [kTimes[field.type] ?? field.type, field.name, field.isArray ?? false, field.arrayLength ?? null]);

/** Typed arrays as plain ones, as JSON has them. */
function plain(value) {
  if (ArrayBuffer.isView(value)) return Array.from(value);
  if (Array.isArray(value)) return value.map(plain);
  if (value === null || typeof value !== "object") return value;
  return Object.fromEntries(Object.entries(value).map(([name, field]) => [name, plain(field)]));
}

const below = (limit) => Math.floor(Math.random() * limit);
const kRandom = {
  bool: () => below(2) === 1,
  int8: () => below(256) - 128,
  uint8: () => below(256),
  int32: () => below(2 ** 32) - 2 ** 31,
  uint32: () => below(2 ** 32),
  float32: () => Math.fround(kRandom.float64()),
  float64: () => (Math.random() - 0.5) * 10 ** below(9),
  string: () => "abcdefgh/_ 0123".repeat(3).slice(0, below(40)),
  time: () => ({ sec: kRandom.int32(), nanosec: below(1e9) }),
  duration: () => kRandom.time(),
};

function randomValue(type, all) {
  if (kRandom[type]) return kRandom[type]();
  const value = {};
  for (const field of all[type].definitions) {
    if (field.isConstant) continue;
    const one = () => randomValue(field.type, all);
    value[field.name] = field.isArray ? Array.from({ length: field.arrayLength ?? below(4) }, one) : one();
  }
  return value;
}

const all = allDefinitions();
const samples = await jsonLines(ours);
const types = [...new Set(samples.map(({ type }) => type))];
const used = new Set(types.flatMap((type) => [...closure(type, all).keys()]));
let compared = 0;
for (const type of used) {  // our texts against theirs: a viewer goes by ours
  if (type.startsWith("vision_msgs/")) continue;
  assert.deepEqual(shape(parseOwn(type)), shape(all[type]), `fields of ${type}`);
  ++compared;
}

const codecs = new Map(types.map((type) => {
  const definitions = [...closure(type, all).values()];
  return [type, { reader: new MessageReader(definitions), writer: new MessageWriter(definitions) }];
}));
for (const { type, value, cdr } of samples) {
  const { reader, writer } = codecs.get(type);
  const bytes = Buffer.from(cdr, "hex");
  assert.deepEqual(plain(reader.readMessage(bytes)), value, `${type}: they read other values`);
  assert.equal(Buffer.from(writer.writeMessage(value)).toString("hex"), cdr, `${type}: they write other bytes`);
}

const lines = [];
for (const type of types) {
  for (let i = 0; i < kSamples; ++i) {
    const value = randomValue(type, all);
    const bytes = codecs.get(type).writer.writeMessage(value);
    assert.deepEqual(plain(codecs.get(type).reader.readMessage(bytes)), value, `${type}: they read what they write`);
    lines.push(JSON.stringify({ type, value, cdr: Buffer.from(bytes).toString("hex") }));
  }
}
await writeFile(theirs, lines.join("\n") + "\n");
console.log(`@foxglove/rosmsg2-serialization: ${samples.length} of our samples of ${types.length} types equal, both ways; ` +
            `the fields of ${compared} type texts equal`);
