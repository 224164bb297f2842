// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/onnx_file.hpp"

#include <algorithm>
#include <set>
#include <span>
#include <sstream>

#include "common/io/byte_sink.hpp"
#include "common/io/input_file.hpp"
#include "services/detector/core/detector_config.hpp"

namespace rtd::detector {

void ModelName::refuse(const std::string& cause) const {
  throw ModelError(kind + " '" + path + "': " + cause + "; run `deploy/setup.sh --models`, or name another file with " +
                   key);
}

std::vector<std::uint8_t> read_model_file(const ModelName& model) {
  try {
    const std::string content = io::read_file(model.path, io::kNetwork);
    if (content.empty()) model.refuse("is empty");
    return {content.begin(), content.end()};
  } catch (const io::IoError& error) {
    model.refuse(error.what());
  }
}

namespace {

// Protobuf's wire format, without its library. Nothing here reads outside the bytes, whatever they hold.

using Span = std::span<const std::uint8_t>;

struct Field {
  int number = 0;
  std::uint64_t varint = 0;  ///< of a field that is a number
  Span bytes;                ///< of all others; no data() for a number
};

enum WireType : int { kVarint = 0, kFixed64 = 1, kLengthDelimited = 2, kFixed32 = 5 };

/// Takes the first bytes off a span; empty when it has less.
std::optional<Span> take_bytes(Span& span, std::uint64_t count) {
  if (count > span.size()) return std::nullopt;
  const Span taken = span.first(count);
  span = span.subspan(count);
  return taken;
}

std::optional<std::uint64_t> take_varint(Span& span) {
  std::uint64_t value = 0;
  for (int shift = 0; shift < 64 && !span.empty(); shift += 7) {
    const std::uint8_t byte = take_bytes(span, 1)->front();
    value |= std::uint64_t{byte & 0x7FU} << shift;
    if ((byte & 0x80U) == 0) return value;
  }
  return std::nullopt;
}

/// The next field of a message; empty at its end or where it is malformed.
std::optional<Field> take_field(Span& span) {
  const std::optional<std::uint64_t> key = take_varint(span);
  if (!key) return std::nullopt;
  Field field{static_cast<int>(*key >> 3U & 0x1FFFFFFFU), 0, {}};
  const int wire_type = static_cast<int>(*key & 7U);
  std::optional<std::uint64_t> number;  // the value of a varint, the length of other fields
  if (wire_type == kVarint || wire_type == kLengthDelimited) number = take_varint(span);
  if (wire_type == kFixed64) number = 8;
  if (wire_type == kFixed32) number = 4;
  if (!number) return std::nullopt;
  if (wire_type == kVarint) {
    field.varint = *number;
    return field;
  }
  const std::optional<Span> body = take_bytes(span, *number);
  if (!body) return std::nullopt;
  field.bytes = *body;
  return field;
}

/// The first field of this number that is no number itself.
std::optional<Span> find_message(Span span, int number) {
  while (const std::optional<Field> field = take_field(span)) {
    if (field->number == number && field->bytes.data() != nullptr) return field->bytes;
  }
  return std::nullopt;
}

std::string text_of(const std::optional<Span>& span) {
  return span ? std::string(span->begin(), span->end()) : std::string();
}

constexpr int kGraphOfModel = 7, kMetadataOfModel = 14, kKeyOfEntry = 1, kValueOfEntry = 2, kInputOfGraph = 11,
              kTypeOfValueInfo = 2, kTensorOfType = 1, kShapeOfTensor = 2, kDimOfShape = 1, kValueOfDim = 1,
              kInitializerOfGraph = 5, kDimsOfTensor = 1, kDataTypeOfTensor = 2, kIntsOfTensor = 7, kNameOfTensor = 8,
              kRawOfTensor = 9, kNodeOfGraph = 1, kInputOfNode = 1, kOutputOfNode = 2, kOperatorOfNode = 4,
              kAttributeOfNode = 5, kTensorOfAttribute = 5;
constexpr std::uint64_t kFloat = 1, kInt64 = 7;

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

void read_image_input(Span graph, OnnxFile& file) {
  constexpr std::uint64_t kMaxSide = 8192;
  while (const std::optional<Field> field = take_field(graph)) {
    if (field->number != kInputOfGraph || field->bytes.data() == nullptr) continue;
    const std::vector<std::uint64_t> dimensions = read_dimensions(field->bytes);
    if (dimensions.size() != 4 || dimensions[1] != 3) continue;
    const std::uint64_t height = dimensions[2], width = dimensions[3];
    file.free_batch = dimensions[0] == 0;
    if (height == 0 || width == 0 || height > kMaxSide || width > kMaxSide) return;
    file.input = InputSize{static_cast<int>(width), static_cast<int>(height)};
    return;
  }
}

/// Elements of a TensorProto of floats, 0 for other types. `dims` may be packed or not.
std::uint64_t count_floats(Span tensor) {
  std::uint64_t elements = 1, type = 0;
  while (const std::optional<Field> field = take_field(tensor)) {
    if (field->number == kDataTypeOfTensor) type = field->varint;
    if (field->number != kDimsOfTensor) continue;
    if (field->bytes.data() == nullptr) elements *= field->varint;
    Span packed = field->bytes;
    while (!packed.empty()) {
      const std::optional<std::uint64_t> dimension = take_varint(packed);
      if (!dimension) return 0;
      elements *= *dimension;
    }
  }
  return type == kFloat ? elements : 0;
}

std::uint64_t count_parameters(Span graph) {
  std::uint64_t parameters = 0;
  while (const std::optional<Field> field = take_field(graph)) {
    if (field->number == kInitializerOfGraph && field->bytes.data() != nullptr)
      parameters += count_floats(field->bytes);
  }
  return parameters;
}

/// Whether a TensorProto of 64-bit integers begins with 0. They are raw, packed, or one varint each.
bool begins_with_zero(Span tensor) {
  std::uint64_t type = 0;
  std::optional<bool> zero;
  while (const std::optional<Field> field = take_field(tensor)) {
    if (field->number == kDataTypeOfTensor) type = field->varint;
    if (zero) continue;
    Span values = field->bytes;
    if (field->number == kRawOfTensor && values.size() >= sizeof(std::uint64_t)) {
      zero = std::ranges::all_of(values.first(sizeof(std::uint64_t)), [](std::uint8_t byte) { return byte == 0; });
    } else if (field->number == kIntsOfTensor) {
      zero = (values.data() == nullptr ? std::optional(field->varint) : take_varint(values)) == std::uint64_t{0};
    }
  }
  return type == kInt64 && zero.value_or(false);
}

/// The names of the constants, initializers or outputs of Constant nodes, that begin with 0.
std::set<std::string> shapes_that_copy_the_batch(Span graph) {
  std::set<std::string> names;
  while (const std::optional<Field> field = take_field(graph)) {
    if (field->bytes.data() == nullptr) continue;
    std::optional<Span> tensor, name;
    if (field->number == kInitializerOfGraph) {
      tensor = field->bytes;
      name = find_message(field->bytes, kNameOfTensor);
    } else if (field->number == kNodeOfGraph && text_of(find_message(field->bytes, kOperatorOfNode)) == "Constant") {
      const std::optional<Span> attribute = find_message(field->bytes, kAttributeOfNode);
      if (attribute) tensor = find_message(*attribute, kTensorOfAttribute);
      name = find_message(field->bytes, kOutputOfNode);
    }
    if (tensor && begins_with_zero(*tensor)) names.insert(text_of(name));
  }
  return names;
}

/// The second input of a Reshape.
std::string shape_of_reshape(Span node) {
  std::vector<std::string> inputs;
  while (const std::optional<Field> field = take_field(node)) {
    if (field->number == kInputOfNode) inputs.push_back(text_of(field->bytes));
  }
  return inputs.size() > 1 ? inputs[1] : std::string();
}

bool reshapes_copy_the_batch(Span graph) {
  const std::set<std::string> copying = shapes_that_copy_the_batch(graph);
  while (const std::optional<Field> field = take_field(graph)) {
    if (field->number != kNodeOfGraph || field->bytes.data() == nullptr) continue;
    if (text_of(find_message(field->bytes, kOperatorOfNode)) != "Reshape") continue;
    if (!copying.contains(shape_of_reshape(field->bytes))) return false;
  }
  return true;
}

}  // namespace

OnnxFile read_onnx_file(const std::uint8_t* bytes, std::size_t size) {
  OnnxFile file;
  Span model{bytes, size};
  while (const std::optional<Field> field = take_field(model)) {
    if (field->bytes.data() == nullptr) continue;
    if (field->number == kGraphOfModel) {
      file.has_graph = true;
      read_image_input(field->bytes, file);
      file.free_batch = file.free_batch && reshapes_copy_the_batch(field->bytes);
      file.parameters = count_parameters(field->bytes);
    } else if (field->number == kMetadataOfModel) {
      file.metadata[text_of(find_message(field->bytes, kKeyOfEntry))] =
          text_of(find_message(field->bytes, kValueOfEntry));
    }
  }
  return file;
}

std::vector<std::string> split_lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::vector<HeadLayout> parse_heads(const std::string& text) {
  std::vector<HeadLayout> heads;
  for (const std::string& line : split_lines(text)) {
    std::istringstream stream(line);
    HeadLayout head;
    char separator = 0;
    if (!(stream >> head.stride_px >> separator) || separator != ':' || head.stride_px <= 0) return {};
    for (Anchor& anchor : head.anchors) {
      if (!(stream >> anchor.width_px >> separator >> anchor.height_px) || separator != ',') return {};
    }
    if (stream >> separator) return {};  // more than three anchors
    heads.push_back(head);
  }
  return heads;
}

}  // namespace rtd::detector
