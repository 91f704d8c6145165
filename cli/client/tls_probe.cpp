#include "cli/client/tls_probe.h"

#include <array>
#include <boost/asio/ip/tcp.hpp>

namespace mortise::cli {
namespace {

// The first bytes of records (RFC 8446, section 5.1).
constexpr char kAlert = 21;
constexpr char kHandshake = 22;

// The ClientHello of TLS 1.2 with two ciphers, and the curves and signatures that they need: enough
// for a server of TLS to answer, be it to refuse.
constexpr std::array<unsigned char, 11> kBeginning = {
    22, 3, 1, 0,  81,  // a handshake of as many bytes
    1,  0, 0, 77,      // a ClientHello of as many
    3,  3,             // TLS 1.2; 32 random bytes and the length of a session's name follow, all 0
};
constexpr int kZeros = 33;
constexpr std::array<unsigned char, 42> kEnd = {
    0, 4,    0xc0, 0x2f, 0xc0, 0x2b,                    // ECDHE with AES-128-GCM, RSA and ECDSA
    1, 0,                                               // no compression
    0, 32,                                              // as many bytes of extensions
    0, 0x0a, 0,    6,    0,    4,    0, 0x1d, 0, 0x17,  // groups: X25519, P-256
    0, 0x0b, 0,    2,    1,    0,                       // points: uncompressed
    0, 0x0d, 0,    12,   0,    10,   4, 3,    8, 4,
    4, 1,    5,    3,    6,    1,  // signatures: ECDSA, PSS and RSA
};

std::string ClientHello() {
  std::string bytes(kBeginning.begin(), kBeginning.end());
  bytes.append(kZeros, '\0');
  bytes.append(kEnd.begin(), kEnd.end());
  return bytes;
}

}  // namespace

TlsAnswer AskForTls(const std::string& address, std::chrono::milliseconds patience) {
  const std::size_t colon = address.rfind(':');
  if (colon == std::string::npos) return TlsAnswer::kNothing;
  std::string host = address.substr(0, colon);
  if (host.size() > 2 && host.front() == '[') host = host.substr(1, host.size() - 2);
  boost::asio::ip::tcp::iostream connection;
  connection.expires_after(patience);
  connection.connect(host, address.substr(colon + 1));
  connection << ClientHello() << std::flush;
  char first = 0;
  if (!connection.get(first)) return TlsAnswer::kNothing;
  return first == kAlert || first == kHandshake ? TlsAnswer::kTls : TlsAnswer::kOther;
}

}  // namespace mortise::cli
