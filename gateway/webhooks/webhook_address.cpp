#include "gateway/webhooks/webhook_address.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <netinet/in.h>

#include <algorithm>
#include <array>
#include <boost/asio/ip/address_v4.hpp>
#include <boost/asio/ip/address_v6.hpp>
#include <cstring>
#include <vector>

#include "absl/strings/numbers.h"
#include "common/base/errors.h"

namespace mortise::gateway {
namespace {

using boost::asio::ip::address;
using boost::asio::ip::address_v4;
using boost::asio::ip::address_v6;

constexpr std::size_t kMaximalUrlBytes = 2048;

// Where cloud machines are told their credentials, beside the link-local addresses.
constexpr std::array<const char*, 4> kCredentialHosts = {"100.100.100.200", "168.63.129.16",
                                                         "192.0.0.192", "fd00:ec2::254"};

const char* UsualPort(bool secure) { return secure ? "443" : "80"; }

bool IsPort(std::string_view text) {
  constexpr int kLargest = 65535;
  const bool digits =
      std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
  int port = 0;
  return digits && absl::SimpleAtoi(absl::string_view(text.data(), text.size()), &port) &&
         port >= 1 && port <= kLargest;
}

// A name, or an IPv4 or IPv6 address: what no resolver could take for anything else. An address
// with a zone ('%') is link-local, which is refused, or means no more than without.
bool IsHost(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) {
    const bool plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    return plain || c == '.' || c == '-' || c == '_' || c == ':';
  });
}

// The IPv4 addresses that an address of a network's own NAT64 may stand for (RFC 8215): where in it
// they are depends on the prefix that the network has chosen (RFC 6052), which is not known here.
std::vector<address_v4> OfLocalTranslation(const address_v6::bytes_type& bytes) {
  constexpr std::size_t kPlaces[][4] = {
      {6, 7, 9, 10}, {7, 9, 10, 11}, {9, 10, 11, 12}, {12, 13, 14, 15}};
  std::vector<address_v4> found;
  for (const auto& [a, b, c, d] : kPlaces) {
    // What begins with zero is no address, but a place where there is none.
    if (bytes[a] != 0) found.push_back(address_v4({bytes[a], bytes[b], bytes[c], bytes[d]}));
  }
  if (found.empty()) found.push_back(address_v4::any());
  return found;
}

// The IPv4 addresses that an IPv6 address stands for: mapped, compatible, translated (NAT64, SIIT)
// or tunnelled (6to4); none if it stands for itself.
std::vector<address_v4> EmbeddedV4(const address_v6& given) {
  const address_v6::bytes_type bytes = given.to_bytes();
  const auto v4_at = [&](std::size_t at) {
    return std::vector{address_v4({bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]})};
  };
  const auto starts_with = [&](std::initializer_list<unsigned char> prefix) {
    return std::equal(prefix.begin(), prefix.end(), bytes.begin());
  };
  if (given.is_v4_mapped()) return v4_at(12);
  if (starts_with({0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff, 0, 0})) return v4_at(12);
  if (starts_with({0x00, 0x64, 0xff, 0x9b, 0, 0, 0, 0, 0, 0, 0, 0})) return v4_at(12);
  if (starts_with({0x00, 0x64, 0xff, 0x9b, 0, 1})) return OfLocalTranslation(bytes);
  if (starts_with({0x20, 0x02})) return v4_at(2);
  const bool compatible = starts_with({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  if (compatible && !given.is_loopback() && !given.is_unspecified()) return v4_at(12);
  return {};
}

address AddressOf(const sockaddr& given) {
  if (given.sa_family == AF_INET) {
    return address_v4(ntohl(reinterpret_cast<const sockaddr_in&>(given).sin_addr.s_addr));
  }
  address_v6::bytes_type bytes;
  std::memcpy(bytes.data(), &reinterpret_cast<const sockaddr_in6&>(given).sin6_addr, bytes.size());
  return address_v6(bytes);
}

// Whether an interface of this machine has the address now.
bool IsOwn(const address& given) {
  ifaddrs* first = nullptr;
  if (::getifaddrs(&first) != 0) return true;  // not known to be another's
  bool own = false;
  for (const ifaddrs* one = first; one != nullptr && !own; one = one->ifa_next) {
    if (one->ifa_addr == nullptr) continue;
    const int family = one->ifa_addr->sa_family;
    own = (family == AF_INET || family == AF_INET6) && AddressOf(*one->ifa_addr) == given;
  }
  ::freeifaddrs(first);
  return own;
}

bool IsCredentialHost(const address& given) {
  return std::any_of(kCredentialHosts.begin(), kCredentialHosts.end(), [&](const char* host) {
    return given == boost::asio::ip::make_address(host);
  });
}

bool IsSpecial(const address_v4& given) {
  const auto number = given.to_uint();
  const bool link_local = number >> 16 == 0xa9fe;
  const bool this_network = number >> 24 == 0;
  const bool reserved = number >> 28 == 0xf;
  return link_local || this_network || reserved;
}

}  // namespace

