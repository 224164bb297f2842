// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Changed HTTP requests and WebSocket frames for the viewer's server over loopback: no exception; the server answers a
/// good request afterwards.
#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>

#include "services/viewer/core/foxglove_hub.hpp"
#include "services/viewer/core/page_hub.hpp"
#include "services/viewer/core/page_messages.hpp"
#include "services/viewer/web/web_server.hpp"
#include "tests/fuzz/fuzz_loop.hpp"

namespace rtd::viewer {
namespace {

/// A loopback connection that never blocks.
class Connection {
 public:
  explicit Connection(std::uint16_t port) : descriptor_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const linger at_once{1, 0};  // no port waits for late packets
    setsockopt(descriptor_, SOL_SOCKET, SO_LINGER, &at_once, sizeof(at_once));
    open_ = ::connect(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
    fcntl(descriptor_, F_SETFL, O_NONBLOCK);
  }
  ~Connection() { ::close(descriptor_); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  bool send(std::span<const std::byte> bytes) {
    return open_ && ::send(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL) >= 0;
  }
  std::string receive() {
    std::array<char, 4096> buffer{};
    const ssize_t size = ::recv(descriptor_, buffer.data(), buffer.size(), 0);
    if (size == 0) open_ = false;
    return size > 0 ? std::string(buffer.data(), static_cast<std::size_t>(size)) : "";
  }
  bool open() const { return open_; }

 private:
  int descriptor_;
  bool open_ = false;
};

using fuzz::bytes_of;

std::string upgrade(const std::string& subprotocol) {
  return "GET /live HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
         "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Protocol: " +
         subprotocol + "\r\n\r\n";
}

/// A masked frame, with a mask of zeros.
std::string frame(int opcode, const std::string& content) {
  std::string text(1, static_cast<char>(0x80 | opcode));
  text += static_cast<char>(0x80 | content.size());
  return text + std::string(4, '\0') + content;
}

std::vector<io::Bytes> request_seeds() {
  return {bytes_of("GET / HTTP/1.1\r\nHost: localhost\r\n\r\n"),
          bytes_of("GET /three/build/three.module.js HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n"),
          bytes_of("HEAD /app.js HTTP/1.0\r\n\r\n"),
          bytes_of("POST /access?token=x HTTP/1.1\r\nHost: 127.0.0.1:1\r\nContent-Length: 4\r\n\r\nabcd"),
          bytes_of("GET /a HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n4\r\nabcd\r\n0\r\n\r\n"),
          bytes_of(upgrade("foxglove.sdk.v1")),
          bytes_of(upgrade("rtd.viewer.v1, other"))};
}

std::vector<io::Bytes> frame_seeds() {
  return {bytes_of(frame(1, R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":1}]})")),
          bytes_of(frame(1, R"({"op":"options","image":false})")),
          bytes_of(frame(2, std::string("\x02\x01\x00\x00\x00\x09\x00\x00\x00\x04\x00\x00\x00json{}", 19))),
          bytes_of(frame(9, "ping")),
          bytes_of(frame(8, std::string("\x03\xe8", 2))),
          bytes_of(frame(0, "rest")),
          bytes_of(std::string("\x01\x83\x00\x00\x00\x00"
                               "abc",
                               9) +
                   frame(0, "def"))};
}

/// The server, and a WebSocket to it that is renewed when it is closed.
class Target {
 public:
  void send_request(const io::Bytes& input) {
    Connection connection(server_->port());
    turn();
    connection.send(input);
    for (int i = 0; i < 3; ++i) turn();
    answers_ += connection.receive().starts_with("HTTP/1.1") ? 1 : 0;
  }

  void send_frame(const io::Bytes& input) {
    if (!client_ || !client_->open() || ++frames_ % 200 == 0) connect();
    if (!client_->send(input)) client_.reset();
    turn();
    if (client_) client_->receive();
  }

  bool still_answers() {
    Connection connection(server_->port());
    connection.send(request_seeds().front());
    for (int i = 0; i < 200; ++i) {
      server_->run_for(std::chrono::milliseconds(1));
      if (connection.receive().starts_with("HTTP/1.1 200")) return true;
    }
    return false;
  }
  std::uint64_t answers() const { return answers_; }
  WebCounts counts() const { return server_->counts(); }

 private:
  void turn() {
    server_->run_for(std::chrono::milliseconds(0));
    server_->pump();
  }
  void connect() {
    client_ = std::make_unique<Connection>(server_->port());
    const auto request = bytes_of(upgrade(++connected_ % 2 == 0 ? "foxglove.sdk.v1" : "rtd.viewer.v1"));
    client_->send(request);
    for (int i = 0; i < 3; ++i) turn();
    client_->receive();
  }

  FoxgloveHub foxglove_{"fuzz", "1", {}, {}};
  PageHub page_{{}, {}, {.on_call = {}, .now_ms = [] { return 0.0; }}};
  Site site_{"/usr/share/javascript/three"};
  std::unique_ptr<WebServer> server_ = WebServer::listen(
      {.port = 0, .access = {.hosts = {"localhost"}}}, site_, [this](const std::string& subprotocol, Rights) {
        return subprotocol == page::kSubprotocol ? page_.open() : foxglove_.open();
      });
  std::unique_ptr<Connection> client_;
  std::uint64_t frames_ = 0, connected_ = 0, answers_ = 0;
};

}  // namespace
}  // namespace rtd::viewer

int main(int argc, char** argv) {
  using namespace rtd;
  const std::vector<io::Bytes> requests = viewer::request_seeds(), frames = viewer::frame_seeds();
  viewer::Target target;
  bool is_request = false;
  std::uint64_t count = 0;
  return fuzz::run_fuzz(argc, argv,
                        {.failed_path = "fuzz_viewer_web_failed.bin",
                         .make =
                             [&](fuzz::Random& random) {
                               is_request = random() % 4 == 0;
                               const auto& seeds = is_request ? requests : frames;
                               return random() % 4 == 0 ? seeds[random() % seeds.size()]
                                                        : fuzz::mutate_one(seeds, random);
                             },
                         .test = [&](const io::Bytes& input, fuzz::Random&) -> std::string {
                           is_request ? target.send_request(input) : target.send_frame(input);
                           return ++count % 1000 == 0 && !target.still_answers() ? "the server answers no more" : "";
                         },
                         .counted =
                             [&] {
                               return fmt::format("{} requests answered, {} refused, {} bytes sent", target.answers(),
                                                  target.counts().refused, target.counts().sent_bytes);
                             }});
}
