// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/run_record/run_record.hpp"

#include <openssl/evp.h>

#include <algorithm>
#include <limits>

#include "common/camera/source_schemes.hpp"

namespace rtd::run_record {

std::vector<JudgedFeature> judged(std::span<const msg::Feature> features) {
  std::vector<JudgedFeature> result;
  result.reserve(features.size());
  for (const msg::Feature& f : features) {
    result.push_back({f.u_raw_px, f.v_raw_px, (f.flags & msg::kFeatureRemoved) != 0});
  }
  return result;
}

std::vector<SeenPoint> seen(const msg::FeatureFrame& frame) {
  const auto [fx, fy, cx, cy] = frame.intrinsics;
  std::vector<SeenPoint> points;
  for (const msg::Feature& f : msg::used_part(frame, frame.features)) {
    if ((f.flags & msg::kFeatureRemoved) != 0 || !(f.depth_m > 0)) continue;
    const auto x_m = static_cast<float>((f.u_px - cx) / fx * f.depth_m);
    const auto y_m = static_cast<float>((f.v_px - cy) / fy * f.depth_m);
    points.push_back({f.u_raw_px, f.v_raw_px, {x_m, y_m, f.depth_m}});
  }
  return points;
}

double FrameUse::coverage() const {
  if (given == 0) return std::numeric_limits<double>::quiet_NaN();
  return static_cast<double>(with_pose) / static_cast<double>(given);
}

std::string FrameUse::text() const {
  return std::to_string(given) + " given, " + std::to_string(used) + " used, " + std::to_string(with_pose) +
         " with pose";
}

FrameUse frame_use(const RunRecord& record) {
  FrameUse use;
  use.given = record.frames_in + record.frames_left_out + record.frames_not_played;
  use.with_pose = static_cast<std::uint64_t>(std::ranges::count_if(
      record.frames, [](const FrameRecord& frame) { return msg::is_measured(frame.tracking.state); }));
  const std::uint64_t lost = std::max(record.frames_dropped, record.frames_out_of_range);
  use.used = std::max(record.frames_in - std::min(lost, record.frames_in), use.with_pose);
  return use;
}

std::vector<std::string> deaths(const RunRecord& record, const std::vector<std::string>& services) {
  std::vector<std::string> lines;
  for (const auto& [name, process] : record.processes) {
    if (process.deaths == 0 || (!services.empty() && std::ranges::find(services, name) == services.end())) continue;
    lines.push_back(name + ' ' + process.died);
    if (process.deaths > 1) lines.back() += " (" + std::to_string(process.deaths) + " times)";
  }
  return lines;
}

bool is_synthetic(const std::string& source_uri) {
  return camera::is_of_kind(source_uri, camera::SourceKind::kScene);
}

std::filesystem::path mask_folder(const std::string& source_uri) {
  if (!camera::is_of_kind(source_uri, camera::SourceKind::kFolder)) return {};
  const std::string folder = source_uri.substr(source_uri.find(':') + 1);
  return std::filesystem::path(folder.substr(0, folder.find('?'))) / "mask";
}

bool has_true_masks(const std::string& source_uri) {
  std::error_code error;
  const std::filesystem::path folder = mask_folder(source_uri);
  return is_synthetic(source_uri) || (!folder.empty() && std::filesystem::is_directory(folder, error));
}

std::string to_base64(const std::vector<std::uint8_t>& bytes) {
  std::string text((bytes.size() + 2) / 3 * 4, '=');
  EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()), bytes.data(), static_cast<int>(bytes.size()));
  return text;
}

std::vector<std::uint8_t> from_base64(std::string_view text) {
  if (text.size() % 4 != 0) throw std::invalid_argument("base64 text has a wrong length");
  const std::size_t padding = text.size() - text.substr(0, text.find('=')).size();
  std::vector<std::uint8_t> bytes(text.size() / 4 * 3);
  const auto* const letters = reinterpret_cast<const unsigned char*>(text.data());
  // OpenSSL skips blanks at both ends and takes '=' anywhere.
  const int decoded = EVP_DecodeBlock(bytes.data(), letters, static_cast<int>(text.size()));
  if (decoded != static_cast<int>(bytes.size()) || padding > 2 || !text.ends_with(std::string_view("==", padding)))
    throw std::invalid_argument("base64 text has a wrong character");
  bytes.resize(bytes.size() - padding);
  return bytes;
}

}  // namespace rtd::run_record
