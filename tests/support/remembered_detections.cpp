// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/remembered_detections.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace rtd::test_support {
namespace {

using nlohmann::json;

json to_json(const std::vector<vision::Detection>& boxes) {
  json list = json::array();
  for (const vision::Detection& d : boxes)
    list.push_back({d.class_name, d.score, d.x_px, d.y_px, d.width_px, d.height_px});
  return list;
}

/// Runs of equal labels: [columns, rows, length, label, length, label, ...].
json to_json(const vision::PersonMasks& masks) {
  json list = json::array({masks.columns, masks.rows});
  for (auto from = masks.labels.begin(); from != masks.labels.end();) {
    const auto to = std::find_if(from, masks.labels.end(), [from](std::uint8_t label) { return label != *from; });
    list.push_back(to - from);
    list.push_back(*from);
    from = to;
  }
  return list;
}

void from_json(const json& list, vision::PersonMasks& masks) {
  masks.columns = list.at(0);
  masks.rows = list.at(1);
  for (std::size_t i = 2; i + 1 < list.size(); i += 2)
    masks.labels.insert(masks.labels.end(), list[i].get<std::size_t>(), list[i + 1].get<std::uint8_t>());
}

void from_json(const json& list, std::vector<vision::Detection>& boxes) {
  for (const json& d : list) boxes.push_back({d.at(0), d.at(1), d.at(2), d.at(3), d.at(4), d.at(5)});
}

class Memory {
 public:
  explicit Memory(std::string file) : file_(std::move(file)) {
    if (!std::filesystem::exists(file_)) return;
    std::ifstream in(file_);
    answers_ = json::parse(in, nullptr, false);
    if (!answers_.is_object()) throw std::invalid_argument(file_ + " does not hold remembered detections");
  }
  Memory(const Memory&) = delete;
  Memory& operator=(const Memory&) = delete;
  ~Memory() {
    if (!grown_) return;
    std::ofstream(file_) << answers_.dump() << '\n';
  }

  template <class Answer>
  Answer recall(const camera::SourceFrame& frame, const std::function<Answer()>& look) {
    const std::string key = std::to_string(frame.image.seq);
    Answer answer;
    if (const auto known = answers_.find(key); known != answers_.end()) {
      from_json(*known, answer);
      return answer;
    }
    answer = look();
    answers_[key] = to_json(answer);
    grown_ = true;
    return answer;
  }

 private:
  std::string file_;
  json answers_ = json::object();
  bool grown_ = false;
};

}  // namespace

Look remembered_look(Look look, const std::string& file) {
  return [memory = std::make_shared<Memory>(file), look = std::move(look)](const camera::SourceFrame& frame) {
    return memory->recall<std::vector<vision::Detection>>(frame, [&] { return look(frame); });
  };
}

LookAtPixels remembered_pixels(LookAtPixels look, const std::string& file) {
  return [memory = std::make_shared<Memory>(file), look = std::move(look)](const auto& frame, const auto& boxes) {
    return memory->recall<vision::PersonMasks>(frame, [&] { return look(frame, boxes); });
  };
}

}  // namespace rtd::test_support
