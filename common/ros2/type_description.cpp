// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/ros2/type_description.hpp"

#include <fmt/format.h>
#include <openssl/sha.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <set>
#include <sstream>
#include <string_view>

#include "common/msg/commands.hpp"
#include "common/msg/imu.hpp"
#include "common/msg/message_list.hpp"
#include "common/msg/parameters.hpp"
#include "common/msg/ros_graph.hpp"
#include "common/ros2/names.hpp"
#include "common/ros_codec/wire.hpp"

namespace rtd::ros2 {
namespace {

template <class Number>
std::string word_of() {
  if constexpr (std::is_same_v<Number, bool>) return "bool";
  const std::string kind = std::is_floating_point_v<Number> ? "float" : std::is_signed_v<Number> ? "int" : "uint";
  return kind + std::to_string(8 * sizeof(Number));
}

/// What definitions of ROS 2 say beyond the C++ type of a field: another word for the same bytes, bounds.
struct Refinement {
  const char *type, *field, *word = nullptr;
  std::uint32_t capacity = 0, text_capacity = 0;
};
constexpr Refinement kRefinements[] = {
    {"diagnostic_msgs/DiagnosticStatus", "level", "byte"},
    {"rcl_interfaces/ParameterValue", "byte_array_value", "byte"},
    {"rcl_interfaces/ParameterValue", "bool_array_value", "bool"},
    {"rcl_interfaces/ParameterDescriptor", "floating_point_range", nullptr, 1},
    {"rcl_interfaces/ParameterDescriptor", "integer_range", nullptr, 1},
    {"rmw_dds_common/NodeEntitiesInfo", "node_namespace", nullptr, 0, 256},
    {"rmw_dds_common/NodeEntitiesInfo", "node_name", nullptr, 0, 256},
};

void refine(const std::string& type, MessageField& field) {
  for (const Refinement& more : kRefinements) {
    if (type != more.type || field.name != more.field) continue;
    if (more.word != nullptr) field.type = more.word;
    if (more.capacity > 0) field.capacity = more.capacity;
    field.text_capacity = more.text_capacity;
  }
}

/// Collects types from the lists of fields of their structs.
class Collector {
 public:
  template <class T>
  void add() {
    const std::string type = msg::type_name(msg::TypeOf<T>());
    if (types_.contains(type)) return;
    std::vector<MessageField> fields;
    msg::for_each_field_type<T>([&]<class Field>(const char* name) {
      MessageField& field = fields.emplace_back();
      field.name = name;
      describe(field, msg::TypeOf<Field>());
      refine(type, field);
    });
    types_[type] = std::move(fields);
  }
  MessageFields take() { return std::move(types_); }

 private:
  template <class T>
  void describe(MessageField& field, msg::TypeOf<T>) {
    if constexpr (msg::Message<T>) {
      field.type = msg::type_name(msg::TypeOf<T>());
      add<T>();
    } else if constexpr (std::is_enum_v<T>) {
      field.type = word_of<std::underlying_type_t<T>>();
    } else if constexpr (ros::UnalignedNumber<T>) {
      field.type = word_of<typename T::Number>();
    } else {
      field.type = word_of<T>();
    }
  }
  void describe(MessageField& field, msg::TypeOf<std::string>) { field.type = "string"; }
  template <class T>
  void describe(MessageField& field, msg::TypeOf<std::vector<T>>) {
    describe(field, msg::TypeOf<T>());
    field.kind = MessageField::Kind::kSequence;
  }
  template <class T, std::size_t kSize>
  void describe(MessageField& field, msg::TypeOf<std::array<T, kSize>>) {
    describe(field, msg::TypeOf<T>());
    field.kind = MessageField::Kind::kArray;
    field.capacity = kSize;
  }

