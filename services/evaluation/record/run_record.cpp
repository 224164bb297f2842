// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/record/run_record.hpp"

#include <array>
#include <stdexcept>
#include <string_view>

namespace rtd::eval {

std::vector<JudgedFeature> judged(std::span<const msg::Feature> features) {
  std::vector<JudgedFeature> result;
  result.reserve(features.size());
  for (const msg::Feature& f : features) {
    result.push_back({f.u_raw_px, f.v_raw_px, (f.flags & msg::kFeatureRemoved) != 0});
  }
  return result;
}

bool is_synthetic(const std::string& source_uri) {
  return source_uri.starts_with("synthetic:");
}

std::filesystem::path mask_folder(const std::string& source_uri) {
  constexpr std::string_view kTum = "tum:";
  if (!source_uri.starts_with(kTum)) return {};
  const std::string folder = source_uri.substr(kTum.size());
  return std::filesystem::path(folder.substr(0, folder.find('?'))) / "mask";
}

bool has_true_masks(const std::string& source_uri) {
  std::error_code error;
  const std::filesystem::path folder = mask_folder(source_uri);
  return is_synthetic(source_uri) || (!folder.empty() && std::filesystem::is_directory(folder, error));
}

namespace {

constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr std::uint8_t kInvalid = 64;
}  // namespace

std::string to_base64(const std::vector<std::uint8_t>& bytes) {
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = bytes.size() - i;
    const unsigned group = (unsigned{bytes[i]} << 16U) | (left > 1 ? unsigned{bytes[i + 1]} << 8U : 0U) |
                           (left > 2 ? unsigned{bytes[i + 2]} : 0U);
    text += kDigits[group >> 18U];
    text += kDigits[(group >> 12U) & 63U];
    text += left > 1 ? kDigits[(group >> 6U) & 63U] : '=';
    text += left > 2 ? kDigits[group & 63U] : '=';
  }
  return text;
}

std::vector<std::uint8_t> from_base64(std::string_view text) {
  if (text.size() % 4 != 0) throw std::invalid_argument("base64 text has a wrong length");
  std::size_t padding = 0;
  while (padding < 2 && text.size() > padding && text[text.size() - 1 - padding] == '=') ++padding;
  std::array<std::uint8_t, 256> values;
  values.fill(kInvalid);
  for (std::uint8_t i = 0; i < kDigits.size(); ++i) values[static_cast<unsigned char>(kDigits[i])] = i;
  std::vector<std::uint8_t> bytes;
  bytes.reserve(text.size() / 4 * 3);
  for (std::size_t i = 0; i < text.size(); i += 4) {
    unsigned group = 0;
    for (std::size_t k = i; k < i + 4; ++k) {
      const unsigned value = k >= text.size() - padding ? 0 : values[static_cast<unsigned char>(text[k])];
      if (value == kInvalid) throw std::invalid_argument("base64 text has a wrong character");
      group = group << 6U | value;
    }
    for (const unsigned shift : {16U, 8U, 0U}) bytes.push_back(static_cast<std::uint8_t>(group >> shift));
  }
  for (; padding > 0; --padding) bytes.pop_back();
  return bytes;
}

}  // namespace rtd::eval
