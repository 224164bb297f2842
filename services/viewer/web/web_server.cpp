// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
//
// Longer than most: a visitor that speaks HTTP becomes a client with a WebSocket, and both are private to the server.
#include "services/viewer/web/web_server.hpp"

#include <algorithm>
#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <list>
#include <optional>
#include <set>

#include "common/service/monotonic_clock.hpp"
#include "services/viewer/core/foxglove.hpp"
#include "services/viewer/core/page_messages.hpp"

namespace rtd::viewer {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using Request = http::request<http::empty_body>;

constexpr int kSendBuffer = 256 * 1024;  // what waits in the kernel is old when it arrives
constexpr std::size_t kLongestHead = 8192;

std::string_view view(beast::string_view text) {
  return {text.data(), text.size()};
}

/// Our subprotocol that the client prefers; "" when it offers none.
std::string choose_subprotocol(std::string_view offered) {
  while (!offered.empty()) {
    const std::size_t end = std::min(offered.find(','), offered.size());
    std::string_view name = offered.substr(0, end);
    offered.remove_prefix(std::min(end + 1, offered.size()));
    while (name.starts_with(' ')) name.remove_prefix(1);
    while (name.ends_with(' ')) name.remove_suffix(1);
    if (name == page::kSubprotocol || std::ranges::count(foxglove::kSubprotocols, name) > 0) return std::string(name);
  }
  return {};
}

std::array<asio::const_buffer, 2> buffers(const Frame& frame) {
  return {asio::buffer(frame.head), frame.payload ? asio::buffer(*frame.payload) : asio::const_buffer()};
}

class BeastServer : public WebServer {
 public:
  BeastServer(const WebOptions& options, const Site& site, Open open, Reports reports);
  ~BeastServer() override;

  std::uint16_t port() const override { return acceptor_.local_endpoint().port(); }
  void run_for(std::chrono::milliseconds time) override {
    context_.restart();
    context_.poll();  // run_for() does nothing when no time is given
    context_.run_for(time);
  }
  void post(std::function<void()> task) override { asio::post(context_, std::move(task)); }
  void pump() override;
  WebCounts counts() const override;

 private:
  class Visitor;
  class Client;

  void listen();
  void accept();
  void welcome(tcp::socket socket);
  void close_oldest_visitor();
  void upgrade(beast::tcp_stream stream, Request request, Rights rights);

  const WebOptions options_;
  const Site& site_;
  const Open open_;
  const Reports reports_;
  asio::io_context context_{1};
  tcp::acceptor acceptor_{context_};
  asio::steady_timer retry_{context_};
  std::list<std::weak_ptr<Visitor>> visitors_;
  std::set<Client*> clients_;
  WebCounts counts_;
  bool ended_ = false;
};

/// A connection that speaks HTTP.
class BeastServer::Visitor : public std::enable_shared_from_this<Visitor> {
 public:
  Visitor(BeastServer& server, tcp::socket socket) : server_(server), stream_(std::move(socket)) {}
  ~Visitor() {
    server_.visitors_.remove_if([](const auto& visitor) { return visitor.expired(); });
  }

  void read() {
    parser_.emplace();
    parser_->header_limit(kLongestHead);
    parser_->body_limit(std::uint64_t{0});
    stream_.expires_after(server_.options_.patience);
    http::async_read(stream_, buffer_, *parser_,
                     [self = shared_from_this()](beast::error_code error, std::size_t) { self->handle(error); });
  }
  void close() {
    beast::error_code ignored;
    stream_.socket().close(ignored);
  }

 private:
  void handle(beast::error_code error) {
    if (error == http::error::header_limit || error == http::error::body_limit)
      return refuse(http::status::request_header_fields_too_large, "the request is too long\n");
    if (error) return;  // gone, too slow, or not HTTP
    ++server_.counts_.requests;
    Request request = parser_->release();
    if (websocket::is_upgrade(request)) {
      const Access access = access_of(request);
      const Rights rights = access == Access::kGranted ? Rights::kControl : Rights::kLook;
      if (may_upgrade(request, access)) server_.upgrade(std::move(stream_), std::move(request), rights);
      return;
    }
    serve(request);
  }

  Access access_of(const Request& request) const {
    return check_access(server_.options_.access, {.host = view(request[http::field::host]),
                                                  .origin = view(request[http::field::origin]),
                                                  .target = view(request.target()),
                                                  .authorization = view(request[http::field::authorization])});
  }

  bool may_upgrade(const Request& request, Access access) {
    if (!may_look(access)) {
      refuse(access == Access::kNoToken ? http::status::unauthorized : http::status::forbidden, explain(access));
      return false;
    }
    if (choose_subprotocol(view(request[http::field::sec_websocket_protocol])).empty()) {
      refuse(http::status::bad_request,
             "offer one of the WebSocket subprotocols foxglove.sdk.v1, foxglove.websocket.v1, rtd.viewer.v1\n");
      return false;
    }
    if (server_.clients_.size() >= server_.options_.most_clients) {
      refuse(http::status::service_unavailable, "too many clients are connected\n");
      return false;
    }
    return true;
  }

