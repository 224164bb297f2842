// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/onnx_input_shape.hpp"

#include <vector>

namespace rtd::detector {
namespace {

constexpr int kGraphOfModel = 7, kInputOfGraph = 11, kTypeOfValueInfo = 2, kTensorOfType = 1, kShapeOfTensor = 2,
              kDimOfShape = 1, kValueOfDim = 1;
enum WireType : int { kVarint = 0, kFixed64 = 1, kLengthDelimited = 2, kFixed32 = 5 };

struct Span {
  const std::uint8_t* begin = nullptr;
  const std::uint8_t* end = nullptr;
  std::size_t size() const { return static_cast<std::size_t>(end - begin); }
};

struct Field {
  int number = 0;
  std::uint64_t varint = 0;  ///< wire type kVarint
  Span bytes;                ///< wire type kLengthDelimited
};

std::optional<std::uint64_t> take_varint(Span& span) {
  std::uint64_t value = 0;
  for (int shift = 0; shift < 64 && span.begin != span.end; shift += 7) {
    const std::uint8_t byte = *span.begin++;
    value |= std::uint64_t{byte & 0x7FU} << shift;
    if ((byte & 0x80U) == 0) return value;
  }
  return std::nullopt;
}

std::optional<Span> take_bytes(Span& span, std::uint64_t count) {
  if (count > span.size()) return std::nullopt;
  const Span taken{span.begin, span.begin + count};
  span.begin = taken.end;
  return taken;
}

/// The next field of a message; empty at its end or where it is malformed (then span.begin != span.end or it was cut).
std::optional<Field> take_field(Span& span) {
  const std::optional<std::uint64_t> key = take_varint(span);
  if (!key) return std::nullopt;
  Field field{static_cast<int>(*key >> 3U & 0x1FFFFFFFU), 0, {}};
  std::optional<Span> body;
  switch (static_cast<int>(*key & 7U)) {
    case kVarint: {
      const std::optional<std::uint64_t> value = take_varint(span);
      if (!value) return std::nullopt;
      field.varint = *value;
      return field;
    }
    case kFixed64:
      body = take_bytes(span, 8);
      break;
    case kFixed32:
      body = take_bytes(span, 4);
      break;
    case kLengthDelimited: {
      const std::optional<std::uint64_t> length = take_varint(span);
      if (length) body = take_bytes(span, *length);
      break;
    }
    default:
      return std::nullopt;
  }
  if (!body) return std::nullopt;
  field.bytes = *body;
  return field;
}

std::optional<Span> find_message(Span span, int number) {
  while (const std::optional<Field> field = take_field(span)) {
    if (field->number == number && field->bytes.begin != nullptr) return field->bytes;
  }
  return std::nullopt;
}

/// Dimensions of a ValueInfoProto; 0 stands for "not fixed".
std::vector<std::uint64_t> read_dimensions(Span value_info) {
  std::optional<Span> span = value_info;
  for (const int number : {kTypeOfValueInfo, kTensorOfType, kShapeOfTensor}) {
    span = find_message(*span, number);
    if (!span) return {};
  }
  std::vector<std::uint64_t> dimensions;
  while (const std::optional<Field> dimension = take_field(*span)) {
    if (dimension->number != kDimOfShape) continue;
    std::uint64_t value = 0;
    Span body = dimension->bytes;
    while (const std::optional<Field> field = take_field(body)) {
      if (field->number == kValueOfDim) value = field->varint;
    }
    dimensions.push_back(value);
  }
  return dimensions;
}

}  // namespace

OnnxInput read_onnx_input(const std::uint8_t* bytes, std::size_t size) {
  constexpr std::uint64_t kMaxSide = 8192;
  OnnxInput input;
  std::optional<Span> graph = find_message({bytes, bytes + size}, kGraphOfModel);
  input.has_graph = graph.has_value();
  while (graph) {
    const std::optional<Field> field = take_field(*graph);
    if (!field) break;
    if (field->number != kInputOfGraph || field->bytes.begin == nullptr) continue;
    const std::vector<std::uint64_t> dimensions = read_dimensions(field->bytes);
    if (dimensions.size() != 4 || dimensions[1] != 3) continue;
    const std::uint64_t height = dimensions[2], width = dimensions[3];
    if (height > 0 && width > 0 && height <= kMaxSide && width <= kMaxSide) {
      input.fixed = InputSize{static_cast<int>(width), static_cast<int>(height)};
    }
    break;
  }
  return input;
}

}  // namespace rtd::detector
