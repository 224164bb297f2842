// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <type_traits>

#include "common/io/atomic_file.hpp"
#include "common/io/byte_sink.hpp"
#include "common/io/input_file.hpp"
#include "common/msg/fields.hpp"
#include "common/run_record/run_record.hpp"
#include "common/service/json_text.hpp"

// What run.json has, by the same names and in this order.
namespace rtd::vision {
using msg::TypeOf;
RTD_FIELDS_OF(PersonMasks, "PersonMasks", columns, rows, labels)
}  // namespace rtd::vision

namespace rtd::run_record {
using msg::TypeOf;
RTD_FIELDS_OF(ProcessUsage, "ProcessUsage", cpu_s, peak_rss_mb, restarts, deaths, died)
RTD_FIELDS_OF(HostClock, "HostClock", service, offset_ms, round_trip_ms)
RTD_FIELDS_OF(SampleFrame, "SampleFrame", seq, jpeg, features, points, masks)
RTD_FIELDS_OF(JudgedFrame, "JudgedFrame", stamp_ns, features)
RTD_FIELDS_OF(RunRecord, "RunRecord", version, source, pace, filter_mode, dds, detector, interrupted, z_up, duration_s,
              frames_in, frames_left_out, frames_not_played, frames_out_of_range, frames_dropped, drops, left_out,
              depth_median_m, depth_holes, processes, clocks, events, frames, samples, judged_frames)
namespace {

using Json = nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "features are stored in little-endian order");
constexpr int kFormat = 1;

constexpr std::size_t kFeatureBytes = 9;  // u and v as float32, one byte for "removed"
static_assert(sizeof(SeenPoint) == 5 * sizeof(float), "points are stored as five float32");

/// What earlier versions did not write.
bool is_added(std::string_view name) {
  constexpr std::array<std::string_view, 12> kAdded = {
      "map_id",   "z_up",   "frames_left_out", "frames_not_played", "frames_out_of_range",
      "left_out", "deaths", "points",          "depth_median_m",    "depth_holes",
      "died",     "masks"};
  return std::ranges::find(kAdded, name) != kAdded.end();
}

std::string pack(const std::vector<JudgedFeature>& features) {
  std::vector<std::uint8_t> bytes(features.size() * kFeatureBytes);
  for (std::size_t i = 0; i < features.size(); ++i) {
    std::memcpy(&bytes[i * kFeatureBytes], &features[i].u_raw_px, sizeof(float));
    std::memcpy(&bytes[i * kFeatureBytes + 4], &features[i].v_raw_px, sizeof(float));
    bytes[i * kFeatureBytes + 8] = features[i].removed ? 1 : 0;
  }
  return to_base64(bytes);
}

std::vector<JudgedFeature> unpack(const std::string& text) {
  const std::vector<std::uint8_t> bytes = from_base64(text);
  std::vector<JudgedFeature> features(bytes.size() / kFeatureBytes);
  for (std::size_t i = 0; i < features.size(); ++i) {
    std::memcpy(&features[i].u_raw_px, &bytes[i * kFeatureBytes], sizeof(float));
    std::memcpy(&features[i].v_raw_px, &bytes[i * kFeatureBytes + 4], sizeof(float));
    features[i].removed = bytes[i * kFeatureBytes + 8] != 0;
  }
  return features;
}

template <class T>
concept Map = requires {
  typename T::mapped_type;
};
template <class T>
concept Plain = std::is_arithmetic_v<T> || std::same_as<T, std::string>;

/// JSON has no NaN and no infinity: both become null, which is read as NaN.
template <class T>
Json to_value(const T& value) {
  if constexpr (std::is_floating_point_v<T>) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
  } else if constexpr (std::is_enum_v<T>) {
    return static_cast<std::underlying_type_t<T>>(value);
  } else if constexpr (Plain<T>) {
    return value;
  } else if constexpr (std::same_as<T, std::vector<JudgedFeature>>) {
    return pack(value);
  } else if constexpr (std::same_as<T, std::vector<std::uint8_t>> || std::same_as<T, std::vector<SeenPoint>>) {
    return packed(value);
  } else if constexpr (std::same_as<T, std::vector<FrameRecord>>) {
    Json table;
    const FrameRecord none;
    for_each_column(none, [&](const char* name, const auto&) { table[name] = Json::array(); });
    for (const FrameRecord& frame : value)
      for_each_column(frame, [&](const char* name, const auto& cell) { table[name].push_back(to_value(cell)); });
    return table;
  } else if constexpr (msg::Message<T>) {
    Json object = Json::object();
    msg::for_each_field(value, [&]<class Field>(const char* name, const Field& field) {
      if constexpr (std::same_as<Field, vision::PersonMasks>)
        if (field.empty()) return;
      object[name] = to_value(field);
    });
    return object;
  } else if constexpr (Map<T>) {
    Json object = Json::object();
    for (const auto& [name, entry] : value) object[name] = to_value(entry);
    return object;
  } else {
    Json list = Json::array();
    for (const auto& entry : value) list.push_back(to_value(entry));
    return list;
  }
}