  MessageFields types_;
};

template <class... T>
MessageFields fields_of_all(msg::TypeList<T...>) {
  Collector collector;
  (collector.add<T>(), ...);
  collector.add<msg::Imu>();  // travels as raw samples only
  return collector.take();
}

const std::string kSeparator(80, '=');  // between the types of one text, as rosbag2 has it

/// What the .msg files of ROS 2 hold besides fields.
std::string constants_of(const std::string& type) {
  if (type == "diagnostic_msgs/DiagnosticStatus") return "byte OK=0\nbyte WARN=1\nbyte ERROR=2\nbyte STALE=3\n";
  if (type != "sensor_msgs/PointField") return {};
  return "uint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\nuint8 UINT16=4\nuint8 INT32=5\nuint8 UINT32=6\n"
         "uint8 FLOAT32=7\nuint8 FLOAT64=8\n";
}

std::string default_of(const std::string& type, const MessageField& field) {
  if (type != "geometry_msgs/Quaternion") return {};
  return field.name == "w" ? " 1" : " 0";
}

/// Types of the same package go without it, but for those that an older package has too.
std::string type_text(const MessageField& field, const std::string& package) {
  const bool ambiguous = field.type == "vision_msgs/Pose2D" || field.type == "vision_msgs/Point2D";
  const bool local = field.type.starts_with(package + '/') && !ambiguous;
  const std::string type = local ? field.type.substr(package.size() + 1) : field.type;
  if (field.kind == MessageField::Kind::kSequence) return type + "[]";  // none of those in texts has a bound
  return field.kind == MessageField::Kind::kOne ? type : type + '[' + std::to_string(field.capacity) + ']';
}

/// Names of fields have small letters in ROS 2: T_world_camera is t_world_camera there.
std::string ros_field(std::string name) {
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return name;
}

/// The .msg file of a type.
std::string msg_text(const std::string& type, const MessageFields& types) {
  const std::string package = type.substr(0, type.find('/'));
  std::string text = constants_of(type);
  for (const MessageField& field : types.at(type)) {
    text += type_text(field, package) + ' ' + ros_field(field.name) + default_of(type, field) + '\n';
  }
  return text;
}

/// The types that one is made of, each once, the type itself first.
std::vector<std::string> closure(const std::string& type, const MessageFields& types) {
  std::vector<std::string> all{type};
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (const MessageField& field : types.at(all[i])) {
      const bool known = std::find(all.begin(), all.end(), field.type) != all.end();
      if (field.is_message() && !known) all.push_back(field.type);
    }
  }
  return all;
}

/// Without preprocessor lines, which readers of schemas do not know.
std::string idl_text() {
  std::string text;
  std::istringstream lines(own_idl());
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with('#')) text += line + '\n';
  }
  return text;
}

const std::string kPrefix = "RIHS01_", kKey = "typehash=";

/// The numbers of type_description_interfaces/msg/FieldType.
int type_id(const MessageField& field) {
  static const std::map<std::string, int> kPrimitive = {
      {"int8", 2},   {"uint8", 3},    {"int16", 4},    {"uint16", 5}, {"int32", 6}, {"uint32", 7}, {"int64", 8},
      {"uint64", 9}, {"float32", 10}, {"float64", 11}, {"bool", 15},  {"byte", 16}, {"string", 17}};
  constexpr int kMessage = 1, kBoundedString = 21;
  constexpr int kOffset[] = {0, 48, 144}, kBoundedSequence = 96;  // by MessageField::Kind
  const bool bounded = field.kind == MessageField::Kind::kSequence && field.capacity > 0;
  const int one = field.is_message() ? kMessage : field.text_capacity > 0 ? kBoundedString : kPrimitive.at(field.type);
  return one + (bounded ? kBoundedSequence : kOffset[static_cast<int>(field.kind)]);
}

/// "package/Type" as descriptions name it; what belongs to a service has its middle part already.
std::string full_name(const std::string& type) {
  const std::size_t slash = type.find('/');
  if (type.find('/', slash + 1) != std::string::npos) return type;
  return type.substr(0, slash) + "/msg" + type.substr(slash);
}

std::string describe(const MessageField& field) {
  return fmt::format(
      R"({{"name": "{}", "type": {{"type_id": {}, "capacity": {}, "string_capacity": {}, "nested_type_name": "{}"}}}})",
      ros_field(field.name), type_id(field), field.capacity, field.text_capacity,
      field.is_message() ? full_name(field.type) : "");
}

