// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Changed messages for the sessions of Foxglove clients and of pages: no exception.
#include <fmt/format.h>
#include <span>

#include "services/viewer/core/foxglove_hub.hpp"
#include "services/viewer/core/page_hub.hpp"
#include "tests/fuzz/fuzz_loop.hpp"

namespace rtd::viewer {
namespace {

/// The first byte chooses the client and the kind of message.
constexpr unsigned kText = 1, kPage = 2;

std::vector<io::Bytes> seeds() {
  const auto text = [](unsigned kind, const std::string& content) {
    io::Bytes input(1, static_cast<std::byte>(kind));
    const io::Bytes bytes = fuzz::bytes_of(content);
    input.insert(input.end(), bytes.begin(), bytes.end());
    return input;
  };
  const std::string call("\x02\x01\x00\x00\x00\x09\x00\x00\x00\x04\x00\x00\x00json{\"argument\":\"x\",\"data\":true}",
                         44);
  const std::string cdr_call(
      "\x02\x02\x00\x00\x00\x09\x00\x00\x00\x03\x00\x00\x00"
      "cdr\x00\x01\x00\x00\x03\x00\x00\x00hi\x00",
      27);
  const std::string seek("\x03\x01\x00\x00\x80\x3f\x01\x39\x30\x00\x00\x00\x00\x00\x00\x01\x00\x00\x00i", 20);
  const std::string data("\x01\x01\x00\x00\x00\x00\x01\x00\x00hello", 14);
  return {
      text(kText, R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":1},{"id":1,"channelId":2}]})"),
      text(kText, R"({"op":"unsubscribe","subscriptionIds":[0,1]})"),
      text(kText, R"({"op":"advertise","channels":[{"id":1,"topic":"/x","encoding":"cdr","schemaName":"a/msg/B"}]})"),
      text(kText,
           R"({"op":"setParameters","parameters":[{"name":"a","value":1.5},{"name":"b","value":"x"}],"id":"1"})"),
      text(kText, R"({"op":"getParameters","parameterNames":["a"],"id":"2"})"),
      text(kText, R"({"op":"subscribeParameterUpdates","parameterNames":["a","b"]})"),
      text(kText, R"({"op":"subscribeConnectionGraph"})"),
      text(kText, R"({"op":"fetchAsset","uri":"package://x","requestId":3})"),
      text(0, call),
      text(0, cdr_call),
      text(0, seek),
      text(0, data),
      text(kPage | kText, R"({"op":"options","image":false,"mask":true,"points":true,"dense":true})"),
      text(kPage | kText, R"({"op":"call","id":7,"robot":0,"name":"/slam/save_map","argument":"a.map"})"),
      text(kPage | kText, R"({"op":"ping","sent_ms":12.5})"),
  };
}

/// One client of each kind, renewed now and then.
class Clients {
 public:
  Clients() {
    foxglove_.add_channel("/a", {"cdr", "a/msg/A", "ros2msg", "uint8 a"});
    foxglove_.add_channel("/b", {"cdr", "a/msg/B", "ros2msg", "uint8 b"});
    foxglove_.set_commands({{"/slam/reset", CommandKind::kTrigger}, {"/slam/save_map", CommandKind::kText}});
    foxglove_.set_parameters({{"a", 1.0}});
    foxglove_.set_played(Played{.begin_ns = 0, .end_ns = 1'000'000'000});
    page_.robot("");
  }

  void send(const io::Bytes& input) {
    if (++count_ % 64 == 1) {
      foxglove_client_ = foxglove_.open();
      page_client_ = page_.open();
    }
    if (input.empty()) return;
    const auto kind = std::to_integer<unsigned>(input[0]);
    Session& client = (kind & kPage) != 0 ? *page_client_ : *foxglove_client_;
    const auto message = std::span(input).subspan(1);
    if ((kind & kText) != 0) {
      client.on_text({reinterpret_cast<const char*>(message.data()), message.size()});
    } else {
      client.on_binary(message);
    }
    foxglove_.publish(1, count_, std::make_shared<const Bytes>(8));
    if (count_ % 3 == 0)
      while (client.next(static_cast<std::int64_t>(count_) * 1'000'000)) ++sent_;
  }
  std::uint64_t sent() const { return sent_; }
  std::uint64_t acted() const { return acted_; }

 private:
  FoxgloveHooks hooks() {
    FoxgloveHooks hooks;
    hooks.on_call = [this](const auto&, const auto&, const auto& answer) {
      ++acted_;
      answer({true, "done"});
    };
    hooks.on_set = [this](const auto&, const auto& answer) { answer({++acted_ % 2 == 0, "why not"}); };
    hooks.on_playback = [this](const auto&, const auto& answer) { answer({++acted_ % 2 == 0, "why not"}); };
    hooks.on_publish = [this](const auto&, const auto&, auto) {
      ++acted_;
      return std::string();
    };
    return hooks;
  }

  std::uint64_t count_ = 0, sent_ = 0, acted_ = 0;
  FoxgloveHub foxglove_{"fuzz", "1", {}, hooks()};
  PageHub page_{{.control = true},
                {},
                {.on_call =
                     [this](const auto&, const auto&, const auto&, const auto& answer) {
                       ++acted_;
                       answer({});
                     },
                 .now_ms = [] { return 0.0; }}};
  std::unique_ptr<Session> foxglove_client_, page_client_;
};

}  // namespace
}  // namespace rtd::viewer

int main(int argc, char** argv) {
  using namespace rtd;
  const std::vector<io::Bytes> seeds = viewer::seeds();
  viewer::Clients clients;
  return fuzz::run_fuzz(
      argc, argv,
      {.failed_path = "fuzz_viewer_messages_failed.bin",
       .make =
           [&](fuzz::Random& random) {
             return random() % 8 == 0 ? seeds[random() % seeds.size()] : fuzz::mutate_one(seeds, random);
           },
       .test = [&](const io::Bytes& input, fuzz::Random&) -> std::string {
         clients.send(input);
         return "";
       },
       .counted = [&] { return fmt::format("{} messages sent, {} acted on", clients.sent(), clients.acted()); }});
}