  void serve(const Request& request) {
    const Access access = check_host(server_.options_.access, view(request[http::field::host]));
    if (access != Access::kGranted) return refuse(http::status::forbidden, explain(access));
    if (request.method() != http::verb::get && request.method() != http::verb::head)
      return refuse(http::status::method_not_allowed, "only GET is answered\n");
    const std::string_view path = path_of(view(request.target()));
    if (path == "/access") return answer_access(request);
    if (const auto report = server_.reports_.find(path); report != server_.reports_.end())
      return answer_report(request, report->second);
    const auto file = server_.site_.file(path);
    if (!file) return refuse(http::status::not_found, "there is no such page\n");
    answer(http::status::ok, file->content, file->type, file->keeps, request.keep_alive(),
           request.method() == http::verb::head);
  }

  /// A page cannot see why a WebSocket was refused; here it can.
  void answer_access(const Request& request) {
    const Access access = access_of(request);
    answer(may_look(access) ? http::status::ok : http::status::unauthorized, explain(access),
           "text/plain; charset=utf-8", false, request.keep_alive(), false);
  }

  void answer_report(const Request& request, const std::function<Report()>& make) {
    const Access access = access_of(request);
    if (!may_look(access)) return refuse(http::status::unauthorized, explain(access));
    const Report report = make();
    answer(report.well ? http::status::ok : http::status::service_unavailable, report.content, report.type, false,
           request.keep_alive(), request.method() == http::verb::head);
  }

  void refuse(http::status status, const std::string& why) {
    ++server_.counts_.refused;
    answer(status, why, "text/plain; charset=utf-8", false, false, false);
  }

  void answer(http::status status, const std::string& content, const char* type, bool keeps, bool stay,
              bool head_only) {
    auto response = std::make_shared<http::response<http::string_body>>(status, 11);
    response->set(http::field::server, "rtd-viewer");
    response->set(http::field::content_type, type);
    response->set(http::field::cache_control, keeps ? "max-age=86400" : "no-cache");
    response->set("X-Content-Type-Options", "nosniff");
    response->set("Referrer-Policy", "no-referrer");
    response->set("Content-Security-Policy",
                  "default-src 'self'; img-src 'self' blob: data:; style-src 'self' 'unsafe-inline'; "
                  "connect-src 'self' ws: wss:; frame-ancestors 'none'");
    response->keep_alive(stay);
    response->body() = content;
    response->prepare_payload();
    if (head_only) response->body().clear();
    stream_.expires_after(server_.options_.patience);
    http::async_write(stream_, *response,
                      [self = shared_from_this(), response, stay](beast::error_code error, std::size_t bytes) {
                        self->server_.counts_.sent_bytes += bytes;
                        if (!error && stay) return self->read();
                        beast::error_code ignored;
                        self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
                      });
  }

  BeastServer& server_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{kLongestHead};
  std::optional<http::request_parser<http::empty_body>> parser_;
};

/// A connection that is a WebSocket.
class BeastServer::Client : public std::enable_shared_from_this<Client> {
 public:
  Client(BeastServer& server, beast::tcp_stream stream) : server_(server), socket_(std::move(stream)) {
    server_.clients_.insert(this);
  }
  ~Client() { server_.clients_.erase(this); }

  void accept(Request request, Rights rights) {
    const std::string subprotocol = choose_subprotocol(view(request[http::field::sec_websocket_protocol]));
    beast::get_lowest_layer(socket_).expires_never();
    websocket::stream_base::timeout timeout = websocket::stream_base::timeout::suggested(beast::role_type::server);
    timeout.handshake_timeout = server_.options_.patience;
    timeout.idle_timeout = std::chrono::seconds(20);
    socket_.set_option(timeout);
    socket_.set_option(websocket::stream_base::decorator([subprotocol](websocket::response_type& response) {
      response.set(http::field::server, "rtd-viewer");
      response.set(http::field::sec_websocket_protocol, subprotocol);
    }));
    socket_.read_message_max(server_.options_.longest_message_bytes);
    request_ = std::move(request);
    socket_.async_accept(request_, [self = shared_from_this(), subprotocol, rights](beast::error_code error) {
      if (!error) self->begin(subprotocol, rights);
    });
  }

  void pump() {
    if (!session_ || writing_) return;
    if (session_->overflowed()) {
      ++server_.counts_.closed_slow;
      return drop();
    }
    auto frame = session_->next(service::monotonic_ns());
    if (!frame) return;
    writing_ = std::move(frame);
    socket_.text(writing_->text);
    socket_.async_write(buffers(*writing_), [self = shared_from_this()](beast::error_code error, std::size_t bytes) {
      self->server_.counts_.sent_bytes += bytes;
      self->writing_.reset();
      if (error) return self->drop();
      self->pump();
    });
  }