std::string describe(const std::string& type, const MessageFields& types) {
  std::string fields;
  for (const MessageField& field : types.at(type)) {
    fields += (fields.empty() ? "" : ", ") + describe(field);
  }
  return fmt::format(R"({{"type_name": "{}", "fields": [{}]}})", full_name(type), fields);
}

/// The messages that one is made of, in the order of their names.
void add_parts(const std::string& type, const MessageFields& types, std::set<std::string>& parts) {
  for (const MessageField& field : types.at(type)) {
    if (field.is_message() && parts.insert(field.type).second) add_parts(field.type, types, parts);
  }
}

std::string description(const std::string& type, const MessageFields& types) {
  std::set<std::string> parts;
  add_parts(type, types, parts);
  std::string referenced;
  for (const std::string& part : parts) referenced += (referenced.empty() ? "" : ", ") + describe(part, types);
  return fmt::format(R"({{"type_description": {}, "referenced_type_descriptions": [{}]}})", describe(type, types),
                     referenced);
}

/// The types of a service as ROS 2 describes it: the service itself, its request, its response, and the event that
/// says who asked what.
template <class Request, class Response>
MessageFields service_fields(const std::string& service) {
  constexpr auto kArray = MessageField::Kind::kArray, kSequence = MessageField::Kind::kSequence;
  Collector collector;
  collector.add<Request>();
  collector.add<Response>();
  collector.add<msg::Time>();
  MessageFields types = collector.take();
  const std::string request = service + "_Request", response = service + "_Response", event = service + "_Event";
  types[request] = types.at(msg::type_name(msg::TypeOf<Request>()));
  types[response] = types.at(msg::type_name(msg::TypeOf<Response>()));
  types["service_msgs/ServiceEventInfo"] = {{"uint8", "event_type"},
                                            {"builtin_interfaces/Time", "stamp"},
                                            {"uint8", "client_gid", kArray, 16},
                                            {"int64", "sequence_number"}};
  types[event] = {{"service_msgs/ServiceEventInfo", "info"},
                  {request, "request", kSequence, 1},
                  {response, "response", kSequence, 1}};
  types[service] = {{request, "request_message"}, {response, "response_message"}, {event, "event_message"}};
  return types;
}

/// Hashes of what the bus carries besides messages, by "package/Type" and "package/srv/Type". A service has one for its
/// request and its reply.
std::map<std::string, std::string> other_hashes() {
  std::map<std::string, std::string> hashes;
  msg::for_each_service([&]<class Request, class Response>(const char* service) {
    hashes[service] = type_hash(service, service_fields<Request, Response>(service));
  });
  Collector graph;
  graph.add<msg::ParticipantEntitiesInfo<16>>();
  const std::string info = msg::type_name(msg::TypeOf<msg::ParticipantEntitiesInfo<16>>());
  hashes[info] = type_hash(info, graph.take());
  return hashes;
}

/// "std_srvs/srv/Trigger" of "std_srvs::srv::dds_::Trigger_Request_" and of its response; "" for other types.
std::string service_of(const std::string& dds_type) {
  const std::string type = ros_type(dds_type);
  for (const std::string_view part : {"_Request", "_Response"}) {
    if (type.ends_with(part) && type.find("/srv/") != std::string::npos)
      return type.substr(0, type.size() - part.size());
  }
  return {};
}

/// Names, numbers and signs, without comments.
std::vector<std::string> words_of(const std::string& idl) {
  std::vector<std::string> words;
  std::istringstream lines(idl);
  for (std::string line; std::getline(lines, line);) {
    bool in_name = false;
    for (const char c : line.substr(0, line.find("//"))) {
      const bool names = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
      const bool blank = std::isspace(static_cast<unsigned char>(c)) != 0;
      if (names && in_name) {
        words.back() += c;
      } else if (!blank) {
        words.emplace_back(1, c);
      }
      in_name = names;
    }
  }
  return words;
}

