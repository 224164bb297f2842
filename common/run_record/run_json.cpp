// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <type_traits>

#include "common/io/atomic_file.hpp"
#include "common/io/byte_sink.hpp"
#include "common/io/input_file.hpp"
#include "common/run_record/run_record.hpp"
#include "common/service/json_text.hpp"

namespace rtd::run_record {
namespace {

using Json = nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "features are stored in little-endian order");
constexpr int kFormat = 1;
constexpr std::string_view kAddedColumn = "map_id";  // earlier versions did not write it: zeros
constexpr std::size_t kFeatureBytes = 9;             // u and v as float32, one byte for "removed"

/// JSON has no NaN and no infinity: both become null, which is read as NaN.
template <typename T>
Json to_value(const T& value) {
  if constexpr (std::is_floating_point_v<T>) return std::isfinite(value) ? Json(value) : Json(nullptr);
  if constexpr (std::is_enum_v<T>) return static_cast<std::underlying_type_t<T>>(value);
  return value;
}

template <typename T, std::size_t N>
Json to_value(const std::array<T, N>& values) {
  Json list = Json::array();
  for (const T& value : values) list.push_back(to_value(value));
  return list;
}

template <typename T>
void from_value(const Json& json, T& value) {
  if constexpr (std::is_floating_point_v<T>) {
    value = json.is_null() ? std::numeric_limits<T>::quiet_NaN() : json.get<T>();
  } else if constexpr (std::is_enum_v<T>) {
    value = static_cast<T>(json.get<std::underlying_type_t<T>>());
  } else {
    json.get_to(value);
  }
}

template <typename T, std::size_t N>
void from_value(const Json& json, std::array<T, N>& values) {
  for (std::size_t i = 0; i < N; ++i) from_value(json.at(i), values[i]);
}

Json masks_json(const vision::PersonMasks& masks) {
  return {{"columns", masks.columns}, {"rows", masks.rows}, {"labels", to_base64(masks.labels)}};
}

Json frames_json(const std::vector<FrameRecord>& frames) {
  Json table;
  const FrameRecord none;
  for_each_column(none, [&](const char* name, const auto&) { table[name] = Json::array(); });
  for (const FrameRecord& frame : frames)
    for_each_column(frame, [&](const char* name, const auto& value) { table[name].push_back(to_value(value)); });
  return table;
}

std::vector<FrameRecord> read_frames(const Json& table) {
  std::vector<FrameRecord> frames(table.at("seq").size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    for_each_column(frames[i], [&](const char* name, auto& value) {
      if (table.contains(name) || name != kAddedColumn) from_value(table.at(name).at(i), value);
    });
  }
  return frames;
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

static_assert(sizeof(SeenPoint) == 5 * sizeof(float), "points are stored as five float32");

/// None in the files of earlier versions.
std::vector<SeenPoint> read_points(const Json& sample) {
  const std::vector<std::uint8_t> bytes = from_base64(sample.value("points", std::string()));
  std::vector<SeenPoint> points(bytes.size() / sizeof(SeenPoint));
  if (!points.empty()) std::memcpy(points.data(), bytes.data(), points.size() * sizeof(SeenPoint));
  return points;
}

Json processes_json(const std::map<std::string, ProcessUsage>& processes) {
  Json json = Json::object();
  for (const auto& [name, usage] : processes) {
    json[name] = {{"cpu_s", to_value(usage.cpu_s)},
                  {"peak_rss_mb", to_value(usage.peak_rss_mb)},
                  {"restarts", usage.restarts},
                  {"deaths", usage.deaths},
                  {"died", usage.died}};
  }
  return json;
}

Json record_json(const RunRecord& record) {
  Json json{{"format", kFormat},
            {"version", record.version},
            {"source", record.source},
            {"pace", record.pace},
            {"filter_mode", record.filter_mode},
            {"dds", record.dds},
            {"detector", record.detector},
            {"interrupted", record.interrupted},
            {"z_up", record.z_up},
            {"duration_s", to_value(record.duration_s)},
            {"frames_in", record.frames_in},
            {"frames_left_out", record.frames_left_out},
            {"frames_not_played", record.frames_not_played},
            {"frames_out_of_range", record.frames_out_of_range},
            {"frames_dropped", record.frames_dropped},
            {"drops", Json::object()},
            {"left_out", Json::object()},
            {"depth_median_m", to_value(record.depth_median_m)},
            {"depth_holes", to_value(record.depth_holes)},
            {"processes", processes_json(record.processes)},
            {"clocks", Json::array()},
            {"events", record.events},
            {"frames", frames_json(record.frames)},
            {"samples", Json::array()},
            {"judged_frames", Json::array()}};
  for (const auto& [place, count] : record.drops) json["drops"][place] = to_value(count);
  for (const auto& [reason, count] : record.left_out) json["left_out"][reason] = to_value(count);
  for (const HostClock& clock : record.clocks) {
    json["clocks"].push_back({{"service", clock.service},
                              {"offset_ms", to_value(clock.offset_ms)},
                              {"round_trip_ms", to_value(clock.round_trip_ms)}});
  }
  for (const SampleFrame& sample : record.samples) {
    Json entry = {{"seq", sample.seq},
                  {"jpeg", to_base64(sample.jpeg)},
                  {"features", pack(sample.features)},
                  {"points", packed(sample.points)}};
    if (!sample.masks.empty()) entry["masks"] = masks_json(sample.masks);
    json["samples"].push_back(std::move(entry));
  }
  for (const JudgedFrame& frame : record.judged_frames) {
    json["judged_frames"].push_back({{"stamp_ns", frame.stamp_ns}, {"features", pack(frame.features)}});
  }
  return json;
}

/// Runs without masks have none, and earlier versions did not write them.
vision::PersonMasks read_masks(const Json& sample) {
  const auto json = sample.find("masks");
  if (json == sample.end()) return {};
  vision::PersonMasks masks{json->at("columns"), json->at("rows"),
                            from_base64(json->at("labels").get_ref<const std::string&>())};
  const bool fits =
      masks.columns > 0 && masks.rows > 0 &&
      masks.labels.size() / static_cast<std::size_t>(masks.columns) == static_cast<std::size_t>(masks.rows) &&
      masks.labels.size() % static_cast<std::size_t>(masks.columns) == 0;
  if (!fits) throw std::invalid_argument("has masks of another size than their labels");
  return masks;
}

void read_lists(const Json& json, RunRecord& record) {
  for (const auto& [place, count] : json.at("drops").items()) from_value(count, record.drops[place]);
  if (const auto left_out = json.find("left_out"); left_out != json.end())  // earlier versions did not write it
    for (const auto& [reason, count] : left_out->items()) from_value(count, record.left_out[reason]);
  for (const auto& [name, usage] : json.at("processes").items()) {
    ProcessUsage& process = record.processes[name];
    from_value(usage.at("cpu_s"), process.cpu_s);
    from_value(usage.at("peak_rss_mb"), process.peak_rss_mb);
    usage.at("restarts").get_to(process.restarts);
    process.deaths = usage.value("deaths", 0);  // earlier versions did not write them
    process.died = usage.value("died", std::string());
  }
  for (const Json& entry : json.at("clocks")) {
    HostClock clock{entry.at("service")};
    from_value(entry.at("offset_ms"), clock.offset_ms);
    from_value(entry.at("round_trip_ms"), clock.round_trip_ms);
    record.clocks.push_back(clock);
  }
  for (const Json& sample : json.at("samples")) {
    record.samples.push_back({sample.at("seq"), from_base64(sample.at("jpeg").get_ref<const std::string&>()),
                              unpack(sample.at("features")), read_masks(sample), read_points(sample)});
  }
  for (const Json& frame : json.at("judged_frames"))
    record.judged_frames.push_back({frame.at("stamp_ns"), unpack(frame.at("features"))});
}

RunRecord read_record(const Json& json) {
  if (const int format = json.at("format"); format != kFormat) {
    throw std::invalid_argument("has format " + std::to_string(format) + ", this rtd-eval reads format " +
                                std::to_string(kFormat));
  }
  RunRecord record;
  for (const auto& [key, text] : {std::pair{"version", &record.version},
                                  {"source", &record.source},
                                  {"pace", &record.pace},
                                  {"filter_mode", &record.filter_mode},
                                  {"dds", &record.dds},
                                  {"detector", &record.detector}}) {
    json.at(key).get_to(*text);
  }
  json.at("interrupted").get_to(record.interrupted);
  from_value(json.at("duration_s"), record.duration_s);
  json.at("frames_in").get_to(record.frames_in);
  json.at("frames_dropped").get_to(record.frames_dropped);
  record.z_up = json.value("z_up", false);
  record.frames_left_out = json.value("frames_left_out", std::uint64_t{0});  // earlier versions did not write them
  record.frames_not_played = json.value("frames_not_played", std::uint64_t{0});
  record.frames_out_of_range = json.value("frames_out_of_range", std::uint64_t{0});
  if (json.contains("depth_median_m")) from_value(json.at("depth_median_m"), record.depth_median_m);
  if (json.contains("depth_holes")) from_value(json.at("depth_holes"), record.depth_holes);
  json.at("events").get_to(record.events);
  record.frames = read_frames(json.at("frames"));
  read_lists(json, record);
  return record;
}

}  // namespace

void write_run_json(const RunRecord& record, const std::filesystem::path& file) {
  try {
    io::write_file(file, service::json_line(record_json(record)) + '\n');
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