void check(const vision::PersonMasks& masks) {
  const bool fits =
      masks.columns > 0 && masks.rows > 0 &&
      masks.labels.size() / static_cast<std::size_t>(masks.columns) == static_cast<std::size_t>(masks.rows) &&
      masks.labels.size() % static_cast<std::size_t>(masks.columns) == 0;
  if (!fits) throw std::invalid_argument("has masks of another size than their labels");
}

template <class T>
void from_value(const Json& json, T& value) {
  if constexpr (std::is_floating_point_v<T>) {
    value = json.is_null() ? std::numeric_limits<T>::quiet_NaN() : json.get<T>();
  } else if constexpr (std::is_enum_v<T>) {
    value = static_cast<T>(json.get<std::underlying_type_t<T>>());
  } else if constexpr (Plain<T>) {
    json.get_to(value);
  } else if constexpr (std::same_as<T, std::vector<JudgedFeature>>) {
    value = unpack(json.get_ref<const std::string&>());
  } else if constexpr (std::same_as<T, std::vector<std::uint8_t>>) {
    value = from_base64(json.get_ref<const std::string&>());
  } else if constexpr (std::same_as<T, std::vector<SeenPoint>>) {
    const std::vector<std::uint8_t> bytes = from_base64(json.get_ref<const std::string&>());
    value.resize(bytes.size() / sizeof(SeenPoint));
    if (!value.empty()) std::memcpy(value.data(), bytes.data(), value.size() * sizeof(SeenPoint));
  } else if constexpr (std::same_as<T, std::vector<FrameRecord>>) {
    value.resize(json.at("seq").size());
    for (std::size_t i = 0; i < value.size(); ++i)
      for_each_column(value[i], [&](const char* name, auto& cell) {
        if (json.contains(name) || !is_added(name)) from_value(json.at(name).at(i), cell);
      });
  } else if constexpr (msg::Message<T>) {
    msg::for_each_field(value, [&](const char* name, auto& field) {
      if (json.contains(name) || !is_added(name)) from_value(json.at(name), field);
    });
    if constexpr (std::same_as<T, vision::PersonMasks>) check(value);
  } else if constexpr (Map<T>) {
    for (const auto& [name, entry] : json.get_ref<const Json::object_t&>()) from_value(entry, value[name]);
  } else {
    if constexpr (requires { value.resize(0); }) value.resize(json.get_ref<const Json::array_t&>().size());
    for (std::size_t i = 0; i < value.size(); ++i) from_value(json.at(i), value[i]);
  }
}

RunRecord read_record(const Json& json) {
  if (const int format = json.at("format"); format != kFormat) {
    throw std::invalid_argument("has format " + std::to_string(format) + ", this rtd-eval reads format " +
                                std::to_string(kFormat));
  }
  RunRecord record;
  from_value(json, record);
  return record;
}

}  // namespace

void write_run_json(const RunRecord& record, const std::filesystem::path& file) {
  Json json{{"format", kFormat}};
  msg::for_each_field(record, [&](const char* name, const auto& field) { json[name] = to_value(field); });
  try {
    io::write_file(file, service::json_line(json) + '\n');
  } catch (const io::IoError& error) {
    throw RunFileError(error.what());
  }
}

RunRecord read_run_json(const std::filesystem::path& file) {
  try {
    return read_record(Json::parse(io::read_file(file, io::kResults)));
  } catch (const io::IoError& error) {
    throw RunFileError(std::string(error.what()) + "; name a folder that 'rtd run --out' wrote");
  } catch (const nlohmann::json::exception& error) {
    throw RunFileError(file.string() + ": is not the record of a run: " + error.what());
  } catch (const std::invalid_argument& error) {
    throw RunFileError(file.string() + ": " + error.what());
  }
}

}  // namespace rtd::run_record