  /// At once: a client that does not read would never take a farewell.
  void drop() {
    session_.reset();
    beast::error_code ignored;
    beast::get_lowest_layer(socket_).socket().close(ignored);
  }

 private:
  void begin(const std::string& subprotocol, Rights rights) {
    session_ = server_.open_(subprotocol, rights);
    if (!session_) return drop();
    read();
    pump();
  }

  void read() {
    socket_.async_read(buffer_, [self = shared_from_this()](beast::error_code error, std::size_t) {
      if (error) return self->session_.reset();  // Beast has answered a close or sent its reason
      self->receive();
    });
  }

  void receive() {
    const auto bytes = buffer_.data();
    if (session_) {
      if (socket_.got_text()) {
        session_->on_text({static_cast<const char*>(bytes.data()), bytes.size()});
      } else {
        session_->on_binary({static_cast<const std::byte*>(bytes.data()), bytes.size()});
      }
    }
    buffer_.consume(buffer_.size());
    if (!session_) return;
    pump();
    read();
  }

  BeastServer& server_;
  websocket::stream<beast::tcp_stream> socket_;
  beast::flat_buffer buffer_;
  Request request_;
  std::unique_ptr<Session> session_;
  std::optional<Frame> writing_;  ///< lives until the write has ended
};

BeastServer::BeastServer(const WebOptions& options, const Site& site, Open open, Reports reports)
    : options_(options), site_(site), open_(std::move(open)), reports_(std::move(reports)) {
  listen();
  accept();
}

BeastServer::~BeastServer() {
  ended_ = true;
  beast::error_code ignored;
  acceptor_.close(ignored);
  retry_.cancel();
  for (Client* client : clients_) client->drop();
  for (const auto& visitor : visitors_)
    if (const auto known = visitor.lock()) known->close();
  context_.restart();
  context_.run_for(std::chrono::milliseconds(200));  // pending operations end and let go of their connections
}

void BeastServer::listen() {
  beast::error_code error;
  const auto address = asio::ip::make_address(options_.address, error);
  if (error)
    throw WebError("'" + options_.address + "' is not an IP address; use 127.0.0.1, 0.0.0.0 or that of an interface");
  const tcp::endpoint endpoint(address, options_.port);
  acceptor_.open(endpoint.protocol(), error);
  if (!error) acceptor_.set_option(tcp::acceptor::reuse_address(true), error);
  if (!error) acceptor_.bind(endpoint, error);
  if (!error) acceptor_.listen(512, error);
  if (error)
    throw WebError("cannot listen on " + options_.address + ", port " + std::to_string(options_.port) + ": " +
                   error.message() + "; choose another one with --port or --bind");
}

void BeastServer::accept() {
  acceptor_.async_accept(context_, [this](beast::error_code error, tcp::socket socket) {
    if (ended_) return;
    if (!error) {
      welcome(std::move(socket));
      return accept();
    }
    close_oldest_visitor();  // no descriptors may be left
    retry_.expires_after(std::chrono::milliseconds(50));
    retry_.async_wait([this](beast::error_code aborted) {
      if (!aborted) accept();
    });
  });
}

void BeastServer::close_oldest_visitor() {
  if (visitors_.empty()) return;
  if (const auto oldest = visitors_.front().lock()) oldest->close();
}

void BeastServer::welcome(tcp::socket socket) {
  beast::error_code ignored;
  socket.set_option(tcp::no_delay(true), ignored);
  socket.set_option(asio::socket_base::send_buffer_size(kSendBuffer), ignored);
  if (visitors_.size() >= options_.most_visitors) close_oldest_visitor();
  const auto visitor = std::make_shared<Visitor>(*this, std::move(socket));
  visitors_.push_back(visitor);
  visitor->read();
}

void BeastServer::upgrade(beast::tcp_stream stream, Request request, Rights rights) {
  std::make_shared<Client>(*this, std::move(stream))->accept(std::move(request), rights);
}

void BeastServer::pump() {
  std::vector<std::shared_ptr<Client>> clients;  // one may go meanwhile
  for (Client* client : clients_) clients.push_back(client->shared_from_this());
  for (const auto& client : clients) client->pump();
}

WebCounts BeastServer::counts() const {
  WebCounts counts = counts_;
  counts.clients = clients_.size();
  return counts;
}

}  // namespace

std::unique_ptr<WebServer> WebServer::listen(const WebOptions& options, const Site& site, Open open, Reports reports) {
  return std::make_unique<BeastServer>(options, site, std::move(open), std::move(reports));
}

}  // namespace rtd::viewer
