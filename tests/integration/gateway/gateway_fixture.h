// A gateway in front of fake services, and a plain HTTP client, for tests.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "gateway/gateway.h"
#include "tests/integration/gateway/fake_house.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/gateway/contract/token_fixture.h"

namespace mortise::gateway {

// A whole answer to one HTTP request.
struct HttpAnswer {
  int status = 0;
  std::map<std::string, std::string> headers;  // names in lower case
  std::string body;
};

// One request on a connection of its own; status 0 if that failed.
HttpAnswer Http(const std::string& address, const std::string& method, const std::string& target,
                const std::map<std::string, std::string>& headers = {},
                const std::string& body = "");

// A connection that an answer comes in by and by.
class HttpStream {
 public:
  // A GET of `target`.
  HttpStream(const std::string& address, const std::string& target,
             const std::map<std::string, std::string>& headers = {});
  // Any bytes.
  static std::unique_ptr<HttpStream> Send(const std::string& address, const std::string& bytes);
  ~HttpStream();

  // Reads until `text` has come; everything read so far, or what there is after ten seconds.
  std::string ReadUntil(const std::string& text);

  // The first so many bytes of all that comes; what there is after ten seconds.
  std::string ReadBytes(std::size_t count);

  // Whether the other side closes the connection, within ten seconds; what it says is kept.
  bool AwaitClose();

  // Sends more.
  void Write(const std::string& bytes);

  // Sends nothing more, and still reads.
  void FinishSending();

  void Close();

 private:
  struct Socket;
  // Reads until that is done, or ten seconds have passed. Whether the other side closed.
  bool ReadWhile(const std::function<bool()>& not_done);
  explicit HttpStream(const std::string& address);
  std::unique_ptr<Socket> socket_;
  std::string read_;
  bool closed_ = false;  // by the other side
};

class GatewayTest : public ::testing::Test {
 protected:
  // Options of a gateway in development, in front of the fake house.
  GatewayOptions Options() const;

  // The same without development: only tokens of `signer` open the doors.
  GatewayOptions SecureOptions(const TokenSigner& signer) const;

  void StartGateway(const GatewayOptions& options);

  mortise::testing::TemporaryFolder folder_;
  FakeHouse house_;
  std::unique_ptr<Gateway> gateway_;
};

}  // namespace mortise::gateway