absl::StatusOr<WebhookUrl> ParseWebhookUrl(std::string_view url) {
  if (url.size() > kMaximalUrlBytes) return InvalidField("url", "is too long");
  if (std::any_of(url.begin(), url.end(), [](char c) { return c <= 0x20 || c >= 0x7f; })) {
    return InvalidField("url", "may only have printable ASCII characters");
  }
  WebhookUrl result;
  if (url.starts_with("https://")) {
    result.secure = true;
    url.remove_prefix(8);
  } else if (url.starts_with("http://")) {
    url.remove_prefix(7);
  } else {
    return InvalidField("url", "must begin with http:// or https://");
  }
  url = url.substr(0, url.find('#'));
  const auto end = std::min(url.find_first_of("/?"), url.size());
  std::string_view authority = url.substr(0, end);
  result.target = std::string(url.substr(end));
  if (!result.target.starts_with('/')) result.target.insert(0, "/");
  if (authority.find('@') != std::string_view::npos) {
    return InvalidField("url", "may not carry a user name or password");
  }
  std::string_view port;
  if (authority.starts_with('[')) {
    const auto close = authority.find(']');
    if (close == std::string_view::npos) return InvalidField("url", "has an unfinished address");
    result.host = std::string(authority.substr(1, close - 1));
    authority.remove_prefix(close + 1);
    if (!authority.empty() && authority.front() != ':') return InvalidField("url", "is malformed");
    port = authority.empty() ? authority : authority.substr(1);
  } else {
    const auto colon = authority.find(':');
    result.host = std::string(authority.substr(0, colon));
    if (colon != std::string_view::npos) port = authority.substr(colon + 1);
  }
  if (result.host.empty()) return InvalidField("url", "names no host");
  if (!IsHost(result.host)) return InvalidField("url", "names a host that cannot be");
  if (!port.empty() && !IsPort(port)) return InvalidField("url", "has a port beyond 1 to 65535");
  result.port = port.empty() ? UsualPort(result.secure) : std::string(port);
  return result;
}

std::optional<address> LiteralAddress(std::string host) {
  if (host.size() > 1 && host.back() == '.') host.pop_back();
  boost::system::error_code error;
  const address plain = boost::asio::ip::make_address(host, error);
  if (!error) return plain;
  in_addr old{};
  if (::inet_aton(host.c_str(), &old) == 0) return std::nullopt;
  return address_v4(ntohl(old.s_addr));
}

bool IsAllowedAddress(const address& asked, bool allow_loopback) {
  address given = asked;
  if (asked.is_v6()) {
    // Without its zone, for addresses are compared with it.
    const address_v6 zoneless(asked.to_v6().to_bytes());
    const std::vector<address_v4> embedded = EmbeddedV4(zoneless);
    if (!embedded.empty()) {
      return std::all_of(embedded.begin(), embedded.end(), [&](const address_v4& one) {
        return IsAllowedAddress(one, allow_loopback);
      });
    }
    given = zoneless;
  }
  if (given.is_unspecified() || given.is_multicast() || IsCredentialHost(given)) return false;
  if (given.is_v6() ? given.to_v6().is_link_local() : IsSpecial(given.to_v4())) return false;
  return allow_loopback || (!given.is_loopback() && !IsOwn(given));
}

}  // namespace mortise::gateway
