// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/viewer/core/outbox.hpp"

#include <span>

namespace rtd::viewer {
namespace {

Frame take_first(std::deque<Frame>& frames, std::size_t& bytes) {
  Frame frame = std::move(frames.front());
  frames.pop_front();
  bytes -= frame.size();
  return frame;
}

}  // namespace

Frame text_frame(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {.text = true, .head = Bytes(bytes.begin(), bytes.end())};
}

Frame binary_frame(Bytes head, std::shared_ptr<const Bytes> payload) {
  return {.text = false, .head = std::move(head), .payload = std::move(payload)};
}

bool Outbox::push_control(Frame frame) {
  if (control_.size() >= limits_.control_messages || control_bytes_ + frame.size() > limits_.control_bytes)
    overflowed_ = true;
  if (overflowed_) return false;
  control_bytes_ += frame.size();
  control_.push_back(std::move(frame));
  return true;
}

void Outbox::push_data(Frame frame) {
  while (!data_.empty() && (data_.size() >= limits_.data_messages || data_bytes_ + frame.size() > limits_.data_bytes)) {
    take_first(data_, data_bytes_);
    ++dropped_;
  }
  data_bytes_ += frame.size();
  data_.push_back(std::move(frame));
}

std::optional<Frame> Outbox::pop() {
  if (!control_.empty()) return take_first(control_, control_bytes_);
  if (!data_.empty()) return take_first(data_, data_bytes_);
  return std::nullopt;
}

}  // namespace rtd::viewer
