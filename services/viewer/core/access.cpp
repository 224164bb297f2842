// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/viewer/core/access.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>

namespace rtd::viewer {
namespace {

/// "localhost:8765" -> "localhost", "[::1]:8765" -> "[::1]"
std::string_view without_port(std::string_view host) {
  if (host.starts_with('[')) return host.substr(0, std::min(host.find(']') + 1, host.size()));
  return host.substr(0, host.rfind(':'));
}

std::string lower(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(), [](unsigned char letter) { return std::tolower(letter); });
  return result;
}

bool same_text(std::string_view given, std::string_view expected) {
  unsigned difference = given.size() == expected.size() ? 0 : 1;  // takes the same time for any guess
  for (std::size_t place = 0; place < given.size(); ++place)
    difference |= static_cast<unsigned char>(given[place]) ^
                  static_cast<unsigned char>(expected.empty() ? 0 : expected[place % expected.size()]);
  return difference == 0;
}

bool knows(const std::string& token, const AccessRequest& request) {
  constexpr std::string_view kBearer = "Bearer ";
  if (request.authorization.starts_with(kBearer) && same_text(request.authorization.substr(kBearer.size()), token))
    return true;
  return same_text(query_value(request.target, "token"), token);
}

/// Any page in a file or a sandboxed frame has such an origin, whoever wrote it.
bool is_anonymous(std::string_view origin) {
  return origin == "null" || lower(origin.substr(0, 5)) == "file:";
}

/// Anonymous ones have been dealt with before.
bool right_origin(const AccessRules& rules, const AccessRequest& request) {
  if (request.origin.empty() || std::ranges::count(rules.origins, request.origin) > 0) return true;
  const std::size_t scheme = request.origin.find("://");
  return scheme != std::string_view::npos && lower(request.origin.substr(scheme + 3)) == lower(request.host);
}

std::string decoded(std::string_view text) {
  std::string result;
  for (std::size_t place = 0; place < text.size(); ++place) {
    const std::string_view digits = text.substr(place + 1, 2);
    unsigned code = 0;
    const bool escaped = text[place] == '%' && digits.size() == 2 &&
                         std::from_chars(digits.begin(), digits.end(), code, 16).ptr == digits.end();
    result += escaped ? static_cast<char>(code) : text[place];
    if (escaped) place += 2;
  }
  return result;
}

}  // namespace

bool is_loopback(std::string_view host) {
  const bool digits = host.find_first_not_of("0123456789.") == std::string_view::npos;  // not 127.example.org
  return host == "localhost" || host == "[::1]" || host == "::1" || (digits && host.starts_with("127."));
}

Access check_host(const AccessRules& rules, std::string_view host) {
  const std::string name = lower(without_port(host));
  return is_loopback(name) || rules.hosts.empty() || std::ranges::count(rules.hosts, name) > 0 ? Access::kGranted
                                                                                               : Access::kWrongHost;
}

Access check_access(const AccessRules& rules, const AccessRequest& request) {
  if (check_host(rules, request.host) != Access::kGranted) return Access::kWrongHost;
  if (is_anonymous(request.origin) && rules.token.empty()) return Access::kAnonymousOrigin;
  if (!right_origin(rules, request)) return Access::kWrongOrigin;
  if (rules.token.empty() || knows(rules.token, request)) return Access::kGranted;
  if (!rules.look_token.empty() && knows(rules.look_token, request)) return Access::kToLook;
  return rules.look_freely && !is_anonymous(request.origin) ? Access::kToLook : Access::kNoToken;
}

const char* explain(Access access) {
  switch (access) {
    case Access::kGranted:
      return "granted";
    case Access::kToLook:
      return kOnlyLooks;
    case Access::kWrongHost:
      return "this viewer is not addressed by that host name; start it with --host NAME to allow it\n";
    case Access::kWrongOrigin:
      return "a page of another site may not connect; start the viewer with --origin ORIGIN to allow it\n";
    case Access::kAnonymousOrigin:
      return "a page from a file may connect only with a token; start the viewer with --token TEXT and use the address "
             "that it then prints (?token=TEXT)\n";
    case Access::kNoToken:
      return "the token is missing or wrong: use the address that the viewer has printed (?token=...)\n";
  }
  return "";
}

std::string_view path_of(std::string_view target) {
  return target.substr(0, target.find('?'));
}

std::string query_value(std::string_view target, std::string_view name) {
  const std::size_t begin = target.find('?');
  std::string_view rest = begin == std::string_view::npos ? std::string_view() : target.substr(begin + 1);
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('&'), rest.size());
    const std::string_view pair = rest.substr(0, end);
    if (pair.starts_with(name) && pair.substr(name.size()).starts_with('='))
      return decoded(pair.substr(name.size() + 1));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return {};
}

}  // namespace rtd::viewer
