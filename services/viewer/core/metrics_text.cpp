// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/viewer/core/metrics_text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>

#include "common/service/json_text.hpp"
#include "common/service/metric_names.hpp"

namespace rtd::viewer {
namespace {

namespace metric = service::metric;

/// Prometheus asks for base units, by their whole names.
struct Unit {
  std::string_view ending, base;
  double factor;
};
constexpr std::array kUnits = {
    Unit{"_ms", "_seconds", 1e-3}, Unit{"_us", "_seconds", 1e-6}, Unit{"_ns", "_seconds", 1e-9},
    Unit{"_s", "_seconds", 1},     Unit{"_mb", "_bytes", 1e6},    Unit{"_mib", "_bytes", 1048576},
    Unit{"_m", "_meters", 1},      Unit{"_hz", "_hertz", 1},      Unit{"_percent", "_ratio", 1e-2},
};

/// Samples by the name of their metric, as the format wants them together.
using Families = std::map<std::string, std::string>;

/// Letters, digits and underscores.
std::string as_name(std::string_view text) {
  std::string name(text);
  std::ranges::replace_if(
      name, [](unsigned char letter) { return std::isalnum(letter) == 0; }, '_');
  return name;
}

std::string escaped(std::string_view text) {
  std::string result;
  for (const char letter : text) {
    if (letter == '\\' || letter == '"') result += '\\';
    if (letter != '\n') result += letter;
  }
  return result;
}

std::string labels_of(const WatchedService& service) {
  return "robot=\"" + escaped(service.robot) + "\",service=\"" + escaped(service.line.status.service) + "\",host=\"" +
         escaped(msg::word_of(service.line.status, metric::kHostNamePrefix)) + '"';
}

std::string number(double value) {
  if (std::isnan(value)) return "NaN";
  if (std::isinf(value)) return value > 0 ? "+Inf" : "-Inf";
  std::array<char, 32> text{};
  const auto written = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), written.ptr};
}

void add(Families& families, const std::string& name, const std::string& labels, double value) {
  families[name] += name + '{' + labels + "} " + number(value) + '\n';
}

/// "acknowledged:/slam/pose" and "clock.slam.offset_ms" are about something: what it is becomes a label.
void add_metric(Families& families, const WatchedService& service, const msg::Metric& given) {
  if (given.name == metric::kHostId || given.name.starts_with(metric::kHostNamePrefix)) return;
  const std::string_view text = given.name;
  const std::size_t begin = text.find_first_of(".:"), end = std::max(text.rfind('.'), begin);
  const bool about = begin != std::string_view::npos && begin + 1 < text.size() && text.substr(0, begin) != "replay";
  std::string name = as_name(text), labels = labels_of(service);
  if (about) {
    const bool between = end > begin && end != std::string_view::npos && text[begin] == '.';
    const std::string_view of = between ? text.substr(begin + 1, end - begin - 1) : text.substr(begin + 1);
    name = as_name(text.substr(0, begin)) + (between ? '_' + as_name(text.substr(end + 1)) : "");
    labels += ",of=\"" + escaped(of) + '"';
  }
  double value = given.value;
  for (const Unit& unit : kUnits) {
    if (!name.ends_with(unit.ending)) continue;
    name.replace(name.size() - unit.ending.size(), unit.ending.size(), unit.base);
    value *= unit.factor;
    break;
  }
  const std::string own = as_name(service.line.status.service) + '_';
  add(families, "rtd_" + (name.starts_with(own) ? name : own + name), labels, value);
}

}  // namespace

std::string metrics_text(const std::vector<WatchedService>& services) {
  Families families;
  for (const WatchedService& service : services) {
    if (service.line.status.state == msg::ServiceState::kFinished) continue;
    const std::string labels = labels_of(service);
    const std::string state = page::state_text(service.line);
    add(families, "rtd_service_up", labels, state != "gone" && state != "failed" ? 1 : 0);
    add(families, "rtd_service_degraded", labels, state == "degraded" ? 1 : 0);
    add(families, "rtd_service_heartbeat_age_seconds", labels, 1e-3 * service.line.age_ms);
    add(families, "rtd_service_start_time_seconds", labels, 1e-9 * static_cast<double>(service.line.status.started_ns));
    for (const msg::Metric& given : service.line.status.metrics) add_metric(families, service, given);
  }
  std::string text;
  for (const auto& [name, samples] : families)
    text += "# HELP " + name + " From the heartbeats on rtd/status.\n# TYPE " + name + " gauge\n" + samples;
  return text;
}

Health health_of(const std::vector<WatchedService>& services) {
  Health health;
  bool degraded = false;
  nlohmann::json list = nlohmann::json::array();
  for (const WatchedService& service : services) {
    const std::string state = page::state_text(service.line);
    health.well = health.well && state != "failed" && state != "gone";
    degraded = degraded || state == "degraded";
    list.push_back({{"robot", service.robot},
                    {"service", service.line.status.service},
                    {"host", msg::word_of(service.line.status, metric::kHostNamePrefix)},
                    {"state", state},
                    {"message", service.line.status.message},
                    {"age_s", std::round(service.line.age_ms) * 1e-3}});
  }
  const char* status = !health.well ? "failed" : degraded ? "degraded" : services.empty() ? "no services" : "ok";
  health.json = service::json_text(nlohmann::json{{"status", status}, {"services", std::move(list)}});
  return health;
}

}  // namespace rtd::viewer
