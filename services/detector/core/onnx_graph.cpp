// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/onnx_graph.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <set>

#include "services/detector/core/protobuf_wire.hpp"

namespace rtd::detector {
namespace {

using protobuf::Field, protobuf::Span, protobuf::append_numbers, protobuf::find_message, protobuf::take_field,
    protobuf::text_of;

static_assert(std::endian::native == std::endian::little, "ONNX keeps numbers in this order");

// Field numbers of onnx.proto.
namespace model {
constexpr int kGraph = 7;
}
namespace graph {
constexpr int kNode = 1, kInitializer = 5, kInput = 11, kOutput = 12;
}
namespace value_info {
constexpr int kName = 1;
}
namespace node {
constexpr int kInput = 1, kOutput = 2, kName = 3, kOperator = 4, kAttribute = 5;
}
namespace attribute {
constexpr int kName = 1, kReal = 2, kNumber = 3, kText = 4, kTensor = 5, kNumbers = 8;
}
namespace tensor {
constexpr int kDims = 1, kType = 2, kFloats = 4, kInts = 7, kName = 8, kRaw = 9;
constexpr std::uint64_t kFloatType = 1, kInt64Type = 7;
}  // namespace tensor

[[noreturn]] void malformed(const std::string& what) {
  throw OnnxGraphError("the ONNX file is malformed: " + what);
}

template <class Number>
void append_raw(Span bytes, std::vector<Number>& numbers) {
  const std::size_t before = numbers.size(), more = bytes.size() / sizeof(Number);
  numbers.resize(before + more);
  if (more > 0) std::memcpy(numbers.data() + before, bytes.data(), more * sizeof(Number));
}

std::uint64_t elements_of(const std::vector<std::int64_t>& shape) {
  constexpr std::uint64_t kMost = std::uint64_t{1} << 32U;
  std::uint64_t elements = 1;
  for (const std::int64_t side : shape) {
    if (side < 0 || static_cast<std::uint64_t>(side) > kMost) malformed("a tensor of no size");
    elements *= static_cast<std::uint64_t>(side);
    if (elements > kMost) malformed("a tensor of no size");
  }
  return elements;
}

OnnxTensor read_tensor(Span span) {
  OnnxTensor read;
  std::uint64_t type = 0;
  Span raw;
  while (const std::optional<Field> field = take_field(span)) {
    if (field->number == tensor::kType) type = field->varint;
    if (field->number == tensor::kRaw) raw = field->bytes;
    if (field->number == tensor::kFloats) append_raw(field->bytes, read.floats);  // packed, or one at a time: the same
    if (field->number == tensor::kDims && !append_numbers(*field, read.shape)) malformed("the shape of a tensor");
    if (field->number == tensor::kInts && !append_numbers(*field, read.ints)) malformed("the numbers of a tensor");
  }
  read.is_float = type == tensor::kFloatType;
  if (read.is_float) append_raw(raw, read.floats);
  if (type == tensor::kInt64Type) append_raw(raw, read.ints);
  const bool known = read.is_float || type == tensor::kInt64Type;
  if (known && elements_of(read.shape) != (read.is_float ? read.floats.size() : read.ints.size()))
    malformed("a tensor has not the elements of its shape");
  return read;
}

OnnxAttribute read_attribute(Span span, std::string& name) {
  OnnxAttribute read;
  while (const std::optional<Field> field = take_field(span)) {
    if (field->number == attribute::kName) name = text_of(field->bytes);
    if (field->number == attribute::kNumber) read.number = static_cast<std::int64_t>(field->varint);
    if (field->number == attribute::kText) read.text = text_of(field->bytes);
    if (field->number == attribute::kTensor) read.tensor = read_tensor(field->bytes);
    if (field->number == attribute::kReal && field->bytes.size() == sizeof(float))
      std::memcpy(&read.real, field->bytes.data(), sizeof(float));
    if (field->number == attribute::kNumbers && !append_numbers(*field, read.numbers)) malformed("an attribute");
  }
  return read;
}

OnnxNode read_node(Span span) {
  OnnxNode read;
  while (const std::optional<Field> field = take_field(span)) {
    if (field->number == node::kInput) read.inputs.push_back(text_of(field->bytes));
    if (field->number == node::kOutput) read.outputs.push_back(text_of(field->bytes));
    if (field->number == node::kName) read.name = text_of(field->bytes);
    if (field->number == node::kOperator) read.op = text_of(field->bytes);
    if (field->number == node::kAttribute) {
      std::string name;
      OnnxAttribute value = read_attribute(field->bytes, name);
      read.attributes.insert_or_assign(name, std::move(value));
    }
  }
  if (read.outputs.empty()) malformed("a node without output");
  return read;
}

/// The outputs of Constant nodes are constants as the initializers are.
void add_node(OnnxNode node, OnnxGraph& read) {
  const auto value = node.attributes.find("value");
  if (node.op == "Constant" && value != node.attributes.end() && value->second.tensor) {
    read.constants.insert_or_assign(node.outputs.front(), std::move(*value->second.tensor));
  } else {
    read.nodes.push_back(std::move(node));
  }
}

/// Every input was made before, and no name twice.
void check_order(const OnnxGraph& read) {
  std::set<std::string> made(read.inputs.begin(), read.inputs.end());
  for (const auto& [name, constant] : read.constants) made.insert(name);
  for (const OnnxNode& node : read.nodes) {
    for (const std::string& input : node.inputs) {
      if (!input.empty() && !made.contains(input))
        malformed(node.op + " " + node.name + " uses '" + input + "' too early");
    }
    for (const std::string& output : node.outputs) {
      if (!made.insert(output).second) malformed("'" + output + "' is made twice");
    }
  }
  for (const std::string& output : read.outputs) {
    if (!made.contains(output)) malformed("nothing makes the output '" + output + "'");
  }
}

}  // namespace

OnnxGraph read_onnx_graph(std::span<const std::uint8_t> onnx) {
  std::optional<Span> bytes = find_message(onnx, model::kGraph);
  if (!bytes) throw OnnxGraphError("these bytes are not an ONNX model");
  OnnxGraph read;
  while (const std::optional<Field> field = take_field(*bytes)) {
    if (field->bytes.data() == nullptr) continue;
    const auto name = [&](int number) { return text_of(find_message(field->bytes, number)); };
    if (field->number == graph::kNode) add_node(read_node(field->bytes), read);
    if (field->number == graph::kInitializer)
      read.constants.insert_or_assign(name(tensor::kName), read_tensor(field->bytes));
    if (field->number == graph::kInput) read.inputs.push_back(name(value_info::kName));
    if (field->number == graph::kOutput) read.outputs.push_back(name(value_info::kName));
  }
  std::erase_if(read.inputs, [&](const std::string& input) { return read.constants.contains(input); });
  check_order(read);
  return read;
}

}  // namespace rtd::detector