/// Where the body of each struct begins, behind "struct NAME {".
std::map<std::string, std::size_t> bodies_in(const std::vector<std::string>& words) {
  std::map<std::string, std::size_t> bodies;
  for (std::size_t i = 0; i + 3 < words.size(); ++i)
    if (words[i] == "struct" && words[i + 2] == "{") bodies.try_emplace(words[i + 1], i + 3);
  return bodies;
}

}  // namespace

const MessageFields& message_fields() {
  static const MessageFields kTypes = fields_of_all(msg::MessageTypes());
  return kTypes;
}

const std::vector<MessageField>* fields_of(const std::string& type) {
  const auto found = message_fields().find(type);
  return found == message_fields().end() ? nullptr : &found->second;
}

TypeDefinition definition_of(const std::string& dds_type) {
  const std::string type = short_type(dds_type);
  if (fields_of(type) == nullptr) return {ros_type(dds_type), {}, {}};
  if (type.starts_with("rtd_msgs/")) return {ros2::dds_type(ros_type(dds_type)), "omgidl", idl_text()};
  return {ros_type(dds_type), "ros2msg", ros2msg_text(type, message_fields())};
}

std::string ros2msg_text(const std::string& type, const MessageFields& types) {
  std::string text;
  for (const std::string& part : closure(type, types)) {
    if (!text.empty()) text += kSeparator + "\nMSG: " + part + '\n';
    text += msg_text(part, types);
  }
  return text;
}

std::string msg_file(const std::string& type) {
  const std::string wanted = "struct " + type.substr(type.find('/') + 1) + "_ {";
  std::string comment;
  std::istringstream lines(own_idl());
  for (std::string line; std::getline(lines, line) && line != wanted;) {
    if (line.starts_with("// ")) comment += "# " + line.substr(3) + '\n';
    if (line.empty()) comment.clear();
  }
  const std::string license =
      "# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors\n# SPDX-License-Identifier: Apache-2.0\n";
  return license + (comment.empty() ? "" : "#\n" + comment) + '\n' + msg_text(type, message_fields());
}

std::string type_hash(const std::string& type, const MessageFields& types) {
  const std::string text = description(type, types);
  unsigned char digest[SHA256_DIGEST_LENGTH];
  SHA256(reinterpret_cast<const unsigned char*>(text.data()), text.size(), digest);
  std::string hash = kPrefix;
  for (const unsigned char byte : digest) hash += fmt::format("{:02x}", byte);
  return hash;
}

std::string type_hash(const std::string& dds_type) {
  static const std::map<std::string, std::string> kOthers = other_hashes();
  const std::string type = short_type(dds_type);
  if (fields_of(type) != nullptr) return type_hash(type, message_fields());
  const auto other = kOthers.find(type.empty() ? service_of(dds_type) : type);
  return other == kOthers.end() ? std::string() : other->second;
}

std::string user_data_of(const std::string& dds_type) {
  const std::string hash = type_hash(dds_type);
  return hash.empty() ? "from=rtd;" : kKey + hash + ';';
}

std::string hash_in(const std::string& user_data) {
  const std::size_t begin = user_data.find(kKey);
  const bool is_key = begin == 0 || (begin != std::string::npos && user_data[begin - 1] == ';');
  if (!is_key) return {};
  const std::size_t value = begin + kKey.size();
  return user_data.substr(value, user_data.find(';', value) - value);
}

std::string layout_in(const std::string& idl, const std::string& struct_name) {
  const std::vector<std::string> words = words_of(idl);
  std::map<std::string, std::size_t> bodies = bodies_in(words);  // that are not written yet
  std::string layout;
  std::vector<std::string> structs{struct_name};
  for (std::size_t next = 0; next < structs.size(); ++next) {
    const auto body = bodies.extract(structs[next]);
    if (!body || words[body.mapped()] == "}") continue;
    layout += structs[next] + ": ";
    for (std::size_t i = body.mapped(); i < words.size() && words[i] != "}"; ++i) {
      layout += words[i] + ' ';
      if (bodies.contains(words[i])) structs.push_back(words[i]);
    }
  }
  return layout;
}

}  // namespace rtd::ros2
